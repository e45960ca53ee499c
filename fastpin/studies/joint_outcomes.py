"""Outcomes of joints of several pins: a number of a pin in a plate, or the largest of several."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin.assess.outputs import kept
from fastpin.casefile.toml_text import Section
from fastpin.model import ties
from fastpin.model.checks import choice
from fastpin.studies.outcomes import TAKES, StudyOutcome

if TYPE_CHECKING:  # compiled code, and a plan is read without it
    from fastpin.joints import Joint, JointFile, JointResult, JointState

AT_LARGEST_LOAD = "at largest load"
"""The take of the state with the largest force of all pins on a plate."""

Pairs = tuple[tuple[str, str], ...]
"""Names of pins and of plates, or of their slices."""


class _Quantity(NamedTuple):
    """A number of each pin in each plate at a state.

    Attributes
    ----------
    kind : str
        See :class:`fastpin.studies.outcomes.StudyOutcome`.
    of : callable
        ``of(state, pin, plate)``; NaN without a value.
    take : str
        The take unless another one is given.
    of_pin : bool
        Whether it is a number of one pin in one plate.
    """

    kind: str
    of: Callable[[JointState, str, str], float]
    take: str = "largest"
    of_pin: bool = False


def _along(state: JointState, pin: str, plate: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The direction of the whole force of the pins on a plate, and the distances and forces of its pins along it.

    Distances, m, count from `pin`. All is NaN without a force.
    """
    joint = state.joint
    pins = joint.pins_of(joint.sections[joint.places(pin, plate)[0]][1])
    own = next(each.at for each in pins if each.name == pin)
    forces = np.array([state.force(each.name, plate) for each in pins])
    with np.errstate(invalid="ignore"):
        along = forces.sum(axis=0) / np.hypot(*forces.sum(axis=0))
    apart = np.array([each.at - own for each in pins])
    return along, apart.real * along[0] + apart.imag * along[1], forces @ along


def bypass(state: JointState, pin: str, plate: str) -> float:
    """The force in the plate that passes the hole: that of the pins more than a radius ahead of it, N."""
    _, apart, forces = _along(state, pin, plate)
    _, of = state.joint.sections[state.joint.places(pin, plate)[0]]
    return float(forces[apart > state.joint.radius_in(of)].sum()) if np.isfinite(apart).all() else math.nan


def kt(state: JointState, pin: str, plate: str, net: bool) -> float:
    """The largest hoop stress over the stress by the whole force of the pins on the plate, gross or net.

    The gross section is the width of the outline across this force times the thickness. The net section leaves out the
    holes of all pins at most a radius ahead or behind. NaN without an outline or a force.
    """
    along, apart, forces = _along(state, pin, plate)
    joint = state.joint
    _, of = joint.sections[joint.place(pin, plate)]
    if of.is_infinite or not np.isfinite(apart).all():
        return math.nan
    edge = np.array([z for part in of.outline for z in part.at(np.linspace(0.0, 1.0, 33))])
    width = float(np.ptp(edge.imag * along[0] - edge.real * along[1]))
    radius = joint.radius_in(of)
    width -= 2.0 * radius * int((np.abs(apart) <= radius).sum()) if net else 0.0
    contact = state[pin, plate]
    return float((contact.seat or contact).peak_hoop_stress("plate").value) * width * of.thickness / float(forces.sum())


QUANTITIES: dict[str, _Quantity] = {
    "share": _Quantity("ratio", lambda state, pin, plate: state.shares(plate)[pin], AT_LARGEST_LOAD, True),
    "bypass": _Quantity("force", bypass, AT_LARGEST_LOAD, True),
    "force": _Quantity("force", lambda state, pin, plate: float(np.hypot(*state.force(pin, plate)))),
    "pressure": _Quantity(
        "traction", lambda state, *at: float(state[at].peak_pressure) if state[at].in_contact else 0.0
    ),
    "hoop": _Quantity("traction", lambda state, *at: float(state[at].peak_hoop_stress("plate").value)),
    "kt_gross": _Quantity("ratio", partial(kt, net=False), AT_LARGEST_LOAD),
    "kt_net": _Quantity("ratio", partial(kt, net=True), AT_LARGEST_LOAD),
    "slip": _Quantity("displacement", lambda state, *at: float(np.max(state[at].slip_distance))),
    "dissipation": _Quantity(
        "energy", lambda state, *at: float(state[at].dissipation * (state[at].problem.thickness or 1.0)), "last"
    ),
}
"""Numbers of a pin in a plate at a state, by name."""

WHOLE = ("hoop_at", "margin", "life")
"""Numbers of a history: pin and plate of the largest hoop stress, the least margin, and the shortest life."""


def read_joint_outcome(section: Section, file: JointFile | None) -> StudyOutcome | None:
    """Read ``{ joint = "share", pin = "A" }``, and report its faults. `file` is the joint file of the plan."""
    name = section.choice("joint", (*QUANTITIES, *WHOLE))
    if file is None:
        section.report("joint: is for a plan whose case is a joint file")
    if name is None or file is None:
        return None
    pairs = _pairs(section, file.joint, name in QUANTITIES and QUANTITIES[name].of_pin)
    if not pairs:
        return None
    given = {key: section.value(key) for key in ("pin", "plate") if key in section}
    if name in QUANTITIES:
        quantity = QUANTITIES[name]
        usual = quantity.take
        take = section.choice("take", (usual, *(each for each in (*TAKES, AT_LARGEST_LOAD) if each != usual)))
        definition = json.dumps({"joint": name, **given, "take": take}, sort_keys=True)
        return (
            None if take is None else StudyOutcome(quantity.kind, "", definition, partial(of_joint, name, take, pairs))
        )
    if "take" in section:
        section.report(f"take: has no effect on {name}, which is a number of the whole history", "take")
        return None
    how, classes, kind, unit = None, {}, "", ""
    if name == "hoop_at":
        kind, classes = "class", {place: f"{pin} in {plate}" for place, (pin, plate) in enumerate(pairs)}
    elif name == "life":
        how = file.fatigue
        if how is None:
            section.report('joint: "life" needs a section [fatigue] of the joint file', "joint")
            return None
        given["how"] = how.toml()
        kind, unit = ("life", "") if how.passes == "cycles" else ("", how.passes)
    definition = json.dumps({"joint": name, **given}, sort_keys=True)
    return StudyOutcome(kind, unit, definition, partial(of_history, name, pairs, how), classes)


def _pairs(section: Section, joint: Joint, of_pin: bool) -> Pairs:
    """The pins and plates that a table names: all, unless it says which. Empty with a fault (reported)."""
    pins, plates = [pin.name for pin in joint.pins], [plate.name for plate in joint.plates]
    slices = [plate.name for _, plate in joint.sections]
    pin = section.checked("pin", choice, tuple(pins))
    plate = section.checked("plate", choice, tuple(dict.fromkeys([*plates, *slices])))
    if (pin is None and "pin" in section) or (plate is None and "plate" in section):
        return ()
    if of_pin and pin is None:
        section.report(f"pin is missing: {section.value('joint')} is a number of one pin, of {', '.join(pins)}")
        return ()
    if of_pin:
        through = next(each.plates for each in joint.pins if each.name == pin)
        found = [(pin, plate or through[0])] if plate is None or plate.partition(".")[0] in through else []
    else:
        named = [(one.name, of.name) for one, of in joint.sections if pin in (None, one.name)]
        found = [names for names in named if plate in (None, names[1], names[1].partition(".")[0])]
    if not found:
        section.report(f"plate: pin {pin} does not go through {plate}", "plate")
    return tuple(found)  # type: ignore[arg-type]


@kept
def _values(result: JointResult, name: str, pairs: Pairs) -> np.ndarray:
    """A quantity at all states, shape (states, pairs)."""
    return np.array([[QUANTITIES[name].of(state, *pair) for pair in pairs] for state in result.states])


def largest_load(result: JointResult, plate: str) -> int:
    """The place of the state with the largest force of all pins on a plate or a slice."""
    pins = [pin.name for pin in result.joint.pins if plate.partition(".")[0] in pin.plates]
    forces = [np.sum([state.force(pin, plate) for pin in pins], axis=0) for state in result.states.bare]
    return ties.top(np.hypot(*np.transpose(forces)).tolist())


def of_joint(name: str, take: str, pairs: Pairs, result: JointResult) -> float:
    """Take a number from the largest one of some pins and plates at every state.

    See :func:`fastpin.studies.outcomes.taken` for the ways to take it. "at largest load" takes the state with the
    largest force of all pins on the plate, or on the first of several.
    """
    values = _values(result, name, pairs)
    found = np.where(np.isnan(values), -np.inf, values).max(axis=1)
    found[np.isinf(found)] = math.nan
    if take == "last":
        return float(found[-1])
    if take == AT_LARGEST_LOAD:
        return float(found[largest_load(result, pairs[0][1])])
    known = found[np.isfinite(found)]
    if not len(known):
        return math.nan
    if take == "range":
        return float(np.ptp(known))
    known = np.abs(known) if take == "largest magnitude" else known
    return float(known.min() if take == "smallest" else known.max())


def of_history(name: str, pairs: Pairs, how: Any, result: JointResult) -> float:
    """A number of :data:`WHOLE` of some pins and plates.

    The place of the pin and plate with the largest hoop stress among the pairs; the least margin; or the shortest life,
    NaN if none ends. NaN if nothing is known.
    """
    if name == "hoop_at":
        return float(ties.top(_values(result, "hoop", pairs).max(axis=0).tolist()))
    found = [
        one.margin.margin if name == "margin" else one.found.hot_spot.life
        for one in _judged(result, name, how)
        if (one.pin, one.plate) in pairs
    ]
    return min((each for each in found if math.isfinite(each)), default=math.nan)


@kept
def _judged(result: JointResult, name: str, how: Any) -> list[Any]:
    """All margins, or all damages."""
    return result.margins() if name == "margin" else result.assessed_fatigue(how)
