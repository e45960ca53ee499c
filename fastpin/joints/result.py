"""The result of a joint: its states at the corners of a load history, and the contact of every pin in every plate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fastpin.joints.parts import Joint
from fastpin.model.checks import known_name
from fastpin.states.state import State


@dataclass(frozen=True, eq=False)
class JointState:
    """The state of a joint at one corner.

    Attributes
    ----------
    joint : Joint
    step : int
        Number of the corner, from 0.
    load : dict of str to float
        Forces, N, and stresses, Pa, by the names of ``joint.load_names``.
    contacts : tuple of State
        The contact of each pin in each of its plates, in the order of ``joint.sections``. Their loads P, Q and M are
        what the pin passes on to this plate. Slip counts from the place where the pin, straight from the middle, first
        rested on the hole. Work and energy are NaN: they belong to the whole joint.
    forces : ndarray, shape (sections, 2)
        Force of the pin on the plate along x and y, N.
    moved : ndarray, shape (plates, 3)
        Displacement of the supports of each plate along x and y, m, and its rotation, rad; 0 where they are fixed. Of a
        plate that is free it is the mean motion of the outline, at the place of its first pin.
    residuals : dict of str to float
        Largest violations of the contact conditions and of the equilibrium of every pin and plate, relative, recomputed
        from the matrices.
    """

    joint: Joint
    step: int
    load: dict[str, float]
    contacts: tuple[State, ...]
    forces: np.ndarray
    moved: np.ndarray
    residuals: dict[str, float]

    def __getitem__(self, names: tuple[str, str]) -> State:
        """The contact of a pin in a plate, by both names: ``state["A", "skin"]``."""
        return self.contacts[self.joint.place(*names)]

    def __repr__(self) -> str:
        acting = ", ".join(f"{name} {value:g}" for name, value in self.load.items() if value) or "no load"
        return f"<JointState at corner {self.step}: {acting}>"

    @property
    def moments(self) -> np.ndarray:
        """Moment of each pin on each plate, N m, shape (sections,)."""
        thickness = np.array([plate.thickness for _, plate in self.joint.sections])
        return np.array([each.load["M"] for each in self.contacts]) * thickness

    def shares(self, plate: str) -> dict[str, float]:
        """The part of the force that the plate takes from each pin, by name, along the sum of these forces.

        NaN where the pins do not load the plate together. An unknown plate raises :class:`InputError`.
        """
        known_name("plate", plate, [each.name for each in self.joint.plates])
        found = {
            pin.name: self.forces[place] for place, (pin, of) in enumerate(self.joint.sections) if of.name == plate
        }
        whole = np.sum(list(found.values()), axis=0)
        size = float(whole @ whole)
        largest = max(float(force @ force) for force in found.values())
        if not size > 1e-12 * largest:
            return dict.fromkeys(found, float("nan"))
        return {name: float(force @ whole) / size for name, force in found.items()}


@dataclass(frozen=True, eq=False)
class JointResult(Sequence[JointState]):
    """The states of a joint at the corners of a load history.

    Attributes
    ----------
    joint : Joint
    states : tuple of JointState
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
    states: tuple[JointState, ...]
    nodes: int
    harmonics: tuple[int, ...]
    snaps: int
    seconds: float

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, place):  # type: ignore[no-untyped-def]
        return self.states[place]

    def __iter__(self) -> Iterator[JointState]:
        return iter(self.states)

    def __repr__(self) -> str:
        pins, plates = len(self.joint.pins), len(self.joint.plates)
        return f"<JointResult: {pins} pins, {plates} plates, {len(self)} states, {self.nodes} nodes a contact>"

    def of(self, pin: str, plate: str) -> list[State]:
        """The states of one pin in one plate. Unknown names raise :class:`InputError`."""
        place = self.joint.place(pin, plate)
        return [state.contacts[place] for state in self.states]

    def shares(self, plate: str) -> dict[str, np.ndarray]:
        """The share of each pin in the force on a plate at every state, by name; see :meth:`JointState.shares`."""
        rows = [state.shares(plate) for state in self.states]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}

    @cached_property
    def first_touches(self) -> dict[tuple[str, str], int]:
        """The first corner at which each pin touches each plate, by both names; -1 where it never does at a corner."""
        found = {}
        for place, (pin, plate) in enumerate(self.joint.sections):
            touching = [state.step for state in self.states if state.contacts[place].in_contact]
            found[pin.name, plate.name] = touching[0] if touching else -1
        return found
