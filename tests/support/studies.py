"""A small convergence study, for tests of studies, of their tables and of the command."""

from fastpin import MaterialPair, Problem, converge
from fastpin.studies.convergence import Convergence

CORNERS: list[dict[str, float]] = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}]
GRIDS = (51, 101, 201)


def small_problem(pair: MaterialPair) -> Problem:
    """The problem of the study."""
    return Problem.from_load_parameter(pair, 0.5, 0.5, "centre")


def small_study(problem: Problem) -> Convergence:
    """Three corners on three grids, and with three numbers of increments."""
    return converge(problem, CORNERS, GRIDS, (5, 10, 20), increment_nodes=51)
