"""How well a sweep uses the processors: the same runs in a loop, in threads, with one worker, and with several.

    python bench/sweep.py                                  1,000 runs with 101 nodes, 2 threads, 1 and 2 workers
    python bench/sweep.py --runs 100 --nodes 201 --workers 4
    python bench/sweep.py --against ../before              a sweep here against a loop over ``solve`` of a checkout
    python bench/sweep.py --parts ../before                a run in parts, here and in a checkout, and its compiled loop
    python bench/sweep.py --dask                           the same on a dask cluster, one of whose workers is killed

Friction and clearance of the built-in case are varied. Efficiency is t(1) / (n t(n)). The time of a sweep includes the
start of its workers. "Without the start" counts from the end of the first run. All code is compiled before. A loop
solves every case, reads its key figures, and writes a file. Memory is the largest of this process, and of a worker.
Against a checkout the measurements take turns, and the medians count. The checkout needs its environment ``.venv``.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar
from unittest import mock

import numpy as np
from threadpoolctl import threadpool_limits

import fastpin
from fastpin.kernels import exchange
from fastpin.runtime.threads import in_one_thread
from fastpin.storage import store
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, parse_plan
from fastpin.studies.run_end import key_figures

try:
    from fastpin.kernels import held
except ImportError:  # earlier checkouts have no compiled steps
    held = exchange

HERE = Path(__file__).resolve().parents[1]
CHILDREN = resource.RUSAGE_CHILDREN

Measured = TypeVar("Measured")

PLAN = """
[grid]
"contact.friction" = {{ from = 0.1, to = 0.9, count = {rows} }}
"contact.clearance" = {{ from = 1e-6, to = 2e-4, count = {columns}, spacing = "log" }}
"solve.nodes" = [{nodes}]
"""


def plan_of(runs: int, nodes: int) -> Plan:
    """Return a plan of at least `runs` runs."""
    rows = max(2, math.isqrt(runs))
    return parse_plan(PLAN.format(rows=rows, columns=max(2, math.ceil(runs / rows)), nodes=nodes))


def loop(plan: Plan) -> float:
    """Return the seconds of all runs one after the other, in this process, on one thread, with readings and files."""
    with tempfile.TemporaryDirectory() as directory, threadpool_limits(limits=1), in_one_thread():
        began = time.perf_counter()
        for run, point in plan.runs.items():
            case = plan.case(point)
            result = fastpin.solve(case.problem, case.history, **case.options.keywords())
            key_figures(result)
            store.save(result, Path(directory) / f"{run}.h5", restart=False)
        return time.perf_counter() - began


def parts(plan: Plan) -> dict[str, float]:
    """Return the processor time of the parts of a run, ms: those of every run of a sweep, in this process.

    The compiled loop is the part of "solve" inside the kernels that follow the load, coarse runs included.
    """
    times = dict.fromkeys(("plan", "case", "solve", "key figures", "store"), 0.0)
    loops = 0.0

    def looped(kernel: Callable[..., Any]) -> Callable[..., Any]:
        def follow(*arguments: Any) -> Any:
            nonlocal loops
            began = time.process_time()
            found = kernel(*arguments)
            loops += 1e3 * (time.process_time() - began) / len(plan.runs)
            return found

        return follow

    def timed(name: str, work: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
        began = time.process_time()
        found = work(*arguments, **keywords)
        times[name] += 1e3 * (time.process_time() - began) / len(plan.runs)
        return found

    pack = getattr(store, "pack", None)  # earlier checkouts have files only
    with (
        tempfile.TemporaryDirectory() as directory,
        threadpool_limits(limits=1),
        in_one_thread(),
        mock.patch.object(exchange, "follow", looped(exchange.follow)),
        mock.patch.object(held, "step", looped(getattr(held, "step", exchange.follow)), create=True),
    ):
        timed("plan", parse_plan, plan.text)
        for run, point in plan.runs.items():
            case = timed("case", plan.case, point)
            result = timed("solve", fastpin.solve, case.problem, case.history, **case.options.keywords())
            timed("key figures", key_figures, result)
            if pack is None:
                timed("store", store.save, result, Path(directory) / f"{run}.h5", restart=False)
            else:
                timed("store", pack, result, None, 10**6)
    whole = sum(times.values())
    return times | {"all": whole, "compiled loop": loops, "all / loop": whole / loops}


def elsewhere(checkout: Path, what: str, options: argparse.Namespace) -> Any:
    """Return what a measurement gives in the environment of a checkout."""
    command = [checkout / ".venv/bin/python", __file__, "--only", what]
    sizes = ["--runs", str(options.runs), "--nodes", str(options.nodes), "--workers", str(options.workers[0])]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run([*command, *sizes], cwd=checkout, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"the measurement of {checkout} failed:\n{done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def only(what: str, plan: Plan, workers: int) -> Any:
    """Return one measurement, for :func:`elsewhere`. The code is compiled before."""
    first = plan_of(1, int(plan.points[0].values["solve.nodes"]))
    loop(first)
    if what == "sweep":
        swept(first, 1)
    began = _processor_time()
    if what == "parts":
        return parts(plan)
    seconds = swept(plan, workers)[0] if what == "sweep" else loop(plan)
    return seconds, _processor_time() - began


def _processor_time() -> float:
    """Processor time of this process and its ended children, s."""
    return sum(each.ru_utime + each.ru_stime for each in map(resource.getrusage, (resource.RUSAGE_SELF, CHILDREN)))


def against(options: argparse.Namespace) -> None:
    """Compare a sweep here with a loop over ``solve`` in another checkout."""
    ratios = []
    for _ in range(options.rounds):
        there, here = elsewhere(options.against, "loop", options), elsewhere(HERE, "sweep", options)
        ratios.append([mine / theirs for mine, theirs in zip(here, there, strict=True)])
        print(
            f"sweep with {options.workers[0]} workers {here[0]:8.2f} s, loop there {there[0]:8.2f} s: "
            f"{ratios[-1][0]:.3f}; processor time {here[1]:8.2f} s and {there[1]:8.2f} s: {ratios[-1][1]:.3f}"
        )
    wall, processor = (statistics.median(column) for column in zip(*ratios, strict=True))
    print(f"medians of the ratios: {wall:.3f}, of processor time {processor:.3f}")


def compared_parts(options: argparse.Namespace) -> None:
    """Compare the parts of a run here and in another checkout."""
    pairs = [[elsewhere(path, "parts", options) for path in (options.parts, HERE)] for _ in range(options.rounds)]
    print(f"{'ms of one run':16}{'there':>10}{'here':>10}{'ratio':>8}")
    for name in pairs[0][0]:
        there, here = (statistics.median(pair[side][name] for pair in pairs) for side in (0, 1))
        print(f"{name:16}{there:10.2f}{here:10.2f}{here / there:8.3f}")


def swept(plan: Plan, workers: int, executor: Executor | None = None) -> tuple[float, float]:
    """Return the seconds of a sweep, and its seconds without the start of the workers.

    The latter count from the end of the first run, and are scaled to the number of all runs.
    """
    ends: list[float] = []
    with tempfile.TemporaryDirectory() as directory:
        began = time.perf_counter()
        summary = sweep.run(plan, directory, executor, workers, progress=lambda *_: ends.append(time.perf_counter()))
        seconds = time.perf_counter() - began
    if summary.done != len(plan.runs):
        raise SystemExit(f"{len(summary.failed)} runs failed, the first: {summary.failed[0]}")
    count = len(plan.runs)
    return seconds, (ends[-1] - ends[1]) * count / (count - 1)


def on_a_cluster(plan: Plan) -> None:
    """Compare a dask cluster with workers of our own. One of its two workers is killed after a fifth of the runs."""
    from distributed import Client, LocalCluster

    with tempfile.TemporaryDirectory() as folder:
        theirs, ours = Path(folder) / "theirs", Path(folder) / "ours"
        with (
            LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            victim = next(iter(client.run(os.getpid).values()))

            def progress(ended: int, total: int) -> None:
                if ended == max(total // 5, 1):
                    os.kill(victim, signal.SIGKILL)

            began = time.perf_counter()
            summary = sweep.run(plan, theirs, client.get_executor(), progress=progress)
            seconds = time.perf_counter() - began
        sweep.run(plan, ours, workers=2)
        different = 0
        for run in plan.runs:
            pairs = zip(*(store.load(folder / "results" / f"{run}.h5") for folder in (theirs, ours)), strict=True)
            different += not all(np.array_equal(one.shear, other.shear) for one, other in pairs)
    print(
        f"dask, a worker killed  {seconds:8.2f} s; {summary.done} done, {len(summary.failed)} failed, {different} with "
        "other bits than by workers of our own"
    )


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--nodes", type=int, default=101)
    parser.add_argument("--workers", type=int, nargs="+", default=[2])
    parser.add_argument("--rounds", type=int, default=3, help="turns against a checkout")
    parser.add_argument("--against", type=Path, metavar="CHECKOUT", help="compare with a loop over solve there")
    parser.add_argument("--parts", type=Path, metavar="CHECKOUT", help="compare the parts of a run with those there")
    parser.add_argument("--only", choices=["loop", "sweep", "parts"], help=argparse.SUPPRESS)
    parser.add_argument("--dask", action="store_true", help="only see whether a cluster gives the same")
    options = parser.parse_args()
    plan = plan_of(options.runs, options.nodes)
    if options.only:
        print(json.dumps(only(options.only, plan, options.workers[0])))
        return
    if options.dask:
        on_a_cluster(plan)
        return
    if options.against or options.parts:
        (against if options.against else compared_parts)(options)
        return
    loop(plan_of(1, options.nodes))
    count = len(plan.runs)
    serial, processor = measured(lambda: loop(plan))
    print(f"{count} runs, {options.nodes} nodes; wall and processor time, ms a run; runs a second")
    show("loop in this process", serial, processor, count)
    for threads in options.workers:
        with ThreadPoolExecutor(threads) as pool:
            (seconds, _), processor = measured(lambda: swept(plan, threads, pool))  # noqa: B023  called at once
        show(f"{threads} threads", seconds, processor, count, f"{serial / seconds:.2f} times the loop")
    (one, steady_one), processor = measured(lambda: swept(plan, 1))
    show("1 worker", one, processor, count, f"{steady_one:.2f} s without the start")
    for workers in options.workers:
        (many, steady), processor = measured(lambda: swept(plan, workers))  # noqa: B023  called at once
        efficiency = f"efficiency {one / (workers * many):.3f}, {steady_one / (workers * steady):.3f} without the start"
        show(f"{workers} workers", many, processor, count, f"{efficiency}; {serial / many:.2f} times the loop")
    megabytes = (resource.getrusage(who).ru_maxrss // 1024 for who in (resource.RUSAGE_SELF, CHILDREN))
    print("memory: {} MB here, {} MB a worker at most".format(*megabytes))


def measured(work: Callable[[], Measured]) -> tuple[Measured, float]:
    """Return what `work` returns, and its processor time, s, with that of its ended children."""
    began = _processor_time()
    return work(), _processor_time() - began


def show(name: str, seconds: float, processor: float, runs: int, more: str = "") -> None:
    """Print a row."""
    print(
        f"{name:22}{seconds:9.2f} s {1e3 * seconds / runs:8.2f} ms {1e3 * processor / runs:8.2f} ms "
        f"{runs / seconds:8.1f} /s  {more}"
    )


if __name__ == "__main__":
    main()
