"""Pairs of cases with a known relation: turned, mirrored, scaled, split and renumbered.

:func:`compare` solves a random case, and a changed case for every relation, on the same nodes. The states must agree.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.bodies.body import PlateBody
from fastpin.bodies.compliance import Compliance
from fastpin.errors import FastpinError
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS, ROTATION, SXX, SXY, SYY, UX, UY, M, P, Q
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile
from fastpin.model.profile_terms import Crown, Flat, Harmonic, Samples, Term, Zone
from fastpin.solver.configuration import MAX_RESIDUAL
from fastpin.solver.errors import ResolutionError
from fastpin.solver.first_contact import BESIDE_END, GROWN_NODES
from fastpin.solver.solving import solve
from fastpin.states.state import State
from tests.survey.histories import generate
from tests.survey.random_histories import ending_of, within_time

CLASSES = ("general", "extreme", "moderate_stress", "fixed", "remote", "bodies", "gap", "drift")
"""Classes whose cases are compared."""

MOST_NODES = 300
"""Cases with more nodes are left out."""

TOLERANCE = 1e-8
"""Largest relative difference of two states."""

WORK = 2
"""Place of the work among the energies."""


@dataclass
class Fields:
    """What is compared of a state, in the frame of the first case: arrays (n,), and the motion (dx, dy, rotation)."""

    arrays: dict[str, np.ndarray]
    motion: np.ndarray
    energies: np.ndarray


@dataclass
class Changed:
    """A changed case, and the way back from its states to the first case.

    Attributes
    ----------
    loads : ndarray, shape (corners, loads)
    places : ndarray of int
        The corners that correspond to the corners of the first case.
    order : ndarray of int
        The node of the changed grid at each node of the first.
    sign : float
        -1 for a mirrored case.
    angle : float
        Angle of a turned case, rad.
    traction, displacement, radius : float
        Factors of a scaled case.
    split : int
        Number of corners that are solved first; 0 for all.
    """

    problem: Problem
    loads: np.ndarray
    grid: Grid
    places: np.ndarray
    order: np.ndarray = field(default_factory=lambda: np.array([], dtype=int))
    sign: float = 1.0
    angle: float = 0.0
    traction: float = 1.0
    displacement: float = 1.0
    radius: float = 1.0
    split: int = 0

    def states(self, **options: Any) -> list[State]:
        """The states of the changed case at the corners of the first case."""
        history = LoadHistory.from_array(acting_loads(self.problem, self.loads))
        if self.split:
            first = solve(self.problem, history[: self.split], grid=self.grid, **options)
            states = [*first, *solve(self.problem, history[self.split :], start=first, **options)]
        else:
            states = solve(self.problem, history, grid=self.grid, **options).states
        return [states[place] for place in self.places]

    def fields(self, state: State) -> Fields:
        """The fields of a state, in the frame and units of the first case."""
        order = self.order if self.order.size else slice(None)
        scale = {"pressure": self.traction, "gap": self.displacement}
        arrays = {name: getattr(state, name)[order] / value for name, value in scale.items()}
        arrays["shear"] = self.sign * state.shear[order] / self.traction
        arrays["slip"] = self.sign * state.slip[order] / self.displacement
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        moved = np.array([cos * state.dx + sin * state.dy, cos * state.dy - sin * state.dx]) / self.displacement
        turned = self.sign * state.rotation * self.radius / self.displacement
        energy = self.traction * self.radius * self.displacement
        energies = np.array([state.dissipation, state.energy, state.work]) / energy
        return Fields(arrays, np.array([self.sign * moved[0], moved[1], turned]), energies)


def acting_loads(problem: Problem, loads: np.ndarray) -> np.ndarray:
    """The loads with NaN for the ones that can't act in the problem. Forces push the pin."""
    loads = loads.copy()
    loads[:, [UX, UY]] = np.nan
    if problem.held:
        loads[:, M] = np.nan
    else:
        loads[:, ROTATION] = np.nan
    if problem.pin_load == "body":
        loads[:, M] = np.nan
    return loads


def with_point(body: PlateBody, move: Callable[[complex], complex]) -> PlateBody:
    """A plate's body with its reaction point moved; with the same bush."""
    if isinstance(body, Bushing):
        inside = with_point(body.inside, move)
        assert isinstance(inside, (Plate, Ring))
        return replace(body, inside=inside)
    if isinstance(body, Plate) and body.reaction is not None:
        moved = move(complex(*body.reaction))
        return Plate((moved.real, moved.imag))
    return body


def enlarged(body: Any, radius: float, modulus: float, displacement: float) -> Any:
    """A body of pin or plate with all lengths times `radius`, and the moduli and interference of a bush scaled."""
    if isinstance(body, Bushing):
        return Bushing(
            body.material.scaled(modulus), body.outer_radius * radius, body.interference * displacement,
            enlarged(body.inside, radius, modulus, displacement),
        )  # fmt: skip
    if isinstance(body, Tube):
        return replace(body, bore_radius=body.bore_radius * radius)
    if isinstance(body, Ring):
        return replace(body, outer_radius=body.outer_radius * radius)
    if isinstance(body, Compliance):
        return replace(body, hole_radius=body.hole_radius * radius)
    return with_point(body, lambda point: point * radius)


def moved_gap(gap: InitialGap, angle: float, mirrored: bool = False) -> InitialGap:
    """A gap turned by `angle`, rad; or its mirror image, left and right exchanged."""
    return InitialGap(*(moved_profile(each, angle, mirrored) for each in (gap.hole, gap.pin)))


def moved_profile(profile: Profile, angle: float, mirrored: bool = False) -> Profile:
    """A profile turned by `angle`, rad; or its mirror image, left and right exchanged."""
    return Profile(tuple(_moved(term, angle, mirrored) for term in profile.terms))


def _moved_friction(problem: Problem, angle: float, mirrored: bool = False) -> float | Profile:
    """The friction of a problem turned by `angle`, rad; or its mirror image."""
    friction = problem.friction
    return moved_profile(friction, angle, mirrored) if isinstance(friction, Profile) else friction


def _moved(term: Term, angle: float, mirrored: bool) -> Term:
    """A term of a profile turned by `angle`, rad; or its mirror image."""
    if isinstance(term, Harmonic):
        wave = complex(term.cosine, -term.sine) * cmath.exp(-1j * term.order * angle)
        if mirrored:  # theta becomes -pi - theta
            wave = (wave * (-1.0) ** term.order).conjugate()
        return Harmonic(term.order, wave.real, -wave.imag)
    if isinstance(term, Samples):
        angles, heights = np.array(term.angles), np.array(term.heights)
        return Samples(-math.pi - angles[::-1], heights[::-1]) if mirrored else Samples(angles + angle, heights)
    if isinstance(term, Zone):
        ends = (-math.pi - term.stop, -math.pi - term.start) if mirrored else (term.start + angle, term.stop + angle)
        return Zone(term.value, *ends)
    assert isinstance(term, (Crown, Flat))
    return replace(term, centre=-math.pi - term.centre if mirrored else term.centre + angle)


def enlarged_gap(gap: InitialGap, factor: float) -> InitialGap:
    """A gap times a factor, without flats."""

    def times(term: Term) -> Term:
        if isinstance(term, Harmonic):
            return Harmonic(term.order, factor * term.cosine, factor * term.sine)
        if isinstance(term, Samples):
            return Samples(term.angles, factor * np.array(term.heights))
        assert isinstance(term, Crown)
        return replace(term, height=factor * term.height)

    return InitialGap(*(Profile(tuple(map(times, each.terms))) for each in (gap.hole, gap.pin)))


def has_side(problem: Problem) -> bool:
    """Whether the plate has a side that does not turn with the load."""
    lug = problem.plate_body.lug
    return isinstance(lug, Compliance) or (isinstance(lug, Ring) and lug.support == "half")


def turned(rng: np.random.Generator, problem: Problem, loads: np.ndarray, grid: Grid) -> Changed:
    """All turned by any angle."""
    angle = rng.uniform(-math.pi, math.pi)
    cos, sin = math.cos(angle), math.sin(angle)
    new = loads.copy()
    new[:, Q], new[:, P] = cos * loads[:, Q] + sin * loads[:, P], cos * loads[:, P] - sin * loads[:, Q]
    xx, yy, xy = loads[:, SXX], loads[:, SYY], loads[:, SXY]
    new[:, SXX] = cos * cos * xx + sin * sin * yy - 2.0 * sin * cos * xy
    new[:, SYY] = sin * sin * xx + cos * cos * yy + 2.0 * sin * cos * xy
    new[:, SXY] = sin * cos * (xx - yy) + (cos * cos - sin * sin) * xy
    plate = with_point(problem.plate_body, lambda point: point * complex(cos, sin))
    friction = _moved_friction(problem, angle)
    problem = replace(problem, plate_body=plate, gap=moved_gap(problem.gap, angle), friction=friction)
    return Changed(problem, new, Grid(grid.theta + angle, grid.closed), np.arange(len(loads)), angle=angle)


def mirrored(rng: np.random.Generator, problem: Problem, loads: np.ndarray, grid: Grid) -> Changed:
    """Left and right exchanged."""
    del rng
    new, n = loads.copy(), grid.size
    new[:, [Q, M, SXY, ROTATION]] *= -1.0
    order = np.arange(n)[::-1]
    plate = with_point(problem.plate_body, lambda point: -point.conjugate())
    friction = _moved_friction(problem, 0.0, mirrored=True)
    problem = replace(
        problem, plate_body=plate, gap=moved_gap(problem.gap, 0.0, mirrored=True), friction=friction
    )  # fmt: skip
    return Changed(
        problem, new, Grid(-math.pi - grid.theta[::-1], grid.closed), np.arange(len(loads)), order, sign=-1.0
    )


def scaled(rng: np.random.Generator, problem: Problem, loads: np.ndarray, grid: Grid) -> Changed:
    """All loads and the clearance times a factor; in half of the cases another radius and other moduli too."""
    factor = 10.0 ** rng.uniform(-3.0, 3.0)
    radius, modulus = (10.0 ** rng.uniform(-3.0, 0.0), 10.0 ** rng.uniform(0.0, 11.0)) if rng.random() < 0.5 else (1, 1)
    pair = problem.pair
    bodies = (Material(body.E * modulus, body.nu) for body in (pair.pin, pair.plate))
    displacement = factor * radius / modulus
    hub = None if problem.hub_radius is None else problem.hub_radius * radius
    spring = None if problem.hub_stiffness is None else problem.hub_stiffness * radius**2 * modulus
    new_problem = replace(
        problem, pair=MaterialPair(*bodies, pair.plane), hole_radius=problem.hole_radius * radius,
        clearance=problem.clearance * displacement, hub_radius=hub, hub_stiffness=spring,
        pin_body=enlarged(problem.pin_body, radius, modulus, displacement),
        plate_body=enlarged(problem.plate_body, radius, modulus, displacement),
        gap=enlarged_gap(problem.gap, displacement),
    )  # fmt: skip
    factors = dict.fromkeys(LOADS, factor) | {"rotation": factor / modulus, "friction_change": 1.0}
    factors |= {"P": factor * radius, "Q": factor * radius, "M": factor * radius**2}
    new = loads * np.array([factors[name] for name in LOADS])
    return Changed(
        new_problem, new, grid, np.arange(len(loads)), traction=factor, displacement=displacement, radius=radius
    )


def split(rng: np.random.Generator, problem: Problem, loads: np.ndarray, grid: Grid) -> Changed:
    """One more corner inside a step, where the solution is cut in two."""
    step, part = int(rng.integers(len(loads))), rng.uniform(0.1, 0.9)
    before = loads[step - 1] if step else np.zeros(loads.shape[1])
    new = np.insert(loads, step, before + part * (loads[step] - before), axis=0)
    places = np.delete(np.arange(len(new)), step)
    return Changed(problem, new, grid, places, split=step + 1)


def renumbered(rng: np.random.Generator, problem: Problem, loads: np.ndarray, grid: Grid) -> Changed:
    """The circle begins at another node. An arc becomes a circle with one wide interval first."""
    first = int(rng.integers(1, grid.size - 1))
    theta = np.r_[grid.theta[first:], grid.theta[:first] + 2.0 * math.pi]
    order = (np.arange(grid.size) - first) % grid.size
    return Changed(problem, loads, Grid(theta, closed=True), np.arange(len(loads)), order)


RELATIONS: dict[str, Callable[[np.random.Generator, Problem, np.ndarray, Grid], Changed]] = {
    function.__name__: function for function in (turned, mirrored, scaled, split, renumbered)
}
"""The relations, by name."""


@dataclass
class Sizes:
    """Sizes of a case that its states may not show.

    Attributes
    ----------
    force : float
        Largest force or moment. Work is a small difference of large products of force and motion.
    interference : float
        Interference of a pressed pin. Its motion is a small difference of such lengths.
    stiffness : float
        Traction for a displacement that changes its sign from node to node, over this displacement.
    unbalanced : float
        Part of a work that may differ, see :func:`imbalance`.
    """

    force: float = 0.0
    interference: float = 0.0
    stiffness: float = 0.0
    unbalanced: float = 0.0

    @classmethod
    def of(cls, problem: Problem, loads: np.ndarray, grid: Grid) -> Sizes:
        """The sizes of a case on a grid."""
        wave = math.pi / (problem.hole_radius * float(np.diff(grid.theta).min()))
        force = float(np.abs(loads[:, [P, Q, M]]).max())
        return cls(force, max(-problem.clearance, 0.0), wave / problem.surfaces.beta_star)


def differences(one: list[Fields], two: list[Fields], sizes: Sizes) -> tuple[np.ndarray, np.ndarray]:
    """Largest relative difference of each pair of states, shape (states,), and the same of a pin that floats.

    The second holds the position of a pin without contact, and the rotation since it floated first. Sizes are the
    largest of all states. The solver accepts displacements that miss by MAX_RESIDUAL of the largest one, and the
    tractions differ by so much times the stiffness.
    """
    largest_of = {name: max(float(np.abs(f.arrays[name]).max()) for f in one) for name in one[0].arrays}
    moved = max(float(np.abs(f.motion).max()) for f in one)
    length = max(largest_of["gap"], largest_of["slip"], moved, sizes.interference, 1e-300)
    traction = max(largest_of["pressure"], MAX_RESIDUAL / TOLERANCE * sizes.stiffness * length, 1e-300)
    energy = max(*(float(np.abs(f.energies).max()) for f in one), sizes.force * moved, 1e-300)
    size = {"pressure": traction, "shear": traction, "gap": length, "slip": length}
    apart, floating = np.zeros(len(one)), np.zeros(len(one))
    floated = False
    for place, (a, b) in enumerate(zip(one, two, strict=True)):
        touches = bool(a.arrays["pressure"].any()) and bool(b.arrays["pressure"].any())
        floated |= not touches
        arrays = [float(np.abs(a.arrays[name] - b.arrays[name]).max()) / size[name] for name in size]
        motion = np.abs(a.motion - b.motion) / length
        off = np.abs(a.energies - b.energies)
        off[WORK] = max(off[WORK] - sizes.unbalanced, 0.0)
        energies = float(off.max()) / energy
        apart[place] = max(*arrays, motion[:2].max(), energies) if touches else energies
        floating[place] = motion[2] if touches else max(*arrays, motion.max())
        if not floated:
            apart[place], floating[place] = max(apart[place], floating[place]), 0.0
    return apart, floating


@dataclass
class Pair:
    """The outcome of one pair.

    Attributes
    ----------
    ending : str
        "compared", or the reason why the pair was not.
    difference, floating : float
        Largest difference of the states, and of a floating pin, see :func:`differences`.
    state : int
        The first state that differs; -1 if none.
    jumps : float
        Snaps of the first case.
    """

    kind: str
    seed: int
    relation: str
    ending: str
    difference: float = 0.0
    floating: float = 0.0
    state: int = -1
    jumps: float = 0.0


def with_room(grid: Grid) -> Grid:
    """An arc with so many nodes more on either side that a young contact has the room that it has on a circle.

    The slip of the first nodes is that of a contact grown on trial, which stays away from the ends of an arc.
    """
    if grid.closed:
        return grid
    more = (GROWN_NODES + BESIDE_END + 1) // 2
    first, last = np.diff(grid.theta)[[0, -1]]
    steps = np.arange(1, more + 1)
    theta = np.r_[grid.theta[0] - first * steps[::-1], grid.theta, grid.theta[-1] + last * steps]
    return Grid(theta) if np.ptp(theta) < 2.0 * math.pi - max(first, last) else grid


def imbalance(found: list[Fields]) -> float:
    """Largest difference of work from energy and dissipation in all states.

    A step that begins the contact takes the sum of both as its work, and the rest of a step that is cut there adds its
    own integral. The compliances of some bodies are symmetric up to the error of the nodes only.
    """
    return max(abs(each.energies[WORK] - each.energies[:WORK].sum()) for each in found)


def compare(kind: str, seed: int, relations: tuple[str, ...] = tuple(RELATIONS)) -> list[Pair]:
    """Solve a case and its changed cases, and compare the states."""
    case = generate(kind, seed)
    if case.problem.drive != "force":
        return [Pair(kind, seed, "", "driven")]
    loads = case.history.values()
    try:
        grid = solve(case.problem, case.history, **case.options).grid
    except FastpinError:
        return [Pair(kind, seed, "", "refused")]
    if grid.size > MOST_NODES:
        return [Pair(kind, seed, "", "large")]
    own, roomy = (Changed(case.problem, loads, each, np.arange(len(loads))) for each in (grid, with_room(grid)))
    try:
        result, wider = (solve(case.problem, case.history, grid=each.grid) for each in (own, roomy))
    except FastpinError as error:
        return [Pair(kind, seed, "", f"refused on its own grid: {ending_of(error)}")]
    sizes = Sizes.of(case.problem, loads, grid)
    pairs = []
    for relation in relations:
        if relation in ("turned", "mirrored") and has_side(case.problem):
            continue
        if relation == "scaled" and not case.problem.dimensionless:  # a flat has the shape that its lengths give
            continue
        rng = np.random.default_rng([seed, len(relation)])
        pair = Pair(kind, seed, relation, "compared", jumps=result.statistics["jumps"])
        pairs.append(pair)
        first, states = (roomy, wider) if relation == "renumbered" else (own, result)
        changed = RELATIONS[relation](rng, case.problem, loads, first.grid)
        try:
            others = changed.states()
        except FastpinError as error:
            is_narrow = relation == "split" and isinstance(error, ResolutionError)  # at the new corner
            pair.ending = "narrow" if is_narrow else f"one refused: {error}"
            continue
        one, two = [first.fields(a) for a in states], [changed.fields(b) for b in others]
        begins = changed.split and (changed.split == 1 or not result[changed.split - 2].in_contact)
        unbalanced = imbalance(one + two) if begins else 0.0
        apart, floating = differences(one, two, replace(sizes, unbalanced=unbalanced))
        pair.difference, pair.floating = float(apart.max()), float(floating.max())
        if pair.difference > TOLERANCE:
            pair.state = int(np.argmax(apart > TOLERANCE))
    return pairs


def compare_in_time(kind: str, seed: int) -> list[Pair]:
    """As :func:`compare`, with the ending "hang" after a long time."""
    return within_time(compare, kind, seed) or [Pair(kind, seed, "", "hang")]
