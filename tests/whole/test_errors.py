"""Every error of the package survives pickle and copies, so that it can leave a worker process."""

import copy
import importlib
import multiprocessing
import pickle
import pkgutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

import pytest

import fastpin
from fastpin.errors import CaseFileError, FastpinError, FieldMessage, InputError
from fastpin.solver.errors import Interrupted, NoEquilibriumError, SolveError
from fastpin.solver.path import StepLostError
from fastpin.studies.convergence import StudyInterrupted, StudyLostError
from fastpin.studies.workers import BrokenError, WorkerDiedError
from tests.support.faults import faults_of
from tests.support.samples import sample_result

COPIES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle 2": lambda error: pickle.loads(pickle.dumps(error, 2)),
    "pickle": lambda error: pickle.loads(pickle.dumps(error)),
}


def subclasses(base: type) -> Iterator[type]:
    for each in base.__subclasses__():
        yield each
        yield from subclasses(each)


def error_classes() -> list[type[BaseException]]:
    """All exceptions that the modules of the package define, found by importing every module."""
    for module in pkgutil.walk_packages(fastpin.__path__, "fastpin."):
        if module.name != "fastpin.__main__":
            importlib.import_module(module.name)
    found = {each for each in subclasses(BaseException) if each.__module__.startswith("fastpin.")}
    return sorted(found, key=lambda each: each.__name__)


def example(kind: type[BaseException]) -> BaseException:
    """An error of a class with all its attributes."""
    if issubclass(kind, CaseFileError):
        return kind("case.toml", [(3, "one"), (1, "two")])
    if issubclass(kind, FieldMessage):
        return kind("nodes", "must be more")
    if issubclass(kind, SolveError):
        error = kind("lost", 2, 0.5, {"P": 1.0}, sample_result(complete=False))
        error.args = ("step 3, at 50 %: lost",)  # as Run adds the place
        return error
    if issubclass(kind, Interrupted):
        return kind(sample_result(complete=False))
    if issubclass(kind, (StudyInterrupted, BrokenError)):
        return kind(["tasks"])
    if issubclass(kind, StepLostError):
        return kind(2, 0.5)
    return kind("something went wrong")


@pytest.mark.parametrize("kind", error_classes(), ids=lambda kind: kind.__name__)
def test_an_error_survives(kind):
    error = example(kind)
    for way, copied in COPIES.items():
        again = copied(error)
        assert type(again) is kind, way
        assert (str(again), again.args, set(vars(again))) == (str(error), error.args, set(vars(error))), way
        for name, value in vars(error).items():
            if name == "result":
                assert len(again.result) == len(value), way
                assert again.result[0].pressure.tolist() == value[0].pressure.tolist(), way
            else:
                assert getattr(again, name) == value, way


def test_all_classes_are_found():
    found = error_classes()
    assert {FastpinError, InputError, CaseFileError, SolveError, NoEquilibriumError, Interrupted} <= set(found)
    assert {StudyLostError, StudyInterrupted, WorkerDiedError, BrokenError} <= set(found)


def test_an_error_of_a_real_run_keeps_its_result(similar):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.1)
    with pytest.raises(NoEquilibriumError) as raised:
        fastpin.solve(problem, [{"P": 1.0}, {"M": 5.0}], nodes=41)
    again = pickle.loads(pickle.dumps(raised.value))
    assert len(again.result) == 1
    assert (again.step, again.fraction, again.load) == (1, raised.value.fraction, raised.value.load)


@pytest.mark.gate
def test_an_error_leaves_a_worker_process():
    text = "[pin]\n"
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        with pytest.raises(InputError, match="E: Young's modulus must be positive"):
            executor.submit(fastpin.Material, -1.0, 0.3).result()
        with pytest.raises(CaseFileError) as raised:
            executor.submit(fastpin.casefile.parse_case, text).result()
    assert raised.value.problems == faults_of(fastpin.casefile.parse_case, text)
