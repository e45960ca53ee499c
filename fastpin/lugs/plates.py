"""The compliance of a finite plate with a hole, by boundary integral equations.

The known tractions are the harmonics on the edge of the hole, and the tractions of the loads. The unknowns are
displacements on free edges and tractions on held ones. :mod:`fastpin.lugs.panels` makes the two matrices.

Finite elements of second degree were tried for the same matrix, see docs/compliance.md. With 74,000 unknowns they agree
to 4e-7, in 10 s. The integral equations reach 1e-10 in 2 s. They need neither a mesh generator nor another package.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy.linalg
from threadpoolctl import threadpool_limits

from fastpin.bodies.compliance import COLUMNS, LEAST_ORDER, MOST_ORDER, WARM, Compliance
from fastpin.errors import InputError
from fastpin.lugs.outline import Lug, Part
from fastpin.lugs.panels import Boundary, Edges, Fineness, matrices
from fastpin.model.checks import check_callable, instance, string, whole_number
from fastpin.version import __version__

FINE, COARSE = Fineness(10, 16), Fineness(8, 12)
"""The discretisation, and a coarser one for its error. Measured for a rectangle with one held edge: 3e-11 and 2e-9; for
an edge that is held in its middle only: 2e-7 and 4e-6."""

FIRST_TRIED, MOST_CHOSEN = 16, 120
"""Harmonics that are tried first, then twice as many, and most that are chosen. The file of more is too large."""

KEPT = 1e-7
"""Least size of the last harmonic that is kept, in parts of the largest. The peak pressure of a contact changes by 1e-6
when harmonics below 1e-5 are left out."""

HOLE = 0.5
"""Compliance G v/R of the hole in the infinite plate under pressure."""

NO_PINS: Mapping[str, int] = MappingProxyType({})
"""No further hole has a pin."""

RIGID = np.arange(1, 6)
"""Places of the rotation and of the first harmonic, which hold the motion of the hole over the supports."""


@dataclass(frozen=True, eq=False)
class PlateResult:
    """A compliance, and how good it is. Errors are in parts of the largest entry; see :func:`largest_part`.

    Attributes
    ----------
    compliance : Compliance
    asymmetry : float
        Largest difference of the matrix and its transpose, before it was made symmetric.
    last : float
        Largest entry of the last harmonic, without rotation and first harmonic.
    error : float
        Largest difference of the matrix and columns from those of a coarser discretisation. The error is smaller.
    nodes : int
        Number of nodes on all edges.
    """

    compliance: Compliance
    asymmetry: float
    last: float
    error: float
    nodes: int


@dataclass(frozen=True, eq=False)
class Response:
    """Displacements 2G u/R of all nodes, under unit harmonics on the hole's edge and under unit loads.

    Attributes
    ----------
    edges : Edges
    u : ndarray, shape (2, nodes, 2 + 4 K + loads)
        Components along x and y.
    t, pulled : ndarray, shape (2, nodes, 2 + 4 K + loads)
        The given tractions, and those with the tractions of supports, along x and y.
    loads : tuple of str
        Names of the loads.
    warm, hindered : ndarray, shape (2, nodes, 1)
        Displacements and tractions when all supports move by -z, as they do over a plate that expands by a unit of
        strain.
    resultants : ndarray, shape (3, 2 + 4 K + loads), or None
        Force along x and y, and moment about 0, of the given tractions on a plate that floats. The outline balances
        them by tractions that grow linearly.
    """

    edges: Edges
    u: np.ndarray
    t: np.ndarray
    pulled: np.ndarray
    loads: tuple[str, ...]
    warm: np.ndarray
    hindered: np.ndarray
    resultants: np.ndarray | None = None

    def whole(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacements and tractions on all nodes, complex, both (nodes, 2 + 4 K + 4).

        The last columns belong to the loads sxx, syy and sxy, zero where the plate has none, and to `warm`.
        """
        size = self.t.shape[2] - len(self.loads)
        places = {name: size + k for k, name in enumerate((*self.loads, WARM))}
        chosen = [*range(size), *(places.get(name, -1) for name in (*COLUMNS, WARM))]
        none = np.zeros((2, self.edges.z.size, 1))
        u, t = np.dstack([self.u, self.warm, none]), np.dstack([self.pulled, self.hindered, none])
        return u[0][:, chosen] + 1j * u[1][:, chosen], t[0][:, chosen] + 1j * t[1][:, chosen]

    def projected(self) -> np.ndarray:
        """Coefficients G v/R on the hole's edge, shape (2 + 4 K, 2 + 4 K + loads)."""
        return self._coefficients(self.u)

    def with_temperature(self) -> np.ndarray:
        """The same with a last column for the temperature."""
        return np.hstack([self.projected(), self._coefficients(self.warm)])

    def _coefficients(self, u: np.ndarray) -> np.ndarray:
        size = self.t.shape[2] - len(self.loads)
        harmonics = self.t[:, :, :size] * self.edges.weights[:, None]
        found: np.ndarray = 0.5 / math.pi * np.einsum("inf,inc->fc", harmonics, u, optimize=True)
        return found


def plate_compliance(
    lug: Lug,
    order: int | None = None,
    progress: Callable[[float, float], None] | None = None,
    made_by: str = f"fastpin {__version__}",
) -> PlateResult:
    """Compute the compliance of a finite plate.

    Parameters
    ----------
    lug : Lug
    order : int, optional
        Highest harmonic K. Without it harmonics are taken until they are below 1e-7 of the largest.
    progress : callable, optional
        ``progress(done, total)`` is called from time to time.
    made_by : str
        Origin of the numbers, for the file.

    Raises
    ------
    InputError
        If an argument is of another class, `order` is out of range, too few harmonics are kept, or the outline needs
        too many nodes.
    """
    instance("lug", lug, Lug, "a Lug")
    check_callable("progress", progress)
    string("made_by", made_by)
    if order is not None:
        order = whole_number("harmonics", order, LEAST_ORDER, MOST_ORDER)

    def share(start: float, length: float) -> Callable[[float], None]:
        return lambda done: None if progress is None else progress(start + length * done, 1.0)

    computed = FIRST_TRIED if order is None else order
    tried = 0
    while True:
        coarse = respond(lug, computed, COARSE, share(0.1 * tried, 0.1)).with_temperature()
        size = 2 + 4 * computed
        rough = coarse[:, :size] - hole_compliance(computed, lug.kolosov)
        if order is not None or computed == MOST_CHOSEN or harmonic_sizes(rough)[-1] <= KEPT:
            break
        computed, tried = min(2 * computed, MOST_CHOSEN), tried + 1
    kept = order
    if kept is None:
        kept = max(4, int(np.flatnonzero(harmonic_sizes(rough) > KEPT)[-1]))  # the last one shows that they decay
    fine = respond(lug, kept, FINE, share(0.1 * (tried + 1), 0.9 - 0.1 * tried))
    cut = 2 + 4 * kept
    whole = fine.with_temperature()
    less = whole - np.hstack([coarse[:cut, :cut], coarse[:cut, size:]])
    matrix = whole[:, :cut] - hole_compliance(kept, lug.kolosov)
    columns = {name: whole[:, cut + place] for place, name in enumerate((*fine.loads, WARM))}
    try:
        outline = "" if lug.floats else json.dumps(lug.document())
        made = Compliance(lug.nu, lug.plane, lug.hole_radius, 0.5 * (matrix + matrix.T), columns, made_by, outline)
    except InputError as error:
        raise InputError("harmonics" if "more harmonics" in error.reason else error.field, error.reason) from None
    return PlateResult(
        made,
        largest_part(matrix - matrix.T, whole),
        float(harmonic_sizes(matrix)[-1]),
        largest_part(less, whole),
        fine.edges.z.size,
    )


def largest_part(difference: np.ndarray, whole: np.ndarray) -> float:
    """Largest entry of a difference, in parts of the largest entry of its kind.

    The rotation and the translation over the supports are large in a long plate. So an entry between two of them counts
    in parts of the geometric mean of their own compliances. A column of a load counts at least as 1, the size of a
    displacement of the hole.
    """
    deforming = np.setdiff1d(np.arange(len(whole)), RIGID)
    scale = np.full(len(whole), float(np.abs(whole[np.ix_(deforming, deforming)]).max()))
    scale[RIGID] = np.maximum(scale[RIGID], np.diag(whole)[RIGID])
    square = np.abs(difference[:, : len(whole)]) / np.sqrt(np.multiply.outer(scale, scale))
    found = float(square.max())
    for column, values in zip(difference[:, len(whole) :].T, whole[:, len(whole) :].T, strict=False):
        for kind in (RIGID, deforming):
            found = max(found, float(np.abs(column[kind]).max()) / max(1.0, float(np.abs(values[kind]).max())))
    return found


def harmonic_sizes(matrix: np.ndarray) -> np.ndarray:
    """Largest entry of each harmonic 0 to K, in parts of the largest one. Rotation and translation don't count.

    In a wide plate all entries are small. Then they count in parts of the compliance of the hole itself.
    """
    count = (len(matrix) - 2) // 4
    harmonic = np.r_[0, 0, np.repeat(np.arange(1, count + 1), 4)]
    rows = np.abs(np.delete(matrix, RIGID, axis=1)).max(axis=1)
    found = np.array([rows[harmonic == n].max() for n in range(count + 1)])
    return found / max(rows[0], found[2:].max(), HOLE)


def hole_compliance(order: int, kolosov: float) -> np.ndarray:
    """The matrix "hole" of (T41): the hole in the infinite plate, without its first harmonic of the force."""
    n = np.arange(1, order + 1)
    backward = np.where(n > 1, 0.5 * kolosov / np.maximum(n - 1, 1), 0.0)
    return harmonic_matrix((0.5, 0.5), 0.5 / (n + 1), backward)


def harmonic_matrix(mean: tuple[float, float], forward: np.ndarray, backward: np.ndarray) -> np.ndarray:
    """The matrix, in the basis of a compliance, that multiplies each harmonic of r + i theta components by a number.

    Parameters
    ----------
    mean : (float, float)
        Factors of the mean along r and along theta.
    forward, backward : ndarray, shape (K,)
        Factors of exp(i n theta) and exp(-i n theta), n = 1 to K.
    """
    matrix = np.diag(np.r_[mean, np.repeat(0.5 * (forward + backward), 4)])
    for place, other in enumerate(0.5 * (forward - backward)):
        block = slice(4 * place + 2, 4 * place + 6)
        matrix[block, block] += np.diag([other, -other, -other, other])[:, ::-1]
    return matrix


class PlateEquations:
    """The integral equations of a plate, factored once.

    Parameters
    ----------
    lug : Lug
    edges : Edges
    progress : callable
        Called with the part that is done.
    loaded : ndarray of bool, shape (nodes,), optional
        Nodes with given tractions, panel by panel. Unless given, all nodes may have some.

    Attributes
    ----------
    modes : RigidModes or None
        Of a plate that floats.
    """

    def __init__(
        self, lug: Lug, edges: Edges, progress: Callable[[float], None], loaded: np.ndarray | None = None
    ) -> None:
        self.edges, self.modes = edges, _rigid_modes(lug, edges) if lug.floats else None
        held, frame = self._held, self._frame = _supports(lug, edges)
        kept = self._kept = np.flatnonzero(held.any(axis=0) | (True if loaded is None else loaded))
        # At 1 (nu = 0.5 in plane strain) the pressure on an outline that is held all round moves nothing, and the
        # equations have no unique solution. The matrix changes by 1e-7.
        self.kolosov = kolosov = max(lug.kolosov, 1.0 + 1e-7)
        with threadpool_limits(limits=1, user_api="blas"):  # the same bits with any number of cores
            # With this unit of length no plate has the size at which a purely logarithmic equation for held edges has
            # no unique solution.
            U, T = matrices(edges, kolosov, 8.0 * edges.extent, kept, progress)
            turned = np.flatnonzero(frame != 1.0)
            c, s = frame.real[turned], frame.imag[turned]
            for matrix, at in ((U, np.searchsorted(kept, turned)), (T, turned)):  # along the frames of supports
                x, y = matrix[:, :, 0, at], matrix[:, :, 1, at]
                matrix[:, :, 0, at], matrix[:, :, 1, at] = x * c + y * s, y * c - x * s
            size = 2 * edges.z.size
            self._of_tractions, T = U.reshape(size, -1), T.reshape(size, size)
            if (modes := self.modes) is not None:  # the mean of the outline moves no more
                T += modes.of_nodes @ np.linalg.solve(modes.gram, modes.on_outline.T)
            self._of_supports = T[:, held.reshape(-1)]
            T[:, held.reshape(-1)] = -self._of_tractions[:, held[:, kept].reshape(-1)]
            self._factors = scipy.linalg.lu_factor(T.T, overwrite_a=True, check_finite=False)

    def solve(self, tractions: np.ndarray, moved: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Displacements 2G u/R and tractions of all nodes, along x and y, both (2, nodes, m).

        Free components have the given `tractions`, held ones are `moved` by 0 unless it is given; both are complex,
        (nodes, m).
        """
        held, frame = self._held, self._frame
        along = np.stack([_dot(frame, tractions), _dot(1j * frame, tractions)])
        along[held] = 0.0
        with threadpool_limits(limits=1, user_api="blas"):
            right = self._of_tractions @ along[:, self._kept].reshape(-1, tractions.shape[1])
            if moved is not None:
                back = np.stack([_dot(frame, moved), _dot(1j * frame, moved)])
                right -= self._of_supports @ back[held]
            found = scipy.linalg.lu_solve(self._factors, right, trans=1, check_finite=False).reshape(along.shape)
        along[held] = found[held]
        found[held] = 0.0 if moved is None else back[held]
        c, s = frame.real[:, None], frame.imag[:, None]
        u, t = (np.stack([c * one - s * two, s * one + c * two]) for one, two in (found, along))
        return u, t


def respond(
    lug: Lug, order: int, fineness: Fineness, progress: Callable[[float], None], pinned: Mapping[str, int] = NO_PINS
) -> Response:
    """Solve the integral equations for the harmonics up to `order` on the edge of the hole, and for the loads.

    `pinned` maps the names of further holes with a pin, in the order of ``lug.holes``, to their highest harmonics.
    Their radius is that of the first hole.
    """
    edges = Edges(boundaries(lug, order, pinned), fineness)
    tractions, loads = _tractions(lug, edges, order, pinned)
    loaded = np.repeat(tractions.any(axis=1).reshape(-1, edges.points).any(axis=1), edges.points)
    loaded |= lug.floats  # the outline balances the pins
    equations, resultants = PlateEquations(lug, edges, lambda done: progress(0.7 * done), loaded), None
    if equations.modes is not None:
        tractions, resultants = balanced(tractions, equations.modes)
    u, pulled = equations.solve(tractions)
    # 2G u is 2 by a unit of G times the strain
    warm, hindered = equations.solve(np.zeros((edges.z.size, 1)), -2.0 * edges.z[:, None])
    progress(1.0)
    given = np.stack([tractions.real, tractions.imag])
    return Response(edges, u, given, pulled, loads, warm, hindered, resultants)


class RigidModes(NamedTuple):
    """Two translations and a rotation about 0 at all nodes, both components, shape (2 nodes, 3).

    Attributes
    ----------
    of_nodes : ndarray
    on_outline : ndarray
        Times the lengths that belong to nodes of the outline; 0 at other nodes.
    weighted : ndarray
        Times the lengths that belong to all nodes.
    gram : ndarray, shape (3, 3)
        Integrals of products along the outline.
    """

    of_nodes: np.ndarray
    on_outline: np.ndarray
    weighted: np.ndarray
    gram: np.ndarray

    def mean_motion(self, moved: np.ndarray) -> np.ndarray:
        """The rigid motions of all nodes that move the outline as `moved` does in the mean; complex, (nodes, m)."""
        factors = np.linalg.solve(self.gram, self.on_outline.T @ np.concatenate([moved.real, moved.imag]))
        x, y = np.split(self.of_nodes @ factors, 2)
        return np.asarray(x + 1j * y)


def _rigid_modes(lug: Lug, edges: Edges) -> RigidModes:
    z, last = edges.z, edges.of_hole + len(lug.outline)
    modes = np.stack([np.ones_like(z), np.full_like(z, 1j), 1j * z], axis=1)
    both = np.concatenate([modes.real, modes.imag])
    outer = edges.is_further & (edges.part_of_node < last)
    weights = np.tile(edges.weights, 2)[:, None]
    on_outline = both * weights * np.tile(outer, 2)[:, None]
    return RigidModes(both, on_outline, both * weights, on_outline.T @ both)


def balanced(tractions: np.ndarray, modes: RigidModes) -> tuple[np.ndarray, np.ndarray]:
    """Tractions (nodes, columns) that linear ones on the outline balance, and their resultants before, (3, columns)."""
    both = np.concatenate([tractions.real, tractions.imag])
    resultants = modes.weighted.T @ both
    factors = np.linalg.solve(modes.gram, resultants)
    spread = modes.of_nodes * (modes.on_outline != 0.0)
    x, y = np.split(both - spread @ factors, 2)
    return x + 1j * y, resultants


def _dot(along: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    found: np.ndarray = (np.conj(along)[:, None] * vectors).real
    return found


def boundaries(lug: Lug, order: int, pinned: Mapping[str, int] = NO_PINS) -> list[Boundary]:
    """All edges in hole radii; the first one is the edge of the pin's hole."""

    def marks(name: str) -> tuple[str | None, tuple[int, ...]]:
        return lug.supports.get(name), tuple(place for place, load in enumerate(lug.loads) if name in load.parts)

    def scaled(parts: tuple[Part, ...]) -> tuple[Part, ...]:
        return tuple(part.scaled(1.0 / lug.hole_radius) for part in parts)

    # Ten nodes on 4 rad of a harmonic integrate a product of two such harmonics to 1e-12, eight nodes to 1e-8.
    def finest(highest: int) -> float:
        return min(Boundary.turn, 4.0 / highest)

    count = len(lug.contact_edge)
    loops = [Boundary(scaled(lug.contact_edge), ((None, ()),) * count, (True,) * count, finest(order))]
    for names, parts in [
        ([part.name for part in lug.outline], lug.outline),
        *(([hole.name] * len(hole.parts), hole.parts) for hole in lug.holes),
    ]:
        free = tuple(
            name not in lug.supports and not lug.floats for name in names
        )  # a floating outline balances the pins
        turn = finest(pinned[names[0]]) if names[0] in pinned and len(set(names)) == 1 else Boundary.turn
        loops.append(Boundary(scaled(parts), tuple(map(marks, names)), free, turn))
    return loops


def _on_parts(lug: Lug, edges: Edges, name: str) -> np.ndarray:
    """Whether each node lies on a part or hole of this name."""
    named = [place for place, part in enumerate(edges.parts) if place >= edges.of_hole and part.name == name]
    return np.isin(edges.part_of_node, named)


def _supports(lug: Lug, edges: Edges) -> tuple[np.ndarray, np.ndarray]:
    """Whether components 1, 2 of nodes are held, shape (2, nodes), and the unit vector of component 1, complex."""
    held = np.zeros((2, edges.z.size), dtype=bool)
    frame = np.ones(edges.z.size, dtype=complex)
    for name, hold in lug.supports.items():
        on = _on_parts(lug, edges, name)
        held[0, on], held[1, on] = hold != "y", hold in ("both", "y")
        if hold == "normal":
            frame[on] = edges.normals[on]
    return held, frame


def _tractions(lug: Lug, edges: Edges, order: int, pinned: Mapping[str, int]) -> tuple[np.ndarray, tuple[str, ...]]:
    """Tractions of unit harmonics on each edge with a pin, and of loads, and the names of the loads.

    The tractions are complex, shape (nodes, sum of 2 + 4 K of all edges with a pin + loads).
    """
    found = [_of_harmonics(edges.z, ~edges.is_further, order)]
    for hole in lug.holes:
        if hole.name in pinned:
            away = edges.z - hole.centre / lug.hole_radius
            found.append(_of_harmonics(away, _on_parts(lug, edges, hole.name), pinned[hole.name]))
    acting, loads = load_tractions(lug, edges)
    return np.hstack([*found, acting]), loads


def load_tractions(lug: Lug, edges: Edges) -> tuple[np.ndarray, tuple[str, ...]]:
    """Tractions of the unit loads of a plate at all nodes, complex, (nodes, loads), and the names of the loads."""
    loads = tuple(sorted({load.name for load in lug.loads}))
    acting = np.zeros((edges.z.size, len(loads)), dtype=complex)
    for load in lug.loads:
        for name in load.parts:
            on = _on_parts(lug, edges, name)
            acting[on, loads.index(load.name)] += complex(load.x, load.y) + load.normal * edges.normals[on]
    return acting, loads


def _of_harmonics(away: np.ndarray, on_hole: np.ndarray, order: int) -> np.ndarray:
    """Unit harmonics at the nodes on a hole, seen from its centre; 0 at all others."""
    found = np.zeros((away.size, 2 + 4 * order), dtype=complex)
    found[on_hole] = edge_basis(away[on_hole], order)
    return found


def edge_basis(z: np.ndarray, order: int) -> np.ndarray:
    """The basis of a compliance at points (k,) on the edge of a hole round 0, complex, shape (k, 2 + 4 K)."""
    radial = z / np.abs(z)
    waves = radial[:, None] ** np.arange(order + 1)
    waves[:, 0] = math.sqrt(0.5)
    r, along = radial[:, None], 1j * radial[:, None]
    found = np.empty((radial.size, 2 + 4 * order), dtype=complex)
    found[:, :2] = waves[:, :1] * np.hstack([r, along])
    for place, (base, values) in enumerate(
        ((r, waves.real), (r, waves.imag), (along, waves.real), (along, waves.imag))
    ):
        found[:, 2 + place :: 4] = base * values[:, 1:]
    return found
