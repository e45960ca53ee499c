"""Draw figures beyond the paper: ``python -m docs.beyond.figures memory klang --output out`` from a copy of the source.

Each figure is a ``PaperFigure`` in ``FIGURES`` of a file beside this one. Its picture, NAME.png, and its numbers,
NAME.csv, are written. Without a name, all of them are drawn.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from docs.beyond import (
    finite_bodies,
    handbook_formulas,
    interference,
    klang,
    lug_concentration,
    memory,
    rectangular_lug,
    regimes,
    rigid_pin,
    sliding_onset,
)
from fastpin.assess.outputs import write_csv
from fastpin.published.records import PaperFigure, save_drawing

FIGURES: dict[str, PaperFigure] = {
    figure.name: figure
    for subject in (
        memory,
        sliding_onset,
        rigid_pin,
        finite_bodies,
        rectangular_lug,
        lug_concentration,
        interference,
        regimes,
        klang,
        handbook_formulas,
    )
    for figure in subject.FIGURES
}
"""All figures by name."""


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", choices=[*FIGURES, []], metavar="NAME", help=", ".join(FIGURES))
    parser.add_argument("--nodes", type=int, default=400, help="number of nodes (default 400)")
    parser.add_argument("--output", type=Path, default=Path(), help="folder of the files (default: this one)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    for name in options.names or FIGURES:
        figure = FIGURES[name]
        curves = figure.compute(max(options.nodes, figure.least_nodes), None)
        write_csv(curves, options.output / f"{name}.csv", [figure.title])
        save_drawing(figure.draw, curves, options.output / f"{name}.png", dpi=300.0)


if __name__ == "__main__":
    main()
