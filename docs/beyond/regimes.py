"""Regimes of contact under remote stress: one arc, two arcs, all round or none; Ti-6Al-4V pin in aluminium, mu = 0.40.

Left: a clearance pin. Right: an interference pin with the clearance's negative. Above: without a force. Below: with the
force P of figure 10 of the paper, for which L_p is 0.75 and -0.75. P comes first, then sxx and syy in a fixed ratio.
The axes count in s_c, the stress sxx = syy that moves the edge of the hole by the clearance or interference. Squares:
the four cases of figure 10.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from scipy import ndimage

from fastpin.assess.outputs import Curve
from fastpin.kernels.status import OPEN
from fastpin.model import Grid, Problem
from fastpin.published.records import PaperFigure, Report, head, panels, steps
from fastpin.published.remote_stress import DASHES, FRICTION, LOAD_PARAMETER, PAIR
from fastpin.published.tractions import NAMES, PAIRS
from fastpin.reading.zones import runs
from fastpin.solver import Result, solve
from fastpin.states.state import State
from fastpin.verification import interference

LARGEST = 3.0
"""Largest stress of the map in s_c. It is 230 MPa in aluminium with a clearance of 0.2 % of R."""

REACH = 1.3
"""Length of the rays, in parts of the way to the side of the map. Borders that leave the map then reach its side."""

RAYS, HALVINGS = 80, 4
"""Rays, and halvings of the angle between two that differ. With a multiple of 8 no ray meets a corner of the map."""

COARSE, FINE = 40, 15
"""States on each ray, and states between two of them that differ. 1/600 of a ray is less than a pixel."""

ALL_ROUND = -1
"""Number of arcs that stands for a contact all round in the curves."""


class MapRegion(NamedTuple):
    """Words and colour of a region of the map. The greys differ too, and every region has its name in it."""

    words: str
    colour: str


REGIMES = {
    0: MapRegion("no contact", "#ffffff"),
    1: MapRegion("one arc", "#d6e6f5"),
    2: MapRegion("two arcs", "#f2b15f"),
    3: MapRegion("three arcs", "#c08fc0"),
    ALL_ROUND: MapRegion("all round", "#73988a"),
}
"""The regimes by the number of arcs."""


Ray = list[tuple[float, int]]
"""Where each regime of a ray begins, in parts of its length, and its number of arcs."""


def arcs(state: State) -> int:
    """Return the number of contact arcs, :data:`ALL_ROUND` if no node is open."""
    closed = state.status != OPEN
    return ALL_ROUND if bool(np.all(closed)) else len(runs(state.grid, closed))


def direction(turn: float) -> np.ndarray:
    """Return a point (sxx, syy) on the square of half-width 1, by its distance from (1, 0) along the sides, 0 to 8."""
    side, along = divmod(turn % 8.0 + 1.0, 2.0)
    x, y = 1.0, along - 1.0
    for _ in range(int(side) % 4):
        x, y = -y, x
    return np.array([x, y])


def problem_of(load_parameter: float) -> Problem:
    """Return the joint of a column of panels."""
    return Problem.from_load_parameter(PAIRS[PAIR], load_parameter, FRICTION, "body")


def regimes_along(start: Result, target: np.ndarray) -> Ray:
    """Return the regimes on the way to the stress `target` (sxx, syy): the part of the way at which each begins.

    `start` is the state without stress. A regime that lasts for less than 1/40 of the way may be left out.
    """
    corner = [dict(zip(("sxx", "syy"), target.tolist(), strict=True))]

    def regimes_at(fractions: np.ndarray) -> list[int]:
        result = solve(start.problem, corner, start=start, between=fractions.tolist())
        return [arcs(state) for state in result]

    coarse = np.arange(1, COARSE) / COARSE
    kinds = [arcs(start[-1]), *regimes_at(coarse)]
    changed = [index for index in range(COARSE) if kinds[index] != kinds[index + 1]]
    begun = [(0.0, kinds[0])]
    if not changed:
        return begun
    fine = np.concatenate([(index + np.arange(1, FINE) / FINE) / COARSE for index in changed])
    within = np.reshape(regimes_at(fine)[: fine.size], (len(changed), FINE - 1))
    for index, row in zip(changed, within, strict=True):
        for step, kind in enumerate([*row.tolist(), kinds[index + 1]], start=1):
            if kind != begun[-1][1]:
                begun.append(((index + (step - 0.5) / FINE) / COARSE, kind))
    return begun


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Regimes along rays, one curve for each pin and force: where each regime begins, in s_c.

    Rays are added between neighbours with different regimes.
    """
    load_parameters = (LOAD_PARAMETER, -LOAD_PARAMETER)
    cases = [(force, load_parameter) for force in (0.0, 1.0) for load_parameter in load_parameters]
    rays_of: dict[tuple[float, float], dict[float, Ray]] = {case: {} for case in cases}
    starts: dict[tuple[float, float], Result] = {}
    for case, index in steps([(case, index) for case in cases for index in range(RAYS)], progress):
        if case not in starts:
            even = nodes - nodes % 4  # symmetric about x and y, like the contact without a force
            starts[case] = solve(problem_of(case[1]), [{"P": case[0]}], grid=Grid.circle(even))
        low, high = ((number % RAYS + 0.5) * 8.0 / RAYS for number in (index, index + 1))
        _add_rays(rays_of[case], starts[case], (low, high), HALVINGS)
    curves = []
    for (force, load_parameter), rays in rays_of.items():
        rows = [
            (turn, *(part * REACH * LARGEST * direction(turn)).tolist(), kind)
            for turn, ray in sorted(rays.items())
            for part, kind in ray
        ]
        columns = dict(zip(("ray", "sxx/s_c", "syy/s_c", "arcs"), np.array(rows).T, strict=True))
        curves.append(Curve({"P": force, "L_p": load_parameter}, columns))
    return curves


def _add_rays(rays: dict[float, Ray], start: Result, turns: tuple[float, float], halvings: int) -> None:
    """Add the rays at two turns, and rays between them where their regimes differ."""
    for turn in turns:
        if turn not in rays:
            unit = abs(interference.release_stress(start.problem))
            rays[turn] = regimes_along(start, REACH * LARGEST * unit * direction(turn))
    low, high = turns
    if halvings and [kind for _, kind in rays[low]] != [kind for _, kind in rays[high]]:
        middle = (0.5 * (low + (high if high > low else high + 8.0))) % 8.0
        _add_rays(rays, start, (low, middle), halvings - 1)
        _add_rays(rays, start, (middle, high), halvings - 1)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw a map for each pin and force."""
    figure, axes = panels(2, 2, height=3.35)
    head(
        figure,
        f"{NAMES[PAIR]}, plane strain, friction coefficient {FRICTION:g}; body force P",
        "sc: the stress sxx = syy that moves the edge of the hole by clearance or interference",
    )
    for panel, curve in zip(axes.flat, curves, strict=True):
        is_of_paper = curve.parameters["P"] > 0.0 and curve.parameters["L_p"] > 0.0
        _draw_map(panel, curve, 1.3 if is_of_paper else 0.0)  # no names over the cases of figure 10
        if is_of_paper:
            # The paper normalises stresses by F: sigma = L_p sxx/s_c.
            cases = np.array(list(DASHES)) / LOAD_PARAMETER
            panel.plot(*cases.T, linestyle="none", marker="s", markersize=5.0, color="black")
            corner = (cases.max(), 0.0)
            panel.annotate("figure 10", corner, (5.0, 0.0), textcoords="offset points", va="center", fontsize=9.0)
        pin = "clearance" if curve.parameters["L_p"] > 0.0 else "interference"
        force = f"load parameter {curve.parameters['L_p']:g}" if curve.parameters["P"] > 0.0 else "no force"
        panel.set_title(f"{pin} pin, {force}".replace(" -", " −"), fontsize=10.0)
        panel.set_aspect("equal")
        panel.set_xlim(-LARGEST, LARGEST)
        panel.set_ylim(-LARGEST, LARGEST)
        panel.grid(False)
    for panel in axes[-1]:
        panel.set_xlabel("horizontal remote stress  $s_{xx}/s_c$")
    for panel in axes[:, 0]:
        panel.set_ylabel("vertical remote stress  $s_{yy}/s_c$")
    return figure


def _rays(curve: Curve) -> dict[float, Ray]:
    rays: dict[float, Ray] = {}
    size = np.maximum(np.abs(curve["sxx/s_c"]), np.abs(curve["syy/s_c"])) / LARGEST / REACH
    for turn, part, kind in zip(curve["ray"].tolist(), size.tolist(), curve["arcs"].tolist(), strict=True):
        rays.setdefault(turn, []).append((part, int(kind)))
    return rays


def _draw_map(panel: Axes, curve: Curve, clear: float) -> None:
    """Fill the sectors between neighbouring rays, draw the borders, and write names farther than `clear` from 0."""
    rays = _rays(curve)
    turns = [*rays, min(rays) + 8.0]
    regimes = [*rays.values(), rays[min(rays)]]
    polygons: list[np.ndarray] = []
    fills: list[str] = []
    borders: list[np.ndarray] = []
    for first, second, one, two in zip(turns[:-1], turns[1:], regimes[:-1], regimes[1:], strict=True):
        if [kind for _, kind in one] == [kind for _, kind in two]:
            _add_sector((first, second), (one, two), polygons, fills, borders)
        else:
            middle = 0.5 * (first + second)
            _add_sector((first, middle), (one, one), polygons, fills, borders)
            _add_sector((middle, second), (two, two), polygons, fills, borders)
            borders += _borders_along(middle, one, two)
    panel.add_collection(PolyCollection(polygons, facecolors=fills, edgecolors=fills, linewidths=0.4))
    panel.add_collection(LineCollection(borders, colors="0.1", linewidths=1.2, capstyle="round"))
    _write_names(panel, rays, clear)


def _add_sector(
    turns: tuple[float, float],
    rays: tuple[Ray, Ray],
    polygons: list[np.ndarray],
    fills: list[str],
    borders: list[np.ndarray],
) -> None:
    """Add the regions and borders between two rays with the same regimes."""
    ends = [REACH * LARGEST * direction(turn) for turn in turns]
    starts = np.array([[part * end for part, _ in ray] + [end] for ray, end in zip(rays, ends, strict=True)])
    for index, (_, kind) in enumerate(rays[0]):
        polygons.append(np.array([starts[0, index], starts[0, index + 1], starts[1, index + 1], starts[1, index]]))
        fills.append(REGIMES[kind].colour)
        if index > 0:
            borders.append(starts[:, index])


def _borders_along(turn: float, one: Ray, two: Ray) -> list[np.ndarray]:
    """The parts of a ray beside which the regimes of two neighbouring rays differ."""
    end = REACH * LARGEST * direction(turn)
    cuts = sorted({part for ray in (one, two) for part, _ in ray} | {1.0})
    kinds = [[[kind for part, kind in ray if part <= cut][-1] for ray in (one, two)] for cut in cuts[:-1]]
    return [
        np.array([low * end, high * end])
        for low, high, (left, right) in zip(cuts[:-1], cuts[1:], kinds, strict=True)
        if left != right
    ]


def _write_names(panel: Axes, rays: dict[float, Ray], clear: float) -> None:
    """Write the name of each region at its point farthest from borders, and farther than `clear` from the middle."""
    raster = np.linspace(-LARGEST, LARGEST, 181)
    x, y = np.meshgrid(raster, raster)
    size = np.maximum(np.abs(x), np.abs(y)) / LARGEST / REACH
    turns = np.array(list(rays))
    nearest = np.abs(_turn(x, y)[..., None] - turns).argmin(axis=-1)
    kinds = np.empty(x.shape, dtype=int)
    for index, ray in enumerate(rays.values()):
        near = nearest == index
        begun = np.searchsorted([part for part, _ in ray], size[near], side="right") - 1
        kinds[near] = np.array([kind for _, kind in ray])[begun]
    for kind in np.unique(kinds).tolist():
        # A corridor that is narrower than a letter does not join regions.
        regions, count = ndimage.label(ndimage.binary_erosion(kinds == kind, iterations=4))
        for number in range(1, count + 1):
            inside = np.pad((regions == number) & (np.hypot(x, y) >= clear), 1)
            # Names are wider than high, so distances across count less.
            depth = ndimage.distance_transform_edt(inside, sampling=(1.0, 0.28))[1:-1, 1:-1]
            row, column = np.unravel_index(int(depth.argmax()), depth.shape)
            if depth[row, column] > 2.0:
                panel.text(raster[column], raster[row], REGIMES[kind].words, ha="center", va="center", fontsize=9.5)


def _turn(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The distance along the sides of the square, 0 to 8, of the rays through points: the inverse of `direction`."""
    size = np.maximum(np.maximum(np.abs(x), np.abs(y)), 1e-12)
    a, b = x / size, y / size
    right, top, left = a >= np.abs(b), b >= np.abs(a), -a >= np.abs(b)
    return np.select([right, top, left], [b, 2.0 - a, 4.0 - b], 6.0 + a) % 8.0


FIGURES = (
    PaperFigure(
        "regimes", "Regimes of contact under remote stress, Ti-6Al-4V/aluminium, mu = 0.40, L_p = 0.75 and -0.75",
        100, compute, draw,
    ),
)  # fmt: skip
