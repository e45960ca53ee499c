"""The result of a joint: its states at the corners of a load history, and the contact of every pin in every plate."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from fastpin.bodies.compliance import LEAST_ORDER, Compliance
from fastpin.cracks.growing import Growth, planned_growth
from fastpin.damage.assessed import assessed_fatigue
from fastpin.damage.spectrum import NoChangeError, SpectrumDamage
from fastpin.errors import InputError
from fastpin.joints.bending import bending_moments
from fastpin.joints.hole import in_hole
from fastpin.joints.parts import Joint
from fastpin.joints.pins import BEAM, whole_name
from fastpin.model import crack as crack_model
from fastpin.model.assessment import FatigueAssessment, check_assessment
from fastpin.model.checks import check_callable, instance, known_name, string, true_or_false, whole_number
from fastpin.model.crack import CrackGrowth
from fastpin.model.history import MAX_CORNERS
from fastpin.model.wear import Wear
from fastpin.states.extremes import KeptStates, find_extremes
from fastpin.states.margins import Margin, static_margins
from fastpin.states.state import State
from fastpin.states.yielding import PREFIX, yielding_owners

BALANCED = 1e-3
"""Sum of the forces of the pins on a plate, in parts of the largest, below which there are no shares.

The weak springs of loose pins bring 1e-4.
"""


class JointInterface(NamedTuple):
    """A pin in a plate, or its bush there, which may slip or open.

    Attributes
    ----------
    pin, plate : str
        Their names; a bush is called "bush of A".
    place : int
        The place of the pin in the plate among ``joint.sections``.
    is_bush : bool
    """

    pin: str
    plate: str
    place: int
    is_bush: bool

    def of(self, contact: State) -> State:
        """The state of the interface in that of the pin in the plate."""
        return contact.seat if self.is_bush and contact.seat is not None else contact


def interfaces_of(joint: Joint) -> list[JointInterface]:
    """All interfaces, in the order of ``joint.sections``."""
    found = []
    for place, (pin, plate) in enumerate(joint.sections):
        names = (pin.name, f"bush of {pin.name}")[: len(joint.problem(pin, plate).interfaces)]
        found += [JointInterface(name, plate.name, place, name != pin.name) for name in names]
    return found


class SectionDamage(NamedTuple):
    """The damage of the plate, or of the pin, where a pin goes through a plate."""

    pin: str
    plate: str
    found: SpectrumDamage


class SectionCrack(NamedTuple):
    """A crack of the plate where a pin goes through it, and how it grows."""

    pin: str
    plate: str
    how: CrackGrowth


class SectionMargin(NamedTuple):
    """A margin of safety of the plate, or of the pin, where a pin goes through a plate."""

    pin: str
    plate: str
    margin: Margin


class FayingState(NamedTuple):
    """The friction between two plates that a pin clamps, at one corner.

    Attributes
    ----------
    force : ndarray, shape (2,)
        Force of friction on the first plate along x and y, N.
    slip : ndarray, shape (2,)
        Slip of the next plate over the first one along x and y, m.
    dissipation : float
        Energy that friction has dissipated since the start, J.
    """

    force: np.ndarray
    slip: np.ndarray
    dissipation: float


@dataclass(frozen=True, eq=False)
class JointState:
    """The state of a joint at one corner.

    Attributes
    ----------
    joint : Joint
    step : int
        Number of the corner, from 0.
    load : dict of str to float
        Forces, N, stresses, Pa, and displacements, m, by the names of ``joint.load_names``; the reactions, too.
    contacts : tuple of State
        The contact of each pin in each of its plates, in the order of ``joint.sections``. That of its bush in the plate
        is the ``seat``. Their loads P, Q and M are what the pin passes on to this plate. Slip counts from the place
        where the pin, straight from the middle, first rested on the hole. Work and energy are NaN: they belong to the
        whole joint.
    forces : ndarray, shape (sections, 2)
        Force of the pin on the plate, or on the slice, along x and y, N.
    moved : ndarray, shape (plates, 3)
        Displacement of the supports of each plate along x and y, m, and its rotation, rad; 0 where they are fixed. Of a
        plate that is free it is the mean motion of the outline, at the place of its first pin.
    residuals : dict of str to float
        Largest violations of the contact conditions and of the equilibrium of every pin and plate, relative, recomputed
        from the matrices.
    faying : tuple of FayingState
        The faying surfaces of clamped plates, in the order of ``joint.faying``.
    """

    joint: Joint
    step: int
    load: dict[str, float]
    contacts: tuple[State, ...]
    forces: np.ndarray
    moved: np.ndarray
    residuals: dict[str, float]
    faying: tuple[FayingState, ...] = ()

    def __getitem__(self, names: tuple[str, str]) -> State:
        """The contact of a pin in a plate, by both names: ``state["A", "skin"]``, or ``state["A", "lug.1"]``."""
        return self.contacts[self.joint.place(*names)]

    def __repr__(self) -> str:
        acting = ", ".join(f"{name} {value:g}" for name, value in self.load.items() if value) or "no load"
        return f"<JointState at corner {self.step}: {acting}>"

    def force(self, pin: str, plate: str) -> np.ndarray:
        """Force of a pin on a plate with all its slices, or on one slice, along x and y, N.

        Unknown names raise :class:`InputError`.
        """
        return np.asarray(self.forces[self.joint.places(pin, plate)].sum(axis=0))

    def bending(self, pin: str) -> tuple[np.ndarray, np.ndarray]:
        """The moments in a pin that is a beam, see :func:`fastpin.joints.bending.bending_moments`.

        Raises
        ------
        InputError
            If the name is unknown, or the pin is no beam.
        """
        joint = self.joint
        known_name("pin", pin, [one.name for one in joint.pins])
        of = next(one for one in joint.pins if one.name == pin)
        if of.flexibility != BEAM:
            raise InputError("pin", f'{pin} does not bend: flexibility = "{BEAM}" makes it a beam')
        loads = -self.forces[[place for place, (one, _) in enumerate(joint.sections) if one is of]]
        first = len(joint.places(pin, of.plates[0]))
        loads[:first] += np.array([self.load[f"{pin}.{axis}"] for axis in "xy"]) / first
        return bending_moments(of.bar, joint.edges(of), of.heads or 0.0, loads)

    @property
    def moments(self) -> np.ndarray:
        """Moment of each pin on each plate, N m, shape (sections,)."""
        thickness = np.array([plate.thickness for _, plate in self.joint.sections])
        return np.array([each.load["M"] for each in self.contacts]) * thickness

    def shares(self, plate: str) -> dict[str, float]:
        """The part of the force on a plate or a slice that each pin brings, by name, along the sum of these forces.

        NaN where the pins do not load the plate together: where their sum is below 1e-3 of the largest one. Friction of
        faying surfaces does not count. An unknown plate raises :class:`InputError`.
        """
        known_name("plate", whole_name(string("plate", plate)), [each.name for each in self.joint.plates])
        pins = [pin.name for pin in self.joint.pins if whole_name(plate) in pin.plates]
        found = {pin: self.force(pin, plate) for pin in pins}
        whole = np.sum(list(found.values()), axis=0)
        size = float(whole @ whole)
        largest = max(float(force @ force) for force in found.values())
        if not size > BALANCED**2 * largest:
            return dict.fromkeys(found, float("nan"))
        return {name: float(force @ whole) / size for name, force in found.items()}


class JointStates(Sequence[JointState]):
    """The states of a joint in memory. Those of a file are a subclass, which reads them when they are asked for."""

    def __init__(self, states: Sequence[JointState]) -> None:
        self._states = states

    def __len__(self) -> int:
        return len(self._states)

    def __getitem__(self, place):  # type: ignore[no-untyped-def]
        return self._states[place]

    @property
    def bare(self) -> Sequence[JointState]:
        """The states, perhaps without their contacts."""
        return self._states

    def section(self, place: int) -> KeptStates:
        """The contact of a pin in a plate at all states, of which there must be one."""
        return KeptStates([state.contacts[place] for state in self._states])


@dataclass(frozen=True, eq=False)
class JointResult(Sequence[JointState]):
    """The states of a joint at the corners of a load history.

    Attributes
    ----------
    joint : Joint
    states : JointStates
    nodes : int
        Nodes of each contact, all round.
    harmonics : tuple of int
        Highest harmonic of the holes of each plate.
    snaps : int
        Times that a pin was released, or snapped to a new place.
    seconds : float
        Time of the solution.
    """

    joint: Joint
    states: JointStates
    nodes: int
    harmonics: tuple[int, ...]
    snaps: int
    seconds: float

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, place):  # type: ignore[no-untyped-def]
        return self.states[place]

    def __repr__(self) -> str:
        pins, plates = len(self.joint.pins), len(self.joint.plates)
        return f"<JointResult: {pins} pins, {plates} plates, {len(self)} states, {self.nodes} nodes a contact>"

    def of(self, pin: str, plate: str, whole: bool = False) -> list[State]:
        """The states of one pin in one plate.

        Parameters
        ----------
        pin, plate : str
        whole : bool
            Whether the states know the whole plate, for its stress anywhere, the stress along all its edges, and
            cracks. Places count from the centre of the pin's hole. The first question takes some seconds.

        Raises
        ------
        InputError
            If a name is unknown, or the plate is infinite and the whole of it is asked for.
        """
        place = self.joint.place(pin, plate)
        states = list(self.states.section(place)) if self.states else []
        return [*map(self.knowing_plate(pin, plate), states)] if true_or_false("whole", whole) else states

    def knowing_plate(self, pin: str, plate: str) -> Callable[[State], State]:
        """A function that returns a state of a pin in a plate as one that knows the whole plate, see :meth:`of`.

        Raises
        ------
        InputError
            If a name is unknown, or the plate is infinite or a slice.
        """
        lug, pinned = self.joint.lug(pin, plate)
        outline = json.dumps(lug.document())

        def knowing(state: State) -> State:
            hole: Any = state.problem.plate_body.lug  # a HoleInPlate
            return in_hole(state, replace(hole, outline=outline, pinned=pinned))

        return knowing

    def shares(self, plate: str) -> dict[str, np.ndarray]:
        """The share of each pin in the force on a plate at every state, by name; see :meth:`JointState.shares`."""
        rows = [state.shares(plate) for state in self.states.bare]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}

    @cached_property
    def first_touches(self) -> dict[tuple[str, str], int]:
        """The first corner at which each pin touches each plate, by both names; -1 where it never does at a corner."""
        found = {}
        for place, (pin, plate) in enumerate(self.joint.sections):
            contacts = self.states.section(place) if self.states else ()
            found[pin.name, plate.name] = next((one.step for one in contacts if one.in_contact), -1)
        return found

    @property
    def _loads(self) -> np.ndarray:
        """Loads at the states, shape (states, loads)."""
        return np.array([[state.load[name] for name in self.joint.given_names] for state in self.states.bare])

    @property
    def last_cycle(self) -> tuple[JointState, ...]:
        """The states of the last cycle, from the corner at which it begins; none without a cycle.

        A cycle is the shortest run of corners at the end of the history that repeats the loads of the corners before.
        """
        return tuple(self.states[place] for place in self.last_cycle_places)

    @property
    def last_cycle_places(self) -> range:
        """The places of the states of the :attr:`last_cycle`."""
        length, size = cycle_length(self._loads), len(self)
        return range(size - length - 1 if length else size, size)

    def assessed_fatigue(
        self, how: FatigueAssessment | None = None, progress: Callable[[float, float], None] | None = None
    ) -> list[SectionDamage]:
        """The damage of plates and pins at every contact over one pass of a spectrum.

        See :func:`fastpin.damage.assessed_fatigue`. The stresses are those at the load points.

        Parameters
        ----------
        how : FatigueAssessment, optional
            By default Smith, Watson and Topper over the whole history. A pass may be the :attr:`last_cycle`.
        progress : callable, optional
            Called as ``progress(done, total)`` now and then.

        Returns
        -------
        list of SectionDamage
            Criterion by criterion, the largest damage first. Parts whose material lacks the constants are left out, and
            holes at which no stress changes.

        Raises
        ------
        InputError
            If no material has the constants, or there are less than two states or no cycle.
        """
        how = FatigueAssessment() if how is None else instance("how", how, FatigueAssessment, "a FatigueAssessment")
        check_callable("progress", progress)
        check_fatigue(self.joint, how, self._loads)
        places = range(len(self)) if how.over == "history" else self.last_cycle_places
        known = _assessed_sections(self.joint, how)
        found: list[SectionDamage] = []
        for done, place in enumerate(known):
            pin, plate = self.joint.sections[place]

            def tell(part: float, whole: float, done: int = done) -> None:
                if progress is not None:
                    progress(done + part / whole, len(known))

            try:
                at_pin = assessed_fatigue(self.states.section(place).read(places), how, tell)
            except NoChangeError:
                if done == len(known) - 1 and not found:
                    raise
                continue
            found += [SectionDamage(pin.name, plate.name, each) for each in at_pin]
        return sorted(found, key=lambda one: (how.criteria.index(one.found.criterion), -one.found.hot_spot.damage))

    def crack_growth(self, crack: SectionCrack, progress: Callable[[float, float], None] | None = None) -> Growth:
        """The growth of a crack of a plate where a pin goes through it.

        It grows under the :attr:`last_cycle`, or else under the whole history as a spectrum. It does not change the
        forces of the pins, nor their contact. Angles and places count from the centre of the pin's hole.

        Parameters
        ----------
        crack : SectionCrack
        progress : callable, optional
            See :func:`fastpin.cracks.planned_growth`.

        Raises
        ------
        InputError
            See :func:`check_crack`; also if the crack can't be followed.
        """
        instance("crack", crack, SectionCrack, "a SectionCrack")
        check_crack(self.joint, crack, len(self))
        cycle, states = self.last_cycle_places, self.of(crack.pin, crack.plate, whole=True)
        return planned_growth(states[-len(cycle) :], crack.how, not cycle, progress)

    def margins(self, progress: Callable[[float, float], None] | None = None) -> list[SectionMargin]:
        """The margins of yield and ultimate strength of plates and pins at every contact over all states.

        The smallest one comes first, those that are not known last. A hole is looked at near its edge only.

        Parameters
        ----------
        progress : callable, optional
            Called as ``progress(done, total)`` now and then.

        Raises
        ------
        InputError
            If `progress` can't be called.
        """
        check_callable("progress", progress)
        found = []
        for place, (pin, plate) in enumerate(self.joint.sections if self.states else ()):
            kept = self.states.section(place)
            wanted = [PREFIX + owner for owner in yielding_owners(kept.problem)]
            rows = static_margins(kept.problem, find_extremes(kept, [(name, "largest") for name in wanted]), kept.read)
            found += [SectionMargin(pin.name, plate.name, row) for row in rows]
            if progress is not None:
                progress(place + 1, len(self.joint.sections))
        return sorted(found, key=lambda one: (math.isnan(one.margin.margin), one.margin.margin))


def check_fatigue(joint: Joint, how: FatigueAssessment, loads: np.ndarray) -> None:
    """Check that the fatigue of a joint can be assessed under the loads of its corners, shape (corners, loads).

    Raises
    ------
    InputError
        If no material has the constants, or the history has one corner or no cycle.
    """
    _assessed_sections(joint, how)
    if len(loads) < 2:
        raise InputError("fatigue", "needs a turning point: the history has one corner only")
    if how.over == "cycle" and not cycle_length(loads):
        raise InputError("over", "the history has no cycles: repeat = 2 in [joint] repeats its corners")


def check_crack(joint: Joint, crack: SectionCrack, corners: int) -> None:
    """Check that a crack can be followed in a joint under a history with so many corners.

    Raises
    ------
    InputError
        If the plate is infinite or has a bush, the crack leaves it, or is in a pin, there is no law of growth, or one
        corner only.
    """
    lug, _ = joint.lug(crack.pin, crack.plate)
    if joint.sections[joint.place(crack.pin, crack.plate)][0].bush_in(crack.plate) is not None:
        raise InputError("pin", f"{crack.pin} has a bush in {crack.plate}: cracks need a hole without one")
    nothing = np.zeros((2 + 4 * LEAST_ORDER,) * 2)  # the outline is what counts
    body = Compliance(lug.nu, lug.plane, lug.hole_radius, nothing, outline=json.dumps(lug.document()))
    problem = joint.problem(*joint.sections[joint.place(crack.pin, crack.plate)])
    crack_model.check_crack(replace(problem, plate_body=body), crack.how)
    if corners < 2:
        raise InputError("crack", "needs a turning point: the history has one corner only")


def check_wear(wear: Wear, values: np.ndarray) -> None:
    """Check that a joint may wear under the loads of its corners, shape (corners, loads).

    Raises
    ------
    InputError
        If the history has no cycle, or too many cycles are asked for.
    """
    length = cycle_length(values)
    if not length:
        raise InputError("wear", "the history has no cycles: repeat = 2 in [joint] repeats its corners")
    whole_number("cycles", wear.cycles, 1, MAX_CORNERS // length - 2)


def cycle_length(loads: np.ndarray) -> int:
    """Corners of the shortest run at the end of a history that repeats the loads before; 0 without one."""
    lengths = range(2, len(loads) // 2 + 1)
    return next((n for n in lengths if np.array_equal(loads[-n:], loads[-2 * n : -n])), 0)


def _assessed_sections(joint: Joint, how: FatigueAssessment) -> list[int]:
    """The places of the sections whose fatigue can be assessed. Without any, the error of the first one is raised."""
    known, errors = [], []
    for place, section in enumerate(joint.sections):
        try:
            check_assessment(joint.problem(*section), how)
            known.append(place)
        except InputError as error:
            errors.append(error)
    if not known:
        raise errors[0]
    return known
