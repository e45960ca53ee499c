"""Relative errors of half-plane formulas against L_p: from which load parameter on they are right.

An error is half-plane over fastpin minus 1, with its sign in the CSV. Errors that are too small to be distinguished
from the discretisation error are left out (`floor`). The half-plane formulas are used in the usual way, with Hertz's
half-width and peak pressure and with arcs for lengths. Materials are similar and mu = 0.5 unless said otherwise.

*Hertz*: peak pressure and half-width under P. Without friction, Persson's closed form replaces fastpin.

*Cattaneo-Mindlin*: pin held, centre load, P, then Q = +-0.6 mu P. The errors are: stick zone over contact, largest
shear, and int |difference of T| over int mu N. The formula's middle is the bottom of the hole, or is moved to the
middle of the contact. The stick zone after -Q is blurred: its border lies beside the border that +Q left.

*Bulk stress*: a remote stress that rises together with +Q. At the bottom of the hole it makes the hoop stress
sigma = 3 sxx - syy. This is the bulk stress of the half-plane, here tension. It should move the stick zone by
e = a sigma/(4 mu p0) = 0.15 a to the side to which Q pushes the pin. The shift is the distance from the middle of the
contact to the middle of the stick zone, over the half-width. Without bulk stress the shift is not zero, so the shift
added by the stress has an error of its own. The stress also changes the curvature of the hole, at the bottom in
proportion to 7 sxx - 5 syy. With syy = 1.4 sxx the curvature stays (balanced), with syy = 0 it changes (uniaxial).

*Unlike materials*: Dundurs' beta = +-0.1438 (alpha = +-0.5), stick zone over contact under P with mu = 0.5, 1 and
1.5 |beta|, free pin, centre load. The reference is two half-planes with pressure and shear coupled
(`unlike_half_planes`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.model import MATERIALS, MaterialPair, Problem, angles
from fastpin.published.records import PaperFigure, Report, grey, head, legend_below, marked, panels, steps
from fastpin.solver.solving import solve
from fastpin.states.state import State
from fastpin.verification import closed_forms

LEVELS = (0.05, 0.01)
"""Relative errors at which a formula counts as right."""

SIMILAR = MaterialPair(MATERIALS["steel"], MATERIALS["steel"])
FRICTION, LOW_FRICTION = 0.5, 0.2
RATIO = 0.6
"""Q/(mu P)"""
SHIFT = 0.15
"""e/a"""
REMOTE = {"balanced": {"sxx": 1.0 / 1.6, "syy": 1.4 / 1.6}, "uniaxial": {"sxx": 1.0 / 3.0}}
"""Remote stresses whose hoop stress at the bottom of the hole is one."""
BETA = 0.1438
MU_OVER_BETA = (0.5, 1.0, 1.5)
UNLIKE = {sign: MaterialPair.from_dundurs(sign * 0.5, sign * BETA, nu_pin=0.3) for sign in (1, -1)}

LOAD_PARAMETERS = tuple(10.0 ** (k / 3) for k in range(-3, 13))
UNLIKE_LOAD_PARAMETERS = tuple(10.0 ** (k / 2) for k in range(-2, 11))

FLOOR = 1e-3
"""Smallest error of most quantities that exceeds the discretisation error at 400 nodes."""


def floor(quantity: str, nodes: int) -> float:
    """Return the smallest error of a quantity that exceeds the discretisation error with `nodes` nodes."""
    larger = {"stick size, -Q": 8e-3, "stick size, -Q, mu = 0.2": 8e-3, "peak shear, -Q": 6e-3}
    larger |= {"what the stress adds, balanced": 3e-3, "what the stress adds, uniaxial": 3e-3}
    if quantity.startswith("mu ="):  # unlike materials
        larger[quantity] = 0.03 if quantity.startswith("mu = 0.5 ") else 8e-3
    return larger.get(quantity, FLOOR) * max(1.0, 400.0 / nodes)


Error = tuple[str, str, float]
"""Panel, quantity and relative error."""


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Errors against L_p, a curve for each quantity, with the L_p from which on the formula is right to 5 % and 1 %."""
    cases = [("like", value, mu) for mu in (FRICTION, LOW_FRICTION) for value in LOAD_PARAMETERS]
    cases += [("unlike", value, ratio) for ratio in MU_OVER_BETA for value in UNLIKE_LOAD_PARAMETERS]
    limits = {ratio: unlike_half_planes(ratio * BETA, BETA) for ratio in MU_OVER_BETA}
    rows: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for kind, load_parameter, value in steps(cases, progress):
        if kind == "like":
            errors = like_errors(load_parameter, value, nodes)
        else:
            errors = unlike_errors(load_parameter, value, limits[value], nodes)
        for panel, quantity, error in errors:
            rows.setdefault((panel, quantity), []).append((load_parameter, error))
    return [
        _curve(panel, quantity, np.array(pairs), floor(quantity, nodes)) for (panel, quantity), pairs in rows.items()
    ]


def _curve(panel: str, quantity: str, rows: np.ndarray, least: float) -> Curve:
    load_parameter, error = rows.T
    limits = [threshold(load_parameter, error, level) if level > least else math.nan for level in LEVELS]
    names = [f"right_to_{100.0 * level:g}_percent_from" for level in LEVELS]
    right = dict(zip(names, limits, strict=True))
    shown = np.where(np.abs(error) >= least, error, math.nan)
    return Curve({"panel": panel, "quantity": quantity, **right}, {"L_p": load_parameter, "error": shown})


def threshold(load_parameter: np.ndarray, error: np.ndarray, level: float) -> float:
    """Return the L_p from which on |error| stays below `level`, to three digits, interpolated between logarithms.

    The result is 0 if all errors are below, inf if the last one is not.
    """
    size = np.abs(error)
    above = np.flatnonzero(size >= level)
    if above.size == 0:
        return 0.0
    last = above[-1]
    if last == size.size - 1:
        return math.inf
    pair = slice(last, last + 2)
    value = np.exp(np.interp(-math.log(level), -np.log(size[pair]), np.log(load_parameter[pair])))
    return float(f"{value:.3g}")


def stick_and_contact(state: State) -> tuple[float, float, float, float]:
    """Return middle and half-width of the widest stick zone, then of the contact, rad."""
    ((start, stop),) = state.contact
    left, right = max(state.stick, key=lambda zone: zone[1] - zone[0])
    return 0.5 * (left + right), 0.5 * (right - left), 0.5 * (start + stop), 0.5 * (stop - start)


def like_errors(load_parameter: float, friction: float, nodes: int, ratio: float = RATIO) -> Iterator[Error]:
    """Yield the errors of Hertz, of Cattaneo-Mindlin at Q = +-`ratio` mu P, and of bulk stress.

    Hertz and bulk stress need `friction` = FRICTION, bulk stress also `ratio` = RATIO and an L_p of at least 1. For
    smaller L_p the stress drives the stick zone to the edge.
    """
    problem = Problem.from_load_parameter(SIMILAR, load_parameter, friction, "centre", "fixed")
    Q = ratio * friction
    pushed, forward, back = solve(problem, [{"P": 1.0}, {"Q": Q}, {"Q": -Q}], nodes=nodes)
    half = float(closed_forms.hertz_half_angle(load_parameter))
    peak = float(closed_forms.hertz_peak_pressure(load_parameter))
    low = "" if friction == FRICTION else f", mu = {friction:g}"
    if not low:
        exact = float(closed_forms.persson_half_angle(load_parameter))
        yield "Hertz", "half-width", half / exact - 1.0
        yield "Hertz", "peak pressure", peak / float(closed_forms.persson_pressure(0.0, exact)) - 1.0
        yield "Hertz", "half-width, with friction", half / stick_and_contact(pushed)[3] - 1.0
        yield "Hertz", "peak pressure, with friction", peak / pushed.peak_pressure - 1.0
    half_plane_stick = float(closed_forms.cattaneo_mindlin_stick_ratio(ratio))
    half_plane_shear = friction * peak * math.sqrt(ratio)  # at the border of the stick zone
    corners: list[tuple[State, str, float, closed_forms.Branch]] = [
        (forward, "+Q", ratio, "loading"),
        (back, "-Q", -ratio, "unloading"),
    ]
    for state, load, now, branch in corners:
        _, stick, middle, contact = stick_and_contact(state)
        yield "Cattaneo-Mindlin", f"stick size, {load}{low}", half_plane_stick * contact / stick - 1.0
        yield "Cattaneo-Mindlin", f"peak shear, {load}{low}", half_plane_shear / abs(state.peak_shear) - 1.0
        for moved, origin in (("", angles.BOTTOM), (", moved", middle)):
            x = state.theta - origin
            # The shear on the pin opposes Q.
            shear = -closed_forms.cattaneo_mindlin_shear(x, half, peak, friction, now, ratio, branch)
            weights = state.grid.weights
            difference = weights @ np.abs(state.shear - shear) / (friction * weights @ state.pressure)
            yield "Cattaneo-Mindlin", f"distribution{moved}, {load}{low}", float(difference)
    if not low and ratio == RATIO and load_parameter > 0.99:
        yield from bulk_errors(problem, shift(forward), nodes)


def shift(state: State) -> float:
    """Return the distance from the middle of the contact to the middle of the stick zone, over the half-width."""
    middle_of_stick, _, middle, contact = stick_and_contact(state)
    return (middle_of_stick - middle) / contact


def bulk_shift(problem: Problem, stress: str, e: float, nodes: int) -> float:
    """Return the shift after P, and then +Q with a remote stress.

    The stress is the one that makes the shift `e` in the half-plane (negative: compression).
    """
    load_parameter = problem.load_parameter(1.0)
    sigma = 4.0 * problem.uniform_friction * float(closed_forms.hertz_peak_pressure(load_parameter)) * e
    remote = {name: sigma * part for name, part in REMOTE[stress].items()}
    return shift(solve(problem, [{"P": 1.0}, {"Q": RATIO * problem.uniform_friction, **remote}], nodes=nodes)[-1])


def bulk_errors(problem: Problem, without: float, nodes: int) -> Iterator[Error]:
    """Yield the errors of the shift by bulk stress. `without` is the shift by Q alone."""
    for stress in REMOTE:
        total = bulk_shift(problem, stress, SHIFT, nodes)
        yield "Bulk stress", f"shift, {stress}", SHIFT / total - 1.0
        yield "Bulk stress", f"what the stress adds, {stress}", SHIFT / (total - without) - 1.0


def unlike_errors(
    load_parameter: float, ratio: float, limit: float, nodes: int, pin_load: PinLoad = "centre"
) -> Iterator[Error]:
    """Yield the errors of stick zone over contact of both pairs, with mu = `ratio` |beta|.

    `limit` is the value of half-planes, see :func:`unlike_half_planes`.
    """
    for sign, pair in UNLIKE.items():
        problem = Problem.from_load_parameter(pair, load_parameter, ratio * BETA, pin_load)
        _, stick, _, contact = stick_and_contact(solve(problem, [{"P": 1.0}], nodes=nodes)[-1])
        relation = ">" if sign > 0 else "<"
        yield "Unlike materials", f"mu = {ratio:g} |beta|, beta {relation} 0", limit * contact / stick - 1.0


def unlike_half_planes(friction: float, beta: float, cells: int = 60) -> float:
    """Return stick zone over contact of unlike half-planes in normal loading, with pressure and shear coupled.

    By Spence's self-similarity a flat punch has the same ratio c. The punch does not slip for |x| < c, and has
    T = mu N sign(x) beyond. c is the value for which the shear is finite at |x| = c. Tractions are constant on cells
    that crowd towards +-1 and +-c.
    """

    def singularity(c: float) -> float:
        crowded = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 2 * cells + 1)))
        crowded *= crowded * (3.0 - 2.0 * crowded)
        inner, outer = c * (2.0 * crowded - 1.0), c + (1.0 - c) * crowded[::2]
        ends = np.r_[-outer[::-1], inner[1:-1], outer]
        middle, width = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
        offset = middle[:, None] - ends
        integral = offset * np.log(np.abs(offset)) - offset
        normal = integral[:, :-1] - integral[:, 1:]
        n = middle.size
        coupling = 0.5 * np.pi * beta * width * np.sign(np.subtract.outer(np.arange(n), np.arange(n)))
        sticks = np.abs(middle) < c
        shear_of_pressure = np.diag(np.where(sticks, 0.0, friction * np.sign(middle)))
        shear_of_stick = np.eye(n)[:, sticks]
        # Unknowns: pressure, shear where it sticks, approach. Rows: flat, no slip where it sticks, a load of one.
        no_slip = np.hstack([normal @ shear_of_pressure + coupling, normal @ shear_of_stick, np.zeros((n, 1))])
        flat = np.hstack([normal - coupling @ shear_of_pressure, -coupling @ shear_of_stick, np.ones((n, 1))])
        load = np.r_[width, np.zeros(np.count_nonzero(sticks) + 1)]
        right = np.r_[np.zeros(n + np.count_nonzero(sticks)), 1.0]
        solution = np.linalg.solve(np.vstack([flat, no_slip[sticks], load]), right)
        at_border = np.flatnonzero(sticks)[-8:-2]
        excess = solution[n:-1][-8:-2] - friction * solution[at_border]
        root = np.sqrt(c - middle[at_border])
        return float(np.linalg.lstsq(np.column_stack([1.0 / root, root, root**3]), excess)[0][0])

    return float(brentq(singularity, 0.05, 0.985))


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw one panel for each theory, with solid lines at 5 % and 1 %."""
    figure, axes = panels(2, 2, height=3.6)
    head(
        figure,
        f"P at the centre of the pin, plane strain; friction coefficient {FRICTION:g} unless said otherwise",
        f"unlike bodies: Dundurs' β = ±{BETA:g}",
        "curves end where the grid has errors as large, and dip where an error changes its sign",
    )
    for panel, (name, theory) in zip(axes.flat, THEORIES.items(), strict=True):
        for curve in curves:
            style = theory.lines.get(str(curve.parameters["quantity"]))
            if curve.parameters["panel"] == name and style is not None:
                panel.plot(curve["L_p"], np.abs(curve["error"]), **marked(*style))
        for level in LEVELS:
            panel.axhline(level, color="0.2", linewidth=0.9, zorder=0)
        colours = [(words, marked(colour)) for colour, words in enumerate(theory.colours)]
        dashes = [(words, grey(dash)) for dash, words in enumerate(theory.dashes)]
        legend_below(panel, [*colours, *dashes], 2)
        _error_axes(panel, theory.title)
    for panel in axes[0]:
        degrees = panel.secondary_xaxis(
            "top",
            functions=(
                lambda load_parameter: np.degrees(1.0 / np.sqrt(math.pi * np.maximum(load_parameter, 1e-9))),
                lambda angle: 1.0 / (math.pi * np.radians(np.maximum(angle, 1e-9)) ** 2),
            ),
        )
        degrees.set_xlabel("half-angle of Hertz's contact (deg)", fontsize=8.0)
        degrees.set_xticks([60.0, 30.0, 10.0, 3.0, 1.0, 0.3, 0.1], labels=["60", "30", "10", "3", "1", "0.3", "0.1"])
        degrees.set_xticks([], minor=True)
        degrees.tick_params(labelsize=8.0)
    return figure


def _error_axes(panel: Axes, title: str) -> None:
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlim(LOAD_PARAMETERS[0], UNLIKE_LOAD_PARAMETERS[-1])
    panel.set_ylim(0.7 * FLOOR, 1.0)
    panel.set_yticks([1e-3, 1e-2, 5e-2, 1e-1, 1.0], labels=["0.1 %", "1 %", "5 %", "10 %", "100 %"])
    panel.set_yticks([], minor=True)
    panel.set_xlabel("load parameter  $L_p$")
    panel.set_ylabel("error of the half-plane")
    panel.set_title(title, fontsize=9.0)


@dataclass(frozen=True)
class Theory:
    """A panel.

    Attributes
    ----------
    title : str
    colours, dashes : tuple of str
        What each colour and each kind of dashes shows.
    lines : dict
        Colour and dashes of each quantity that is drawn.
    """

    title: str
    colours: tuple[str, ...]
    dashes: tuple[str, ...]
    lines: dict[str, tuple[int, int]]


THEORIES = {
    "Hertz": Theory(
        "P alone: Hertz",
        ("width of the contact", "peak pressure"),
        ("no friction", f"friction {FRICTION:g}"),
        {
            "half-width": (0, 0),
            "half-width, with friction": (0, 1),
            "peak pressure": (1, 0),
            "peak pressure, with friction": (1, 1),
        },
    ),
    "Cattaneo-Mindlin": Theory(
        f"P, then Q = ±{RATIO:g} μP: Cattaneo and Mindlin",
        ("shear  ∫|ΔT| / ∫μN", "same, formula centred", "largest shear", "stick zone"),
        ("+Q", "−Q after +Q", f"+Q, friction {LOW_FRICTION:g}"),
        {
            "distribution, +Q": (0, 0),
            "distribution, -Q": (0, 1),
            f"distribution, +Q, mu = {LOW_FRICTION:g}": (0, 2),
            "distribution, moved, +Q": (1, 0),
            "peak shear, +Q": (2, 0),
            "peak shear, -Q": (2, 1),
            f"peak shear, +Q, mu = {LOW_FRICTION:g}": (2, 2),
            "stick size, +Q": (3, 0),
            "stick size, -Q": (3, 1),
        },
    ),
    "Bulk stress": Theory(
        "P, then +Q and a remote stress: shift of the stick zone",
        ("whole shift", "part due to the stress"),
        ("$s_{yy}$ = 1.4 $s_{xx}$", "$s_{yy}$ = 0"),
        {
            "shift, balanced": (0, 0),
            "shift, uniaxial": (0, 1),
            "what the stress adds, balanced": (1, 0),
            "what the stress adds, uniaxial": (1, 1),
        },
    ),
    "Unlike materials": Theory(
        "P alone, unlike bodies: width of the stick zone",
        tuple(f"friction {ratio:g} |β|" for ratio in MU_OVER_BETA),
        ("β > 0 (softer plate)", "β < 0 (softer pin)"),
        {
            f"mu = {ratio:g} |beta|, beta {relation} 0": (colour, dashes)
            for colour, ratio in enumerate(MU_OVER_BETA)
            for dashes, relation in enumerate("><")
        },
    ),
}
"""The panels, by the names of their quantities in the numbers."""


FIGURES = (
    PaperFigure("half-plane", "Relative error of half-plane formulas against the load parameter", 201, compute, draw),
)
