"""A case as text: what fastpin has understood of a case file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from fastpin import assess
from fastpin.assess.outputs import ROUNDING, Column, cut_lines, printed_rows, table
from fastpin.model import Case, LoadHistory, Material, Problem, Wear, checks, points
from fastpin.model.case import questions_of
from fastpin.model.loads import LOAD_KIND, LOADS, named_load
from fastpin.model.units import acting_loads, units


def describe(case: Case) -> str:
    """Describe a case as text: pair, contact, solver, and a table of the loads with their load parameters.

    Another class than :class:`Case` raises :class:`InputError`.
    """
    rows = case_rows(case)
    text = [case.title] if case.title else []
    width = max(8, *(len(name) for name, _ in rows))
    text += [f"{name:{width}s} {value}" for name, value in rows]
    columns, hidden = corner_columns(case.problem, case.history)
    return "\n".join([*text, "", table(columns, hidden)])


def case_rows(case: Case) -> list[tuple[str, str]]:
    """Return the pair, the contact and the solver of a case in words: rows of (subject, text).

    Another class than :class:`Case` raises :class:`InputError`.
    """
    checks.instance("case", case, Case, "a Case")
    problem, options, count = case.problem, case.options, len(case.history)
    pair, surfaces = problem.pair, problem.surfaces
    alpha, beta = surfaces.dundurs()
    if problem.dimensionless:
        scale = "dimensionless: R = 1, F = 1, beta* = 1"
        size = f"load parameter {problem.clearance:.4g}"
    else:
        scale = f"beta* = {units(problem)['compliance'].text(surfaces.beta_star, 4)}"
        kind = "clearance" if problem.clearance >= 0.0 else "clearance (interference)"
        length = units(problem)["length"]
        size = f"hole radius {length.text(problem.hole_radius)}, {kind} {length.text(problem.clearance)}"
        size += "" if problem.thickness is None else f", thickness {length.text(problem.thickness)}"
    pin_load = problem.pin_body.load_words(problem.pin_load)
    contact = "" if surfaces is pair else "pin and bush: "
    if options.arc is None:
        where = "arc chosen by the solver"
    elif options.is_full_turn:
        where = "on the whole circle"
    else:
        where = f"arc from {options.arc[0]:g} to {options.arc[1]:g} rad"
    method = options.method if options.method == "path" else f"increment, {options.increments} a corner"
    rows = [
        (points.owner_of(problem, "pin"), _material(pair.pin, problem)),
        ("plate", _material(pair.plate, problem)),
        *_bodies(problem),
        ("pair", f"plane {pair.plane}, {contact}Dundurs alpha = {alpha:.4f}, beta = {beta:.4f}, {scale}"),
        ("contact", f"{size}, friction {problem.friction_words()}"),
        *profile_rows(problem),
        ("loading", f"{pin_load}, rotation {problem.rotation}{_hub(problem)}{_drive(problem)}"),
        ("solver", f"{method}, {options.nodes} nodes, {where}"),
        ("loads", f"{count:,} corner{'s' * (count != 1)}, reached {'one after the other ' * (count != 1)}from no load"),
    ]
    if options.keep != "all":
        rows.append(("states", f"kept: {options.keep}"))
    if case.wear is not None:
        rows.append(("wear", _wear_words(problem, case.wear)))
    asked = questions_of(case).items()
    return rows + [(name, assess.questions.QUESTIONS[name].words(problem, how)) for name, how in asked]


def _wear_words(problem: Problem, wear: Wear) -> str:
    """Law, cycles and coefficients of wear."""
    names = {"coefficient": "pin and plate together", "pin": "pin", "plate": "plate"}
    known = {words: profile for name, words in names.items() if (profile := wear.given.get(name)) is not None}
    unit = units(problem)["wear coefficient"]
    parts = [f"{words} {profile.words(lambda value: f'{unit.factor * value:.4g}')}" for words, profile in known.items()]
    law = {"archard": "Archard's law", "energy": "law of energy"}[wear.law]
    return f"{law}, {wear.cycles:,} cycles; in {unit.name}: {', '.join(parts)}"


def profile_rows(problem: Problem) -> list[tuple[str, str]]:
    """Return the rows that describe the profiles along the rim; none for a round hole and pin and uniform friction."""
    found = []
    for name, words in profile_words(problem):
        notes = ["missing material"] * (name != "friction") + ["angles in degrees from the bottom"] * ("deg" in words)
        found.append((name, f"{words} ({', '.join(notes)})" if notes else words))
    return found


def profile_words(problem: Problem) -> list[tuple[str, str]]:
    """Return names and words of the given profiles along the rim. Angles are in degrees from the bottom of the hole."""
    gap = units(problem)["displacement"]
    found = [(f"{name} profile", profile.words(gap.text)) for name, profile in problem.gap.given.items()]
    friction = problem.profiles.get("contact.friction")
    if friction is not None:
        found.append(("friction", friction.words(lambda value: f"{value:.4g}")))
    return found


def _bodies(problem: Problem) -> list[tuple[str, str]]:
    """Return the rows of the bodies; none for a solid pin in an infinite plate."""
    unit, bush, rows = units(problem), problem.plate_body.bush, []
    for body in (problem.pin_body, problem.plate_body):
        rows += body.rows(unit["length"].text, lambda material: _material(material, problem))
    if bush is not None and bush.interference < 0.0:
        words = f"clearance {unit['displacement'].text(-bush.interference)} of the bush in the plate"
        rows.append(("loose fit", words))
    elif bush is not None and bush.interference:
        words = f"interference {unit['displacement'].text(bush.interference)}"
        words += f", pressure {unit['traction'].text(problem.press_fit_pressure, 4)}"
        words += f", clearance after it {unit['displacement'].text(problem.assembled_clearance)}"
        rows.append(("press fit", words))
    return rows


def _hub(problem: Problem) -> str:
    """Return the words that say how the hub of a pin is held; empty if the pin rotates freely."""
    if not problem.held:
        return ""
    spring, unit = "", units(problem)
    if problem.hub_stiffness is not None:
        spring = f" of stiffness {unit['stiffness'].text(problem.hub_stiffness)}"
    if problem.hub_radius is None:
        if problem.pin_body.bore_radius:
            return f"{spring} at the bore"
        if problem.surfaces.pin.is_rigid:
            return spring
        datum = problem.hole_radius / math.sqrt(problem.surfaces.pin_kolosov + 1.0)
        return f"{spring} at radius {unit['length'].text(datum, 4)}, the paper's datum"
    return f"{spring} at radius {unit['length'].text(problem.hub_radius)}"


def _drive(problem: Problem) -> str:
    """Return the words that say which displacements are prescribed; empty if forces push the pin."""
    if problem.drive == "force":
        return ""
    names = {"ux": "ux in place of Q", "uy": "uy in place of P", "both": "ux and uy in place of Q and P"}
    length = units(problem)["length"]
    words = f", {names[problem.drive]}"
    if problem.gauge_radius is not None:
        words += f" over radius {length.text(problem.gauge_radius)}"
    if problem.rig_stiffness is not None:
        words += f", rig of stiffness {units(problem)['rig stiffness'].text(problem.rig_stiffness)}"
    if problem.hub_radius is not None and not problem.held:
        words += f", hub of radius {length.text(problem.hub_radius)}"
    return words


def corner_columns(
    problem: Problem, history: LoadHistory, initial: np.ndarray | None = None
) -> tuple[list[Column], int]:
    """Return the columns of the table of the corners, and the number of corners that it leaves out.

    Of a repeated block it shows the first cycle, and the number of cycles. `initial`, shape (loads,), is the load
    before the first corner; zero unless given.
    """
    numbers, counts, loads = [], [], []
    last = np.zeros(len(LOADS)) if initial is None else initial
    begin = 1
    for block in history.blocks:
        visible = printed_rows(cut_lines(len(block.given)))
        values = LoadHistory.from_array(block.given).values(initial=last)
        numbers += [f"{begin + k}" for k in visible]
        counts += [f"x {block.count:,}" if block.count > 1 else "" for _ in visible]
        loads += [named_load(values[k]) for k in visible]
        last, begin = values[-1], begin + block.corners
    columns = [("corner", "", numbers)]
    if any(counts):
        columns.append(("times", "", counts))
    columns += load_columns(problem, loads)
    forces = [math.hypot(load["P"], load["Q"]) for load in loads]
    columns.append(("L_p", "", [f"{problem.load_parameter(force):.4g}" if force else "-" for force in forces]))
    return columns, sum(len(block.given) for block in history.blocks) - len(loads)


def load_columns(problem: Problem, loads: Sequence[Mapping[str, float]]) -> list[Column]:
    """Return the columns of all loads that are not zero throughout: name, unit and one number a row, for :func:`table`.

    Loads of one kind share a unit and its SI prefix. Values below :data:`ROUNDING` of the largest are printed as 0.
    """
    columns = []
    acting = acting_loads(loads)
    for name in acting:
        same_kind = [load[other] for other in acting for load in loads if LOAD_KIND[other] == LOAD_KIND[name]]
        factor, label = units(problem)[LOAD_KIND[name]].scale(same_kind)
        noise = ROUNDING * max(map(abs, same_kind))
        values = [0.0 if abs(load[name]) <= noise else load[name] * factor for load in loads]
        columns.append((name, label, [f"{value:.5g}" for value in values]))
    return columns


def _material(material: Material, problem: Problem) -> str:
    if material.is_rigid:
        return "rigid"
    pressures = [name for name in material.shown_moduli if not name.startswith("nu")]
    unit = units(problem)
    modulus = "{:.4g} / beta*".format if problem.dimensionless else unit["modulus"].text
    shown = material.shown_moduli.items()
    moduli = [f"{name} = {modulus(value) if name in pressures else f'{value:.4g}'}" for name, value in shown]
    strength = material.known_yield_strength
    yields = "" if strength is None else f"yields at {unit['modulus'].text(strength, 4)}"
    expands = "" if material.expansion is None else f"expands by {material.expansion:.4g} per K"
    return ", ".join(filter(None, [material.label, *moduli, material.direction_words, expands, yields]))
