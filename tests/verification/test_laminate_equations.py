"""The integral equations of a laminate, (T58): their residuals vanish with the distance of the nodes."""

import numpy as np
import pytest

from fastpin import Grid, MaterialPair, Problem, solve
from tests.support.checks import integral_equations
from tests.support.laminates import STEEL, TURNED

BESIDE = 0.15
"""Angle beside borders of zones that is left out, rad: tractions have kinks there."""


def largest(nodes: int, friction: float) -> tuple[float, float]:
    """The largest residuals of (46) and (47), away from the borders of zones."""
    problem = Problem.from_load_parameter(MaterialPair(STEEL, TURNED, "stress"), -0.3, friction)
    state = solve(problem, [{"P": 0.4, "sxx": 0.05}], grid=Grid.circle(nodes))[-1]
    found = integral_equations.residuals(
        problem, 1.0, state.grid, state.pressure, state.shear, state.slip, state.rotation, sxx=0.05, rest=(0.0, 0.0)
    )
    borders = state.theta[state.status != np.roll(state.status, 1)]
    away = np.abs(np.angle(np.exp(1j * (state.theta[:, None] - borders)))).min(axis=1, initial=np.pi) > BESIDE
    return tuple(float(np.abs(values[away]).max()) for values in found)


@pytest.mark.filterwarnings("ignore:friction")
@pytest.mark.parametrize(("friction", "allowed"), [(0.0, 2e-4), (1e3, 2e-5)], ids=["smooth", "stuck"])
def test_residuals_are_of_second_order(friction: float, allowed: float) -> None:
    for one, other in zip(largest(200, friction), largest(400, friction), strict=True):
        assert other < allowed
        assert one / other == pytest.approx(4.0, rel=0.1)


@pytest.mark.gate
def test_residuals_of_partial_slip_fall() -> None:
    """The cusps at the borders of zones are felt far away."""
    for one, other in zip(largest(200, 0.4), largest(800, 0.4), strict=True):
        assert other < 4e-4
        assert one > 1.8 * other


def test_without_the_term_of_the_laminate_they_are_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(integral_equations, "_laminate_terms", lambda *_: 0.0)
    assert min(largest(200, 0.4)) > 0.02
