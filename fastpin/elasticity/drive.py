"""The drive of the pin: along each axis a force or a prescribed displacement, in dimensionless form.

Along a driven axis the displacement of the hub relative to the gauge circle is prescribed, (T29): D = c + g F - k J.
c is the displacement of the pin's rim relative to the hole, F the reaction, J an integral of the tractions. The
reaction takes the place of c among the unknown motion of the pin. With the column m of the motion and the w terms of
the force, gap and slip are

    c m + F w = D m + F (w - g m) + k J m.

The last term is added to the operator (:mod:`fastpin.elasticity.operator`). The operator is then no longer a Toeplitz
matrix, nor symmetric. The place of F in the load vector stays 0, for F is no load.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.loads import UX, UY, P, Q
from fastpin.model.problem import Problem

DISPLACEMENTS = (UX, UY)
"""Places of the prescribed displacements in a load vector, along x and y."""

FORCES = (Q, P)
"""Places of the forces that they replace, along x and y."""

SIGNS = (1.0, -1.0)
"""Sense of these forces: Q acts along +x, P along -y."""


@dataclass(frozen=True, eq=False)
class Drive:
    """What moves the pin along x and y: forces, unless a subclass prescribes displacements. All is dimensionless.

    Attributes
    ----------
    translation : ndarray, shape (2n, 2)
        Maps the displacement c of the pin to (h, s).
    columns : ndarray, shape (2n, loads)
        Maps the loads to (h, s), without the prescribed displacements.
    axes : ndarray of bool, shape (2,)
        Whether each axis is driven: its displacement is prescribed.
    has_displacements : bool
        Whether an axis is driven. Then the drive puts the pin in place, in contact or not.
    """

    translation: np.ndarray
    columns: np.ndarray
    axes: np.ndarray = field(default_factory=lambda: np.zeros(2, dtype=bool))
    has_displacements: ClassVar[bool] = False

    @property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """Factors (2n, r) and (r, 2n) of the matrix that the operator gains. Its rank r is 0 under forces."""
        return self.translation[:, :0], self.translation[:, :0].T

    def part(self, rows: np.ndarray) -> Drive:
        """The drive with some `rows` (k,) only, indices of tractions."""
        return replace(self, translation=self.translation[rows], columns=self.columns[rows])

    def prescribed(self, load: np.ndarray) -> np.ndarray:
        """The prescribed displacements of a load (loads,), shape (2,); 0 along an axis that is not driven."""
        return np.where(self.axes, load[list(DISPLACEMENTS)], 0.0)

    def force(self, motion: np.ndarray, load: np.ndarray) -> np.ndarray:
        """Force on the pin along x and y, shape (2,): reactions from the unknown `motion` (m,), others from `load`."""
        return np.array([load[Q], -load[P]])

    def position(self, tractions: np.ndarray, motion: np.ndarray, load: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """Displacement c of the pin's rim relative to the hole, from the concentric position, shape (2,).

        `rest` (2,) is the position from which the motion counts along an axis that is not driven. `tractions` has the
        shape (2n,).
        """
        position: np.ndarray = rest + motion[:2]
        return position

    def with_reactions(self, motion: np.ndarray, load: np.ndarray) -> np.ndarray:
        """The load vector (loads,) with the reactions in the places of the forces."""
        return load

    def energy(self, weights: np.ndarray, tractions: np.ndarray, motion: np.ndarray) -> float:
        """The part of the elastic energy that the operator lacks: w terms of the reactions, without the coupling.

        `tractions` and their `weights` have the shape (2n,).
        """
        return 0.0

    def reaction_terms(self, weights: np.ndarray, load_rate: np.ndarray) -> np.ndarray:
        """The ``reactions`` of :class:`fastpin.kernels.arrays.LoadTerms`, shape (2, 2n+3), from the weights (2n,)."""
        return np.zeros((2, weights.size + 3))

    def work(
        self, weights: np.ndarray, freed: np.ndarray, motion: np.ndarray, change: np.ndarray, load_change: np.ndarray
    ) -> float:
        """Work of the reactions over a change of the tractions by `freed` (2n,), with their `weights` (2n,).

        `motion` (m,) is the mean of the unknown motion, `change` (m,) its change, `load_change` (loads,) the change of
        the load.
        """
        return 0.0


@dataclass(frozen=True, eq=False)
class DisplacementDrive(Drive):
    """A drive that prescribes the displacement along one axis or both.

    Attributes
    ----------
    compliance : float
        The compliance g, with the compliance of the rig.
    coupling : ndarray, shape (2, 2n)
        Maps (N, T) to k J, along x and y. It is 0 for an axis that is not driven.
    offsets : ndarray, shape (2n, 2)
        Maps the reactions to (h, s) where c is 0: the w terms. It is 0 for an axis that is not driven.
    """

    compliance: float = field(kw_only=True)
    coupling: np.ndarray = field(kw_only=True)
    offsets: np.ndarray = field(kw_only=True)
    has_displacements: ClassVar[bool] = True

    @property
    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        return self.translation, self.coupling

    def part(self, rows: np.ndarray) -> Drive:
        nodal = {name: getattr(self, name)[rows] for name in ("translation", "columns", "offsets")}
        return replace(self, coupling=self.coupling[:, rows], **nodal)

    def force(self, motion: np.ndarray, load: np.ndarray) -> np.ndarray:
        return np.where(self.axes, motion[:2], super().force(motion, load))

    def position(self, tractions: np.ndarray, motion: np.ndarray, load: np.ndarray, rest: np.ndarray) -> np.ndarray:
        driven = load[list(DISPLACEMENTS)] - self.compliance * motion[:2] + self.coupling @ tractions
        return np.where(self.axes, driven, rest + motion[:2])

    def with_reactions(self, motion: np.ndarray, load: np.ndarray) -> np.ndarray:
        complete = load.copy()
        complete[list(FORCES)] = self.force(motion, load) * SIGNS
        return complete

    def energy(self, weights: np.ndarray, tractions: np.ndarray, motion: np.ndarray) -> float:
        weighted, reactions = weights * tractions, np.where(self.axes, motion[:2], 0.0)
        coupled = (weighted @ self.translation) @ (self.coupling @ tractions)
        return float(weighted @ (self.offsets @ reactions) - 0.5 * coupled)

    def reaction_terms(self, weights: np.ndarray, load_rate: np.ndarray) -> np.ndarray:
        terms = super().reaction_terms(weights, load_rate)
        terms[:, :-3] = self._work_columns(weights)
        terms[:, -3], terms[:, -2], terms[:, -1] = load_rate[list(DISPLACEMENTS)], self.compliance, self.axes
        return terms

    def work(
        self, weights: np.ndarray, freed: np.ndarray, motion: np.ndarray, change: np.ndarray, load_change: np.ndarray
    ) -> float:
        columns = self._work_columns(weights) @ freed
        moved = load_change[list(DISPLACEMENTS)] - self.compliance * change[:2] + columns
        return float(np.where(self.axes, motion[:2] * moved, 0.0).sum())

    def _work_columns(self, weights: np.ndarray) -> np.ndarray:
        """Work of the reactions per reaction and traction rate, shape (2, 2n), from the weights (2n,) of the nodes."""
        columns: np.ndarray = (weights[:, None] * self.offsets).T + self.coupling
        return columns


def displacement_coupling(problem: Problem, grid: Grid) -> np.ndarray:
    """The rows k J of (T29) along x and y, shape (2, 2n), that map (N, T) to a displacement in units of beta*."""
    cos, sin = grid.trig_moments()
    return problem.drive_compliances[1] * np.array([np.r_[cos, -sin], np.r_[sin, cos]])


def make_drive(
    problem: Problem, grid: Grid, motion: np.ndarray, loads: np.ndarray, rows: np.ndarray, forces: np.ndarray
) -> Drive:
    """Replace the forces of the driven axes in the matrices of a system by displacements, and return the drive.

    Parameters
    ----------
    problem : Problem
    grid : Grid
    motion : ndarray, shape (2n, 3)
    loads : ndarray, shape (2n, loads)
    rows : ndarray, shape (3, 3)
    forces : ndarray, shape (3, loads)
        The matrices of :class:`fastpin.elasticity.system.System` for a pin under forces; `rows` are the motion rows.
        They are changed.
    """
    axes = np.array(problem.driven)
    if not axes.any():
        return Drive(motion[:, :2], loads)
    compliance = problem.drive_compliances[0]
    if problem.rig_stiffness is not None:  # a spring in series
        compliance += 1.0 / (problem.rig_stiffness * problem.surfaces.beta_star)
    coupling = displacement_coupling(problem, grid) * axes[:, None]
    translation = motion[:, :2].copy()
    offsets = loads[:, list(FORCES)] * SIGNS * axes
    for axis in np.flatnonzero(axes):
        loads[:, FORCES[axis]] = 0.0
    columns = loads.copy()
    for axis in np.flatnonzero(axes):
        loads[:, DISPLACEMENTS[axis]] = translation[:, axis]
        motion[:, axis] = offsets[:, axis] - compliance * translation[:, axis]
        rows[axis, axis] = -1.0
        forces[axis] *= 0.0
    return DisplacementDrive(translation, columns, axes, compliance=compliance, coupling=coupling, offsets=offsets)
