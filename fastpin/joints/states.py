"""States of a joint from configurations, after their conditions were checked."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fastpin.bodies.compliance import COLUMNS
from fastpin.elasticity.interfaces import TURN
from fastpin.errors import InputError
from fastpin.joints.conditions import CENTRING, PinSection
from fastpin.joints.faying import NORMALS, rim_basis
from fastpin.joints.hole import HoleInPlate, in_hole
from fastpin.joints.parts import Joint
from fastpin.joints.result import FayingState, JointState
from fastpin.joints.system import PinsSystem
from fastpin.kernels.status import OPEN, SLIP_POSITIVE
from fastpin.lugs.several_holes import HolesCompliance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS
from fastpin.solver.configuration import MAX_RESIDUAL, Configuration, review
from fastpin.solver.errors import ConvergenceError
from fastpin.states.state import State

ROUNDED = 1e-13
"""Entries of the compliance of a hole below this are rounding: those of a hole far from any other."""


@dataclass(frozen=True, eq=False)
class Since:
    """What has happened to a joint since the start, beside its configuration.

    Attributes
    ----------
    dissipated : ndarray, shape (sections,)
        Energy that friction has dissipated at each interface, J/m.
    rubbed : ndarray, shape (surfaces,)
        Energy that friction has dissipated at each faying surface, J.
    rest : ndarray, shape (sections, 2)
        Where the inner body first rested on the outer one of each interface, dimensionless; NaN before.
    """

    dissipated: np.ndarray
    rubbed: np.ndarray
    rest: np.ndarray

    @classmethod
    def start(cls, sections: int, surfaces: int) -> Since:
        """Nothing yet, for so many sections and faying surfaces."""
        return cls(np.zeros(sections), np.zeros(surfaces), np.full((sections, 2), np.nan))

    def copy(self) -> Since:
        """A copy."""
        return Since(self.dissipated.copy(), self.rubbed.copy(), self.rest.copy())


class StateMaker:
    """Makes the states of a joint.

    Parameters
    ----------
    joint : Joint
    system : PinsSystem
    plates : list of HolesCompliance

    Attributes
    ----------
    holes : list of HoleInPlate
        The hole of each section of the joint, without loads.
    """

    def __init__(self, joint: Joint, system: PinsSystem, plates: list[HolesCompliance]) -> None:
        self._joint, self._system, self._plates = joint, system, plates
        self._around = {ring.inner: ring.outer for ring in system.rings}
        self.holes = [self._hole(system.sections[self._around.get(k, k)]) for k in range(len(joint.sections))]

    def state(
        self, now: Configuration, since: Since, residuals: dict[str, float], step: int, load: dict[str, float]
    ) -> JointState:
        """The state of a configuration with these :func:`residuals <residuals_of>` at a corner, under a `load`, SI.

        What has happened up to the corner before stands in `since`, to which this step is added.

        Raises
        ------
        ConvergenceError
            If the configuration violates the contact conditions, or the equilibrium of a pin or a plate.
        """
        system, scales = self._system, self._system.scales
        worst = max(residuals, key=lambda name: residuals[name])
        if not residuals[worst] <= MAX_RESIDUAL:
            words = f"the state violates the contact conditions ({worst} by {residuals[worst]:.2g}) and is not returned"
            raise ConvergenceError(words, fraction=1.0)
        passed, count = system.passed(now.tractions), len(self._joint.sections)
        interfaces = [self._contact(now, since, step, place, residuals) for place in range(len(passed))]
        contacts = [self._whole(now, place, interfaces) for place in range(count)]
        thickness = np.array([[each.problem.thickness] for each in system.sections[:count]], dtype=float)
        moved = np.zeros((len(self._plates), 3))
        units = np.array([scales.displacement, scales.displacement, scales.rotation])
        for motion, by in zip(system.given.moving, now.motion[3 * len(passed) :], strict=True):
            moved[motion.plate] += by * units * motion.at(0j)
        forces = passed[:count, :2] * scales.force * thickness
        load = load | self._reactions(now)
        return JointState(self._joint, step, load, tuple(contacts), forces, moved, residuals, self._faying(now, since))

    def _reactions(self, now: Configuration) -> dict[str, float]:
        """The forces where displacements are given, N, by their names."""
        system, found = self._system, {}
        names, unit = self._joint.load_names, system.scales.force * self._joint.plates[0].thickness
        of = {given: name for name, given in self._joint.reactions.items()}
        for row, (load, left) in enumerate(zip(system.driven, left_on_bodies(system, now), strict=True)):
            if load >= 0:
                found[of[names[load]]] = float(left if row < 3 * len(system.sections) else -left) * unit
        return found

    def _faying(self, now: Configuration, since: Since) -> tuple[FayingState, ...]:
        """The faying surfaces of clamped plates."""
        system, scales, found = self._system, self._system.scales, []
        thick = self._joint.plates[0].thickness
        for place, (force, sides) in enumerate(zip(system.rubbed(now.tractions), system.sides, strict=True)):
            lost = float(now.slip_tally.sums[1, sides].sum()) * scales.force * scales.displacement * thick
            since.rubbed[place] += lost
            slip = 0.0 - (NORMALS @ now.slip[sides]) * scales.displacement
            found.append(FayingState(force * scales.force * thick, slip, float(since.rubbed[place])))
        return tuple(found)

    def _contact(self, now: Configuration, since: Since, step: int, place: int, residuals: dict[str, float]) -> State:
        """The contact of one pin in one plate."""
        system, scales = self._system, self._system.scales
        nodes, grid, problem = system.nodes.parts[place], system.nodes.grids[place], system.sections[place].problem
        passed, (x, y, turned) = system.passed(now.tractions)[place], now.motion[3 * place : 3 * place + 3]
        status = now.status[nodes].copy()
        if problem.frictionless:
            status = np.where(status == OPEN, OPEN, SLIP_POSITIVE).astype(np.int8)
        first = since.rest[place]
        if (status != OPEN).any() and np.isnan(first).any():
            first[:] = _resting_place(system.initial_gap[nodes], grid, x, y)
        rest = np.zeros(2) if np.isnan(first).any() else first
        datum = (rest[1] * np.cos(grid.theta) - rest[0] * np.sin(grid.theta)) * scales.displacement
        tally: dict[str, Any] = {**now.slip_tally.part(np.arange(nodes.start, nodes.stop)).fields(scales)}
        for name in ("slip_lowest", "slip_highest"):
            tally[name] = tally[name] - datum
        since.dissipated[place] += float(grid.weights @ tally["friction_energy"]) * problem.hole_radius
        load = dict.fromkeys(LOADS, 0.0)
        load["Q"], load["P"] = float(passed[0]) * scales.force, -float(passed[1]) * scales.force
        load["M"] = float(passed[2]) * scales.force * self._joint.radius
        return State(
            step=step, fraction=1.0, load=load, theta=grid.theta, pressure=now.pressure[nodes] * scales.traction,
            shear=now.shear[nodes] * scales.traction, gap=now.gap[nodes] * scales.displacement,
            slip=now.slip[nodes] * scales.displacement - datum, status=status, dx=float(x) * scales.displacement,
            dy=float(y) * scales.displacement, rotation=float(turned) * scales.rotation,
            dissipation=float(since.dissipated[place]), work=math.nan, energy=math.nan, residuals=residuals,
            problem=problem, grid=grid, **tally,
        )  # fmt: skip

    def _whole(self, now: Configuration, place: int, interfaces: list[State]) -> State:
        """The state of a pin in a plate, which has that of its bush."""
        own, outer, seat = interfaces[place], self._around.get(place, place), None
        if outer != place:
            seat = replace(interfaces[outer], load=own.load)
        whole = replace(own, problem=self._joint.problem(*self._joint.sections[place]), seat=seat)
        return in_hole(whole, self._body(now, outer, self.holes[place]))

    def _body(self, now: Configuration, place: int, hole_alone: HoleInPlate) -> HoleInPlate:
        """The hole of a contact, with what the other pins and the loads of the plate do to its edge."""
        system, scales, section = self._system, self._system.scales, self._system.sections[place]
        plate, size = self._plates[section.plate], len(hole_alone.matrix)
        loads, on_holes = np.zeros(len(COLUMNS)), np.zeros((plate.holes, size))
        of_slices = np.zeros(size)  # mean tractions of all slices here, less those of this one
        for at, integrals in system.integrals.items():
            other, nodes = system.sections[at], system.nodes.parts[at]
            own = float(other is section)  # the matrix of the hole knows its own tractions
            if felt := section.felt(other, plate.holes) - own:
                onto = of_slices if other.hole == section.hole else on_holes[other.hole]
                onto += felt * (integrals @ np.concatenate([now.pressure[nodes], now.shear[nodes]]))
        for surface, sides in zip(system.faying, system.sides, strict=True):
            for other, sign in ((system.sections[at], sign) for at, sign in surface.signs):
                if other.plate == section.plate:
                    width = other.thickness * other.radius
                    on_holes[other.hole] += rim_basis(size, sign, width)[1] @ now.shear[sides]
        incoming = hole_alone.matrix @ of_slices
        for hole, coefficients in enumerate(on_holes):
            incoming += plate.block(section.hole, hole) @ coefficients
        for of, name, load in system.given.columns:
            if of == section.plate:
                loads[COLUMNS.index(name)] = now.load[len(LOADS) + load]
                incoming += plate.column(name, section.hole) * now.load[len(LOADS) + load]
        unit, others = scales.traction, np.delete(on_holes, section.hole, axis=0)
        return hole_alone.under(
            incoming=incoming * unit, others=others * unit, loads=loads * unit, rubbed=on_holes[section.hole] * unit
        )

    def _hole(self, section: PinSection) -> HoleInPlate:
        """The hole of a section, without loads."""
        plate, problem = self._plates[section.plate], section.problem
        matrix = plate.block(section.hole, section.hole).copy()
        matrix[np.abs(matrix) < ROUNDED] = 0.0
        try:
            return HoleInPlate(problem.pair.plate.nu, problem.pair.plane, problem.hole_radius, matrix)
        except InputError as error:
            raise InputError(
                "harmonics", f"too few for {self._joint.plates[section.plate].name}: {error.reason}"
            ) from None


def _resting_place(gap: np.ndarray, grid: Grid, x: float, y: float) -> np.ndarray:
    """Where a rigid pin rests that goes from the middle of a hole with the `gap` (n,) towards (x, y), shape (2,)."""
    way = math.hypot(x, y)
    if not way:
        return np.zeros(2)
    ahead = (np.cos(grid.theta) * x + np.sin(grid.theta) * y) / way
    is_round = gap.min() == gap.max()
    reach = gap.max() if is_round else np.divide(gap, ahead, out=np.full_like(gap, np.inf), where=ahead > 0.0).min()
    return float(reach) / way * np.array([x, y])


def residuals_of(system: PinsSystem, now: Configuration) -> dict[str, float]:
    """Residuals of the contact conditions, and of the equilibrium of all pins and plates, by name."""
    return review(system.resting(now.rest), now).residuals | {"bodies": unbalanced(system, now)}


def unbalanced(system: PinsSystem, now: Configuration) -> float:
    """The largest force or moment that is left on a pin, a ring or a plate, relative to what contacts and loads carry.

    It is recomputed from the tractions and the springs of loose pins, without the conditions of the solver. Where a
    displacement is given, a reaction is left.
    """
    left = np.abs(left_on_bodies(system, now)[system.driven < 0])
    rubbed = np.abs(system.rubbed(now.tractions)).ravel()
    size = float(max(*(np.abs(system.resultants) @ np.abs(now.tractions)), *rubbed))
    return float(left.max(initial=0.0)) / size if size else 0.0


def left_on_bodies(system: PinsSystem, now: Configuration) -> np.ndarray:
    """What contacts, friction, springs and loads leave on each pin, ring and plate that moves, shape (m,).

    It stands in the places of their conditions. A pin passes on more than acts on it where it is positive.
    """
    load, count, rubbed = now.load[len(LOADS) : -2], len(system.sections), system.rubbed(now.tractions)
    passed, motion = system.passed(now.tractions), (now.motion - now.rest)[: 3 * count].reshape(count, 3)
    pushed = np.array([[each.thickness] for each in system.sections]) * (passed + CENTRING * motion)
    left = np.zeros(system.motions)
    for pin, members in enumerate(system.pins):
        head = 3 * members[0]
        left[head : head + 3] = pushed[members].sum(axis=0)
        left[head : head + 2] -= system.given.pins[pin] @ load
        left[head + TURN] *= not system.is_smooth(pin)
    for ring in system.rings:
        is_smooth = all(system.sections[place].problem.frictionless for place in (ring.inner, ring.outer))
        left[3 * ring.outer : 3 * ring.outer + 3] = pushed[ring.outer] - pushed[ring.inner]
        left[3 * ring.outer + TURN] *= not is_smooth
    within = {ring.inner for ring in system.rings}
    for row, (motion, force) in enumerate(zip(system.given.moving, system.given.plates @ load, strict=True), 3 * count):
        of = [each for place, each in enumerate(zip(system.sections, pushed, strict=True)) if place not in within]
        left[row] = sum(push @ motion.at(each.at) for each, push in of if each.plate == motion.plate) + force
        for surface, friction in zip(system.faying, rubbed, strict=True):
            for each, sign in ((system.sections[at], sign) for at, sign in surface.signs):
                left[row] += sign * float(friction @ motion.at(each.at)[:2]) if each.plate == motion.plate else 0.0
    return left
