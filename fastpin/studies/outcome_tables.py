"""Outcomes from the table [outcomes] of a plan, from a file of functions, and from Python.

All faults of a table are reported at once, each with its line.
"""

from __future__ import annotations

import ast
import contextlib
import inspect
import json
import marshal
import os
import pickle
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from fastpin.assess.questions import LEAST, QUESTIONS, of_margin, of_question
from fastpin.assess.wear import RACE_OUTCOMES, WEAR_OUTCOMES, of_wear
from fastpin.casefile.beside import READERS
from fastpin.casefile.profiles import read_wear
from fastpin.casefile.toml_text import CaseText, NamedTable, Section, read_text
from fastpin.damage.criteria import FATIGUE_CRITERIA
from fastpin.errors import CaseFileError, InputError, printable
from fastpin.model import Profile, points, synonyms
from fastpin.model.assessment import SPECTRA
from fastpin.model.checks import alternatives, as_toml, file_path, string
from fastpin.model.wear import WEAR_KEYS, Wear
from fastpin.states.margins import MARGINS
from fastpin.states.quantities import QUANTITIES
from fastpin.studies.joint_outcomes import read_joint_outcome
from fastpin.studies.outcomes import (
    CYCLE_QUANTITIES,
    INTERFACES,
    TAKES,
    FunctionOfFile,
    StudyOutcome,
    digest,
    of_last_cycle,
    of_quantity,
)
from fastpin.studies.run_end import KEY_FIGURES, RUN_COLUMNS

Outcomes = dict[str, StudyOutcome]
"""Outcomes by the names that the user chose."""

KEYS = {
    "quantity": ("quantity", "take", "over", "interface"),
    "cycle": ("cycle", "interface"),
    "wear": ("wear", *WEAR_KEYS, "criterion", "body"),
    **{name: (name, *question.keys) for name, question in QUESTIONS.items()},
    "margin": ("margin", "body"),
    "joint": ("joint", "pin", "plate", "take"),
    "function": ("function", "classes"),
}
"""The first key of an outcome says what is read. The others may stand beside it."""

RENAMED = {"dissipation": "energy_per_cycle", "pressure": "largest_pressure"}
"""Older names of quantities of wear, which plans may still have."""

LONGEST_NAME = 64
"""Most characters in the name of an outcome."""

TAKES_OF_CLASS = ("last", "largest", "smallest")
"""Ways to take a class from those of several states."""

MOST_CLASSES = 8
"""Most classes of an outcome: more can't be told apart in a map."""

LONGEST_CLASS = 40
"""Most letters in the words of a class. They stand in legends."""

_EXAMPLE = '{ quantity = "peak_shear", take = "largest" }, { cycle = "dissipation" } or { function = "my.py:wear" }'


def read_outcomes(path: str | Path, beside: Mapping[str, Any] = MappingProxyType({})) -> Outcomes:
    """Read all outcomes of a file.

    Parameters
    ----------
    path : path
        A Python file (.py): all its public functions, each called with a result. The file is not run yet. Or a TOML
        file with a table [outcomes], such as a plan; its other keys are not read.
    beside : mapping of str, optional
        What outcomes leave out, and the joint of ``{ joint = ... }``, see :func:`outcomes_from`.

    Returns
    -------
    dict of str to Outcome

    Raises
    ------
    CaseFileError
        With all faults of the file.
    InputError
        If `path` is no path, or has another suffix.
    """
    path = file_path("outcomes", path)
    if path.suffix not in (".py", ".toml"):
        raise InputError(str(path), "must end in .py or .toml to be a file of outcomes")
    text = read_text(path)
    if path.suffix == ".toml":
        source = CaseText(text)
        if source.readable and "outcomes" not in source.root:
            source.report("the section [outcomes] is missing")
    else:
        functions = _functions(path, text)
        tables = {name: {"function": f"{path.name}:{name}"} for name in functions}
        source = CaseText("").with_tables({"outcomes": tables})
        if not functions:
            source.report("defines no function whose name begins with a letter")
    found = outcomes_in_text(source, path.parent, beside)
    if source.faults:
        raise CaseFileError(str(path), source.faults)
    return found


def outcomes_from(given: Mapping[str, Any], beside: Mapping[str, Any] = MappingProxyType({})) -> Outcomes:
    """Check outcomes that are given in Python.

    Parameters
    ----------
    given : mapping of str
        By name: a function of a result, a table as in a plan, such as ``{"quantity": "dx", "take": "largest"}``, or an
        :class:`StudyOutcome` of :func:`read_outcomes`. The attribute ``unit`` of a function is the unit of its value.
    beside : mapping of str, optional
        What outcomes leave out, see :meth:`fastpin.studies.variation.BaseCase.beside`.

    Returns
    -------
    dict of str to Outcome

    Raises
    ------
    CaseFileError
        With all faults. It is an :class:`InputError` for the field "outcomes".
    """
    if not isinstance(given, Mapping):
        raise InputError("outcomes", f"must be a dict of functions and tables by name, not {as_toml(given)}")
    source = CaseText("").with_tables({"outcomes": dict(given)})
    found = outcomes_in_text(source, Path(), beside)
    if source.faults:
        raise CaseFileError("outcomes", source.faults)
    return found


def outcomes_in_text(source: CaseText, folder: Path, beside: Mapping[str, Any] = MappingProxyType({})) -> Outcomes:
    """Read the table [outcomes] of a text, and report its faults.

    Relative names of files start in `folder`. `beside` has the sections of the case, for outcomes that leave their keys
    out. The outcomes have no meaning if the text has faults.
    """
    if not isinstance(beside, Mapping):
        raise InputError("beside", f"must be a dict of sections, not {as_toml(beside)}")
    found: Outcomes = {}
    section = source.section("outcomes")
    for name in section.table:
        value = section.value(name)
        if fault := _name_fault(name, found):
            section.report(fault, str(name))
            continue
        try:
            if isinstance(value, StudyOutcome):
                found[name] = value
            elif isinstance(value, Mapping):
                outcome = _of_table(source, NamedTable(source, ("outcomes", name), value, name), folder, beside)
                found |= {} if outcome is None else {name: outcome}
            elif callable(value):
                found[name] = _of_callable(value)
            elif value is not None or section.table[name] is None:  # A value that can't be parsed is reported already.
                section.report(f"{name}: must be a table such as {_EXAMPLE}, not {as_toml(value)}", name)
        except InputError as error:
            section.report(f"{name}: {error}", name)
    for name, fault in bar_faults(found).items():
        section.report(fault, name)
    return found


def bar_faults(outcomes: Iterable[str]) -> dict[str, str]:
    """Return the faults of names of outcomes that the error bar of another number has in tables, by name."""
    others = {*outcomes, *KEY_FIGURES}
    stems = {name: name.removesuffix("_bar") for name in outcomes if name.endswith("_bar")}
    taken = {name: stem for name, stem in stems.items() if stem in others}
    words = "is the column of the error bar of {}; choose another name"
    return {name: f"{name}: {words.format(stem)}" for name, stem in taken.items()}


def has_strengths(outcomes: Outcomes) -> bool:
    """Whether an outcome depends on strengths: then they are a part of the ids of runs."""
    return any(outcome.has_strengths for outcome in outcomes.values())


def _name_fault(name: object, others: Outcomes) -> str:
    """Return the fault of an outcome's name beside `others`; empty if there is none."""
    if not isinstance(name, str) or not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{,{LONGEST_NAME - 1}}}", name):
        rule = "the name of an outcome is a letter, then letters, digits and underscores, at most"
        return f"{as_toml(name)}: {rule} {LONGEST_NAME}"
    if name.lower() in RUN_COLUMNS:
        return f"{name}: is a column of every sweep; choose another name"
    other = next((other for other in others if other.lower() == name.lower()), None)
    return f"{name}: there is {other} already; capital letters make no difference" if other else ""


# -- single outcomes ---------------------------------------------------------------------------------------------


def _of_table(source: CaseText, section: Section, folder: Path, beside: Mapping[str, Any]) -> StudyOutcome | None:
    """Read the table of one outcome, and report its faults. No outcome if a value is wrong."""
    first = [key for key in KEYS if key in section]
    if len(first) != 1:
        section.report(f"must have one of the keys {', '.join(KEYS)}, such as {_EXAMPLE}")
        return None
    allowed = KEYS[first[0]]
    others = f"may be {' and '.join(allowed[1:])}" if len(allowed) > 1 else "is no other key"
    section.check_keys(allowed, "", f"; beside {first[0]} there {others}")
    if first[0] == "joint":
        return read_joint_outcome(section, beside.get("joint"))
    if "joint" in beside and first[0] != "function":
        section.report(
            f'{first[0]}: is for one pin; of a joint there are {{ joint = "share", pin = ... }} and functions'
        )
        return None
    if first[0] == "wear":
        return _of_wear(section, folder, beside)
    if first[0] in QUESTIONS:
        return _of_section(first[0], source, section, beside)
    if first[0] == "margin":
        return _of_margin(section, beside)
    if first[0] == "function":
        return _of_function(section, folder)
    return _of_cycle(section) if first[0] == "cycle" else _of_quantity(section)


def _of_quantity(section: Section) -> StudyOutcome | None:
    quantity = section.choice("quantity", tuple(QUANTITIES))
    take, span = section.choice("take", TAKES), section.choice("over", SPECTRA)
    interface = section.choice("interface", INTERFACES)
    if quantity is None or take is None or span is None or interface is None:
        return None
    kind = QUANTITIES[quantity].kind
    if kind == "class" and take not in TAKES_OF_CLASS:
        section.report(f"take: {quantity} is a class: take {alternatives(TAKES_OF_CLASS)}", "take")
        return None
    if take == "largest magnitude" and kind == "angle":
        section.report('take: a place on the hole has no magnitude; take "largest" or "smallest"', "take")
        return None
    if take == "last" and span == "cycle":
        section.report('over: the last state is that of the history, too; take "largest" or another', "over")
        return None
    return of_quantity(quantity, take, span, interface)


def _of_cycle(section: Section) -> StudyOutcome | None:
    quantity, interface = section.choice("cycle", tuple(CYCLE_QUANTITIES)), section.choice("interface", INTERFACES)
    if quantity is None or interface is None:
        return None
    kind, classes = CYCLE_QUANTITIES[quantity].kind, dict(CYCLE_QUANTITIES[quantity].classes)
    definition = {"cycle": quantity} | ({} if interface == INTERFACES[0] else {"interface": interface})
    return StudyOutcome(kind, "", json.dumps(definition), partial(of_last_cycle, quantity, interface), classes)


def _of_wear(section: Section, folder: Path, beside: Mapping[str, Any]) -> StudyOutcome | None:
    """Read a number of the last cycle, followed on a profile that wears: as the case says, unless the table does."""
    default: Wear | None = beside.get("wear")
    quantity = RENAMED.get(str(section.table.get("wear"))) or section.choice("wear", (*WEAR_OUTCOMES, *RACE_OUTCOMES))
    asked = beside["fatigue"].criteria if "fatigue" in beside else ()
    with_life = tuple(name for name, each in FATIGUE_CRITERIA.items() if each.counting is not None)
    criterion = section.choice("criterion", (*asked, *(name for name in with_life if name not in asked)))
    body: Any = section.choice("body", points.BODIES)
    if quantity in WEAR_OUTCOMES:
        for key in ("criterion", "body"):
            if key in section:
                section.report(f"{key}: has no effect on the {quantity.replace('_', ' ')}", key)
    if default is None and "cycles" not in section:
        section.report("cycles is missing, such as cycles = 1e5; a section [wear] of the case gives it too")
    wear = read_wear(section, folder, {} if default is None else default.given)
    if quantity is None or criterion is None or body is None or wear is None:
        return None
    how = {name: value.entries() if isinstance(value, Profile) else value for name, value in wear.given.items()}
    definition = {"wear": quantity, "how": how, "criterion": criterion, "body": body}
    output, read = (WEAR_OUTCOMES | RACE_OUTCOMES)[quantity], partial(of_wear, quantity, wear, criterion, body)
    return StudyOutcome(output.kind, "", json.dumps(definition, sort_keys=True), read, dict(output.classes), wear=wear)


def _of_section(name: str, source: CaseText, section: Section, beside: Mapping[str, Any]) -> StudyOutcome | None:
    """Read a number of a section beside the problem: as the case says, unless the table does."""
    quantity = section.choice(name, tuple(QUESTIONS[name].outcomes))
    how = READERS[name](source, section, _entries(name, beside[name]) if name in beside else {})
    if quantity is None or how is None:
        return None
    if name == "fatigue":
        if "criterion" in section and len(how.criteria) > 1:
            words = f"must be one criterion, not {len(how.criteria)}; each outcome has one"
            section.report(f"criterion: {words}", "criterion")
            return None
        how = how.changed(criterion=how.criteria[0])
    how = QUESTIONS[name].in_sweeps(how)
    definition = json.dumps({name: quantity, "how": _entries(name, how)}, sort_keys=True)
    output, _ = QUESTIONS[name].outcomes[quantity]
    kind, unit = output.kind, ""
    if kind == "life":  # spectra are no cycles, and have no kind
        passes = getattr(how, "passes", beside.get("passes", "cycles or spectra"))
        kind, unit = ("life", "") if passes == "cycles" else ("", passes)
    return StudyOutcome(kind, unit, definition, partial(of_question, name, quantity, how), dict(output.classes))


def _entries(name: str, how: Any) -> dict[str, Any]:
    """Return the keys and values of a section, for the definition of an outcome."""
    entries: dict[str, Any] = how.toml() if name == "fatigue" else how.entries()
    return entries


def _of_margin(section: Section, beside: Mapping[str, Any]) -> StudyOutcome | None:
    """Read the smallest margin of safety, of all kinds or of one kind, with the sections of the case."""
    of_questions = (name for question in QUESTIONS.values() for name in question.margin_names)
    name = section.choice("margin", (LEAST, *MARGINS, *of_questions))
    owner = section.choice("body", ("pin", "bush", "plate")) if "body" in section else None
    if name is None or ("body" in section and owner is None):
        return None
    # Some kinds of margins need a section of the case.
    needed = next((section for section, question in QUESTIONS.items() if name in question.margin_names), None)
    if needed is not None and needed not in beside:
        section.report(f'margin: "{name}" needs a section [{needed}] of the case', "margin")
        return None
    asked = [each for each in QUESTIONS if each in beside and (name == LEAST or each == needed)]
    sections = {each: QUESTIONS[each].in_sweeps(beside[each]) for each in asked}
    definition = {"margin": name, "body": owner, **{each: _entries(each, value) for each, value in sections.items()}}
    text = json.dumps({key: value for key, value in definition.items() if value is not None}, sort_keys=True)
    return StudyOutcome("", "", text, partial(of_margin, name, owner, tuple(sections.items())), has_strengths=True)


def _of_function(section: Section, folder: Path) -> StudyOutcome | None:
    """Read a function of a file, ``FILE.py:NAME``."""
    value = section.value("function")
    if value is None:
        return None
    file, colon, function = value.rpartition(":") if isinstance(value, str) else ("", "", "")
    if not (colon and file.endswith(".py") and file.isprintable() and function):
        section.report(f'function: must be FILE.py:NAME, such as "my.py:wear", not {as_toml(value)}', "function")
        return None
    if Path(file).is_absolute() or ".." in Path(file).parts:  # A plan runs no code from elsewhere.
        section.report(f"{file}: must lie beside the plan, or in a folder below", "function")
        return None
    path = folder / file
    # Unlike Path.resolve, realpath takes links that lead to themselves.
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        section.report(f"{file}: is a link that leads out of the folder of the plan", "function")
        return None
    try:
        text = read_text(path)
        functions = _functions(path, text)
    except CaseFileError as error:
        for line, message in error.problems:
            section.report(f"{file}{f', line {line}' if line else ''}: {message}", "function")
        return None
    if function not in functions:
        known = f"; there are {', '.join(functions)}" if functions else ""
        hint = synonyms.closest(function, tuple(functions)) or known
        section.report(f'there is no function "{function}" in {file}{hint}', "function")
        return None
    definition = {"function": function, "file": digest(text)}
    reader = FunctionOfFile(str(path), text, function)
    if "classes" not in section:
        return StudyOutcome("", functions[function], json.dumps(definition), reader)
    classes = section.checked("classes", _classes)
    if classes is None:
        return None
    if functions[function]:
        section.report(f"classes: the number of a class has no unit, but {function}.unit is set", "classes")
    # The words of a class change no value.
    return StudyOutcome("class", "", json.dumps(definition | {"classes": list(classes)}), reader, classes)


def _classes(field: str, value: object) -> dict[int, str]:
    """Check the words of the classes of an outcome, by number, and return them in the order of the numbers."""
    if not isinstance(value, Mapping) or not 2 <= len(value) <= MOST_CLASSES:
        example = '{ 0 = "stick", 1 = "slip" }'
        raise InputError(field, f"must be a table of 2 to {MOST_CLASSES} numbers with words, such as {example}")
    found: dict[int, str] = {}
    for key, word in value.items():
        if not re.fullmatch(r"-?\d{1,9}", str(key)) or isinstance(key, bool):
            raise InputError(field, f'each class has a whole number, such as 0 = "stick", not {as_toml(key)}')
        words = string(f"{field}: {key}", word)
        if not words.strip() or len(words) > LONGEST_CLASS or not words.isprintable():
            raise InputError(f"{field}: {key}", f"must be text of 1 to {LONGEST_CLASS} letters")
        if int(key) in found or words in found.values():
            raise InputError(field, f"the numbers and words of classes must differ, but there is {as_toml(word)} twice")
        found[int(key)] = words
    return dict(sorted(found.items()))


def _of_callable(function: Callable[..., Any]) -> StudyOutcome:
    """An outcome of a function in Python. Its definition changes with its code, and with the text of its module."""
    module, content = "", b""
    code = marshal.dumps(function.__code__) if inspect.isfunction(function) else b""
    with contextlib.suppress(Exception):  # The function may be anything that can be called.
        content = pickle.dumps(function)
        module = inspect.getsource(inspect.getmodule(function))  # type: ignore[arg-type]
    file = digest(f"{code!r}{content!r}{module}")
    unit = printable(string("the attribute unit", getattr(function, "unit", "")))
    definition = {"function": getattr(function, "__qualname__", ""), "file": file}
    return StudyOutcome("", unit, json.dumps(definition), function)


def _functions(path: Path, text: str) -> dict[str, str]:
    """Names and units of the public functions that a Python file defines, in their order. The file is not run.

    Raises
    ------
    CaseFileError
        If the text is not Python, or a unit is no text in quotes.
    """
    try:
        tree = ast.parse(text, str(path))
        statements = list(_top_level(tree.body))
    except SyntaxError as error:
        raise CaseFileError(str(path), [(error.lineno or 0, f"is not Python: {error.msg}")]) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise CaseFileError(str(path), [(0, f"is not Python: {error}")]) from None
    found: dict[str, str] = {}
    for statement in statements:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
            found[statement.name] = ""
            continue
        for target in statement.targets:
            if isinstance(target, ast.Name) and isinstance(statement.value, ast.Lambda):
                found[target.id] = ""
            elif (
                isinstance(target, ast.Attribute)
                and target.attr == "unit"
                and isinstance(target.value, ast.Name)
                and target.value.id in found  # another object may have a unit too
            ):
                found[target.value.id] = _written_unit(path, target.value.id, statement)
    return {name: unit for name, unit in found.items() if not name.startswith("_")}


def _top_level(body: list[ast.stmt]) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef | ast.Assign]:
    """Yield the functions and assignments of a file, also inside of conditions."""
    for statement in body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.Assign):
            yield statement
        elif isinstance(statement, ast.If | ast.Try | ast.With):
            yield from _top_level([*statement.body, *getattr(statement, "orelse", [])])


def _written_unit(path: Path, name: str, statement: ast.Assign) -> str:
    """The unit of a function, which is read without running the file."""
    value = statement.value.value if isinstance(statement.value, ast.Constant) else None
    if not isinstance(value, str):
        words = f"{name}: the attribute unit must be text in quotes, as the file is read without being run"
        raise CaseFileError(str(path), [(statement.lineno, words)])
    return string("the attribute unit", value)
