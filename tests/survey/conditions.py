"""The contact conditions of results, recomputed without the matrices of the solver.

:func:`check_states` checks the states of a result. :func:`check_direction` and :func:`check_dissipation` check the
way between states that lie close together. All read the public fields of states only. The displacements (9)-(12) are
integrals of the piecewise linear tractions by Gauss quadrature, graded towards the logarithm. The smooth terms of other
bodies share their coefficients with the solver, not their sums.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from fastpin.bodies import Tube
from fastpin.elasticity.terms import body_terms
from fastpin.errors import FastpinError
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, THERMAL
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap
from fastpin.model.profile_terms import Crown, Flat, Harmonic
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.solver.task import reference_force
from fastpin.states.state import State

TOLERANCE = 1e-8
"""Largest relative violation of a condition that rounding explains."""

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(10)
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS
"""Gauss points and weights on (0, 1)."""

HALVINGS = 44
"""Halvings of a segment towards a logarithm at its end."""

CLOSER = 3
"""Times that an interval is divided by a hundred in search of the moment of a wrong slip."""

STOPS = 101
"""Places between two states at which a driven pin may float."""

RANK = 1e-8
"""Size of a further displacement by loads, in parts of the largest one, below which it is the sum of others."""

NEGLIGIBLE = 1e-10
"""Clearance, in parts of F beta*, that the solver takes for none."""

LEAST_LENGTH = 1e-6
"""Least size of displacements, in parts of the clearance: below it the clearance leaves no digits."""


def _graded_rule() -> tuple[np.ndarray, np.ndarray]:
    """Points and weights on (0, 1) for a logarithm at 0 or beyond."""
    ends = np.r_[0.0, 0.5 ** np.arange(HALVINGS, -1, -1)]
    lengths = np.diff(ends)[:, None]
    return (ends[:-1, None] + lengths * POINTS).ravel(), (lengths * WEIGHTS).ravel()


GRADED = _graded_rule()


class Integrals:
    """Displacements and resultants of piecewise linear tractions on the nodes of a result.

    Parameters
    ----------
    problem : Problem
    theta : ndarray, shape (n,)
    closed : bool
        Whether the nodes go all round.
    loaded : ndarray of bool, shape (n,)
        The nodes that ever carry tractions.
    """

    def __init__(self, problem: Problem, theta: np.ndarray, closed: bool, loaded: np.ndarray) -> None:
        self.problem, self.theta, self.loaded = problem, theta, np.flatnonzero(loaded)
        self.is_uniform = Grid(theta, closed).uniform
        pair, n = problem.surfaces, theta.size
        # 1/G and Kolosov's constant of pin and plate; the constants of (32).
        soft = [2.0 * (1.0 + body.nu) / body.E for body in (pair.pin, pair.plate)]
        strain = pair.plane == "strain"
        kappas = [
            3.0 - 4.0 * body.nu if strain and body.is_isotropic else (3.0 - body.nu) / (1.0 + body.nu)
            for body in (pair.pin, pair.plate)
        ]
        laminate = problem.joint.hole.laminate
        self.delta = 0.0 if laminate is None else laminate.delta
        self.pin, self.kappa_pin = soft[0], kappas[0]
        self.alpha = (kappas[1] - 1.0) * soft[1] - (kappas[0] - 1.0) * soft[0]
        self.beta = 0.5 * ((kappas[1] + 1.0) * soft[1] + (kappas[0] + 1.0) * soft[0])
        self.plate = problem.hole_radius * 0.25 * (kappas[1] + 1.0) * soft[1]  # R k'/(2G) of (42)
        share = 1.0 if problem.pin_load == "centre" else 0.5
        self.bodies = body_terms(problem)
        self.point = share * self.pin / (4.0 * math.pi)
        if self.bodies is not None:
            self.point = self.bodies.force_factor * self.beta
        first = np.arange(n if closed else n - 1)
        second = (first + 1) % n
        length = np.diff(np.r_[theta, theta[0] + 2.0 * math.pi])[first]
        self.moments = np.zeros((3, n))  # integrals of every hat times 1, cos, sin
        places = theta[first, None] + length[:, None] * POINTS
        self.waves = np.zeros((0, n), dtype=complex)  # integrals of every hat times exp(-i k theta)
        if self.bodies is not None:
            most = max(self.bodies.coefficients.shape[1], (len(self.bodies.matrix) + 2) // 4)
            self.waves = np.zeros((most, n), dtype=complex)
        for share, nodes in ((1.0 - POINTS, first), (POINTS, second)):
            for row, values in zip(self.moments, (np.ones_like(places), np.cos(places), np.sin(places)), strict=True):
                np.add.at(row, nodes, length * (values @ (WEIGHTS * share)))
            for k, row in enumerate(self.waves):
                np.add.at(row, nodes, length * (np.exp(-1j * k * places) @ (WEIGHTS * share)))
        self.direct, self.cross, *self.logs = np.zeros((4 if self.delta else 2, n, self.loaded.size))
        column = np.full(n, -1)
        column[self.loaded] = np.arange(self.loaded.size)
        for k in first[(column[first] >= 0) | (column[second] >= 0)]:
            self._add_segment(first[k], second[k], length[k], (column[first[k]], column[second[k]]))

    def _add_segment(self, start: int, stop: int, length: float, columns: tuple[int, int]) -> None:
        """Add the integrals over the segment between two nodes to the `columns` of its hats; -1 for none."""
        offsets = [(self.theta - self.theta[end] + math.pi) % (2.0 * math.pi) - math.pi for end in (start, stop)]
        for end, offset in zip((start, stop), offsets, strict=True):
            offset[end] = 0.0
        from_start = np.abs(offsets[0]) <= np.abs(offsets[1])
        nearest = np.where(from_start, *offsets)
        near = np.abs(nearest) < 0.99 * length
        for rows, (points, weights) in ((np.flatnonzero(~near), (POINTS, WEIGHTS)), (np.flatnonzero(near), GRADED)):
            phi = nearest[rows, None] - np.where(from_start[rows], 1.0, -1.0)[:, None] * length * points
            C, S = np.cos(phi), np.sin(phi)
            L, A = 2.0 * np.log(2.0 * np.abs(np.sin(0.5 * phi))), 0.5 * phi - 0.5 * math.pi * np.sign(phi)
            kernels = self.alpha * S * A - self.beta * C * L, self.alpha * C * A + self.beta * S * L
            kernels += (C * L, S * L) if self.delta else ()
            for matrix, values in zip((self.direct, self.cross, *self.logs), kernels, strict=True):
                near_hat, far_hat = length * (values @ np.column_stack([weights * (1.0 - points), weights * points])).T
                hats = np.where(from_start[rows], near_hat, far_hat), np.where(from_start[rows], far_hat, near_hat)
                for place, hat in zip(columns, hats, strict=True):
                    if place >= 0:
                        matrix[rows, place] += hat

    def elastic(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """v_r - u_r and u_theta - v_theta of (9)-(12), without the terms of the force (w)."""
        N, T = state.pressure[self.loaded], state.shear[self.loaded]
        scale = self.problem.hole_radius / (4.0 * math.pi)
        swelling = 0.5 * (self.kappa_pin + 1.0) * self.pin * float(self.moments[0] @ state.pressure)
        gap = scale * (self.direct @ N + self.cross @ T - swelling)
        slip = scale * (self.direct @ T - self.cross @ N)
        if self.delta:
            moved = self.anisotropic @ (N + 1j * T)
            gap, slip = gap + moved.real, slip - moved.imag
        return (gap, slip) if self.bodies is None else self._with_bodies(state, gap, slip)

    @cached_property
    def anisotropic(self) -> np.ndarray:
        """The term of a laminate between N + iT and v_r + i v_theta, shape (n, loaded); symmetric on equal spacings."""
        turn, logs = np.exp(-1j * self.theta), self.logs[0] + 1j * self.logs[1]
        factor = -self.problem.hole_radius * self.delta / (2.0 * math.pi)
        if not self.is_uniform:
            return np.asarray(factor * (turn**2)[:, None] * logs)
        across = np.outer(turn, turn[self.loaded].conj())
        return np.asarray(factor * np.outer(turn, turn[self.loaded]) * (across * logs).real)

    def _with_bodies(self, state: State, gap: np.ndarray, slip: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap and slip with the smooth terms of the bodies."""
        assert self.bodies is not None
        unit = self.problem.hole_radius * self.beta
        N, T = self.waves @ state.pressure, self.waves @ state.shear
        for k, (first, second, cross) in enumerate(self.bodies.coefficients.T):
            wave = np.exp(1j * k * self.theta)
            gap = gap + unit * (first * (wave * N[k]).real + cross * (wave * T[k]).imag)
            slip = slip + unit * (second * (wave * T[k]).real - cross * (wave * N[k]).imag)
        if not self.bodies.matrix.size:
            return gap, slip
        size = (len(self.bodies.matrix) - 2) // 4
        columns = [np.ones_like(self.theta) / math.sqrt(2.0)]
        forces = [N[0].real / math.sqrt(2.0), -T[0].real / math.sqrt(2.0)]
        for k in range(1, size + 1):
            columns += [np.cos(k * self.theta), np.sin(k * self.theta)]
            forces += [N[k].real, -N[k].imag, -T[k].real, T[k].imag]
        found = self.bodies.matrix @ np.array(forces) / math.pi
        moved = np.r_[found[:2], found[2:]]
        radial, turning = moved[0] * columns[0], moved[1] * columns[0]
        for k in range(size):
            radial = radial + moved[4 * k + 2] * columns[2 * k + 1] + moved[4 * k + 3] * columns[2 * k + 2]
            turning = turning + moved[4 * k + 4] * columns[2 * k + 1] + moved[4 * k + 5] * columns[2 * k + 2]
        return gap + unit * radial, slip - unit * turning

    def loads(self, load: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        """The parts of gap and slip that the loads determine: terms of the force (w), and remote stress (42)."""
        cos, sin = np.cos(self.theta), np.sin(self.theta)
        double, double_sin = np.cos(2.0 * self.theta), np.sin(2.0 * self.theta)
        if self.bodies is not None:
            return self._loads_of_bodies(load, cos, sin)
        total, oval, diagonal = load["sxx"] + load["syy"], load["sxx"] - load["syy"], 2.0 * load["sxy"]
        gap = self.plate * (0.5 * total + oval * double + diagonal * double_sin)
        slip = self.plate * (oval * double_sin - diagonal * double)
        return (
            gap + self.point * (load["P"] * sin - load["Q"] * cos),
            slip + self.point * (load["P"] * cos + load["Q"] * sin),
        )

    def _loads_of_bodies(
        self, load: Mapping[str, float], cos: np.ndarray, sin: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The same with other bodies: every load displaces the hole by a Fourier series."""
        assert self.bodies is not None
        moved = np.zeros(self.theta.size, dtype=complex)
        for place, column in self.bodies.columns.items():
            if place in THERMAL:  # the growth of the gap is given
                continue
            unit = self.beta if LOADS[place] in "PQ" else self.beta * self.problem.hole_radius
            half = column.size // 2
            for k in range(-half, half + 1):
                moved += unit * load[LOADS[place]] * column[half + k] * np.exp(1j * k * self.theta)
        gap = moved.real + self.point * (load["P"] * sin - load["Q"] * cos)
        return gap, -moved.imag + self.point * (load["P"] * cos + load["Q"] * sin)

    def resultants(self, state: State) -> tuple[np.ndarray, float]:
        """P, Q and M/R of the tractions, (50) and (51), shape (3,); and the resultant of their sizes."""
        one, cos, sin = self.problem.hole_radius * self.moments
        N, T = state.pressure, state.shear
        return np.array([cos @ T - sin @ N, sin @ T + cos @ N, -(one @ T)]), float(one @ (np.abs(N) + np.abs(T)))


def initial_gap(gap: InitialGap, theta: np.ndarray, radius: float) -> np.ndarray:
    """The initial gap, m, shape (n,), from the definitions of its terms.

    The value of a spline is the only one that is not computed anew.
    """
    total = np.zeros(theta.size)
    for term in (*gap.hole.terms, *gap.pin.terms):
        if isinstance(term, Harmonic):
            total += (complex(term.cosine, -term.sine) * np.exp(1j * term.order * theta)).real
        elif isinstance(term, Crown):
            away = np.angle(np.exp(1j * (theta - term.centre)))
            bump = term.height * np.cos(0.5 * math.pi * away / term.half_width) ** 2
            total += np.where(np.abs(away) < term.half_width, bump, 0.0)
        elif isinstance(term, Flat):
            along = np.cos(theta - term.centre)
            chord = (radius - term.depth) / np.where(along > 0.0, along, 1.0)
            total += np.where(along > 0.0, np.maximum(radius - chord, 0.0), 0.0)
        else:
            total += term.values(theta, radius)[0]
    return total


def integrals_of(states: Sequence[State]) -> Integrals:
    """The integrals for the states of one result."""
    loaded = np.any([(state.pressure != 0.0) | (state.shear != 0.0) for state in states], axis=0)
    return Integrals(states[0].problem, states[0].theta, states[0].grid.closed, loaded)


class Checked:
    """One state with its recomputed displacements."""

    def __init__(
        self, integrals: Integrals, state: State, grown: np.ndarray | float,
        moved: tuple[np.ndarray | float, np.ndarray | float] = (0.0, 0.0), remote: bool = True,
    ) -> None:  # fmt: skip
        self.state, self.problem, self.integrals = state, state.problem, integrals
        own = integrals.elastic(state)
        self.elastic = own[0] + moved[0], own[1] + moved[1]
        acting = state.load if remote else {**state.load, "sxx": 0.0, "syy": 0.0, "sxy": 0.0}
        self.loads = integrals.loads(acting)
        cos, sin = np.cos(state.theta), np.sin(state.theta)
        radius = self.problem.hole_radius
        # Gap and slip from the first resting position of the pin. The place of that position is not known.
        initial = initial_gap(self.problem.gap, state.theta, radius)
        resting = self.problem.assembled_clearance + initial + grown
        self.room = room_of(self.problem, resting if np.any(grown) else None)
        self.gap = resting - state.dx * cos - state.dy * sin + self.elastic[0] + self.loads[0]
        self.slip = radius * state.rotation + state.dy * cos - state.dx * sin + self.elastic[1] + self.loads[1]
        self.touches = bool(np.any(state.status != OPEN))
        least = LEAST_LENGTH if self.touches else 1.0
        self.length = max(
            *(float(np.abs(part).max()) for part in self.elastic), abs(state.dx), abs(state.dy),
            radius * abs(state.rotation), least * float(np.abs(resting).max()), 1e-300,
        )  # fmt: skip
        self.peak = max(float(np.abs(state.pressure).max()), 1e-300)

    @cached_property
    def conditions(self) -> dict[str, float]:
        """Largest relative violations of the conditions at this state alone."""
        state = self.state
        mu = self.problem.friction_at(state.theta) * (1.0 + state.load["friction_change"])
        most = max(float(mu.max()), 1.0)
        N, T, status, peak = state.pressure, state.shear, state.status, self.peak
        is_open, slips = status == OPEN, (status != OPEN) & (status != STICK)
        found = {
            "N >= 0": max(0.0, -N.min() / peak),
            "gap >= 0": max(0.0, -state.gap.min() / self.length),
            "N gap = 0": np.minimum(np.abs(N) / peak, np.abs(state.gap) / self.length).max(),
            "open": max(np.abs(N[is_open]).max(initial=0.0), np.abs(T[is_open]).max(initial=0.0)) / peak,
            "|T| <= mu N": max((np.abs(T) - mu * N).max(), 0.0) / (most * peak),
            "slipping": np.abs(T + status * mu * N)[slips].max(initial=0.0) / (most * peak),
        }
        forces, size = self.integrals.resultants(state)
        wrong = forces - np.array([state.load["P"], state.load["Q"], state.load["M"] / self.problem.hole_radius])
        free = self.problem.rotation == "free"
        if self.touches:
            found["equilibrium"] = np.abs(wrong[: 3 if free else 2]).max() / max(size, 1e-300)
        if not free and self.touches:
            turned = state.rotation - state.load["rotation"] - self.hub_turn(-float(forces[2]))
            found["rotation"] = abs(turned) * self.problem.hole_radius / self.length
        found["energy"] = abs(self.energy - state.energy) / max(size * self.length, 1e-300)
        return {name: float(value) for name, value in found.items()}

    def hub_turn(self, shear_force: float) -> float:
        """Rotation that a spring or a hub of a given radius adds; the force is R int T."""
        problem, integrals = self.problem, self.integrals
        force = shear_force / problem.hole_radius
        spring = 0.0 if problem.hub_stiffness is None else force * problem.hole_radius**2 / problem.hub_stiffness
        hub = problem.hub_radius
        if hub is None and isinstance(problem.pin_body, Tube):
            hub = problem.pin_body.bore_radius
        if hub is None:
            return spring
        factor = (problem.hole_radius / hub) ** 2 - (integrals.kappa_pin + 1.0)
        return spring + factor * integrals.pin / (4.0 * math.pi) * force

    @property
    def energy(self) -> float:
        """Energy of the tractions on their displacements, up to a part of the loads alone."""
        state = self.state
        parts = zip((state.pressure, state.shear), self.elastic, self.loads, strict=True)
        weights = self.problem.hole_radius * self.integrals.moments[0]
        return sum(float(weights @ (traction * (0.5 * own + given))) for traction, own, given in parts)


def room_of(problem: Problem, resting: np.ndarray | None = None) -> float:
    """Largest gap round the resting pin, m, of the problem or of worn gaps (n,); -1 where the hole grips the pin."""
    if resting is not None:
        return max(float(resting.max()), 0.0)
    return -1.0 if problem.is_gripped else max(map(abs, problem.clearances))


def floats(states: Sequence[State], grown: Sequence[np.ndarray]) -> bool:
    """Whether the pin loses contact at a state or may lose it between two. `grown` is the growth (n,) of the gap, m."""
    problem, theta = states[0].problem, states[0].theta
    resting = problem.assembled_clearance + initial_gap(problem.gap, theta, problem.hole_radius)
    room = room_of(problem, resting + np.max(grown, axis=0))
    pairs = pairwise(states)
    return not all(state.in_contact for state in states) or any(may_lose_contact(*pair, room) for pair in pairs)


def check_states(states: Sequence[State], grown: Sequence[np.ndarray] | None = None) -> list[dict[str, float]]:
    """Largest relative violation of each condition at each state. `grown` is the growth (n,) of the gap at each, m.

    "gap" and "slip" compare the fields of the states with the recomputed displacements. The first resting position of
    the pin is fitted once for all states. The slip may differ by its reference, which changes only where contact was
    lost.
    """
    if not states:
        return []
    integrals = integrals_of(states)
    growths = [0.0] * len(states) if grown is None else grown
    checked = [Checked(integrals, state, growth) for state, growth in zip(states, growths, strict=True)]
    found = [dict(one.conditions) for one in checked]
    left_out = negligible_clearance(states)
    if left_out:  # nothing grips the pin without load
        for one in checked:
            one.room = max(one.room, 0.0)
    _check_gaps(checked, found, left_out)
    _check_slips(checked, found)
    _check_energy_balance(checked, found)
    return found


def negligible_clearance(states: Sequence[State]) -> float:
    """The clearance or interference, m, that the solver takes for none; 0 where it takes all of it."""
    problem, loads = states[0].problem, np.array([[state.load[name] for name in LOADS] for state in states])
    least = NEGLIGIBLE * reference_force(problem, loads) * problem.surfaces.beta_star
    clearance = abs(problem.assembled_clearance)
    return clearance if clearance <= least and not problem.gap else 0.0


def _check_gaps(checked: list[Checked], found: list[dict[str, float]], left_out: float) -> None:
    """Compare the gaps. Before the first contact the pin is in the middle; its later datum is fitted.

    With an initial gap the pin may float beside the middle. Then it is not judged. The gaps may lack a clearance
    `left_out`, m.
    """
    began = next((place for place, one in enumerate(checked) if one.touches), len(checked))
    if checked[0].problem.gap:
        checked, found, began = checked[began:], found[began:], 0
    for one, conditions in zip(checked[:began], found, strict=False):
        conditions["gap"] = max(float(np.abs(one.gap - one.state.gap).max()) - left_out, 0.0) / one.length
    if began == len(checked):
        return
    theta = checked[0].state.theta
    columns = np.column_stack([np.cos(theta), np.sin(theta)])
    best = min(checked[began:], key=lambda one: one.length)
    datum = np.linalg.lstsq(columns, best.gap - best.state.gap, rcond=None)[0]
    for one, conditions in zip(checked[began:], found[began:], strict=True):
        off = float(np.abs(one.gap - columns @ datum - one.state.gap).max())
        conditions["gap"] = max(off - left_out, 0.0) / one.length


def _check_slips(checked: list[Checked], found: list[dict[str, float]]) -> None:
    """Compare the slips. Their reference is a rigid motion, and the displacement of the hole by loads."""
    theta = checked[0].state.theta
    columns = [np.ones_like(theta), np.cos(theta), np.sin(theta)]
    for name in checked[0].state.load:
        moved = checked[0].integrals.loads({**dict.fromkeys(LOADS, 0.0), name: 1.0})[1]
        columns.append(moved / max(float(np.abs(moved).max()), 1e-300))
    directions, sizes, _ = np.linalg.svd(np.column_stack(columns), full_matrices=False)
    basis = directions[:, sizes > RANK * sizes[0]]
    last: np.ndarray | None = None
    previous: Checked | None = None
    for one, conditions in zip(checked, found, strict=True):
        if one.problem.frictionless or not one.touches:
            last, previous = None, one
            continue
        difference = one.slip - one.state.slip
        if last is None or (previous is not None and may_lose_contact(previous.state, one.state, one.room)):
            last = basis @ (basis.T @ difference)
        conditions["slip"] = float(np.abs(difference - last).max()) / one.length
        last, previous = difference, one


def may_lose_contact(before: State, after: State, room: float) -> bool:
    """Whether the pin may float between two states with room: no force acts, or the force passes through zero.

    Along an axis with a prescribed displacement the pin must also lie within the `room` of :func:`room_of`, m.
    """
    problem = before.problem
    if room < 0.0:
        return False
    first, last = (
        np.array([[state.load["Q"], state.load["P"]], [state.load["ux"], state.load["uy"]]])
        for state in (before, after)
    )
    driven = np.array(problem.driven)
    first, last = (np.where([~driven, driven], given, 0.0) for given in (first, last))
    way = last - first
    part = min(max(float(-(first[0] @ way[0])) / max(float(way[0] @ way[0]), 1e-300), 0.0), 1.0)
    stops = np.r_[part, np.linspace(0.0, 1.0, STOPS)]
    forces, shifts = (np.linalg.norm(first[k] + stops[:, None] * way[k], axis=1) for k in (0, 1))
    largest = max(float(np.abs([first[0], last[0]]).max()), 1e-300)
    inside = shifts <= room if driven.any() else np.ones(stops.size, dtype=bool)
    return bool(np.any(inside & (forces <= 1e-9 * largest)))


def _held(states: Sequence[State]) -> list[tuple[int, State, State]]:
    """Consecutive states that lie close together, with contact all the way, and the place of the second.

    A pin that only the remote stress holds is taken to be in contact between two states in contact.
    """
    return [
        (place, before, after)
        for place, (before, after) in enumerate(pairwise(states), start=1)
        if before.in_contact
        and after.in_contact
        and not (
            may_lose_contact(before, after, room_of(before.problem))
            and any(state.load[name] for state in (before, after) for name in "PQ")
        )
    ]


def _check_energy_balance(checked: list[Checked], found: list[dict[str, float]]) -> None:
    """Work = energy + dissipation. The sizes of energies are products of resultant and displacement."""
    size = 0.0
    for one, conditions in zip(checked, found, strict=True):
        state = one.state
        size = max(size, abs(state.work), abs(state.energy), abs(state.dissipation), 1e-300)
        conditions["balance"] = abs(state.work - state.energy - state.dissipation) / size
        conditions["dissipation >= 0"] = max(-state.dissipation / size, 0.0)


def wrong_slips(states: Sequence[State]) -> list[tuple[int, int, float]]:
    """State, node and amount of slips against the shear, and of movements of sticking nodes.

    The states lie close together. A node that slips at one state and sticks at the next may slip in one direction only.
    A node that slips in opposite directions at two consecutive states is not judged.
    """
    found = []
    for place, before, after in _held(states):
        judged = (before.status != OPEN) & (after.status != OPEN) & (before.status * after.status != -1)
        slid = after.slip - before.slip
        sense = np.sign(before.status + after.status)
        wrong = np.where(judged, np.where(sense == 0, np.abs(slid), np.maximum(-sense * slid, 0.0)), 0.0)
        node = int(np.argmax(wrong))
        found.append((place, node, float(wrong[node])))
    return found


def check_direction(result: Result) -> tuple[float, int]:
    """Largest slip in a wrong direction in a result with many stops, in parts of the largest slip; and its step.

    A node may slip and stick again between two stops. So the worst step is followed once more, with stops that lie a
    hundred times closer in the worst interval, :data:`CLOSER` times. The amount that is left there counts. A step that
    the solver refuses with these stops is not judged.
    """
    return max(_interface_direction(result, place) for place in range(len(interfaces_of(result.states))))


def _interface_direction(result: Result, place: int) -> tuple[float, int]:
    """As :func:`check_direction`, at one interface."""
    states = interfaces_of(result.states)[place]
    if states[0].problem.frictionless:
        return 0.0, -1
    size = slip_size(states)
    wrong = max(wrong_slips(states), key=lambda found: found[2], default=(0, 0, 0.0))
    rounding = 8.0 * np.finfo(float).eps * max(float(np.abs(state.slip).max()) for state in states)
    if wrong[2] <= max(TOLERANCE * size, rounding):  # where all nodes stick, all changes are rounding
        return 0.0, -1
    inside = result.states
    for _ in range(CLOSER):
        before, after = inside[wrong[0] - 1], inside[wrong[0]]
        try:
            inside = _states_between(result, before, after)
        except FastpinError:
            return 0.0, after.step
        left = max(wrong_slips(interfaces_of(inside)[place]), key=lambda found: found[2], default=(0, 0, 0.0))
        if left[2] <= 0.3 * wrong[2]:
            return 0.0, after.step
        wrong = left
    return wrong[2] / size, after.step


def _states_between(result: Result, before: State, after: State) -> Sequence[State]:
    """The states at a hundred stops between two states. The first interval of a step begins at its first stop."""
    begin = before.fraction if before.step == after.step else 0.0
    stops = np.linspace(begin, after.fraction, 101)
    stops = stops[(stops > 0.0) & (stops < 1.0)]
    closer = solve(result.problem, result.history[: after.step + 1], grid=result.grid, between=list(stops))
    first = stops[0] if begin == 0.0 else begin  # the rest of the first interval is as wide as the others
    return [s for s in closer.states if s.step == after.step and first <= s.fraction <= after.fraction]


def interfaces_of(states: Sequence[State]) -> list[Sequence[State]]:
    """The states at the pin and, with a bush that slips, those at its seat."""
    seats = [state.seat for state in states if state.seat is not None]
    return [states, seats] if seats else [states]


def slip_size(states: Sequence[State]) -> float:
    """Natural size of slips: the largest change of slip between states in contact."""
    largest = 0.0
    for _, before, after in _held(states):
        both = (before.status != OPEN) & (after.status != OPEN)
        largest = max(largest, float(np.abs(after.slip - before.slip)[both].max(initial=0.0)))
    return max(largest, 1e-300)


def check_dissipation(result: Result) -> float:
    """Difference of int |T ds| and the dissipation at the end, in parts of it, if it is no error of the integral.

    It is such an error if it is below four times the difference of the integrals with all states and with every second
    one, or if it falls with four times the stops.
    """
    fine, coarse = (_dissipated(some) for some in (result.states, result.states[len(result) % 2 :: 2]))
    error = dissipation_error(result.states, fine)
    beyond = error - 4.0 * abs(fine - coarse) / max(abs(result.states[-1].dissipation), 1e-300)
    if beyond <= 0.0:
        return 0.0
    stops = 4 * len(result) // len(result.history) - 1
    try:
        closer = solve(result.problem, result.history, grid=result.grid, between=stops).states
    except FastpinError:
        return 0.0
    return error if dissipation_error(closer, _dissipated(closer)) > 0.8 * error else 0.0


def dissipation_error(states: Sequence[State], integral: float) -> float:
    """Difference of an integral int |T ds| and the dissipation of the last state, in parts of it."""
    return abs(integral - states[-1].dissipation) / max(abs(states[-1].dissipation), 1e-300)


def _dissipated(states: Sequence[State]) -> float:
    """int -T ds by the trapezoidal rule, with the slip since the state before also where nodes close or open.

    The sum over all interfaces. Two states of which one has no contact say nothing of the way between them: there the
    dissipation of the states themselves counts.
    """
    total = 0.0
    for some in interfaces_of(states):
        weights = some[0].problem.hole_radius * some[0].grid.weights
        lost = [state.dissipation - (state.seat.dissipation if state.seat else 0.0) for state in some]
        gains = np.diff(lost, prepend=0.0)
        for place, before, after in _held(some):
            gains[place] = -0.5 * float(weights @ ((after.slip - before.slip) * (before.shear + after.shear)))
        total += float(gains.sum())
    return total
