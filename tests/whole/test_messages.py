"""Bad and suspicious input, and the sentence that answers it: in Python, in a case file and on the command line."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest

import fastpin
from fastpin.casefile.lug import LUG_KEYS
from fastpin.casefile.reader import EXAMPLE, KEYS, parse_case
from fastpin.cli.main import main
from fastpin.cli.options import parser
from fastpin.errors import CaseFileError, InputError
from fastpin.model import synonyms
from fastpin.studies.plan import parse_plan

PAIR = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])

UNKNOWN_KEYS: list[tuple[str, str, str]] = [
    ("friction = 0.4", "mu = 0.4", 'unknown key "mu" in [contact], did you mean "friction"?'),
    ("friction = 0.4", "cof = 0.4", 'unknown key "cof" in [contact], did you mean "friction"?'),
    ("hole_radius = 10e-3", "R = 10e-3", 'unknown key "R" in [contact], did you mean "hole_radius"?'),
    ("hole_radius = 10e-3", "radius = 10e-3", 'unknown key "radius" in [contact], did you mean "hole_radius"?'),
    ("hole_radius = 10e-3", "diameter = 20e-3", 'unknown key "diameter" in [contact]; hole_radius is half of it'),
    ("clearance = 20e-6", "delta = 20e-6", 'unknown key "delta" in [contact], did you mean "clearance"?'),
    ("clearance = 20e-6", "gap = 20e-6", 'unknown key "gap" in [contact], did you mean "clearance"?'),
    (
        "clearance = 20e-6",
        "pin_radius = 9.98e-3",
        'unknown key "pin_radius" in [contact]; clearance is the hole radius minus the pin radius',
    ),
    (
        "clearance = 20e-6",
        "interference = 20e-6",
        'unknown key "interference" in [contact]; a negative clearance is an interference fit',
    ),
    ("E  = 69e9", "youngs_modulus = 69e9", 'unknown key "youngs_modulus" in [plate], did you mean "E"?'),
    ("E  = 69e9", "G = 26e9", 'unknown key "G" in [plate]; with the shear modulus G, E is 2 G (1 + nu)'),
    ("nu = 0.33", "poisson = 0.33", 'unknown key "poisson" in [plate], did you mean "nu"?'),
    ("P = 2.42e6", "p = 2.42e6", 'unknown key "p" in [[load]], did you mean "P"?'),
    ("P = 2.42e6", "load = 2.42e6", 'unknown key "load" in [[load]], did you mean "P"?'),
    (
        "P = 2.42e6",
        "Fy = -2.42e6",
        'unknown key "Fy" in [[load]]; P is the force downwards: the opposite of a force along +y',
    ),
    ("P = 2.42e6", "P = 2.42e6\ntau = 1e6", 'unknown key "tau" in [[load]], did you mean "sxy"?'),
    (
        "friction = 0.4",
        "friction = 0.4\nE = 69e9",
        'unknown key "E" in [contact]; it belongs in [pin] or [plate] or [plate_body]',
    ),
    (
        "friction = 0.4",
        "friction = 0.4\nload = 2.42e6",
        'unknown key "load" in [contact]; loads are [[load]] blocks, with double brackets',
    ),
    ("nodes = 401", "mesh = 401", 'unknown key "mesh" in [solve], did you mean "nodes"?'),
    (
        "nodes = 401",
        "nodes = 401\nmu = 0.4",
        'unknown key "mu" in [solve], did you mean "friction" in [contact] or [plate_body]?',
    ),
    (
        "nu = 0.33",
        "nu = 0.33\ndiameter = 20e-3",
        'unknown key "diameter" in [plate]; hole_radius is half of it in [contact]',
    ),
    ("nodes = 401", "nodes = 401\nxyzzy = 1", 'unknown key "xyzzy" in [solve]; the keys are nodes, method, increments'),
    ("[solve]", "[solver]", 'unknown section [solver], did you mean "solve"?'),
    ("[contact]", "[geometry]", 'unknown section [geometry], did you mean "contact"?'),
    ("[pin]  ", "mu = 0.4\n[pin]  ", 'unknown key "mu" before the first section, did you mean "friction" in [contact]'),
    ('method = "path"', 'method = "exact"', 'method: must be "path" or "increment", not "exact", did you mean "path"?'),
]
"""A line of the example, the line that is typed instead, and the only fault that is reported."""


@pytest.mark.parametrize(("line", "typed", "sentence"), UNKNOWN_KEYS)
def test_an_unknown_key_is_answered_with_the_key_that_is_meant(line: str, typed: str, sentence: str) -> None:
    assert EXAMPLE.count(line) >= 1
    with pytest.raises(CaseFileError) as error:
        parse_case(EXAMPLE.replace(line, typed, 1))
    (fault,) = error.value.problems
    assert fault[1].startswith(sentence)


@pytest.mark.parametrize(
    ("field", "sentence"),
    [
        ("contact.mu", '"contact.mu": there is no key "mu" in [contact], did you mean "friction"?'),
        ("contact.diameter", '"contact.diameter": there is no key "diameter" in [contact]; hole_radius is half of it'),
        ("solve.mu", '"solve.mu": there is no key "mu" in [solve], did you mean "friction" in [contact] or'),
        ("solver.nodes", '"solver.nodes": there is no section [solver] in a case file, did you mean "solve"?'),
        ("load.1.F", '"load.1.F": there is no key "F" in [load], did you mean "P"?'),
    ],
)
def test_an_unknown_field_of_a_plan_is_answered_with_the_one_that_is_meant(field: str, sentence: str) -> None:
    with pytest.raises(CaseFileError) as error:
        parse_plan(f"[grid]\n{field} = [0.1, 0.2]\n")
    assert error.value.problems[0][1].startswith(sentence)


KEYWORDS: list[tuple[Callable[..., Any], dict[str, Any], str]] = [
    (fastpin.Problem, {"mu": 0.4}, ', did you mean "friction"?'),
    (fastpin.Problem, {"R": 0.01}, ', did you mean "hole_radius"?'),
    (fastpin.Problem, {"diameter": 1}, '; hole_radius is half of it'),
    (fastpin.Problem, {"E": 69e9}, ', did you mean E of Material?'),
    (fastpin.Problem, {"xyzzy": 1}, ''),
    (fastpin.Problem.from_load_parameter, {"mu": 0}, ', did you mean "friction"?'),
    (fastpin.Material, {"young": 1}, ', did you mean "E"?'),
    (fastpin.MaterialPair, {"disk": 1}, ', did you mean "pin"?'),
    (fastpin.SolveOptions, {"mesh": 9}, ', did you mean "nodes"?'),
    (fastpin.solve, {"node": 9}, ', did you mean "nodes"?'),
    (fastpin.solve, {"mu": 9}, ', did you mean friction of Problem?'),
    (fastpin.converge, {"mesh": 9}, ', did you mean "nodes"?'),
]  # fmt: skip
"""A class or function, an unknown keyword, and the end of the answer."""


@pytest.mark.parametrize(("function", "keyword", "hint"), KEYWORDS)
def test_an_unknown_keyword_is_answered_with_the_one_that_is_meant(
    function: Callable[..., Any], keyword: dict[str, Any], hint: str
) -> None:
    with pytest.raises(TypeError) as error:
        function(**keyword)
    assert str(error.value) == f"{function.__name__}() got an unexpected keyword argument {next(iter(keyword))!r}{hint}"


@pytest.mark.parametrize("made", [fastpin.Problem, fastpin.Material, fastpin.solve])
def test_explained_keywords_leave_the_signature_as_it_was(made: Callable[..., Any]) -> None:
    names = list(inspect.signature(made).parameters)
    assert "args" not in names
    assert len(names) > 3
    assert made.__doc__


def test_an_unknown_load_is_answered_with_the_one_that_is_meant() -> None:
    with pytest.raises(InputError, match=r'unknown load "Force"; the loads are .*, did you mean "P"\?'):
        fastpin.LoadHistory([{"Force": 1e6}])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "a.toml", "--mu", "0.3"], "unrecognized arguments: --mu 0.3; friction is a key of the case file"),
        (["run", "--friction=0.3"], "unrecognized arguments: --friction=0.3; friction is a key of the case file"),
        (["run", "a.toml", "--node", "101"], "unrecognized arguments: --node 101, did you mean --nodes?"),
        (["run", "a.toml", "--mesh", "101"], "unrecognized arguments: --mesh 101, did you mean --nodes?"),
        (["run", "--errorbars"], "unrecognized arguments: --errorbars, did you mean --error-bars?"),
        (["sweep", "plan.toml", "--jobs", "3"], "unrecognized arguments: --jobs 3, did you mean --workers?"),
        (["run", "--xyzzy"], "unrecognized arguments: --xyzzy"),
        (["run", "case.toml", "case.h5"], "unrecognized arguments: case.h5"),
    ],
)
def test_an_unknown_option_is_answered_with_the_one_that_is_meant(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(words)
    assert capsys.readouterr().err.endswith(f"fastpin: error: {sentence}\n")


def test_every_name_with_synonyms_is_a_name_of_fastpin() -> None:
    allowed = {*KEYS, *(key for keys in KEYS.values() for key in keys), *LUG_KEYS, "title"}
    allowed |= set(parser().format_help().split()) | {"workers", "output", "plot", "table"}
    allowed |= {"fatigue_strength", "fatigue_ductility", "strength_exponent", "ductility_exponent", "yield_strength"}
    allowed |= {"path", "increment", "spring", "fixed", "free", "centre", "body", "held"}
    names = {name for word in synonyms.words() for name in synonyms.meant(word)}
    assert names - allowed == {"thickness"} - allowed
    assert {"friction", "hole_radius", "P", "nodes"} <= names
