"""``fastpin compliance``: from the outline of a finite plate to its compliance file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fastpin import casefile, figures, lugs
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import EXIT_OK, check_outputs, say, write_files, write_text
from fastpin.errors import CaseFileError, InputError, printable
from fastpin.version import __version__

DOUBTFUL = 1e-5
"""Estimated error above which a note is printed. Contact tractions have errors of this size with 401 nodes."""


def run(options: argparse.Namespace) -> int:
    """Make a compliance file, and print how good it is; or print a commented lug file."""
    if options.example:
        sys.stdout.write(casefile.LUG_EXAMPLE)
        return EXIT_OK
    if options.lug is None:
        raise InputError("lug", "the lug file is missing; start with: fastpin compliance --example > lug.toml")
    output = options.lug.with_suffix(".json") if options.output is None else options.output
    found = casefile.read_lug(options.lug)
    check_outputs({"--output": output, "--plot": options.plot})
    drawn = write_files([(options.plot, lambda path: figures.plot_lug(found.lug, path, found.title))])
    made_by = f"fastpin {__version__}, {found.title or printable(options.lug.name)}"
    with Bar(1, "compliance") as progress_bar:
        try:
            result = lugs.plate_compliance(found.lug, found.harmonics, progress_to(progress_bar), made_by)
        except InputError as error:
            raise CaseFileError(str(options.lug), [(0, str(error))]) from None
    code = write_files([(output, lambda path: write_text(path, result.compliance.to_text()))])
    if code == EXIT_OK:
        drawing = options.plot if options.plot is not None and drawn == EXIT_OK else None
        for note in found.notes:
            say(f"outline          {note}")
        _print_report(result, output, drawing)
    return code or drawn


def _print_report(result: lugs.PlateResult, output: Path, drawing: Path | None) -> None:
    compliance = result.compliance
    say(f"harmonics        {compliance.order}")
    say(f"last harmonic    {result.last:.1e} of the largest")
    say(f"symmetry error   {result.asymmetry:.1e}")
    say(f"estimated error  {result.error:.1e}, from a coarser discretisation")
    say(f"nodes            {result.nodes:,} on all edges")
    say(f"loads            {', '.join(compliance.own_loads) or 'none of its own'}")
    say(f"wrote {output}" + ("" if drawing is None else f" and {drawing}"))
    if result.error > DOUBTFUL:
        say(f"note: the estimated error is above {DOUBTFUL:g}; edges may be too near one another", file=sys.stderr)
