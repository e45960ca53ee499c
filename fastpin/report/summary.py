"""A case and its states as a JSON-ready dict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from fastpin import cracks
from fastpin.assess import crack
from fastpin.assess.cycle import document as cycle_document
from fastpin.assess.margins import document as margins_document
from fastpin.assess.outputs import json_ready, unit_names
from fastpin.assess.questions import QUESTIONS, margins_of
from fastpin.bodies.body import BodyBase
from fastpin.cracks.margins import crack_margins
from fastpin.errors import ReadingError, reading
from fastpin.model import Case, Problem, Profile
from fastpin.model.angles import interval_from_bottom
from fastpin.model.fields import FIELDS
from fastpin.model.loads import LATER, LOAD_KIND, LOADS
from fastpin.model.materials import STRENGTHS, Material
from fastpin.model.units import DEGREE, Unit, printed_loads, units
from fastpin.solver.result import Result
from fastpin.states import LoadCycle, State
from fastpin.states.extremes import READINGS
from fastpin.states.margins import over_yield
from fastpin.states.quantities import QUANTITIES, bar_in_degrees, in_degrees, load_point, quantity
from fastpin.version import __version__


def document(
    case: Case, result: Result | None, error: str | None = None, cycle: LoadCycle | None = None,
    found: Mapping[str, Any] = MappingProxyType({}),
) -> dict[str, Any]:  # fmt: skip
    """Return a case and its states as a JSON-ready dict. NaN and infinity become None.

    The entry ``units`` names the unit of every kind of quantity: with a thickness forces are in N, else in N/m. Angles
    are in degrees from the bottom of the hole, widths in degrees.

    Parameters
    ----------
    case : Case
    result : Result or None
        None if the run did not reach its first state.
    error : str, optional
        The reason why `result` is incomplete.
    cycle : LoadCycle, optional
        The cycle of the entry ``cycle``.
    found : mapping of str
        What is found for the questions of the case, by their names: an entry for each.

    The entry ``unread`` says which quantities could not be read from the states, and why. They are None.
    """
    problem, pair = case.problem, case.problem.pair
    unread: dict[str, str] = {}
    alpha, beta = problem.surfaces.dundurs()
    unit = units(problem)
    margins = margins_of(result, found) if result is not None and result.states else []
    whole = {
        "fastpin": __version__,
        "title": case.title,
        "complete": result is not None and result.complete,
        "error": error,
        "units": unit_names(problem),
        "problem": {
            "pin": _material_summary(pair.pin),
            "plate": _material_summary(pair.plate),
            "plane": pair.plane,
            "dundurs": {"alpha": alpha, "beta": beta, "convention": "usual"},
            "beta_star": problem.surfaces.beta_star,
            **{name: _in_its_unit(problem, name) for name in problem.entries()},
            "pin_body": _body_summary(problem.pin_body),
            "plate_body": _body_summary(problem.plate_body),
            "assembled_clearance": problem.assembled_clearance,
            "press_fit_pressure": problem.press_fit_pressure,
            "dimensionless": problem.dimensionless,
        },
        "history": _history_summary(case),
        "solver": case.options.keywords(),
        "statistics": {} if result is None else result.statistics,
        "states": [] if result is None else [_state_summary(state, unread) for state in result],
        "extremes": {} if result is None else _extremes_summary(result, unread),
        "margins": margins_document(problem, margins),
        "unread": unread,
        "cycles": [
            row._asdict() | {"dissipation": unit["energy"].factor * row.dissipation}
            for row in (() if result is None else result.cycles)
        ],
        "cycle": None if cycle is None else cycle_document(cycle),
        **{
            name: None if found.get(name) is None else question.document(found[name], over_yield(margins))
            for name, question in QUESTIONS.items()
        },
    }
    return json_ready(whole)


def _history_summary(case: Case) -> dict[str, Any]:
    """Return the blocks of the load history. A load that a corner does not give becomes null."""
    unit = units(case.problem)
    factors = np.array([unit[kind].factor for kind in LOAD_KIND.values()])
    listed = [place for place, name in enumerate(LOADS) if name not in LATER or name in case.history.largest]
    return {
        "loads": [LOADS[place] for place in listed],
        "blocks": [
            {"repeat": each.count, "corners": (factors * each.given)[:, listed].tolist()}
            for each in case.history.blocks
        ],
    }


def _in_its_unit(problem: Problem, name: str) -> Any:
    """A field of the problem, in the unit that :func:`unit_names` gives to its kind."""
    value, kind = getattr(problem, name), FIELDS[name].kind
    if isinstance(value, Profile):
        return value.toml()
    if FIELDS[name].has_section:
        return {key: profile.toml() for key, profile in value.given.items()}
    return units(problem)[kind].factor * value if kind and value is not None else value


def _material_summary(material: Material) -> dict[str, Any]:
    modulus = None if material.is_rigid else material.E
    known = {"name": material.name, "rigid": material.is_rigid, "E": modulus, "nu": material.nu}
    expands = {} if material.expansion is None else {"expansion": material.expansion}
    return known | {name: getattr(material, name) for name in STRENGTHS} | expands | material.summary()


def _body_summary(body: BodyBase) -> dict[str, Any]:
    return body.as_json(_material_summary) | body.summary()


def _state_summary(state: State, unread: dict[str, str]) -> dict[str, Any]:
    resultants, bars, plate = state.resultants, state.error_bars, state.problem.surfaces.plate
    unit = units(state.problem)

    def known(name: str, read: Callable[[], Any]) -> Any:
        try:
            with reading(name):
                return read()
        except ReadingError as error:
            unread[error.field] = error.reason
            return None

    def shown(name: str) -> float | str:
        """A quantity: angles and widths in degrees, a class in words."""
        value = QUANTITIES[name].shown(state)
        return value if isinstance(value, str) else _in_units(unit, name, in_degrees(name, value))

    return {
        "load_point": load_point(state),
        "step": state.step,
        "fraction": state.fraction,
        "load": printed_loads(state.problem, state.load),
        "in_contact": state.in_contact,
        **{name: known(name, partial(shown, name)) for name in QUANTITIES if name not in resultants},
        "unresolved": [
            name for name, each in QUANTITIES.items() if known(name, partial(each.is_resolved, state)) is False
        ],
        "peak_hoop_resolved": None if plate.is_rigid else known("peak_hoop", lambda: state.peak_hoop_stress().resolved),
        "contact": [interval_from_bottom(*interval) for interval in state.contact],
        "stick": [interval_from_bottom(*interval) for interval in state.stick],
        "slip": [(*interval_from_bottom(start, stop), sign) for start, stop, sign in state.slip_zones],
        "energy": unit["energy"].factor * state.energy,
        "resultants": printed_loads(state.problem, resultants),
        "residuals": state.residuals,
        "error_bars": bars and {name: _in_units(unit, name, bar_in_degrees(name, bar)) for name, bar in bars.items()},
        **({} if state.seat is None else {"seat": _state_summary(state.seat, unread)}),
    }


def _in_units(unit: Mapping[str, Unit], name: str, value: float) -> float:
    """A quantity that is in degrees already, if it is an angle, in printed units."""
    kind = READINGS[name].kind if name in READINGS else quantity(name).kind
    return unit.get(kind, DEGREE).factor * value


def _extremes_summary(result: Result, unread: dict[str, str]) -> dict[str, Any]:
    """Return the extremes of all quantities over all states, with the units of the states."""
    unit = units(result.problem)
    try:
        extremes = result.extremes()
    except ReadingError as error:
        unread[error.field] = error.reason
        return {}

    def shown(name: str, value: float) -> float:
        return _in_units(unit, name, in_degrees(name, value) if name in QUANTITIES else value)

    return {
        name: {side: each._asdict() | {"value": shown(name, each.value)} for side, each in pair._asdict().items()}
        for name, pair in extremes.items()
    }


def crack_document(case: Case, growth: cracks.Growth) -> dict[str, Any]:
    """Return the growth of a crack with its numbers at all lengths and its margins as a JSON-ready dict."""
    columns = {name: values.tolist() for name, values in crack.growth_curve(growth).columns.items()}
    return json_ready(
        {
            "fastpin": __version__,
            "title": case.title,
            "units": unit_names(growth.problem),
            "crack": crack.document(growth, {}),
            "lengths": columns,
            "margins": margins_document(growth.problem, crack_margins(growth)),
        }
    )
