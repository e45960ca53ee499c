"""The contact conditions of a joint whose bush slips, recomputed at both interfaces without the matrices of the solver.

Each interface alone is recomputed as in :mod:`tests.survey.conditions`. The displacement of one rim of the bush under
the tractions on the other is a Fourier series of the piecewise linear tractions. Its potentials are solved harmonic by
harmonic.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.states.state import State
from tests.survey.conditions import POINTS, WEIGHTS, Checked, integrals_of, may_lose_contact, room_of

HARMONICS = 400
"""Harmonics of the tractions, at most."""

SMALLEST = 1e-17
"""Response of the other rim, in parts of the first one, below which harmonics are left out."""


def ring_responses(n: int, outer: float, kolosov: float, from_outer: bool) -> np.ndarray:
    """2G (u_n, conj u_-n) of one free rim per traction (t_n, conj t_-n) on the other, (2, 2), from (T36).

    Four equations for the tractions on both rims give the amplitudes. Harmonic 1 has the terms without a force;
    harmonic 0 is Lame's.
    """
    k, loaded, seen = kolosov, outer if from_outer else 1.0, 1.0 if from_outer else outer
    free = seen
    if n == 0:
        a, b = np.linalg.solve([[1.0, loaded**-2.0], [1.0, free**-2.0]], [1.0, 0.0])
        return np.array([[0.5 * (k - 1.0) * a * seen - b / seen, 0.0], [0.0, 0.0]])
    if n == 1:  # t_1 = 2 (A r + D r^-3), 2G u_1 = k A r^2 - D r^-2
        a, d = np.linalg.solve([[2.0 * r, 2.0 * r**-3.0] for r in (loaded, free)], [1.0, 0.0])
        return np.array([[k * a * seen**2 - d / seen**2, 0.0], [0.0, 0.0]])

    def tractions(r: float) -> np.ndarray:
        up, down = r ** float(n), r ** -float(n)
        return np.array(
            [
                [(n + 1.0) * up, -(n * n - 1.0) * down, 0.0, (n + 1.0) * down / r**2],
                [-(n * n - 1.0) * up, (1.0 - n) * down, (1.0 - n) * up / r**2, 0.0],
            ]
        )

    matrix = np.vstack([tractions(loaded), tractions(free)])
    scale = np.abs(matrix).max(axis=0)
    amplitudes = np.linalg.solve(matrix / scale, np.eye(4, 2)) / scale[:, None]
    own = np.zeros((2, 4))
    own[0, 0], own[1, 1] = seen ** (n + 1.0), seen ** (1.0 - n)
    traction = tractions(seen) @ amplitudes
    found: np.ndarray = (k + 1.0) * (own @ amplitudes) + seen * traction * np.array(
        [[-1.0 / (n + 1.0)], [1.0 / (n - 1.0)]]
    )
    return found


class Bush:
    """What one rim of the bush feels of the tractions on the other one.

    Parameters
    ----------
    problem : Problem
    grids : tuple of Grid
        Nodes of the pin and of the seat.
    """

    def __init__(self, problem: Problem, grids: tuple[Grid, Grid]) -> None:
        pin, seat = problem.interfaces
        outer, bush = seat.hole_radius / pin.hole_radius, seat.pair.pin
        self.unit = pin.hole_radius / (2.0 * bush.shear_modulus)
        matrices = []
        for n in range(HARMONICS):
            pair = [ring_responses(n, outer, bush.kolosov(seat.pair.plane), from_outer) for from_outer in (True, False)]
            matrices.append(pair)
            if n > 4 and np.abs(pair).max() < SMALLEST * np.abs(matrices[2]).max():
                break
        self.matrices = np.array(matrices)  # (n, rim, 2, 2)
        self.waves = [_hat_integrals(grid, len(matrices)) for grid in grids]
        self.angles = [grid.theta for grid in grids]

    def moved(self, place: int, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Gap and slip (n,) of the interface `place` (0 or 1) under the tractions of the `state` of the other one."""
        waves = self.waves[1 - place]
        t = -(state.pressure - 1j * state.shear) / (2.0 * math.pi)
        plus, minus = waves @ t, np.conj(waves) @ t
        found = np.zeros(self.angles[place].size, dtype=complex)
        for n, matrix in enumerate(self.matrices[:, place]):
            forward, backward = matrix @ np.array([plus[n], np.conj(minus[n])])
            if n == 0:
                forward = matrix[0, 0] * plus[0].real  # shear turns the rim only
            found += forward * np.exp(1j * n * self.angles[place])
            if n > 1:
                found += np.conj(backward) * np.exp(-1j * n * self.angles[place])
        sense = self.unit * (1.0 if place == 0 else -1.0)
        return sense * found.real, -sense * found.imag


def _hat_integrals(grid: Grid, count: int) -> np.ndarray:
    """Integrals of every hat times exp(-i n theta), shape (count, nodes), by Gauss quadrature."""
    found = np.zeros((count, grid.size), dtype=complex)
    order = np.arange(count)[:, None, None]
    theta = np.r_[grid.theta, grid.theta[0] + 2.0 * math.pi]
    parts = max(1, math.ceil(count * 2.0 * math.pi / grid.size / 4.0))
    for part in range(parts):
        along = (part + POINTS) / parts
        places = theta[:-1, None] + np.diff(theta)[:, None] * along
        waves = np.exp(-1j * order * places) * (np.diff(theta)[:, None] * WEIGHTS / parts)
        found += waves @ (1.0 - along)
        found += np.roll(waves @ along, 1, axis=1)
    return found


def check_joint(states: Sequence[State]) -> list[dict[str, float]]:
    """Largest relative violation of each condition at each state of pin or seat; see tests/survey/conditions.py.

    The energy balance is that of the whole joint. The slips of the pin count from each beginning of its contact.
    """
    problem = states[0].problem
    seats = [state.seat for state in states]
    first = seats[0]
    assert first is not None
    bush = Bush(problem, (states[0].grid, first.grid))
    found: list[dict[str, float]] = [{} for _ in states]
    energies = np.zeros(len(states))
    pins: list[Checked] = []
    for place, (own_problem, own, others) in enumerate(
        zip(problem.interfaces, (list(states), seats), (seats, list(states)), strict=True)
    ):
        alone = [replace(state, problem=own_problem) for state in own]  # type: ignore[type-var]
        integrals = integrals_of(alone)
        checked = [
            Checked(integrals, state, 0.0, bush.moved(place, other), remote=place == 1)  # type: ignore[arg-type]
            for state, other in zip(alone, others, strict=True)
        ]
        pins = pins or checked
        _check(checked, found, place, problem.held)
        energies += [one.energy for one in checked]
    size = 0.0
    for state, seat, pin, energy, conditions in zip(states, seats, pins, energies, found, strict=True):
        assert seat is not None
        if problem.held and state.in_contact:
            conditions |= _held_together(state, seat, pin)
        size = max(size, abs(state.work), abs(state.energy), abs(state.dissipation), 1e-300)
        conditions["energy"] = abs(energy - state.energy) / size
        conditions["balance"] = abs(state.work - state.energy - state.dissipation) / size
        conditions["dissipation >= 0"] = max(-state.dissipation / size, 0.0)
        conditions["dissipation in the seat >= 0"] = max(-seat.dissipation / size, 0.0)
    return found


def _held_together(state: State, seat: State, pin: Checked) -> dict[str, float]:
    """Violations of the moment that both interfaces share, and of the rotation that is prescribed for both together."""
    moments = state.resultants["M"], seat.resultants["M"]
    size = max(
        float(each.grid.weights @ np.hypot(each.pressure, each.shear)) * each.problem.hole_radius**2
        for each in (state, seat)
    )
    found = {"moment": abs(moments[0] - moments[1]) / max(size, 1e-300)}
    bush, shear = seat.problem.pair.pin, float(seat.grid.weights @ seat.shear)
    rim = bush.kolosov(seat.problem.pair.plane) / (4.0 * math.pi * bush.shear_modulus) * shear
    hub = pin.hub_turn(-state.resultants["M"] / state.problem.hole_radius)
    turned = state.rotation + seat.rotation + rim - state.load["rotation"] - hub
    size = max(abs(state.rotation), abs(seat.rotation), abs(state.load["rotation"]), pin.length, 1e-300)
    return found | {"rotation": abs(turned) / size}


def _check(checked: list[Checked], found: list[dict[str, float]], place: int, held: bool) -> None:
    """Compare gaps and slips of one interface, and note its conditions."""
    theta = checked[0].state.theta
    columns = np.column_stack([np.cos(theta), np.sin(theta)])
    datum = np.zeros(theta.size)
    touching = [one for one in checked if one.touches]
    is_pressed = place == 1 and checked[0].problem.is_gripped
    if touching and not is_pressed:
        best = min(touching, key=lambda one: one.length)
        datum = columns @ np.linalg.lstsq(columns, best.gap - best.state.gap, rcond=None)[0]
    last: np.ndarray | None = np.zeros(theta.size) if is_pressed else None
    previous: Checked | None = None
    for one, conditions in zip(checked, found, strict=True):
        own = dict(one.conditions)
        own.pop("energy")
        own.pop("rotation", None)
        if held and one.touches:  # the moment is compared for both together
            forces, size = one.integrals.resultants(one.state)
            own["equilibrium"] = max(abs(forces[0] - one.state.load["P"]), abs(forces[1] - one.state.load["Q"])) / size
        if one.touches:
            own["gap"] = float(np.abs(one.gap - datum - one.state.gap).max()) / one.length
        if one.touches and not one.problem.frictionless:
            difference = one.slip - one.state.slip
            floats = (
                not is_pressed
                and previous is not None
                and may_lose_contact(previous.state, one.state, room_of(one.problem))
            )
            if last is not None and not floats:
                own["slip"] = float(np.abs(difference - last).max()) / one.length
            last = difference
        elif not is_pressed:
            last = None
        previous = one
        for name, value in own.items():
            conditions[name] = max(conditions.get(name, 0.0), value)
