"""Joints with many nodes: tables of the interfaces and a small system between them give the states of one tableau."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fastpin import Material, MaterialPair
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, solve_joint, system
from fastpin.joints.conditions import CENTRING
from fastpin.joints.ports import Ports
from fastpin.kernels import exchange, ports
from fastpin.lugs.outline import rectangle
from fastpin.solver import held, path
from tests.support.kernels import run_as_python

pytestmark = pytest.mark.gate

ALUMINIUM, STEEL = Material(72e9, 0.33), Material(210e9, 0.30)
FORCE = 1e6
UNIT = MaterialPair(STEEL, ALUMINIUM, "stress").beta_star * FORCE
SHEETS = (
    JointPlate("thick", ALUMINIUM, 1.0),
    JointPlate("thin", ALUMINIUM, 0.6, rectangle((-4.0, 15.0), (-4.0, 7.0)), moves="free"),
)


def joint_of(clearances: tuple[float, ...], friction: tuple[float, ...]) -> Joint:
    """Pins through two sheets, the last one through one. Clearances are in units of F beta*."""
    pins = []
    for k, (clearance, mu) in enumerate(zip(clearances, friction, strict=True)):
        through = ("thick",) if k == len(clearances) - 1 else ("thick", "thin")
        pins.append(
            JointPin(f"p{k}", 4.5 * k + 0.5j * k * k, STEEL, 1.0, through, clearance * UNIT, mu, 0.1 * UNIT / FORCE)
        )
    return Joint(SHEETS, tuple(pins))


CORNERS = [
    {"p0.x": FORCE, "p1.y": -0.7 * FORCE, "p2.x": 0.5 * FORCE, "thick.sxx": 0.1 * FORCE},
    {"p0.x": -0.2 * FORCE, "p1.y": -0.1 * FORCE},
    {"p0.x": FORCE, "p1.y": -0.7 * FORCE},
]


def solved(monkeypatch: pytest.MonkeyPatch, joint: Joint, few: int, drift: float = 1e-12) -> JointResult:
    """The states of a joint, of which so `few` nodes are few."""
    with monkeypatch.context() as patch:
        for module, name in ((held, "FEW_NODES"), (path, "FEW_NODES"), (system, "LARGEST_DENSE")):
            patch.setattr(module, name, few)
        patch.setattr(path, "MOST_DRIFT", drift)
        return solve_joint(joint, CORNERS, nodes=24, harmonics=6)


@pytest.mark.parametrize(
    ("clearances", "friction"),
    [
        ((0.05, 0.1, 0.02), (0.3, 0.3, 0.3)),
        ((0.1, 0.1, 0.1), (0.0, 0.0, 0.0)),
        ((-0.1, 0.2, 0.0), (0.2, 0.0, 0.5)),
    ],
)
def test_many_nodes_have_the_states_of_few(
    monkeypatch: pytest.MonkeyPatch, clearances: tuple[float, ...], friction: tuple[float, ...]
) -> None:
    joint = joint_of(clearances, friction)
    few, many = (solved(monkeypatch, joint, count) for count in (1_000, 0))
    assert many.snaps == few.snaps
    for corner, (one, other) in enumerate(zip(few, many, strict=True)):
        near = 1e-13 / CENTRING if few.snaps and corner > 0 else 1e-9  # beyond a snap springs have placed a pin
        np.testing.assert_allclose(other.forces, one.forces, atol=near * FORCE)
        for contact, same in zip(one.contacts, other.contacts, strict=True):
            size = contact.pressure.max()
            np.testing.assert_array_equal(same.status, contact.status)
            np.testing.assert_allclose(same.pressure, contact.pressure, atol=near * size)
            np.testing.assert_allclose(same.shear, contact.shear, atol=near * size)
            np.testing.assert_allclose(same.slip, contact.slip, atol=near * UNIT)


def test_a_tableau_is_built_anew_where_it_has_lost_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    joint = joint_of((0.05, 0.1, 0.02), (0.3, 0.3, 0.3))
    once, often = (solved(monkeypatch, joint, 0, drift) for drift in (1e-10, 0.0))
    for one, other in zip(once, often, strict=True):
        np.testing.assert_allclose(other.forces, one.forces, atol=1e-8 * FORCE)


def test_plain_python_follows_the_same_states(monkeypatch: pytest.MonkeyPatch) -> None:
    joint = joint_of((0.05, 0.1, 0.02), (0.3, 0.3, 0.3))
    compiled = solved(monkeypatch, joint, 0)
    for kernels in (ports, exchange):
        run_as_python(kernels, monkeypatch)
    for one, other in zip(compiled, solved(monkeypatch, joint, 0), strict=True):
        np.testing.assert_allclose(other.forces, one.forces, atol=1e-12 * FORCE)
        for contact, same in zip(one.contacts, other.contacts, strict=True):
            np.testing.assert_array_equal(same.status, contact.status)


def test_the_operator_of_ports_has_the_entries_of_its_products(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Ports] = []

    def ports_of(*given: Any) -> Ports:
        made.append(Ports(*given))
        return made[-1]

    monkeypatch.setattr(system, "Ports", ports_of)
    solved(monkeypatch, joint_of((0.05, 0.1, 0.02), (0.3, 0.3, 0.3)), 0)
    operator = made[0]
    whole = operator.entries()
    given = np.cos(np.arange(2.0 * operator.size)).reshape(operator.size, 2)
    np.testing.assert_allclose(operator @ given, whole @ given, atol=1e-12 * np.abs(whole).max())
    np.testing.assert_allclose(operator @ given[:, 0], whole @ given[:, 0], atol=1e-12 * np.abs(whole).max())
    np.testing.assert_allclose(operator.diagonal(), np.diagonal(whole), rtol=1e-12)
    rows, columns = np.array([3, 100, 7]), np.array([90, 2])
    np.testing.assert_allclose(operator.entries(rows, columns), whole[np.ix_(rows, columns)], rtol=1e-12)
