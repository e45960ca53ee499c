"""The tries of a history: the order of their grids."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import fastpin
from fastpin import ConvergenceError, Grid, SolveError, SolveOptions, narrow
from fastpin.solver import ArcError, task
from fastpin.solver.task import Task, Unfit, follow_on_arcs, one_blas_thread

STEEL = fastpin.MATERIALS["steel"]
PROBLEM = fastpin.Problem.from_load_parameter(fastpin.MaterialPair(STEEL, STEEL), 0.1, 0.4)

ARCS = [Grid.arc(-2.0 - part, -1.0 + part, 61) for part in (0.0, 0.2)]
GRADED = [Grid.graded([(-1.57, 0.1)], nodes) for nodes in (80, 90)]
NAMES = {id(grid): name for grid, name in zip([*ARCS, *GRADED], ["arc", "wide", "graded", "fine"], strict=True)}


@pytest.fixture(autouse=True)
def _known_grids(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(task, "candidate_grids", lambda *_: iter(ARCS))
    monkeypatch.setattr(narrow, "narrow_grids", lambda *_: iter(GRADED))


def order(errors: dict[str, type[SolveError]], grid: Grid | None = None, unfit: Unfit | None = None, **options) -> str:
    """The tries where each one of `errors` ends in its error; in brackets if it is not strict."""
    tried = []

    def follow(grid: Grid, strict: bool) -> None:
        tried.append(NAMES[id(grid)] if strict else f"({NAMES[id(grid)]})")
        if tried[-1] in errors:
            raise errors[tried[-1]](tried[-1])

    try:
        Task(PROBLEM, [{"P": 1.0}], SolveOptions(**options), grid).follow_on_grids(follow, unfit=unfit)
    except SolveError as error:
        tried.append(f"error of {error}")
    return ", ".join(tried)


LOST = ConvergenceError
ALL_LOST = dict.fromkeys(("arc", "wide", "graded", "fine", "(arc)", "(wide)"), LOST)


def test_a_wider_arc_follows_a_contact_that_reaches_its_end() -> None:
    assert order({}) == "arc"
    assert order({"arc": ArcError}) == "arc, wide"
    assert order({"arc": ArcError, "wide": ArcError}) == "arc, wide, error of wide"


def test_graded_grids_follow_a_narrow_contact_and_then_arcs_where_it_is_let_go() -> None:
    assert order({"arc": LOST}) == "arc, graded"
    assert order({"arc": LOST, "graded": LOST}) == "arc, graded, fine"
    assert order({"arc": LOST, "graded": LOST, "fine": LOST}) == "arc, graded, fine, (arc)"
    assert order({**ALL_LOST, "(arc)": ArcError}) == "arc, graded, fine, (arc), (wide), error of (wide)"


def test_given_nodes_have_no_graded_grids() -> None:
    assert order({"wide": LOST}, grid=ARCS[1]) == "wide, (wide)"
    assert order({"wide": ArcError}, grid=ARCS[1]) == "wide, error of wide"


def test_the_increment_solver_is_not_tried_on_other_grids() -> None:
    assert order({"arc": LOST}, method="increment") == "arc, error of arc"


def test_tries_go_on_after_a_grid_that_was_unfit() -> None:
    assert order({}, unfit=Unfit(ARCS[0], ArcError("cut off"))) == "wide"
    assert order({}, unfit=Unfit(ARCS[0], LOST("narrow"))) == "graded"
    assert order({}, unfit=Unfit(GRADED[0], LOST("narrow"))) == "fine"
    assert order({}, unfit=Unfit(GRADED[1], LOST("narrow"))) == "(arc)"
    assert order({}, unfit=Unfit(ARCS[1], ArcError("cut off"))).startswith("error of the contact reaches an end")


def test_without_an_arc_the_contact_is_cut_off() -> None:
    with pytest.raises(ArcError, match="give a wider one"):
        follow_on_arcs([], lambda grid, strict: grid)


@pytest.mark.parametrize("threads", [1, 2])
def test_blas_has_one_thread_in_a_run_and_its_own_number_afterwards(threads: int) -> None:
    def numbers() -> set[int]:
        return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}

    with threadpool_limits(limits=threads, user_api="blas"):
        with one_blas_thread():
            assert numbers() == {1}
        assert numbers() == {threads}
