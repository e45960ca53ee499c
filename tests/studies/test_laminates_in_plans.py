"""Laminates in plans, in tolerance plans and in the ids of runs."""

from pathlib import Path

import pytest

from fastpin import CaseFileError
from fastpin.casefile import parse_case
from fastpin.model import Laminate
from fastpin.model.angles import angle_at
from fastpin.model.keys import kind_of
from fastpin.studies import parse_plan, parse_tolerances
from fastpin.studies.identity import canonical, canonical_json, run_id
from fastpin.studies.variation import field_words

HEAD = '[pin]\nmaterial = "steel"\n[plate]\n'
TAIL = '\n[contact]\nplane = "stress"\nhole_radius = 3e-3\nclearance = 2e-5\nfriction = 0.2\n[[load]]\nP = 1e6\n'
LAYUP = 'layup = "[0/45/-45/90]2s"\nply = "T300/5208"'
COMPLIANCE = (2e-11, 0.0, 3e-11, 0.0, 0.0, 6e-11)
MODULI = "E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25"


def plates(folder: Path, keys: str, plan: str) -> list[Laminate]:
    (folder / "case.toml").write_text(HEAD + keys + TAIL)
    found = parse_plan(f'case = "case.toml"\n{plan}', folder=folder)
    return [found.case(point).problem.pair.plate for point in found.points]  # type: ignore[misc]


def test_a_grid_of_axes_and_layups(tmp_path: Path) -> None:
    found = plates(tmp_path, LAYUP, '[grid]\n"plate.axis" = [0, 45]\n"plate.layup" = ["[0]4", "[0/90]s"]\n')
    assert [(each.axis, each.layup) for each in found] == [
        (angle_at(axis), layup) for axis in (0.0, 45.0) for layup in ("[0]4", "[0/90]s")
    ]


@pytest.mark.parametrize(
    ("keys", "plan", "expected"),
    [
        (MODULI, "E1 = 80e9", Laminate.from_moduli(80e9, 30e9, 9e9, 0.25)),
        (LAYUP, 'ply = "AS4/3501-6"', Laminate.from_layup("[0/45/-45/90]2s", "AS4/3501-6")),
        (LAYUP, f"compliance = {[*COMPLIANCE]}", Laminate(compliance=COMPLIANCE)),
        (LAYUP, "E1 = 80e9, E2 = 30e9, G12 = 9e9, nu12 = 0.1", Laminate.from_moduli(80e9, 30e9, 9e9, 0.1)),
        ('material = "aluminium"', 'layup = "[0]", ply = "T300/5208"', Laminate.from_layup("[0]", "T300/5208")),
    ],
)
def test_a_varied_key_replaces_the_other_ways(tmp_path: Path, keys: str, plan: str, expected: Laminate) -> None:
    assert plates(tmp_path, keys, f"[[list]]\nplate = {{ {plan} }}\n") == [expected]


def test_an_isotropic_material_replaces_a_laminate(tmp_path: Path) -> None:
    (steel,) = plates(tmp_path, LAYUP + "\naxis = 30", '[grid]\n"plate.material" = ["steel"]\n')
    assert steel.name == "steel"
    assert steel.is_isotropic


def test_faults_of_laminates_in_plans_name_the_field(tmp_path: Path) -> None:
    with pytest.raises(CaseFileError, match=r"plate.layup: must be symmetric .* \(in the run plate.layup"):
        plates(tmp_path, LAYUP, '[grid]\n"plate.layup" = ["[0]", "[0/90]"]\n')
    with pytest.raises(CaseFileError, match=r"plate\.axis: must be in degrees from the bottom"):
        plates(tmp_path, LAYUP, '[grid]\n"plate.axis" = [0.7854]\n')


def test_the_nominal_axis_is_in_degrees(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(HEAD + LAYUP + TAIL)
    plan = parse_tolerances(
        'case = "case.toml"\nsamples = 3\n[tolerances]\n"plate.axis" = { from = -5, to = 5 }\n', folder=tmp_path
    )
    assert plan.limits["plate.axis"].nominal == 0.0


def identity(keys: str) -> str:
    return run_id(canonical(parse_case(HEAD + keys + TAIL)), "1.0")


def test_an_id_tells_all_that_results_depend_on() -> None:
    keys = [
        LAYUP,
        LAYUP + "\naxis = 10",
        LAYUP.replace("2s", "s"),
        LAYUP.replace("T300/5208", "T300/914"),
        'layup = "[90/45/-45/0]2s"\nply = "T300/5208"',
        MODULI,
        MODULI.replace("70e9", "71e9"),
        'layup = "[0]"\nply = { E1 = 1e11, E2 = 1e10, G12 = 5e9, nu12 = 0.3, thickness = 1e-4 }',
        'layup = "[0]"\nply = { E1 = 1e11, E2 = 1e10, G12 = 5e9, nu12 = 0.3, thickness = 2e-4 }',
    ]
    assert len(set(map(identity, keys))) == len(keys)


def test_an_id_does_not_depend_on_the_spelling() -> None:
    own = "{ E1 = 1e11, E2 = 1e10, G12 = 5e9, nu12 = 0.3, thickness = 1e-4"
    assert identity(f'layup = "[0/90]s"\nply = {own} }}') == identity(
        f'layup = "[ 0 / 90_2 / 0 ]"\nply = {own}, name = "mine", source = "tests" }}\naxis = 0'
    )
    assert '"plate":{"axis":' in canonical_json(canonical(parse_case(HEAD + MODULI + TAIL)))


def test_words_of_the_fields() -> None:
    assert field_words("plate.axis") == "axis (deg) of the plate"
    assert field_words("plate.E1") == "modulus E1 of the plate"
    assert (kind_of("plate.E1"), kind_of("plate.axis")) == ("modulus", "")
