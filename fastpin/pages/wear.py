"""The sections of the page of a life of wear."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from fastpin.assess.outputs import columns_at, printed_rows
from fastpin.assess.wear import DEBRIS, cycle_columns, cycle_lines, followed_words, law_rows
from fastpin.damage import WornFatigue
from fastpin.figures.scar import damage_of, scar_plot, wear_plot
from fastpin.figures.states import Subject
from fastpin.model import FatigueAssessment, angles, points, ties
from fastpin.model.units import units
from fastpin.model.wear import cycles_text
from fastpin.pages import sections
from fastpin.pages.content import Facts, Items, PageSection, SectionPart, Table, Text
from fastpin.pages.source import PageParts, Source, margins, sentence
from fastpin.report.states import TableRows, way_on
from fastpin.states.margins import over_yield_words
from fastpin.states.quantities import load_point
from fastpin.wear_lives.wear_result import WearResult

NO_PROFILE = "There is no stored profile: the life ended before its first cycle."
"""In place of a section that needs profiles."""


def overview(page: PageParts) -> PageSection:
    """Return the most important sentences on a life of wear."""
    source, life = page.source, _life(page)
    unit = units(life.problem)
    parts: list[SectionPart] = [_status(source, life), *sections.warnings_and_notes(source)]
    parts.append(Text(f"{sentence(DEBRIS)} Worn material leaves the contact at once.", "note"))
    if len(life):
        first, last, peak = life[0], life[-1], life[ties.top([each.largest_pressure for each in life])]
        worn = f"worn off after {cycles_text(last.cycle)}: {unit['work per stress'].text(last.volume, 4)}"
        worn += f", at most {unit['displacement'].text(last.depth, 4)} deep"
        share = "" if math.isnan(last.pin_share) else f"; {100.0 * last.pin_share:.3g} % of the volume from the pin"
        pressures = [unit["traction"].text(each.largest_pressure, 4) for each in (peak, first)]
        lines = [
            f"{worn}{share}",
            f"largest contact pressure over a cycle: {pressures[0]} after {cycles_text(peak.cycle)}, "
            f"{pressures[1]} on the first profile",
            f"energy per cycle: {unit['energy'].text(last.energy_per_cycle, 4)} dissipated on the last profile",
        ]
        for one in source.worn:
            mark = over_yield_words(source.over_yield, points.owner_of(life.problem, one.body))
            lines.append(f"damage of the {_subject(one)}: {one.words}{mark}")
        parts.append(Items([sentence(line) for line in lines]))
    parts.append(Text(sections.ANGLES))
    return PageSection("overview", "Overview", parts)


def _life(page: PageParts) -> WearResult:
    assert page.source.life is not None
    return page.source.life


def _status(source: Source, life: WearResult) -> Text:
    """Say how many cycles were followed and solved, and why not all."""
    solved = f"{life[-1].solved:,} cycles were really solved" if len(life) else "no cycle was solved"
    how = "every cycle is solved"
    if life.tolerance:
        how = f"a solved cycle may stand for many, with an error of at most {life.tolerance:g} of the largest depth"
    if life.complete:
        return Text(f"Complete: {followed_words(life)}. {sentence(f'{solved}: {how}')}")
    why = f" The reason: {source.error}." if source.error else ""
    line = way_on(source.path, source.error)
    more = f" {sentence(line)}" if line else ""
    return Text(f"{sentence(followed_words(life))} {sentence(f'{solved}: {how}')}{why}{more}", "note")


def numbers(page: PageParts) -> PageSection:
    """Return the law of wear, and figure and table of the numbers over the cycles."""
    life = _life(page)
    parts: list[SectionPart] = [Facts("Law of wear, and control of the error", law_rows(life), ("subject", "in words"))]
    if not len(life):
        return PageSection("wear", "Wear", [*parts, Text(NO_PROFILE, "missing")])
    lines = cycle_lines(life)
    columns, gaps = columns_at(cycle_columns(life), printed_rows(lines)), TableRows(lines, life.numbers).gaps
    parts += [page.album.figure(wear_plot(Subject(life))), Table("Stored cycles", columns, gaps)]
    remarks = "Energy and pressure of a row are those over one cycle on its profile, without further wear. "
    remarks += "The last column counts the cycles that were really solved, those for the control of the error included."
    if gaps:
        remarks += " The table lacks its middle, but not the extremes: fastpin plot FILE wear --csv NAME has all rows."
    return PageSection("wear", "Wear", [*parts, Text(remarks)])


def profile(page: PageParts) -> PageSection:
    """Return the scar with its pressure, and what is worn off each body."""
    life = _life(page)
    if not len(life):
        return PageSection("profile", "Worn profile", [Text(NO_PROFILE, "missing")])
    last, unit = life[-1], units(life.problem)
    rows = []
    names, depths = ("pin", points.edge_body(life.problem, "plate")), (last.pin_depth, last.plate_depth)
    for name, depth, volume in zip(names, depths, last.volumes, strict=True):
        if not depth.any():
            rows.append((name, "nothing", "-", "-"))
            continue
        deepest = unit["displacement"].text(float(depth.max()), 4)
        place = f"{angles.from_bottom(float(life.theta[ties.top_angle(depth, life.theta)])):z.2f} deg"
        rows.append((name, unit["work per stress"].text(volume, 4), deepest, place))
    energies = [
        ("dissipated by friction", unit["energy"].text(last.dissipation, 4), "in all cycles"),
        ("gone with the material", unit["energy"].text(last.removed, 4), "elastic energy of worn material"),
    ]
    parts: list[SectionPart] = [
        page.album.figure(scar_plot(Subject(life))),
        Facts(f"Worn off after {cycles_text(last.cycle)}", rows, ("body", "volume", "largest depth", "at")),
        Facts("Energies", energies, ("energy", "value", "remark")),
        Text("Beside a worn stick zone the pressure has a peak that depends on the nodes. Depth and volume do not."),
    ]
    return PageSection("profile", "Worn profile", parts)


def damage(page: PageParts) -> PageSection:
    """Return the damage of the material of all bodies with constants, and the race of crack and wear."""
    source, life = page.source, _life(page)
    if not source.worn:
        criteria = (source.case.fatigue or FatigueAssessment()).criteria
        words = f"Damage needs constants for a life by {' or '.join(criteria)}: the key fatigue of a case file "
        words += "gives them."
        if len(life) < 2:
            words = "Damage needs the profile of cycle 0 and another one."
        return PageSection("damage", "Damage", [Text(words, "missing")])
    parts: list[SectionPart] = []
    for one in source.worn:
        parts.append(page.album.figure(damage_of(life, one)))
        parts.append(Facts(f"Race of crack and wear: {_subject(one)}", _race(one), ("subject", "value")))
    summed = source.worn[0].cycles.size
    if summed < len(life):
        parts.append(Text(f"The damage is summed up from {summed} of {len(life):,} stored cycles.", "missing"))
    return PageSection("damage", "Damage", parts)


def _subject(found: WornFatigue) -> str:
    return f"{points.edge_body(found.problem, found.body)}, {found.criterion.title()}"


def _race(found: WornFatigue) -> list[tuple[str, str]]:
    """Return what is known of the first crack, and of the material that wears away: rows of (subject, text)."""
    length, left = units(found.problem)["displacement"], found.hot_spots[-1]
    depth = f"{length.text(left.depth, 4)} under" if left.depth else "on"
    place = f"at {angles.from_bottom(left.theta):z.2f} deg, {depth} the first surface"
    alone = cycles_text(float(f"{found.first_life:.4g}")) if math.isfinite(found.first_life) else "infinite"
    gone = float(np.where(found.is_gone[-1], found.damage[-1], 0.0).max())
    change = "not known: it needs three stored cycles"
    if not math.isnan(found.error):
        change = f"{100.0 * found.error:.2g} %" if math.isfinite(found.error) else "a crack in one of both only"
    return [
        ("end of the race", f"{found.race.words}: {found.words}"),
        ("life on the first profile alone", alone),
        ("largest damage of material still there", f"{left.damage:.4g}, {place}"),
        ("largest damage of material worn off", f"{gone:.4g}" if gone else "none"),
        ("change with every second stored cycle", change),
    ]


def contact(page: PageParts) -> PageSection:
    """Return tractions, slip and zones over one cycle on the last profile."""
    source, life = page.source, _life(page)
    if not len(life):
        return PageSection("contact", "Contact on the last profile", [Text(NO_PROFILE, "missing")])
    first, last = (load_point(life[-1].states[place]) for place in (0, -1))
    words = f"One cycle on the profile after {cycles_text(life[-1].cycle)}: load points {first:,.0f} to {last:,.0f}. "
    words += "Figures also show the states of the extremes of all stored profiles."
    parts: list[SectionPart] = [Text(words), *sections.tractions(page).parts]
    if source.cycle is None:
        parts.append(Text(f"There is no figure of the slip: {source.why_no_cycle}.", "missing"))
    else:
        parts += sections.slip_parts(page, source.cycle)
    return PageSection("contact", "Contact on the last profile", [*parts, *sections.zones(page).parts])


WEAR_SECTIONS: Sequence[Callable[[PageParts], PageSection]] = (
    overview, numbers, profile, damage, sections.case, sections.materials, sections.loads, contact, sections.stresses,
    margins, sections.checks, sections.provenance,
)  # fmt: skip
"""All sections, in the order of the page."""
