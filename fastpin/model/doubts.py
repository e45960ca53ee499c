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
import warnings
from collections.abc import Iterable, Iterator
from contextvars import ContextVar
from itertools import starmap
from operator import itemgetter

import numpy as np

from fastpin.errors import InputWarning
from fastpin.model.angles import meant_degrees
from fastpin.model.grid import Grid
from fastpin.model.growth import Nasgro
from fastpin.model.history import LoadHistory
from fastpin.model.laminate import Laminate
from fastpin.model.loads import LOAD_KIND
from fastpin.model.materials import STRENGTHS, Material
from fastpin.model.options import SolveOptions
from fastpin.model.points import owner_of
from fastpin.model.problem import LOOKED_AT, Problem
from fastpin.model.profile import Profile
from fastpin.model.profile_terms import MOST_ANGLE
from fastpin.model.unit_systems import SI
from fastpin.model.units import system_words, units
from fastpin.model.wear import Wear

STIFF = 1e9
"""Young's modulus, Pa, above which a body is stiff: no solid with a ratio near 0.5, such as rubber, reaches it."""

SOFTEST, STIFFEST = 1e6, 2e13
"""Young's moduli, Pa, of the softest rubber, and above diamond: it has 1.2e12 Pa, or 1.2e13 dyn/cm^2."""

MOST_STRAIN = 0.1
"""Strain by the loads above which something is wrong. Metals yield below 0.01, and rubber is not linear then."""

LEAST_STRAIN = 3e-4
"""Strain from which no bearing stress is small: soft plastics and rubber carry 1 MPa and less."""

LARGEST_HOLE = 1.0
"""Hole radius, m, above which it is probably in mm: pins of large bridges and cranes have half of it."""

LEAST_STRENGTH = 1e-5
"""Strength in parts of Young's modulus, below which it is probably in MPa: a pure soft metal yields at 1e-4."""

EDGES = {
    "hole": ("plate", "at the hole of the plate"),
    "bore of the bush": ("bush", "in the bore of the bush"),
    "rim of the bush": ("bush", "on the outer rim of the bush"),
    "seat": ("plate", "of the plate at the seat of the bush"),
    "pin": ("pin", "on the surface of the pin"),
    "bore of the pin": ("pin", "in the bore of the pin"),
}
"""Edges of the bodies: the name of the body, and words for the place."""

Doubt = tuple[str, str]
"""A field, and the sentence on it."""

_GIVEN: ContextVar[bool] = ContextVar("given", default=False)


def doubts(
    problem: Problem,
    history: LoadHistory | None = None,
    options: SolveOptions | None = None,
    grid: Grid | None = None,
) -> list[InputWarning]:
    """Return a warning for each doubtful value of a problem, its loads and the options of the solver, or its grid."""
    pairs, has_units = [*_of_contact(problem)], _has_units(problem)
    for name, material in problem.joint.materials.items():
        if isinstance(material, Laminate):
            pairs += _of_laminate(material, problem)
        elif not material.is_rigid and material.is_isotropic:
            pairs += _of_material(name, material, problem)
    if options is not None and options.arc is not None:
        angle = max(options.arc, key=abs)
        if abs(angle) > MOST_ANGLE:
            pairs.append(("arc", f"{angle:g} rad is more than two turns; angles are in rad"))
    if history is not None and options is not None and problem.gap:
        pairs += _of_roughness(problem, history, options, grid)
    sizes = [*_of_sizes(problem)] if has_units else []
    found = [*starmap(InputWarning, pairs + sizes)]
    if has_units:
        if not {"clearance", "interference"} & {field for field, _ in sizes}:
            stresses = problem.joint.assembly_stresses(problem.assembled_clearance)
            found += filter(None, (yield_doubt(problem, *stress, "before any load") for stress in stresses.items()))
        loads = [] if history is None else [*_of_loads(problem, history.largest)]
        moduli = [] if any(field == "E" for field, _ in loads) else [*_of_moduli(problem)]
        found += starmap(InputWarning, loads + moduli)
    return found


def wear_doubts(problem: Problem, wear: Wear) -> list[InputWarning]:
    """Return a warning for a coefficient of wear that is probably in another unit."""
    theta = np.linspace(-math.pi, math.pi, LOOKED_AT)
    most = float(wear.coefficients(problem.hole_radius, theta).sum(axis=0).max())
    # Archard's coefficient times the hardness is the part of touching asperities that wears off: below 0.01 even for
    # severe wear. The hardness of metals is some 1/30 of their modulus, so a coefficient of beta* makes this part 0.1.
    if not _has_units(problem) or most <= problem.surfaces.beta_star:
        return []
    unit = units(problem)["wear coefficient"]
    hint = "numbers in 1/MPa are to be multiplied by 1e-6, numbers in mm^3/(N m) by 1e-9"
    hint = hint if problem.unit_system == SI else f"wear coefficients are in {unit.name}"
    return [InputWarning("coefficient", f"{unit.text(most, 3)} is more than any surface wears; {hint}")]


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
    peak = max((float(pressure.max(initial=0.0)) for pressure in distinct.values()), default=0.0)
    strain = problem.surfaces.beta_star * peak  # linear elasticity fails above 0.05
    if strain > 0.05 and _has_units(problem):
        words = f"contact strains of about {strain:.2g} are beyond linear elasticity"
        found.append(f"{words}; are all values in {system_words(problem)}?")
    for body, material in (("pin", problem.pair.pin), ("plate", problem.surfaces.plate)):
        strength = material.known_yield_strength
        if strength is not None and peak > strength >= LEAST_STRENGTH * material.E:
            words = f"{_stress(problem, peak)} is above the yield strength {_stress(problem, strength)} of the"
            words = f"{words} {owner_of(problem, body)}; fastpin is elastic, but a real contact yields there"
            found.append(words)
    return [InputWarning("peak pressure", words) for words in found]


def are_loads_plausible(problem: Problem, history: LoadHistory) -> bool:
    """Whether stresses can be compared with strengths: there are units, and the loads do not strain bodies by 0.1."""
    return not problem.dimensionless and max(_strains(problem, history.largest).values(), default=0.0) <= MOST_STRAIN


def yield_doubt(problem: Problem, edge: str, stress: float, where: str) -> InputWarning | None:
    """A warning if the von Mises `stress`, Pa, at an edge exceeds the yield strength there.

    The edge is one of :data:`EDGES`, or a further one of the plate. `where` tells the angle and the load, for example
    "before any load".
    """
    name, words = EDGES.get(edge, ("plate", "in the plate"))
    material = problem.joint.materials[name]
    strength = material.known_yield_strength
    if strength is None or not stress > strength >= LEAST_STRENGTH * material.E:
        return None
    return InputWarning(
        "von Mises stress",
        f"{_stress(problem, stress)} {words}, {where}, is above the yield strength {_stress(problem, strength)} of the "
        f"{name}; "
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


def _text(problem: Problem, kind: str, value: float) -> str:
    """A value with the unit in which it is printed and read, without a prefix."""
    unit = units(problem)[kind]
    return f"{_short(float(f'{unit.factor * value:.12g}'))} {unit.name}"


def _hint(problem: Problem, words: str, kind: str, meant: str = "") -> str:
    """The unit of a kind of quantity, and in SI units what was `meant`, or an example."""
    return f"{words} are in {units(problem)[kind].name}{meant if problem.unit_system == SI else ''}"


def _meant(value: float, unit: str, factor: float) -> str:
    """The question whether a number was meant in another unit. It is rounded as one would write it."""
    rounded = float(f"{value:.3g}")
    return f"; did you mean {_short(rounded)} {unit}, which is {_short(factor * rounded)}?"


def _stress(problem: Problem, stress: float) -> str:
    return f"{stress / 1e6:.4g} MPa" if problem.unit_system == SI else units(problem)["traction"].text(stress, 4)


def _of_contact(problem: Problem) -> Iterator[Doubt]:
    """Doubts about friction, also where slip may have several solutions (T52), and about the clearance."""
    friction, laminate = problem.most_friction, problem.joint.hole.laminate
    # Clean metals reach 1.5, and 200 is as much in percent. Beyond, a pin is meant to stick wherever it touches.
    if 2.0 < friction <= 200.0:
        percent = float(f"{friction:.2g}")
        words = f"{friction:g} is above 2, more than dry metals have"
        yield "friction", f"{words}; did you mean {percent:g} %, which is {percent / 100:g}?"
    if not problem.dimensionless and problem.clearance > 0.5 * problem.hole_radius:
        size, radius = (_text(problem, "length", each).split()[0] for each in (problem.clearance, problem.hole_radius))
        words = f"{size} is more than half of the hole radius {radius}"
        yield "clearance", f"{words}; clearance is the hole radius minus the pin radius"
    if not problem.pair.plate.is_isotropic and laminate is not None and not laminate.is_isotropic_contact:
        most = math.sqrt(max((0.5 * problem.surfaces.beta_star / abs(laminate.delta)) ** 2 - 1.0, 0.0))
        if friction > most:
            words = f"{friction:g} is above {most:.3g}, beyond which slip in this laminate"
            yield "friction", f"{words} may have several solutions; fastpin follows one of them"


def _of_roughness(problem: Problem, history: LoadHistory, options: SolveOptions, grid: Grid | None) -> Iterator[Doubt]:
    """A doubt about waves of the gap that the nodes do not resolve. Without an arc they lie on half of the rim.

    A wave with n periods round the hole and the amplitude A presses with 2 n A/(R beta*), up and down, where it is
    closed.
    """
    first, last = options.arc or (0.0, math.pi)
    spacing = (last - first) / (options.nodes - 1) if grid is None else float(np.diff(grid.theta).min())
    # The pressure of a wave is right to 3 % with 8 nodes a wave.
    most, pressed = int(2.0 * math.pi / (8 * spacing) + 1e-9), 0.0
    for profile in problem.gap.given.values():
        waves = Profile(tuple(term for term in profile.terms if not term.needs_lengths))
        amplitudes = np.abs(waves.amplitudes(problem.hole_radius))[most + 1 :]
        slopes = amplitudes * np.arange(most + 1, most + 1 + amplitudes.size) / problem.hole_radius
        pressed += 2.0 * float((slopes**2).sum())  # the mean square
    strain = max(_strains(problem, history.largest).values(), default=0.0)
    if strain and math.sqrt(pressed) > 0.03 * strain:
        nodes = options.nodes if grid is None else grid.theta.size
        form = 15  # waves by which a roundness tester gives the form of a hole, without its roughness
        yield (
            "gap",
            f"has waves shorter than {360.0 / max(most, 1):.2g} degrees, {most} round the hole, the shortest that "
            f"{nodes} nodes resolve; they press with {math.sqrt(pressed) / strain:.2g} times the bearing stress, and "
            f"results follow the nodes; harmonics = {max(min(most, form), 1)} in the profile filters them",
        )


def _of_laminate(laminate: Laminate, problem: Problem) -> Iterator[Doubt]:
    """Doubts about angles in rad, the thickness of the stack, and strengths of plies in MPa."""
    angles = {angle for _, angle in laminate.plies if angle}
    if angles and all(map(meant_degrees, angles)):
        first = min(angles, key=abs)
        words = f"the angles look like rad: {first:g} is {meant_degrees(first)} degrees in rad"
        yield "layup", f"{words}; angles of plies are in degrees"
    thickness = problem.thickness  # that of the stack may differ by 1 %, the rounding of the plies
    if thickness is not None and laminate.plies and abs(laminate.thickness - thickness) > 0.01 * thickness:
        stack = _text(problem, "length", float(f"{laminate.thickness:.6g}"))
        words = f"{_text(problem, 'length', thickness)} is not that of the stack of plies, {stack}"
        yield "thickness", f"{words}; loads are divided by the first"
    for ply in dict.fromkeys(ply for ply, _ in laminate.plies):
        for field, value in {} if ply.strengths is None else ply.strengths.entries().items():
            if _has_units(problem) and value < LEAST_STRENGTH * ply.E2:
                hint = _hint(problem, "stresses", "traction", _meant(value, "MPa", 1e6))
                yield field, f"{_text(problem, 'traction', value)} of a ply is very small; {hint}"


def _of_material(name: str, material: Material, problem: Problem) -> Iterator[Doubt]:
    """Doubts about an elastic material. Stiff solids have nu from 0.05, as beryllium, to 0.46; indium has 0.45."""
    nu = material.nu  # 0 and 0.5 themselves are chosen on purpose
    if 0.0 < nu < 0.05:
        yield "nu", f"{nu:g} of the {name} is very small; metals have 0.25 to 0.45"
    if not _has_units(problem):
        return
    if 0.46 < nu < 0.5 and material.E >= STIFF:
        yield "nu", f"{nu:g} of the {name} is unusual for a stiff body; metals have 0.25 to 0.45"
    least, ultimate = material.known_yield_strength, material.ultimate_strength
    if least is not None and ultimate is not None and ultimate < least:
        strength, limit = (_text(problem, "traction", each) for each in (ultimate, least))
        yield "ultimate_strength", f"{strength} of the {name} is less than its yield strength of {limit}"
    strengths = ({} if material.fatigue is None else material.fatigue.given()) | material.strengths
    limits = ("fatigue_strength", "shear_fatigue_strength", "bending_limit", "torsion_limit", "limit_range")
    for field in (*STRENGTHS, *limits):  # the constants that are stresses
        if field in strengths and (value := strengths[field]) < LEAST_STRENGTH * material.E:
            hint = _hint(problem, "stresses", "traction", _meant(value, "MPa", 1e6))
            yield field, f"{_text(problem, 'traction', value)} of the {name} is very small; {hint}"
    law = material.growth
    if law is None:
        return
    for field in ("threshold_range", "toughness", "unit"):
        value = getattr(law, field)
        if value is not None and 0.0 < value < 1e3:  # a thousandth of the threshold of metals
            words = f"{_text(problem, 'stress intensity', value)} of the {name} is very small"
            meant = _meant(value, "MPa sqrt(m)", 1e6) if problem.unit_system == SI else ""
            yield f"growth.{field}", f"{words}{meant}"
    power = law.n if isinstance(law, Nasgro) else law.m
    rate = math.log10(law.C) + power * math.log10(1e7 / law.unit)
    if not -12.0 < rate < -4.0:  # the powers of ten, m, between which metals grow in this cycle
        words = f"gives 1e{rate:.3g} m per cycle of 10 MPa sqrt(m) in the {name}"
        length = units(problem)["length"].name
        yield "growth.C", f"{words}; C is the growth under the range unit, in {length} per cycle"


def _of_sizes(problem: Problem) -> Iterator[Doubt]:
    """Doubts about lengths."""
    radius, clearance, bush = problem.hole_radius, problem.clearance, problem.plate_body.bush
    tightest = 0.02  # interference in parts of the radius above which a body yields
    if radius > LARGEST_HOLE and _softest_and_stiffest(problem)[0][1] >= STIFF:
        hint = _hint(problem, "lengths", "length", _meant(radius, "mm", 1e-3))
        yield "hole_radius", f"{_text(problem, 'length', radius)} is larger than any pin; {hint}"
    if problem.thickness is not None and problem.thickness > 50.0 * radius:  # such a long pin bends
        words = f"{_text(problem, 'length', problem.thickness)} is more than 50 hole radii"
        yield "thickness", f"{words}; {_hint(problem, 'lengths', 'length', ': 5 mm is 5e-3')}"
    if clearance < -tightest * radius:
        words = f"the interference is {-100.0 * clearance / radius:.3g} % of the hole radius"
        yield "clearance", f"{words}; metals yield at 0.5 %"
    if bush is not None and bush.interference > tightest * bush.outer_radius:
        words = (
            f"{_text(problem, 'length', bush.interference)} is {100.0 * bush.interference / bush.outer_radius:.3g} %"
        )
        yield "interference", f"{words} of the outer radius of the bush; metals yield at 0.5 %"


def _of_moduli(problem: Problem) -> Iterator[Doubt]:
    """Doubts about moduli that do not fit together. Steel and rubber differ by a factor of 2e5."""
    (soft, least), (stiff, most) = _softest_and_stiffest(problem)
    if most > STIFFEST and SOFTEST <= least <= STIFFEST:
        yield "E", f"{_beyond_diamond(problem, stiff, most)}; a body that does not deform is rigid"
    elif most > 1e6 * least:
        low, high = (_text(problem, "modulus", each) for each in (least, most))
        words = f"{low} of the {soft} and {high} of the {stiff} differ by more than a factor 1,000,000"
        yield "E", f"{words}; {_hint(problem, 'moduli', 'modulus', ': 69 GPa is 69e9')}"


def _beyond_diamond(problem: Problem, name: str, modulus: float) -> str:
    hint = _hint(problem, "moduli", "modulus", ": 69 GPa is 69e9")
    return f"{_text(problem, 'modulus', modulus)} of the {name} is stiffer than diamond; {hint}"


def _softest_and_stiffest(problem: Problem) -> tuple[tuple[str, float], tuple[str, float]]:
    """The name and the modulus of the softest and of the stiffest body that is not rigid. There is at least one."""
    moduli = [(name, material.E) for name, material in problem.joint.materials.items() if not material.is_rigid]
    return min(moduli, key=itemgetter(1)), max(moduli, key=itemgetter(1))


def _strains(problem: Problem, largest: dict[str, float]) -> dict[str, float]:
    """The strain by the largest value of each load: of a force by its nominal bearing stress F / (2 R)."""
    natural, share = problem.natural_loads(), {"force": 0.5, "moment": 1.0, "traction": 1.0}
    return {
        name: share[LOAD_KIND[name]] * abs(load) / natural[LOAD_KIND[name]]
        for name, load in largest.items()
        if LOAD_KIND[name] in share
    }


def _of_loads(problem: Problem, largest: dict[str, float]) -> Iterator[Doubt]:
    """Doubts about loads: whether they fit the moduli and the size."""
    rotation = largest.get("rotation", 0.0)
    if abs(rotation) > 0.2 and problem.rotation == "fixed":
        yield "rotation", f"{rotation:g} rad is {math.degrees(rotation):.3g} degrees; rotations are in rad, and small"
    free = max(map(abs, problem.clearances))
    for name in ("ux", "uy"):
        shift = abs(largest.get(name, 0.0))
        if shift - free > 0.05 * problem.hole_radius:  # a strain of that size
            words = f"{_text(problem, 'displacement', largest[name])} is {shift / problem.hole_radius:.2g} hole radii"
            yield name, f"{words}; {_hint(problem, 'lengths', 'length', ': 1 mm is 1e-3')}"
    strains = _strains(problem, largest)
    if not strains:
        return
    (soft, least), (_, most) = _softest_and_stiffest(problem)
    name = max(strains, key=lambda name: strains[name])
    if strains[name] > MOST_STRAIN and least < SOFTEST:
        # A modulus below 2e3 is probably in GPa, one above in MPa: no solid has more than 1,300 GPa.
        meant = _meant(least, "GPa", 1e9) if least < 2e3 else _meant(least, "MPa", 1e6)
        words = f"{_text(problem, 'modulus', least)} of the {soft} is softer than rubber"
        yield "E", f"{words}; {_hint(problem, 'moduli', 'modulus', meant)}"
    elif strains[name] > MOST_STRAIN:
        kind = LOAD_KIND[name]
        printed = units(problem)[kind].name
        hint = f"{kind}s are in" if problem.thickness else f"{kind}s are per thickness, in"
        hint = f"stresses are in {printed}" if kind == "traction" else f"{hint} {printed}"
        words = f"{_text(problem, kind, largest[name])} strains the bodies by {strains[name]:.2g}"
        yield name, f"{words}, far beyond linear elasticity; {hint}"
    elif strains[name] < LEAST_STRAIN and most > STIFFEST:
        yield "E", _beyond_diamond(problem, soft, least)
    elif least >= SOFTEST:
        yield from _of_small_loads(problem, largest, name, strains[name])


def _of_small_loads(problem: Problem, largest: dict[str, float], name: str, strain: float) -> Iterator[Doubt]:
    """Doubts about forces that are alone and small, and about small remote stresses. `name` strains the bodies most.

    Joints carry bearing stresses F/(2 R) of 10 to 500 MPa. In plates of 1 to 20 mm a force in N in place of N/m has 1
    to 20 thousandths of its bearing stress, mostly below 3 MPa; a force in kN in place of N has one thousandth.
    """
    thickness, radius, force = problem.thickness, problem.hole_radius, abs(largest[name])
    bearing = force / (2.0 * radius)
    is_small = 0.0 < strain < LEAST_STRAIN and bearing < (3e6 if thickness is None else 1e6) and force != 1.0
    is_alone = all(LOAD_KIND[other] == "force" for other, load in largest.items() if load)
    if is_small and is_alone and not problem.is_gripped and radius <= LARGEST_HOLE:
        hint = _hint(problem, "forces", "force", ": 1 kN is 1e3")
        if thickness is None:
            name_of_unit, example = units(problem)["force"].name, ": 1 N/mm is 1e3" if problem.unit_system == SI else ""
            hint = (
                f"forces are per thickness, in {name_of_unit}{example}; divide a force in N by the thickness in m, or"
            )
            hint = f"{hint} give the thickness"
        words = f"{_text(problem, 'force', largest[name])} is a bearing stress of {_stress(problem, bearing)} only"
        yield name, f"{words}; {hint}"
    for name in ("sxx", "syy", "sxy"):
        if 0.0 < (stress := abs(largest.get(name, 0.0))) < 2e3 and stress != 1.0:  # no metal carries 2,000 MPa
            hint = _hint(problem, "stresses", "traction", _meant(largest[name], "MPa", 1e6))
            yield name, f"{_text(problem, 'traction', largest[name])} is very small; {hint}"
