"""A joint whose bush slips in its seat, for tests of its outputs: few nodes, three cycles of Q to and fro."""

import functools
from pathlib import Path

import fastpin
from fastpin import Case, casefile

BONDED = """
pin.material = "steel"
plate.material = "7075-T6"
[contact]
hole_radius = 10e-3
clearance = 60e-6
friction = 0.2
thickness = 10e-3
[plate_body]
E = 100e9
nu = 0.35
outer_radius = 12.5e-3
interference = 20e-6
"""
"""The joint with its bush bonded."""

SLIPS = "bonded = false\nfriction = 0.15\n"
"""The keys of a bush that slips."""

LOADS = "[[load]]\nP = 40e3\n[[load]]\nQ = [20e3, -20e3, 0]\nrepeat = 3\n"

TEXT = f"{BONDED}{SLIPS}[solve]\nnodes = 48\nslip_sums = true\n{LOADS}"
"""The text of the case."""


@functools.cache
def sample_case() -> Case:
    """Return the case."""
    return casefile.parse_case(TEXT)


@functools.cache
def sample_seat() -> fastpin.Result:
    """Return the result of the case. Nothing may change it."""
    case = sample_case()
    return fastpin.solve(case.problem, case.history, **case.options.keywords())


def stored_sample(path: Path) -> Path:
    """Write the case beside `path`, and its result to it."""
    path.with_suffix(".toml").write_text(TEXT, encoding="utf-8")
    sample_seat().save(path)
    return path
