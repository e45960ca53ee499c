"""The loads that can act in a problem, and the options of the solver that fit it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import MOST_FRICTION, number
from fastpin.model.history import LoadHistory
from fastpin.model.loads import FRICTION_CHANGE, LOAD_KIND, LOADS, PIN_TEMPERATURE, REMOTE, THERMAL
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem

MOST_LOAD = 1e50
"""Limit of every load, in parts of the load that strains the bodies by about 1. Squares of all results are numbers."""

MOST_STRAIN = 0.1
"""Largest strain of a body by a temperature."""


def check_loads(problem: Problem, history: LoadHistory) -> None:
    """Raise :class:`InputError` if a load of `history` can't act in `problem`, or is beyond :data:`MOST_LOAD`."""
    check_largest(problem, history.largest)
    check_friction_changes(problem, history)


def check_friction_changes(problem: Problem, history: LoadHistory) -> None:
    """Raise :class:`InputError` if the friction of `problem` can't change as in `history`."""
    given = np.concatenate([block.given[:, FRICTION_CHANGE] for block in history.blocks])
    low, high = np.fmin.reduce(given, initial=0.0), np.fmax.reduce(given, initial=0.0)
    if low == high == 0.0:
        return
    if problem.frictionless:
        raise InputError("friction_change", "there is no friction that could change: friction = 0")
    if low <= -1.0:
        raise InputError("friction_change", f"must be more than -1, which would leave no friction, not {low:g}")
    if (1.0 + high) * problem.most_friction > MOST_FRICTION:
        largest = f"{high:g} makes the coefficient of friction {(1.0 + high) * problem.most_friction:g}"
        raise InputError("friction_change", f"{largest}; it must be at most {MOST_FRICTION:g}")


def check_largest(problem: Problem, largest: Mapping[str, float]) -> None:
    """Check loads as :func:`check_loads`. `largest` has the largest value of every load that is given."""
    natural = problem.natural_loads()
    for name, value in largest.items():
        most = MOST_LOAD * natural[LOAD_KIND[name]]
        number(name, value, -most, most)
    for name in (LOADS[place] for place in REMOTE):
        if largest.get(name, 0.0) != 0.0:
            problem.plate_body.lug.check_remote(name)
    for name in (LOADS[place] for place in THERMAL):
        check_temperature(problem, name, largest.get(name, 0.0))
    if problem.pin_load == "body" and largest.get("M", 0.0) != 0.0:
        raise InputError(
            "M",
            "a body-loaded pin can't carry a moment: uniform body forces leave the moment's singularity at the centre "
            '(section 4 of the paper); use pin_load = "centre"',
        )
    if problem.held and "M" in largest:
        words = f'the moment is a reaction where rotation = "{problem.rotation}"; leave it out or let the pin rotate'
        raise InputError("M", words)
    if not problem.held and "rotation" in largest:
        raise InputError("rotation", 'a rotation can be prescribed only where rotation = "fixed" or "spring"')
    for place, is_driven in enumerate(problem.driven):
        force, displacement = ("Q", "P")[place], ("ux", "uy")[place]
        if (force if is_driven else displacement) not in largest:
            continue
        if is_driven:
            raise InputError(force, f'the force is a reaction where drive = "{problem.drive}"; give {displacement}')
        words = f'a displacement can be prescribed only where drive = "{displacement}" or "both"; give {force}'
        raise InputError(displacement, words)


def check_temperature(problem: Problem, name: str, largest: float) -> None:
    """Raise :class:`InputError` if the load `name`, a temperature of this size, can't act."""
    if largest == 0.0:
        return
    if problem.dimensionless:
        raise InputError(name, "has no meaning with load_parameter: the bodies have no sizes")
    bodies = dict(problem.joint.materials)
    if name == LOADS[PIN_TEMPERATURE]:
        bodies = {"pin": bodies["pin"]}
    elif why := problem.plate_body.unknown_when_warm(problem.pair):
        raise InputError(name, why)
    elif not problem.pair.plate.is_isotropic:
        raise InputError(name, "a laminate has no coefficient of thermal expansion here")
    for body, material in bodies.items():
        if material.expansion is None:
            raise InputError(name, f"needs the coefficient of thermal expansion of the {body}: its key expansion, 1/K")
        if abs(material.expansion * largest) > MOST_STRAIN:
            words = f"{largest:g} K strain the {body} by {material.expansion * largest:g}"
            raise InputError(name, f"{words}; at most {MOST_STRAIN:g} are allowed")


def check_arc(problem: Problem, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the arc is too short: the nodes must go all round."""
    if options.arc is not None and not options.is_full_turn and (reason := problem.needs_circle):
        raise InputError("arc", f"{reason}: the arc must span 2 pi, or be left out")


def check_keep(history: LoadHistory, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the ends of cycles are to be kept, but the history has no cycles."""
    if options.keep == "cycles" and not history.longest_cycle:
        raise InputError("keep", "the history has no cycles: none of its blocks is repeated")
