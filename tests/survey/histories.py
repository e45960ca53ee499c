"""Random problems with random load histories: the whole space that the theory admits.

:data:`GENERATORS` names the classes. Each one maps a seed to a :class:`RandomCase`. All are dimensionless: a load P = 1
has the load parameter of the problem.
"""

from __future__ import annotations

import functools
import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.bodies.body import PinBody, PlateBody
from fastpin.bodies.compliance import Compliance
from fastpin.bodies.pins import TUBE_LOADS
from fastpin.bodies.ring import SUPPORTS
from fastpin.lugs.outline import Lug, Part, PartLoad
from fastpin.lugs.plates import plate_compliance
from fastpin.model.history import LoadHistory
from fastpin.model.laminate import Laminate, in_axes
from fastpin.model.loads import LOADS, Corner
from fastpin.model.materials import Material, MaterialPair, Plane
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile
from fastpin.model.profile_terms import Crown, Flat, Harmonic, Samples, Term, Zone

NODES = 81
"""Nodes of the general class."""


@dataclass(frozen=True)
class RandomCase:
    """A random problem and history, and the options of :func:`fastpin.solve` for it, or of :func:`fastpin.wear`."""

    problem: Problem
    history: LoadHistory
    options: dict[str, Any] = field(default_factory=lambda: {"nodes": NODES})
    wears: bool = False


def random_case(seed: int) -> tuple[Problem, LoadHistory]:
    """A random problem and a random history of up to six corners: everyday values.

    L_p is 1e-4 to 2.5, friction 0.02 to 1.2, the stiffness ratio 1/30 to 30, nu 0 to 0.49, with both planes, both pin
    loads and both rotations. Q goes up to 1.2 mu P. Half of the free centre-loaded pins have a moment, up to the
    largest that friction at a point can carry. One case of five has remote stress, one of five returns to no load.
    """
    rng = np.random.default_rng(seed)
    ratio = 30.0 ** rng.uniform(-1.0, 1.0)
    pair = MaterialPair(
        Material(1.0, rng.uniform(0.0, 0.49)),
        Material(ratio, rng.uniform(0.0, 0.49)),
        "strain" if rng.random() < 0.5 else "stress",
    )
    load_parameter = 10.0 ** rng.uniform(-4.0, np.log10(2.5))
    friction = rng.uniform(0.02, 1.2)
    pin_load = "body" if rng.random() < 0.5 else "centre"
    rotation = "fixed" if pin_load == "centre" and rng.random() < 0.5 else "free"
    problem = Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation)
    with_moment = pin_load == "centre" and rotation == "free" and rng.random() < 0.5
    with_stress = rng.random() < 0.2
    back_to_zero = rng.random() < 0.2
    corners = []
    for _ in range(int(rng.integers(1, 7))):
        pull = rng.uniform(0.2, 1.0)
        corner = {"P": pull, "Q": pull * friction * rng.uniform(-1.2, 1.2)}
        if with_moment:
            corner["M"] = pull * friction / np.hypot(1.0, friction) * rng.uniform(-1.0, 1.0)
        if with_stress:
            corner |= {
                "sxx": load_parameter * rng.uniform(-0.3, 0.3),
                "syy": load_parameter * rng.uniform(-0.3, 0.3),
            }
        corners.append(corner)
    if back_to_zero:
        corners[1:1] = [dict.fromkeys(corners[0], 0.0), dict(corners[0])]
    return problem, LoadHistory(corners)


def _extreme_pair(rng: np.random.Generator) -> MaterialPair:
    """Stiffness ratio 0.01 to 100, nu up to 0.5; one pair of twelve has a rigid body."""
    nus = [0.5 if rng.random() < 0.1 else rng.uniform(0.0, 0.5) for _ in range(2)]
    bodies = [Material(1.0, nus[0]), Material(10.0 ** rng.uniform(-2.0, 2.0), nus[1])]
    plane = "strain" if rng.random() < 0.5 else "stress"
    if rng.random() < 1.0 / 12.0:
        bodies[int(rng.integers(2))] = Material.rigid()
    if plane == "strain" and any(body.is_rigid for body in bodies):
        # An incompressible body on a rigid body in plane strain: keep one that can change its volume.
        bodies = [body if body.is_rigid else Material(body.E, min(body.nu, 0.49)) for body in bodies]
    return MaterialPair(bodies[0], bodies[1], plane)


def _any_friction(rng: np.random.Generator) -> float:
    """No friction in one case of twelve, otherwise 0.005 to 3."""
    return 0.0 if rng.random() < 1.0 / 12.0 else float(10.0 ** rng.uniform(math.log10(0.005), math.log10(3.0)))


def _support(rng: np.random.Generator) -> dict[str, Any]:
    """How the pin is loaded and held: body or centre, free or fixed, sometimes at a hub."""
    if rng.random() < 0.4:
        return {"pin_load": "body", "rotation": "free"}
    if rng.random() < 0.45:
        return {"pin_load": "centre", "rotation": "free"}
    hub = rng.uniform(0.1, 1.0) if rng.random() < 0.3 else None
    return {"pin_load": "centre", "rotation": "fixed", "hub_radius": hub}


def _extreme_loads(rng: np.random.Generator, problem: Problem, corners: int, stress: float) -> list[dict[str, float]]:
    """Corners with forces, moments a free pin can carry, and remote stress up to `stress` of the clearance."""
    friction = problem.friction
    turning = problem.pin_load == "centre" and problem.rotation == "free" and friction > 0.0 and rng.random() < 0.4
    rotated = problem.rotation == "fixed" and rng.random() < 0.3
    result = []
    for _ in range(corners):
        pull = rng.uniform(0.05, 1.0)
        corner = {"P": pull, "Q": pull * min(max(friction, 0.3), 1.5) * rng.uniform(-1.2, 1.2)}
        force = math.hypot(corner["P"], corner["Q"])
        if turning:
            corner["M"] = force * friction / math.hypot(1.0, friction) * rng.uniform(-0.95, 0.95)
        if rotated:
            corner["rotation"] = rng.uniform(-0.5, 0.5)
        if stress > 0.0:
            size = stress * abs(problem.clearance)
            corner |= {name: size * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
        result.append(corner)
    if rng.random() < 0.15:
        result[1:1] = [dict.fromkeys(result[0], 0.0), dict(result[0])]
    return result


def _problem(rng: np.random.Generator, load_parameter: float, **fields: Any) -> Problem:
    chosen = {"pair": _extreme_pair(rng), "friction": _any_friction(rng), **_support(rng), **fields}
    return Problem.from_load_parameter(load_parameter=load_parameter, **chosen)


def _nodes(rng: np.random.Generator) -> dict[str, Any]:
    return {"nodes": int(rng.integers(61, 143))}


def general(rng: np.random.Generator, seed: int) -> RandomCase:
    """Everyday values, see :func:`random_case`."""
    del rng
    return RandomCase(*random_case(seed))


def extreme(rng: np.random.Generator, seed: int) -> RandomCase:
    """All materials, load parameters 1e-4 to 1e4, friction to 3, remote stress in a third of the cases."""
    del seed
    problem = _problem(rng, 10.0 ** rng.uniform(-4.0, 4.0))
    stress = 0.5 if rng.random() < 0.33 else 0.0
    return RandomCase(problem, LoadHistory(_extreme_loads(rng, problem, int(rng.integers(1, 7)), stress)), _nodes(rng))


def remote(rng: np.random.Generator, seed: int) -> RandomCase:
    """Remote stress with or without a force, up to several times the stress that closes the hole, rigid bodies."""
    del seed
    problem = _problem(rng, 10.0 ** rng.uniform(-2.0, 1.5))
    alone = rng.random() < 0.5
    size = 10.0 ** rng.uniform(-1.0, 0.7) * problem.clearance
    corners: list[Corner] = []
    for _ in range(int(rng.integers(1, 6))):
        corner = {name: size * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
        if not alone:
            pull = rng.uniform(0.05, 1.0)
            corner |= {"P": pull, "Q": pull * rng.uniform(-0.8, 0.8)}
        corners.append(corner)
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def fits(rng: np.random.Generator, seed: int) -> RandomCase:
    """Interference fits, and neat fits in one case of four, with forces and remote stress."""
    del seed
    load_parameter = 0.0 if rng.random() < 0.25 else -(10.0 ** rng.uniform(-3.0, 2.0))
    problem = _problem(rng, load_parameter)
    if problem.pair.pin.nu > 0.49 and problem.pair.plate.is_rigid:
        problem = _problem(rng, load_parameter, pair=MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3)))
    corners = _extreme_loads(rng, problem, int(rng.integers(1, 6)), 0.0)
    if rng.random() < 0.5:
        size = 10.0 ** rng.uniform(-1.0, 0.5) * max(abs(load_parameter), 0.1)
        for corner in corners:
            corner |= {name: size * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def fixed(rng: np.random.Generator, seed: int) -> RandomCase:
    """A pin whose rotation is held, moderate friction, all load parameters."""
    del seed
    problem = _problem(
        rng, 10.0 ** rng.uniform(-3.0, 3.5), friction=rng.uniform(0.05, 0.8), pin_load="centre", rotation="fixed",
        hub_radius=None,
    )  # fmt: skip
    return RandomCase(problem, LoadHistory(_extreme_loads(rng, problem, int(rng.integers(2, 8)), 0.0)), _nodes(rng))


def _everyday_pair(rng: np.random.Generator) -> MaterialPair:
    """Stiffness ratio 1/10 to 10, nu 0.1 to 0.45."""
    return MaterialPair(
        Material(1.0, rng.uniform(0.1, 0.45)), Material(10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.1, 0.45))
    )


def moderate_stress(rng: np.random.Generator, seed: int) -> RandomCase:
    """Everyday materials, forces and remote stress in every case."""
    del seed
    pair = _everyday_pair(rng)
    problem = _problem(rng, 10.0 ** rng.uniform(-1.5, 1.0), pair=pair, friction=rng.uniform(0.05, 1.0))
    return RandomCase(problem, LoadHistory(_extreme_loads(rng, problem, int(rng.integers(1, 7)), 2.0)), _nodes(rng))


def narrow(rng: np.random.Generator, seed: int) -> RandomCase:
    """Narrow contacts, load parameters 40 to 1e4, rotation held, all materials."""
    del seed
    problem = _problem(rng, 10.0 ** rng.uniform(math.log10(40.0), 4.0), pin_load="centre", rotation="fixed")
    stress = 0.5 if rng.random() < 0.33 else 0.0
    return RandomCase(problem, LoadHistory(_extreme_loads(rng, problem, int(rng.integers(1, 7)), stress)), _nodes(rng))


def rough(rng: np.random.Generator, seed: int) -> RandomCase:
    """Friction 2 to 3; one case of ten 100 to 1000."""
    del seed
    friction = 10.0 ** rng.uniform(2.0, 3.0) if rng.random() < 0.1 else rng.uniform(2.0, 3.0)
    problem = _problem(rng, 10.0 ** rng.uniform(-3.0, 2.0), friction=friction)
    return RandomCase(problem, LoadHistory(_extreme_loads(rng, problem, int(rng.integers(1, 7)), 0.0)), _nodes(rng))


def scales(rng: np.random.Generator, seed: int) -> RandomCase:
    """Loads of very different size: forces from 1e-5 to 1 in one history."""
    del seed
    problem = _problem(rng, 10.0 ** rng.uniform(-3.0, 2.0))
    corners: list[Corner] = []
    for _ in range(int(rng.integers(2, 7))):
        pull = 10.0 ** rng.uniform(-5.0, 0.0)
        corners.append({"P": pull, "Q": pull * rng.uniform(-0.8, 0.8)})
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def wandering(rng: np.random.Generator, seed: int) -> RandomCase:
    """A force that turns round the hole, forth and back, and pushes the other way."""
    del seed
    problem = _problem(rng, 10.0 ** rng.uniform(-3.0, 3.0))
    angle, corners = 0.0, []
    for _ in range(int(rng.integers(2, 9))):
        angle += rng.uniform(-1.5, 1.5)
        pull = rng.uniform(0.2, 1.0) * (-1.0 if rng.random() < 0.15 else 1.0)
        corners.append({"P": pull * math.cos(angle), "Q": pull * math.sin(angle)})
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def bodies(rng: np.random.Generator, seed: int) -> RandomCase:
    """Hollow pins, rings with all supports, bushings, plates with a reaction, a lug; all fits."""
    del seed
    pair = MaterialPair(
        *(Material(10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.0, 0.49)) for _ in range(2)),
        "strain" if rng.random() < 0.5 else "stress",
    )
    load_parameter = 10.0 ** rng.uniform(-3.0, 1.0)
    load_parameter *= rng.choice([1.0, 1.0, 1.0, 0.0, -0.3])
    hollow = rng.random() < 0.6
    pin: PinBody = Disk()
    if hollow:
        pin = Tube(rng.uniform(0.05, 0.95), rng.choice(TUBE_LOADS).item())
    plate = _plate_body(rng)
    if rng.random() < 0.15:
        plate = lug(float(rng.choice((0.2, 0.33, 0.45))), pair.plane)
        pair = MaterialPair(pair.pin, Material(pair.plate.E, plate.nu), pair.plane)
    support = _support(rng)
    if hollow:
        hub = rng.uniform(pin.bore_radius, 1.0) if isinstance(pin, Tube) and "hub_radius" in support else None
        support |= {"pin_load": "centre", "hub_radius": hub}
    problem = Problem.from_load_parameter(
        pair, load_parameter, _any_friction(rng), pin_body=pin, plate_body=plate, **support
    )
    outside = problem.plate_body.lug
    held = isinstance(outside, Ring) and outside.held
    stress = 0.0 if held or rng.random() < 0.6 else 0.5
    corners = _extreme_loads(rng, problem, int(rng.integers(1, 7)), stress)
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def gap(rng: np.random.Generator, seed: int) -> RandomCase:
    """Initial gaps of hole and pin: waves, bumps and samples; all fits, held, free and driven pins, some other bodies.

    One case of eight has lengths in m, and flats.
    """
    del seed
    pair = MaterialPair(
        *(Material(10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.0, 0.49)) for _ in range(2)),
        "strain" if rng.random() < 0.5 else "stress",
    )
    if rng.random() < 0.3:
        pair = MaterialPair(pair.pin, pair.pin, pair.plane)
    load_parameter = 10.0 ** rng.uniform(-2.5, 1.5) * rng.choice([1.0, 1.0, 1.0, 0.0, -0.5])
    size = max(abs(load_parameter), 0.03)
    chosen: dict[str, Any] = {**_support(rng), "friction": _any_friction(rng)}
    if rng.random() < 0.15:
        chosen |= {"pin_body": Tube(rng.uniform(0.1, 0.8)), "plate_body": _plate_body(rng)}
        chosen |= {"pin_load": "centre", "hub_radius": None}
    elif rng.random() < 0.15:
        chosen["drive"] = rng.choice(["ux", "uy", "both"]).item()
    profiles = [Profile(_terms(rng, size)) for _ in range(2)]
    profiles[int(rng.integers(2))] = Profile() if rng.random() < 0.6 else profiles[0]
    problem = Problem.from_load_parameter(pair, load_parameter, gap=InitialGap(*profiles), **chosen)
    stress = 0.5 if rng.random() < 0.25 and not _is_held(problem) else 0.0
    corners = _extreme_loads(rng, problem, int(rng.integers(1, 6)), 0.0)
    for corner in corners:
        if stress:
            corner |= {name: stress * size * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
        for name, force, driven in zip(("ux", "uy"), ("Q", "P"), problem.driven, strict=True):
            if driven:
                del corner[force]
                corner[name] = 3.0 * (size + 0.3) * rng.uniform(-1.0, 1.0)
    if problem.drive != "force":
        corners = [{name: value for name, value in corner.items() if name != "M"} for corner in corners]
    if problem.drive == "force" and not problem.has_bodies and not problem.is_gripped and rng.random() < 0.15:
        return _with_flats(rng, problem, corners)
    return RandomCase(problem, LoadHistory(corners), {"nodes": int(rng.integers(81, 202))})


def wear(rng: np.random.Generator, seed: int) -> RandomCase:
    """Short lives of wear: everyday values, all fits, held pins, initial gaps; both laws, zones, fat cycles.

    Some cycles lose contact. The worn depth goes up to the size of the clearance.
    """
    kind = [general, fits, fixed, gap][int(rng.integers(4))]
    case = kind(rng, seed)
    problem, names = case.problem, list(case.history.largest)
    corners = case.history.values()[:, [LOADS.index(name) for name in names]]
    while len(corners) < 2:
        corners = np.vstack([corners, 0.5 * corners[-1:]])
    turn = LoadHistory.from_array(corners[1:4], names)
    size = 10.0 ** rng.uniform(-3.0, 0.0) * (1.0 if problem.dimensionless else 1e-3 * problem.surfaces.beta_star)
    options: dict[str, Any] = {"nodes": int(rng.integers(41, 82)), "law": rng.choice(["archard", "energy"]).item()}
    options |= {"cycles": int(rng.integers(2, 7)), "tolerance": 0.0}
    if rng.random() < 0.25:
        options |= {"cycles": int(rng.integers(8, 40)), "tolerance": 0.05}
    if rng.random() < 0.5 or problem.frictionless:
        options |= {"coefficient": size, "law": "archard" if problem.frictionless else options["law"]}
    else:
        start = rng.uniform(-math.pi, math.pi)
        options |= {"pin": size * rng.random(), "plate": Profile((Harmonic(0, size), Zone(size, start, start + 1.0)))}
    return RandomCase(problem, LoadHistory.from_array(corners[:1], names) + turn.repeated(1), options, wears=True)


def _is_held(problem: Problem) -> bool:
    """Whether a ring round the plate is held, so that there is no remote stress."""
    outside = problem.plate_body.lug
    return isinstance(outside, Ring) and outside.held


def _terms(rng: np.random.Generator, size: float) -> list[Term]:
    """One to three terms of a gap, of the order of `size`."""
    terms: list[Term] = []
    for _ in range(int(rng.integers(1, 4))):
        height, kind = 10.0 ** rng.uniform(-2.0, 0.2) * size, rng.random()
        turn = rng.uniform(-math.pi, math.pi)
        if kind < 0.65:
            order = int(rng.choice([1, 2, 2, 2, 3, 3, 4, 5, 6, 8, 20]))
            height /= max(order, 1)
            terms.append(Harmonic(order, height * math.cos(turn), height * math.sin(turn)))
        elif kind < 0.85:
            terms.append(Crown(height * rng.choice([-0.3, 1.0]), turn, rng.uniform(0.3, math.pi)))
        else:
            angles = turn + np.arange(12) * (math.pi / 6.0)
            terms.append(Samples(angles, 0.3 * height * rng.uniform(-1.0, 1.0, 12)))
    return terms


def _with_flats(rng: np.random.Generator, problem: Problem, corners: list[dict[str, float]]) -> RandomCase:
    """The same with lengths in m, and a flat on the pin: a load of 1 strains the bodies by 1e-3."""
    radius, strain = 0.01, 1e-3
    natural = Problem(problem.pair, radius, 0.0, 0.0).natural_loads()["force"]
    unit = strain * radius
    flat = Flat(unit * rng.uniform(0.1, 2.0) * max(problem.clearance, 0.1), rng.uniform(-math.pi, math.pi))
    found = replace(
        problem, hole_radius=radius, clearance=unit * problem.clearance, dimensionless=False,
        hub_radius=None if problem.hub_radius is None else radius * problem.hub_radius,
        gap=InitialGap(pin=Profile((flat,))),
    )  # fmt: skip
    sizes = {"P": 1.0, "Q": 1.0, "M": radius, "sxx": 1.0 / radius, "syy": 1.0 / radius, "sxy": 1.0 / radius}
    loads = {name: strain * natural * size for name, size in sizes.items()} | {"rotation": strain}
    scaled = [{name: loads[name] * value for name, value in corner.items()} for corner in corners]
    return RandomCase(found, LoadHistory(scaled), {"nodes": int(rng.integers(81, 202))})


@functools.cache
def lug(nu: float, plane: Plane) -> Compliance:
    """An oblique lug that no axis divides, with tractions of its own for all remote stresses."""
    corners = [-1.8 - 1.6j, 2.4 - 1.9j, 2.1 + 4.0j, -2.6 + 3.2j]
    outline = tuple(Part(f"side {k}", corners[k], corners[(k + 1) % 4]) for k in range(4))
    loads = [PartLoad("sxx", ("side 1",), normal=1.0), PartLoad("syy", ("side 0",), normal=1.0)]
    loads.append(PartLoad("sxy", ("side 0",), x=1.0))
    return plate_compliance(Lug(nu, plane, 1.0, outline, {"side 2": "both"}, loads)).compliance


def _plate_body(rng: np.random.Generator) -> PlateBody:
    """A plate, with a reaction at a point in half of the cases, a ring, or a bush in either."""
    chosen = rng.random()
    if chosen < 0.2:
        return _plate(rng, 1.0)
    if chosen < 0.6:
        return _ring(rng, 1.0)
    outer = 1.0 + 10.0 ** rng.uniform(-1.5, 0.3)
    inside = _plate(rng, outer) if rng.random() < 0.5 else _ring(rng, outer)
    bush = Material(10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.0, 0.49))
    return Bushing(bush, outer, rng.uniform(0.0, 0.1) if rng.random() < 0.3 else 0.0, inside=inside)


def _plate(rng: np.random.Generator, hole: float) -> Plate:
    if rng.random() < 0.5:
        return Plate()
    away, angle = hole * 10.0 ** rng.uniform(0.05, 1.0), rng.uniform(-math.pi, math.pi)
    return Plate((away * math.cos(angle), away * math.sin(angle)))


def _ring(rng: np.random.Generator, hole: float) -> Ring:
    return Ring(hole * (1.0 + 10.0 ** rng.uniform(-1.3, 1.0)), rng.choice(SUPPORTS).item())


def drift(rng: np.random.Generator, seed: int) -> RandomCase:
    """Friction that changes at the corners by a factor of 1/10 to 3; in half of the cases it varies along the rim."""
    del seed
    load_parameter = float(10.0 ** rng.uniform(-2.0, 1.0)) * (-0.3 if rng.random() < 0.2 else 1.0)
    problem = _problem(rng, load_parameter, pair=_everyday_pair(rng), friction=rng.uniform(0.05, 1.0))
    corners = _extreme_loads(rng, problem, int(rng.integers(2, 6)), 0.3 if rng.random() < 0.2 else 0.0)
    for corner in corners[int(rng.random() < 0.5) :]:
        if rng.random() < 0.8:
            corner["friction_change"] = float(10.0 ** rng.uniform(-1.0, 0.5)) - 1.0
    held = [dict(corners[-1], friction_change=float(10.0 ** rng.uniform(-0.5, 0.5)) - 1.0)]  # at constant load
    if rng.random() < 0.5:
        wave = Profile.lobes(int(rng.integers(1, 5)), rng.uniform(0.1, 0.9) * problem.friction, rng.uniform(0.0, 6.0))
        problem = replace(problem, friction=Profile.constant(problem.friction) + wave)
    return RandomCase(problem, LoadHistory([*corners, *held]), {"nodes": int(rng.integers(41, 82))})


def bush(rng: np.random.Generator, seed: int) -> RandomCase:
    """A bush that slips in a plate, a ring or a lug: press fits from light to heavy, all fits of the pin, all loads.

    One pin of six is hollow. One bush of eight sits in a lug of any outline, a third of these bonded.
    """
    del seed
    plane: Plane = "strain" if rng.random() < 0.5 else "stress"
    pin, plate, layer = (Material(10.0 ** rng.uniform(-0.7, 0.7), rng.uniform(0.1, 0.45)) for _ in range(3))
    outer = 1.0 + 10.0 ** rng.uniform(-1.2, 0.2)
    inside: PlateBody = _plate(rng, outer) if rng.random() < 0.5 else _ring(rng, outer)
    pressure = 10.0 ** rng.uniform(-2.0, 0.0)
    support = (
        _support(rng) if rng.random() < 0.8 else {"pin_load": "centre", "rotation": "spring", "hub_stiffness": 1.0}
    )
    support |= {"hub_radius": None}
    bonded = False
    if rng.random() < 0.125:
        plate = replace(plate, nu=float(rng.choice((0.2, 0.33, 0.45))))
        inside, bonded = lug(plate.nu, plane), bool(rng.random() < 0.3)
    if rng.random() < 0.17:
        support |= {"pin_load": "centre", "pin_body": Tube(rng.uniform(0.1, 0.9))}

    def problem(interference: float, clearance: float) -> Problem:
        mu = None if bonded else float(10.0**friction)
        body = Bushing(layer, outer, interference, inside, mu, bonded)  # type: ignore[arg-type]
        return Problem.from_load_parameter(
            MaterialPair(pin, plate, plane), clearance, _any_friction(rng), plate_body=body, **support
        )

    friction = rng.uniform(-1.5, 0.0)
    trial = problem(1.0, 0.0)
    interference = pressure / trial.press_fit_pressure
    shrinks = -trial.assembled_clearance * interference
    gap = float(10.0 ** rng.uniform(-2.0, 0.5)) * (-0.1 if rng.random() < 0.2 else 1.0)
    found = problem(interference, shrinks + gap)
    if gap > 0.0 and not bonded and rng.random() < 0.15:  # a loose bush, or a neat one
        found = problem(rng.choice([0.0, -0.3]) * rng.uniform(0.1, 1.0), gap)
    stress = 0.3 if rng.random() < 0.2 and not _is_held(found) else 0.0
    corners = _extreme_loads(rng, found, int(rng.integers(1, 7)), 0.0)
    for corner in corners:
        if stress:
            corner |= {name: stress * pressure * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
    if rng.random() < 0.2:
        corners[1:1] = [dict.fromkeys(corners[0], 0.0), dict(corners[0])]
    return RandomCase(found, LoadHistory(corners), {"nodes": int(rng.integers(41, 102))})


def laminates(rng: np.random.Generator, seed: int) -> RandomCase:
    """A pin in a laminate of one to four ply angles, E1/E2 to 150, any axis; all fits, solid and hollow pins.

    One pin of eight is rigid. In plane strain the pin alone is.
    """
    del seed
    along, shear = 10.0 ** rng.uniform(0.0, math.log10(150.0)), 10.0 ** rng.uniform(-0.7, 0.3)
    ratio = rng.uniform(0.0, 0.45)
    ply = np.array([[1.0 / along, -ratio / along, 0.0], [-ratio / along, 1.0, 0.0], [0.0, 0.0, 1.0 / shear]])
    stiffness = np.mean(
        [np.linalg.inv(in_axes(ply, angle)) for angle in rng.uniform(0.0, math.pi, rng.integers(1, 5))], axis=0
    )
    (a11, a12, a16), (_, a22, a26), (_, _, a66) = np.linalg.inv(stiffness)
    laminate = Laminate(compliance=(a11, a12, a22, a16, a26, a66), axis=rng.uniform(-math.pi, math.pi))
    pin = Material.rigid() if rng.random() < 0.125 else Material(10.0 ** rng.uniform(-1.0, 2.0), rng.uniform(0.0, 0.49))
    load_parameter = 10.0 ** rng.uniform(-3.0, 1.5) * rng.choice([1.0, 1.0, 1.0, 0.0, -0.3])
    support, chosen = _support(rng), {}
    if rng.random() < 0.15 and not pin.is_rigid:
        chosen = {"pin_body": Tube(rng.uniform(0.1, 0.9))}
        support |= {"pin_load": "centre", "hub_radius": None}
    elif rng.random() < 0.1:
        chosen = {"drive": rng.choice(["ux", "uy", "both"]).item()}
    plane: Plane = "strain" if rng.random() < 0.3 else "stress"
    friction = float(rng.choice([0.0, 10.0 ** rng.uniform(-2.0, 0.0)], p=[0.12, 0.88]))
    problem = Problem.from_load_parameter(
        MaterialPair(pin, laminate, plane), load_parameter, friction, **support, **chosen
    )
    size = max(abs(load_parameter), 0.1)
    stress = rng.uniform(0.1, 2.0) * size if rng.random() < 0.4 else 0.0
    corners = _extreme_loads(rng, problem, int(rng.integers(1, 7)), 0.0)
    for corner in corners:
        if stress:
            corner |= {name: stress * rng.uniform(-1.0, 1.0) for name in ("sxx", "syy", "sxy")}
        for name, force, driven in zip(("ux", "uy"), ("Q", "P"), problem.driven, strict=True):
            if driven:
                del corner[force]
                corner[name] = 3.0 * size * rng.uniform(-1.0, 1.0)
    if problem.drive != "force":
        corners = [{name: value for name, value in corner.items() if name != "M"} for corner in corners]
    return RandomCase(problem, LoadHistory(corners), _nodes(rng))


def neat(rng: np.random.Generator, seed: int) -> RandomCase:
    """A pin in a neat fit, or one that is neat to 1e-3 and less, whose loads vanish and turn round together.

    P, Q, M and remote stress act alone and together, in solid and hollow pins, plates, rings and laminates.
    """
    plane: Plane = "strain" if rng.random() < 0.3 else "stress"
    pin, plate = (Material(10.0 ** rng.uniform(-0.7, 0.7), rng.uniform(0.0, 0.45)) for _ in range(2))
    kind = rng.choice(["plate", "laminate", "ring", "tube"], p=[0.5, 0.2, 0.15, 0.15])
    support = _support(rng)
    bodies: dict[str, Any] = {}
    if kind == "laminate":
        pair = replace(laminates(rng, seed).problem.pair, plane="stress")
    else:
        pair = MaterialPair(pin, pin if rng.random() < 0.3 else plate, plane)
    if kind == "tube":
        bodies, support = (
            {"pin_body": Tube(rng.uniform(0.1, 0.9))},
            support | {"pin_load": "centre", "hub_radius": None},
        )
    if kind == "ring":
        bodies["plate_body"] = Ring(1.0 + 10.0 ** rng.uniform(-0.5, 0.7), str(rng.choice(["held", "half", "uniform"])))
    fit = 0.0 if rng.random() < 0.65 else 10.0 ** rng.uniform(-14.0, -3.0) * rng.choice([-1.0, 1.0])
    friction = 10.0 ** rng.uniform(math.log10(0.05), 0.0)
    problem = Problem.from_load_parameter(pair, fit, friction, **support, **bodies)
    names = [("P",), ("P", "Q"), ("syy",), ("sxx",), ("sxy",), ("sxx", "syy", "sxy"), ("P", "syy"), ("P", "Q", "sxx")]
    if kind == "ring":
        names = names[:2]
    chosen = dict.fromkeys(names[int(rng.integers(len(names)))])
    sizes = {name: float(rng.uniform(0.2, 1.0) * rng.choice([-1.0, 1.0])) for name in chosen}
    if "P" in sizes and problem.rotation == "free" and problem.pin_load == "centre" and rng.random() < 0.5:
        force = math.hypot(sizes["P"], sizes.get("Q", 0.0))
        sizes["M"] = force * friction / math.hypot(1.0, friction) * rng.uniform(-0.8, 0.8)
    factors = [1.0, *rng.choice([-1.0, -0.5, -0.1, 0.1, 0.5, 1.0, 0.0, 0.7, -0.3], int(rng.integers(2, 6)))]
    corners = [{name: float(factor) * size for name, size in sizes.items()} for factor in factors]
    return RandomCase(problem, LoadHistory(corners), {"nodes": 101})


GENERATORS: dict[str, Callable[[np.random.Generator, int], RandomCase]] = {
    function.__name__: function
    for function in (
        general, extreme, remote, fits, fixed, moderate_stress, narrow, rough, scales, wandering, bodies, gap, drift,
        wear, bush, laminates, neat,
    )
}  # fmt: skip
"""The classes of random cases, by name."""


def generate(kind: str, seed: int) -> RandomCase:
    """The random case of a class and a seed."""
    return GENERATORS[kind](np.random.default_rng([zlib.crc32(kind.encode()), seed]), seed)
