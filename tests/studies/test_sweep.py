"""Sweeps: what is run, kept, skipped, tried again, split and merged."""

import shutil
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed.scheduler import KilledWorker

import fastpin
from fastpin.errors import FastpinError, InputError, OutputError
from fastpin.kernels.status import OPEN
from fastpin.model.angles import interval_from_bottom
from fastpin.runtime.threads import works_alone
from fastpin.storage import store
from fastpin.storage.packed import INDEX
from fastpin.studies import run_end, run_kinds, sweep, workers
from fastpin.studies.identity import id_of_json
from fastpin.studies.index import lock_directory
from fastpin.studies.plan import Plan, parse_plan
from fastpin.studies.run_end import KEY_FIGURES, key_figures
from fastpin.studies.sweep import Summary
from scripts.inline import Inline
from tests.support.plans import FRICTION, MOMENT
from tests.support.samples import sample_result, with_values
from tests.support.tiers import for_gate


@pytest.fixture(scope="module")
def plan() -> Plan:
    return parse_plan(MOMENT)


@pytest.fixture(scope="module")
@for_gate
def calls() -> list[tuple[int, int]]:
    return []


@pytest.fixture(scope="module")
def swept(plan: Plan, calls: list[tuple[int, int]], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Summary]:
    """A sweep with two worker processes, and its summary."""
    directory = tmp_path_factory.mktemp("swept") / "new"
    return directory, sweep.run(plan, directory, workers=2, progress=lambda *now: calls.append(now))


@pytest.fixture
def copy(swept: tuple[Path, Summary], tmp_path: Path) -> Path:
    """A copy of the directory of that sweep."""
    shutil.copytree(swept[0], tmp_path / "copy")
    return tmp_path / "copy"


def contents(directory: Path) -> dict[str, bytes | None]:
    """The results in the index, by run."""
    with sweep.Index(directory) as index:
        return {run: index.content(run) for run in index.packed()}


def comparable(directory: Path) -> dict[str, dict[str, Any]]:
    """What two sweeps of one plan have in common."""
    unlike = ("seconds", "started", "host")
    return {row["id"]: {k: v for k, v in row.items() if k not in unlike} for row in sweep.load(directory)}


def test_what_is_done_has_the_bits_of_a_serial_solution(plan: Plan, swept: tuple[Path, Summary]) -> None:
    directory, summary = swept
    assert (summary.total, summary.done, summary.waiting, summary.ended) == (6, 4, 0, 6)
    assert summary.seconds > 0.0
    for run, point in plan.runs.items():
        case = plan.case(point)
        alone: fastpin.Result | None
        try:
            alone = fastpin.solve(case.problem, case.history, **case.options.keywords())
        except fastpin.NoEquilibriumError as error:
            alone = error.result
        stored = store.load(directory / "results" / f"{run}.h5")
        assert alone.complete == stored.complete
        assert len(alone) == len(stored) > 0
        for expected, state in zip(alone, stored, strict=True):
            assert np.array_equal(expected.pressure, state.pressure)
            assert np.array_equal(expected.shear, state.shear)


def test_failures_have_their_reason(plan: Plan, swept: tuple[Path, Summary]) -> None:
    directory, summary = swept
    assert [point.values["contact.friction"] for point, _ in summary.failed] == [0.1, 0.1]
    assert [point.values["load.2.M"] for point, _ in summary.failed] == [3000.0, 9000.0]
    for point, reason in summary.failed:
        assert reason.startswith("step 2, at ")
        assert "nothing holds the pin any more" in reason
        (row,) = (row for row in sweep.load(directory) if row["id"] == point.id)
        assert (row["status"], row["reason"], row["states"]) == ("failed", reason, 1)
        assert row["peak_pressure"] is None


def test_progress_counts_from_nothing_to_all(swept: tuple[Path, Summary], calls: list[tuple[int, int]]) -> None:
    assert calls == [(k, 6) for k in range(7)]


def test_key_figures_are_those_of_the_result(plan: Plan, swept: tuple[Path, Summary]) -> None:
    rows = {row["id"]: row for row in sweep.load(swept[0])}
    run = plan.points[3].id
    result = store.load(swept[0] / "results" / f"{run}.h5")
    row, last = rows[run], result[-1]
    assert {name: row[name] for name in KEY_FIGURES} == key_figures(result)
    assert row["peak_pressure"] == last.peak_pressure
    assert (row["contact_start"], row["contact_stop"]) == interval_from_bottom(*last.contact[0])
    assert row["contact_width"] == pytest.approx(np.degrees(last.contact[0][1] - last.contact[0][0]))
    assert row["stick_width"] == pytest.approx(sum(np.degrees(stop - start) for start, stop in last.stick))
    assert row["max_pressure"] == max(state.peak_pressure for state in result)
    assert row["max_shear"] == max(abs(state.peak_shear) for state in result)
    assert row["residual"] == max(max(state.residuals.values()) for state in result)
    assert (row["states"], row["nodes"], row["dissipation"]) == (len(result), 41, last.dissipation)
    assert row["versions"]["fastpin"] == fastpin.__version__
    assert row["started"].endswith("+00:00")
    assert row["seconds"] > 0.0


def test_key_figures_without_contact() -> None:
    result = sample_result()
    opened = replace(result, states=[with_values(result[0], pressure=0.0, shear=0.0, status=OPEN)])
    figures = key_figures(opened)
    assert figures["contact_start"] is None
    assert figures["peak_pressure_angle"] is None
    assert (figures["contact_width"], figures["peak_pressure"]) == (0.0, 0.0)


# -- going on --------------------------------------------------------------------------------------------------


def test_runs_that_share_matrices_follow_one_another() -> None:
    text = """
    [grid]
    "contact.friction" = [0.1, 0.2, 0.3]
    "contact.clearance" = [1e-5, 2e-5]
    """
    plan = parse_plan(text)
    values = [plan.runs[run].values for run in workers.neighbours(plan, plan.runs)]
    assert [(each["contact.clearance"], each["contact.friction"]) for each in values] == [
        (gap, friction) for gap in (1e-5, 2e-5) for friction in (0.1, 0.2, 0.3)
    ]
    last = list(plan.runs)[2:]
    assert sorted(workers.neighbours(plan, last)) == sorted(last)


def test_what_is_finished_is_skipped(plan: Plan, copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = contents(copy)
    assert set(before) == set(plan.runs)
    monkeypatch.setattr(run_kinds, "solve", None)  # not needed
    summary = sweep.run(plan, copy, Inline())
    assert (summary.done, len(summary.failed), summary.ended) == (4, 2, 0)
    assert contents(copy) == before


def test_only_failures_are_retried(plan: Plan, copy: Path) -> None:
    started = {row["id"]: row["started"] for row in sweep.load(copy)}
    summary = sweep.run(plan, copy, Inline(), retry=True)
    assert (summary.done, len(summary.failed), summary.ended) == (4, 2, 2)
    again = {row["id"] for row in sweep.load(copy) if row["started"] != started[row["id"]]}
    assert again == {point.id for point, _ in summary.failed}


def test_a_result_that_is_gone_is_computed_again(plan: Plan, copy: Path) -> None:
    before = contents(copy)
    run = plan.points[4].id
    with sweep.Index(copy, write=True) as index:
        index._database.execute("DELETE FROM results WHERE run = ?", [run])
    assert sweep.status(plan, copy).waiting == 1
    assert sweep.run(plan, copy, Inline()).ended == 1
    assert set(contents(copy)) == set(before)
    path = copy / "results" / f"{run}.h5"
    path.write_text("x\n")  # another file stands before the result, and is none
    (copy / "results" / f".{run}.1.h5").symlink_to("nowhere")  # what is being written does not count
    assert sweep.status(plan, copy).waiting == 1
    assert sweep.run(plan, copy, Inline()).ended == 1
    assert not path.exists()
    assert len(store.load(path)) > 0


def test_a_plan_that_has_grown_runs_what_is_new(plan: Plan, copy: Path) -> None:
    grown = parse_plan(MOMENT.replace("[0.1, 0.4]", "[0.4, 0.5]"))
    assert sweep.status(grown, copy) == Summary(3, 3, [])
    summary = sweep.run(grown, copy, Inline())
    assert (summary.done, summary.failed, summary.ended) == (6, [], 3)
    assert len(sweep.load(copy)) == 9
    assert (copy / "plan.toml").read_text() == grown.text


def test_another_version_runs_everything_again(plan: Plan, copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(id_of_json, "__defaults__", ("99",))
    later = parse_plan(MOMENT)
    assert not set(later.runs) & set(plan.runs)
    assert sweep.status(later, copy) == Summary(0, 6, [])


def test_half_written_results_are_cleared_away(plan: Plan, copy: Path) -> None:
    rest, foreign = copy / "results" / f".{plan.points[0].id}.0123456789abcdef.h5", copy / "results" / ".notes.h5"
    rest.touch()
    foreign.touch()
    sweep.run(plan, copy, Inline())
    assert (rest.exists(), foreign.exists()) == (False, True)


def test_rows_of_a_plan_are_its_points(plan: Plan, copy: Path, tmp_path: Path) -> None:
    rows = sweep.rows(plan, copy)
    assert [row["id"] for row in rows] == [point.id for point in plan.points]
    assert rows[0]["status"] == "done"
    unknown = sweep.rows(plan, tmp_path)
    assert {row["status"] for row in unknown} == {"waiting"}
    assert unknown[1]["load.2.M"] == plan.points[1].values["load.2.M"]


# -- results in files ------------------------------------------------------------------------------------------


def same_states(one: fastpin.Result, other: fastpin.Result) -> bool:
    pairs = list(zip(one, other, strict=True))
    return all(np.array_equal(a.pressure, b.pressure) and np.array_equal(a.shear, b.shear) for a, b in pairs)


def stems(directory: Path) -> set[str]:
    return {path.stem for path in (directory / "results").iterdir()}


def test_results_get_files_when_asked_for(plan: Plan, copy: Path, tmp_path: Path) -> None:
    """Those of finished runs are written from the index; a run that is solved now has a file only."""
    done = {row["id"] for row in sweep.load(copy) if row["status"] == "done"}
    packed = {run: store.load(copy / "results" / f"{run}.h5") for run in plan.runs}
    assert stems(copy) == set()
    assert sweep.run(plan, copy, Inline(), files=True).ended == 0
    assert stems(copy) == done
    assert contents(copy).keys() == plan.runs.keys()
    sweep.run(plan, tmp_path / "new", Inline(), files=True)
    assert (stems(tmp_path / "new"), contents(tmp_path / "new")) == (set(plan.runs), {})
    for run in done:
        for directory in (copy, tmp_path / "new"):
            assert same_states(store.load(directory / "results" / f"{run}.h5"), packed[run])


@pytest.mark.gate
def test_a_sweep_of_files_without_results_in_its_index_goes_on(plan: Plan, tmp_path: Path) -> None:
    """As earlier versions have written it."""
    sweep.run(plan, tmp_path, Inline(), files=True)
    (tmp_path / "results" / f"{plan.points[0].id}.h5").unlink()
    with sweep.Index(tmp_path, write=True) as index:
        index._database.execute("DROP TABLE results")
    assert sweep.status(plan, tmp_path) == Summary(3, 1, sweep.status(plan, tmp_path).failed)
    assert sweep.run(plan, tmp_path, Inline()).ended == 1
    assert set(contents(tmp_path)) == {plan.points[0].id}
    assert len(stems(tmp_path)) == 5
    assert sweep.merge([tmp_path], tmp_path / "whole") == 6
    assert (stems(tmp_path / "whole"), contents(tmp_path / "whole")) == (stems(tmp_path), contents(tmp_path))


@pytest.mark.gate
def test_a_large_result_has_a_file(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "MOST_PACKED", 8000)
    sweep.run(plan, tmp_path, Inline())
    small = {run for run in plan.runs if len(store.load(tmp_path / "results" / f"{run}.h5")) == 1}
    assert 0 < len(small) < 6
    assert (set(contents(tmp_path)), stems(tmp_path)) == (small, set(plan.runs) - small)


def test_a_full_disk_ends_a_sweep_and_keeps_what_is_finished(plan: Plan, tmp_path: Path) -> None:
    class Small(sweep.Index):
        """An index that has room for some results."""

        def expect(self, *arguments: Any) -> None:
            super().expect(*arguments)
            self._database.execute(f"PRAGMA max_page_count = {self._one('PRAGMA page_count') + 10}")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "Index", Small)
        with pytest.raises(OutputError, match=r"index.sqlite: can't be written: database or disk is full"):
            sweep.run(plan, tmp_path, Inline())
    finished = set(contents(tmp_path))
    assert 0 < len(finished) < 6
    assert sweep.run(plan, tmp_path, Inline()).ended == 6 - len(finished)


# -- batches -----------------------------------------------------------------------------------------------------


def test_batches_take_as_long_as_a_message_is_worth() -> None:
    pace = workers.Pace(2)
    assert pace.size(1000) == 1  # nothing is known
    pace.learn([run_end.RunEnd("a", None, seconds=0.01), run_end.RunEnd("b", "lost", seconds=0.03)])
    assert pace.size(1000) == 12  # 0.25 s of 20 ms each
    assert (pace.size(40), pace.size(3)) == (5, 1)  # fewer towards the end
    pace.learn([run_end.RunEnd("c", None, seconds=9.0)])
    assert pace.size(1000) == 1
    quick = workers.Pace(1)
    quick.learn([run_end.RunEnd("d", "it could not begin")])
    assert quick.size(1000) == workers.MOST_IN_BATCH


# -- executors -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("executor", [Inline, lambda: ThreadPoolExecutor(2)], ids=["inline", "threads"])
def test_any_executor_gives_the_same(executor, plan, swept, tmp_path):
    with executor() as working:
        sweep.run(plan, tmp_path, working)
    assert comparable(tmp_path) == comparable(swept[0])


def test_a_run_makes_its_products_in_one_thread(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    solve, seen = run_kinds.solve, []

    def watched(*arguments: Any, **options: Any) -> Any:
        seen.append(works_alone())
        return solve(*arguments, **options)

    monkeypatch.setattr(run_kinds, "solve", watched)
    sweep.run(plan, tmp_path, Inline())
    assert seen == [True] * 6
    assert not works_alone()


def test_whatever_goes_wrong_in_a_run_is_its_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    errors = iter([MemoryError(), ZeroDivisionError("by nothing")])
    solve = run_kinds.solve

    def failing(*arguments: Any, **options: Any) -> Any:
        for error in errors:
            raise error
        return solve(*arguments, **options)

    monkeypatch.setattr(run_kinds, "solve", failing)
    summary = sweep.run(parse_plan(FRICTION.replace("COUNT", "3")), tmp_path, Inline())
    assert [reason for _, reason in summary.failed] == ["not enough memory", "ZeroDivisionError: by nothing"]
    assert summary.done == 1


def test_a_full_disk_is_a_failure_without_figures(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "save", full)
    summary = sweep.run(plan, tmp_path, Inline(), files=True)
    assert summary.failed[0][1] == "OSError: [Errno 28] No space left on device"
    assert {row["peak_pressure"] for row in sweep.load(tmp_path)} == {None}


def test_a_worker_of_another_version_is_refused(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of_sweep = workers.Setting
    monkeypatch.setattr(workers, "Setting", lambda process, _, *more: of_sweep(process, "0.0", *more))
    summary = sweep.run(plan, tmp_path, Inline())
    assert summary.failed[0][1] == f"the worker has fastpin {fastpin.__version__}, the sweep 0.0"


def test_a_result_that_does_not_arrive_is_a_failure(plan, tmp_path, monkeypatch):
    monkeypatch.setattr(store, "save", lambda *_, **__: None)  # as if to a disk of another machine
    summary = sweep.run(plan, tmp_path, Inline(), files=True)
    assert summary.done == 0
    assert "the result did not arrive" in summary.failed[0][1]


class Breaks(Inline):
    """An executor whose fourth task breaks it."""

    def __init__(self, error: Exception, on_submit: bool) -> None:
        self.error = error
        self.on_submit = on_submit
        self.left = 3

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        self.left -= 1
        if self.left >= 0:
            return super().submit(function, *arguments, **keywords)
        if self.on_submit:
            raise self.error
        future: Future[Any] = Future()
        future.set_exception(self.error)
        return future


@pytest.mark.parametrize("on_submit", [True, False])
def test_an_executor_that_breaks_loses_nothing(plan: Plan, tmp_path: Path, on_submit: bool) -> None:
    with pytest.raises(FastpinError, match="the executor has stopped working; runs that are finished are kept"):
        sweep.run(plan, tmp_path, Breaks(BrokenProcessPool("gone"), on_submit))
    assert sweep.status(plan, tmp_path).waiting in (3, 6)
    assert sweep.run(plan, tmp_path, Inline()).total == 6


def test_a_worker_that_a_cluster_gives_up_is_a_failure(plan: Plan, tmp_path: Path) -> None:
    summary = sweep.run(plan, tmp_path, Breaks(KilledWorker("run", None, 3), on_submit=False))
    assert sum(reason.startswith("the worker process died") for _, reason in summary.failed) == 3


# -- arguments and directories ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"workers": 0}, "workers: must be a whole number of at least 1"),
        ({"shard": (0, 2)}, "shard"),
        ({"shard": (3, 2)}, "shard: must be i/n with i from 1 to n, not 3/2"),
    ],
)
def test_arguments_out_of_range(plan: Plan, arguments: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        sweep.run(plan, tmp_path / "new", Inline(), **arguments)
    assert not (tmp_path / "new").exists()


def test_two_sweeps_in_one_directory_are_refused(plan: Plan, tmp_path: Path) -> None:
    with lock_directory(tmp_path), pytest.raises(InputError, match="another sweep is running in this directory"):
        sweep.run(plan, tmp_path, Inline())


def test_a_plan_of_the_user_s_is_not_overwritten(plan: Plan, tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text("mine")
    with pytest.raises(InputError, match=r"holds another plan.toml, but no sweep"):
        sweep.run(plan, tmp_path, Inline())
    assert (tmp_path / "plan.toml").read_text() == "mine"
    assert not (tmp_path / INDEX).exists()


def test_merging_does_not_overwrite_a_plan_either(copy: Path, tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text("mine")
    with pytest.raises(InputError, match=r"holds another plan.toml, but no sweep"):
        sweep.merge([copy], tmp_path)
    assert (tmp_path / "plan.toml").read_text() == "mine"


def test_a_directory_that_can_not_be_made(plan: Plan, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="can't be made"):
        sweep.run(plan, tmp_path / "file" / "below", Inline())


# -- parts -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def parts(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The plan run in three parts."""
    directories = [tmp_path_factory.mktemp(f"part{part}") for part in (1, 2, 3)]
    for part, directory in enumerate(directories, start=1):
        assert sweep.run(plan, directory, Inline(), shard=(part, 3)).total == 2
    return directories


def test_parts_make_the_whole(plan: Plan, parts: list[Path], swept: tuple[Path, Summary], tmp_path: Path) -> None:
    assert sweep.merge(parts[:2], tmp_path) == 4
    assert sweep.merge(parts[1:], tmp_path) == 6
    assert comparable(tmp_path) == comparable(swept[0])
    assert set(contents(tmp_path)) == set(contents(swept[0]))
    summary = sweep.run(plan, tmp_path, Inline())
    assert (summary.done, summary.ended) == (4, 0)


def test_the_order_of_the_points_does_not_matter_to_parts(plan: Plan) -> None:
    turned = parse_plan(MOMENT.replace("[0.1, 0.4]", "[0.4, 0.1]"))
    for part in (1, 2, 3):
        assert set(sweep.shard_of(turned, (part, 3))) == set(sweep.shard_of(plan, (part, 3)))


def test_done_wins_over_failed_and_failed_over_waiting(plan: Plan, copy: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(copy, other)
    with sweep.Index(other, write=True) as index:
        index.record([run_end.RunEnd(plan.points[0].id, "lost")])
        index._database.execute("UPDATE runs SET status = 'waiting' WHERE id = ?", [plan.points[1].id])
    for name, order in (("a", (copy, other)), ("b", (other, copy))):
        sweep.merge(order, tmp_path / name)
        assert comparable(tmp_path / name) == comparable(copy)


def test_results_that_disagree_are_refused(plan: Plan, copy: Path, swept: tuple[Path, Summary], tmp_path: Path) -> None:
    run = plan.points[0].id
    with sweep.Index(copy, write=True) as index:
        index._database.execute("UPDATE runs SET peak_pressure = 1.01 * peak_pressure WHERE id = ?", [run])
    with pytest.raises(InputError, match=f"run {run} has peak_pressure = "):
        sweep.merge([swept[0], copy], tmp_path / "whole")


@pytest.mark.parametrize(
    ("name", "words"), [("plan", "belongs to another plan"), ("version", "was made by another version of fastpin")]
)
def test_other_plans_and_versions_are_not_merged(name, words, copy, swept, tmp_path):
    with sweep.Index(copy, write=True) as index:
        index._write_notes(**{name: "another"})
    with pytest.raises(InputError, match=words):
        sweep.merge([swept[0], copy], tmp_path / "whole")


def test_a_merge_and_a_part_that_were_killed_at_their_beginning_do_no_harm(
    swept: tuple[Path, Summary], tmp_path: Path
) -> None:
    for name in ("whole", "part"):
        (tmp_path / name).mkdir()
        with sweep.Index(tmp_path / name, write=True):
            pass
    assert sweep.merge([tmp_path / "part", swept[0], tmp_path / "part"], tmp_path / "whole") == len(
        sweep.load(swept[0])
    )
    assert sweep.load(tmp_path / "whole") == sweep.load(swept[0])
    assert (tmp_path / "whole" / "plan.toml").read_text() == (swept[0] / "plan.toml").read_text()


def test_merging_needs_sweeps(copy: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no sweep"):
        sweep.merge([tmp_path], tmp_path / "whole")
    with pytest.raises(InputError, match="can't be merged into itself"):
        sweep.merge([copy], copy)
