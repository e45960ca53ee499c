"""Outcomes: numbers that the user chooses, each read from the result of a run.

An outcome is a quantity of the states, a quantity of the last cycle, or the value of a function of the user. The tables
of a plan, and files with functions, are read in :mod:`fastpin.studies.outcome_tables`.
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
import pickle
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin.assess.outputs import ROUNDING, Output, kept
from fastpin.damage.criteria import FATIGUE_CRITERIA
from fastpin.errors import FastpinError, InputError, printable
from fastpin.model import Wear, angles, checks, ties
from fastpin.model.points import Body, owner_of
from fastpin.model.units import DEGREE, Unit
from fastpin.states import NodeBehaviour, State, choice
from fastpin.states.error_bars import known_bar, number_bar, value_bar
from fastpin.states.quantities import QUANTITIES, size
from fastpin.states.regimes import REGIMES

if TYPE_CHECKING:  # the solver is compiled code, and a plan is read without it
    from fastpin.damage.hot_spots import HotSpot
    from fastpin.solver.result import Result

TAKES = ("last", "largest", "smallest", "largest magnitude", "range")
"""Ways to take one number from the values of a quantity, see :func:`taken`."""

INTERFACES = ("pin", "seat")
"""Interfaces of a joint: the pin in the hole, and a bush that slips in its seat."""


def _hot_spot_quantities(criterion: str, body: Body) -> Iterator[Output]:
    """Yield parameter, angle and, if the criterion has one, life at the hot spot of a body."""
    kind, counting = FATIGUE_CRITERIA[criterion].kind, FATIGUE_CRITERIA[criterion].counting
    stem, end = criterion.replace("-", "_"), "" if body == "plate" else f"_{body}"
    yield Output(f"{stem}{end}", kind, lambda result: _hot_spot(result, criterion, body).parameter)
    yield Output(f"{stem}_angle{end}", "angle", lambda result: _hot_spot(result, criterion, body).theta)
    if counting is not None:
        yield Output(f"{stem}_life{end}", "life", lambda result: _life(result, criterion, body))


CYCLE_QUANTITIES = {
    each.name: each
    for each in (
        Output("dissipation", "energy", lambda result: result.cycles[-1].dissipation),
        Output("rotation_change", "rotation", lambda result: result.cycles[-1].rotation_change),
        Output("pressure_change", "", lambda result: result.cycles[-1].pressure_change),
        Output("shear_change", "", lambda result: result.cycles[-1].shear_change),
        Output("largest_slip_range", "displacement", lambda result: _slip_range(result)[0]),
        Output("largest_slip_range_angle", "angle", lambda result: _slip_range(result)[1]),
        Output("largest_friction_energy", "energy density", lambda result: _friction_energy(result)[0]),
        Output("largest_friction_energy_angle", "angle", lambda result: _friction_energy(result)[1]),
        *(one for criterion in FATIGUE_CRITERIA for one in _hot_spot_quantities(criterion, "plate")),
        *(one for criterion in FATIGUE_CRITERIA for one in _hot_spot_quantities(criterion, "seat")),
        Output("regime", "class", lambda result: _regime(result), classes=REGIMES),
        Output("sticking_part", "", lambda result: _sticking_part(result)),
    )
}
"""The quantities of the last cycle, by name.

The first four are those of :class:`fastpin.states.cycles.Cycle`. The next four are the largest values of a node in
:class:`fastpin.states.LoadCycle`. "regime" is :attr:`fastpin.states.LoadCycle.regime`. "sticking_part" is the part of
the hole that sticks all the time. The others belong to the hot
spot on the edge of the plate, see :func:`fastpin.damage.fatigue`. Names that end with "_seat", such as
"smith_watson_topper_life_seat", belong to the plate round a bush, at the seat of the bush.
"""


@dataclass(frozen=True)
class StudyOutcome:
    """One number that is read from a complete result.

    Attributes
    ----------
    kind : str
        See :class:`fastpin.assess.outputs.Output`; "" for a function of the user, "degrees" for a place on the hole
        that is in degrees already.
    unit : str
        Unit of a function of the user, as it is to be shown; empty for a plain number.
    definition : str
        A text that changes with the definition of the number.
    read : callable
        Gives the number for a result, with angles and widths in rad. NaN or None: the result has no such number.
    classes : dict of int to str
        The words of each value, if the number stands for a class; else empty.
    bar : callable or None
        Gives the error bar of the number for a result with error bars. None: the bar comes from the numbers on the two
        grids alone, see :func:`fastpin.states.error_bars.number_bar`.
    wear : Wear or None
        How the bodies wear, of a number of a life of wear.
    has_strengths : bool
        Whether the number depends on strengths. They change no state, but then they are a part of the ids of runs.
    """

    kind: str
    unit: str
    definition: str
    read: Callable[[Any], Any]
    classes: Mapping[int, str] = field(default_factory=dict)
    bar: Callable[[Result], float] | None = None
    wear: Wear | None = None
    has_strengths: bool = False

    @property
    def is_life(self) -> bool:
        """Whether the number is a life. One that does not end has no value."""
        return self.kind == "life" or "spectra" in self.unit

    def reported(self, value: float) -> float:
        """A value in the units of reports: angles in degrees from the bottom of the hole, widths in degrees."""
        if self.kind == "angle" and math.isfinite(value):
            return angles.from_bottom(value)
        return self.reported_bar(value)

    def reported_bar(self, bar: float) -> float:
        """A difference of values in the units of reports: of angles and widths in degrees."""
        return math.degrees(bar) if self.kind in ("angle", "width") else bar

    @property
    def is_angle(self) -> bool:
        """Whether it is in degrees in reports."""
        return self.kind in ("angle", "width", "degrees")

    def unit_in(self, units: Mapping[str, Unit]) -> Unit:
        """The unit of :meth:`reported` values. `units` is that of every kind, see :func:`fastpin.model.units.units`."""
        return DEGREE if self.is_angle else units.get(self.kind, Unit(1.0, self.unit))


class OutcomeValue(NamedTuple):
    """What an outcome gave for one run.

    Attributes
    ----------
    definition : str
        See :class:`StudyOutcome`.
    value : float or None
        None: the result has no such number, or it could not be read.
    reason : str or None
        Why the number could not be read.
    bar : float or None
        Error bar of the number; inf if the nodes do not resolve it, or the coarse grid has no number to compare. None:
        the number has none.
    """

    definition: str
    value: float | None
    reason: str | None = None
    bar: float | None = None


def value_of(outcome: StudyOutcome, result: Any) -> OutcomeValue:
    """Read an outcome, with angles and widths in rad. Whatever goes wrong becomes the reason of a missing value."""
    try:
        value = outcome.read(result)
        if value is None or (isinstance(value, float | np.floating) and math.isnan(value)):
            return OutcomeValue(outcome.definition, None)
        known = checks.number("its value", value)
        if outcome.classes and known not in outcome.classes:
            allowed = ", ".join(map(str, outcome.classes))
            raise FastpinError(f"its value must be the number of a class, {allowed}, not {known:g}")
        return OutcomeValue(outcome.definition, known)
    except (Exception, SystemExit) as error:  # A function of the user may fail in any way.
        return OutcomeValue(outcome.definition, None, reason_of(error))


def pickled(outcome: StudyOutcome) -> bytes:
    """An outcome for a worker.

    Raises
    ------
    FastpinError
        If its function can't be sent to another process.
    """
    try:
        return pickle.dumps(outcome)
    except Exception as error:  # The class of the function may be anyone's.
        words = "can't be sent to workers, which import it by its name; write a function of a module"
        raise FastpinError(f"{words} ({error})") from None


def values_in_worker(outcomes: Mapping[str, tuple[str, bytes]], result: Any) -> dict[str, OutcomeValue]:
    """Read outcomes in the units of reports. Each is given by its definition and the bytes of :func:`pickled`.

    A function that this process does not find is a missing value, and not the end of the process.
    """
    values = {}
    for name, (definition, content) in outcomes.items():
        try:
            outcome = pickle.loads(content)
        except Exception as error:  # Unpickling imports modules of the user.
            values[name] = OutcomeValue(definition, None, f"the worker does not find the function: {reason_of(error)}")
            continue
        read = value_of(outcome, result)
        if read.value is not None:
            bar = bar_of(outcome, read.value, result)
            reported = None if bar is None else outcome.reported_bar(bar)
            read = read._replace(value=outcome.reported(read.value), bar=reported)
        values[name] = read
    return values


def bar_of(outcome: StudyOutcome, value: float, result: Any) -> float | None:
    """Error bar of a number, with angles and widths in rad; inf if the coarse grid has no number to compare.

    Without error bars it is inf if the nodes do not resolve the number. None: the number has none.
    """
    try:
        if outcome.bar is not None:
            bar = outcome.bar(result)
        elif getattr(result, "coarse", None) is None:  # a joint never has one
            return None
        else:
            other = value_of(outcome, result.coarse).value
            coarse = math.nan if other is None else _beside(outcome.kind, value, other)
            bar = number_bar(outcome.kind, value, coarse, result[-1])
    except FastpinError:
        return None
    return None if math.isnan(bar) else bar


def _beside(kind: str, value: float, other: float) -> float:
    """The number `other`, if it is an angle, moved by whole turns next to `value`."""
    return value + math.remainder(other - value, 2.0 * math.pi) if kind == "angle" and math.isfinite(other) else other


# -- readers ---------------------------------------------------------------------------------------------------


def taken(quantity: str, take: str, span: str, interface: str, result: Result) -> float:
    """Take one number from the values of a quantity at the kept states.

    States without the value, such as the angle of a peak without contact, do not count.

    Parameters
    ----------
    quantity : str
        A name in :data:`fastpin.states.QUANTITIES`.
    take : {"last", "largest", "smallest", "largest magnitude", "range"}
        "last": at the last state. "largest", "smallest": with sign. "largest magnitude": without sign, and not for
        places on the hole. "range": the largest minus the smallest value; for a place on the hole, the length of the
        smallest arc that holds all its places.
    span : {"history", "cycle"}
    interface : {"pin", "seat"}
        The contact of the pin, or that of a bush that slips in its seat.
    result : Result

    Returns
    -------
    float
        In SI units, or in the units of a dimensionless problem; angles and widths in rad. NaN if no state has a value.

    Raises
    ------
    FastpinError
        If there is no cycle, or not all corners of the last cycle are kept.
    """
    kind, of = QUANTITIES[quantity].kind, of_interface(quantity, interface)
    if take == "last":
        return of(result[-1])
    values = np.array([of(state) for state in _states_of(span, result)])
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return math.nan
    if take == "range" and kind == "angle":  # the smallest arc is a turn without the widest gap between two angles
        turned = np.sort(np.mod(values, 2.0 * math.pi))
        return 2.0 * math.pi - float(np.diff(turned, append=turned[0] + 2.0 * math.pi).max())
    if take == "range":
        return float(np.ptp(values))
    if take == "largest magnitude":
        values = np.abs(values)
    return float(values.min() if take == "smallest" else values.max())


def of_quantity(
    quantity: str, take: str = "last", span: str = "history", interface: str = INTERFACES[0]
) -> StudyOutcome:
    """The outcome of :func:`taken`."""
    each, how = QUANTITIES[quantity], (quantity, take, span, interface)
    definition = {"quantity": quantity, "take": take, "over": span}
    if interface != INTERFACES[0]:  # a definition without it is as it was before there was a choice
        definition["interface"] = interface
    kind = "width" if (each.kind, take) == ("angle", "range") else each.kind
    bar = None if each.classes else partial(bar_of_taken, *how)
    return StudyOutcome(kind, "", json.dumps(definition), partial(taken, *how), dict(each.classes), bar)


def of_interface(quantity: str, interface: str) -> Callable[[State], float]:
    """A quantity of the states of an interface: a name in :data:`INTERFACES`. NaN without a seat."""
    of = QUANTITIES[quantity].of
    if interface == "pin":
        return of
    return lambda state: math.nan if state.seat is None else of(state.seat)


def bar_of_taken(quantity: str, take: str, span: str, interface: str, result: Result) -> float:
    """Error bar of the number of :func:`taken`. Without error bars it is inf if the nodes do not resolve the number.

    It is 1.25 times the difference of the numbers on the two grids, plus the floor of the quantity at the state that
    the number is taken from. A range has the floors of both its ends.

    Returns
    -------
    float
        See :func:`fastpin.states.error_bars.bars`.
    """
    if interface == "seat":
        if result.seat is None:
            return math.nan
        result = result.seat
    if take == "last":
        return known_bar(quantity, result[-1])
    if result.coarse is None and QUANTITIES[quantity].edge is None:
        return math.nan
    of = QUANTITIES[quantity].of
    states = [state for state in _states_of(span, result) if math.isfinite(of(state))]
    if not states:
        return math.nan
    readings = np.array([of(state) for state in states])
    sizes = {"smallest": [-readings], "largest magnitude": [np.abs(readings)], "range": [-readings, readings]}
    ends = [states[ties.top(each)] for each in sizes.get(take, [readings])]
    if result.coarse is None:
        return math.nan if all(QUANTITIES[quantity].is_resolved(state) for state in ends) else math.inf
    value, other = (taken(quantity, take, span, "pin", each) for each in (result, result.coarse))
    kind = "width" if take == "range" else QUANTITIES[quantity].kind
    return value_bar(quantity, value, _beside(kind, value, other), ends)


def of_last_cycle(quantity: str, interface: str, result: Result) -> float:
    """The value of a name in :data:`CYCLE_QUANTITIES` at an interface of :data:`INTERFACES`; NaN without a seat.

    Raises
    ------
    FastpinError
        If the result has no cycle.
    """
    _check_cycles(result)
    chosen = result if interface == "pin" else result.seat
    return math.nan if chosen is None else CYCLE_QUANTITIES[quantity].number(chosen)


@dataclass(frozen=True)
class FunctionOfFile:
    """A function of a Python file with this text. Workers need not see the file.

    The file is run when the function is loaded or called for the first time, and not before.
    """

    path: str
    text: str
    name: str

    def __call__(self, result: Result) -> Any:
        return self.load()(result)

    def load(self) -> Callable[[Result], Any]:
        """Run the file, and return the function. It raises whatever the text raises."""
        function: Callable[[Result], Any] = getattr(_module(self.path, self.text), self.name)
        return function


def check_loadable(outcomes: Mapping[str, StudyOutcome]) -> None:
    """Run the files of all functions, before the work of which they judge the results.

    Raises
    ------
    InputError
        If a file can't be run, or does not define the function.
    """
    for name, outcome in outcomes.items():
        if isinstance(outcome.read, FunctionOfFile):
            try:
                outcome.read.load()
            except (Exception, SystemExit) as error:  # The file may do anything.
                file = Path(outcome.read.path).name
                raise InputError("outcomes", f"{name}: {file}: can't be imported: {reason_of(error)}") from None


@functools.cache
def _module(path: str, text: str) -> ModuleType:
    """The module that a Python file with this text defines."""
    name = f"{Path(path).stem}_{digest(text)}"
    module = ModuleType(name)
    module.__file__ = path
    sys.modules[name] = module  # Data classes look for their module there.
    try:
        exec(compile(text, path, "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def digest(text: str) -> str:
    """Some hexadecimal digits of the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _check_cycles(result: Result) -> None:
    if not result.cycles:
        raise FastpinError("the history has no cycle")


def _states_of(span: str, result: Result) -> Sequence[State]:
    """The kept states whose values count: those of the whole "history", or of the last "cycle"."""
    return _states_of_cycle(result) if span == "cycle" else result


def _states_of_cycle(result: Result) -> list[State]:
    """The kept states of the last cycle, from its beginning to its end."""
    _check_cycles(result)
    first, last = choice.span_of(result.cycles[-1])
    states = choice.states_between(result, first, last)
    if choice.missing_corners(states, first + 1, last):
        raise FastpinError('not all corners of the last cycle are kept; keep = "corners" keeps them')
    return states


def _slip_range(result: Result) -> tuple[float, float]:
    """The largest slip range of a node, m, and its angle, rad; 0 and NaN where all slip is rounding.

    Unless slip sums are counted, the ranges are those of the kept states, and all corners of the cycle must be kept.
    """
    cycle = result.cycle()
    if not cycle.has_exact_slip_range:
        _states_of_cycle(result)
    if cycle.largest_slip_range <= ROUNDING * size("dx", cycle.states[-1]):
        return 0.0, math.nan
    return cycle.largest_slip_range, cycle.largest_slip_range_angle


def _sticking_part(result: Result) -> float:
    """The part of the hole whose nodes are in contact and stick throughout the cycle. All corners must be kept."""
    _states_of_cycle(result)
    cycle, weights = result.cycle(), result.grid.weights
    return float(weights @ (cycle.behaviour == NodeBehaviour.STICKS)) / (2.0 * math.pi)


def _regime(result: Result) -> float:
    """The regime of the cycle. Unless slip sums are counted, all corners of the cycle must be kept."""
    cycle = result.cycle()
    if not cycle.has_exact_slip_range:
        _states_of_cycle(result)
    return float(cycle.regime)


def _friction_energy(result: Result) -> tuple[float, float]:
    """The largest friction energy of a node, J/m^2, and its angle, rad."""
    cycle = result.cycle()
    if cycle.friction_energy is None:
        raise FastpinError("the friction energy of nodes is not counted; slip_sums = true in [solve] counts it")
    return float(cycle.friction_energy.max()), cycle.angle_of_largest(cycle.friction_energy)


@kept
def _hot_spot(result: Result, criterion: str, body: Body) -> HotSpot:
    """The hot spot on the edge of a body. It is kept while the result lives: several outcomes read it."""
    _states_of_cycle(result)
    return result.fatigue(criterion, body).hot_spot


def _life(result: Result, criterion: str, body: Body) -> float:
    """The life at the hot spot, cycles."""
    life = _hot_spot(result, criterion, body).life
    if math.isnan(life):
        owner = owner_of(result.problem, body)
        raise FastpinError(f"the {owner}'s material has no constants for a life by {criterion}")
    return life


def reason_of(error: BaseException) -> str:
    """An error in one line, with the line of the user's code that raised it."""
    frames = traceback.extract_tb(error.__traceback__)
    package = Path(__file__).parents[1]
    of_user = [frame for frame in frames if not Path(frame.filename).is_relative_to(package)]
    place = f" ({Path(of_user[0].filename).name}, line {of_user[0].lineno})" if of_user else ""
    words = str(error) if isinstance(error, FastpinError) else f"{type(error).__name__}: {error}"
    return printable(f"{words}{place}")
