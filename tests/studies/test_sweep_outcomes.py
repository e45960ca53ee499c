"""Outcomes of sweeps: read in workers, kept, added later, changed, and what becomes of their failures."""

import shutil
import sqlite3
from pathlib import Path
from typing import Any

import pytest

from fastpin import InputError, __version__
from fastpin.storage import store
from fastpin.studies import parse_plan, read_outcomes, read_plan, run_kinds, sweep, workers
from fastpin.studies.index import Index
from fastpin.studies.outcomes import OutcomeValue
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import RunEnd
from scripts.inline import Inline
from tests.support.outcomes import CYCLES, FILE, TABLE, deadly, last_work
from tests.support.plans import MOMENT

FUNCTIONS = """
[outcomes]
pressure = { function = "mine.py:largest_pressure" }
nothing = { function = "mine.py:nothing" }
broken = { function = "mine.py:broken" }
"""


@pytest.fixture(scope="module")
def bare() -> Plan:
    return parse_plan(CYCLES)


@pytest.fixture(scope="module")
def swept(bare: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished sweep without outcomes."""
    directory = tmp_path_factory.mktemp("swept") / "bare"
    sweep.run(bare, directory, Inline())
    return directory


@pytest.fixture
def copy(swept: Path, tmp_path: Path) -> Path:
    shutil.copytree(swept, tmp_path / "copy")
    return tmp_path / "copy"


def chosen(plan: Plan, directory: Path) -> list[dict[str, Any]]:
    return [{name: row[name] for name in plan.outcomes} for row in sweep.rows(plan, directory)]


@pytest.mark.gate
def test_outcomes_are_those_of_the_results(tmp_path: Path) -> None:
    plan = parse_plan(CYCLES + TABLE).with_outcomes({"work": last_work})
    summary = sweep.run(plan, tmp_path, workers=2)
    assert (summary.done, summary.read, summary.unread) == (2, 0, [])
    for row in sweep.rows(plan, tmp_path):
        result = store.load(tmp_path / "results" / f"{row['id']}.h5")
        assert row["shear"] == max(abs(state.peak_shear) for state in result)
        turns = [state.rotation for state in result if state.step >= 3]  # the first cycle ends at corner 3
        assert row["swing"] == max(turns) - min(turns)
        assert row["loss"] == result.cycles[-1].dissipation > 0.0
        assert row["work"] == result[-1].work
    assert sweep.load(tmp_path)[0]["loss"] == sweep.rows(plan, tmp_path)[0]["loss"]


def test_outcomes_that_are_added_later_are_read_and_nothing_is_solved(bare, copy, tmp_path, monkeypatch):
    plan = parse_plan(CYCLES + TABLE).with_outcomes({"work": last_work})
    sweep.run(plan, tmp_path / "at once", Inline())
    started = [row["started"] for row in sweep.load(copy)]
    assert chosen(plan, copy) == [dict.fromkeys(plan.outcomes)] * 2
    monkeypatch.setattr(run_kinds, "solve", None)
    calls: list[tuple[int, int]] = []
    summary = sweep.run(plan, copy, Inline(), progress=lambda *now: calls.append(now))
    assert (summary.ended, summary.read, summary.unread) == (0, 2, [])
    assert calls == [(0, 2), (1, 2), (2, 2)]
    assert chosen(plan, copy) == chosen(plan, tmp_path / "at once")
    assert [row["started"] for row in sweep.load(copy)] == started
    assert sweep.run(plan, copy, Inline()).read == 0
    assert sweep.run(bare, copy, Inline()).read == 0


def test_an_outcome_with_another_definition_is_read_again(copy: Path) -> None:
    first = parse_plan(CYCLES + TABLE)
    second = parse_plan(CYCLES + TABLE.replace('"largest magnitude"', '"smallest"'))
    sweep.run(first, copy, Inline())
    known = chosen(first, copy)
    assert [row["shear"] for row in chosen(second, copy)] == [None, None]  # the other value is not shown for it
    assert sweep.run(second, copy, Inline()).read == 2
    assert all(now["shear"] < 0.0 < old["shear"] for now, old in zip(chosen(second, copy), known, strict=True))
    assert [row["loss"] for row in chosen(second, copy)] == [row["loss"] for row in known]


@pytest.mark.gate
def test_a_function_that_fails_loses_no_run(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    (tmp_path / "mine.py").write_text(FILE)
    path.write_text(CYCLES + FUNCTIONS)
    plan = read_plan(path)
    summary = sweep.run(plan, tmp_path / "out", workers=1)
    assert (summary.done, summary.failed) == (2, [])
    reason = "ZeroDivisionError: division by zero (mine.py, line 20)"
    assert {(name, said) for _, name, said in summary.unread} == {("broken", reason)}
    assert sweep.status(plan, tmp_path / "out").unread == summary.unread
    for row in sweep.rows(plan, tmp_path / "out"):
        assert row["pressure"] == row["max_pressure"]
        assert (row["nothing"], row["broken"]) == (None, None)

    assert sweep.run(plan, tmp_path / "out", Inline()).read == 0
    assert sweep.run(plan, tmp_path / "out", Inline(), retry=True).read == 2
    (tmp_path / "mine.py").write_text(FILE.replace("1 / 0", "1 / 2"))
    mended = sweep.run(read_plan(path), tmp_path / "out", Inline())
    assert (mended.ended, mended.read, mended.unread) == (0, 2, [])
    assert [row["broken"] for row in sweep.rows(read_plan(path), tmp_path / "out")] == [0.5, 0.5]


@pytest.mark.gate
def test_a_function_that_kills_its_worker_loses_no_run(bare: Plan, tmp_path: Path) -> None:
    plan = bare.with_outcomes({"deadly": deadly})
    summary = sweep.run(plan, tmp_path, workers=1)
    assert (summary.done, summary.failed, summary.ended) == (2, [], 2)
    assert [(name, reason) for _, name, reason in summary.unread] == [("deadly", workers.DIED)] * 2


def test_a_function_that_can_not_be_sent_is_refused_before_the_runs(bare: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="outcomes: guess: can't be sent to workers, which import it by its name"):
        sweep.run(bare.with_outcomes({"guess": lambda result: 1.0}), tmp_path / "out", workers=1)
    assert not (tmp_path / "out").exists()


def test_a_failed_run_has_no_outcomes(tmp_path: Path) -> None:
    plan = parse_plan(MOMENT).with_outcomes({"shear": {"quantity": "peak_shear"}})
    summary = sweep.run(plan, tmp_path, Inline())
    assert (summary.done, len(summary.failed), summary.unread) == (4, 2, [])
    assert [row["shear"] is None for row in sweep.rows(plan, tmp_path)] == [False, True, True, False, False, False]


def test_a_result_that_can_not_be_read_is_the_reason(copy: Path) -> None:
    with Index(copy, write=True) as index:
        index._database.execute("UPDATE results SET content = substr(content, 1, 1000)")
    summary = sweep.run(parse_plan(CYCLES + TABLE), copy, Inline())
    assert len(summary.unread) == 6
    assert all(reason.startswith("the result can't be read: ") for _, _, reason in summary.unread)
    assert all(reason.endswith("is damaged: its checksum is wrong") for _, _, reason in summary.unread)


@pytest.mark.gate
def test_outcomes_are_read_from_files_too(tmp_path: Path) -> None:
    sweep.run(parse_plan(CYCLES), tmp_path, Inline(), files=True)
    assert sweep.run(parse_plan(CYCLES + TABLE), tmp_path, Inline()).read == 2
    for path in (tmp_path / "results").iterdir():
        path.write_bytes(path.read_bytes()[:1000])
    summary = sweep.run(parse_plan(CYCLES + TABLE.replace("largest magnitude", "smallest")), tmp_path, Inline())
    assert summary.unread
    assert all(reason.startswith("the result can't be read: ") for _, _, reason in summary.unread)


def test_a_worker_of_another_version_reads_nothing(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of_sweep = workers.Setting
    monkeypatch.setattr(workers, "Setting", lambda process, _, *more: of_sweep(process, "0.0", *more))
    summary = sweep.run(parse_plan(CYCLES + TABLE), copy, Inline())
    assert {reason for _, _, reason in summary.unread} == {f"the worker has fastpin {__version__}, the sweep 0.0"}


def test_parts_bring_their_outcomes(tmp_path: Path) -> None:
    plan = parse_plan(CYCLES + TABLE)
    for part in (1, 2):
        sweep.run(plan, tmp_path / f"part{part}", Inline(), shard=(part, 2))
    sweep.merge([tmp_path / "part1", tmp_path / "part2"], tmp_path / "whole")
    assert None not in [value for row in chosen(plan, tmp_path / "whole") for value in row.values()]
    assert sweep.run(plan, tmp_path / "whole", Inline()).read == 0


def test_an_index_without_the_table_of_outcomes_is_read(bare: Plan, copy: Path) -> None:
    with sqlite3.connect(copy / "index.sqlite") as database:
        database.execute("DROP TABLE outcomes")
    database.close()
    assert sweep.status(bare, copy).done == 2
    assert len(sweep.load(copy)) == 2
    assert sweep.run(parse_plan(CYCLES + TABLE), copy, Inline()).read == 2


def test_plain_sql_reads_outcomes(copy: Path) -> None:
    sweep.run(parse_plan(CYCLES + TABLE), copy, Inline())
    database = sqlite3.connect(copy / "index.sqlite")
    query = "SELECT \"contact.friction\", value FROM runs JOIN outcomes ON run = id WHERE name = 'loss' ORDER BY value"
    found = database.execute(query).fetchall()
    database.close()
    assert sorted(friction for friction, _ in found) == [0.3, 0.6]
    assert found[0][1] < found[1][1]


def test_a_damaged_value_is_described(copy: Path) -> None:
    with Index(copy, write=True) as index:
        run = index.rows()[0]["id"]
        index.record_outcomes([RunEnd(run, None, outcomes={"shear": OutcomeValue("x", 1.0)})])
        index._database.execute("UPDATE outcomes SET value = 'high'")
    with pytest.raises(InputError, match='is damaged: shear: must be a number, not "high"'):
        sweep.load(copy)


def test_a_run_that_fails_when_solved_again_shows_no_old_outcome(copy: Path) -> None:
    plan = parse_plan(CYCLES + TABLE)
    sweep.run(plan, copy, Inline())
    with Index(copy, write=True) as index:
        index.record([RunEnd(plan.points[0].id, "not enough memory")])
    assert [row["loss"] is None for row in sweep.rows(plan, copy)] == [True, False]


@pytest.mark.gate
def test_a_cluster_reads_outcomes(bare: Plan, tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    (tmp_path / "mine.py").write_text(FILE)
    plan = bare.with_outcomes(read_outcomes(tmp_path / "mine.py") | {"work": last_work})
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        summary = sweep.run(plan, tmp_path / "out", client.get_executor())
        later = plan.with_outcomes({"loss": {"cycle": "dissipation"}})
        assert sweep.run(later, tmp_path / "out", client.get_executor()).read == 2
    assert summary.done == 2
    assert {name for _, name, _ in summary.unread} == {"broken"}
    for row in sweep.rows(later, tmp_path / "out"):
        assert row["largest_pressure"] == row["max_pressure"]
        assert row["loss"] > 0.0
        assert row["work"] > 0.0
