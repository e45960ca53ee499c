"""Small plans, and ways to run and compare them, for the tests of sweeps."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

import fastpin
from fastpin.states.state import State
from fastpin.storage import store
from fastpin.studies import parse_plan
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import KEY_FIGURES
from scripts.inline import Inline

FRICTION = """
title = "Friction"
[grid]
"contact.friction" = { from = 0.1, to = 0.9, count = COUNT }
"solve.nodes" = [61]
"""

MOMENT = """
title = "Moment that friction carries"
[grid]
"contact.pin_load" = ["centre"]
"solve.nodes" = [41]
"contact.friction" = [0.1, 0.4]
"load.2.M" = { from = 1000.0, to = 9000.0, count = 3, spacing = "log" }
"""
"""The two largest moments are too much for the smaller friction."""

MAP = """
[grid]
"contact.friction" = [0.2, 0.4]
"contact.clearance" = { from = 1e-6, to = 1e-4, count = 3, spacing = "log" }
[[list]]
"pin.material" = "steel"
[[list]]
"pin.E" = 1e11
"""


def planned(folder: Path, case: str, text: str) -> Plan:
    """The plan of a text that lies in a folder, beside its base case."""
    (folder / "case.toml").write_text(case, encoding="utf-8")
    return parse_plan(f'case = "case.toml"\n{text}', folder=folder)


def run_here(_: object, tasks: Iterable[Any], submit: Callable[..., Any], size: object) -> Iterator[Any]:
    """Make runs in this process, in place of ``through_processes`` of fastpin.studies.workers."""
    for task in tasks:
        yield (task,), submit(Inline(), (task,)).result()


def assert_same_as_serial(plan: Plan, directory: Path) -> None:
    """Every run of the plan has the bits of a solution in this process."""
    for run, point in plan.runs.items():
        case = plan.case(point)
        alone = fastpin.solve(case.problem, case.history, **case.options.keywords())
        stored = store.load(directory / "results" / f"{run}.h5")
        assert len(alone) == len(stored)
        for expected, state in zip(alone, stored, strict=True):
            for name in (item.name for item in fields(State) if item.name not in ("problem", "grid", "marks")):
                assert np.array_equal(getattr(expected, name), getattr(state, name)), name
            assert np.array_equal(expected.old_borders, state.old_borders)
            assert np.array_equal(expected.old_places, state.old_places, equal_nan=True)


def made_up_rows(plan: Plan) -> list[dict[str, Any]]:
    """Rows of an index for the plan MAP, without any run. One failed, one waits.

    The peak pressure in MPa is 100 times the friction plus the place of the clearance.
    """
    rows: list[dict[str, Any]] = []
    for index, point in enumerate(plan.points):
        number = 100.0 * point.values["contact.friction"] + index % 3
        row = dict.fromkeys((*plan.fields, *KEY_FIGURES, "seconds", "started", "host")) | point.values
        row |= {"id": point.id, "status": "done", "reason": None, "dimensionless": 0}
        rows.append(row | {"peak_pressure": 1e6 * number, "contact_start": -number, "states": 3, "seconds": 0.1})
    rows[1] |= {"status": "failed", "reason": "lost, at last", "peak_pressure": None}
    given = dict.fromkeys(plan.fields) | plan.points[2].values
    rows[2] = {"id": rows[2]["id"], "status": "waiting", "reason": None, **given}
    return rows
