"""Joints at random: the conditions of contact and equilibrium hold in every state, or no state is returned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fastpin import Material, MaterialPair, SolveError
from fastpin.bodies import Bushing
from fastpin.joints import Clamp, Joint, JointPin, JointPlate, JointState, solve_joint
from fastpin.kernels.status import STICK
from fastpin.lugs.outline import rectangle
from fastpin.model import Profile
from tests.support.tiers import seeds

MATERIALS = (Material(72e9, 0.33), Material(210e9, 0.30), Material(110e9, 0.31))
FORCE = 1e6


SHEET = JointPlate("sheet", MATERIALS[0], 1.0)
COVER = JointPlate("cover", MATERIALS[0], 0.7, rectangle((-4.0, 15.0), (-4.0, 5.0)), moves="free")


def random_joint(rng: np.random.Generator) -> tuple[Joint, list[dict[str, float]]]:
    """Three pins in a sheet, with a free cover, clamped or not, or without: all fits, directions and signs of loads."""
    material, covered = MATERIALS[rng.integers(3)], bool(rng.random() < 0.7)
    unit = MaterialPair(material, SHEET.material, "stress").beta_star * FORCE
    pins = []
    for k, at in enumerate((0.0, 5.0 - 0.5j, 11.0 + 1.0j)):
        through = ("sheet", "cover") if covered and (k != 1 or rng.random() < 0.7) else ("sheet",)
        fits = {name: float(rng.choice([-0.1, 0.0, 0.02, 0.1, 0.3])) * unit for name in through}
        friction = float(rng.choice([0.0, 0.2, 0.6]))
        soft = float(rng.choice([0.0, 0.2])) * unit / FORCE
        pins.append(JointPin(f"p{k}", at, material, 1.0, through, fits, friction, soft))
    joint = Joint((SHEET, COVER) if covered else (SHEET,), tuple(pins))
    names = [name for name in joint.load_names if rng.random() < 0.6]
    sizes = {name: FORCE * (0.2 if joint.load_kind(name) == "traction" else 1.0) for name in names}
    corners = [{name: float(rng.uniform(-1.0, 1.0)) * size for name, size in sizes.items()} for _ in range(3)]
    clamps = [Clamp(float(rng.choice([0.5, 2.0, 8.0])) * FORCE, float(rng.choice([0.0, 0.1, 0.5]))) for _ in pins]
    if rng.random() < 0.5:
        pins = [
            replace(pin, clamp=clamp) if len(pin.plates) == 2 else pin for pin, clamp in zip(pins, clamps, strict=True)
        ]
        joint = replace(joint, pins=tuple(pins))
    return joint, corners


def random_bushes(rng: np.random.Generator) -> tuple[Joint, list[dict[str, float]]]:
    """The same with a bush round each pin in some plates: press fits, clearances and all frictions, also bonded."""
    joint, corners = random_joint(rng)
    unit = MaterialPair(MATERIALS[1], SHEET.material, "stress").beta_star * FORCE
    bushed = [plate.name for plate in joint.plates if rng.random() < 0.7]
    pins = []
    for pin in joint.pins:
        bushes = {}
        for plate in (name for name in pin.plates if name in bushed):
            material, fit = MATERIALS[rng.integers(3)], float(rng.choice([-0.1, 0.0, 0.1, 0.3, 2.0])) * unit
            is_bonded = bool(fit > unit and rng.random() < 0.5)
            friction = None if is_bonded else float(rng.choice([0.0, 0.15, 0.5]))
            bushes[plate] = Bushing(material, 1.2, fit, friction=friction, bonded=is_bonded)
        pins.append(replace(pin, bush=bushes))
    return replace(joint, pins=tuple(pins)), corners


def random_gaps(rng: np.random.Generator) -> tuple[Joint, list[dict[str, float]]]:
    """The same without bushes, with lobes of holes: small, or with bumps beyond the clearance."""
    joint, corners = random_joint(rng)
    unit = MaterialPair(MATERIALS[1], SHEET.material, "stress").beta_star * FORCE
    lobes = [
        (int(rng.integers(2, 6)), float(rng.choice([0.0, 0.02, 0.2])) * unit, float(rng.uniform())) for _ in range(3)
    ]
    pins = [replace(pin, gap=Profile.lobes(*each)) for pin, each in zip(joint.pins, lobes, strict=True)]
    return replace(joint, pins=tuple(pins)), corners


LAYOUTS = (
    (0.0, 6.0),
    (0.0, 5.0 - 0.5j, 11.0 + 1.0j),
    (0.0, 5.0, 5.0j, 5.0 + 5.0j),
    (0.0, 5.0, 10.0, 15.0, 20.0),
    (0.0, 5.0, 10.0, 5.0j, 5.0 + 5.0j, 10.0 + 5.0j),
)
"""Places of two to six pins, in rows and patterns."""


def random_straps(rng: np.random.Generator) -> tuple[Joint, list[dict[str, float]]]:
    """Two to six pins in straps, in single or double shear: all fits, loads of pins and straps, also reversed ones."""
    layout = LAYOUTS[rng.integers(5)]
    (left, right), y = (-4.0, float(np.real(layout).max()) + 4.0), (-5.0, 9.0)
    skin = JointPlate("skin", MATERIALS[0], 1.0, rectangle((left - 4.0, right), y), {"left": "both"})
    strap = JointPlate("strap", MATERIALS[1], 0.6, rectangle((left, right + 4.0), y), {"right": "both"}, moves="x")
    plates = (skin, strap) if rng.random() < 0.5 else (replace(strap, name="below"), skin, strap)
    material = MATERIALS[rng.integers(3)]
    unit = MaterialPair(material, MATERIALS[0], "stress").beta_star * FORCE
    pins = []
    for k, at in enumerate(layout):
        fits = {plate.name: float(rng.choice([-0.1, 0.0, 0.02, 0.1, 0.3])) * unit for plate in plates}
        friction, soft = float(rng.choice([0.0, 0.2, 0.6])), float(rng.choice([0.0, 0.2])) * unit / FORCE
        pins.append(JointPin(f"p{k}", at, material, 1.0, tuple(fits), fits, friction, soft))
    joint = Joint(plates, tuple(pins))
    names = [name for name in joint.load_names if name.startswith("strap") or rng.random() < 0.3]
    first, other = ({name: float(rng.uniform(-1.0, 1.0)) * FORCE for name in names} for _ in range(2))
    back = {name: float(rng.choice([-1.0, 0.0])) * first[name] for name in names}
    return joint, [first, back if rng.random() < 0.5 else other, first]


def check_state(state: JointState) -> None:
    """Check Coulomb's law, the unilateral contact and the balance of pins and plates, from the arrays alone."""
    joint = state.joint
    for whole in state.contacts:
        for contact in filter(None, (whole, whole.seat)):
            friction = float(contact.problem.friction)  # type: ignore[arg-type]
            assert contact.pressure.min() >= 0.0
            assert contact.gap.min() >= 0.0
            assert np.all(contact.pressure * contact.gap == 0.0)
            excess = np.abs(contact.shear) - friction * contact.pressure
            assert excess.max() <= 1e-9 * max(contact.pressure.max(), 1.0)
        if whole.seat is not None:  # the balance of the bush
            passed, own = whole.seat.resultants, whole.resultants
            np.testing.assert_allclose([passed[name] for name in own], [*own.values()], atol=1e-4 * FORCE)
            assert whole.problem.bush_slips or (whole.seat.status == STICK).all()
    for pin in joint.pins:
        places = [place for place, (of, _) in enumerate(joint.sections) if of is pin]
        given = [state.load[f"{pin.name}.x"], state.load[f"{pin.name}.y"]]
        # Springs that hold loose pins take 1e-6 of a displacement.
        np.testing.assert_allclose(state.forces[places].sum(axis=0), given, atol=1e-4 * FORCE)
    for plate in joint.plates:
        passed = sum(force for (_, of), force in zip(joint.sections, state.forces, strict=True) if of is plate)
        for surface, at in zip(joint.faying, state.faying, strict=True):
            passed = passed + at.force * ((surface.plate == plate.name) - (surface.other == plate.name))
        for place, axis in enumerate("xy"):
            if plate.moves in ("free", axis):
                assert abs(passed[place] + state.load.get(f"{plate.name}.{axis}", 0.0)) <= 1e-4 * FORCE
    for surface, at in zip(joint.faying, state.faying, strict=True):
        assert np.hypot(*at.force) <= 1.02 * surface.clamp.limit + 1e-4 * FORCE
    assert max(state.residuals.values()) <= 1e-9


@pytest.mark.gate
@pytest.mark.parametrize(
    ("draw", "count"), [(random_joint, 6), (random_straps, 2), (random_bushes, 3), (random_gaps, 2)]
)
def test_random_joints_meet_all_conditions_or_are_refused(draw: Callable[..., Any], count: int) -> None:
    refused, tried = 0, 0
    for seed in seeds(count):
        joint, corners = draw(np.random.default_rng(seed))
        tried += 1
        try:
            result = solve_joint(joint, corners, nodes=24, harmonics=6)
        except SolveError as error:
            refused += 1
            result = error.result  # type: ignore[assignment]
            assert result is not None
        for state in result:
            check_state(state)
    assert refused <= max(1, tried // 10), (refused, tried)


@pytest.mark.gate
@pytest.mark.parametrize("seed", [79, 191, *(pytest.param(seed, marks=pytest.mark.survey) for seed in (284, 996))])
def test_pins_that_only_weak_springs_press_let_go(seed: int) -> None:
    """Where both edges that a loose pin touches come nearer, it must go back a little."""
    joint, corners = random_joint(np.random.default_rng(seed))
    result = solve_joint(joint, corners, nodes=24, harmonics=6)
    assert result.snaps
    for state in result:
        check_state(state)


@pytest.mark.gate
def test_many_press_fits_begin_beside_a_neat_bush() -> None:
    """Implicit increments from sticking nodes find no first contact."""
    joint, corners = random_bushes(np.random.default_rng(307))
    (state,) = solve_joint(joint, corners[:1], nodes=16, harmonics=6)
    check_state(state)


@pytest.mark.gate
def test_a_neat_joint_with_friction_is_unloaded_after_reversed_loads() -> None:
    """Without loads the tractions are zero up to rounding."""
    strap = JointPlate("strap", MATERIALS[0], 1.0, rectangle((-4.0, 15.0), (-4.0, 4.0)), {"right": "both"}, moves="x")
    skin = replace(strap, name="skin", supports={"left": "both"}, moves="")
    pins = tuple(JointPin(f"p{k}", 6.0 * k + 0j, MATERIALS[1], 1.0, ("skin", "strap"), 0.0, 0.3) for k in range(2))
    loads = [{"strap.x": size * FORCE} for size in (1.0, -1.0, 1.0, 0.0)]
    result = solve_joint(Joint((skin, strap), pins), loads, nodes=24, harmonics=6)
    for state in result:
        check_state(state)
    np.testing.assert_allclose(result[-1].forces, 0.0, atol=1e-8 * FORCE)


@pytest.mark.gate
def test_neat_pins_in_double_shear_are_unloaded() -> None:
    """The path is lost at 5e-9 of the load, which is not yet rounding."""
    lug = JointPlate("lug", MATERIALS[0], 1.0, rectangle((-8.0, 15.0), (-4.5, 5.0)), {"left": "both"})
    strap = JointPlate("strap", MATERIALS[1], 0.5, rectangle((-4.0, 19.0), (-4.5, 5.0)), {"right": "both"}, moves="x")
    plates, soft = (replace(strap, name="below"), lug, strap), 1.838383838383838e-11
    names = tuple(plate.name for plate in plates)
    pins = tuple(JointPin(f"p{k}", at, MATERIALS[2], 1.0, names, 0.0, 0.6, soft) for k, at in enumerate(LAYOUTS[1]))
    load = {"p0.x": 982814.321478122, "p0.y": -576784.5472108342, "p2.x": -179048.83436189967}
    result = solve_joint(Joint(plates, pins), [load, dict.fromkeys(load, 0.0)], nodes=24, harmonics=6)
    for state in result:
        check_state(state)
    np.testing.assert_allclose(result[-1].forces, 0.0, atol=1e-8 * FORCE)
