"""What the sections of a page share, and its margins: the verdict, the table, and the lines for signatures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from fastpin.assess.margins import HEADS, all_margins, in_order, margin_rows, verdict
from fastpin.damage.margins import fatigue_margins
from fastpin.model.points import edge_body
from fastpin.pages.album import Album
from fastpin.pages.content import Facts, PageSection, Text
from fastpin.pages.source import Source
from fastpin.states.margins import Margin
from fastpin.states.walking import walk_margins
from fastpin.studies.convergence import Convergence


@dataclass(frozen=True)
class PageParts:
    """What the sections of one page share.

    Attributes
    ----------
    source : Source
    album : Album
    convergence : Convergence or None
    """

    source: Source
    album: Album
    convergence: Convergence | None = None

    @cached_property
    def margins(self) -> list[Margin]:
        """The margins of yield, bush, fatigue, crack and plies, the smallest one first."""
        source, problem = self.source, self.source.case.problem
        cycle = [] if source.cycle is None else source.cycle.states
        found = source.found
        judged = {edge_body(problem, one.body) for one in found["fatigue"].reserves} if "fatigue" in found else set()
        last_cycle = walk_margins(cycle) + [
            row
            for row in fatigue_margins(problem, source.fatigue, cycle)
            if not (math.isnan(row.margin) and row.subject.removeprefix("last cycle only: ").split(",")[0] in judged)
        ]
        return in_order(all_margins(source.static_margins, last_cycle, found))


def sentence(line: str) -> str:
    """Return a line of a report as a sentence."""
    return f"{line[0].upper()}{line[1:]}."


def margins(page: PageParts) -> PageSection:
    """Return the margins, each with the state that governs it, and the lines of those who answer for the report."""
    source, found = page.source, page.margins
    run = "" if source.result.complete else " of an unfinished run"
    states = "the only kept state" if source.points.size == 1 else f"all {source.points.size:,} kept states"
    words = f"Margins of safety over {states}{run}: allowable/value - 1"
    remarks = "Between two kept states nothing is known. The von Mises stress is looked at on the edges and on circles "
    remarks += "down to a third of the hole's radius below them; fastpin is elastic."
    if any(row.part for row in found):
        remarks += " Of the plate only the edge of its hole is looked at: its other places may fail first."
    rows, author = margin_rows(source.case.problem, found), source.case.about.author
    signed = [("prepared", author, "", ""), ("checked", "", "", ""), ("approved", "", "", "")]
    return PageSection(
        "margins",
        "Margins",
        [
            Text(sentence(verdict(found, source.result.complete))),
            Facts(words, rows, HEADS),
            Text(remarks),
            Facts("Signatures", signed, ("", "name", "date", "signature"), tall=True),
        ],
    )
