"""Bodies in plans and in the ids of runs."""

from pathlib import Path

import numpy as np
import pytest

from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.casefile.reader import EXAMPLE, parse_case
from fastpin.model.materials import MATERIALS, Material
from fastpin.model.problem import Problem
from fastpin.report.sweep import text as sweep_text
from fastpin.studies.identity import canonical, canonical_json, run_id
from fastpin.studies.plan import Plan, parse_plan
from tests.support.bodies import soft_plate
from tests.support.body_texts import HEAD as CASE

RING = CASE + '[plate_body]\nkind = "ring"\nouter_radius = 2e-2\nsupport = "half"\n'
BUSH = CASE + '[plate_body]\nmaterial = "steel"\nouter_radius = 12e-3\nring_outer_radius = 2e-2\nsupport = "half"\n'


def planned(folder: Path, base: str, text: str) -> Plan:
    (folder / "case.toml").write_text(base)
    return parse_plan(f'case = "case.toml"\n{text}', folder=folder)


def problems(folder: Path, base: str, text: str) -> list[Problem]:
    plan = planned(folder, base, text)
    return [plan.case(point).problem for point in plan.points]


def identity(bodies: str, folder: Path | str = ".") -> str:
    return run_id(canonical(parse_case(CASE + bodies, folder=folder)), "1.0")


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
