"""The passes over the nodes: compiled, as plain Python, and against the same conditions written for whole arrays."""

import numpy as np
import pytest

from fastpin.kernels import conditions
from fastpin.kernels.arrays import ContactValues, Equations
from fastpin.kernels.status import OPEN, STICK
from tests.support.tiers import seeds

KERNELS = conditions
NODES = 12
pytestmark = pytest.mark.usefixtures("way")


class Drawn:
    """A random contact with its equations: no conditions hold."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        n, m = NODES, 3
        self.status = rng.permutation(np.resize([OPEN, STICK, 1, -1], n)).astype(np.int8)
        self.closed, self.stick = self.status != OPEN, self.status == STICK
        self.friction = np.where(rng.random(n) < 0.2, 0.0, rng.uniform(0.1, 1.0, n))
        pressure, shear = rng.normal(1.0, 1.0, n), rng.normal(size=n)
        self.values = ContactValues(
            pressure, shear, rng.normal(size=n), rng.normal(size=n), self.status, rng.normal(size=m)
        )
        self.equations = Equations(
            rng.normal(size=(2 * n, m)), rng.normal(size=(m, 2 * n)), rng.normal(size=(m, m)), self.friction,
            *(rng.normal(size=(rows, 4)) for rows in (2 * n, 2 * n, m)),
        )  # fmt: skip
        self.elastic, self.load = rng.normal(size=2 * n), rng.normal(size=5)  # a longer load vector
        self.loaded, self.work, self.forces = (columns @ self.load[:4] for columns in self.equations[4:])
        self.resultants, self.weights = rng.normal(size=(6, 2 * n)), rng.uniform(0.5, 1.0, n)
        self.force, self.moment = rng.normal(size=2), float(rng.normal())
        self.rest_gap, self.concentric_gap = rng.normal(size=n), rng.uniform(5.0, 6.0, n)

    @property
    def tractions(self):
        return np.r_[self.values.pressure, self.values.shear]

    @property
    def true(self):
        moved = self.elastic + self.equations.motion @ self.values.motion + self.loaded
        return moved + np.r_[self.rest_gap, np.zeros(NODES)]

    @property
    def lacking(self):
        carried = self.equations.equilibrium @ self.tractions + self.equations.motion_rows @ self.values.motion
        return self.forces - carried

    @property
    def sizes(self):
        return np.abs(self.equations.equilibrium) @ np.abs(self.tractions)

    def review(self, is_held=False):
        return conditions.review(
            self.equations, self.resultants, self.weights, self.values, self.elastic, self.load,
            self.rest_gap, self.concentric_gap, self.force, self.moment, is_held,
        )  # fmt: skip

    def residuals(self):
        return self.review()[0]


def test_residuals():
    for seed in seeds(6):
        drawn = Drawn(seed)
        found = drawn.residuals()
        (gap, slip), (pressure, shear) = np.split(drawn.true, 2), drawn.values[:2]
        size = np.abs(shear)
        sliding = np.abs(shear + drawn.status * drawn.friction * pressure)
        cone = np.where(drawn.stick, size - drawn.friction * pressure, sliding)
        cone = np.where(drawn.closed, np.maximum(cone, -pressure), np.maximum(np.abs(pressure), size))
        length = max(np.abs(drawn.elastic).max(), np.abs(drawn.values.motion).max())
        expected = (
            np.where(drawn.closed, np.abs(gap), np.maximum(-gap, 0.0)).max() / length,
            np.abs(slip - drawn.values.slip)[drawn.closed].max() / length,
            max(cone.max(), 0.0) / np.abs(pressure).max(),
            np.abs(drawn.lacking).max() / drawn.sizes.sum(),
        )
        assert found == pytest.approx(expected, rel=1e-12)


def test_residuals_without_contact_are_in_parts_of_the_gap():
    drawn = Drawn(1)
    drawn.status[:] = OPEN
    found = drawn.residuals()
    length = max(np.abs(drawn.elastic).max(), np.abs(drawn.values.motion).max(), drawn.concentric_gap.max())
    assert found[0] == pytest.approx(max(-drawn.true[:NODES].min(), 0.0) / length, rel=1e-12)
    assert found[1] == 0.0


@pytest.mark.parametrize("is_held", [False, True])
def test_equilibrium_and_energy(is_held):
    """The resultants of two interfaces against the force and the moment, and the elastic energy."""
    for seed in seeds(6):
        drawn = Drawn(seed)
        _, imbalance, energy = drawn.review(is_held)
        passed = drawn.resultants @ drawn.tractions
        moment = passed[2] if is_held else drawn.moment
        left = np.abs(passed.reshape(2, 3) - [*drawn.force, moment]).max()
        assert imbalance == pytest.approx(left / (np.abs(drawn.resultants) @ np.abs(drawn.tractions)).sum(), rel=1e-12)
        half = 0.5 * np.r_[drawn.weights, drawn.weights] * drawn.elastic
        assert energy == pytest.approx(drawn.tractions @ (half + drawn.work), rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("name", ["pressure", "shear", "slip", "motion"])
@pytest.mark.parametrize("place", [0, -1])
def test_nan_is_no_small_residual(name, place):
    drawn = Drawn(2)
    drawn.status[[0, -1]] = STICK
    getattr(drawn.values, name)[place] = np.nan
    found = drawn.residuals()
    assert np.isnan(np.max(found))


def test_imbalance_and_drift():
    for seed in seeds(6):
        drawn, true, missing = Drawn(seed), np.full(2 * NODES, np.nan), np.full(2 * NODES + 3, np.nan)
        error = conditions.imbalance(
            drawn.equations, drawn.values, drawn.elastic, drawn.loaded, drawn.forces, drawn.rest_gap, true, missing
        )
        assert true == pytest.approx(drawn.true, rel=1e-13)
        held = (drawn.values.slip - true[NODES:]) * drawn.stick
        expected = np.r_[-true[:NODES] * drawn.closed, held, drawn.lacking]
        assert missing == pytest.approx(expected, rel=1e-12, abs=1e-13)
        largest = np.abs(expected[: 2 * NODES]).max() / np.abs(drawn.elastic).max()
        assert error == pytest.approx(max(largest, np.abs(drawn.lacking).max() / drawn.sizes.max()), rel=1e-12)
        moved = np.abs(true - np.r_[drawn.values.gap, drawn.values.slip]).max()
        length = max(np.abs(drawn.elastic).max(), np.abs(drawn.values.motion).max(), 1e-4 * 7e5)
        got = conditions.drift(drawn.elastic, true, drawn.values.gap, drawn.values.slip, drawn.values.motion, 7e5)
        assert got == pytest.approx(moved / length, rel=1e-13)


def test_a_correction():
    for seed in seeds(6):
        drawn, rng = Drawn(seed), np.random.default_rng(seed + 100)
        tie, change = rng.choice([-1, 1], NODES).astype(np.int8), rng.normal(size=2 * NODES + 3)
        pressure, shear, motion = drawn.values.pressure.copy(), drawn.values.shear.copy(), drawn.values.motion.copy()
        conditions.correct(drawn.friction, tie, change, drawn.values)
        moved = pressure + change[:NODES]
        sticking = shear + change[NODES:-3] - tie * drawn.friction * change[:NODES]
        slipping = -drawn.friction * drawn.status * moved
        assert drawn.values.pressure == pytest.approx(np.where(drawn.closed, moved, pressure))
        expected = np.where(drawn.stick, sticking, np.where(drawn.closed, slipping, shear))
        assert drawn.values.shear == pytest.approx(expected)
        assert drawn.values.motion == pytest.approx(motion + change[-3:])


def test_values_on_their_bounds():
    for seed in seeds(6):
        drawn, rng = Drawn(seed), np.random.default_rng(seed + 200)
        solution, slip = drawn.values, rng.normal(size=NODES)
        solution.pressure[:3] = [1e-14, -0.3, 0.0]
        solution.gap[3:6] = [1e-14, -0.3, 0.0]
        settled = ContactValues(*(np.full(NODES, np.nan) for _ in range(3)), slip.copy(), drawn.status, np.zeros(3))
        conditions.put_on_bounds(drawn.friction, solution, settled)
        pressed = drawn.closed & (solution.pressure > 1e-12 * np.abs(solution.pressure).max())
        pressure = np.where(pressed, solution.pressure, 0.0)
        bound = drawn.friction * pressure
        held = np.where(np.abs(solution.shear) > bound, np.copysign(bound, solution.shear), solution.shear)
        shear = np.where(pressed, np.where(drawn.stick, held, solution.shear), 0.0)
        gaping = ~drawn.closed & (solution.gap > 1e-12 * np.abs(solution.gap).max())
        assert np.array_equal(settled.pressure, pressure)
        assert settled.shear == pytest.approx(shear, abs=1e-11)
        assert np.array_equal(settled.gap, np.where(gaping, solution.gap, 0.0))
        assert np.array_equal(settled.slip, np.where(drawn.stick, slip, solution.slip))
        traction, gap = conditions.beyond_bounds(solution, settled)
        cut = np.abs(settled.shear - solution.shear)[drawn.stick].max()
        assert traction == max(np.abs(settled.pressure - solution.pressure).max(), cut)
        assert gap == np.abs(settled.gap - solution.gap)[~drawn.closed].max()


def test_wanted_statuses():
    for seed in seeds(12):
        drawn, rng = Drawn(seed), np.random.default_rng(seed + 300)
        solution, start_slip, wanted = drawn.values, rng.normal(size=NODES), np.empty(NODES, dtype=np.int8)
        conditions.wanted_status(drawn.friction, solution, start_slip, drawn.rest_gap, 1e-11, wanted)
        slid = solution.slip - start_slip
        expected = drawn.status.copy()
        closing = ~drawn.closed & (solution.gap < 0.0)
        expected[closing] = np.where(slid[closing] < 0.0, -1, 1)
        back = drawn.closed & ~drawn.stick & (drawn.friction > 0.0) & (drawn.status * slid < 0.0)
        expected[back] = STICK
        free = drawn.stick & (np.abs(solution.shear) > drawn.friction * solution.pressure)
        expected[free] = np.where(solution.shear[free] > 0.0, -1, 1)
        expected[drawn.closed & (solution.pressure < 0.0)] = OPEN
        assert np.array_equal(wanted, expected)


def test_statuses_stay_within_the_tolerance():
    drawn, wanted = Drawn(3), np.empty(NODES, dtype=np.int8)
    conditions.wanted_status(drawn.friction, drawn.values, np.zeros(NODES), drawn.rest_gap, 1e9, wanted)
    assert np.array_equal(wanted, drawn.status)
