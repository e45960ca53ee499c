"""``fastpin charts``: tables of solved contacts with error bounds."""

from __future__ import annotations

import argparse
from functools import partial

from fastpin import assess, report
from fastpin.charts import lookups
from fastpin.cli.terminal import as_options, check_outputs, flag, say, write_outputs
from fastpin.errors import InputError


def run(options: argparse.Namespace) -> int:
    """Print the list of charts, the value of one, or formulas; write the nodes of a chart."""
    given = {name: value for name in lookups.CYCLE_PARAMETERS if (value := getattr(options, name)) is not None}
    chart = None if options.chart is None else lookups.chart_of(options.chart)
    if chart is None and given:
        raise InputError(flag(next(iter(given))), "has a meaning with the name of a chart only")
    if chart is None and options.csv is not None:
        raise InputError("--csv", "has a meaning with the name of a chart only")
    check_outputs({"--csv": options.csv, "--json": options.json})
    with as_options(lookups.CYCLE_PARAMETERS):
        found = lookups.lookup(chart.name, **given) if chart is not None and given else None
    if options.formulas and options.json != "-":
        say(*report.charts.formula_text().split("\n"))
    elif chart is not None and found is not None and options.json != "-":
        say(report.charts.value_text(chart, found))
    elif options.csv is None and options.json is None:
        say(*report.charts.chart_list().split("\n"))
    files = [(options.csv, lambda path: report.charts.write_chart(lookups.chart_of(options.chart), path))]
    looked = report.charts.Looked(lookups.CHARTS if chart is None else {chart.name: chart}, given, found)
    document = partial(assess.outputs.whole_document, report.charts.LOOKED, looked, {})
    return write_outputs(files, options.json, document)
