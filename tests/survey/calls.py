"""Call public names with odd arguments: does fastpin answer with a value or one sentence, and in time?

:func:`examine` finds the public functions, classes, methods and properties by itself, in the lists ``__init__.pyi``,
as far as the reference describes them. A value of :mod:`tests.survey.odd_values`, or a wrong object of fastpin, takes
the place of one argument or of two. All other arguments are valid, see :mod:`tests.survey.valid_values`. The calls run
in a process of their own, in a temporary folder.

A raw error is an exception that is no FastpinError. A call is slow if it takes longer than :data:`LONGEST`.
"""

from __future__ import annotations

import ast
import collections
import contextlib
import dataclasses
import enum
import functools
import importlib
import inspect
import itertools
import logging
import multiprocessing
import os
import re
import resource
import shutil
import tempfile
import time
import traceback
import warnings
import zlib
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import psutil

import fastpin
from fastpin.bodies.body import BodyBase, PinBody, PlateBody
from fastpin.errors import FastpinError, InputError
from tests.survey import odd_values, valid_values
from tests.survey.valid_values import Valid

LONGEST = 10.0
"""Seconds of the processor for one call."""

LONGEST_WAIT = 90.0
"""Seconds of the clock for the same. The machine may be busy with other work."""

MOST_MEMORY = 3 << 30
"""Bytes of address space that the calls may take, beyond the process before."""

COUNT, PAIRS = 400, 0.25
"""Calls of a seed, and the share of them with two odd arguments."""

NOT_CALLED = {
    "fastpin.live.serve": "it serves until it is stopped",
    "fastpin.tables.history_from_csv": "LoadHistory.from_csv calls it with checked arguments",
    "fastpin.storage.resume_joint": "the example is solved to its end",
    "fastpin.joints.JointState.bending": "the pins of the example do not bend",
    "fastpin.tables.column_choices": "LoadHistory.from_csv calls it with the name of its argument",
    **{
        f"fastpin.{name}": "the package calls it with points that it has checked"
        for name in (
            *("lugs.Lug.contains", "lugs.Lug.edges_at", "lugs.Lug.surrounds"),
            *("lugs.Part.crossing", "lugs.Part.nearest", "lugs.Part.share", "lugs.Part.turn_round"),
        )
    },
    **{
        f"fastpin.joints.Joint.{name}": "the package calls it with pins and plates of the joint"
        for name in ("coherence", "pins_of", "radius_in")
    },
    **{
        f"fastpin.{name}": "a plate of any outline has it, whose matrices take seconds"
        for name in (
            *("State.outline_hoop_stress", "State.outline_peak", "figures.plot_outline", "figures.plot_displacement"),
            *("joints.JointResult.crack_growth", "joints.JointResult.knowing_plate"),
        )
    },
}
"""Callables that are left out, and why."""

OF_BUSH = ("around", "layer", "check_material")
"""Methods of a bush for the package only, as the questions of :mod:`fastpin.bodies.body` are."""

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"
"""The pages that describe the public names."""


class Parameter(NamedTuple):
    """A parameter of a callable: its name, its annotation as text, and whether a call can do without it."""

    name: str
    annotation: str
    is_optional: bool
    keyword: bool


@dataclasses.dataclass(frozen=True)
class Target:
    """A public callable.

    Attributes
    ----------
    name : str
        Its full name, such as ``fastpin.Grid.arc``.
    owner : type or None
        The class whose valid objects the call needs; None for functions, classes and class methods.
    call : callable
        The callable, with the object as the first argument if there is an owner.
    parameters : tuple of Parameter
    """

    name: str
    owner: type | None
    call: Callable[..., Any]
    parameters: tuple[Parameter, ...]


class Attempt(NamedTuple):
    """A call: the name of the callable, and the name of the odd value of each parameter that has one."""

    target: str
    odd: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        return f"{self.target}({', '.join(f'{name}={value}' for name, value in self.odd)})"


class Ending(NamedTuple):
    """The end of an attempt: "accepted", "InputError", "FastpinError", "raw" or "slow", and the exception in words."""

    kind: str
    words: str = ""


# -- the public callables ------------------------------------------------------------------------------------


def public_targets() -> dict[str, Target]:
    """All callables that the reference describes, by name. A callable with several names has the shortest one."""
    text = "\n".join(path.read_text("utf-8") for path in sorted(REFERENCE.glob("*.md")))
    described = set(re.findall(r"^\.\. auto\w+:: (\S+)$", text, re.MULTILINE))
    found: dict[str, Target] = {}
    seen: set[int] = set()
    package = Path(fastpin.__file__).parent
    for stub in sorted(package.rglob("__init__.pyi"), key=lambda path: (len(path.parts), path)):
        folder = ".".join(("fastpin", *stub.parent.relative_to(package).parts))
        module = importlib.import_module(folder)
        names = [alias.asname or alias.name for node in ast.parse(stub.read_text("utf-8")).body for alias in node.names]  # type: ignore[attr-defined]
        for name in names:
            value = getattr(module, name)
            whole = f"{folder}.{name}"
            if isinstance(value, ModuleType):
                inner = [(one, getattr(value, one.rpartition(".")[2])) for one in described if _lies_in(one, whole)]
            else:
                inner = [(whole, value)] if whole in described else []
            for full, one in sorted(inner, key=lambda pair: pair[0]):
                found |= {target.name: target for target in _targets_of(full, one, seen)}
    return {name: target for name, target in found.items() if name not in NOT_CALLED}


def _lies_in(name: str, module: str) -> bool:
    return name.rpartition(".")[0] == module


def _targets_of(name: str, value: Any, seen: set[int]) -> Iterator[Target]:
    """The callables of a public name. `seen` holds the ids of the objects that have another name."""
    if id(value) in seen or not callable(value) or not str(getattr(value, "__module__", "")).startswith("fastpin"):
        return
    seen.add(id(value))
    if inspect.isclass(value):
        yield from _targets_of_class(name, value)
    else:
        yield Target(name, None, value, _parameters(value))


def _targets_of_class(name: str, owner: type) -> Iterator[Target]:
    """The constructor, methods and properties of a class; errors, protocols and enumerations have their base's."""
    if issubclass(owner, (BaseException, enum.Enum)) or getattr(owner, "_is_protocol", False):
        return
    yield Target(name, None, owner, _parameters(owner))
    asked = {*dir(PinBody), *dir(PlateBody), *OF_BUSH} if issubclass(owner, BodyBase) else ()
    for inner in dir(owner):
        if (
            inner in asked
            or inner.startswith("_")
            or not any(inner in vars(base) for base in owner.__mro__ if _is_ours(base))
        ):
            continue
        static = inspect.getattr_static(owner, inner)
        if isinstance(static, (classmethod, staticmethod)):
            call = getattr(owner, inner)
            yield Target(f"{name}.{inner}", None, call, _parameters(call))
        elif isinstance(static, (property, functools.cached_property)):
            yield Target(f"{name}.{inner}", owner, functools.partial(_attribute, inner), ())
        elif inspect.isfunction(static):
            yield Target(f"{name}.{inner}", owner, static, _parameters(static)[1:])


def _is_ours(base: type) -> bool:
    return base.__module__.startswith("fastpin")


def _attribute(name: str, value: Any) -> Any:
    return getattr(value, name)


def _parameters(call: Callable[..., Any]) -> tuple[Parameter, ...]:
    """The parameters of a callable. Keywords of any name become those that :mod:`tests.survey.valid_values` knows."""
    found = []
    for name, one in inspect.signature(call).parameters.items():
        if one.kind == inspect.Parameter.VAR_KEYWORD:
            found += [Parameter(key, "", True, True) for key in valid_values.KEYWORDS.get(call.__qualname__, ())]
        elif one.kind != inspect.Parameter.VAR_POSITIONAL:
            is_optional = one.default is not inspect.Parameter.empty
            text = one.annotation if isinstance(one.annotation, str) else inspect.formatannotation(one.annotation)
            annotation = re.sub(r"\b(\w+\.)+", "", text)
            found.append(Parameter(name, annotation, is_optional, one.kind != inspect.Parameter.POSITIONAL_ONLY))
    return tuple(found)


# -- the attempts --------------------------------------------------------------------------------------------


def attempts(targets: dict[str, Target], values: Iterable[str], seed: int) -> list[Attempt]:
    """:data:`COUNT` attempts at random: an odd value of one parameter, or of two."""
    names, rng, chosen = list(values), np.random.default_rng(seed), []
    places = [(target, place) for target in targets.values() for place in range(len(target.parameters))]
    for _ in range(COUNT):
        target, first = places[rng.integers(len(places))]
        others = [place for place in range(len(target.parameters)) if place != first]
        both = {first, int(rng.choice(others))} if others and rng.random() < PAIRS else {first}
        odd = tuple((target.parameters[place].name, names[rng.integers(len(names))]) for place in sorted(both))
        chosen.append(Attempt(target.name, odd))
    return chosen


def sample(targets: dict[str, Target], values: Iterable[str]) -> list[Attempt]:
    """An odd value for each parameter, always the same one, and each call with valid arguments."""
    names = list(values)
    chosen = [Attempt(name, ()) for name in targets]
    for target in targets.values():
        for parameter in target.parameters:
            place = zlib.crc32(f"{target.name}.{parameter.name}".encode()) % len(names)
            chosen.append(Attempt(target.name, ((parameter.name, names[place]),)))
    return chosen


# -- calls ---------------------------------------------------------------------------------------------------


class Caller:
    """It makes the calls, in the present process and folder."""

    def __init__(self, targets: dict[str, Target], valid: Valid) -> None:
        self._targets, self._valid = targets, valid

    @property
    def odd(self) -> dict[str, Callable[[], Any]]:
        """All odd values by name: those of the table, and the objects of fastpin."""
        return odd_values.VALUES | {f"a {name}": make for name, make in self._valid.objects.items()}

    def attempt(self, attempt: Attempt) -> Ending:
        """Make a call, and return how it ended."""
        arguments, keywords = self.arguments(attempt)
        try:
            value = self._targets[attempt.target].call(*arguments, **keywords)
            if inspect.isgenerator(value):
                collections.deque(itertools.islice(value, 1000), 0)
        except valid_values.Enough:
            return Ending("accepted")
        except InputError as error:
            return Ending("InputError", str(error))
        except FastpinError as error:
            return Ending("FastpinError", str(error))
        except BaseException as error:
            return Ending("raw", _in_words(error))
        return Ending("accepted")

    def arguments(self, attempt: Attempt) -> tuple[list[Any], dict[str, Any]]:
        """The arguments of a call, by position and by name. LookupError says which one has no valid value."""
        target, odd = self._targets[attempt.target], dict(attempt.odd)
        arguments: list[Any] = [] if target.owner is None else [self._valid.object_of(target.owner, target.name)]
        keywords: dict[str, Any] = {}
        for parameter in target.parameters:
            if parameter.name in odd:
                value = self.odd[odd[parameter.name]]()
            else:
                value = self._valid.argument(target.name, parameter.name, parameter.annotation, parameter.is_optional)
                if value is valid_values.LEFT_OUT:
                    continue
            if parameter.keyword:
                keywords[parameter.name] = value
            else:
                arguments.append(value)
        return arguments, keywords


def _in_words(error: BaseException) -> str:
    """An exception with the last lines of fastpin's code and of any code that it went through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "/fastpin/" in frame.filename]
    places = [f"{Path(frame.filename).parent.name}/{Path(frame.filename).name}:{frame.lineno}" for frame in ours[-1:]]
    try:
        words = str(error)
    except Exception:
        words = ""
    return f"{type(error).__name__}: {' '.join(words.split())[:80]} ({', '.join(places)})"


def _work(caller: Caller, todo: list[Attempt], first: int, pipe: Connection, folder: Path) -> None:
    """Make the attempts from `first` on in this process, and send the ending of each."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, used + MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    warnings.simplefilter("ignore")
    logging.disable()
    devnull = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(devnull, stream)
    for attempt in todo[first:]:
        restore(folder)
        pipe.send(None)  # the time begins
        ending = caller.attempt(attempt)
        pipe.send(ending)


def restore(folder: Path) -> None:
    """Fill the present folder anew with the files of another one, unless it has them already."""
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    if {path.name: path.stat().st_mtime_ns for path in Path().iterdir()} != before:
        for path in Path().iterdir():
            shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        shutil.copytree(folder, Path(), dirs_exist_ok=True, symlinks=True)


def endings(caller: Caller, todo: list[Attempt], folder: Path) -> Iterator[tuple[Attempt, Ending]]:
    """Make the attempts in another process, which is replaced after a slow call or a crash.

    `folder` holds the files that the calls may read.
    """
    context = multiprocessing.get_context("fork")
    place = 0
    while place < len(todo):
        ours, theirs = context.Pipe()
        worker = context.Process(target=_work, args=(caller, todo, place, theirs, folder), daemon=True)
        worker.start()
        theirs.close()
        try:
            while place < len(todo):
                ours.recv()
                if slow := _too_slow(ours, worker.pid):
                    yield todo[place], Ending("slow", f"no end within {slow}")
                    break
                ending = ours.recv()
                place += 1
                yield todo[place - 1], ending
            else:
                worker.join()
                return
        except EOFError:
            worker.join()
            yield todo[place], Ending("raw", f"the process ended with the exit code {worker.exitcode}")
        finally:
            if worker.is_alive():
                worker.kill()
                worker.join()
        place += 1


def _too_slow(pipe: Connection, process: int | None) -> str:
    """Wait for the end of a call in a process. Return the limit that it exceeds, or an empty text."""
    began, used = time.monotonic(), _cpu_seconds(process)
    while not pipe.poll(0.1 * LONGEST):
        if _cpu_seconds(process) - used > LONGEST:
            return f"{LONGEST:g} s of the processor"
        if time.monotonic() - began > LONGEST_WAIT:
            return f"{LONGEST_WAIT:g} s"
    return ""


def _cpu_seconds(process: int | None) -> float:
    """Seconds of the processor that a process and its ended children have taken; 0 if it has ended."""
    try:
        return sum(psutil.Process(process).cpu_times()[:4])
    except psutil.NoSuchProcess:
        return 0.0


def examine(choose: Callable[[dict[str, Target], list[str]], list[Attempt]]) -> Iterator[tuple[Attempt, Ending]]:
    """Yield all attempts that `choose` makes from callables and odd values, with their endings."""
    targets, before = public_targets(), Path.cwd()
    with tempfile.TemporaryDirectory() as temporary:
        folder, work = Path(temporary) / "files", Path(temporary) / "work"
        folder.mkdir()
        work.mkdir()
        os.chdir(folder)
        try:
            with contextlib.suppress(ImportError):  # optional packages take seconds to import
                importlib.import_module("pylife.materiallaws")
                importlib.import_module("xarray")
            caller = Caller(targets, Valid())
            os.chdir(work)
            yield from endings(caller, choose(targets, list(caller.odd)), folder)
        finally:
            os.chdir(before)
