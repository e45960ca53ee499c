"""A life of wear: its outputs, those of its damage, its table, curves and JSON."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin import damage
from fastpin.assess import outputs
from fastpin.damage.race import Race
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.assessment import FatigueAssessment, assessed_bodies
from fastpin.model.doubts import doubts_given
from fastpin.model.points import Body, edge_body
from fastpin.model.ties import top
from fastpin.model.units import units
from fastpin.model.wear import Wear, cycles_text
from fastpin.version import __version__

if TYPE_CHECKING:  # they import compiled code, and a plan is read without it
    from fastpin.damage import WornFatigue
    from fastpin.wear_lives.wear_result import WearResult, WornCycle

COUNTS = outputs.numbers("cycle next_jump solved", "whole")
"""Counts of a :class:`fastpin.wear_lives.WornCycle`."""


WORN = (
    outputs.Output("depth", "displacement"),
    outputs.Output("volume", "work per stress"),
    outputs.Output("pin_volume", "work per stress", lambda one: one.volumes[0]),
    outputs.Output("plate_volume", "work per stress", lambda one: one.volumes[1]),
    outputs.Output("energy_per_cycle", "energy", short="energy/cycle"),
    outputs.Output("dissipation", "energy"),
    outputs.Output("removed", "energy"),
    outputs.Output("largest_pressure", "traction", short="largest p"),
)
"""Outputs of a :class:`fastpin.wear_lives.WornCycle`. Dissipation and removed energy are those of all cycles so far."""


PROFILES = (
    outputs.Output("pin_depth", "displacement"),
    outputs.Output("plate_depth", "displacement"),
    outputs.Output("pressure", "traction", lambda one: one.states[-1].pressure),
)
"""Outputs at each node. The pressure is that on the profile at the end of one more cycle."""


WEAR_OUTCOMES = outputs.chosen(
    (*WORN, outputs.Output("pin_share")),
    ("volume", "depth", "pin_share", "energy_per_cycle", "largest_pressure"),
)
"""Outcomes of the last cycle: the last profile, and one cycle on it."""


RACE_OUTCOMES = {
    "life": outputs.Output("life", "life"),
    "damage": outputs.Output("damage", "", lambda found: found.damage[-1].max()),
    "race": outputs.Output("race", "class", classes={int(race): race.words for race in Race}),
}
"""Outcomes of a :class:`fastpin.damage.WornFatigue`: cycles until a crack starts, largest sum of damage, who wins. The
life is a median life, without residual stress.
"""

DEBRIS = "debris is not modelled"
"""A limit of the model that every report names."""

LAW_WORDS = {
    "archard": "depth = coefficient times int p |ds|, with the pressure p and the slip s",
    "energy": "depth = coefficient times the energy that friction dissipates per area",
}
"""Words for the laws of wear."""


def of_wear(quantity: str, wear: Wear, criterion: str, body: Body, result: Any) -> float:
    """Return an outcome of a result that is followed on a profile that wears. Lives are kept while the result lives."""
    if quantity in WEAR_OUTCOMES:
        return WEAR_OUTCOMES[quantity].number(_worn(result, wear)[-1])
    return RACE_OUTCOMES[quantity].number(_worn_fatigue(result, wear, criterion, body))


@outputs.kept
def _worn(result: Any, wear: Wear) -> WearResult:
    with doubts_given():
        return result.wear(**wear.given)


@outputs.kept
def _worn_fatigue(result: Any, wear: Wear, criterion: str, body: Body) -> WornFatigue:
    return _worn(result, wear).fatigue(criterion, body)


def table(result: WearResult) -> str:
    """Return the chosen cycles as a table. A long table lacks its middle, but for the extremes."""
    columns, lines = cycle_columns(result), cycle_lines(result)
    return outputs.table_of_lines(outputs.columns_at(columns, outputs.printed_rows(lines)), lines, columns[0][2])


def cycle_lines(result: WearResult) -> list[outputs.TableLine]:
    """Return the lines of the table of the chosen cycles, with those of the largest pressure and dissipation."""
    pressures, energies = [each.largest_pressure for each in result], [each.energy_per_cycle for each in result]
    extremes = {top(values) for values in (pressures, energies) if values}
    return outputs.with_rows(outputs.cut_lines(len(result)), extremes)


def cycle_columns(result: WearResult) -> list[outputs.Column]:
    """Return the columns of the table of all chosen cycles."""
    unit = units(result.problem)
    of_pin = outputs.Output("pin_share", "share", short="of the pin", digits=".3g")
    shown = ("cycle", "depth", "volume", "energy_per_cycle", "largest_pressure", "pin_share", "solved")
    return [each.cells(result, unit) for each in outputs.chosen((*COUNTS, *WORN, of_pin), shown).values()]


def coefficient_words(result: WearResult) -> dict[str, str]:
    """Return the wear coefficients in words, of each body at the contact that wears."""
    unit = units(result.problem)["wear coefficient"]
    found = {}
    for body, values in zip(("pin", edge_body(result.problem, "plate")), result.coefficients, strict=True):
        if not values.any():
            continue
        least, most = (unit.text(float(value), 4) for value in (values.min(), values.max()))
        found[body] = most if least == most else f"{least.partition(' ')[0]} to {most} along the rim"
    return found


def wear_input(result: WearResult) -> dict[str, Any]:
    """Return what a life of wear depends on beside its problem and its loads, JSON-ready, in SI units.

    A coefficient that is the same at all nodes is one number.
    """
    pin, plate = (row.tolist() if np.ptp(row) else float(row[0]) for row in result.coefficients)
    control = {"cycles": result.all_cycles, "tolerance": result.tolerance}
    return {"law": result.law, "pin": pin, "plate": plate, **control}


def law_rows(result: WearResult) -> list[tuple[str, str]]:
    """Return the law of wear, its coefficients, the cycles and the control of their error: rows of (subject, text)."""
    tolerance = "0: every cycle is solved"
    if result.tolerance:
        tolerance = f"{result.tolerance:g} of the largest depth, for the error by cycles that stand for many"
    return [
        ("law", f"{result.law}: {LAW_WORDS[result.law]}"),
        *((f"wear coefficient of the {body}", words) for body, words in coefficient_words(result).items()),
        ("cycles", f"{result.all_cycles:,}"),
        ("tolerance", tolerance),
    ]


def followed_words(result: WearResult) -> str:
    """Return words on how many cycles were followed; an unfinished life says so."""
    if result.complete:
        return cycles_text(result[-1].cycle)
    return f"unfinished: {result[-1].cycle if len(result) else 0:,} of {cycles_text(result.all_cycles)}"


def reached_line(result: WearResult) -> str:
    """Return a line of text: how many cycles were followed, and how many of them were solved."""
    solved = f", {result[-1].solved:,} of them solved" if len(result) else ""
    return f"{followed_words(result)}{solved}; {DEBRIS}"


def scar_curves(result: WearResult) -> list[outputs.Curve]:
    """Return the profiles after all stored cycles, a curve each, in the order of the angles.

    The pressure is that on the profile at the end of one more cycle.
    """
    unit = units(result.problem)
    angles = np.array([from_bottom(angle) for angle in result.theta.tolist()])
    order = np.argsort(angles)
    curves = []
    for each in result:
        columns = {"angle [deg]": angles} | {one.column(unit): one.shown(each, unit) for one in PROFILES}
        curves.append(outputs.Curve({"cycle": each.cycle}, {name: values[order] for name, values in columns.items()}))
    return curves


def cycles_curve(result: WearResult) -> outputs.Curve:
    """Return the numbers of all stored cycles."""
    unit = units(result.problem)
    names = ("cycle", "pin_volume", "plate_volume", "depth", "energy_per_cycle", "largest_pressure")
    shown = outputs.chosen((*COUNTS, *WORN), names).values()
    return outputs.Curve(
        {}, {each.column(unit): np.array([float(each.shown(one, unit)) for one in result]) for each in shown}
    )


def damages(cycles: Sequence[WornCycle], how: FatigueAssessment | None) -> list[WornFatigue]:
    """Return the damage of the material that wears, by each criterion and of each body of a section [fatigue].

    Without a section it is Smith, Watson and Topper's. A body without constants for a life is left out; less than two
    cycles have no damage.
    """
    how, found = how or FatigueAssessment(), []
    for criterion in how.criteria if len(cycles) > 1 else ():
        with contextlib.suppress(InputError):  # no body has the constants
            for body in assessed_bodies(cycles[0].states[0].problem, how, criterion):
                found.append(damage.worn_fatigue(cycles, criterion, body))  # type: ignore[arg-type]
    return found


def damage_curve(found: WornFatigue) -> outputs.Curve:
    """Return the damage of all material points after the last cycle, and whether they are gone."""
    length = units(found.problem)["length"]
    shape = found.damage[-1].shape
    angles = np.array([from_bottom(angle) for angle in found.theta.tolist()])
    columns = {
        "angle [deg]": np.broadcast_to(angles, shape),
        f"depth [{length.name}]": np.broadcast_to(length.factor * found.depth[:, None], shape),
        "damage": found.damage[-1],
        "worn off": found.is_gone[-1].astype(float),
        "cycles to damage 1": np.where(np.isfinite(found.broken), found.broken, np.nan),
    }
    return outputs.Curve({"body": found.body}, {name: np.ravel(values) for name, values in columns.items()})


def _profile(result: WearResult, values: np.ndarray) -> list[float]:
    """Values at the nodes in the unit of a wear coefficient."""
    scaled: np.ndarray = units(result.problem)["wear coefficient"].factor * values
    return scaled.tolist()


def _cycles(result: WearResult) -> list[dict[str, Any]]:
    """The chosen cycles, each with its loss of friction."""
    unit = units(result.problem)
    return [
        outputs.document(COUNTS, each, unit) | {"tau": tau} | outputs.document((*WORN, *PROFILES), each, unit)
        for each, tau in zip(result, _profile(result, result.tau), strict=True)
    ]


LIFE = (
    outputs.Output("complete", "truth"),
    outputs.UNITS,
    outputs.Output("law", "text"),
    outputs.Output("tolerance"),
    *(
        outputs.Output(name, of=read, form=outputs.list_of(outputs.NUMBER))
        for name, read in {
            "angles": lambda life: [from_bottom(angle) for angle in life.theta.tolist()],
            "pin_coefficient": lambda life: _profile(life, life.coefficients[0]),
            "plate_coefficient": lambda life: _profile(life, life.coefficients[1]),
        }.items()
    ),
    outputs.Output("statistics", form=outputs.map_of(outputs.NUMBER, "counters of the solver")),
    outputs.Output(
        "cycles", of=_cycles,
        form=outputs.list_of(
            outputs.object_of(
                outputs.properties(COUNTS) | {"tau": outputs.NUMBER} | outputs.properties(WORN)
                | {name: outputs.list_of(each) for name, each in outputs.properties(PROFILES).items()}
            )
        ),
    ),
)  # fmt: skip
"""Outputs of a life of wear."""


def document(result: WearResult | None, title: str = "", error: str | None = None) -> dict[str, Any]:
    """Return a life of wear as a JSON-ready dict. Angles are in degrees from the bottom of the hole.

    `error` is the reason why it is incomplete. Without a result no cycle was reached.
    """
    if result is None:
        empty = {"complete": False, "units": {}, "law": "", "tolerance": 0.0, "statistics": {}}
        rest: dict[str, Any] = {each.name: empty.get(each.name, []) for each in LIFE}
        return {"fastpin": __version__, "title": title, "error": error, **rest}
    return outputs.whole_document(LIFE, result, {}, title=title, error=error)
