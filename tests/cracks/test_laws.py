"""Laws of growth by hand, and their limits."""

import math
import pickle

import numpy as np
import pytest

from fastpin.cracks import GrowthLaw, Nasgro, Walker, intrinsic_length, paris
from fastpin.damage import critical_distance
from fastpin.errors import InputError
from fastpin.model.growth import law_entries, law_from
from tests.support.cracks import NASGRO, M
from tests.support.refusals import refused


def one(law, top, bottom, length=1e-3):
    """Range, threshold and rate of one cycle."""
    high, low, a = np.array([top]), np.array([bottom]), np.array([length])
    return law.range(high, low)[0], law.threshold(high, low, a)[0], law.rate(high, low, a)[0]


def test_paris_takes_the_open_part_of_a_cycle():
    law = paris(1e-10, 3.0)
    assert one(law, 10.0 * M, 2.0 * M) == pytest.approx((8.0 * M, 0.0, 1e-10 * 512.0))
    assert one(law, 10.0 * M, -5.0 * M) == pytest.approx((10.0 * M, 0.0, 1e-7))
    assert one(law, -1.0 * M, -5.0 * M) == (0.0, 0.0, 0.0)
    assert one(law, 5.0 * M, 5.0 * M) == (0.0, 0.0, 0.0)


def test_walker_takes_the_stress_ratio():
    law = Walker(1e-10, 3.0, 0.5, threshold_range=2.0 * M, intrinsic_length=1e-3)
    swing, threshold, rate = one(law, 10.0 * M, 5.0 * M)
    assert swing == 5.0 * M
    assert threshold == pytest.approx(2.0 * M * math.sqrt(0.5) * math.sqrt(0.5))
    assert rate == pytest.approx(1e-10 * (math.sqrt(10.0 * 5.0)) ** 3)
    other = Walker(1e-10, 3.0, 0.5, threshold_range=2.0 * M, threshold_exponent=1.0)
    assert one(other, 10.0 * M, 5.0 * M)[1] == pytest.approx(1.0 * M)
    assert one(law, 1.0 * M, 0.0)[2] == 0.0
    assert one(Walker(1e-10, 3.0, toughness=10.0 * M), 10.0 * M, 0.0)[2] == math.inf
    assert one(Walker(1e-10 * 2.0**3, 3.0, unit=2.0 * M), 10.0 * M, 0.0)[2] == pytest.approx(1e-7)


def test_nasgro_by_hand():
    A_0 = (0.825 - 0.68 + 0.2) * math.sqrt(math.cos(0.15 * math.pi))
    A_1 = (0.415 - 0.142) * 0.3
    assert NASGRO.opening(np.array([0.0, -1.0, -2.0, 1.0])) == pytest.approx([A_0, A_0 - A_1, A_0 - 2.0 * A_1, 1.0])
    f = max(0.5, A_0 + 0.5 * A_1 + 0.25 * (1.0 - A_0 - A_1 - (2 * A_0 + A_1 - 1.0)) + 0.125 * (2 * A_0 + A_1 - 1.0))
    swing, threshold, rate = one(NASGRO, 10.0 * M, 5.0 * M)
    assert swing == pytest.approx(5.0 * M)
    by_hand = 0.8 * math.sqrt(1e-3 / 1.0381e-3) / ((1 - f) / ((1 - A_0) * 0.5)) ** (1.0 + 2.2 * 0.5)
    assert threshold == pytest.approx(by_hand * M)
    assert rate == pytest.approx(6.35e-10 * ((1 - f) * 10.0) ** 2.5 * (1 - by_hand / 5.0) / (1 - 10.0 / 35.16))


def test_nasgro_at_its_ends():
    assert one(NASGRO, 10.0 * M, -20.0 * M) == one(NASGRO, 10.0 * M, -90.0 * M)
    assert one(NASGRO, 36.0 * M, 0.0)[2] == math.inf
    assert one(NASGRO, -1.0 * M, -3.0 * M)[2] == 0.0
    assert one(NASGRO, 5.0 * M, 5.0 * M)[2] == 0.0
    assert one(NASGRO, 0.5 * M, 0.0)[2] == 0.0
    almost = one(NASGRO, 10.0 * M, -1e-6 * M)
    assert one(NASGRO, 10.0 * M, 0.0) == pytest.approx(almost, rel=1e-6)


def test_the_intrinsic_length_of_a_smooth_edge():
    a0 = intrinsic_length(3.0 * M, 200.0 * M)
    assert 1.1215222 * 200.0 * M * math.sqrt(math.pi * a0) == pytest.approx(3.0 * M)
    assert critical_distance(3.0 * M, 200.0 * M) / a0 == pytest.approx(1.2578, rel=1e-4)
    law = paris(1e-10, 3.0, 3.0 * M, a0)
    short = 1e-9
    assert one(law, 0.0, 0.0, short)[1] == pytest.approx(1.1215222 * 200.0 * M * math.sqrt(math.pi * short), rel=1e-4)


REFUSED = {
    "C: must be positive, not 0": lambda: Walker(0.0, 3.0),
    "m: must be positive, not -3": lambda: Walker(1e-10, -3.0),
    "exponent: must lie between 0 and 1, not 2": lambda: Walker(1e-10, 3.0, 2.0),
    "threshold_range: must not be negative, not -1": lambda: Walker(1e-10, 3.0, threshold_range=-1.0),
    "threshold_exponent: must lie between 0 and 2, not 3": lambda: Walker(1e-10, 3.0, threshold_exponent=3.0),
    "intrinsic_length: must be a finite number, not nan": lambda: paris(1e-10, 3.0, 0.0, math.nan),
    "toughness: must be positive, not 0": lambda: Walker(1e-10, 3.0, toughness=0.0),
    "unit: must be positive, not 0": lambda: Walker(1e-10, 3.0, unit=0.0),
    "constraint: must lie between 1 and 3, not 4": lambda: Nasgro(1e-10, 3, 1, 1, 1e6, 1e8, constraint=4.0),
    "stress_level: must lie between 0 and 0.99, not 1": lambda: Nasgro(1e-10, 3, 1, 1, 1e6, 1e8, stress_level=1.0),
    "p: must not be negative, not -1": lambda: Nasgro(1e-10, 3, -1, 1, 1e6, 1e8),
    "limit_range: must be positive, not 0": lambda: intrinsic_length(1e6, 0.0),
    "threshold_range: is 1e+200 times": lambda: intrinsic_length(1e200 * 1.1215222, 1.0),
}


@pytest.mark.parametrize("words", REFUSED)
def test_refusals(words):
    assert str(refused(REFUSED[words])).startswith(words)


def test_pickles():
    for law in (NASGRO, paris(1e-10, 3.0)):
        assert pickle.loads(pickle.dumps(law)) == law


def test_a_law_of_the_user_needs_one_method():
    class Forman(GrowthLaw):
        """Forman, Kearney, Engle 1967, with the toughness 50 MPa sqrt(m)."""

        @property
        def fracture_toughness(self):
            return 50.0 * M

        def _rate_above(self, K_max, K_min, length):
            swing = self._range(K_max, K_min) / M
            return 1e-8 * swing**3 / (50.0 * swing / (K_max / M) - swing)

    law = Forman()
    assert one(law, 20.0 * M, 10.0 * M) == pytest.approx((10.0 * M, 0.0, 1e-5 / (25.0 - 10.0)))
    assert one(law, 50.0 * M, 10.0 * M)[2] == math.inf
    assert one(law, -1.0 * M, -2.0 * M) == (0.0, 0.0, 0.0)


def test_laws_become_tables_and_come_back():
    for law in (NASGRO, Walker(1e-10, 3.0), Walker(1e-10, 3.0, 0.5, toughness=5e7, source="own")):
        assert law_from(law_entries(law)) == law
    assert law_entries(paris(1e-10, 3.0)) == {"law": "walker", "C": 1e-10, "m": 3.0}
    for entries, fault in (
        ({"law": "parris"}, 'law: must be one of paris, walker, nasgro, not "parris"'),
        ({"law": "paris", "C": 1.0, "m": 3.0, "exponent": 0.5}, "exponent: is no constant of the law paris"),
        ({"law": "walker", "C": 1.0}, "m: is missing; the law walker needs C, m"),
    ):
        with pytest.raises(InputError, match=fault):
            law_from(entries)


def test_a_law_without_a_growth_is_refused():
    with pytest.raises(InputError, match=r"law: needs the method _rate_above\(K_max, K_min, length\)"):
        GrowthLaw().rate([2.0], [1.0], 1.0)
