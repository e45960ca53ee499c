"""What a person or another program wants to read of a case and its states: tables and a summary.

Angles are in degrees from the bottom of the hole, counter-clockwise positive (towards +x, where Q points).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin import __version__
from fastpin.loading import LOADS, Block, LoadHistory, named_load
from fastpin.materials import Material
from fastpin.problem import Problem
from fastpin.quantities import QUANTITIES, quantity
from fastpin.state import periodic_from, series

if TYPE_CHECKING:
    from fastpin.casefile import Case
    from fastpin.state import Cycle, Result, State

LOAD_KIND = {
    "P": "force",
    "Q": "force",
    "M": "moment",
    "sxx": "traction",
    "syy": "traction",
    "rotation": "rotation",
}
"""What kind of quantity each load is, a key of :func:`units`."""

_SI = {
    "force": "N/m",
    "moment": "N",
    "traction": "Pa",
    "length": "m",
    "displacement": "m",
    "rotation": "rad",
    "energy": "J/m",
}
_DIMENSIONLESS = {
    "force": "F",
    "moment": "F R",
    "traction": "F/R",
    "length": "R",
    "displacement": "F beta*",
    "rotation": "F beta*/R",
    "energy": "F^2 beta*",
}
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p"}
_MAX_ROWS = 40
_DEGREE = math.degrees(1.0)


def units(problem: Problem) -> dict[str, str]:
    """The unit of every kind of quantity: SI, or those of the paper for a dimensionless problem."""
    return dict(_DIMENSIONLESS if problem.dimensionless else _SI)


def from_bottom(angle: float) -> float:
    """An angle in rad as degrees from the bottom of the hole, in (-180, 180]."""
    degrees = math.degrees(angle) + 90.0
    return 180.0 - (180.0 - degrees) % 360.0


def interval_from_bottom(start: float, stop: float) -> tuple[float, float]:
    """An interval in rad as degrees from the bottom; the stop may exceed 180."""
    first = from_bottom(start)
    return first, first + math.degrees(stop - start)


def in_degrees(name: str, value: float) -> float:
    """A quantity as it is reported: angles from the bottom of the hole and widths in degrees, all else as it is."""
    kind = quantity(name).kind
    if kind == "angle":
        return from_bottom(value) if math.isfinite(value) else math.nan
    return math.degrees(value) if kind == "width" else value


def bar_in_degrees(name: str, bar: float) -> float:
    """The error bar of a quantity as it is reported."""
    return math.degrees(bar) if quantity(name).kind in ("angle", "width") else bar


def scaled(values: Sequence[float], unit: str) -> tuple[float, str]:
    """A factor and a unit with an SI prefix in which the largest of `values` reads well.

    Units of a dimensionless problem (those with an F) keep the factor 1.
    """
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    if "F" in unit or unit == "R" or largest == 0.0:
        return 1.0, unit
    exponent = 3 * math.floor(math.log10(largest * (1.0 + 1e-12)) / 3.0)
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**-exponent, _PREFIXES[exponent] + unit


def load_point(state: State) -> float:
    """Where in the history a state is: 1 at the first corner, 1.5 halfway from there to the second."""
    return state.step + state.fraction


def acting_loads(loads: Sequence[Mapping[str, float]]) -> list[str]:
    """Names of the loads that are not zero throughout."""
    return [name for name in LOADS if any(load.get(name, 0.0) != 0.0 for load in loads)]


def named_loads(problem: Problem, load: Mapping[str, float]) -> str:
    """The loads that are not zero, with their units."""
    unit = units(problem)
    acting = acting_loads([load])
    return ", ".join(f"{name} = {_quantity(load[name], unit[LOAD_KIND[name]], 5)}" for name in acting) or "no load"


# -- text ----------------------------------------------------------------------------------------------------


def describe(case: Case) -> str:
    """What a case says, as text: pair, contact, loads with their load parameter, solver."""
    problem, options = case.problem, case.options
    pair = problem.pair
    alpha, beta = pair.dundurs()
    unit = units(problem)
    if problem.dimensionless:
        scale = "dimensionless: R = 1, F = 1, beta* = 1"
        size = f"load parameter {problem.clearance:.4g}"
    else:
        scale = f"beta* = {pair.beta_star:.4g} 1/Pa"
        kind = "clearance" if problem.clearance >= 0.0 else "clearance (interference)"
        size = f"hole radius {_quantity(problem.hole_radius, 'm')}, {kind} {_quantity(problem.clearance, 'm')}"
    pin_load = {"centre": "force at the centre", "body": "uniform body force"}[problem.pin_load]
    hub = ""
    if problem.rotation == "fixed":
        hub = (
            " at the paper's datum"
            if problem.hub_radius is None
            else f" at radius {problem.hub_radius:g} {unit['length']}"
        )
    if options.arc is None:
        where = "arc chosen by the solver"
    elif options.arc[1] - options.arc[0] >= 2.0 * math.pi:
        where = "on the whole circle"
    else:
        where = f"arc from {options.arc[0]:g} to {options.arc[1]:g} rad"
    method = options.method if options.method == "path" else f"increment, {options.increments} a corner"
    rows = [
        ("pin", _material(pair.pin, problem.dimensionless)),
        ("plate", _material(pair.plate, problem.dimensionless)),
        ("pair", f"plane {pair.plane}, Dundurs alpha = {alpha:.4f}, beta = {beta:.4f}, {scale}"),
        ("contact", f"{size}, friction {problem.friction:g}"),
        ("loading", f"{pin_load}, rotation {problem.rotation}{hub}"),
        ("solver", f"{method}, {options.nodes} nodes, {where}"),
        ("loads", f"{len(case.history):,} corners, reached one after the other from no load"),
    ]
    if options.keep != "all":
        rows.append(("states", f"kept: {options.keep}"))
    text = [case.title] if case.title else []
    text += [f"{name:8s} {value}" for name, value in rows]
    return "\n".join([*text, "", _load_table(problem, case.history)])


def _load_table(problem: Problem, history: LoadHistory) -> str:
    """The corners of every block for the first time through."""
    numbers, counts, loads = [], [], []
    last = np.zeros(len(LOADS))
    begin = 1
    for block in history.blocks:
        shown = shown_rows(len(block.given))
        values = LoadHistory.from_array(block.given).values(initial=last)
        numbers += [f"{begin + k}" for k in shown]
        counts += [f"x {block.count:,}" if block.count > 1 else "" for _ in shown]
        loads += [named_load(values[k]) for k in shown]
        last, begin = values[-1], begin + block.corners
    columns = [("corner", "", numbers)]
    if any(counts):
        columns.append(("times", "", counts))
    columns += _load_columns(problem, loads)
    forces = [math.hypot(load["P"], load["Q"]) for load in loads]
    columns.append(("L_p", "", [f"{problem.load_parameter(force):.4g}" if force else "-" for force in forces]))
    return table(columns, sum(len(block.given) for block in history.blocks) - len(loads))


def state_table(problem: Problem, states: Sequence[State], hidden: int = 0) -> str:
    """The states as a table with one line each; `hidden` is how many have been left out of their middle.

    Error bars, where there are any, stand behind +-; that of an interval is the larger one of its ends, ? means none.
    """
    unit = units(problem)

    def column(name: str, digits: int = 5, natural: float = 0.0) -> tuple[str, str, list[str]]:
        each = QUANTITIES[name]
        values = [each.of(state) for state in states]
        # What is zero but for rounding, against the column and a natural size, is shown as zero.
        noise = 1e-9 * max(natural, max((abs(value) for value in values if math.isfinite(value)), default=0.0))
        cleaned = [0.0 if abs(value) <= noise else value for value in values]
        factor, label = scaled(cleaned, unit[each.kind])
        bars = [_bar(state, factor, name) for state in states]
        return (
            each.label,
            label,
            [f"{value * factor:.{digits}g}{bar}" for value, bar in zip(cleaned, bars, strict=True)],
        )

    def angles(name: str) -> tuple[str, str, list[str]]:
        return "at", "deg", [_angle(QUANTITIES[name].of(state)) + _bar(state, _DEGREE, name) for state in states]

    strain = problem.pair.beta_star * max((state.peak_pressure for state in states), default=0.0)
    energy = max((abs(state.energy) for state in states), default=0.0)
    columns = [("load point", "", [_point(state) for state in states])]
    columns += _load_columns(problem, [state.load for state in states])
    columns += [
        column("peak_pressure"),
        angles("peak_pressure_angle"),
        column("peak_shear"),
        angles("peak_shear_angle"),
        ("contact", "deg", [_intervals(state, "contact") for state in states]),
        ("stick", "deg", [_intervals(state, "stick") for state in states]),
        column("rotation", 4, strain),
        column("dissipation", 4, energy),
        ("residual", "", [f"{max(state.residuals.values(), default=0.0):.0e}" for state in states]),
    ]
    return table(columns, hidden)


def cycle_lines(problem: Problem, cycles: Sequence[Cycle]) -> list[str]:
    """What the cycles of each block have changed, a line each."""
    lines = [_series_line(problem, one) for one in series(cycles)]
    if len(lines) > _MAX_ROWS // 2:
        lines[_MAX_ROWS // 4 : -_MAX_ROWS // 4] = [f"... {len(lines) - _MAX_ROWS // 2} more blocks of cycles ..."]
    return lines


def _first_and_last(values: list[float], unit: str, digits: int) -> list[str]:
    """What is zero but for rounding, against the largest, is shown as zero."""
    noise = 1e-9 * max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    shown = [0.0 if abs(value) <= noise else value for value in (values[0], values[-1])]
    return ["not known" if math.isnan(value) else _quantity(value, unit, digits) for value in shown]


def _series_line(problem: Problem, cycles: list[Cycle]) -> str:
    first, last = cycles[0], cycles[-1]
    steady = periodic_from(cycles)
    kind = units(problem)
    dissipation = _first_and_last([cycle.dissipation for cycle in cycles], kind["energy"], 4)
    turned = _first_and_last([cycle.rotation_change for cycle in cycles], kind["rotation"], 3)
    state = f"periodic from cycle {steady.number} on" if steady else "not yet periodic"
    corners = f"{last.length} corner{'s' if last.length > 1 else ''}"
    where = f"to corner {last.corner + 1:,}"
    text = f"{where}, {last.number:,} cycle{'s' if last.number > 1 else ''} of {corners}: {state}"
    if len(cycles) == 1:
        return f"{text}; dissipated {dissipation[0]}, turned {turned[0]}"
    change = max(last.pressure_change, last.shear_change)
    return (
        f"{text}; tractions changed by {max(first.pressure_change, first.shear_change):.2g} (first) and {change:.2g} "
        f"(last) of the peak pressure, dissipated {dissipation[0]} and {dissipation[1]}, "
        f"turned {turned[0]} and {turned[1]}"
    )


def _load_columns(problem: Problem, loads: Sequence[Mapping[str, float]]) -> list[tuple[str, str, list[str]]]:
    unit = units(problem)
    columns = []
    acting = acting_loads(loads)
    for name in acting:
        # Loads of one kind share their unit.
        alike = [load[other] for other in acting for load in loads if LOAD_KIND[other] == LOAD_KIND[name]]
        factor, label = scaled(alike, unit[LOAD_KIND[name]])
        columns.append((name, label, [f"{load[name] * factor:.5g}" for load in loads]))
    return columns


def shown_rows(count: int) -> list[int]:
    """The rows of a table of `count` that are printed: all of a short one, of a long one its beginning and its end."""
    half = _MAX_ROWS // 2
    return list(range(count)) if count <= _MAX_ROWS else [*range(half), *range(count - half, count)]


def table(columns: Sequence[tuple[str, str, list[str]]], hidden: int = 0) -> str:
    """Lines of text, no more than so many; `hidden` rows in the middle are not even in the columns."""
    count = len(columns[0][2])
    middle = min(count, _MAX_ROWS) // 2
    hidden += max(count - _MAX_ROWS, 0)
    if count > _MAX_ROWS:
        columns = [(name, unit, [cells[k] for k in shown_rows(count)]) for name, unit, cells in columns]
    widths = [max(len(cell) for cell in (name, unit, *cells)) for name, unit, cells in columns]
    lines = [[name for name, _, _ in columns], [unit for _, unit, _ in columns]]
    lines += [[cells[k] for _, _, cells in columns] for k in range(len(columns[0][2]))]
    text = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
    if hidden:
        text.insert(2 + middle, f"... {hidden:,} more ...")
    return "\n".join(text)


def _point(state: State) -> str:
    return f"{load_point(state):.3f}".rstrip("0").rstrip(".")


def _angle(angle: float | None) -> str:
    return "-" if angle is None or not math.isfinite(angle) else f"{from_bottom(angle):z.2f}"


def _bar(state: State, factor: float, *names: str) -> str:
    """The error bar, the larger one of several quantities, to be written after them; nothing where there is none."""
    bars = [(state.error_bars or {}).get(name, math.nan) for name in names]
    if any(math.isnan(bar) for bar in bars):
        return ""
    return f" +-{factor * max(bars):.2g}" if math.isfinite(max(bars)) else " +-?"


def _intervals(state: State, zone: str) -> str:
    parts = []
    for number, (start, stop) in enumerate(getattr(state, zone), start=1):
        first, last = interval_from_bottom(start, stop)
        bar = _bar(state, _DEGREE, f"{zone}_{number}_start", f"{zone}_{number}_stop")
        parts.append("all round" if stop - start >= 2.0 * math.pi - 1e-9 else f"{first:z.2f} to {last:z.2f}{bar}")
    return ", ".join(parts) or "none"


def _quantity(value: float, unit: str, digits: int = 6) -> str:
    factor, label = scaled([value], unit)
    return f"{value * factor:.{digits}g} {label}"


def _material(material: Material, dimensionless: bool) -> str:
    if material.is_rigid:
        return "rigid"
    name = f"{material.name}, " if material.name else ""
    modulus = f"E = {material.E:.4g} / beta*" if dimensionless else f"E = {_quantity(material.E, 'Pa')}"
    return f"{name}{modulus}, nu = {material.nu:.4g}"


# -- machine-readable ----------------------------------------------------------------------------------------


def summary(
    case: Case,
    result: Result | None,
    error: str | None = None,
) -> dict[str, Any]:
    """The case and its states as a dict that goes to JSON as it is; what is not finite becomes None.

    `result` is None where not even a first state was reached, `error` says why it is incomplete. ``units``
    names the unit of every kind of quantity; angles are in degrees from the bottom of the hole.
    """
    problem, pair = case.problem, case.problem.pair
    alpha, beta = pair.dundurs()
    document = {
        "fastpin": __version__,
        "title": case.title,
        "complete": result is not None and result.complete,
        "error": error,
        "units": {**units(problem), "angle": "deg from the bottom of the hole, counter-clockwise"},
        "problem": {
            "pin": _material_summary(pair.pin),
            "plate": _material_summary(pair.plate),
            "plane": pair.plane,
            "dundurs": {"alpha": alpha, "beta": beta, "convention": "usual"},
            "beta_star": pair.beta_star,
            "hole_radius": problem.hole_radius,
            "clearance": problem.clearance,
            "friction": problem.friction,
            "pin_load": problem.pin_load,
            "rotation": problem.rotation,
            "hub_radius": problem.hub_radius,
            "dimensionless": problem.dimensionless,
        },
        "history": {"loads": list(LOADS), "blocks": [_block_summary(block) for block in case.history.blocks]},
        "solver": case.options.keywords(),
        "statistics": {} if result is None else result.statistics,
        "states": [] if result is None else [_state_summary(state) for state in result],
        "cycles": [] if result is None else [cycle._asdict() for cycle in result.cycles],
    }
    return plain(document)


def _block_summary(block: Block) -> dict[str, Any]:
    """A block of the history; what a corner does not give is None."""
    return {"repeat": block.count, "corners": block.given.tolist()}


def _material_summary(material: Material) -> dict[str, Any]:
    modulus = None if material.is_rigid else material.E
    return {"name": material.name, "rigid": material.is_rigid, "E": modulus, "nu": material.nu}


def _state_summary(state: State) -> dict[str, Any]:
    resultants, bars = state.resultants, state.error_bars
    return {
        "load_point": load_point(state),
        "step": state.step,
        "fraction": state.fraction,
        "load": state.load,
        "in_contact": state.in_contact,
        **{name: in_degrees(name, each.of(state)) for name, each in QUANTITIES.items() if name not in resultants},
        "contact": [interval_from_bottom(*interval) for interval in state.contact],
        "stick": [interval_from_bottom(*interval) for interval in state.stick],
        "slip": [(*interval_from_bottom(start, stop), sign) for start, stop, sign in state.slip_zones],
        "energy": state.energy,
        "resultants": resultants,
        "residuals": state.residuals,
        "error_bars": bars and {name: bar_in_degrees(name, bar) for name, bar in bars.items()},
    }


def plain(value: Any) -> Any:
    """`value` with numpy's numbers as Python's, tuples as lists and None for what JSON can't say."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
