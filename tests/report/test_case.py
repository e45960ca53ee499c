"""Descriptions of cases."""

from __future__ import annotations

from fastpin.casefile.reader import parse_case
from fastpin.report.case import describe


def test_description_of_other_kinds_of_cases() -> None:
    text = """
    [dundurs]
    alpha = 1.0
    beta = 0.3
    nu_pin = 0.3
    [contact]
    load_parameter = 0.05
    friction = 0.4
    rotation = "fixed"
    hub_radius = 1.0
    [[load]]
    P = 1
    [[load]]
    P = 0
    """
    said = describe(parse_case(text))
    for words in ("rigid", "load parameter 0.05", "rotation fixed at radius 1 R", "dimensionless"):
        assert words in said
    assert said.splitlines()[-1].split() == ["2", "0", "-"]
