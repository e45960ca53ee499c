"""The controls of the page: what a problem lets one change, with limits of the sliders, and what a change means."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from fastpin.bodies.body import MOST_DRY, Control, PlateBody
from fastpin.bodies.kinds import PINS, PLATES, SOLID_PIN
from fastpin.bodies.pins import Tube
from fastpin.errors import InputError
from fastpin.model import InitialGap, Laminate, Problem, Profile, angles, checks, loads, synonyms
from fastpin.model.acting import check_loads
from fastpin.model.fields import FIELDS
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, PLANES, Material, MaterialPair
from fastpin.model.profile_terms import Term
from fastpin.model.units import DEGREE, PLAIN, Unit, units

OWN = "other"
"""The choice of a material that is not in :data:`fastpin.MATERIALS`: its E and nu are given."""

RIGID = "rigid"
"""The choice of a rigid material."""

MISFITS = 1.5
"""End of the sliders of clearance and initial gap, in parts of the larger of them, or of the displacement under the
usual force."""

GAPS = ("hole", "pin")
"""The bodies whose initial gaps have controls."""

TITLES = {kind: made.title for kind, made in PLATES.items() if made.title}
"""The kinds of plates that can be chosen, with their names on the page."""

PIN_CONTROLS = tuple(dict.fromkeys(name for made in PINS.values() for name in made.controlled))
"""Names of the controls of pins."""

PLATE_CONTROLS = tuple(dict.fromkeys(name for made in PLATES.values() for name in made.controlled))
"""Names of the controls of plates. They are names of fields."""

FRICTION_ALONG = {"case": "as in the case", "uniform": "uniform"}
"""The choices of the friction along the rim, where that of the case varies."""


class ControlScales:
    """Sizes of the loads and displacements of a case. They stay as they are while the problem changes.

    Attributes
    ----------
    force : float
        Largest force on the pin in the history, N/m; that of the strain 1e-3 if there is none.
    displacement : float
        Largest prescribed displacement, or else the clearance and the displacement under the force together, m.
    ratio : float
        A usual change of the friction.
    temperature : float
        Largest rise of a temperature in the history, or a usual one, K.
    stress : float
        Bearing stress of the force or largest remote stress, whichever is larger, Pa.
    misfit : float
        Clearance or displacement under the force, whichever is larger, m.
    gap : float
        Clearance or initial gap, whichever is larger, m; the displacement under the force if there is neither.
    """

    def __init__(self, problem: Problem, history: LoadHistory) -> None:
        largest = dict(zip(loads.LOADS, abs(history.distinct()).max(axis=0).tolist(), strict=True))
        natural = problem.natural_loads()
        self.force = math.hypot(largest["P"], largest["Q"]) or 1e-3 * natural["force"]  # a usual strain
        yielded = self.force * problem.surfaces.beta_star
        self.displacement = max(largest["ux"], largest["uy"]) or abs(problem.assembled_clearance) + yielded
        self.stress = max(0.5 * self.force / problem.hole_radius, *(largest[name] for name in ("sxx", "syy", "sxy")))
        self.moment = max(largest["M"], max(problem.most_friction, 0.1) * self.force * problem.hole_radius)
        self.rotation = max(largest["rotation"], yielded / problem.hole_radius)
        self.ratio = 0.5
        self.temperature = max(largest["temperature"], largest["pin_temperature"]) or 100.0
        largest_gap = max(abs(each - problem.assembled_clearance) for each in problem.clearances)
        self.misfit = max(abs(problem.clearance), yielded)
        self.gap = max(abs(problem.clearance), largest_gap) or yielded
        self._friction, self._most_friction = problem.friction, problem.most_friction

    @property
    def has_varying_friction(self) -> bool:
        """Whether the friction of the case varies along the rim."""
        return isinstance(self._friction, Profile) and self._most_friction > 0.0

    def friction_along(self, along: str, most: float) -> float | Profile:
        """The friction of the case along the rim, scaled to a largest coefficient; or this coefficient all round."""
        if checks.choice("friction_along", along, tuple(FRICTION_ALONG)) == "uniform":
            return most
        if not self.has_varying_friction:
            raise InputError("most_friction", "the friction of the case is the same all round")
        return Profile.of("friction", self._friction).scaled(
            checks.not_negative("friction", most) / self._most_friction
        )

    def of_load(self, name: str) -> float:
        """The size of a load."""
        kind = loads.LOAD_KIND[name]
        return float(getattr(self, {"traction": "stress"}.get(kind, kind)))


def load_controls(problem: Problem, scales: ControlScales) -> list[dict[str, Any]]:
    """The loads that the problem allows, with their units and sizes."""
    unit = units(problem)
    found = []
    for name, kind in loads.LOAD_KIND.items():
        try:
            check_loads(problem, LoadHistory([{name: scales.of_load(name)}]))
        except InputError:
            continue
        found.append({"name": name, "unit": asdict(unit[kind]), "size": scales.of_load(name)})
    return found


def problem_controls(problem: Problem, scales: ControlScales) -> list[dict[str, Any]]:
    """The fields of the problem that can be changed: their group, value, unit, and ends of the slider or choices."""
    unit = units(problem)
    misfit = MISFITS * scales.misfit
    return [
        *_friction(problem, scales),
        _slider("contact", "clearance", problem.clearance, unit["displacement"], -misfit, misfit),
        _chooser("contact", "plane", problem.pair.plane, PLANES),
        *(control for body in GAPS for control in _gap(problem, body, unit["displacement"], MISFITS * scales.gap)),
        *_material("pin", problem.pair.pin, unit["modulus"]),
        *_pin(problem, unit),
        *_plate_material(problem, unit),
        *_plate(problem, unit),
    ]


def changed_fields(problem: Problem, changes: Mapping[str, Any], scales: ControlScales) -> dict[str, Any]:
    """The fields of the problem that changes of controls mean.

    Parameters
    ----------
    problem : Problem
    changes : mapping
        New values by the names of controls.
    scales : ControlScales
        Those of the case.

    Returns
    -------
    dict
        Arguments of :meth:`fastpin.Session.change`.

    Raises
    ------
    InputError
        If there is no such control, or a value can't be used.
    """
    for name in changes:
        if name not in NAMES:
            raise InputError(name, f"is no control of the page{synonyms.closest(name, NAMES)}")
    fields: dict[str, Any] = {}
    for name in ("friction", "clearance", "pin_load", "rotation"):
        if name in changes:
            fields[name] = changes[name]
    if changes.keys() & {"most_friction", "friction_along"}:
        most = changes.get("most_friction", problem.most_friction)
        fields["friction"] = scales.friction_along(changes.get("friction_along", "case"), most)
    if changes.keys() & set(GAP_CONTROLS):
        fields["gap"] = InitialGap(
            **{body: _changed_profile(getattr(problem.gap, body), body, changes, 0.5 * scales.gap) for body in GAPS}
        )
    if changes.keys() & {"plane", AXIS, *_names_of_material("pin"), *_names_of_material("plate")}:
        fields["pair"] = MaterialPair(
            _changed_material(problem.pair.pin, "pin", changes),
            _changed_plate_material(problem.pair.plate, changes),
            changes.get("plane", problem.pair.plane),
        )
    if changes.keys() & PIN_CONTROLS:
        bore = checks.number("pin_bore", changes.get("pin_bore", problem.pin_body.bore_radius))
        load = changes.get("bore_load", problem.pin_body.load or "uniform")
        fields["pin_body"] = Tube(bore, load) if bore else SOLID_PIN
        if fields["pin_body"] != SOLID_PIN:
            fields["pin_load"] = "centre"  # the load of a hollow pin is a field of its body
    if changes.keys() & {"plate_body", *PLATE_CONTROLS, *_names_of_material("bush")}:
        fields["plate_body"] = _changed_plate(problem, changes)
    return fields


def _names_of_material(body: str) -> tuple[str, ...]:
    return f"{body}_material", f"{body}_E", f"{body}_nu"


GAP_CONTROLS = tuple(f"{body}_{name}" for body in GAPS for name in ("lobes", "amplitude", "axis"))
"""Names of the controls of initial gaps."""

AXIS = "plate_axis"
"""Name of the control of the axis of a laminate."""

NAMES = (
    "friction",
    "most_friction",
    "friction_along",
    *GAP_CONTROLS,
    "clearance",
    "plane",
    "pin_load",
    "rotation",
    *PIN_CONTROLS,
    "plate_body",
    *PLATE_CONTROLS,
    AXIS,
    *(name for body in ("pin", "plate", "bush") for name in _names_of_material(body)),
)
"""Names of all controls of problems."""


def _slider(group: str, name: str, value: float | None, unit: Unit, least: float, most: float) -> dict[str, Any]:
    return {"group": group, "name": name, "value": value, "unit": asdict(unit), "least": least, "most": most}


def _chooser(group: str, name: str, value: str, choices: Mapping[str, str] | tuple[str, ...]) -> dict[str, Any]:
    names = dict(choices) if isinstance(choices, Mapping) else {word: word for word in choices}
    return {"group": group, "name": name, "value": value, "choices": names}


def _friction(problem: Problem, scales: ControlScales) -> list[dict[str, Any]]:
    """The controls of the friction: its coefficient, or the largest one and whether it varies along the rim."""
    varies = isinstance(problem.friction, Profile)
    name = "most_friction" if varies else "friction"
    found = [_slider("contact", name, problem.most_friction, PLAIN, 0.0, MOST_DRY)]
    if scales.has_varying_friction:
        found.append(_chooser("contact", "friction_along", "case" if varies else "uniform", FRICTION_ALONG))
    return found


def _lobes(profile: Profile) -> tuple[int, float, float, tuple[Term, ...]]:
    """The lobes that the page controls: the first wave of a profile with two of them or more.

    Their number, their amplitude, m, the angle of the one next to the bottom, degrees from there, and the other terms
    of the profile. Without such a wave the number is 0.
    """
    for place, term in enumerate(profile.terms):
        count, amplitude = term.wave or (0, 0j)
        if count > 1:
            angle = angles.degrees_from_bottom(-cmath.phase(amplitude) / count)
            rest = (*profile.terms[:place], *profile.terms[place + 1 :])
            return count, abs(amplitude), angle - round(angle * count / 360.0) * 360.0 / count, rest
    return 0, 0.0, 0.0, profile.terms


def _forms(count: int) -> dict[str, str]:
    """The forms of hole and pin that can be chosen, with that of so many lobes: their numbers of lobes, and words."""
    forms = {"0": "no lobes", "2": "oval"} | {str(lobes): f"{lobes} lobes" for lobes in (3, 4, 5, 6, 8, 12)}
    return forms | ({} if str(count) in forms else {str(count): f"{count} lobes"})


def _gap(problem: Problem, body: str, unit: Unit, most: float) -> list[dict[str, Any]]:
    """The controls of the initial gap of a body. The sliders of its lobes do not reach 0, where lobes are gone."""
    count, amplitude, angle, _ = _lobes(getattr(problem.gap, body))
    found = [_chooser("gap", f"{body}_lobes", str(count), _forms(count))]
    if count:
        found.append(_slider("gap", f"{body}_amplitude", amplitude, unit, 0.01 * most, most))
        found.append(_slider("gap", f"{body}_axis", angle, DEGREE, -180.0 / count, 180.0 / count))
    return found


def _changed_profile(profile: Profile, body: str, changes: Mapping[str, Any], usual: float) -> Profile:
    """The profile of a body after changes of its lobes. Its other terms stay. New lobes have the `usual` amplitude."""
    before, present, angle, rest = _lobes(profile)
    lobes, amplitude, axis = (f"{body}_{name}" for name in ("lobes", "amplitude", "axis"))
    count = int(checks.choice(lobes, changes.get(lobes, str(before)), tuple(_forms(before))))
    height = checks.number(amplitude, changes.get(amplitude, present if before else usual))
    angle = checks.number(axis, changes.get(axis, angle), -360.0, 360.0)
    new = Profile.lobes(count, height, angles.angle_at(angle)).terms if count and height else ()
    return Profile((*new, *rest))


def _material(body: str, material: Material, unit: Unit) -> list[dict[str, Any]]:
    known = MATERIALS.get(material.name)
    alike = known is not None and (known.E, known.nu) == (material.E, material.nu)
    chosen = RIGID if material.is_rigid else material.name if alike else OWN
    found = [_chooser(body, f"{body}_material", chosen, (*MATERIALS, *([RIGID] * (body != "bush")), OWN))]
    if not material.is_rigid:
        found.append(_slider(body, f"{body}_E", material.E, unit, 0.1 * material.E, 3.0 * material.E))
        found.append(_slider(body, f"{body}_nu", material.nu, PLAIN, 0.0, 0.5))
    return found


def _changed_material(material: Material, body: str, changes: Mapping[str, Any]) -> Material:
    name, modulus, ratio = _names_of_material(body)
    if name in changes:
        chosen = checks.choice(name, changes[name], (*MATERIALS, RIGID, OWN))
        if chosen != OWN:
            return Material.rigid() if chosen == RIGID else MATERIALS[chosen]
        if material.is_rigid:  # a rigid body has no moduli to go on from
            material = MATERIALS["steel"]
        return Material(material.E, material.nu, fatigue=material.fatigue)
    if not changes.keys() & {modulus, ratio}:
        return material
    return Material(changes.get(modulus, material.E), changes.get(ratio, material.nu))


def _plate_material(problem: Problem, unit: Mapping[str, Unit]) -> list[dict[str, Any]]:
    """The controls of the material of the plate. Of a laminate it is the axis, from -90 to 90 deg from the bottom."""
    plate = problem.pair.plate
    if plate.is_isotropic:
        return _material("plate", plate, unit["modulus"])
    angle = math.remainder(plate.toml()["axis"], 180.0)  # half a turn gives the same plate
    return [_slider("plate", AXIS, angle, DEGREE, -90.0, 90.0)]


def _changed_plate_material(plate: Material, changes: Mapping[str, Any]) -> Material:
    """The material of the plate after changes."""
    if not isinstance(plate, Laminate):
        if AXIS in changes:
            raise InputError(AXIS, "belongs to a laminate, and the plate is isotropic")
        return _changed_material(plate, "plate", changes)
    for name in _names_of_material("plate"):
        if name in changes:
            raise InputError(name, "can't be changed: the plate is a laminate")
    if AXIS not in changes:
        return plate
    return replace(plate, axis=angles.angle_at(checks.number(AXIS, changes[AXIS], -360.0, 360.0)))


def _of_body(group: str, controls: Sequence[Control], unit: Mapping[str, Unit]) -> list[dict[str, Any]]:
    """The controls of a body."""
    found = []
    for each in controls:
        if isinstance(each.value, Material):
            found += _material(each.name, each.value, unit["modulus"])
        elif each.choices:
            found.append(_chooser(group, each.name, each.value, each.choices))
        else:
            found.append(_slider(group, each.name, each.value, unit[each.kind], each.least, each.most))
    return found


def _pin(problem: Problem, unit: Mapping[str, Unit]) -> list[dict[str, Any]]:
    found = _of_body("pin", problem.pin_body.page_controls(problem.hole_radius), unit)
    if problem.pin_body == SOLID_PIN and not problem.held and problem.drive == "force":
        found.append(_chooser("pin", "pin_load", problem.pin_load, FIELDS["pin_load"].choices))
    if problem.pin_load != "body" and problem.hub_radius is None and problem.hub_stiffness is None:
        found.append(_chooser("pin", "rotation", problem.rotation, ("free", "fixed")))
    return found


def _plate(problem: Problem, unit: Mapping[str, Unit]) -> list[dict[str, Any]]:
    body = problem.plate_body
    if body.kind not in TITLES or not problem.pair.plate.is_isotropic:
        return []
    controls = body.page_controls(problem.hole_radius, problem.clearance, problem.dimensionless)
    return [_chooser("plate", "plate_body", body.kind, TITLES), *_of_body("plate", controls, unit)]


def _changed_plate(problem: Problem, changes: Mapping[str, Any]) -> PlateBody:
    body = problem.plate_body
    values = {name: changes[name] for name in ("plate_body", *PLATE_CONTROLS) if name in changes}
    if body.bush is not None and changes.keys() & set(_names_of_material("bush")):
        values["material"] = _changed_material(body.bush.material, "bush", changes)
    if body.kind not in TITLES:
        raise InputError("plate_body", f"the {body.kind} of a finite plate can't be changed on the page")
    kind = checks.choice("plate_body", values.pop("plate_body", body.kind), tuple(TITLES))
    return body.changed(values) if kind == body.kind else PLATES[kind].usual(problem.hole_radius, problem.pair.plate)


def vector_axes(problem: Problem, scales: ControlScales) -> list[dict[str, Any]]:
    """The loads that the mouse moves along x and along y: their sign in this direction, and their size."""
    names = [("ux" if driven else force, sign) for driven, force, sign in
             zip(problem.driven, ("Q", "P"), (1.0, -1.0), strict=True)]  # fmt: skip
    if problem.driven[1]:
        names[1] = ("uy", 1.0)
    return [{"load": name, "sign": sign, "size": scales.of_load(name)} for name, sign in names]
