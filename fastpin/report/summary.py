"""A case and its states as a JSON-ready dict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess import cycle as load_cycle
from fastpin.assess import margins, outputs
from fastpin.assess.outputs import NUMBER, TEXT, UNKNOWN, WHOLE, Output
from fastpin.assess.questions import QUESTIONS, margins_of
from fastpin.bodies.body import BodyBase
from fastpin.errors import ReadingError, reading
from fastpin.model import Case, Problem, Profile, SolveOptions, angles
from fastpin.model.fields import FIELDS, Field
from fastpin.model.keys import CASE
from fastpin.model.keys import MATERIAL as MATERIAL_KINDS
from fastpin.model.laminate import MODULI, ORDER
from fastpin.model.loads import ACTING, LATER, LOAD_KIND, LOADS
from fastpin.model.materials import STRENGTHS
from fastpin.model.points import has_outline
from fastpin.model.units import DEGREE, Unit, in_units, printed_loads, units
from fastpin.solver.result import Result
from fastpin.states import LoadCycle, State
from fastpin.states.extremes import READINGS
from fastpin.states.margins import Margin, over_yield
from fastpin.states.quantities import QUANTITIES, ZONES, bar_in_degrees, in_degrees, load_point, quantity

# -- the problem -------------------------------------------------------------------------------------------------

MATERIAL = (
    Output("name", "text"),
    Output("rigid", "truth", lambda material: material.is_rigid),
    Output(
        "E", of=lambda material: None if material.is_rigid else material.E, optional=True,
        words="null: rigid; of a laminate: that of the isotropic plate with its contact",
    ),
    Output("nu"),
    *(Output(name, words="null: unknown", optional=True) for name in STRENGTHS),
    Output("expansion", words="1/K", may_lack=True),
)  # fmt: skip
"""Outputs of a material."""


_MATERIAL_KINDS = MATERIAL_KINDS | {"laminate": MATERIAL_KINDS | {"moduli": MATERIAL_KINDS}}
_BODY_KINDS = {**CASE["pin_body"], **CASE["plate_body"], "material": _MATERIAL_KINDS, "hole_radius": "length"}


def _material(name: str, problem: Problem) -> Any:
    """A material in printed units."""
    parts = MATERIAL if name == "pin" else PLATE
    return in_units(problem, outputs.document(parts, getattr(problem.pair, name), {}), _MATERIAL_KINDS)


def body_entries(problem: Problem, name: str) -> dict[str, Any]:
    """Return the entries of a body, with its material, in printed units."""
    body: BodyBase = getattr(problem, name)
    found = body.as_json(lambda material: outputs.document(PLATE, material, {})) | body.summary()
    return dict(in_units(problem, found, _BODY_KINDS | {"inside": _BODY_KINDS}))


def _in_its_unit(name: str, problem: Problem) -> Any:
    """A field of the problem, in the unit of its kind. A profile along the rim is a list of tables."""
    value, kind = getattr(problem, name), FIELDS[name].kind
    if isinstance(value, Profile):
        return value.toml()
    if FIELDS[name].place == "section":
        return in_units(problem, {key: each.toml() for key, each in value.given.items()}, CASE[name]) or None
    return in_units(problem, value, kind)


def _form(each: Field) -> outputs.Schema:
    """The schema of a field."""
    words = "terms of a profile; angles in degrees from the bottom"
    profile = outputs.list_of({"type": "object"}) | {"description": words}
    if each.place == "section":
        return outputs.map_of(profile, "profiles; left out without any")
    if each.is_profile:
        return {"anyOf": [NUMBER, profile]}
    return TEXT if each.choices or each.place == "root" else UNKNOWN if each.is_optional else NUMBER


PLATE = (
    *MATERIAL,
    Output(
        "laminate", of=lambda material: material.summary().get("laminate"), may_lack=True,
        form=outputs.object_of(
            {
                "layup": outputs.or_null(TEXT),
                "ply": {
                    "description": "name or numbers of the ply; a list: of each ply",
                    "type": ["string", "object", "array", "null"],
                },
                "axis": NUMBER | {"description": "deg from the bottom of the hole"},
                "moduli": outputs.object_of(dict.fromkeys(MODULI, NUMBER)),
                "compliance": outputs.list_of(NUMBER, len(ORDER)) | {"description": f"{', '.join(ORDER)}, 1/Pa"},
                "is_isotropic_contact": outputs.TRUTH,
            }
        ),
    ),
)  # fmt: skip
"""Outputs of a material that may be a laminate."""

PROBLEM = (
    Output("pin", of=partial(_material, "pin"), form=outputs.schema_of(MATERIAL)),
    Output("plate", of=partial(_material, "plate"), form=outputs.schema_of(PLATE)),
    Output("plane", "text", lambda problem: problem.pair.plane, allowed=("strain", "stress")),
    Output(
        "dundurs", of=lambda problem: problem.surfaces.dundurs(),
        parts=(
            Output("alpha", of=lambda dundurs: dundurs[0]),
            Output("beta", of=lambda dundurs: dundurs[1]),
            Output("convention", "text", lambda dundurs: "usual"),
        ),
    ),
    Output("beta_star", "compliance", lambda problem: problem.surfaces.beta_star),
    *(Output(name, of=partial(_in_its_unit, name), form=_form(each), may_lack=each.place == "section")
      for name, each in FIELDS.items()),
    *(
        Output(
            name, of=partial(body_entries, name=name),
            form={"type": "object", "properties": {"kind": TEXT}, "required": ["kind"]},
        )
        for name in ("pin_body", "plate_body")
    ),
    Output("assembled_clearance", "displacement"),
    Output("press_fit_pressure", "traction"),
    Output("dimensionless", "truth"),
)  # fmt: skip
"""Outputs of a problem."""


# -- a state -----------------------------------------------------------------------------------------------------


class ReadState(NamedTuple):
    """A state, and the quantities that could not be read, with the reasons."""

    state: State
    unread: dict[str, str]

    def known(self, name: str, read: Callable[[], Any]) -> Any:
        """What ``read()`` gives; None if it can't be read."""
        try:
            with reading(name):
                return read()
        except ReadingError as error:
            self.unread[error.field] = error.reason
            return None

    @property
    def unresolved(self) -> list[str]:
        """The quantities that the nodes do not resolve."""
        is_resolved = {name: partial(each.is_resolved, self.state) for name, each in QUANTITIES.items()}
        return [name for name, each in is_resolved.items() if self.known(name, each) is False]

    @property
    def peak_hoop_resolved(self) -> bool | None:
        """Whether the nodes resolve the largest hoop stress; None for a rigid plate."""
        is_rigid = self.state.problem.surfaces.plate.is_rigid
        is_resolved: bool | None
        is_resolved = None if is_rigid else self.known("peak_hoop", lambda: self.state.peak_hoop_stress().resolved)
        return is_resolved

    def intervals(self, zone: str) -> list[tuple[float, float]]:
        """The intervals of a zone, degrees from the bottom."""
        return [angles.interval_from_bottom(*each) for each in getattr(self.state, zone)]

    @property
    def error_bars(self) -> Mapping[str, float] | None:
        """The error bars in printed units; None without."""
        bars, unit = self.state.error_bars, units(self.state.problem)
        return bars and {name: _in_units(unit, name, bar_in_degrees(name, bar)) for name, bar in bars.items()}

    @property
    def seat(self) -> ReadState | None:
        """The state of a bush that slips in its seat."""
        return None if self.state.seat is None else ReadState(self.state.seat, self.unread)


def _quantity(name: str) -> Output:
    """A quantity of a state. A class has words, and is never null."""
    each = QUANTITIES[name]
    has_classes = bool(each.classes)
    return Output(
        name, each.kind, lambda read: read.known(name, lambda: QUANTITIES[name].of(read.state)),
        "" if has_classes else each.kind, classes=each.classes, optional=not has_classes,
    )  # fmt: skip


_RESULTANTS = ("P", "Q", "M")

STATE = (
    Output("load_point", of=lambda read: load_point(read.state)),
    Output("step", "whole", lambda read: read.state.step),
    Output("fraction", of=lambda read: read.state.fraction),
    Output(
        "load", of=lambda read: printed_loads(read.state.problem, read.state.load),
        form=outputs.object_of(dict.fromkeys(LOADS, NUMBER), LOADS[:ACTING]),
    ),
    Output("in_contact", "truth", lambda read: read.state.in_contact),
    *(_quantity(name) for name in QUANTITIES if name not in _RESULTANTS),
    Output(
        "peak_hoop_outline_place",
        of=lambda read: (
            read.known("peak_hoop_outline", lambda: read.state.outline_peak)
            if has_outline(read.state.problem) else None
        ),
        words="the place of peak_hoop_outline, from the centre of the hole", may_lack=True,
        parts=(Output("edge", "text"), Output("polyline", "truth"), *outputs.numbers("x y", "length", optional=True)),
    ),
    Output("unresolved", "texts", allowed=[name for name, each in QUANTITIES.items() if each.edge]),
    Output("peak_hoop_resolved", "truth", optional=True),
    *(
        Output(
            zone, form=outputs.list_of(outputs.list_of(NUMBER, 2)),
            of=partial(ReadState.intervals, zone=zone),
        )
        for zone in ZONES
    ),
    Output(
        "slip",
        form=outputs.list_of(
            outputs.list_of(NUMBER, 3) | {"description": "start and stop, deg, and the sign of the slip"}
        ),
        of=lambda read: [(*angles.interval_from_bottom(*ends), sign) for *ends, sign in read.state.slip_zones],
    ),
    Output("energy", "energy", lambda read: read.state.energy, optional=True),
    Output(
        "resultants", of=lambda read: printed_loads(read.state.problem, read.state.resultants),
        form=outputs.object_of(dict.fromkeys(_RESULTANTS, NUMBER)),
    ),
    Output(
        "residuals", of=lambda read: read.state.residuals,
        form=outputs.map_of(UNKNOWN, "errors of the contact conditions"),
    ),
    Output("error_bars", form=outputs.or_null(outputs.map_of(UNKNOWN, "largest likely errors"))),
)  # fmt: skip
"""Outputs of a state of one interface."""


# -- a run -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Run:
    """A case and what is known of its result. `unread` is filled when its states are read."""

    case: Case
    result: Result | None
    error: str | None
    cycle: LoadCycle | None
    found: Mapping[str, Any]
    unread: dict[str, str] = field(default_factory=dict)

    @property
    def problem(self) -> Problem:
        """The problem of the case."""
        return self.case.problem

    @cached_property
    def margins(self) -> list[Margin]:
        """The known margins."""
        return margins_of(self.result, self.found) if self.result is not None and self.result.states else []

    def answer(self, name: str) -> dict[str, Any] | None:
        """What is found for a question; None if nothing is found."""
        found: Any = self.found.get(name)
        return None if found is None else QUESTIONS[name].document(found, over_yield(self.margins))


def _history(run: _Run) -> dict[str, Any]:
    """Return the blocks of the load history. A load that a corner does not give becomes null."""
    unit, history = units(run.problem), run.case.history
    factors = np.array([unit[kind].factor for kind in LOAD_KIND.values()])
    listed = [place for place, name in enumerate(LOADS) if name not in LATER or name in history.largest]
    corners = [(factors * each.given)[:, listed].tolist() for each in history.blocks]
    blocks = [{"repeat": each.count, "corners": given} for each, given in zip(history.blocks, corners, strict=True)]
    return {"loads": [LOADS[place] for place in listed], "blocks": blocks}


def _extremes(run: _Run) -> dict[str, Any]:
    """Return the extremes of all quantities over all states, with the units of the states."""
    if run.result is None:
        return {}
    unit = units(run.problem)
    try:
        extremes = run.result.extremes()
    except ReadingError as error:
        run.unread[error.field] = error.reason
        return {}

    def shown(name: str, value: float) -> float:
        return _in_units(unit, name, in_degrees(name, value) if name in QUANTITIES else value)

    return {
        name: {side: each._asdict() | {"value": shown(name, each.value)} for side, each in pair._asdict().items()}
        for name, pair in extremes.items()
    }


def sides() -> outputs.Schema:
    """Return the schema of the smallest and the largest value of a quantity."""
    extreme = outputs.object_of({"value": UNKNOWN, "place": WHOLE, "load_point": NUMBER})
    return outputs.object_of({"smallest": extreme, "largest": extreme})


def _in_units(unit: Mapping[str, Unit], name: str, value: float) -> float:
    """A quantity that is in degrees already, if it is an angle, in printed units."""
    kind = READINGS[name].kind if name in READINGS else quantity(name).kind
    return unit.get(kind, DEGREE).factor * value


RUN = (
    Output("complete", "truth", lambda run: run.result is not None and run.result.complete),
    Output("error", "text", optional=True),
    outputs.UNITS,
    Output("problem", parts=PROBLEM),
    Output(
        "history", of=_history,
        form=outputs.object_of(
            {
                "loads": outputs.list_of({"enum": list(LOADS)}),
                "blocks": outputs.list_of(
                    outputs.object_of({"repeat": WHOLE, "corners": outputs.list_of(outputs.list_of(UNKNOWN))})
                ),
            }
        ),
    ),
    Output(
        "solver", of=lambda run: run.case.options.keywords(),
        form=outputs.object_of({each.name: {} for each in fields(SolveOptions)}),
    ),
    Output(
        "statistics", of=lambda run: {} if run.result is None else run.result.statistics,
        form=outputs.map_of(NUMBER, "counters of the solver, and its time, s"),
    ),
    Output(
        "states", "list", lambda run: [ReadState(state, run.unread) for state in run.result or ()],
        parts=(
            *STATE,
            Output(
                "seat", parts=STATE, may_lack=True,
                words="the contact of a bush that slips in its seat; left out without one",
            ),
        ),
    ),
    Output("extremes", of=_extremes, form=outputs.object_of(dict.fromkeys(READINGS, sides()), required=())),
    Output("margins", "list", lambda run: margins.in_json(run.problem, run.margins), parts=margins.ROW),
    Output("unread", form=outputs.map_of(TEXT, "why a quantity could not be read from the states, by quantity")),
    Output(
        "cycles", "list", lambda run: () if run.result is None else run.result.cycles, parts=load_cycle.CHANGES
    ),
    Output("cycle", parts=load_cycle.CYCLE, optional=True),
    *(
        Output(name, of=partial(_Run.answer, name=name), form=outputs.or_null(question.schema()))
        for name, question in QUESTIONS.items()
    ),
)  # fmt: skip
"""Outputs of a case and its result."""


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
    run = _Run(case, result, error, cycle, found)
    return outputs.whole_document(RUN, run, units(case.problem), title=case.title)
