"""The sections of a tolerance study on the page of its sweep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fastpin.figures.tolerances import samples_of, tornado_of
from fastpin.pages.album import Album
from fastpin.pages.content import Facts, Items, Listing, PageSection, SectionPart, Table, Text
from fastpin.report.sweep import definition_words
from fastpin.report.tolerances import failed_words, tables, tolerance_chart
from fastpin.studies.index import DONE
from fastpin.studies.tolerances import Tolerances

MOST_DRAWN = 8
"""Most outcomes that are drawn."""

BELOW = 2
"""Most outcomes of a figure, one below the other: more would not fit on a page of paper."""

MOST_FIELDS = 8
"""Most fields of an outcome that shares its figure."""


def limits_section(study: Tolerances, runs: Sequence[dict[str, Any]], album: Album) -> PageSection:
    """Return the section of the plan: fields with their limits, outcomes, and the text."""
    fields = [
        (name, f"{each.nominal:.6g}", f"{each.low:.6g} to {each.high:.6g}") for name, each in study.limits.items()
    ]
    heads = ("field", "nominal", "limits, in the units of the case file")
    parts: list[SectionPart] = [Facts("Fields and their limits", fields, heads)]
    outcomes = [(name, definition_words(outcome)) for name, outcome in study.plan.outcomes.items()]
    parts.append(Facts("Outcomes", outcomes, ("name", "definition")))
    return PageSection("plan", "Plan", [*parts, Listing("The plan", study.plan.text)])


def effects_section(study: Tolerances, runs: Sequence[dict[str, Any]], album: Album) -> PageSection:
    """Return the section of the effects: for each outcome a table and sentences, then tornados and samples."""
    parts: list[SectionPart] = []
    if lost := failed_words(study, runs):
        parts.append(Text(f"{lost[0].upper()}{lost[1:]}.", "note"))
    if not any(run["status"] == DONE for run in runs):
        return PageSection("effects", "Effects", [*parts, Text("No run is finished.", "missing")])
    for head, columns, sentences in tables(study, runs):
        parts += [Table(head, columns), Items([f"{each[0].upper()}{each[1:]}." for each in sentences])]
    names = [*study.plan.outcomes][:MOST_DRAWN]
    beside = BELOW if len(study.limits) <= MOST_FIELDS else 1
    for first in range(0, len(names), beside):
        charts = [tolerance_chart(study, runs, name) for name in names[first : first + beside]]
        parts.append(album.figure(tornado_of(charts)))
        if study.samples:
            parts.append(album.figure(samples_of(charts)))
    if len(study.plan.outcomes) > MOST_DRAWN:
        words = f"{len(study.plan.outcomes) - MOST_DRAWN:,} more outcomes are not drawn here"
        parts.append(Text(f"{words}. fastpin tolerances --plot FILE --value NAME draws one.", "missing"))
    return PageSection("effects", "Effects", parts)
