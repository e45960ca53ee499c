"""The sections of the page of a result."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fastpin.assess.crack import law_words
from fastpin.assess.cycle import cycle_line
from fastpin.assess.margins import verdict
from fastpin.assess.outputs import MAX_ROWS, ROUNDING, Column
from fastpin.assess.questions import QUESTIONS
from fastpin.assess.wear import wear_input
from fastpin.errors import InputError
from fastpin.figures.convergence import convergence_of
from fastpin.figures.cycles import cycles_of
from fastpin.figures.fatigue import crack_growth_of, fatigue_of
from fastpin.figures.history import gap_plot, history_of
from fastpin.figures.laminates import strength_of
from fastpin.figures.load_cycle import STRAIGHT, area_doubt, loops_of, slip_of
from fastpin.figures.sheet import Plot
from fastpin.figures.sketch import sketch_of
from fastpin.figures.states import DrawnStates, Subject
from fastpin.figures.stick_slip import stick_slip_plot
from fastpin.figures.stress import hoop_plot, map_plot, outline_plot
from fastpin.figures.tractions import tractions_plot
from fastpin.kernels.status import SLIP_POSITIVE
from fastpin.model import angles, points, ties
from fastpin.model.checks import as_toml
from fastpin.model.doubts import doubts, pressure_doubts
from fastpin.model.keys import FATIGUE, PLY
from fastpin.model.loads import LOAD, named_load
from fastpin.model.materials import Material
from fastpin.model.options import OPTIONS
from fastpin.model.problem import Problem
from fastpin.model.units import Unit, acting_loads, in_units, named_loads, system_words, units
from fastpin.pages.content import Facts, Items, Listing, PageSection, SectionPart, Table, Text
from fastpin.pages.source import PageParts, Source, margins, sentence
from fastpin.reading.zones import is_all_round
from fastpin.report.case import case_rows, corner_columns
from fastpin.report.convergence import heading, reported_series, series_columns
from fastpin.report.states import (
    bush_line,
    cycle_lines,
    hoop_lines,
    note_lines,
    quantity_column,
    seat_lines,
    solver_line,
    state_columns,
    way_on,
)
from fastpin.solver.configuration import MAX_RESIDUAL
from fastpin.states import LoadCycle, State, extremes, walking
from fastpin.states.quantities import QUANTITIES, load_point, point_name, size
from fastpin.studies.identity import canonical, run_id

RESIDUAL_WORDS = {
    "gap": "no gap where the bodies touch, in parts of the largest displacement",
    "slip": "no change of slip where they stick, in parts of the largest displacement",
    "cone": "Coulomb's law and N >= 0, in parts of the largest pressure",
    "equilibrium": "equilibrium of the pin, in parts of the resultants of the absolute tractions",
}
"""Words for the residuals of a :class:`fastpin.State`."""

NO_SLIP = "from corner {0.first:,} to {0.last:,} the pin does not slip beyond rounding"
"""In place of the slip of a cycle."""

MOST_CHARACTERS = 20_000
"""Most characters of a listing: some four printed pages."""

MOST_BLOCKS = 4
"""Most blocks of cycles that the overview describes, a sentence each."""

ANGLES = "Angles are in degrees from the bottom of the hole, counter-clockwise positive, towards +x."
"""The convention of angles."""

NO_STATE = "There is no state: the run ended before its first corner, or its states were not kept."
"""In place of a section that needs states."""


def overview(page: PageParts) -> PageSection:
    """Return the most important sentences on the result."""
    source, problem = page.source, page.source.case.problem
    cycle = source.cycle
    parts: list[SectionPart] = [_status(source), *warnings_and_notes(source)]
    if source.points.size and not problem.dimensionless:
        parts.append(Text(f"Verdict: {verdict(page.margins, source.result.complete)}."))
    if source.held.peaks:
        largest = source.held.peaks[ties.top([state.peak_pressure for state in source.held.peaks])]
        pressure, point = units(problem)["traction"].text(largest.peak_pressure, 5), point_name(load_point(largest))
        touched = f"largest contact pressure in all kept states: {pressure}, load point {point}"
        sentences = [touched if largest.peak_pressure else "the pin touches the hole in no kept state"]
        sentences += hoop_lines(problem, source.held.peaks)
        sentences += [*bush_line(problem, source.held.peaks).splitlines(), *_seat_lines(source)]
        lines = cycle_lines(problem, source.result.cycles, source.held.peaks)
        many = f"{len(lines):,} blocks of cycles: see hysteresis and slip"
        sentences += lines if len(lines) <= MOST_BLOCKS else [many]
        sentences += [] if cycle is None else [cycle_line(cycle) if _slips(cycle) else NO_SLIP.format(cycle)]
        assessed = source.answer("fatigue")
        sentences += [] if assessed is None else QUESTIONS["fatigue"].lines(assessed, source.over_yield)
        parts.append(Items([sentence(line) for line in sentences if line]))
    parts.append(Text(ANGLES))
    return PageSection("overview", "Overview", parts)


def warnings_and_notes(source: Source) -> list[Text]:
    """Return the doubts about a result, and what a reader of it must know."""
    problem, history = source.case.problem, source.case.history
    warnings = [*doubts(problem, history, source.case.options)]
    warnings += pressure_doubts(problem, history, [np.array([source.held.pressure])])
    warnings += extremes.yield_doubts(problem, history, lambda: source.held.extremes, source.held.read)
    warnings += [] if source.cycle is None else walking.walk_doubts(source.cycle.states, source.result.cycles)
    warnings += [] if source.life is None else source.life.doubts
    notes = note_lines(source.case, source.result)
    return [Text(f"Warning: {each}.", "note") for each in warnings] + [Text(f"Note: {each}.", "note") for each in notes]


def _status(source: Source) -> Text:
    """Say whether the result is complete, and why not."""
    corners = len(source.case.history)
    if source.result.complete:
        which, were = ("the only corner", "was") if corners == 1 else (f"all {corners:,} corners", "were")
        return Text(f"Complete: {which} of the load history {were} followed; {_count(source)}.")
    why = f" The reason: {source.error}." if source.error else ""
    line = way_on(source.path, source.error)
    how = f" {sentence(line)}" if line else ""
    return Text(f"Unfinished: corner {source.reached:,} of {corners:,}; {_count(source)}.{why}{how}", "note")


def _count(source: Source) -> str:
    return "1 state is kept" if source.points.size == 1 else f"{source.points.size:,} states are kept"


def case(page: PageParts) -> PageSection:
    """Return every parameter of the case in words, and the options of the solver."""
    found = page.source.case
    problem, unit = found.problem, units(found.problem)
    elsewhere = ("pin", "plate", *(["loads"] if page.source.initial.any() else []))  # they have sections of their own
    rows = [row for row in case_rows(found) if row[0] not in elsewhere]
    if not problem.dimensionless:
        assembled = " after the press fit" if problem.press_fit_pressure else ""
        relative = f"{problem.assembled_clearance / problem.hole_radius:.4g}"
        rows += [("pin radius", unit["length"].text(problem.pin_radius)), (f"clearance{assembled} / radius", relative)]
    known = page.source.knows_options
    told = ("nodes", "method", "error_bars")  # by a result without its run
    options = {name: value for name, value in found.options.keywords().items() if known or name in told}
    solver = [(name, as_toml(value), OPTIONS[name]["words"]) for name, value in options.items() if value is not None]
    parts = drawn_or_reason(lambda: page.album.figure(sketch_of(found)))
    parts += [page.album.figure(gap_plot(Subject(found)))] if problem.profiles else []
    facts = Facts("Options of the solver", solver, ("option", "value", "meaning"))
    return PageSection("case", "Case", [*parts, Facts("The problem", rows, ("subject", "in words")), facts])


def materials(page: PageParts) -> PageSection:
    """Return the constants of all materials."""
    problem = page.source.case.problem
    found = problem.joint.materials
    modulus = units(problem)["modulus"]
    names = ["material", "Young's modulus E", "Poisson's ratio nu", "shear modulus G", "yield strength"]
    columns: list[Column] = [("constant", "", names)]
    columns += [(name, "", _constants(material, modulus)) for name, material in found.items()]
    parts: list[SectionPart] = [Table("Elastic constants and yield strength", columns)]
    for name, material in found.items():
        if not material.is_isotropic:
            parts += _laminate(name, material, problem)
    known = {name: each.fatigue for name, each in found.items() if each.fatigue and not each.is_rigid}
    fatigue = {name: in_units(problem, each.given(), FATIGUE) for name, each in known.items()}
    sources = {name: given.pop("source", "") for name, given in fatigue.items()}
    if fatigue:
        names = list(dict.fromkeys(name for given in fatigue.values() for name in given))
        columns = [("constant", "", [name.replace("_", " ") for name in names])]
        for body, given in fatigue.items():
            values = [given.get(name, "-") for name in names]
            columns.append((body, "", [value if isinstance(value, str) else f"{value:.6g}" for value in values]))
        parts.append(Table(f"Fatigue constants, in {system_words(problem)}", columns))
        parts += [Text(f"Source of the constants of the {body}: {text}.") for body, text in sources.items() if text]
    else:
        parts.append(Text("No material has fatigue constants: see the key fatigue of a case file.", "missing"))
    for body, material in found.items():
        if material.growth is not None:
            parts.append(Text(sentence(f"Crack growth in the {body}: {law_words(problem, material.growth)}")))
    return PageSection("materials", "Materials", parts)


def _constants(material: Material, unit: Unit) -> list[str]:
    if material.is_rigid:
        return [material.name or "rigid", "infinite", "-", "infinite", "-"]
    if not material.is_isotropic:
        return [material.label, "-", "-", "-", "-"]
    moduli = [unit.text(value, 5) for value in (material.E, material.shear_modulus)]
    strength = material.known_yield_strength
    yields = "not known" if strength is None else unit.text(strength, 5)
    return [material.name or "no name", moduli[0], f"{material.nu:.5g}", moduli[1], yields]


def _laminate(name: str, material: Material, problem: Problem) -> list[SectionPart]:
    """Return the moduli of a laminate, and the constants and sources of its plies."""
    moduli, unit = material.shown_moduli.items(), units(problem)["modulus"]
    whole = [f"{value:.5g}" if field.startswith("nu") else unit.text(value, 5) for field, value in moduli]
    rows: list[Column] = [("constant", "", [*material.shown_moduli, "direction"])]
    rows.append((name, "", [*whole, material.direction_words]))
    parts: list[SectionPart] = [Table(f"Laminate of the {name}: moduli of the whole", rows)]
    plies = in_units(problem, material.entries().get("plies", []), PLY)
    names = list(dict.fromkeys(field for ply in plies for field in ply if field not in ("name", "source")))
    if plies:
        columns: list[Column] = [("constant", "", names)]
        for ply in plies:
            values = [f"{ply[field]:.6g}" if field in ply else "-" for field in names]
            columns.append((ply.get("name", "no name"), "", values))
        words = "moduli in 1/beta*" if problem.dimensionless else f"in {system_words(problem)}"
        parts.append(Table(f"Plies, {words}", columns))
    sources = {ply.get("name", "a ply"): ply["source"] for ply in plies if "source" in ply}
    return parts + [Text(f"Source of the constants of {ply}: {text}.") for ply, text in sources.items()]


def loads(page: PageParts) -> PageSection:
    """Return the figure and the table of the corners."""
    found = page.source.case
    history = found.history
    initial = page.source.initial
    columns, hidden = corner_columns(found.problem, history, initial)
    names = acting_loads([named_load(row) for row in history.distinct(initial)])
    rows = [(name, LOAD[name].words) for name in names]
    count = len(columns[0][2])
    gaps = {min(count, MAX_ROWS) // 2: f"{hidden:,} corners not shown here"} if hidden else {}
    if count > MAX_ROWS:  # each block is short, but there are many
        half = MAX_ROWS // 2
        columns = [(name, unit, cells[:half] + cells[-half:]) for name, unit, cells in columns]
        gaps = {half: f"{hidden + count - MAX_ROWS:,} corners not shown here"}
    remarks = [Text("L_p is the load parameter (R - R_D)/(F beta*) of the force F on the pin.")]
    figure = page.album.figure(history_of(found.problem, history, initial))
    parts: list[SectionPart] = [Facts("Loads", rows, ("load", "meaning")), figure]
    if initial.any():
        kept = named_loads(found.problem, named_load(initial))
        remarks.append(Text(f"The run continues another result. It begins with its loads: {kept}.", "note"))
    return PageSection("loads", "Loads", [*parts, Table("Corners of the load history", columns, gaps), *remarks])


def key_figures(page: PageParts) -> PageSection:
    """Return the table of states, and all quantities of the states that are drawn."""
    source, problem = page.source, page.source.case.problem
    states, gaps = source.rows
    if not states:
        return PageSection("figures", "Key figures", [Text(NO_STATE, "missing")])
    parts: list[SectionPart] = [Table("States", state_columns(problem, states), gaps)]
    parts.append(_all_quantities(source.drawn))
    if states[0].error_bars is None:
        how = "There are no error bars. fastpin report CASE.toml --error-bars solves the case with them, and fastpin "
        how += "run CASE.toml --error-bars -o FILE.h5 keeps them in a file. In Python it is error_bars=True."
        if page.source.case.options.error_bars:
            how = "There are no error bars: their run on the coarse grid has not ended. fastpin resume continues it."
        parts.append(Text(how, "missing"))
    else:
        words = "Error bars stand behind ±. The true value lies within the bar in some 95 of 100 cases."
        parts.append(Text(f"{words} A ? stands for a bar that is not known."))
    return PageSection("figures", "Key figures", parts)


def _all_quantities(drawn: Sequence[State]) -> Table:
    """Return the table of all quantities that the drawn states have."""
    natural = {name: max(size(name, state) for state in drawn) for name in QUANTITIES}
    cells = [quantity_column(drawn[0].problem, drawn, name, natural=natural[name]) for name in QUANTITIES]
    shown = [(each.words, *cell[1:]) for each, cell in zip(QUANTITIES.values(), cells, strict=True)]
    shown = [row for row in shown if not all(cell in ("nan", "-") for cell in row[2])]
    columns: list[Column] = [("quantity", "", [row[0] for row in shown]), ("unit", "", [row[1] for row in shown])]
    for place, state in enumerate(drawn):
        values = ["-" if row[2][place] == "nan" else row[2][place] for row in shown]
        columns.append((point_name(load_point(state)), "", values))
    return Table("All quantities, by load point", columns)


def tractions(page: PageParts) -> PageSection:
    """Return the figure of the tractions."""
    if not any(state.in_contact for state in page.source.drawn):
        why = "Pin and hole do not touch in the drawn states." if page.source.drawn else NO_STATE
        return PageSection("tractions", "Tractions", [Text(why, "missing")])
    return PageSection("tractions", "Tractions", [page.album.figure(tractions_plot(Subject(page.source.drawn)))])


def zones(page: PageParts) -> PageSection:
    """Return the zones of contact, stick and slip."""
    drawn = page.source.drawn
    if not drawn:
        return PageSection("zones", "Stick and slip", [Text(NO_STATE, "missing")])
    rows = [row for state in drawn for row in _zone_rows(state)]
    heads = ("load point", "zone", "from", "to", "direction of the pin")
    units_ = ("", "", "deg", "deg", "")
    columns = [(heads[k], units_[k], [row[k] for row in rows]) for k in range(len(heads))]
    parts: list[SectionPart] = [Table("Zones of contact, stick and slip", columns)]
    if len(page.source.mapped) > 1:
        parts = [*drawn_or_reason(lambda: page.album.figure(stick_slip_plot(Subject(page.source.mapped)))), *parts]
    return PageSection("zones", "Stick and slip", parts)


def _zone_rows(state: State) -> list[tuple[str, ...]]:
    point = point_name(load_point(state))
    found = [("contact", start, stop, "") for start, stop in state.contact]
    found += [("stick", start, stop, "") for start, stop in state.stick]
    for start, stop, sign in state.slip_zones:
        found.append(("slip", start, stop, "counter-clockwise" if sign == SLIP_POSITIVE else "clockwise"))
    rows: list[tuple[str, ...]] = []
    for zone, start, stop, words in found:
        first, last = (f"{angle:z.2f}" for angle in angles.interval_from_bottom(start, stop))
        ends = ("all round", "all round") if is_all_round(stop - start) else (first, last)
        rows.append((point, zone, *ends, words))
    return rows or [(point, "no contact", "-", "-", "")]


def seat(page: PageParts) -> PageSection:
    """Return the contact of a bush that slips in its seat: tractions, stick and slip, states and quantities."""
    source = page.source
    drawn, mapped = source.drawn.seats, source.mapped.seats
    if not drawn:
        return PageSection("seat", "Seat of the bush", [Text(NO_STATE, "missing")])
    words = "Here the bush is the pin, and its seat in the plate the hole: the motion is that of the bush over the "
    words += "plate. Work is that of the whole joint."
    parts: list[SectionPart] = [*(Text(sentence(line)) for line in _seat_lines(source)), Text(words)]
    parts += drawn_or_reason(lambda: page.album.figure(tractions_plot(Subject(drawn))))
    if len(mapped) > 1:
        parts += drawn_or_reason(lambda: page.album.figure(stick_slip_plot(Subject(mapped))))
    if source.cycle is not None:
        parts += slip_parts(page, LoadCycle(tuple(DrawnStates(source.cycle.states, 0).seats)))
    states, gaps = source.rows
    seats = DrawnStates(states, len(states)).seats
    parts.append(Table("States of the seat", state_columns(seats[0].problem, seats), gaps))
    parts.append(_all_quantities(drawn))
    return PageSection("seat", "Seat of the bush", parts)


def _seat_lines(source: Source) -> list[str]:
    (last,) = source.held.read([source.points.size - 1])
    return seat_lines(source.case.problem, source.held.peaks, last, () if source.cycle is None else source.cycle.states)


def hysteresis(page: PageParts) -> PageSection:
    """Return loops and slip of the last cycle, and the changes of all cycles."""
    source, cycle, parts = page.source, page.source.cycle, list[SectionPart]()
    if cycle is None:
        how = "A load block with repeat = 2, or a history that ends with the loads of an earlier corner, has a cycle."
        parts.append(Text(f"There are no loops: {source.why_no_cycle}. {how}", "missing"))
    else:
        if not source.result.cycles:
            words = "The history has no repeated block; its last part begins and ends with the same loads"
            parts.append(Text(f"{words}: corners {cycle.first:,} to {cycle.last:,}."))
        parts += drawn_or_reason(lambda: page.album.figure(loops_of([cycle])))
        if len(cycle.states) <= STRAIGHT:
            parts.append(Text("Loops need states between the corners, such as between = 20 in [solve].", "missing"))
        elif doubt := area_doubt(cycle):
            parts.append(Text(sentence(doubt), "note"))
        parts += slip_parts(page, cycle)
    if source.result.cycles:
        parts += drawn_or_reason(lambda: page.album.figure(cycles_of(source.result)))
        lines = cycle_lines(source.case.problem, source.result.cycles, source.held.peaks)
        if len(lines) > MOST_BLOCKS:
            parts.append(Items([sentence(line) for line in lines]))
    return PageSection("hysteresis", "Hysteresis and slip", parts)


def slip_parts(page: PageParts, cycle: LoadCycle) -> list[SectionPart]:
    """Return the figure of slip and friction energy over a cycle, or that nothing slips."""
    if not _slips(cycle):
        return [Text(sentence(NO_SLIP.format(cycle)))]
    return drawn_or_reason(lambda: page.album.figure(slip_of(cycle)))


def _slips(cycle: LoadCycle) -> bool:
    """Whether a node slips over a cycle, beyond rounding."""
    natural = max(size("dx", state) for state in cycle.states)
    return cycle.largest_slip_range > ROUNDING * natural


def drawn_or_reason(draw: Callable[[], SectionPart]) -> list[SectionPart]:
    """Return a picture, or the reason why there is none."""
    try:
        return [draw()]
    except InputError as error:
        return [Text(f"There is no figure: {error.field} {error.reason}.", "missing")]


def stresses(page: PageParts) -> PageSection:
    """Return the hoop stress round the hole, and a map of the state with the largest one."""
    drawn, problem = page.source.drawn, page.source.case.problem
    if not drawn:
        return PageSection("stresses", "Stresses", [Text(NO_STATE, "missing")])
    parts = drawn_or_reason(lambda: page.album.figure(hoop_plot(Subject(drawn))))
    peaks = page.source.held.peaks
    if points.has_outline(problem):
        parts += drawn_or_reason(lambda: page.album.figure(outline_plot(Subject(drawn))))
    parts += [Text(sentence(line)) for line in hoop_lines(problem, peaks)]
    name = "peak_pressure" if problem.surfaces.plate.is_rigid else "peak_hoop"
    largest = peaks[ties.top([extremes.READINGS[name].of(state) for state in peaks])]
    parts += drawn_or_reason(lambda: page.album.figure(map_plot(Subject(largest))))
    return PageSection("stresses", "Stresses", parts)


def asked(name: str) -> Callable[[PageParts], PageSection]:
    """Return what makes the section of a question of the case: lines of its answer, its figures, and remarks."""
    pictures: dict[str, Callable[[Any], list[Plot]]] = {
        "fatigue": lambda found: [fatigue_of(each) for each in found.along_edges],
        "crack": lambda found: [crack_growth_of(found)],
        "strength": lambda found: [strength_of(Subject([found.state]).states(), found.how)],
    }

    def section(page: PageParts) -> PageSection:
        found = page.source.answer(name)
        if found is None or isinstance(found, str):
            return PageSection(name, name.capitalize(), [Text(found or NO_STATE, "missing")])
        lines = QUESTIONS[name].lines(found, page.source.over_yield)
        tone = "missing" if getattr(found, "reason", "") else "plain"
        parts: list[SectionPart] = [Text(sentence(line), tone) for line in lines]
        parts += [page.album.figure(each) for each in pictures[name](found)]
        return PageSection(
            name, name.capitalize(), [*parts, *(Text(sentence(line)) for line in QUESTIONS[name].remarks(found))]
        )

    section.__name__ = name
    return section


def convergence(page: PageParts) -> PageSection:
    """Return a convergence study, if there is one."""
    study = page.convergence
    if study is None:
        words = "There is no convergence study on this page: result files hold none."
        words += " fastpin converge CASE.toml makes one; in Python, result.report(path, convergence=...) shows it."
        return PageSection("convergence", "Convergence", [Text(words, "missing")])
    parts: list[SectionPart] = []
    for corner in study.loads:
        for one in study.studies:
            rows = reported_series(one, study.problem, corner)
            words = f"Corner {corner:,}, {heading(one, study).removesuffix(':')}"
            parts.append(Table(words, series_columns(one, rows)))
    parts.append(page.album.figure(convergence_of(study)))
    return PageSection("convergence", "Convergence", parts)


def checks(page: PageParts) -> PageSection:
    """Return the residuals of all states, and the counts of the solver."""
    source = page.source
    rows = [
        (name, f"{value:.1e}", "met" if value <= MAX_RESIDUAL else "not met", RESIDUAL_WORDS.get(name, ""))
        for name, value in source.held.residuals.items()
    ]
    parts: list[SectionPart] = []
    if rows:
        count = source.points.size
        states = "the state" if count == 1 else f"all {count:,} states"
        words = f"Largest violations of the contact conditions in {states}"
        heads = ("condition", "largest violation", f"at most {MAX_RESIDUAL:g}", "meaning")
        parts.append(Facts(words, rows, heads))
    else:
        parts.append(Text(NO_STATE, "missing"))
    parts.append(Text(sentence(solver_line(source.result))))
    return PageSection("checks", "Checks", parts)


def provenance(page: PageParts) -> PageSection:
    """Return the versions, the place and time of the run, its id, and its input."""
    source = page.source
    document = canonical(source.case)
    rows, listing = [*source.origin], "Input of the run (JSON, SI units)"
    if source.life is not None:
        document |= {"solve": {"nodes": source.life.grid.size}, "wear": wear_input(source.life)}
        listing = "Input of the life of wear (JSON, SI units)"
    elif source.knows_options:
        rows.append(("id of the input", run_id(document)))
    else:
        del document["solve"]
        listing = "Input of the run without the options of the solver, which are not known (JSON, SI units)"
    parts: list[SectionPart] = [Facts("Origin", rows, ("subject", "value"))]
    if source.case_text:
        parts.append(Listing("Case file", shortened(source.case_text)))
    elif source.path is not None:
        words = "The text of the case file is not in a result file: fastpin report --case CASE.toml shows it."
        parts.append(Text(words, "missing"))
    parts.append(Listing(listing, shortened(json.dumps(document, indent=1))))
    return PageSection("provenance", "Versions and provenance", parts)


def shortened(text: str) -> str:
    """Return a text, or its beginning: the compliance of a finite plate has thousands of numbers."""
    if len(text) <= MOST_CHARACTERS:
        return text
    return f"{text[:MOST_CHARACTERS]}\n... {len(text) - MOST_CHARACTERS:,} more characters"


SECTIONS: Sequence[Callable[[PageParts], PageSection]] = (
    overview, margins, case, materials, loads, key_figures, tractions, zones, seat, hysteresis, stresses,
    *(asked(name) for name in QUESTIONS), convergence, checks, provenance,
)  # fmt: skip
"""All sections, in the order of the page. Only a joint whose bush slips has a seat, and not all cases ask questions."""
