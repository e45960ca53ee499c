"""The crack of a case: the states under which it grows, its outputs and its text."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin import cracks, damage
from fastpin.assess import outputs
from fastpin.assess.margins import ROW, crack_margins, in_json
from fastpin.assess.outputs import Curve, Follow, Output, chosen, kept, or_null, table
from fastpin.cracks.fates import CRACK_FATES, CrackFate
from fastpin.errors import InputError
from fastpin.model import Case, LoadHistory, Problem, angles, points
from fastpin.model.case import BESIDE, questions_of
from fastpin.model.crack import CrackGrowth, edge_name, law_of, mouth_words
from fastpin.model.doubts import doubts_given
from fastpin.model.growth import KnownLaw, Nasgro, Walker, law_entries
from fastpin.model.keys import LAW
from fastpin.model.unit_systems import SI
from fastpin.model.units import in_units, system_words, units
from fastpin.states.choice import missing_corners, span_of
from fastpin.states.cycles import Cycle
from fastpin.states.margins import over_yield_words
from fastpin.states.state import State

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.storage.held import Held

OF_MOUTH = "of a mouth beyond the hole"

GROWTH = (
    Output("angle_of_mouth", "angle", lambda found: found.crack.theta),
    Output("direction", "width", lambda found: found.crack.angle),
    Output("body", "text", lambda found: found.crack.body, allowed=points.EDGES),
    Output("edge", "text", lambda found: edge_name(found.problem, found.crack), OF_MOUTH, may_lack=True),
    Output("x", "length", lambda found: found.crack.place and found.crack.place[0], OF_MOUTH, may_lack=True),
    Output("y", "length", lambda found: found.crack.place and found.crack.place[1], OF_MOUTH, may_lack=True),
    Output(
        "law", of=lambda found: law_entries(found.law) if isinstance(found.law, Walker | Nasgro) else None,
        form=or_null({"type": "object"}),
    ),
    Output("repeated", "text", lambda found: found.per, allowed=("cycle", "spectrum")),
    Output("fate", "class", classes=CRACK_FATES),
    Output("life", "life", words="cycles or spectra; null: no end", optional=True),
    Output("error", words="numerical, in parts of the life or of the arrest; null: unknown", optional=True),
    Output("first", "length", lambda found: float(found.length[0]), optional=True),
    Output("last", "length", lambda found: float(found.length[-1]), optional=True),
    *outputs.numbers("arrest fracture", "length", optional=True),
    Output("words", "text"),
    Output("doubts", "texts", lambda found: [str(doubt) for doubt in found.doubts]),
)  # fmt: skip
"""Outputs of a :class:`fastpin.cracks.Growth`."""


LENGTHS = (
    Output("length", "length"),
    Output("K_max", "stress intensity", heading="K_I largest"),
    Output("K_min", "stress intensity", heading="K_I smallest", short="smallest"),
    Output("K_II", "stress intensity", heading="K_II"),
    Output("delta_K", "stress intensity", heading="range"),
    Output("threshold", "stress intensity"),
    Output("rate", "crack growth", short="growth"),
    Output("cycles"),
)
"""Outputs at each length: columns of CSV, JSON and the table of ``fastpin crack``."""


class CrackStops(NamedTuple):
    """One pass of the loads under which a crack grows.

    Attributes
    ----------
    states : list of State
        In the order of time.
    is_spectrum : bool
        Whether they are a whole history, else the last cycle.
    """

    states: list[State]
    is_spectrum: bool

    @classmethod
    def of(
        cls,
        corners: int,
        cycles: Sequence[Cycle],
        read: Callable[[int, int], Sequence[State]],
        spectrum: bool = False,
    ) -> CrackStops:
        """Choose the last cycle that has ended, or else the whole history.

        Parameters
        ----------
        corners : int
            Number of corners of the history.
        cycles : sequence of Cycle
            The cycles that have ended.
        read : callable
            ``read(first, last)`` gives the kept states from one corner to another, or more of them.
        spectrum : bool
            Whether the whole history is asked for.

        Raises
        ------
        InputError
            If the history has neither a cycle nor three corners, or the state at a corner was not kept.
        """
        if cycles and not spectrum:
            return cls(damage.cycle_states(read(*span_of(cycles[-1])), cycles[-1]), False)
        if corners < 3 and not spectrum:  # as for fatigue
            words = "has no cycle that has ended, and less than three corners; add repeat = 2 to a [[load]] block"
            raise InputError("history", words)
        states = list(read(0, corners))
        if len(states) < 2:
            raise InputError("states", "a spectrum needs at least two kept states")
        if missing_corners(states, 1, corners):
            raise InputError("states", 'not all corners of the history are kept; keep = "all" keeps them')
        return cls(states, True)

    def growth(self, how: CrackGrowth, progress: Follow | None = None) -> cracks.Growth:
        """Follow a crack under this pass, again and again. See :func:`fastpin.cracks.planned_growth`."""
        return cracks.planned_growth(self.states, how, self.is_spectrum, progress)


def passes_of(history: LoadHistory) -> str:
    """Return the name of the passes that a crack counts under a whole history: "cycles" or "spectra"."""
    return "cycles" if history.longest_cycle else "spectra"


@kept
def grown(result: Any, how: CrackGrowth) -> cracks.Growth:
    """Return the growth of a crack under a result. It is kept while the result lives.

    Raises
    ------
    InputError
        If the result has neither a cycle nor a spectrum, or the crack can't be followed.
    """
    stops = CrackStops.of(len(result.history), result.cycles, lambda first, last: result)
    with doubts_given():
        return stops.growth(how)


def find(case: Case, held: Held | None, progress: Follow | None = None) -> cracks.Growth | None:
    """Follow the crack of a case under its last cycle or its spectrum; None without a state.

    Raises
    ------
    InputError
        If it can't be followed.
    """
    crack = questions_of(case).get("crack")
    if held is None or crack is None:
        return None
    return CrackStops.of(len(case.history), held.result.cycles, held.between).growth(crack, progress)


def law_words(problem: Problem, law: KnownLaw) -> str:
    """Return a law of growth and its constants in words. Constants with their default in SI units are left out."""
    entries = law_entries(law) | ({} if problem.unit_system == SI else {"unit": law.unit})
    entries = in_units(problem, entries, LAW)
    names = ", ".join(f"{name} = {value:.6g}" for name, value in entries.items() if not isinstance(value, str))
    source = f"; source: {law.source}" if law.source else ""
    return f"{entries['law']}, {names} ({system_words(problem)}){source}"


def crack_words(problem: Problem, crack: CrackGrowth) -> str:
    """Lengths, place, direction, law and residual stress of a crack that is to grow."""
    length = units(problem)["length"]
    is_anywhere = crack.theta is None and crack.place is None
    place = "where it grows fastest" if is_anywhere else f"at {mouth_words(problem, crack, '.4g')}"
    parts = [f"{length.text(crack.first)} to {length.text(crack.last)}", place]
    parts += (
        [f"{math.degrees(crack.angle):.4g} deg from the {'radius' if crack.place is None else 'normal'}"]
        if crack.angle
        else []
    )
    parts += ["in the plate round the bush"] if crack.body == "seat" else []
    parts += [law_words(problem, law_of(problem, crack))]
    return ", ".join(parts + (["with a residual stress"] if crack.residual_stress is not None else []))


QUESTION = outputs.Question(
    words=crack_words,
    bar="{whole} of {total} places",
    failed="no crack is followed",
    margin_names={
        "fracture": "toughness over the largest K_I, at the first and at the last length",
        "growth": "threshold over the range of K_I at the first length",
    },
    unvaried="no run of a sweep grows a crack",
    keys=BESIDE["crack"].keys,
    outcomes={
        name: (output, grown)
        for name, output in {
            **chosen(GROWTH, ("fate", "life", "arrest")),
            "theta": GROWTH[0],  # the mouth
            "largest_K": Output("largest_K", "stress intensity", lambda found: found.K_max.max()),
        }.items()
    },
    find=find,
    judged=grown,
    lines=lambda growth, over: [growth_line(growth, over)],
    document=lambda growth, over: outputs.document(GROWTH, growth, units(growth.problem)),
    schema=lambda: outputs.schema_of(GROWTH),
    margins=crack_margins,
    remarks=lambda growth: [
        *([f"Law of growth: {law_words(growth.problem, growth.law)}"] if isinstance(growth.law, KnownLaw) else []),
        *(f"Doubt: {doubt}" for doubt in growth.doubts),
    ],
)
"""The crack of [crack]. Its outcome "largest_K" is the largest K_I up to the last length."""


def growth_curve(growth: cracks.Growth) -> Curve:
    """Return length, stress intensities, range, threshold, rate and cycles of a crack, by its length."""
    unit = units(growth.problem)
    columns = {each.column(unit).replace("cycle", growth.per): each.shown(growth, unit) for each in LENGTHS[:-1]}
    mouth = {"mouth [deg]": angles.from_bottom(growth.crack.theta), "body": growth.crack.body}
    return Curve(mouth, columns | {growth.passes: growth.cycles})


DOCUMENT = (
    outputs.UNITS,
    Output("crack", of=lambda growth: growth, parts=GROWTH),
    Output(
        "lengths", of=lambda growth: {name: column.tolist() for name, column in growth_curve(growth).columns.items()},
        form=outputs.map_of(
            outputs.list_of(outputs.UNKNOWN), "a column of numbers at all lengths, with its unit in its name"
        ),
    ),
    Output("margins", "list", lambda growth: in_json(growth.problem, crack_margins(growth)), parts=ROW),
)  # fmt: skip
"""Outputs of a :class:`fastpin.cracks.Growth` in the JSON of ``fastpin crack``."""


def growth_line(growth: cracks.Growth, over: Mapping[str, float] | None = None) -> str:
    """Return a line of text: the place of a crack, and what becomes of it.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.
    """
    mark = over_yield_words(over or {}, points.owner_of(growth.problem, growth.crack.body))
    where = " in the plate round the bush" if growth.crack.body == "seat" else ""
    mouth = mouth_words(growth.problem, growth.crack) + (" from the bottom" if growth.crack.place is None else "")
    line = f"crack{where} at {mouth}: {growth.words}"
    if growth.fate == CrackFate.NONE or math.isnan(growth.error):
        return line + mark
    of = "length" if growth.fate == CrackFate.STOPS else "life"
    if not growth.error < 1.0:
        return f"{line}; the error of this {of} is not known{mark}"
    power = math.floor(math.log10(max(growth.error, 1e-9)))
    return f"{line}; numerical error of this {of} below {math.ceil(growth.error / 10.0**power):g}e{power:03d}{mark}"


def growth_table(growth: cracks.Growth) -> str:
    """Return some lengths of a crack with its stress intensities, threshold, rate and cycles, as text."""
    unit = units(growth.problem)
    rows = np.geomspace(growth.length[0], growth.length[-1], 13)  # at most so many lengths
    at = np.unique(np.abs(np.log(growth.length[:, None] / rows)).argmin(axis=0))
    cells = []
    for each in LENGTHS:
        same = [float(value) for other in LENGTHS if other.kind == each.kind for value in other.value(growth)]
        factor, label = unit[each.kind].scale(same) if each.kind else (1.0, "")
        texts = [f"{factor * value:.4g}" for value in each.value(growth)[at].tolist()]
        name = each.short or each.heading or each.name if each.kind else growth.passes
        cells.append((name, label.replace("cycle", growth.per), ["never" if text == "inf" else text for text in texts]))
    return table(cells)
