"""Profiles along the rim as axes of sweeps."""

from pathlib import Path

import pytest

from fastpin.model.keys import kind_of
from fastpin.studies.plan import Plan, parse_plan
from fastpin.studies.variation import field_words
from tests.support.case_texts import PRESSED
from tests.support.faults import fault_of

GAP = "\n[gap]\nhole = { ellipse = 1e-5, axis = 45 }\n"
ZONES = PRESSED.replace("friction = 0.3", "friction = [0.3, { zone = 0.2, start = -30, stop = 30 }]")


def plan(tmp_path: Path, text: str, case: str = PRESSED) -> Plan:
    (tmp_path / "base.toml").write_text(case)
    return parse_plan(f'case = "base.toml"\n{text}', folder=tmp_path)


def terms(found: Plan, name: str = "gap.hole") -> list[object]:
    profiles = [found.case(point).problem.profiles for point in found.points]
    return [each[name].toml() if name in each else None for each in profiles]


def test_the_size_of_an_oval_is_an_axis(tmp_path: Path) -> None:
    found = plan(tmp_path, "[grid]\ngap.hole.ellipse = [0.0, 1e-5, 2e-5]\n", PRESSED + GAP)
    assert [*found.axes] == ["gap.hole.ellipse"]
    oval = {"harmonic": 2, "cosine": 0.0}
    assert terms(found) == [None, [{**oval, "sine": 1e-5}], [{**oval, "sine": 2e-5}]]
    without = plan(tmp_path, '[grid]\n"gap.hole.ellipse" = { from = 0.0, to = 1e-5, count = 2 }\n')
    assert terms(without) == [None, [{"harmonic": 2, "cosine": 1e-5, "sine": 0.0}]]
    assert without.points[0].id == found.points[0].id


def test_a_term_of_a_list_is_varied_by_its_number(tmp_path: Path) -> None:
    found = plan(tmp_path, "[grid]\ncontact.friction.2.zone = [0.1, 0.2]\ncontact.friction.2.stop = [10, 20]\n", ZONES)
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
    found = plan(tmp_path, text, PRESSED + "\n[gap]\npin = { ellipse = 1e-6, axis = 3 }\n")
    assert [next(iter(profile[0])) for profile in terms(found, "gap.pin")] == ["flat", "constant", "crown"]  # type: ignore[index]
    numbers = plan(tmp_path, "[grid]\ncontact.friction = [0.1, 0.2]\n", ZONES)
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
    assert fault_of(plan, tmp_path, f"[grid]\n{line}\n", PRESSED + GAP) == (3, FAULTS[line])


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("friction", "is a list; write the number of the term, such as contact.friction.1.axis"),
        ("friction.3", "the friction of the case has 2 terms in a list, counted from 1"),
    ],
)
def test_a_list_needs_the_number_of_the_term(tmp_path: Path, field: str, words: str) -> None:
    assert words in fault_of(plan, tmp_path, f"[grid]\ncontact.{field}.zone = [0.1]\n", ZONES)[1]


def test_axes_have_words_and_units() -> None:
    assert field_words("gap.hole.ellipse") == "oval of the hole"
    assert field_words("contact.friction.2.stop") == "stop (deg) of the friction, term 2"
    assert (kind_of("gap.pin.flat"), kind_of("gap.pin.centre"), kind_of("gap.hole")) == (
        "displacement", "", "displacement",
    )  # fmt: skip
