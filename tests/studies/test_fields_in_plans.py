"""Bodies, laminates and profiles along the rim in plans, in tolerance plans and in the ids of runs."""

from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, CaseFileError, Material, Problem
from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.casefile import EXAMPLE, parse_case
from fastpin.model import Laminate
from fastpin.model.angles import angle_at
from fastpin.model.keys import kind_of
from fastpin.report.sweep import text as sweep_text
from fastpin.studies import parse_tolerances
from fastpin.studies.identity import canonical, canonical_json, run_id
from fastpin.studies.plan import Plan
from fastpin.studies.variation import field_words
from tests.support.bodies import soft_plate
from tests.support.body_texts import HEAD as CASE
from tests.support.case_texts import PRESSED
from tests.support.faults import fault_of
from tests.support.plans import planned

RING = CASE + '[plate_body]\nkind = "ring"\nouter_radius = 2e-2\nsupport = "half"\n'
BUSH = CASE + '[plate_body]\nmaterial = "steel"\nouter_radius = 12e-3\nring_outer_radius = 2e-2\nsupport = "half"\n'


def problems(folder: Path, base: str, text: str) -> list[Problem]:
    plan = planned(folder, base, text)
    return [plan.case(point).problem for point in plan.points]


def identity(bodies: str, folder: Path | str = ".", case: str = CASE) -> str:
    return run_id(canonical(parse_case(case + bodies, folder=folder)), "1.0")


def test_a_grid_of_bores_and_rings(tmp_path):
    found = problems(
        tmp_path,
        CASE,
        '[grid]\npin_body.bore_radius = {from = 2e-3, to = 8e-3, count = 3}\n"plate_body.outer_radius" = [2e-2, 3e-2]\n'
        'plate_body.support = ["held", "half"]\n',
    )
    assert len(found) == 12
    assert {one.pin_body for one in found} == {Tube(2e-3), Tube(5e-3), Tube(8e-3)}
    assert {one.plate_body for one in found} == {Ring(r, s) for r in (2e-2, 3e-2) for s in ("held", "half")}


def test_a_list_of_different_bodies(tmp_path):
    (tmp_path / "lug.json").write_text(soft_plate().to_text())
    rows = [
        'plate_body.kind = "plate"',
        'plate_body.outer_radius = 3e-2\nplate_body.support = "held"',
        'plate_body.kind = "bushing"\nplate_body.material = "steel"\nplate_body.outer_radius = 12e-3',
        'plate_body.file = "lug.json"',
        "plate_body = {kind = 'plate', reaction = [0.0, 0.06]}",
    ]
    bodies = [Plate(), Ring(3e-2, "held"), Bushing(MATERIALS["steel"], 12e-3), soft_plate(), Plate((0.0, 0.06))]
    found = problems(tmp_path, RING, "".join(f"[[list]]\n{row}\n" for row in rows))
    assert [one.plate_body for one in found] == bodies


@pytest.mark.parametrize(
    ("base", "fields", "body"),
    [
        (RING, 'plate_body.kind = "plate"', Plate()),
        (RING, 'plate_body.support = "held"', Ring(2e-2, "held")),
        (RING, 'plate_body.file = "lug.json"', soft_plate()),
        (CASE + '[plate_body]\nkind = "compliance"\nfile = "x.json"\n', "plate_body.outer_radius = 3e-2", Ring(3e-2)),
        (CASE + '[plate_body]\nfile = "x.json"\n', "plate_body.reaction = [0.05, 0.0]", Plate((0.05, 0.0))),
        (CASE + '[plate_body]\nfile = "x.json"\n', 'plate_body.kind = "plate"', Plate()),
        (BUSH, 'plate_body.kind = "ring"\nplate_body.outer_radius = 3e-2', Ring(3e-2)),
        (BUSH, 'plate_body.kind = "bushing"', Bushing(MATERIALS["steel"], 12e-3, inside=Ring(2e-2, "half"))),
        (BUSH, "plate_body.interference = 1e-5", Bushing(MATERIALS["steel"], 12e-3, 1e-5, Ring(2e-2, "half"))),
        (BUSH, "plate_body.E = 110e9", Bushing(Material(110e9, 0.3), 12e-3, inside=Ring(2e-2, "half"))),
        (BUSH, "plate_body.reaction = [0.05, 0]", Bushing(MATERIALS["steel"], 12e-3, inside=Plate((0.05, 0.0)))),
        (
            BUSH.replace('ring_outer_radius = 2e-2\nsupport = "half"', "reaction = [0.05, 0]"),
            "plate_body.ring_outer_radius = 3e-2",
            Bushing(MATERIALS["steel"], 12e-3, inside=Ring(3e-2)),
        ),
    ],
)
def test_one_kind_of_body_replaces_the_others(base, fields, body, tmp_path):
    (tmp_path / "lug.json").write_text(soft_plate().to_text())
    (found,) = problems(tmp_path, base, f"[[list]]\n{fields}\n")
    assert found.plate_body == body


def test_a_solid_pin_replaces_a_hollow_one(tmp_path):
    base = CASE + '[pin_body]\nbore_radius = 5e-3\nload = "held"\n'
    text = '[[list]]\npin_body.kind = "disk"\n[[list]]\npin_body.bore_radius = 2e-3\n'
    assert [one.pin_body for one in problems(tmp_path, base, text)] == [Disk(), Tube(2e-3, "held")]


def test_ids_without_bodies_are_as_before_there_were_bodies():
    driven = EXAMPLE.replace('pin_load = "body"  ', 'pin_load = "centre"').replace(
        '# drive = "force" ', 'drive = "ux" '
    )
    driven = driven.replace("# gauge_radius", "gauge_radius")
    driven = driven.replace("Q = [7.26e5, -7.26e5, 7.26e5]", "ux = [1e-6, -1e-6]")
    ids = [run_id(canonical(parse_case(text)), "1.0") for text in (EXAMPLE, driven)]
    assert ids == ["cc97d62acccda339", "3e083727abdf57d0"]
    assert not {"pin_body", "plate_body"} & set(canonical(parse_case(EXAMPLE)))
    assert identity('[pin_body]\nkind = "disk"\n[plate_body]\nkind = "plate"\n') == identity("")


def test_every_number_of_a_body_is_another_run():
    bush = "[plate_body]\nE = 110e9\nnu = 0.34\nouter_radius = 12e-3\n"
    texts = [
        "",
        "[pin_body]\nbore_radius = 5e-3\n",
        "[pin_body]\nbore_radius = 5.000000000000001e-3\n",
        '[pin_body]\nbore_radius = 5e-3\nload = "held"\n',
        "[plate_body]\nouter_radius = 2e-2\n",
        '[plate_body]\nouter_radius = 2e-2\nsupport = "half"\n',
        "[plate_body]\nreaction = [0.0, 0.06]\n",
        "[plate_body]\nreaction = [0.06, 0.0]\n",
        bush,
        bush.replace("110", "111"),
        bush + "interference = 1e-6\n",
        bush + "friction = 0.2\nbonded = false\n",
        bush + "friction = 0.3\nbonded = false\n",
        bush + "ring_outer_radius = 2e-2\n",
        bush + "reaction = [0.0, 0.06]\n",
    ]
    assert len({identity(text) for text in texts}) == len(texts)


def test_spelling_and_names_make_no_other_run():
    assert identity("[plate_body]\nreaction = [0, 0.06]\n") == identity("[plate_body]\nreaction = [-0.0, 60e-3]\n")
    named = '[plate_body]\nmaterial = "steel"\nouter_radius = 12e-3\n'
    assert identity(named) == identity(named.replace('material = "steel"', "E = 210e9\nnu = 0.3"))


def test_a_compliance_enters_by_its_numbers(tmp_path):
    names = {
        "a": soft_plate(),
        "b": soft_plate(made_by="by hand"),
        "c": soft_plate(0.26),
        "d": soft_plate(columns={"sxx": np.ones(18)}),
    }
    ids = {}
    for name, body in names.items():
        (tmp_path / f"{name}.json").write_text(body.to_text())
        ids[name] = identity(f'[plate_body]\nfile = "{name}.json"\n', tmp_path)
    assert ids["a"] == ids["b"]
    assert len(set(ids.values())) == 3
    case = parse_case(CASE + '[plate_body]\nfile = "a.json"\n', folder=tmp_path)
    assert len(canonical_json(canonical(case))) < 1000


def test_fields_of_bodies_have_their_units(tmp_path):
    plan = planned(
        tmp_path,
        BUSH,
        "[grid]\npin_body.bore_radius = [5e-3]\nplate_body.outer_radius = [12e-3]\nplate_body.interference = [2e-6]\n"
        'plate_body.E = [110e9]\nplate_body.support = ["held"]\nplate_body.friction = [0.2]\n'
        'plate_body.bonded = [false]\ncontact.rotation = ["free"]\nload.1.P = [2e6]\n',
    )
    rows = [{"id": point.id, **point.values, "status": "to do", "dimensionless": False} for point in plan.points]
    head, unit, numbers = sweep_text(plan, rows).splitlines()[:3]
    units = {}
    for name in plan.fields:  # columns are as wide as their names, and flush right
        stop = head.index(name) + len(name)
        cell = unit[stop - len(name) : stop].split()
        units[name] = f"{numbers[stop - len(name) : stop].split()[0]} {cell[0] if cell else ''}".strip()
    assert units == {
        "pin_body.bore_radius": "5 mm",
        "plate_body.outer_radius": "12 mm",
        "plate_body.interference": "2 um",
        "plate_body.E": "110 GPa",
        "plate_body.support": "held",
        "plate_body.friction": "0.2",
        "plate_body.bonded": "false",
        "contact.rotation": "free",
        "load.1.P": "2 MN/m",
    }


HEAD = '[pin]\nmaterial = "steel"\n[plate]\n'
TAIL = '\n[contact]\nplane = "stress"\nhole_radius = 3e-3\nclearance = 2e-5\nfriction = 0.2\n[[load]]\nP = 1e6\n'
LAYUP = 'layup = "[0/45/-45/90]2s"\nply = "T300/5208"'
COMPLIANCE = (2e-11, 0.0, 3e-11, 0.0, 0.0, 6e-11)
MODULI = "E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25"


def plates(folder: Path, keys: str, plan: str) -> list[Laminate]:
    return [problem.pair.plate for problem in problems(folder, HEAD + keys + TAIL, plan)]  # type: ignore[misc]


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


def test_an_id_tells_all_of_a_laminate_that_results_depend_on() -> None:
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
    assert len({identity(TAIL, case=HEAD + each) for each in keys}) == len(keys)


def test_an_id_does_not_depend_on_the_spelling_of_a_laminate() -> None:
    own = "{ E1 = 1e11, E2 = 1e10, G12 = 5e9, nu12 = 0.3, thickness = 1e-4"
    plain = f'layup = "[0/90]s"\nply = {own} }}'
    named = f'layup = "[ 0 / 90_2 / 0 ]"\nply = {own}, name = "mine", source = "tests" }}\naxis = 0'
    assert identity(TAIL, case=HEAD + plain) == identity(TAIL, case=HEAD + named)
    assert '"plate":{"axis":' in canonical_json(canonical(parse_case(HEAD + MODULI + TAIL)))


def test_words_of_the_fields_of_a_laminate() -> None:
    assert field_words("plate.axis") == "axis (deg) of the plate"
    assert field_words("plate.E1") == "modulus E1 of the plate"
    assert (kind_of("plate.E1"), kind_of("plate.axis")) == ("modulus", "")


GAP = "\n[gap]\nhole = { ellipse = 1e-5, axis = 45 }\n"
ZONES = PRESSED.replace("friction = 0.3", "friction = [0.3, { zone = 0.2, start = -30, stop = 30 }]")


def terms(found: Plan, name: str = "gap.hole") -> list[object]:
    profiles = [found.case(point).problem.profiles for point in found.points]
    return [each[name].toml() if name in each else None for each in profiles]


def test_the_size_of_an_oval_is_an_axis(tmp_path: Path) -> None:
    found = planned(tmp_path, PRESSED + GAP, "[grid]\ngap.hole.ellipse = [0.0, 1e-5, 2e-5]\n")
    assert [*found.axes] == ["gap.hole.ellipse"]
    oval = {"harmonic": 2, "cosine": 0.0}
    assert terms(found) == [None, [{**oval, "sine": 1e-5}], [{**oval, "sine": 2e-5}]]
    without = planned(tmp_path, PRESSED, '[grid]\n"gap.hole.ellipse" = { from = 0.0, to = 1e-5, count = 2 }\n')
    assert terms(without) == [None, [{"harmonic": 2, "cosine": 1e-5, "sine": 0.0}]]
    assert without.points[0].id == found.points[0].id


def test_a_term_of_a_list_is_varied_by_its_number(tmp_path: Path) -> None:
    text = "[grid]\ncontact.friction.2.zone = [0.1, 0.2]\ncontact.friction.2.stop = [10, 20]\n"
    found = planned(tmp_path, ZONES, text)
    zones = [profile[1] for profile in terms(found, "contact.friction")]  # type: ignore[index]
    assert [(zone["zone"], zone["start"], zone["stop"]) for zone in zones] == [
        (0.1, -30.0, 10.0), (0.1, -30.0, 20.0), (0.2, -30.0, 10.0), (0.2, -30.0, 20.0),
    ]  # fmt: skip


def test_other_kinds_of_terms_and_whole_profiles_are_listed(tmp_path: Path) -> None:
    text = """
    [[list]]
    gap.pin = { flat = 1e-5, centre = -90 }
    [[list]]
    gap.pin = 1e-6
    [[list]]
    gap.pin = { crown = -1e-6, centre = 0, half_width = 20 }
    """
    found = planned(tmp_path, PRESSED + "\n[gap]\npin = { ellipse = 1e-6, axis = 3 }\n", text)
    assert [next(iter(profile[0])) for profile in terms(found, "gap.pin")] == ["flat", "constant", "crown"]  # type: ignore[index]
    numbers = planned(tmp_path, ZONES, "[grid]\ncontact.friction = [0.1, 0.2]\n")
    assert [numbers.case(point).problem.friction for point in numbers.points] == [0.1, 0.2]


FAULTS = {
    "gap.hole.ellipse = [1e-5, 5e-3]": "gap.hole.ellipse: is too large for small strains: must lie within 0.001, a "
    "tenth of the hole radius, not 0.005 (in the run gap.hole.ellipse = 0.005)",
    "gap.hole.axis = [0, 1.5708]": "gap.hole.axis: must be in degrees from the bottom of the hole; 1.5708 is 90 "
    "degrees in rad (in the run gap.hole.axis = 1.5708)",
    "gap.hole.oval = [1e-5]": '"gap.hole.oval": there is no key "oval" in a profile, did you mean "ellipse"?',
    "gap.hole.2.axis = [0]": '"gap.hole.2.axis": the hole of the case has no terms in a list, counted from 1',
    "contact.friction.zone = [0.1]": "contact.friction.zone: start is missing beside zone",
}


@pytest.mark.parametrize("line", FAULTS)
def test_a_wrong_axis_is_explained(tmp_path: Path, line: str) -> None:
    assert fault_of(planned, tmp_path, PRESSED + GAP, f"[grid]\n{line}\n") == (3, FAULTS[line])


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("friction", "is a list; write the number of the term, such as contact.friction.1.axis"),
        ("friction.3", "the friction of the case has 2 terms in a list, counted from 1"),
    ],
)
def test_a_list_needs_the_number_of_the_term(tmp_path: Path, field: str, words: str) -> None:
    assert words in fault_of(planned, tmp_path, ZONES, f"[grid]\ncontact.{field}.zone = [0.1]\n")[1]


def test_axes_have_words_and_units() -> None:
    assert field_words("gap.hole.ellipse") == "oval of the hole"
    assert field_words("contact.friction.2.stop") == "stop (deg) of the friction, term 2"
    assert (kind_of("gap.pin.flat"), kind_of("gap.pin.centre"), kind_of("gap.hole")) == (
        "displacement", "", "displacement",
    )  # fmt: skip
