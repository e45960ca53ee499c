"""Random pressed joints: the stress of the assembly and the stress of the loads add up to the stress."""

import math
import warnings

import pytest

from fastpin.solver.configuration import MAX_RESIDUAL
from tests.support.tiers import seeds
from tests.survey.assembly import examine, pressed_joint

pytestmark = pytest.mark.survey

MOST = 1e-9
"""Largest difference, in parts of the largest stress."""


@pytest.mark.parametrize("part", range(5))
@pytest.mark.parametrize(("kind", "many"), [("fits", 1), ("bodies", 2), ("bush", 1), ("laminates", 2), ("gap", 2)])
def test_stresses_of_assembly_and_loads_add_up(kind: str, many: int, part: int) -> None:
    """Pins and hollow pins, rings, bonded and slipping bushes, outlines, laminates and initial gaps."""
    joints = {
        seed: joint for seed in seeds(many) if seed % 5 == part and (joint := pressed_joint(kind, seed)) is not None
    }
    if not joints:
        pytest.skip("none of these seeds gives a pressed joint")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = {seed: examine(*joint) for seed, joint in joints.items()}
    known = {seed: one for seed, one in found.items() if one is not None}
    linear = [one.halved for one in known.values() if not math.isnan(one.halved)]
    print(kind, len(known), "of", len(found), "solved,", len(linear), "closed:")
    print(max(one.before for one in known.values()), max(one.sums for one in known.values()), max(linear, default=0.0))
    assert len(known) >= 0.8 * len(found) > 0
    assert [(seed, one) for seed, one in known.items() if max(one.before, one.sums) > MOST] == []
    # a state is solved to MAX_RESIDUAL: one state less twice another has three times as much
    assert [(seed, one) for seed, one in known.items() if one.halved > 3.0 * MAX_RESIDUAL] == []
