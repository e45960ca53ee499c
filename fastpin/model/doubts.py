"""Doubts about input that can be used: values that are probably a mistake, such as a modulus in GPa.

Python, ``fastpin check`` and ``fastpin run`` give the same sentences. A doubt never changes a result.

A unit can be wrong only where there are units. A dimensionless problem has none, and neither has a problem whose hole
radius or modulus is exactly 1. In every other problem the loads, the moduli and the size must fit together: the loads
strain the bodies by some 1e-4 to 1e-2. A mistake in one unit changes this strain by a factor of 1,000 or more. So
consistent units of any kind, such as N and mm, raise no doubt.
"""

from __future__ import annotations

import contextlib
import math
import operator
import warnings
from collections.abc import Iterable, Iterator
from contextvars import ContextVar

import numpy as np

from fastpin.errors import InputWarning
from fastpin.model.angles import meant_degrees
from fastpin.model.grid import Grid
from fastpin.model.growth import KnownLaw, Nasgro
from fastpin.model.history import LoadHistory
from fastpin.model.laminate import Laminate
from fastpin.model.loads import LOAD_KIND
from fastpin.model.materials import STRENGTHS, Material
from fastpin.model.options import SolveOptions
from fastpin.model.points import owner_of
from fastpin.model.problem import LOOKED_AT, Problem
from fastpin.model.profile import Profile
from fastpin.model.profile_terms import MOST_ANGLE
from fastpin.model.units import units
from fastpin.model.wear import Wear

MOST_FRICTION, PERCENT = 2.0, 200.0
"""Friction above the first is rare: clean metals reach 1.5. The second is as much in percent.

Beyond, a pin is meant to stick wherever it touches.
"""

LEAST_NU, MOST_NU = 0.05, 0.46
"""Poisson's ratio of stiff solids lies between these: beryllium and cork below, and indium with 0.45, are the extremes.

The bounds 0 and 0.5 themselves are chosen on purpose.
"""

STIFF = 1e9
"""Young's modulus, Pa, above which a body is stiff: no solid with a ratio near 0.5, such as rubber, reaches it."""

SOFTEST, STIFFEST = 1e6, 2e13
"""Young's moduli, Pa, of the softest rubber, and above diamond: it has 1.2e12 Pa, or 1.2e13 dyn/cm^2."""

IN_GPA = 2e3
"""A modulus below this is probably in GPa, one above in MPa: no solid has more than 1,300 GPa."""

MOST_MODULI = 1e6
"""Largest ratio of two moduli: steel and rubber differ by a factor of 2e5."""

MOST_STRAIN = 0.1
"""Strain by the loads above which something is wrong. Metals yield below 0.01, and rubber is not linear then."""

LARGE_STRAIN = 0.05
"""Contact strain, pressure times beta*, above which linear elasticity fails."""

LEAST_BEARING, LEAST_FORCE_BEARING = 3e6, 1e6
"""Bearing stress F/(2 R), Pa, below which a force per thickness may be a force in N, and one in N a force in kN.

Joints carry 10 to 500 MPa. In plates of 1 to 20 mm a force in N has 1 to 20 thousandths of its bearing stress, mostly
below 3 MPa; a force in kN has one thousandth.
"""

LEAST_STRAIN = 3e-4
"""Strain from which no bearing stress is small: soft plastics and rubber carry 1 MPa and less."""

FORM = 15
"""Waves round the hole by which a roundness tester gives the form of a hole, without its roughness."""

NODES_A_WAVE = 8
"""Nodes that a wave of a profile needs: its pressure is right to 3 % then."""

LEAST_ROUGHNESS = 0.03
"""Pressure by waves that the nodes do not resolve, in parts of the bearing stress, from which it is worth a word.

A wave with n periods round the hole and the amplitude A presses with 2 n A/(R beta*), up and down, where it is closed.
"""

LEAST_STRESS = 2e3
"""Remote stress, Pa, below which the number is probably in MPa: no metal carries 2,000 MPa."""

LARGEST_HOLE = 1.0
"""Hole radius, m, above which it is probably in mm: pins of large bridges and cranes have half of it."""

THICKEST = 50.0
"""Thickness in hole radii above which it is probably in mm: such a long pin bends."""

LOOSEST, TIGHTEST = 0.5, 0.02
"""Clearance and interference in parts of the radius. A looser pin is no pin of this hole; a tighter one yields."""

MOST_ROTATION = 0.2
"""Prescribed rotation, rad, above which it is probably in degrees: small rotations are assumed."""

MOST_SHIFT = 0.05
"""Prescribed displacement beyond the clearance, in parts of the hole radius: a strain of that size."""

LEAST_STRENGTH = 1e-5
"""Strength in parts of Young's modulus, below which it is probably in MPa: a pure soft metal yields at 1e-4."""

SAME_THICKNESS = 0.01
"""Relative difference of the thickness of a joint and of its stack of plies that is rounding of the plies."""

MOST_WEAR = 1.0
"""Wear coefficient in parts of beta*, above which it is in another unit.

Archard's coefficient times the hardness is the part of touching asperities that wears off: below 0.01 even for severe
wear. The hardness of metals is some 1/30 of their modulus, so a coefficient of beta* makes this part some 0.1.
"""

EDGES = {
    "hole": ("plate", "at the hole of the plate"),
    "bore of the bush": ("bush", "in the bore of the bush"),
    "rim of the bush": ("bush", "on the outer rim of the bush"),
    "seat": ("plate", "of the plate at the seat of the bush"),
    "pin": ("pin", "on the surface of the pin"),
    "bore of the pin": ("pin", "in the bore of the pin"),
}
"""Edges of the bodies: the name of the body, and words for the place."""

LEAST_INTENSITY = 1e3
"""Least plausible stress intensity of a law of growth, Pa sqrt(m): a thousandth of the threshold of metals."""

TRIED_INTENSITY, LEAST_RATE, MOST_RATE = 1e7, -12.0, -4.0
"""A range of the stress intensity, Pa sqrt(m), and the powers of ten, m, between which metals grow in its cycle."""

_GIVEN: ContextVar[bool] = ContextVar("given", default=False)


def doubts(
    problem: Problem,
    history: LoadHistory | None = None,
    options: SolveOptions | None = None,
    grid: Grid | None = None,
) -> list[InputWarning]:
    """Return a warning for each doubtful value of a problem, its loads and the options of the solver, or its grid."""
    found, has_units = [*_of_contact(problem), *_of_slip(problem)], _has_units(problem)
    for name, material in problem.joint.materials.items():
        found += _of_material(name, material, has_units)
        if isinstance(material, Laminate):
            found += _of_laminate(material, problem)
    if options is not None and options.arc is not None:
        angle = max(options.arc, key=abs)
        if abs(angle) > MOST_ANGLE:
            found.append(InputWarning("arc", f"{angle:g} rad is more than two turns; angles are in rad"))
    if history is not None and options is not None and problem.gap:
        found += _of_roughness(problem, history, options, grid)
    if has_units:
        by_sizes = [*_of_sizes(problem)]
        found += by_sizes
        if not {"clearance", "interference"} & {doubt.field for doubt in by_sizes}:
            stresses = problem.joint.assembly_stresses(problem.assembled_clearance)
            found += filter(None, (yield_doubt(problem, *stress, "before any load") for stress in stresses.items()))
        by_loads = [] if history is None else [*_of_loads(problem, history)]
        found += by_loads
        if all(doubt.field != "E" for doubt in by_loads):
            found += _of_moduli(problem)
    return found


def wear_doubts(problem: Problem, wear: Wear) -> list[InputWarning]:
    """Return a warning for a coefficient of wear that is probably in another unit."""
    theta = np.linspace(-math.pi, math.pi, LOOKED_AT)
    most = float(wear.coefficients(problem.hole_radius, theta).sum(axis=0).max())
    if not _has_units(problem) or most <= MOST_WEAR * problem.surfaces.beta_star:
        return []
    hint = "numbers in 1/MPa are to be multiplied by 1e-6, numbers in mm^3/(N m) by 1e-9"
    return [InputWarning("coefficient", f"{most:.3g} 1/Pa is more than any surface wears; {hint}")]


def pressure_doubts(problem: Problem, history: LoadHistory, pressures: Iterable[np.ndarray]) -> list[InputWarning]:
    """Return warnings about contact strain and yield in a result.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        If they strain the bodies too much, they are in doubt, and not the pressure.
    pressures : iterable of ndarray, shape (n,)
        Contact pressures at the nodes of each state, Pa. An array that comes again is looked at once.
    """
    if not are_loads_plausible(problem, history):
        return []
    found = []
    distinct = {id(pressure): pressure for pressure in pressures}
    peak = max((float(np.max(pressure, initial=0.0)) for pressure in distinct.values()), default=0.0)
    strain = problem.surfaces.beta_star * peak
    if strain > LARGE_STRAIN and _has_units(problem):
        found.append(
            InputWarning(
                "peak pressure",
                f"contact strains of about {strain:.2g} are beyond linear elasticity; are all values in SI units?",
            )
        )
    for name, material in (
        (owner_of(problem, "pin"), problem.pair.pin),
        (owner_of(problem, "plate"), problem.surfaces.plate),
    ):
        strength = material.known_yield_strength
        if strength is not None and peak > strength >= LEAST_STRENGTH * material.E:
            found.append(
                InputWarning(
                    "peak pressure",
                    f"{_mega(peak)} is above the yield strength {_mega(strength)} of the {name}; "
                    "fastpin is elastic, but a real contact yields there",
                )
            )
    return found


def are_loads_plausible(problem: Problem, history: LoadHistory) -> bool:
    """Whether stresses can be compared with strengths: there are units, and the loads do not strain bodies by 0.1."""
    return not problem.dimensionless and max(_strains(problem, history.largest).values(), default=0.0) <= MOST_STRAIN


def yield_doubt(problem: Problem, edge: str, stress: float, where: str) -> InputWarning | None:
    """A warning if the von Mises `stress`, Pa, at an edge of :data:`EDGES` exceeds the yield strength there.

    `where` tells the angle and the load, for example "before any load".
    """
    name, words = EDGES[edge]
    material = problem.joint.materials[name]
    strength = material.known_yield_strength
    if strength is None or not stress > strength >= LEAST_STRENGTH * material.E:
        return None
    return InputWarning(
        "von Mises stress",
        f"{_mega(stress)} {words}, {where}, is above the yield strength {_mega(strength)} of the {name}; "
        f"fastpin is elastic, but a real {name} yields there",
    )


def warn_of(found: Iterable[InputWarning], stacklevel: int) -> None:
    """Give warnings. `stacklevel` counts the calls up to the line of the user, as for :func:`warnings.warn`."""
    for doubt in found:
        warnings.warn(doubt, stacklevel=stacklevel + 1)


@contextlib.contextmanager
def doubts_given() -> Iterator[None]:
    """Within, no doubts are given: they were given before, for the whole study of many runs."""
    token = _GIVEN.set(True)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputWarning)
            yield
    finally:
        _GIVEN.reset(token)


def are_given() -> bool:
    """Whether this is within :func:`doubts_given`. Doubts that take long are not looked for there."""
    return _GIVEN.get()


def _has_units(problem: Problem) -> bool:
    """Whether a problem is given in units, and not in parts of its own radius or modulus."""
    own = [problem.hole_radius, *(material.E for _, material in problem.joint.materials.items())]
    return not problem.dimensionless and 1.0 not in own


def _short(value: float) -> str:
    """A number as one writes it in a case file: 0.4, 69e9 or 10e-3."""
    power = 3 * math.floor(math.log10(abs(value)) / 3.0) if value else 0
    if 0.1 <= abs(value) < 1e6:
        power = 0
    return f"{value / 10.0**power:.6g}" + (f"e{power}" if power else "")


def _meant(value: float, unit: str, factor: float) -> str:
    """The question whether a number was meant in another unit. It is rounded as one would write it."""
    rounded = float(f"{value:.3g}")
    return f"did you mean {_short(rounded)} {unit}, which is {_short(factor * rounded)}?"


def _mega(stress: float) -> str:
    return f"{stress / 1e6:.4g} MPa"


def _of_contact(problem: Problem) -> Iterator[InputWarning]:
    friction = problem.most_friction
    if MOST_FRICTION < friction <= PERCENT:
        percent = float(f"{friction:.2g}")
        yield InputWarning(
            "friction",
            f"{friction:g} is above {MOST_FRICTION:g}, more than dry metals have; "
            f"did you mean {percent:g} %, which is {percent / 100:g}?",
        )
    if not problem.dimensionless and problem.clearance > LOOSEST * problem.hole_radius:
        yield InputWarning(
            "clearance",
            f"{_short(problem.clearance)} is more than half of the hole radius {_short(problem.hole_radius)}; "
            "clearance is the hole radius minus the pin radius",
        )


def _of_roughness(
    problem: Problem, history: LoadHistory, options: SolveOptions, grid: Grid | None
) -> Iterator[InputWarning]:
    """A doubt about waves of the gap that the nodes do not resolve. Without an arc they lie on half of the rim."""
    first, last = options.arc or (0.0, math.pi)
    spacing = (last - first) / (options.nodes - 1) if grid is None else float(np.diff(grid.theta).min())
    most, pressed = int(2.0 * math.pi / (NODES_A_WAVE * spacing) + 1e-9), 0.0
    for profile in problem.gap.given.values():
        waves = Profile(tuple(term for term in profile.terms if not term.needs_lengths))
        amplitudes = np.abs(waves.amplitudes(problem.hole_radius))[most + 1 :]
        slopes = amplitudes * np.arange(most + 1, most + 1 + amplitudes.size) / problem.hole_radius
        pressed += 2.0 * float((slopes**2).sum())  # the mean square
    strain = max(_strains(problem, history.largest).values(), default=0.0)
    if strain and math.sqrt(pressed) > LEAST_ROUGHNESS * strain:
        nodes = options.nodes if grid is None else grid.theta.size
        yield InputWarning(
            "gap",
            f"has waves shorter than {360.0 / max(most, 1):.2g} degrees, {most} round the hole, the shortest that "
            f"{nodes} nodes resolve; they press with {math.sqrt(pressed) / strain:.2g} times the bearing stress, and "
            f"results follow the nodes; harmonics = {max(min(most, FORM), 1)} in the profile filters them",
        )


def _of_slip(problem: Problem) -> Iterator[InputWarning]:
    """A doubt about friction that is so large that slip may have several solutions; (T52)."""
    laminate = None if problem.pair.plate.is_isotropic else problem.joint.hole.laminate
    if laminate is None or laminate.is_isotropic_contact:
        return
    most = math.sqrt(max((0.5 * problem.surfaces.beta_star / abs(laminate.delta)) ** 2 - 1.0, 0.0))
    if problem.most_friction > most:
        words = f"{problem.most_friction:g} is above {most:.3g}, beyond which slip in this laminate"
        yield InputWarning("friction", f"{words} may have several solutions; fastpin follows one of them")


def _of_laminate(laminate: Laminate, problem: Problem) -> Iterator[InputWarning]:
    """Doubts about angles in rad, the thickness of the stack, and strengths of plies in MPa."""
    angles = {angle for _, angle in laminate.plies if angle}
    if angles and all(map(meant_degrees, angles)):
        first = min(angles, key=abs)
        words = f"the angles look like rad: {first:g} is {meant_degrees(first)} degrees in rad"
        yield InputWarning("layup", f"{words}; angles of plies are in degrees")
    thickness = problem.thickness
    if thickness is not None and laminate.plies and abs(laminate.thickness - thickness) > SAME_THICKNESS * thickness:
        words = (
            f"{_short(thickness)} m is not that of the stack of plies, {_short(float(f'{laminate.thickness:.6g}'))} m"
        )
        yield InputWarning("thickness", f"{words}; loads are divided by the first")
    for ply in dict.fromkeys(ply for ply, _ in laminate.plies):
        for field, value in {} if ply.strengths is None else ply.strengths.entries().items():
            if _has_units(problem) and value < LEAST_STRENGTH * ply.E2:
                words = f"{_short(value)} Pa of a ply is very small; stresses are in Pa; {_meant(value, 'MPa', 1e6)}"
                yield InputWarning(field, words)


def _of_material(name: str, material: Material, has_units: bool) -> Iterator[InputWarning]:
    if material.is_rigid or not material.is_isotropic:
        return
    nu = material.nu
    if 0.0 < nu < LEAST_NU:
        yield InputWarning("nu", f"{nu:g} of the {name} is very small; metals have 0.25 to 0.45")
    if not has_units:
        return
    if MOST_NU < nu < 0.5 and material.E >= STIFF:
        yield InputWarning("nu", f"{nu:g} of the {name} is unusual for a stiff body; metals have 0.25 to 0.45")
    strengths = {} if material.fatigue is None else material.fatigue.given()
    strengths |= material.strengths
    least = material.known_yield_strength
    if least is not None and material.ultimate_strength is not None and material.ultimate_strength < least:
        words = f"{_short(material.ultimate_strength)} Pa of the {name} is less than its yield strength"
        yield InputWarning("ultimate_strength", f"{words} of {_short(least)} Pa")
    limits = ("fatigue_strength", "shear_fatigue_strength", "bending_limit", "torsion_limit", "limit_range")
    for field in (*STRENGTHS, *limits):  # the constants that are stresses
        if field in strengths and (value := strengths[field]) < LEAST_STRENGTH * material.E:
            yield InputWarning(
                field,
                f"{_short(value)} Pa of the {name} is very small; stresses are in Pa; {_meant(value, 'MPa', 1e6)}",
            )
    if material.growth is not None:
        yield from _of_growth(name, material.growth)


def _of_growth(name: str, law: KnownLaw) -> Iterator[InputWarning]:
    """Doubts about the units of a law of crack growth."""
    for field in ("threshold_range", "toughness", "unit"):
        value = getattr(law, field)
        if value is not None and 0.0 < value < LEAST_INTENSITY:
            words = f"{_short(value)} Pa sqrt(m) of the {name} is very small"
            yield InputWarning(f"growth.{field}", f"{words}; {_meant(value, 'MPa sqrt(m)', 1e6)}")
    power = law.n if isinstance(law, Nasgro) else law.m
    rate = math.log10(law.C) + power * math.log10(TRIED_INTENSITY / law.unit)
    if not LEAST_RATE < rate < MOST_RATE:
        words = f"gives 1e{rate:.3g} m per cycle of 10 MPa sqrt(m) in the {name}"
        yield InputWarning("growth.C", f"{words}; C is the growth under the range unit, in m per cycle")


def _of_sizes(problem: Problem) -> Iterator[InputWarning]:
    """Doubts about lengths and moduli."""
    radius, clearance, moduli = problem.hole_radius, problem.clearance, _moduli(problem)
    if radius > LARGEST_HOLE and all(modulus >= STIFF for _, modulus in moduli):
        yield InputWarning(
            "hole_radius", f"{_short(radius)} m is larger than any pin; lengths are in m; {_meant(radius, 'mm', 1e-3)}"
        )
    if problem.thickness is not None and problem.thickness > THICKEST * radius:
        yield InputWarning(
            "thickness",
            f"{_short(problem.thickness)} m is more than {THICKEST:g} hole radii; lengths are in m: 5 mm is 5e-3",
        )
    if clearance < -TIGHTEST * radius:
        yield InputWarning(
            "clearance",
            f"the interference is {-100.0 * clearance / radius:.3g} % of the hole radius; metals yield at 0.5 %",
        )
    body = problem.plate_body.bush
    if body is not None and body.interference > TIGHTEST * body.outer_radius:
        yield InputWarning(
            "interference",
            f"{_short(body.interference)} m is {100.0 * body.interference / body.outer_radius:.3g} % of the outer "
            "radius of the bush; metals yield at 0.5 %",
        )


def _of_moduli(problem: Problem) -> Iterator[InputWarning]:
    """Doubts about moduli that do not fit together."""
    moduli = _moduli(problem)
    soft, stiff = min(moduli, key=_modulus), max(moduli, key=_modulus)
    if stiff[1] > STIFFEST and SOFTEST <= soft[1] <= STIFFEST:
        yield InputWarning(
            "E",
            f"{_short(stiff[1])} Pa of the {stiff[0]} is stiffer than diamond; moduli are in Pa: 69 GPa is 69e9; "
            "a body that does not deform is rigid",
        )
    elif stiff[1] > MOST_MODULI * soft[1]:
        yield InputWarning(
            "E",
            f"{_short(soft[1])} Pa of the {soft[0]} and {_short(stiff[1])} Pa of the {stiff[0]} differ by more than "
            f"a factor {MOST_MODULI:,.0f}; moduli are in Pa: 69 GPa is 69e9",
        )


def _moduli(problem: Problem) -> list[tuple[str, float]]:
    """The name and modulus of each body that is not rigid. There is at least one."""
    return [(name, material.E) for name, material in problem.joint.materials.items() if not material.is_rigid]


_modulus = operator.itemgetter(1)


def _softest(problem: Problem) -> tuple[str, float]:
    return min(_moduli(problem), key=_modulus)


def _of_loads(problem: Problem, history: LoadHistory) -> Iterator[InputWarning]:
    """Doubts about loads: whether they fit the moduli and the size."""
    largest = history.largest
    yield from _of_displacements(problem, largest)
    strains = _strains(problem, largest)
    if not strains:
        return
    name, soft = max(strains, key=lambda name: strains[name]), _softest(problem)
    if strains[name] > MOST_STRAIN:
        yield _too_large(problem, name, largest[name], strains[name])
    elif strains[name] < LEAST_STRAIN and max(_moduli(problem), key=_modulus)[1] > STIFFEST:
        yield InputWarning(
            "E", f"{_short(soft[1])} Pa of the {soft[0]} is stiffer than diamond; moduli are in Pa: 69 GPa is 69e9"
        )
    elif soft[1] >= SOFTEST:
        yield from _too_small(problem, largest, strains)


def _strains(problem: Problem, largest: dict[str, float]) -> dict[str, float]:
    """The strain by the largest value of each load: of a force by its nominal bearing stress F / (2 R)."""
    natural, share = problem.natural_loads(), {"force": 0.5, "moment": 1.0, "traction": 1.0}
    return {
        name: share[LOAD_KIND[name]] * abs(load) / natural[LOAD_KIND[name]]
        for name, load in largest.items()
        if LOAD_KIND[name] in share
    }


def _too_large(problem: Problem, name: str, load: float, strain: float) -> InputWarning:
    body, modulus = _softest(problem)
    if modulus < SOFTEST:
        unit, factor = ("GPa", 1e9) if modulus < IN_GPA else ("MPa", 1e6)
        return InputWarning(
            "E",
            f"{_short(modulus)} Pa of the {body} is softer than rubber; moduli are in Pa; "
            f"{_meant(modulus, unit, factor)}",
        )
    kind = LOAD_KIND[name]
    printed = units(problem)[kind]
    hint = f"{kind}s are in {printed.name}" if problem.thickness else f"{kind}s are per thickness, in {printed.name}"
    if kind == "traction":
        hint = "stresses are in Pa"
    return InputWarning(
        name,
        f"{_short(printed.factor * load)} {printed.name} strains the bodies by {strain:.2g}, "
        f"far beyond linear elasticity; {hint}",
    )


def _too_small(problem: Problem, largest: dict[str, float], strains: dict[str, float]) -> Iterator[InputWarning]:
    """Doubts about forces that are alone and small, and about small remote stresses."""
    radius = problem.hole_radius
    name = max(strains, key=lambda name: strains[name])
    alone = all(LOAD_KIND[other] == "force" for other, load in largest.items() if load)
    force = abs(largest[name])
    bearing = force / (2.0 * radius)
    if (
        alone
        and 0.0 < strains[name] < LEAST_STRAIN
        and bearing < (LEAST_BEARING if problem.thickness is None else LEAST_FORCE_BEARING)
        and not problem.is_gripped
        and radius <= LARGEST_HOLE
        and force != 1.0
    ):
        unit = units(problem)["force"]
        hint = (
            "forces are per thickness, in N/m: 1 N/mm is 1e3; divide a force in N by the thickness in m, or give the "
            "thickness"
        )
        yield InputWarning(
            name,
            f"{_short(unit.factor * largest[name])} {unit.name} is a bearing stress of {_mega(bearing)} only; "
            + (hint if problem.thickness is None else "forces are in N: 1 kN is 1e3"),
        )
    for name in ("sxx", "syy", "sxy"):
        stress = abs(largest.get(name, 0.0))
        if 0.0 < stress < LEAST_STRESS and stress != 1.0:
            yield InputWarning(
                name,
                f"{_short(largest[name])} Pa is very small; stresses are in Pa; {_meant(largest[name], 'MPa', 1e6)}",
            )


def _of_displacements(problem: Problem, largest: dict[str, float]) -> Iterator[InputWarning]:
    rotation = largest.get("rotation", 0.0)
    if abs(rotation) > MOST_ROTATION and problem.rotation == "fixed":
        yield InputWarning(
            "rotation", f"{rotation:g} rad is {math.degrees(rotation):.3g} degrees; rotations are in rad, and small"
        )
    free = max(map(abs, problem.clearances))
    for name in ("ux", "uy"):
        shift = largest.get(name, 0.0)
        if abs(shift) - free > MOST_SHIFT * problem.hole_radius:
            parts = abs(shift) / problem.hole_radius
            yield InputWarning(name, f"{_short(shift)} m is {parts:.2g} hole radii; lengths are in m: 1 mm is 1e-3")
