"""Strategies of hypothesis: valid and odd input in Python, in case files and in plans."""

import dataclasses
import datetime
import json
import math
from decimal import Decimal
from typing import Any

import numpy as np
from hypothesis import strategies as st

import fastpin
from fastpin.cracks import Nasgro, Walker
from fastpin.model import LOADS, InitialGap, Profile
from fastpin.model.angles import DEGREE, angle_at
from fastpin.model.assessment import DISTANCES, MINER_RULES
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.history import Block
from fastpin.model.options import MOST_BETWEEN, SolveOptions
from fastpin.model.profile_terms import Crown, Flat, Harmonic, Samples, Term, Zone

Tables = dict[str, dict[str, Any]]
"""Sections of a case file, without its loads."""


def between(least: float, most: float) -> st.SearchStrategy[float]:
    """Floats from `least` to `most`, without subnormal ones."""
    return st.floats(least, most, allow_nan=False, allow_subnormal=False)


def scale(least: int, most: int) -> st.SearchStrategy[float]:
    """Positive floats over many decades, from 10^least to 10^most."""
    return st.builds(lambda digits, power: digits * 10.0**power, between(1.0, 9.99), st.integers(least, most - 1))


words = st.text(st.characters(exclude_categories=("C", "Zl", "Zp")), max_size=12)
"""Text that a title may have."""

moduli = scale(-3, 14)
ratios = st.one_of(st.sampled_from([0.0, 0.25, 0.3, 0.5]), between(0.0, 0.5))

materials = st.builds(fastpin.Material, moduli, ratios, words) | st.just(fastpin.Material.rigid())


@st.composite
def plies(draw: st.DrawFn) -> fastpin.model.Ply:
    """Plies of any stable constants, some with strengths."""
    first, second, shear = (draw(scale(8, 12)) for _ in range(3))
    ratio = draw(between(-0.9, 0.9)) * math.sqrt(first / second)
    strengths = draw(st.none() | st.builds(fastpin.model.PlyStrengths, *[scale(6, 10)] * 5))
    texts = draw(words), draw(words)
    return fastpin.model.Ply(first, second, shear, ratio, draw(scale(-5, -2)), strengths, *texts)


@st.composite
def laminates(draw: st.DrawFn) -> fastpin.model.Laminate:
    """Laminates of named plies, of other plies or of moduli, with axes that degrees give exactly."""
    axis = draw(angles)
    if draw(st.booleans()):
        ply = draw(plies())
        return fastpin.model.Laminate.from_moduli(ply.E1, ply.E2, ply.G12, ply.nu12, axis)
    one = st.sampled_from(list(fastpin.model.PLIES.values())) | plies()
    kinds = draw(st.lists(one, min_size=1, max_size=3))
    turns = st.sampled_from([0.0, 45.0, -45.0, 90.0]) | between(-90.0, 90.0)
    half = draw(st.lists(st.tuples(st.sampled_from(kinds), turns), min_size=1, max_size=6))
    return fastpin.model.Laminate.from_plies(half + half[::-1], axis)


@st.composite
def pairs(draw: st.DrawFn) -> fastpin.MaterialPair:
    """Two materials. At most one of them is rigid."""
    pin, plate = draw(materials), draw(materials)
    if pin.is_rigid and plate.is_rigid:
        plate = fastpin.MATERIALS["steel"]
    return fastpin.MaterialPair(pin, plate, draw(st.sampled_from(["strain", "stress"])))


def degrees(least: float, most: float) -> st.SearchStrategy[float]:
    """Angles in degrees that no case file takes for rad: not a little beside 15, 30, 45 ... degrees in rad."""
    return between(least, most).filter(lambda angle: abs(math.remainder(angle, 15.0 * DEGREE)) > 0.01)


angles = degrees(-180.0, 180.0).map(angle_at)
"""Angles round the hole, rad, that degrees from its bottom give exactly."""

spans = degrees(1.0, 179.0).map(lambda angle: angle * DEGREE)
"""Differences of angles, rad, that degrees give exactly."""


def zones(most: float) -> st.SearchStrategy[Term]:
    """Zones in which a quantity that is positive elsewhere is larger by up to `most`."""
    degrees = between(-180.0, 180.0), between(1.0, 170.0)
    return st.builds(
        lambda value, at, more: Zone(value, angle_at(at), angle_at(at + more)), between(0.0, most), *degrees
    )


@st.composite
def samples(draw: st.DrawFn, least: float, most: float) -> Samples:
    """Samples round the hole, each from `least` to `most`."""
    heights = draw(st.lists(between(least, most), min_size=4, max_size=9))
    first = draw(between(-180.0, 0.0))
    return Samples([angle_at(first + k * 360.0 / len(heights)) for k in range(len(heights))], heights)


@st.composite
def gaps(draw: st.DrawFn, size: float, has_lengths: bool) -> InitialGap:
    """Initial gaps of hole and pin of the order of `size`. A flat needs lengths."""
    waves = st.builds(Harmonic, st.integers(0, 30), between(-size, size), between(-size, size))
    crowns = st.builds(Crown, between(-size, size), angles, spans)
    kinds = [waves, waves, crowns, samples(-size, size)]
    if has_lengths:
        kinds.append(st.builds(Flat, between(1e-3 * size, size), angles))
    profiles = st.lists(st.one_of(kinds), max_size=3).map(lambda terms: Profile(tuple(terms)))
    return InitialGap(draw(profiles), draw(profiles))


@st.composite
def frictions(draw: st.DrawFn) -> float | Profile:
    """No friction, a coefficient, or one that varies along the rim."""
    if draw(st.booleans()):
        return draw(st.just(0.0) | between(0.0, 1.5))
    part = draw(between(0.1, 0.5))
    waves = st.builds(Harmonic, st.integers(1, 12), between(-0.3 * part, 0.3 * part), between(-0.3 * part, 0.3 * part))
    more = draw(st.lists(waves, max_size=1)) + draw(st.lists(zones(1.0) | samples(0.9, 1.0), max_size=2))
    return Profile((Harmonic(0, part), *more))


@st.composite
def problems(draw: st.DrawFn) -> fastpin.Problem:
    """Problems in SI units, and dimensionless ones."""
    pair, friction = draw(pairs()), draw(frictions())
    pin_load = draw(st.sampled_from(["centre", "body"]))
    rotation = "free" if pin_load == "body" else draw(st.sampled_from(["free", "fixed", "spring"]))
    drive = draw(st.sampled_from(["force", "force", "ux", "uy", "both"]))
    least, whole = 0.0 if fastpin.Problem(pair, 1.0, 0.0, 0.1).is_incompressible else -0.01, draw(st.booleans())
    radius, unit = (1.0, 1.0) if whole else (draw(scale(-5, 2)), pair.beta_star)
    has_hub = rotation != "free" or (drive != "force" and pin_load == "centre")
    sizes = {
        "hub_radius": draw(between(1e-3, 1.0)) * radius if has_hub and draw(st.booleans()) else None,
        "hub_stiffness": draw(scale(-3, 3)) * radius**2 / unit if rotation == "spring" else None,
        "gauge_radius": draw(between(1.0, 100.0)) * radius if drive != "force" and draw(st.booleans()) else None,
        "rig_stiffness": draw(scale(-3, 3)) / unit if drive != "force" and draw(st.booleans()) else None,
    }
    kind: dict[str, Any] = {"pin_load": pin_load, "rotation": rotation, "drive": drive}
    if draw(st.booleans()):
        kind["gap"] = draw(gaps(1.0 if whole else 0.01 * radius, not whole))
    if whole:
        return fastpin.Problem.from_load_parameter(pair, draw(between(least, 3.0)), friction, **kind, **sizes)
    return fastpin.Problem(pair, radius, draw(between(least, 0.01)) * radius, friction, **kind, **sizes)


@st.composite
def corners(draw: st.DrawFn, problem: fastpin.Problem, most: int = 5) -> list[dict[str, float]]:
    """Corners of loads that a problem can carry, of the size that strains it by some thousandths."""
    natural = problem.natural_loads()
    kinds = fastpin.model.loads.LOAD_KIND
    refused = {"M", "rotation", "temperature", "pin_temperature"}
    if problem.frictionless:
        refused.add("friction_change")
    for is_driven, force, displacement in zip(problem.driven, ("Q", "P"), ("ux", "uy"), strict=True):
        refused.add(force if is_driven else displacement)
    names = [name for name in LOADS if name not in refused]
    if problem.held:
        names.append("rotation")
    elif problem.pin_load == "centre":
        names.append("M")
    row = st.dictionaries(st.sampled_from(names), between(-1e-3, 1e-3), min_size=1, max_size=3)
    rows = draw(st.lists(row, min_size=1, max_size=most))
    return [{name: part * natural[kinds[name]] for name, part in row.items()} for row in rows]


@st.composite
def histories(draw: st.DrawFn, problem: fastpin.Problem) -> fastpin.LoadHistory:
    """Histories of a few blocks, some of them repeated."""
    history = fastpin.LoadHistory(draw(corners(problem)))
    for count in draw(st.lists(st.integers(1, 40), max_size=2)):
        history += fastpin.LoadHistory(draw(corners(problem, 3))).repeated(count)
    return history


@st.composite
def options(draw: st.DrawFn, closed: bool = False) -> SolveOptions:
    """Options of the solver. With `closed` an arc is the whole circle."""
    given: dict[str, Any] = {
        "nodes": draw(st.integers(5, 20_000)),
        "method": draw(st.sampled_from(["path", "increment"])),
    }
    if given["method"] == "increment":
        given["increments"] = draw(st.none() | st.integers(1, 500))
    if draw(st.booleans()):
        start, length = draw(between(-4.0, 3.0)), draw(between(0.1, 6.0))
        given["arc"] = (start, start + (2.0 * math.pi if closed else length))
    fractions = st.lists(between(0.01, 0.99), min_size=1, max_size=4, unique=True).map(sorted).map(tuple)
    given["between"] = draw(st.integers(0, MOST_BETWEEN) | fractions)
    given["keep"] = draw(st.sampled_from(["all", "corners", "every 10", "every 2"]))
    given |= {name: draw(st.booleans()) for name in ("shortcut", "error_bars", "slip_sums")}
    return SolveOptions(**given)


@st.composite
def cases(draw: st.DrawFn) -> fastpin.Case:
    """Whole cases with title and who made them. Materials have no names: case files can't give them."""
    problem = draw(problems())
    pin, plate = (
        fastpin.Material.rigid() if body.is_rigid else fastpin.Material(body.E, body.nu)
        for body in (problem.pair.pin, problem.pair.plate)
    )
    problem = dataclasses.replace(problem, pair=fastpin.MaterialPair(pin, plate, problem.pair.plane))
    history = draw(histories(problem))
    chosen = draw(options(problem.is_gripped))
    crack = st.none() if problem.pair.plate.is_rigid else st.none() | cracks(problem.hole_radius)
    about = fastpin.model.About(*(draw(words) for _ in range(4)))
    return fastpin.Case(problem, history, chosen, draw(words), about, draw(st.none() | wears()), crack=draw(crack))


@st.composite
def cracks(draw: st.DrawFn, radius: float) -> fastpin.model.CrackGrowth:
    """Cracks that grow by any law, up to ten radii."""
    walker = st.builds(Walker, scale(-20, -3), between(0.5, 8.0), between(0.0, 1.0), scale(3, 8), source=words)
    nasgro = st.builds(
        Nasgro, scale(-20, -3), between(0.5, 8.0), between(0.0, 2.0), between(0.0, 2.0), scale(3, 8), scale(6, 9)
    )
    pairs = st.lists(st.tuples(between(0.0, 1.0), between(-1e9, 1e9)), min_size=2, max_size=4, unique_by=lambda p: p[0])
    last = draw(between(1e-3, 10.0)) * radius
    return fastpin.model.CrackGrowth(
        draw(between(0.01, 0.9)) * last,
        last,
        draw(walker | nasgro),
        draw(st.none() | angles),
        draw(degrees(-60.0, 60.0)) * DEGREE,
        residual_stress=draw(st.none() | between(-1e9, 1e9) | pairs.map(sorted)),
    )


@st.composite
def assessments(draw: st.DrawFn) -> fastpin.model.FatigueAssessment:
    """Assessments of the fatigue of whole histories."""
    rule, method = draw(st.sampled_from(MINER_RULES)), draw(st.sampled_from(DISTANCES))
    criteria, bodies = st.sampled_from(list(LIFE_CONSTANTS)), st.sampled_from(["plate", "pin", "seat"])
    return fastpin.model.FatigueAssessment(
        draw(criteria | st.lists(criteria, min_size=1, unique=True)),
        draw(st.none() | bodies | st.lists(bodies, min_size=1, unique=True)),
        method=method,
        length=None if method == "edge" else draw(st.none() | scale(-8, 0)),
        angles=draw(st.none() | st.lists(between(-360.0, 360.0), min_size=1, max_size=4)),
        small_cycles=rule,
        knee=None if rule == "elementary" else draw(scale(0, 18)),
        straight=draw(st.none() | st.booleans()),
    )


@st.composite
def wears(draw: st.DrawFn) -> fastpin.model.Wear:
    """Lives of wear by any law, with a number or a profile for a coefficient."""
    coefficient = scale(-20, 0) | zones(1e-12).map(lambda zone: Profile((Harmonic(0, 1e-13), zone)))
    given: dict[str, Any] = {"coefficient": draw(coefficient)}
    if draw(st.booleans()):
        given = {"pin": draw(st.none() | coefficient), "plate": draw(coefficient)}
    given |= {"cycles": draw(st.integers(1, 10**9)), "law": draw(st.sampled_from(["archard", "energy"]))}
    given["at"] = draw(st.none() | st.lists(st.integers(1, given["cycles"]), max_size=3, unique=True).map(sorted))
    return fastpin.model.Wear(**given, tolerance=draw(between(0.0, 0.1)))


def tables_of(case: fastpin.Case) -> Tables:
    """The sections of the case file of a case, without its loads."""
    problem = case.problem
    bodies = {"pin": problem.pair.pin, "plate": problem.pair.plate}
    tables: Tables = {
        name: {"rigid": True} if body.is_rigid else {"E": body.E, "nu": body.nu} for name, body in bodies.items()
    }
    tables["about"] = case.about.given()
    contact: dict[str, Any] = {"plane": problem.pair.plane, "friction": written(problem.friction)}
    contact |= {"pin_load": problem.pin_load, "rotation": problem.rotation}
    if problem.dimensionless:
        contact["load_parameter"] = problem.clearance
    else:
        contact |= {"hole_radius": problem.hole_radius, "clearance": problem.clearance}
    given = {
        name: getattr(problem, name)
        for name in ("drive", "hub_radius", "hub_stiffness", "gauge_radius", "rig_stiffness")
    }
    contact |= {name: value for name, value in given.items() if value is not None}
    tables["contact"] = contact
    tables["gap"] = {name: written(profile) for name, profile in problem.gap.given.items()}
    if case.wear is not None:
        given = {field.name: getattr(case.wear, field.name) for field in dataclasses.fields(case.wear)}
        tables["wear"] = {name: written(value) for name, value in given.items() if value is not None}
    if case.crack is not None:
        tables["crack"] = case.crack.entries()
    tables["solve"] = {name: value for name, value in case.options.keywords().items() if value is not None}
    return tables


def written(value: Any) -> Any:
    """A value of a case file. A profile is its list of tables."""
    return value.toml() if isinstance(value, Profile) else value


def text_of(case: fastpin.Case, tables: Tables | None = None) -> str:
    """The text of the case file of a case. Other `tables` may replace its sections."""
    parts = [f"title = {as_toml(case.title)}\n"]
    for name, table in (tables_of(case) if tables is None else tables).items():
        if name == "gap" and not table:
            continue
        parts.append(f"[{name}]\n" + "".join(f"{key} = {as_toml(value)}\n" for key, value in table.items()))
    for block in case.history.blocks:
        parts += _load_blocks(block)
    return "\n".join(parts)


def _load_blocks(block: Block) -> list[str]:
    """The [[load]] blocks of a block of a history. The corners of a repeated block give the same loads."""
    given = ~np.isnan(block.given)
    if block.cycle:
        assert all(np.array_equal(row, given[0]) for row in given), "a case file repeats lists only"
        lists = "".join(
            f"{name} = {as_toml(block.given[:, k].tolist())}\n" for k, name in enumerate(LOADS) if given[0, k]
        )
        return [f"[[load]]\n{lists}repeat = {block.count}\n"]
    return [
        "[[load]]\n" + "".join(f"{name} = {as_toml(float(row[k]))}\n" for k, name in enumerate(LOADS) if mask[k])
        for row, mask in zip(block.given, given, strict=True)
    ]


def as_toml(value: Any) -> str:
    """A value in TOML."""
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(as_toml, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {as_toml(item)}' for key, item in value.items())}}}"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return f"{value:.1f}"
    return str(value)


scalars = st.one_of(
    st.booleans(),
    st.integers(),
    st.integers(-(10**25), 10**25),
    st.floats(),
    words,
    st.sampled_from([10**400, "inf", "every 3", "corners", "path", "", "\x7f"]),
)
"""Values that TOML has, of all kinds and sizes."""

toml_values = scalars | st.lists(scalars, max_size=4) | st.just([[1.0], [2.0]]) | st.just({"P": 1.0})
"""Scalars, lists and tables that TOML has."""

odd_values = st.one_of(
    toml_values,
    st.none(),
    st.binary(max_size=4),
    st.complex_numbers(),
    st.decimals(),
    st.fractions(),
    st.sampled_from(
        [
            np.float32(0.5), np.int8(3), np.uint64(2**64 - 1), np.True_, np.nan, np.array(0.5), np.array([0.1, 0.2]),
            np.ones((2, 2)), np.array([]), np.array(["a"]), np.array([None]), np.complex128(1.0),
            np.timedelta64(5, "s"),
            np.datetime64("2020-01-01"), np.ma.masked, Decimal("sNaN"), datetime.date(2020, 1, 1),
            object(), int, len,
            {}, set(), range(3), slice(1), bytearray(b"1"), memoryview(b"1"), [[1.0], [1.0, 2.0]], "\ud800", "a\0b",
        ]
    ),
)  # fmt: skip
"""Values of any class."""
