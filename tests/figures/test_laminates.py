"""Figures of laminates: stiffness by direction, strength round the hole, directions of plies."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, MaterialPair, Points, Problem, save, solve
from fastpin.cli.main import main
from fastpin.damage import first_ply_failure, joint_strength
from fastpin.figures import plot_stiffness, plot_strength, plot_stress_field
from fastpin.model import Laminate, StrengthAssessment
from fastpin.report.stress import field_curves
from tests.support.once import solve_once

PLATE = Laminate.from_layup("[0_2/45/-45/90]s", "T300/914", axis=-0.5 * math.pi + 0.3)
JOINT = Problem(MaterialPair(MATERIALS["steel"], PLATE, "stress"), 3e-3, 20e-6, 0.2)
ISOTROPIC = Problem(MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"], "stress"), 3e-3, 20e-6, 0.2)
HISTORY = [{"P": 1e6}, {"P": 1e6, "Q": 3e5}]


def result():
    return solve_once(JOINT, HISTORY, nodes=61)


def test_stiffness_by_direction_from_the_bottom() -> None:
    young, shear = plot_stiffness(JOINT, title="Stack").axes
    E1, E2, G12, _ = PLATE.moduli
    for panel, values in ((young, (E1, E2)), (shear, (G12, G12))):
        angle, modulus = panel.lines[0].get_xydata().T
        for turn, value in zip((0.3, 0.3 + 0.5 * math.pi), values, strict=True):
            assert np.interp(turn, angle, 1e9 * modulus) == pytest.approx(value, rel=2e-4)
        assert panel.get_theta_offset() == pytest.approx(1.5 * math.pi)  # 0 is at the bottom
        assert len(panel.lines) == 1 + 2 * 4  # two halves of a line for each direction of plies
    assert young.get_xlabel() == "Young's modulus E (GPa)"


def test_a_dimensionless_laminate_has_moduli_over_beta() -> None:
    problem = Problem.from_load_parameter(MaterialPair(MATERIALS["steel"], PLATE, "stress"), 0.1, 0.2)
    assert plot_stiffness(problem).axes[0].get_xlabel() == "Young's modulus E (1/β*)"


def test_strength_round_the_hole() -> None:
    (panel,) = plot_strength(result(), criterion="tsai-wu", depth=0.5e-3).axes
    for state, drawn in zip(result(), panel.lines, strict=False):
        angle, ratio = drawn.get_xydata().T
        found = joint_strength(state, "tsai-wu", distance=0.5e-3)
        assert ratio.min() == pytest.approx(found.least_ratio)
        assert math.radians(angle[np.argmin(ratio)] - 90.0) == pytest.approx(found.angle)
    assert "first ply by tsai-wu, 500\xa0µm from the edge" in panel.get_title() + panel.figure.get_suptitle()
    worst = min(
        (joint_strength(state, "tsai-wu", distance=0.5e-3) for state in result()), key=lambda each: each.least_ratio
    )
    words = f"{worst.ply_angle:g}° {worst.ply_mode}".replace("-", "−")
    (there,) = (text.xy for text in panel.texts if text.get_text() == words and text.xy[1] == worst.least_ratio)
    assert math.radians(there[0] - 90.0) == pytest.approx(worst.angle)


@pytest.mark.gate
def test_kinds_on_the_command_line(tmp_path: Path, capsys) -> None:
    stored, numbers = tmp_path / "run.h5", tmp_path / "strength.csv"
    save(result(), stored)
    assert main(["plot", str(stored), "stiffness", "-o", str(tmp_path / "stiffness.svg")]) == 0
    options = ["--criterion", "yamada-sun", "--depth", "5e-4", "--states", "2", "--csv", str(numbers)]
    assert main(["plot", str(stored), "strength", "-o", str(tmp_path / "strength.svg"), *options]) == 0
    rows = list(csv.DictReader(numbers.read_text().splitlines()))
    found = joint_strength(result()[1], "yamada-sun", distance=5e-4)
    assert min(float(row["strength ratio"]) for row in rows) == pytest.approx(found.least_ratio, rel=1e-6)
    assert main(["plot", str(stored), "strength", "-o", str(tmp_path / "no.svg"), "--criterion", "hill"]) != 0
    assert "tsai-hill" in capsys.readouterr().err


def test_an_isotropic_plate_has_neither() -> None:
    with pytest.raises(InputError, match="plate: must be a laminate"):
        plot_stiffness(ISOTROPIC)
    with pytest.raises(InputError, match="plate: must be a laminate"):
        plot_strength(solve(ISOTROPIC, [{"P": 1e6}], nodes=41))


@pytest.mark.gate
def test_a_map_of_the_used_strength(tmp_path: Path) -> None:
    """At a point it is the inverse of the ratio; it is a number, not a stress."""
    state = result()[-1]
    (curve,) = field_curves(state, "utilization", extent=1.5, fineness=40)
    assert list(curve.columns)[-1] == "used strength of the first ply (Hashin)"
    radius, angle, used = curve.columns.values()
    for place in (0, 700, used.size - 1):
        point = Points.at_radius(radius[place], math.radians(angle[place] - 90.0))
        stress = state.stress(point)
        ratio = first_ply_failure(PLATE, np.stack([stress.sxx, stress.syy, stress.sxy], axis=-1)).ratio
        assert used[place] == pytest.approx(1.0 / ratio, rel=1e-9)
    figure = plot_stress_field(state, tmp_path / "map.png", component="utilization")
    assert figure.axes[-1].get_ylabel() == "used strength of the first ply (Hashin)"
    with pytest.raises(InputError, match="plate: must be a laminate"):
        field_curves(solve_once(ISOTROPIC, HISTORY, nodes=41)[-1], "utilization")


def test_strength_as_an_assessment_says() -> None:
    how = StrengthAssessment("yamada-sun", tension=0.5e-3, compression=1e-3)
    state = result()[-1]
    panel = plot_strength(state, how=how).axes[0]
    found = joint_strength(state, "yamada-sun", tension=0.5e-3, compression=1e-3)
    assert panel.lines[0].get_ydata().min() == pytest.approx(found.least_ratio)
    assert "on the characteristic curve of 500\xa0µm and 1\xa0mm" in panel.figure.get_suptitle() + panel.get_title()
    other = plot_strength(state, how=how, criterion="hashin", depth=1e-3).axes[0]
    at = joint_strength(state, "hashin", distance=1e-3)
    assert other.lines[0].get_ydata().min() == pytest.approx(at.least_ratio)
    with pytest.raises(InputError, match="how: must be a"):
        plot_strength(state, how="hashin")
