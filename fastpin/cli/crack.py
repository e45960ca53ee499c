"""``fastpin crack``: the growth of a crack at the edge of the hole under the loads of a stored result."""

from __future__ import annotations

import argparse
import sys

from fastpin import casefile, figures, storage
from fastpin.assess import outputs
from fastpin.assess.crack import DOCUMENT, QUESTION, CrackStops, growth_curve, growth_line, growth_table
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import check_outputs, flag, say, write_outputs
from fastpin.errors import InputError
from fastpin.model.case import Case, questions_of
from fastpin.model.crack import CrackGrowth, crack_from
from fastpin.model.growth import LAWS
from fastpin.model.keys import CASE
from fastpin.model.units import from_units, units


def run(options: argparse.Namespace) -> int:
    """Print the growth of a crack, at one place or where a crack grows fastest, and draw it."""
    with storage.stored.StoredResult(options.result) as stored:
        case = stored.case
        stops = CrackStops.of(len(case.history), stored.result.cycles, stored.between, options.spectrum)
    check_outputs({"--output": options.output, "--csv": options.csv, "--json": options.json}, figures=("--output",))
    try:
        with Bar(1, QUESTION.bar) as bar:
            found = stops.growth(_how(options, case), progress_to(bar))
    except InputError as error:
        name = "at" if error.field == "theta" else error.field
        raise InputError(flag(name) if hasattr(options, name) else name, error.reason) from None
    files = [
        (options.output, lambda path: figures.plot_crack_growth(found, path, case.title)),
        (options.csv, lambda path: outputs.write_csv([growth_curve(found)], path)),
    ]
    code = write_outputs(
        files,
        options.json,
        lambda: outputs.whole_document(DOCUMENT, found, units(found.problem), title=case.title),
        lambda: [growth_line(found), "", *growth_table(found).split("\n")],
    )
    if not stops.is_spectrum and all(state.fraction == 1.0 for state in stops.states):
        words = "K between the corners is unknown: run --between 10 keeps states there"
        say(f"note: the cycle has only its {len(stops.states)} corners; {words}", file=sys.stderr)
    return code


def _how(options: argparse.Namespace, case: Case) -> CrackGrowth:
    """The crack of the options, else that of the case."""
    known = case if options.case is None else casefile.read_case(options.case)
    if options.case is not None and known.crack is None:
        raise InputError("case", f"{options.case} has no section [crack]")
    crack = questions_of(known).get("crack")
    entries = {} if crack is None else crack.entries()
    given = {"first": options.first, "last": options.last, "theta": options.at, "body": options.body}
    given |= {"angle": options.angle, "place": options.place}
    for one, other in (("theta", "place"), ("place", "theta")):
        if given[one] is not None:
            entries.pop(other, None)
    keys = dict.fromkeys(["law", *(name for _, names, _ in LAWS.values() for name in names)])
    law = {name: value for name in keys if (value := getattr(options, name, None)) is not None}
    if law:
        given["law"] = {"law": "walker"} | law
    given = {name: value for name, value in given.items() if value is not None}
    entries |= from_units(given, CASE["crack"], case.problem.unit_system)
    return crack_from(**entries)
