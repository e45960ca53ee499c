"""Tolerance studies: points between the limits of fields, and the effects on outcomes."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import spearmanr

from fastpin import CaseFileError, InputError, report
from fastpin.studies import parse_plan, parse_tolerances, read_tolerances, sweep
from fastpin.studies.tolerances import MOST_FIELDS, Tolerances, effect_of, effects_of, part_words, rank_correlation
from scripts.inline import Inline
from tests.support.body_texts import HEAD

CASE = HEAD.replace("20e-6", "0.0").replace("friction = 0.3", "friction = 0.0") + "[solve]\nnodes = 61\n"
"""A neat fit without friction: every stress is proportional to the load."""


def study_of(folder: Path, text: str, case: str = CASE) -> Tolerances:
    (folder / "case.toml").write_text(case)
    return parse_tolerances(f'case = "case.toml"\n{text}', folder=folder)


def faults_of(folder: Path, text: str, case: str = CASE) -> str:
    with pytest.raises(CaseFileError) as caught:
        study_of(folder, text, case)
    return str(caught.value)


@pytest.mark.gate
def test_outcomes_of_a_neat_fit_without_friction_are_proportional_to_the_factors(tmp_path: Path):
    text = (
        "samples = 12\n[tolerances]\nloads = { from = 0.9, to = 1.1 }\nloads.P = { from = 0.5, to = 1.25, count = 4 }\n"
    )
    study = study_of(tmp_path, text.replace("loads.P", '"loads.P"'))
    assert sweep.run(study.plan, tmp_path / "out", Inline()).failed == []
    effects = study.effects(tmp_path / "out")
    assert list(effects) == ["largest_pressure", "largest_shear", "largest_hoop"]
    for name in ("largest_pressure", "largest_hoop"):
        effect = effects[name]
        assert effect.nominal > 0.0
        alone = {"loads": [0.9, 1.0, 1.1], "loads.P": [0.5, 0.75, 1.0, 1.25]}
        for field, factors in alone.items():
            assert effect.alone[field] == pytest.approx([effect.nominal * factor for factor in factors], rel=1e-9)
        assert list(effect.swings) == ["loads.P", "loads"]
        assert effect.swings["loads"] == pytest.approx(0.2 * effect.nominal, rel=1e-9)
        found = [end.value / effect.nominal for end in effect.corners]
        assert found == pytest.approx([0.9 * 0.5, 1.1 * 1.25], rel=1e-9)
        assert study.plan.points[effect.corners.largest.place].values == {"loads": 1.1, "loads.P": 1.25}
        assert effect.beyond == effect.corners  # no sample lies beyond
        products = [study.plan.points[place].values["loads"] * study.plan.points[place].values["loads.P"]
                    for place in study.samples]  # fmt: skip
        assert effect.percentiles[50] == pytest.approx(effect.nominal * np.percentile(products, 50), rel=1e-9)
    assert max(abs(value) for value in effects["largest_shear"].swings.values()) == 0.0


def test_a_part_that_is_added_solves_only_its_own_runs(tmp_path: Path):
    text = "samples = SOME\n[tolerances]\nloads = { from = 0.9, to = 1.1 }\n"
    first = study_of(tmp_path, text.replace("SOME", "0"))
    assert (len(first.corners), len(first.samples), len(first.plan.runs)) == (2, 0, 3)  # corners are limits alone
    assert sweep.run(first.plan, tmp_path / "out", Inline()).ended == 3
    more = study_of(tmp_path, text.replace("SOME", "5"))
    assert sweep.run(more.plan, tmp_path / "out", Inline()).ended == 5
    assert sweep.run(more.plan, tmp_path / "out", Inline()).ended == 0
    assert first.effects(tmp_path / "out")["largest_pressure"].correlations == {}


def test_the_nominal_point_is_the_run_of_the_case_itself(tmp_path: Path):
    study = study_of(
        tmp_path, "samples = 0\n[tolerances]\nplate.E = { from = 60e9, to = 80e9 }\nloads = { from = 0.9, to = 1.1 }"
    )
    alone = parse_plan('case = "case.toml"\n[grid]\ncontact.friction = [0.0]\n', folder=tmp_path)
    assert study.plan.points[0].id == alone.points[0].id
    assert study.limits["plate.E"].nominal == 69e9 == study.plan.points[0].values["plate.E"]  # of the named material
    assert [part_words(study, place) for place in (0, 1, study.corners[0])] == ["nominal", "plate.E alone", "a corner"]


def test_samples_are_a_latin_hypercube_with_a_seed(tmp_path: Path):
    text = (
        "samples = 40\nseed = SEED\ncorners = false\n[tolerances]\n"
        'contact.friction = { from = 0.0, to = 0.5 }\nplate.E = { from = 1e9, to = 1e11, spacing = "log" }\n'
    )
    study = study_of(tmp_path, text.replace("SEED", "3"))
    assert len(study.corners) == 0
    points = [study.plan.points[place].values for place in study.samples]
    friction = np.array([point["contact.friction"] for point in points]) / 0.5
    modulus = np.log10([point["plate.E"] for point in points]) / 2.0 - 4.5
    for parts in (friction, modulus):
        assert sorted(np.floor(40.0 * parts)) == list(range(40))
    again, other = (study_of(tmp_path, text.replace("SEED", seed)) for seed in ("3", "4"))
    assert again.plan.points == study.plan.points
    assert other.plan.points[-1] != study.plan.points[-1]


def test_an_extreme_between_the_limits_lies_beyond_all_corners():
    x = np.array([0.5, 0.0, 1.0, 0.0, 1.0, 0.25, 0.75])
    effect = effect_of(x * (1.0 - x), {"x": x}, {"x": [1, 0, 2]}, range(3, 5), range(5, 7))
    assert (effect.corners.largest.value, effect.beyond.largest.value) == (0.0, 0.25)
    assert effect.beyond.largest.place == 0
    assert effect.beyond.smallest == effect.corners.smallest
    assert effect.swings == {"x": 0.25}


def test_runs_without_a_value_count_nowhere():
    values = np.array([2.0, np.nan, 3.0, np.nan, 3.0, 2.5, np.nan])
    x = np.array([0.5, 0.0, 1.0, 0.0, 1.0, 0.75, 0.25])
    effect = effect_of(values, {"x": x}, {"x": [1, 0, 2]}, range(3, 5), range(5, 7))
    assert effect.swings == {"x": 1.0}
    assert (effect.corners.smallest, effect.corners.largest) == ((3.0, 4), (3.0, 4))
    assert effect.percentiles[5] == 2.5
    assert np.isnan(effect.correlations["x"])  # of one sample
    none = effect_of(np.full(7, np.nan), {"x": x}, {"x": [1, 0, 2]}, range(3, 5), range(5, 7))
    assert (none.corners, none.everywhere, none.beyond, none.percentiles) == (None, None, None, {})


def test_rank_correlations_are_those_of_scipy():
    random = np.random.default_rng(1)
    for count in (3, 10, 50):
        first, second = random.random(count), random.integers(0, 5, count).astype(float)  # with equal values
        assert rank_correlation(first, second) == pytest.approx(spearmanr(first, second).statistic, abs=1e-12)
    assert rank_correlation(first, -(first**3)) == pytest.approx(-1.0)
    assert np.isnan(rank_correlation(first, np.ones(count)))
    assert np.isnan(rank_correlation(first, 1.0 + 1e-13 * first))  # equal up to rounding


def test_places_on_the_hole_are_compared_on_the_circle(tmp_path: Path):
    study = study_of(
        tmp_path,
        "samples = 0\n[tolerances]\nloads = { from = 0.9, to = 1.1 }\n"
        '[outcomes]\nat = { quantity = "peak_hoop_angle" }\n',
    )
    rows = [
        {"id": point.id, "status": "done", "at": angle, "loads": point.values["loads"]}
        for point, angle in zip(study.plan.points, (179.0, -178.0, 175.0, 179.0, 179.0), strict=True)
    ]
    assert effects_of(study, rows)["at"].swings == {"loads": 7.0}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tolerances]\ncontact.friction = { from = 0.1, to = 0.6 }", "line 3: contact.friction: the case has 0"),
        ("[tolerances]\ncontact.friction = { from = 0.6, to = 0.0 }", "line 3: contact.friction: from must lie below"),
        ("[tolerances]\ncontact.friction = { from = 0.0, to = 0.0 }", "line 3: contact.friction: from must lie below"),
        ("[tolerances]\ncontact.fricton = { from = 0.1, to = 0.6 }", 'did you mean "friction"?'),
        ("[tolerances]\ncontact.friction = { from = 0.0 }", "contact.friction: to is missing; a range has from and to"),
        ("[tolerances]\ncontact.friction = 0.3", "must be limits such as { from = 0.1, to = 0.6 }, not 0.3"),
        ("[tolerances]\nsolve.nodes = { from = 41, to = 81 }", "line 3: solve.nodes: is an option of the solver"),
        ("[tolerances]\nloads.Q = { from = 0.9, to = 1.1 }", "line 3: loads.Q: the case has no such load"),
        ("[tolerances]\npin.rigid = { from = 0.9, to = 1.1 }", "line 3: pin.rigid: the case has no number for it"),
        ("[tolerances]\nload.1.P = { from = 1e5, to = 9e5 }", "line 3: load.1.P: the case has 1e+06, outside of"),
        ("[tolerances]\ncontact.friction = { from = -0.1, to = 0.6 }", "line 3: contact.friction: must"),
        ("samples = -1\n[tolerances]\nloads = { from = 0.9, to = 1.1 }", "line 2: samples: must be"),
        ("samplse = 1\n[tolerances]\nloads = { from = 0.9, to = 1.1 }", 'did you mean "samples"?'),
        ("seed = 0.5\n[tolerances]\nloads = { from = 0.9, to = 1.1 }", "line 2: seed: must be"),
        ("[tolerances]\n", "no field has limits"),
        (
            '[tolerances]\nloads = { from = 0.9, to = 1.1 }\n[outcomes]\nr = { quantity = "regime" }',
            "line 5: r: is a class, which has no swing",
        ),
        ("[tolerances]\n[grid]\ncontact.friction = [0.1]", "unknown section [grid]"),
    ],
)  # fmt: skip
def test_faults_name_the_field_with_its_line(tmp_path: Path, text: str, message: str):
    assert message in faults_of(tmp_path, text)


def test_a_load_with_several_points_is_varied_by_a_factor(tmp_path: Path):
    case = CASE.replace("P = 1e6", "P = [1e6, 2e6]")
    words = faults_of(tmp_path, "[tolerances]\nload.1.P = { from = 1e5, to = 9e6 }", case)
    assert "a load with several points is varied by a factor, such as loads.P" in words
    assert len(study_of(tmp_path, '[tolerances]\n"loads.P" = { from = 0.5, to = 2.0 }\n', case).corners) == 2


def test_the_corners_of_many_fields_are_refused_unless_they_are_left_out(tmp_path: Path):
    fields = (
        "contact.friction = { from = 0.0, to = 0.1 }\ncontact.clearance = { from = 0.0, to = 1e-5 }\n"
        "contact.hole_radius = { from = 9e-3, to = 11e-3 }\npin.E = { from = 1e11, to = 3e11 }\n"
        "pin.nu = { from = 0.2, to = 0.4 }\nplate.E = { from = 5e10, to = 8e10 }\nplate.nu = { from = 0.2, to = 0.4 }\n"
        "load.1.P = { from = 0.5e6, to = 2e6 }\nload.1.Q = { from = -1e5, to = 1e5 }\n"
        "load.1.sxx = { from = -1e6, to = 1e6 }\n"
        '"loads.P" = { from = 0.9, to = 1.1 }\n'
    )
    case = CASE.replace("P = 1e6", "P = 1e6\nQ = 0.0\nsxx = 0.0")
    assert fields.count("from") == MOST_FIELDS + 1
    words = faults_of(tmp_path, f"[tolerances]\n{fields}", case)
    assert "11 fields have 2,048 corners, and those of at most 10 fields are run: write corners = false" in words
    study = study_of(tmp_path, f"samples = 3\ncorners = false\n[tolerances]\n{fields}", case)
    assert (len(study.corners), len(study.samples)) == (0, 3)


def test_files_and_kinds_of_plans_are_told_apart(tmp_path: Path):
    (tmp_path / "plan.toml").write_text("[grid]\ncontact.friction = [0.1]\n")
    with pytest.raises(CaseFileError, match="is a plan, not a tolerance plan; see fastpin sweep"):
        read_tolerances(tmp_path / "plan.toml")
    with pytest.raises(CaseFileError, match="is a tolerance plan, not a plan; see fastpin tolerances"):
        parse_plan("[tolerances]\ncontact.friction = { from = 0.1, to = 0.6 }\n")
    study = parse_tolerances("samples = 1\n[tolerances]\ncontact.friction = { from = 0.1, to = 0.6 }\n")
    assert repr(study) == "<Tolerances of contact.friction: 2 corners, 1 samples>"
    with pytest.raises(InputError, match="is a class, which has no swing"):
        study.with_outcomes({"r": {"quantity": "regime"}})
    assert [*study.with_outcomes({"turn": {"quantity": "rotation"}}).plan.outcomes][-1] == "turn"


def test_values_that_the_nodes_do_not_resolve_are_counted(tmp_path: Path):
    text = "[tolerances]\ncontact.friction = { from = 0.0, to = 0.4 }\n[outcomes]\nhoop = { quantity = 'peak_hoop' }\n"
    study = study_of(tmp_path, text)
    given = {"status": "done", "reason": None, "dimensionless": 0}
    rows = [given | point.values | {"id": point.id, "hoop": 1e8} for point in study.plan.points]
    rows[1]["hoop_bar"], rows[0]["hoop_bar"] = math.inf, 1e6
    assert report.tolerances.document(study, rows)["outcomes"]["hoop"]["unresolved"] == 1
    words = "1 runs have a value that the nodes do not resolve"
    assert words in report.tolerances.text(study, rows)
    del rows[1]["hoop_bar"]
    assert words not in report.tolerances.text(study, rows)
