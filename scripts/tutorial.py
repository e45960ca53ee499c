"""Draw the figures of docs/tutorial.md: ``python -m scripts.tutorial``.

The commands are those of the page. They are drawn again after a change of the page's case or of the figures' look.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from fastpin.cli.main import main

DOCS = Path(__file__).resolve().parents[1] / "docs"
CASE = DOCS / "tutorial.toml"


def draw(folder: Path) -> list[Path]:
    """Draw all figures of the tutorial into a folder, and return their paths."""
    drawn = {name: folder / f"tutorial-{name}.png" for name in ("sketch", "tractions", "slip", "hoop")}
    with tempfile.TemporaryDirectory() as scratch:
        result = f"{scratch}/joint.h5"
        commands = (
            ["plot", str(CASE), "sketch", "-o", str(drawn["sketch"])],
            ["run", str(CASE), "-o", result, "--plot", str(drawn["tractions"]), "--states", "1,2"],
            ["plot", result, "slip", "-o", str(drawn["slip"])],
            ["plot", result, "hoop", "--states", "1,2", "-o", str(drawn["hoop"])],
        )
        for command in commands:
            if main(command) != 0:
                raise SystemExit(f"fastpin {' '.join(command)} has failed")
    return list(drawn.values())


if __name__ == "__main__":
    draw(DOCS / "figures")
