"""A spring between the hub of the pin and its prescribed displacement: the rig that drives it."""

import numpy as np
import pytest

from fastpin import InputError, Problem, solve
from fastpin.casefile import case_text, parse_case
from fastpin.report import describe
from tests.support.case_texts import IN_A_RIG

HISTORY = [{"P": 1.0}, {"ux": 0.3}, {"ux": -0.3}, {"ux": 0.3}]


def joint(pair, drive="ux", **more):
    return Problem.from_load_parameter(pair, 0.3, 0.4, "centre", "fixed", 0.3, drive=drive, **more)


@pytest.mark.parametrize("stiffness", [0.05, 1.0, 30.0])
def test_the_rig_gives_way_by_its_force(titanium_in_aluminium, stiffness):
    """The hub moves as without a rig under the displacement that is left, and the work has the spring's energy."""
    result = solve(joint(titanium_in_aluminium, rig_stiffness=stiffness), HISTORY, nodes=61)
    given, forces = (np.array([state.load[name] for state in result]) for name in ("ux", "Q"))
    moved = [state.displacement["ux"] for state in result]
    assert given - forces / stiffness == pytest.approx(moved, abs=1e-12)
    corners = [{"P": state.load["P"], "ux": ux} for state, ux in zip(result, moved, strict=True)]
    rigid = solve(joint(titanium_in_aluminium), corners, grid=result.grid)
    assert [state.load["Q"] for state in rigid] == pytest.approx(forces, abs=1e-11)
    assert rigid[-1].dissipation == pytest.approx(result[-1].dissipation, rel=1e-9)


def test_a_stiff_rig_is_none(titanium_in_aluminium):
    rigid = solve(joint(titanium_in_aluminium), HISTORY, nodes=41)
    stiff = solve(joint(titanium_in_aluminium, rig_stiffness=1e14), HISTORY, grid=rigid.grid)
    assert stiff[-1].load["Q"] == pytest.approx(rigid[-1].load["Q"], rel=1e-11)


@pytest.mark.parametrize(
    ("drive", "stiffness", "words"),
    [
        ("ux", 0.0, "must be positive, not 0"),
        ("ux", -1.0, "must be positive, not -1"),
        ("ux", "soft", "must be a number"),
        ("force", 1.0, 'only a displacement has a rig: drive = "ux" or "uy" or "both"'),
    ],
)
def test_a_wrong_stiffness_is_refused(titanium_in_aluminium, drive, stiffness, words):
    with pytest.raises(InputError, match=words) as caught:
        joint(titanium_in_aluminium, drive, rig_stiffness=stiffness)
    assert caught.value.field == "rig_stiffness"


def test_the_case_file_gives_the_whole_rig_s_stiffness():
    case = parse_case(IN_A_RIG.replace("[[load]]", "thickness = 5e-3\nrig_stiffness = 3e8\n[[load]]"))
    assert case.problem.rig_stiffness == 3e8 / 5e-3
    assert "rig of stiffness 300 MN per m" in describe(case)
    assert parse_case(case_text(case)).problem == case.problem
