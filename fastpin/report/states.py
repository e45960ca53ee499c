"""States and load cycles as text.

Angles are in degrees from the bottom of the hole, counter-clockwise positive (towards +x, where Q points).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from fastpin import storage
from fastpin.assess import outputs
from fastpin.assess.outputs import ROUNDING
from fastpin.model import LOADS, Case, Problem, checks, ties
from fastpin.model.angles import from_bottom, interval_from_bottom
from fastpin.model.points import EDGES, Body, edge_body, edge_words, elastic_bodies, has_outline
from fastpin.model.units import Unit, units
from fastpin.reading.zones import is_all_round
from fastpin.report.case import load_columns
from fastpin.solver import Interrupted, Result
from fastpin.states import Regime, State, walking
from fastpin.states.cycles import Cycle, consecutive_cycles, periodic_from
from fastpin.states.error_bars import known_bar
from fastpin.states.margins import part_of
from fastpin.states.quantities import QUANTITIES, load_point, point_name, sizes

LOAD_POINT = "load point"
"""Heading of the first column."""

MOST_COMPARED = 1_000
"""Most different states whose rows are compared: a row takes some 2 ms. Of more states no row is folded."""

IN_PHASE = 1e-9
"""Largest difference of two load points, in cycles, that is rounding. A larger one only lets more states be read."""

_DEGREE = math.degrees(1.0)

LEAST_REPEATED = 3
"""Least rows that one line replaces: of fewer rows the table is as short."""

LONGEST_PERIOD = 1_000
"""Most rows of a period that is looked for: a table of more rows is cut before it repeats itself."""

COUNTED = {
    "jumps": "the pin snapped {count} times; work does not balance there",
    "released": "{count} times a narrow contact with next to no force was let go and lost its memory",
}
"""Notes on counts of the statistics that are not zero."""


@dataclass(frozen=True)
class TableRows:
    """The rows of a table of states.

    Attributes
    ----------
    lines : list of int, Repeat or LeftOut
        The lines of the table, see :mod:`fastpin.assess.outputs`. A row has the place of its state as number.
    points : ndarray, shape (rows,)
        Load points of all rows.
    """

    lines: list[outputs.TableLine]
    points: np.ndarray

    @property
    def printed(self) -> list[int]:
        """The places of the states that have a line of their own."""
        return outputs.printed_rows(self.lines)

    @property
    def names(self) -> list[str]:
        """The load points of all rows as text."""
        return [point_name(point) for point in self.points]

    @property
    def gaps(self) -> dict[int, str]:
        """Words on the rows between two printed ones, by the number of rows printed before them."""
        found: dict[int, str] = {}
        names, printed = self.names, 0
        for line in self.lines:
            if isinstance(line, int):
                printed += 1
            else:
                words = outputs.line_words(LOAD_POINT, names, line)
                found[printed] = f"{found[printed]}; {words}" if printed in found else words
        return found


def table_rows(
    problem: Problem,
    states: Sequence[State],
    rows: np.ndarray | None = None,
    points: np.ndarray | None = None,
    wanted: Collection[int] = (),
) -> TableRows:
    """Find the rows that a table of states prints. Rows that repeat the rows before become one line.

    Parameters
    ----------
    problem : Problem
    states : sequence of State
        All states, or all that are known to differ.
    rows : ndarray of int, shape (rows,), optional
        The place in `states` of a state like the one of each row. By default each state has a row.
    points : ndarray, shape (rows,), optional
        Load points of the rows; those of the states by default.
    wanted : collection of int
        Rows that are not left out: the states of the extremes.
    """
    if points is None:
        points = np.array([load_point(state) for state in states])
    same = row_numbers(map(_identity, states))
    numbers, first = np.unique(same, return_index=True)
    rows = same if rows is None else same[rows]
    if numbers.size > MOST_COMPARED:
        return TableRows(outputs.with_rows(outputs.cut_lines(rows.size), wanted), points)
    given = [name for name in LOADS if name not in problem.reactions]
    given_loads = (tuple(state.load[name] for name in given) for state in states)
    if numbers.size < rows.size or repeats(row_numbers(given_loads)):
        columns = _compared_columns(problem, [states[place] for place in first.tolist()])
        # A state differs from the same state one cycle before in its number, in a sum, and by rounding.
        own = (LOAD_POINT, QUANTITIES["dissipation"].label, "residual")
        cells = zip(*(cells for name, _, cells in columns if name not in own), strict=True)
        rows = row_numbers(cells)[rows]
    return TableRows(outputs.with_rows(folded_lines(rows), wanted), points)


def folded_lines(rows: np.ndarray) -> list[outputs.TableLine]:
    """Return the lines of a table whose repeated rows become one line. They are at most ``MAX_ROWS`` lines.

    Parameters
    ----------
    rows : ndarray of int, shape (rows,)
        Equal numbers for equal rows, see :func:`row_numbers`.
    """
    lines: list[int | outputs.Repeat] = []
    begin = 0
    for repeat in repeats(rows):
        lines += [*range(begin, repeat.first), repeat]
        begin = repeat.end
    lines += range(begin, len(rows))
    if len(lines) <= outputs.MAX_ROWS:
        return [*lines]
    first, last = lines[: outputs.MAX_ROWS // 2], lines[-outputs.MAX_ROWS // 2 :]
    end = first[-1].end if isinstance(first[-1], outputs.Repeat) else first[-1] + 1
    begin = last[0].first if isinstance(last[0], outputs.Repeat) else last[0]
    return [*first, outputs.LeftOut(begin - end), *last]


def row_numbers(keys: Iterable[Hashable]) -> np.ndarray:
    """Return a number for each key, shape (rows,). Equal keys have equal numbers."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(key, len(numbers)) for key in keys], dtype=np.int64)


def repeats(rows: np.ndarray) -> list[outputs.Repeat]:
    """Find the rows that repeat the rows before them, in order.

    Parameters
    ----------
    rows : ndarray of int, shape (rows,)
        Equal numbers for equal rows.
    """
    found = []
    row = 0
    while row < len(rows):
        repeat = _repeat_at(rows[row:])
        if repeat is None:
            row += 1
        else:
            found.append(repeat._replace(first=row + repeat.first))
            row = found[-1].end
    return found


def _repeat_at(rows: np.ndarray) -> outputs.Repeat | None:
    """The longest repeats of a period that begins with the first of some rows. None if they are too few."""
    found, longest = None, LEAST_REPEATED - 1
    for period in (np.flatnonzero(rows[1 : LONGEST_PERIOD + 1] == rows[0]) + 1).tolist():
        if not np.array_equal(rows[:period], rows[period : 2 * period]):
            continue
        same = rows[:-period] == rows[period:]
        times = (len(same) if same.all() else int(np.argmin(same))) // period
        if times * period > longest:
            found, longest = outputs.Repeat(period, period, times), times * period
    return found


def stored_rows(
    problem: Problem,
    points: np.ndarray,
    cycles: Sequence[Cycle],
    read: Callable[[list[int]], Sequence[State]],
    wanted: Collection[int] = (),
) -> TableRows:
    """As :func:`table_rows`, for a stored result. Few of its states are read.

    Parameters
    ----------
    problem : Problem
    points : ndarray, shape (states,)
        Load points of all states.
    cycles : sequence of Cycle
        All cycles of the result.
    read : callable
        ``read(places)`` gives the states at these places, in increasing order.
    wanted : collection of int
        See :func:`table_rows`.
    """
    alike = _places_alike(points, cycles)
    places, rows = np.unique(alike, return_inverse=True)
    if places.size > MOST_COMPARED:
        return TableRows(outputs.with_rows(outputs.cut_lines(points.size), wanted), points)
    return table_rows(problem, read(places.tolist()), rows, points, wanted)


def _places_alike(points: np.ndarray, cycles: Sequence[Cycle]) -> np.ndarray:
    """The place of a state like each state, shape (states,): its own place, or one in the first steady cycle.

    The states of the last cycle of a block have their own places. So have states at another place of the cycle: of
    those that ``keep = "every 2"`` leaves, each cycle has others.
    """
    places = np.arange(points.size)
    for block in consecutive_cycles(cycles):
        steady, last = periodic_from(block), block[-1]
        if steady is None:
            continue
        bounds = [steady.corner + 1 - steady.length, steady.corner + 1, last.corner + 1 - last.length]
        begin, end, stop = np.searchsorted(points, bounds, side="right").tolist()
        if stop > end > begin:
            earlier = begin + (places[end:stop] - begin) % (end - begin)
            cycles_between = (points[end:stop] - points[earlier]) / steady.length
            in_phase = np.abs(cycles_between - np.round(cycles_between)) < IN_PHASE
            places[end:stop][in_phase] = earlier[in_phase]
    return places


def _identity(state: State) -> tuple[Hashable, ...]:
    """Return the parts of a state that its row shows. Its number, its sum of energy and its residuals are left out."""
    marks = () if state.marks is None else tuple(part.tobytes() for part in state.marks.arrays(state.grid.size))
    arrays = [part.tobytes() for part in (state.pressure, state.shear, state.status)]
    coarse = _identity(state.error_bars.coarse) if state.error_bars is not None else ()
    seat = () if state.seat is None else _identity(state.seat)
    return (*arrays, *marks, state.rotation, *state.load.values(), *coarse, *seat)


def state_table(problem: Problem, states: Sequence[State], rows: TableRows | None = None) -> str:
    """Return a table of states, one line each.

    Error bars stand behind +-, if the states have any. The bar of an interval is the larger one of its two ends. A ?
    stands for a bar that is infinite: nothing is known of the error. States that repeat earlier ones become one line;
    the sum of the dissipation may differ.

    Parameters
    ----------
    problem : Problem
    states : sequence of State
        All states; with `rows` only the states that have a line of their own.
    rows : TableRows, optional
        The rows of the table, see :func:`table_rows`.

    Raises
    ------
    InputError
        If an argument is of another class.
    """
    states = _checked(problem, states)
    if rows is not None:
        checks.instance("rows", rows, TableRows, "the rows of table_rows")
    if rows is None:
        rows = table_rows(problem, states)
        states = [states[place] for place in rows.printed]
    return outputs.table_of_lines(state_columns(problem, states), rows.lines, rows.names)


def state_columns(problem: Problem, states: Sequence[State]) -> list[outputs.Column]:
    """Return the columns of :func:`state_table`, with a cell for each state.

    Raises
    ------
    InputError
        If an argument is of another class.
    """
    states = _checked(problem, states)
    *columns, residual = _compared_columns(problem, states)
    return [*columns, *_edge_columns(problem, states), residual]


def _compared_columns(problem: Problem, states: Sequence[State]) -> list[outputs.Column]:
    """Return the columns by which rows are compared: those that follow from them take longer."""
    column = partial(quantity_column, problem, states)
    strain = problem.surfaces.beta_star * max((state.peak_pressure for state in states), default=0.0)
    energy = max((abs(state.energy) for state in states), default=0.0)
    columns = [(LOAD_POINT, "", [_point(state) for state in states])]
    columns += load_columns(problem, [state.load for state in states])
    for peak in ("peak_pressure", "peak_shear"):
        columns += [column(peak), ("at", *column(f"{peak}_angle")[1:])]
    columns += [(zone, "deg", [_intervals(state, zone) for state in states]) for zone in ("contact", "stick")]
    residuals = [f"{max(state.residuals.values(), default=0.0):.0e}" for state in states]
    ends = column("rotation", 4, strain), column("dissipation", 4, energy), ("residual", "", residuals)
    return [*columns, *ends]


def _edge_columns(problem: Problem, states: Sequence[State]) -> list[outputs.Column]:
    """Return columns on a plate of any outline: the largest hoop stress at its hole and beyond, and the edge there."""
    if not has_outline(problem):
        return []
    hole = "peak_hoop" if problem.plate_body.bush is None else "peak_hoop_seat"
    found = [quantity_column(problem, states, name, 4) for name in (hole, "peak_hoop_outline")]
    return [*found, ("on the edge", "", [state.outline_peak.edge or "-" for state in states])]


def _checked(problem: Problem, states: Sequence[State]) -> list[State]:
    """Check the class of the problem and of each state."""
    checks.instance("problem", problem, Problem, "a Problem")
    return checks.instances("states", states, State, "a list of states")


def quantity_column(
    problem: Problem, states: Sequence[State], name: str, digits: int = 5, natural: float = 0.0
) -> outputs.Column:
    """Return the label of a quantity, its unit, and its value in each state with its error bar, if there is one.

    Values below :data:`ROUNDING` of the largest, or of the size `natural`, become 0.

    Parameters
    ----------
    problem : Problem
    states : sequence of State
        Of this problem.
    name : str
        A name in :data:`fastpin.states.QUANTITIES`.
    digits : int
        Significant digits of a value that is no angle.
    natural : float
        In the quantity's unit.
    """
    each = QUANTITIES[name]
    if each.classes:
        return each.label, "", [str(each.shown(state)) for state in states]
    values = [each.of(state) for state in states]
    if each.kind == "angle":
        bars = [_bar(state, _DEGREE, name) for state in states]
        return each.label, "deg", [_angle(value) + bar for value, bar in zip(values, bars, strict=True)]
    noise = ROUNDING * max(natural, max((abs(value) for value in values if math.isfinite(value)), default=0.0))
    cleaned = [0.0 if abs(value) <= noise else value for value in values]
    factor, label = (_DEGREE, "deg") if each.kind == "width" else units(problem)[each.kind].scale(cleaned)
    bars = [_bar(state, factor, name) for state in states]
    return each.label, label, [f"{value * factor:.{digits}g}{bar}" for value, bar in zip(cleaned, bars, strict=True)]


def hoop_line(problem: Problem, states: Sequence[State], body: Body = "plate") -> str:
    """Return a line of text: the largest hoop stress of a body in all kept states, its parts, and Kt of the loads.

    `states` are all kept states, or those of their extremes. It is empty without the body, for a rigid one, and without
    any stress.
    """
    if body not in elastic_bodies(problem) or not states:
        return ""
    first: dict[Hashable, State] = {}
    for state in states:  # Steady cycles repeat their states, and a peak takes some milliseconds.
        first.setdefault(_identity(state), state)
    distinct = list(first.values())
    state = distinct[ties.top([state.peak_hoop_stress(body).value for state in distinct])]
    peak = state.peak_hoop_stress(body)
    if peak.value == 0.0:
        return ""
    resolved = "" if peak.resolved else " (not resolved by the nodes)"
    factor, unit = units(problem)["traction"].scale([peak.value])
    bar = _bar(state, factor, "peak_hoop" if body == "plate" else "peak_hoop_seat").replace(" +-?", "")
    text = f"largest hoop stress of the {edge_body(problem, body)} in all kept states: {peak.value * factor:.4g}{bar} "
    text += f"{unit}{resolved} at {_angle(peak.angle)} deg, load point {_point(state)}"
    parts = {"remote": peak.kt_bypass_part, "bearing": peak.kt_bearing_part}
    terms = [f"{value:.4g} x {name} stress" for name, value in parts.items() if math.isfinite(value)]
    ratios = {"bearing": peak.kt_bearing, "net-section": peak.kt_net, "remote": peak.kt_gross}
    of_loads, kt, whole = "", "Kt", "it"
    if peak.assembly:
        loads = 0.0 if abs(peak.loads) <= ROUNDING * abs(peak.assembly) else peak.loads
        assembly, loads_text = (units(problem)["traction"].text(value, 4) for value in (peak.assembly, loads))
        of_loads = f"it is {assembly} of the assembly + {loads_text} of the loads"
        kt, whole = "Kt of the loads", "the part of the loads"
    known = [f"{kt} {value:.4g} on the {name} stress" for name, value in ratios.items() if math.isfinite(value)]
    sums = [f"{whole} is {' + '.join(terms).replace('+ -', '- ')}"] if known and len(terms) > 1 else []
    return "; ".join(filter(None, [text, of_loads, *known, *sums]))


def hoop_lines(problem: Problem, states: Sequence[State]) -> list[str]:
    """Return the lines of :func:`hoop_line` of all holes, and one on the further edges of a plate of any outline."""
    lines = [hoop_line(problem, states, body) for body in EDGES]
    if has_outline(problem) and states:
        state = states[ties.top([state.outline_peak.value for state in states])]
        peak, part = state.outline_peak, part_of(problem, "plate")
        if peak.edge:
            value = units(problem)["traction"].text(peak.value, 4)
            where = f"{edge_words(problem, peak.edge, complex(peak.x, peak.y))}, load point {_point(state)}"
            text = f"largest hoop stress along the outline in all kept states: {value} {where}"
            lines.append(f"{text}; {part}" if part else text)
    return [line for line in lines if line]


def bush_line(problem: Problem, states: Sequence[State]) -> str:
    """Return a line of text: whether the press fit holds the bush in all kept states; empty without a bush or contact.

    `states` are all kept states, or those of their extremes. Of a bush that slips it is the smallest pressure only:
    see :func:`seat_lines`.
    """
    if problem.plate_body.bush is None or not any(state.in_contact for state in states):
        return ""
    fits = [(state, state.bush_fit()) for state in states]
    state, fit = fits[ties.top([-fit.open_margin for _, fit in fits])]
    unit = units(problem)["traction"]
    where = f"at {_angle(fit.open_angle)} deg, load point {_point(state)}"
    if problem.bush_slips and fit.open_margin <= 0.0:
        return f"the bush opens in its seat {where}"
    if fit.open_margin < 0.0:
        needed, given = (unit.text(each, 4) for each in (fit.pressure_to_close, fit.press_fit_pressure))
        words = f"note: the bush would open {where}: it needs a press-fit pressure of {needed}, not {given}"
        return f"{words}; these states hold for a bonded bush"
    text = f"smallest pressure between bush and plate in all kept states: {unit.text(fit.open_margin, 4)} {where}"
    if problem.bush_slips:
        return text
    friction = max(fit.least_friction for _, fit in fits)
    return f"{text}; the bush sticks with a friction of {friction:.3g} or more"


def seat_lines(problem: Problem, states: Sequence[State], last: State, cycle: Sequence[State] = ()) -> list[str]:
    """Return lines of text on a bush that slips, none without one.

    The first line has its zones, largest slip, rotation and dissipation. The second one says whether it walks.

    Parameters
    ----------
    problem : Problem
    states : sequence of State
        All kept states, or those of their extremes.
    last : State
        The last kept state.
    cycle : sequence of State
        The states of the last cycle; none if they are not known.
    """
    seats = [state.seat for state in states if state.seat is not None]
    seat, unit = last.seat, units(problem)
    if seat is None or not seats or not problem.bush_slips:
        return []
    most = seats[ties.top([abs(each.peak_slip) for each in seats])]

    def shown(kind: str, value: float, digits: int) -> str:
        return unit[kind].text(0.0 if abs(value) <= ROUNDING * sizes(seat)[kind] else value, digits)

    zones = f"contact {_intervals(seat, 'contact')}, stick {_intervals(seat, 'stick')} (deg)"
    slip = (
        f"{shown('displacement', most.peak_slip, 4)} at {_angle(most.peak_slip_angle)} deg, load point {_point(most)}"
    )
    text = f"bush in its seat at load point {_point(last)}: {zones}; largest slip in all kept states: {slip}; "
    text += f"turned {shown('rotation', seat.rotation, 4)} so far"
    turned = [state.seat.rotation for state in cycle if state.seat is not None]
    if turned:
        text += f", {shown('rotation', turned[-1] - turned[0], 3)} in the last cycle"
    text += f"; dissipated {shown('energy', seat.dissipation, 4)} of {shown('energy', last.dissipation, 4)}"
    words = walking.walk_words(cycle)
    return [text, *([f"bush in its seat: {words}"] if words else [])]


def cycle_lines(problem: Problem, cycles: Sequence[Cycle], states: Sequence[State] = ()) -> list[str]:
    """Return one line of text for each block of cycles: how the cycles changed tractions, energy and rotation.

    What is rounding beside the natural sizes of the `states` is 0.
    """
    found = [sizes(state) for state in states]
    natural = {kind: max((each[kind] for each in found), default=0.0) for kind in ("energy", "rotation")}
    lines = [_block_line(problem, block, natural) for block in consecutive_cycles(cycles)]
    most = outputs.MAX_ROWS // 2
    if len(lines) > most:
        lines[most // 2 : -most // 2] = [f"... {len(lines) - most} more blocks of cycles ..."]
    return lines


def _first_and_last(values: list[float], unit: Unit, digits: int, natural: float) -> list[str]:
    """Return the first and the last value as text.

    Values below :data:`ROUNDING` of the largest, or of the size `natural`, become 0.
    """
    noise = ROUNDING * max(natural, max((abs(value) for value in values if math.isfinite(value)), default=0.0))
    cleaned = [0.0 if abs(value) <= noise else value for value in (values[0], values[-1])]
    return ["not known" if math.isnan(value) else unit.text(value, digits) for value in cleaned]


def _block_line(problem: Problem, cycles: list[Cycle], natural: Mapping[str, float]) -> str:
    first, last = cycles[0], cycles[-1]
    steady = periodic_from(cycles)
    unit = units(problem)
    dissipation = _first_and_last([cycle.dissipation for cycle in cycles], unit["energy"], 4, natural["energy"])
    turned = _first_and_last([cycle.rotation_change for cycle in cycles], unit["rotation"], 3, natural["rotation"])
    who = "bush" if problem.pin_body.is_bush else "pin"
    state = f"periodic from cycle {steady.number} on" if steady else "not yet periodic"
    corners = f"{last.length} corner{'s' if last.length > 1 else ''}"
    where = f"to corner {last.corner + 1:,}"
    text = f"{where}, {last.number:,} cycle{'s' if last.number > 1 else ''} of {corners}: {state}"
    if len(cycles) == 1:
        return f"{text}; dissipated {dissipation[0]}, {who} turned {turned[0]}"
    changes = [f"{max(cycle.pressure_change, cycle.shear_change):.2g}" for cycle in (first, last)]
    before, after = (f"dissipated {one}, {who} turned {two}" for one, two in zip(dissipation, turned, strict=True))
    first_words = f"first cycle: tractions changed by {changes[0]} of the peak pressure, {before}"
    return f"{text}; {first_words}; last: changed by {changes[1]}, {after}"


def _point(state: State) -> str:
    return point_name(load_point(state))


def _angle(angle: float | None) -> str:
    return "-" if angle is None or not math.isfinite(angle) else f"{from_bottom(angle):z.2f}"


def _bar(state: State, factor: float, *names: str) -> str:
    """Return " +- BAR" with the largest bar of several quantities; " +-?" if it is infinite, "" if there is none.

    See :func:`fastpin.states.error_bars.known_bar`.
    """
    bars = [known_bar(name, state) for name in names]
    if any(math.isnan(bar) for bar in bars):
        return ""
    return f" +-{factor * max(bars):.2g}" if math.isfinite(max(bars)) else " +-?"


def _intervals(state: State, zone: str) -> str:
    parts, zones = [], getattr(state, zone)
    if len(zones) > 6:  # a row with more would be too long to read
        first, last = interval_from_bottom(zones[0][0], zones[-1][1])
        return f"{len(zones)} zones within {first:z.2f} to {last:z.2f}"
    for number, (start, stop) in enumerate(zones, start=1):
        first, last = interval_from_bottom(start, stop)
        bar = _bar(state, _DEGREE, f"{zone}_{number}_start", f"{zone}_{number}_stop")
        parts.append("all round" if is_all_round(stop - start) else f"{first:z.2f} to {last:z.2f}{bar}")
    none = Regime.GROSS_SLIDING.words if zone == "stick" and state.in_contact else "none"
    return ", ".join(parts) or none


def note_lines(case: Case, result: Result) -> list[str]:
    """Return lines of text, one for each thing that a reader of a result must know; none for most results.

    Only statistics and grid of the result are read. Doubts about its values are warnings, see
    :mod:`fastpin.model.doubts`.
    """
    counts = {name: int(result.statistics.get(name, 0)) for name in COUNTED}
    notes = [COUNTED[name].format(count=count) for name, count in counts.items() if count]
    if result.grid.size > case.options.nodes and not result.grid.uniform:
        notes.append(f"{result.grid.size} nodes instead of {case.options.nodes}, dense where the contact is narrow")
    return notes


def way_on(path: Path | None, error: str | None) -> str:
    """Return words on how an unfinished run of a file goes on; empty if it does not.

    `error` is the error that ended the run. A run goes on after Ctrl-C or a kill. After another error the same loads
    end at the same place.
    """
    if path is None or error not in (None, str(Interrupted())):
        return ""
    if storage.is_being_written(path):
        return "its run goes on"
    command = f"wear CASE -o {path} --resume" if storage.StoredResult(path).is_life else f"resume {path}"
    return f"continue with: fastpin {command}"


def solver_line(result: Result) -> str:
    """Return a line of text: the solver, the number of nodes, and the statistics that are not zero."""
    names = ("events", "exchanges", "rebuilds", "repeated", "increments", "seconds")
    known = [f"{result.statistics[name]:.4g} {name}" for name in names if result.statistics.get(name)]
    return f"{result.method} solver, {result.grid.size} nodes{''.join(f', {part}' for part in known)}"
