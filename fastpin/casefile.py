"""Case files: a problem, its load history and the solver's options in one TOML file.

All faults of a file are collected and reported at once, each with its line. :data:`EXAMPLE` is a commented
case file; ``fastpin example`` prints it.
"""

from __future__ import annotations

import csv
import difflib
import math
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from fastpin import loading
from fastpin.errors import InputError
from fastpin.loading import LOADS, LoadHistory
from fastpin.materials import MATERIALS, Convention, Material, MaterialPair, Plane
from fastpin.problem import PinLoad, Problem, Rotation

EXAMPLE = """\
# A case file of fastpin. SI units throughout; loads are per unit thickness of pin and plate.
# One "key = value" a line.

title = "Ti-6Al-4V pin in an aluminium plate, one fretting cycle"

[pin]                       # the same keys as [plate]: a material, or E and nu, or rigid = true
material = "Ti-6Al-4V"      # "Ti-6Al-4V", "aluminium", "steel" or "nickel alloy"

[plate]
E  = 69e9                   # Young's modulus, Pa
nu = 0.33                   # Poisson's ratio

# Instead of [pin] and [plate]:
# [dundurs]
# alpha = 0.2507            # positive when the plate is the more compliant body ...
# beta = 0.0595
# nu_pin = 0.32             # needed too: alpha and beta don't determine the frictional problem
# convention = "usual"      # ... or "paper": both parameters with the opposite sign
# beta_star = 8.26e-11      # composite compliance, 1/Pa; not with load_parameter

[contact]
plane = "strain"            # or "stress"
hole_radius = 10e-3         # R, m
clearance = 20e-6           # R - R_D, m: hole radius minus pin radius; 0 is a neat fit, < 0 an interference
# load_parameter = 0.1      # (R - R_D)/(F beta*) instead of the two above: loads are then in units of F
friction = 0.4              # coefficient of friction
pin_load = "body"           # "body": uniform body force; "centre": force at the pin's centre
rotation = "free"           # "free": carries the moment M; "fixed": prescribed rotation, centre load only
# hub_radius = 5e-3         # with rotation = "fixed": the circle whose mean rotation is prescribed, m

# Loads: corners of the history, in order. Between corners the loads vary linearly, from no load at the start.
# P downwards, Q to the right (+x), N/m; M counter-clockwise, N; sxx, syy remote stresses, Pa; rotation, rad.
# What a block leaves out keeps its value; a list is as many corners; repeat = k runs a block k times.
[[load]]
P = 2.42e6

[[load]]
Q = [4.84e5, -4.84e5, 4.84e5]
# repeat = 1

# Instead of [[load]] blocks, a file with a header line of load names and a line of numbers for each corner:
# [history]
# csv = "loads.csv"         # relative to this file
# repeat = 1

[solve]
nodes = 401                 # nodes on the arc or circle
method = "path"             # "path": from one change of contact to the next; "increment": load increments
# increments = 80           # per corner, method = "increment" only
# arc = [-3.5, 0.4]         # ends of the arc of nodes, rad; -pi/2 is the bottom; a span of 2 pi is the circle
# between = 3               # more states inside every step: how many, or at which fractions, [0.25, 0.9]
"""
"""A commented case file: the built-in case."""

MAX_NODES = 20_000  # the matrices hold 4 nodes^2 numbers: 13 GB
MAX_CORNERS = 1_000_000

_MATERIAL_KEYS = ("material", "E", "nu", "rigid")
_KEYS: dict[str, tuple[str, ...]] = {
    "pin": _MATERIAL_KEYS,
    "plate": _MATERIAL_KEYS,
    "dundurs": ("alpha", "beta", "nu_pin", "convention", "beta_star"),
    "contact": (
        "plane",
        "hole_radius",
        "clearance",
        "load_parameter",
        "friction",
        "pin_load",
        "rotation",
        "hub_radius",
    ),
    "load": (*LOADS, "repeat"),
    "history": ("csv", "repeat"),
    "solve": ("nodes", "method", "increments", "arc", "between"),
}
_METHODS = ("path", "increment")

Place = tuple[str | int, ...]  # where a value stands in the file: ("load", 0, "P")


class CaseFileError(InputError):
    """A case file with faults.

    Attributes
    ----------
    problems : list of (int, str)
        Line, from 1, and one sentence for each fault, in the order of the lines. Line 0 is the whole file.
    """

    def __init__(self, name: str, problems: list[tuple[int, str]]) -> None:
        self.problems = sorted(problems, key=lambda problem: problem[0])
        first = self.problems[0][1] if self.problems else ""
        super().__init__(name, first)
        lines = [f"{name}{f', line {line}' if line else ''}: {text}" for line, text in self.problems]
        self.args = ("\n".join(lines),)


@dataclass(frozen=True)
class SolveOptions:
    """Options of :func:`fastpin.solve`, with the same names and defaults."""

    nodes: int = 401
    method: str = "path"
    increments: int = 80
    arc: tuple[float, float] | None = None
    between: int | tuple[float, ...] = 0

    def __post_init__(self) -> None:
        _whole("nodes", self.nodes, 5, MAX_NODES)
        _whole("increments", self.increments, 1)
        if self.method not in _METHODS:
            raise InputError("method", f'must be "path" or "increment", not {self.method!r}')

    def keywords(self) -> dict[str, Any]:
        """The options as keyword arguments of :func:`fastpin.solve`."""
        return {
            "nodes": self.nodes,
            "method": self.method,
            "increments": self.increments,
            "arc": self.arc,
            "between": self.between,
        }


@dataclass(frozen=True)
class Case:
    """What a case file says: everything that :func:`fastpin.solve` needs."""

    problem: Problem
    history: LoadHistory
    options: SolveOptions = field(default_factory=SolveOptions)
    title: str = ""


def builtin_case() -> Case:
    """The case of :data:`EXAMPLE`: a titanium pin in an aluminium plate, one fretting cycle."""
    return parse_case(EXAMPLE, "built-in case")


def read_case(path: str | Path) -> Case:
    """Read a case file.

    Raises
    ------
    CaseFileError
        With all faults of the file.
    """
    path = Path(path)
    try:
        raw = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CaseFileError(str(path), [(0, f"can't be read: {reason}")]) from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise CaseFileError(str(path), [(line, "is not UTF-8 text")]) from None
    return parse_case(text, str(path), path.parent)


def parse_case(text: str, name: str = "case file", folder: str | Path = ".") -> Case:
    """Read a case from `text`.

    Parameters
    ----------
    text : str
        TOML.
    name : str
        What errors call the file.
    folder : path
        Where a relative path of a CSV file starts.

    Raises
    ------
    CaseFileError
        With all faults of the text.
    """
    reader = _Reader(text)
    case = reader.case(Path(folder)) if reader.readable else None
    if reader.problems or case is None:
        raise CaseFileError(name, reader.problems)
    return case


class _Bad:
    """Stands for a value that is given but can't be used: reported once, and never again as missing."""


_BAD = _Bad()


class _Reader:
    """One pass over one file; collects the faults in `problems`."""

    def __init__(self, text: str) -> None:
        self.problems: list[tuple[int, str]] = []
        self.readable = True
        self.data: dict[str, Any] = {}
        self.probe: Problem | None = None  # the problem, with harmless values for what is wrong
        self.lines: dict[Place, int] = {}
        self._parse(text.replace("\r\n", "\n"))

    # -- text to tables ------------------------------------------------------------------------------------

    def _parse(self, text: str) -> None:
        """Parse; after a faulty ``key = value`` line go on without it, to report the other faults as well."""
        lines = text.split("\n")
        self.lines, keys, starts = _locate(lines)
        spoilt: list[Place] = []
        while True:
            try:
                self.data = tomllib.loads("\n".join(lines))
                break
            except RecursionError:
                self._fault(0, "values are nested too deeply")
                self.readable = False
                return
            except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
                message, line = _syntax_message(str(error), lines)
                start = starts.get(line, line)
                path = keys.get(start)
                if line != start:
                    message = f"the value that begins here is not closed, or wrong in line {line}"
                self._fault(start, message)
                whole = start == line and starts.get(line + 1) != line  # the value ends on its line
                if path is None or not whole or not lines[start - 1]:
                    self.readable = False
                    return
                spoilt.append(path)
                lines[start - 1] = ""
        for path in spoilt:
            self._spoil(path)

    def _spoil(self, path: Place) -> None:
        place: Any = self.data
        for part in path[:-1]:
            if isinstance(place, dict):
                place = place.setdefault(part, {})
            elif isinstance(place, list) and isinstance(part, int) and part < len(place):
                place = place[part]
            else:
                return
        if isinstance(place, dict):
            place[path[-1]] = _BAD

    # -- reporting -----------------------------------------------------------------------------------------

    def _line(self, *path: str | int) -> int:
        """Line of a value, or of the closest thing around it."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.lines:
                return self.lines[path[:length]]
        return 0

    def _fault(self, line: int, message: str) -> None:
        if (line, message) not in self.problems:
            self.problems.append((line, message))

    def _report(self, message: str, *path: str | int) -> None:
        self._fault(self._line(*path), message)

    # -- typed values: None when missing or reported -------------------------------------------------------

    def _number(self, table: Mapping[str, Any], key: str, *section: str | int) -> float | None:
        value = table.get(key)
        if value is None or value is _BAD:
            return None
        return self._as_number(value, key, *section, key)

    def _as_number(self, value: object, what: str, *path: str | int) -> float | None:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self._report(f"{what}: must be a number, not {_shown(value)}", *path)
            return None
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            hint = "; for a rigid body write rigid = true" if path[-1] == "E" and number == math.inf else ""
            self._report(f"{what}: must be a finite number, not {number}{hint}", *path)
            return None
        return number

    def _text(self, table: Mapping[str, Any], key: str, allowed: tuple[str, ...], *section: str | int) -> str | None:
        value = table.get(key)
        if value is None or value is _BAD:
            return None
        if not isinstance(value, str):
            wanted = " or ".join(f'"{choice}"' for choice in allowed) if allowed else "text in quotes"
            self._report(f"{key}: must be {wanted}, not {_shown(value)}", *section, key)
            return None
        if allowed and value not in allowed:
            choices = " or ".join(f'"{choice}"' for choice in allowed)
            self._report(f"{key}: must be {choices}, not {_shown(value)}{_closest(value, allowed)}", *section, key)
            return None
        return value

    def _count(
        self, table: Mapping[str, Any], key: str, least: int, most: int | None, *section: str | int
    ) -> int | None:
        value = table.get(key)
        if value is None or value is _BAD:
            return None
        try:
            return _whole(key, value, least, most)
        except InputError as error:
            self._report(str(error), *section, key)
            return None

    # -- sections ------------------------------------------------------------------------------------------

    def case(self, folder: Path) -> Case | None:
        self._unknown_keys()
        title = self._text(self.data, "title", ())
        contact = self._section("contact")
        pair = self._pair(contact)
        problem = self._problem(contact, pair)
        history = self._history(folder)
        options = self._options()
        arc = options.arc if options else None
        if problem is not None and problem.clearance < 0.0 and arc and arc[1] - arc[0] < 2.0 * math.pi:
            message = "arc: an interference fit is in contact all round, the arc must span 2 pi or be left out"
            self._report(message, "solve", "arc")
        if problem is None or history is None or options is None:
            return None
        return Case(problem, history, options, title or "")

    def _section(self, name: str) -> dict[str, Any]:
        """The table of a section; empty when it is missing."""
        table = self.data.get(name, {})
        if isinstance(table, dict):
            return table
        if table is not _BAD:
            self._report(f"{name}: must be a section [{name}], not {_shown(table)}", name)
        return {}

    def _unknown_keys(self) -> None:
        for name, value in self.data.items():
            if name not in _KEYS and name != "title":
                owners = [section for section, keys in _KEYS.items() if name in keys]
                if isinstance(value, (dict, list)) and name not in sum(_KEYS.values(), ()):
                    known = ", ".join(_bracketed(section) for section in _KEYS)
                    hint = _closest(name, tuple(_KEYS))
                    self._report(f"unknown section [{name}]{hint or f'; the sections are {known}'}", name)
                else:
                    hint = f"; it belongs in {_either(owners)}" if owners else _closest(name, ("title",))
                    self._report(f'unknown key "{name}" before the first section{hint}', name)
            tables = value if isinstance(value, list) else [value]
            for index, table in enumerate(tables):
                if name in _KEYS and isinstance(table, dict):
                    section: Place = (name, index) if isinstance(value, list) else (name,)
                    self._unknown_in(name, table, section)

    def _unknown_in(self, name: str, table: dict[str, Any], section: Place) -> None:
        for key in table:
            if key in _KEYS[name]:
                continue
            hint = _closest(key, _KEYS[name])
            if not hint:
                owners = [other for other, keys in _KEYS.items() if key in keys]
                keys = ", ".join(_KEYS[name])
                hint = f"; it belongs in {_either(owners)}" if owners else f"; the keys are {keys}"
            self._report(f'unknown key "{key}" in {_bracketed(name)}{hint}', *section, key)

    def _pair(self, contact: dict[str, Any]) -> MaterialPair | None:
        plane = cast(Plane, self._text(contact, "plane", ("strain", "stress"), "contact") or "strain")
        if "dundurs" in self.data:
            for name in ("pin", "plate"):
                if name in self.data:
                    self._report(f"[{name}]: give either [dundurs] or [pin] and [plate]", name)
            return self._dundurs(contact, plane)
        pin, plate = self._material("pin"), self._material("plate")
        if pin is None or plate is None:
            return None
        try:
            return MaterialPair(pin, plate, plane)
        except InputError as error:
            self._report(str(error), error.field)
            return None

    def _material(self, name: str) -> Material | None:
        if name not in self.data:
            self._report(f"the section [{name}] is missing", name)
            return None
        table = self._section(name)
        if not isinstance(self.data[name], dict):
            return None
        rigid = table.get("rigid", False)
        if not isinstance(rigid, (bool, _Bad)):
            self._report(f"rigid: must be true or false, not {_shown(rigid)}", name, "rigid")
            rigid = _BAD
        modulus, ratio = self._number(table, "E", name), self._number(table, "nu", name)
        if "material" in table or rigid is True:
            chosen = "material" if "material" in table else "rigid"
            for other in ("E", "nu", "rigid"):
                if other in table and other != chosen and (other != "rigid" or rigid is True):
                    self._report(f"[{name}]: {other} can't be given together with {chosen}", name, other)
            if chosen == "rigid":
                return Material.rigid()
            known = self._text(table, "material", tuple(MATERIALS), name)
            return MATERIALS[known] if known else None
        if "E" not in table and "nu" not in table:
            if rigid is not _BAD:
                self._report(f"[{name}]: needs material, or E and nu, or rigid = true", name)
            return None
        for key in ("E", "nu"):
            if key not in table:
                self._report(f"[{name}]: {key} is missing", name)
        # Each is checked on its own, so that one fault does not hide the other.
        for key, probe in (("E", (modulus, 0.3)), ("nu", (1.0, ratio))):
            if table.get(key) is not None and None not in probe:
                try:
                    Material(*cast(tuple[float, float], probe))
                except InputError as error:
                    self._report(str(error), name, key)
                    modulus = None
        return Material(modulus, ratio) if modulus is not None and ratio is not None else None

    def _dundurs(self, contact: dict[str, Any], plane: Plane) -> MaterialPair | None:
        table = self._section("dundurs")
        given_convention = self._text(table, "convention", ("usual", "paper"), "dundurs")
        convention = cast(Convention, given_convention or "usual")
        needed = ["alpha", "beta", "nu_pin"]
        if "load_parameter" not in contact and ("hole_radius" in contact or "clearance" in contact):
            needed.append("beta_star")
        elif "beta_star" in table:
            message = "beta_star: has no meaning with load_parameter, which counts in units of it"
            self._report(message, "dundurs", "beta_star")
        for key in needed:
            if key not in table:
                why = " (the scale of the moduli; with load_parameter none is needed)" if key == "beta_star" else ""
                self._report(f"[dundurs]: {key} is missing{why}", "dundurs")
        numbers = {key: self._number(table, key, "dundurs") for key in needed}
        before = len(self.problems)
        alpha, ratio = numbers["alpha"], numbers["nu_pin"]
        if alpha is not None and not -1.0 <= alpha <= 1.0:
            self._report(f"alpha: must lie between -1 and 1, not {alpha:g}", "dundurs", "alpha")
        if ratio is not None and not 0.0 <= ratio <= 0.5:
            message = f"nu_pin: Poisson's ratio must lie between 0 and 0.5, not {ratio:g}"
            self._report(message, "dundurs", "nu_pin")
        if len(self.problems) > before or any(value is None for value in numbers.values()):
            return None
        given = cast(dict[str, float], numbers)
        try:
            pair = MaterialPair.from_dundurs(
                given["alpha"], given["beta"], given["nu_pin"], plane, convention, given.get("beta_star", 1.0)
            )
        except InputError as error:
            self._report(str(error), "dundurs", error.field)
            return None
        return pair

    def _problem(self, contact: dict[str, Any], pair: MaterialPair | None) -> Problem | None:
        if "contact" not in self.data:
            self._report("the section [contact] is missing", "contact")
        if not isinstance(self.data.get("contact"), dict):
            return None
        before = len(self.problems)
        dimensionless = "load_parameter" in contact
        if dimensionless:
            for key in ("hole_radius", "clearance"):
                if key in contact:
                    self._report(f"{key}: can't be given together with load_parameter", "contact", key)
            needed = ["load_parameter", "friction"]
        else:
            needed = ["hole_radius", "clearance", "friction"]
        for key in needed:
            if key not in contact:
                other = " (or give load_parameter)" if key in ("hole_radius", "clearance") else ""
                self._report(f"[contact]: {key} is missing{other}", "contact")
        # What is missing or wrong is replaced by something harmless: the rest is checked all the same.
        harmless = {"hole_radius": 1e300, "clearance": 0.0, "load_parameter": 0.0, "friction": 0.0}
        values: dict[str, Any] = {}
        for key in needed:
            number = self._number(contact, key, "contact")
            values[key] = harmless[key] if number is None else number
        values["pin_load"] = self._text(contact, "pin_load", ("centre", "body"), "contact")
        values["rotation"] = self._text(contact, "rotation", ("free", "fixed"), "contact")
        values["hub_radius"] = self._number(contact, "hub_radius", "contact")
        known = all(values[key] is not None or key not in contact for key in ("pin_load", "rotation"))
        if not known:  # what else is said about the pin's motion can't be judged
            values.update(pin_load="centre", rotation="free", hub_radius=None)
        values["pin_load"] = cast(PinLoad, values["pin_load"] or "centre")
        values["rotation"] = cast(Rotation, values["rotation"] or "free")
        steel = MATERIALS["steel"]
        body = pair or MaterialPair(steel, steel)
        build: Callable[..., Problem] = Problem.from_load_parameter if dimensionless else Problem
        neutral = {**harmless, "hub_radius": None, "rotation": values["rotation"]}
        problem = None
        while problem is None:
            try:
                problem = build(body, **values)
            except InputError as error:
                self._report(str(error), "contact", error.field)
                if error.field not in neutral:
                    return None
                values[error.field] = neutral.pop(error.field)
                if error.field == "rotation":  # a body-loaded pin that is held
                    values["pin_load"], known = "centre", False
        if known:
            self.probe = problem
        return problem if pair is not None and len(self.problems) == before else None

    # -- loads ---------------------------------------------------------------------------------------------

    def _history(self, folder: Path) -> LoadHistory | None:
        if "load" in self.data and "history" in self.data:
            self._report("[history]: give either [history] or [[load]] blocks", "history")
            return None
        if "history" in self.data:
            history = self._csv(folder) if self.data["history"] is not _BAD else None
        elif "load" in self.data:
            history = self._blocks() if self.data["load"] is not _BAD else None
        else:
            self._report("no loads: [[load]] blocks or a section [history] are missing", "load")
            return None
        if history is None or self.probe is None:
            return None
        return history if self._check_loads(self.probe, history) else None

    def _check_loads(self, problem: Problem, history: LoadHistory) -> bool:
        """Report every load that does not go with the problem."""
        sound = True
        # What a corner leaves out is taken from the one before; what was never given stays away.
        filled = history.values(initial=np.full(len(LOADS), np.nan))
        corners = [{k: v for k, v in loading.named_load(row).items() if not math.isnan(v)} for row in filled]
        for _ in LOADS:
            try:
                loading.check_loads(problem, history)
                return sound
            except InputError as error:
                sound = False
                name = error.field.split()[0]
                self._fault(self._line_of_load(name), str(error))
                if name not in LOADS:
                    return False
                # Without this load, to see whether another one is at fault too.
                corners = [{key: value for key, value in corner.items() if key != name} for corner in corners]
                history = LoadHistory(corners)
        return sound

    def _line_of_load(self, name: str) -> int:
        blocks = self.data.get("load")
        if not isinstance(blocks, list):
            return self._line("history", "csv")
        giving = [index for index, block in enumerate(blocks) if isinstance(block, dict) and name in block]
        acting = [index for index in giving if blocks[index][name] != 0]
        for index in (*acting, *giving):
            return self._line("load", index, name)
        return self._line("load", 0)

    def _blocks(self) -> LoadHistory | None:
        blocks = self.data["load"]
        if not isinstance(blocks, list) or not all(isinstance(block, dict) for block in blocks):
            self._report("loads are [[load]] blocks, with double brackets", "load")
            return None
        before = len(self.problems)
        corners: list[dict[str, float]] = []
        for index, block in enumerate(blocks):
            repeat = self._count(block, "repeat", 1, None, "load", index) or 1
            named = {name: block[name] for name in LOADS if name in block}
            if not named and not any(key != "repeat" for key in block):
                self._report(f"[[load]]: gives no load; the loads are {', '.join(LOADS)}", "load", index)
            columns = {name: self._column(value, name, index) for name, value in named.items()}
            given = {name: value for name, value in columns.items() if value}
            lengths = {name: len(value) for name, value in given.items() if isinstance(named[name], list)}
            length = max(lengths.values(), default=1)
            if len(set(lengths.values())) > 1:
                first = next(iter(lengths))
                wrong = next(name for name in lengths if lengths[name] != lengths[first])
                counts = f"{first} has {lengths[first]} values and {wrong} {lengths[wrong]}"
                self._report(f"{wrong}: lists in one block must be equally long, {counts}", "load", index, wrong)
                continue
            if len(corners) + length * repeat > MAX_CORNERS:
                key = "repeat" if "repeat" in block else "load"
                self._report(f"{key}: the history has more than {MAX_CORNERS} corners", "load", index, key)
                return None
            rows = [
                {name: value[k] if name in lengths else value[0] for name, value in given.items()}
                for k in range(length)
            ]
            corners.extend(rows * repeat)
        if len(self.problems) > before or not corners:
            return None
        return LoadHistory(corners)

    def _column(self, value: object, name: str, index: int) -> list[float] | None:
        """The numbers of one load in one block; a single number is a list of one."""
        if value is _BAD:
            return None
        if not isinstance(value, list):
            number = self._as_number(value, name, "load", index, name)
            return None if number is None else [number]
        if not value:
            message = f"{name}: must be a number or a list of numbers, not an empty list"
            self._report(message, "load", index, name)
            return None
        numbers = [
            self._as_number(item, f"value {k} of {name}", "load", index, name) for k, item in enumerate(value, start=1)
        ]
        return None if None in numbers else cast(list[float], numbers)

    def _csv(self, folder: Path) -> LoadHistory | None:
        table = self._section("history")
        if not isinstance(self.data["history"], dict):
            return None
        repeat = self._count(table, "repeat", 1, None, "history")
        if "csv" not in table:
            self._report("[history]: csv is missing", "history")
            return None
        name = self._text(table, "csv", (), "history")
        if name is None:
            return None
        try:
            history = LoadHistory.from_csv(folder / name)
        except InputError as error:
            self._report(f"csv: {error.reason}", "history", "csv")
            return None
        except (csv.Error, ValueError) as error:
            self._report(f"csv: can't read {name!r}: {error}", "history", "csv")
            return None
        if len(history) * (repeat or 1) > MAX_CORNERS:
            self._report(f"repeat: the history has more than {MAX_CORNERS} corners", "history", "repeat")
            return None
        return history if repeat is None else history.repeated(repeat)

    # -- solver ----------------------------------------------------------------------------------------------

    def _options(self) -> SolveOptions | None:
        table = self._section("solve")
        before = len(self.problems)
        given: dict[str, Any] = {
            "nodes": self._count(table, "nodes", 5, MAX_NODES, "solve"),
            "method": self._text(table, "method", _METHODS, "solve"),
            "increments": self._count(table, "increments", 1, None, "solve"),
            "arc": self._arc(table.get("arc")),
            "between": self._between(table.get("between")),
        }
        if len(self.problems) > before:
            return None
        return SolveOptions(**{key: value for key, value in given.items() if value is not None})

    def _arc(self, value: object) -> tuple[float, float] | None:
        if value is None or value is _BAD:
            return None
        if not isinstance(value, list) or len(value) != 2:
            self._report("arc: must be a list of two angles in rad, [start, stop]", "solve", "arc")
            return None
        start, stop = (self._as_number(item, "arc", "solve", "arc") for item in value)
        if start is None or stop is None:
            return None
        if not 0.0 < stop - start < 2.01 * math.pi:  # angles in degrees would mean many turns
            allowed = "must run from a smaller to a larger angle, at most a full turn, in rad"
            self._report(f"arc: {allowed}, not {start:g} to {stop:g}", "solve", "arc")
            return None
        return start, stop

    def _between(self, value: object) -> int | tuple[float, ...] | None:
        if value is None or value is _BAD:
            return None
        try:
            return checked_between(value)
        except InputError as error:
            self._report(str(error), "solve", "between")
            return None


def checked_between(value: object) -> int | tuple[float, ...]:
    """`value` if it is a count or increasing fractions between 0 and 1, else :class:`InputError`."""
    if isinstance(value, int) and not isinstance(value, bool):
        return _whole("between", value, 0, 10_000)
    allowed = "must be a whole number, or a list of increasing fractions between 0 and 1"
    if not isinstance(value, (list, tuple)):
        raise InputError("between", f"{allowed}, not {_shown(value)}")
    last = 0.0
    for item in value:
        if isinstance(item, bool) or not isinstance(item, (int, float)) or not last < item < 1.0:
            raise InputError("between", f"{allowed}, not {_shown(value)}")
        last = float(item)
    return tuple(float(item) for item in value)


def _whole(name: str, value: object, least: int, most: int | None = None) -> int:
    whole = isinstance(value, int) and not isinstance(value, bool)
    if not whole or not least <= cast(int, value) <= (math.inf if most is None else most):
        limits = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise InputError(name, f"must be a whole number {limits}, not {_shown(value)}")
    return cast(int, value)


def _shown(value: object) -> str:
    """A TOML value as the user wrote it, more or less."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return "a list" if len(value) > 6 else f"[{', '.join(_shown(item) for item in value)}]"
    if isinstance(value, str):
        return f'"{value}"' if len(value) < 60 else f'"{value[:56]}..."'
    if isinstance(value, int) and abs(value) >= 10**18:
        return "a number of more than 18 digits"
    return str(value)


def _bracketed(section: str) -> str:
    return "[[load]]" if section == "load" else f"[{section}]"


def _either(sections: list[str]) -> str:
    return " or ".join(_bracketed(section) for section in sections)


def _closest(word: str, known: tuple[str, ...]) -> str:
    lower = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), lower, n=1)
    return f', did you mean "{lower[close[0]]}"?' if close else ""


# -- lines ---------------------------------------------------------------------------------------------------

_KEY = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
_KEY_LINE = re.compile(rf"\s*({_KEY}(?:\s*\.\s*{_KEY})*)\s*=(.*)", re.DOTALL)
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_KEY}(?:\s*\.\s*{_KEY})*)\s*\]")


def _locate(lines: list[str]) -> tuple[dict[Place, int], dict[int, Place], dict[int, int]]:
    """Where every key stands, which the TOML parser does not tell.

    Returns
    -------
    places : dict
        Line of every header and key; the first one wins.
    keys : dict
        The key that begins on a line.
    starts : dict
        For every line inside a value of several lines, the line on which the value begins.
    """
    places: dict[Place, int] = {}
    keys: dict[int, Place] = {}
    starts: dict[int, int] = {}
    counts: dict[str, int] = {}
    section: Place = ()
    begin, depth, quote = 0, 0, ""
    for number, line in enumerate(lines, start=1):
        if depth > 0 or quote:
            starts[number] = begin
            depth, quote = _scan(line, depth, quote)
            continue
        header, key = _HEADER.match(line), _KEY_LINE.match(line)
        if header:
            section = _parts(header[2])
            if header[1] == "[[":
                counts[header[2]] = counts.get(header[2], -1) + 1
                places.setdefault(section, number)
                section = (*section, counts[header[2]])
            places.setdefault(section, number)
        elif key:
            begin = number
            keys[number] = (*section, *_parts(key[1]))
            places.setdefault(keys[number], number)
            depth, quote = _scan(key[2], 0, "")
    return places, keys, starts


def _parts(dotted: str) -> Place:
    return tuple(part[0].strip("\"'") for part in re.finditer(_KEY, dotted))


def _scan(text: str, depth: int, quote: str) -> tuple[int, str]:
    """Bracket depth and open multi-line quote after `text`."""
    at = 0
    while at < len(text):
        if quote:
            end = text.find(quote, at)
            if end < 0:
                return depth, quote if len(quote) == 3 else ""
            at, quote = end + len(quote), ""
        elif text[at] == "#":
            break
        elif text[at] in "\"'":
            quote = text[at] * 3 if text.startswith(text[at] * 3, at) else text[at]
            at += len(quote)
        else:
            depth += (text[at] in "[{") - (text[at] in "]}")
            at += 1
    return max(depth, 0), quote if len(quote) == 3 else ""


def _syntax_message(message: str, lines: list[str]) -> tuple[str, int]:
    """A sentence and a line from what the TOML parser says."""
    last = max((number for number, line in enumerate(lines, start=1) if line.strip()), default=1)
    found = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
    if not found:
        digits = next((n for n, line in enumerate(lines, start=1) if re.search(r"\d{4300}", line)), last)
        return "a number of thousands of digits can't be read", digits
    line = int(found[1]) if found[1] else last
    reason = message[: found.start()]
    if twice := re.match(r"Cannot declare \((.*?),?\) twice", reason):
        name = twice[1].replace("'", "").replace(", ", ".")
        hint = "; several loads are [[load]] blocks, with double brackets" if name == "load" else ""
        return f"the section [{name}] appears twice{hint}", line
    if reason.startswith("Cannot overwrite"):
        again = _KEY_LINE.match(lines[line - 1])
        return (f'"{again[1]}" is given twice' if again else "is given twice"), line
    key = _KEY_LINE.match(lines[line - 1])
    if key and reason.startswith("Invalid value"):
        value = key[2].split("#")[0].strip()
        if re.fullmatch(r"[A-Za-z][A-Za-z0-9 .-]*", value):
            return f'{key[1]}: text must stand in quotes, "{value}"', line
        if re.fullmatch(r"[+-]?\.\d.*", value):
            return f"{key[1]}: a number needs a digit before its point, {value.replace('.', '0.', 1)}", line
        return f'{key[1]}: must be a number, true, false, a [list] or "text in quotes"', line
    if reason.startswith("Expected '='"):
        return 'not of the form "key = value"', line
    return f"not TOML: {reason[0].lower()}{reason[1:]}", line
