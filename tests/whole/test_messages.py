"""Bad and suspicious input, and the sentence that answers it: in Python, in a case file and on the command line."""

import dataclasses
import inspect
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.casefile.lug import LUG_EXAMPLE, LUG_KEYS, parse_lug
from fastpin.casefile.profiles import WORD_KEYS
from fastpin.casefile.reader import EXAMPLE, KEYS, parse_case
from fastpin.cli.main import main
from fastpin.cli.options import parser
from fastpin.errors import InputError, InputWarning
from fastpin.model import synonyms
from fastpin.model.doubts import doubts, pressure_doubts
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.loads import LOAD_KIND
from fastpin.model.ply import PlyStrengths
from fastpin.studies.plan import parse_plan, read_plan
from tests.support.faults import fault_of, faults_of
from tests.support.processes import without_progress
from tests.support.refusals import refused
from tests.support.tiers import gate

PAIR = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])

UNKNOWN_KEYS: list[tuple[str, str, str]] = [
    ("friction = 0.4", "mu = 0.4", '[contact], did you mean "friction"?'),
    ("friction = 0.4", "cof = 0.4", '[contact], did you mean "friction"?'),
    ("hole_radius = 10e-3", "R = 10e-3", '[contact], did you mean "hole_radius"?'),
    ("hole_radius = 10e-3", "radius = 10e-3", '[contact], did you mean "hole_radius"?'),
    ("hole_radius = 10e-3", "diameter = 20e-3", "[contact]; hole_radius is half of it"),
    ("clearance = 20e-6", "delta = 20e-6", '[contact], did you mean "clearance"?'),
    ("clearance = 20e-6", "gap = 20e-6", '[contact], did you mean "clearance"?'),
    ("clearance = 20e-6", "pin_radius = 9.98e-3", "[contact]; clearance is the hole radius minus the pin radius"),
    ("clearance = 20e-6", "interference = 20e-6", "[contact]; a negative clearance is an interference fit"),
    ("E  = 69e9", "youngs_modulus = 69e9", '[plate], did you mean "E"?'),
    ("E  = 69e9", "G = 26e9", "[plate]; with the shear modulus G, E is 2 G (1 + nu)"),
    ("nu = 0.33", "poisson = 0.33", '[plate], did you mean "nu"?'),
    ("P = 2.42e6", "p = 2.42e6", '[[load]], did you mean "P"?'),
    ("P = 2.42e6", "load = 2.42e6", '[[load]], did you mean "P"?'),
    ("P = 2.42e6", "Fy = -2.42e6", "[[load]]; P is the force downwards: the opposite of a force along +y"),
    ("P = 2.42e6", "P = 2.42e6\ntau = 1e6", '[[load]], did you mean "sxy"?'),
    ("friction = 0.4", "friction = 0.4\nE = 69e9", "[contact]; it belongs in [pin] or [plate] or [plate_body]"),
    ("friction = 0.4", "friction = 0.4\nload = 2.42e6", "[contact]; loads are [[load]] blocks, with double brackets"),
    ("nodes = 401", "mesh = 401", '[solve], did you mean "nodes"?'),
    ("nodes = 401", "nodes = 401\nmu = 0.4", '[solve], did you mean "friction" in [contact] or [plate_body]?'),
    ("nu = 0.33", "nu = 0.33\ndiameter = 20e-3", "[plate]; hole_radius is half of it in [contact]"),
    ("nodes = 401", "nodes = 401\nxyzzy = 1", "[solve]; the keys are nodes, method, increments"),
]
"""A line of the example, the line that is typed instead, and the answer after the key that is unknown."""

UNKNOWN_PARTS: list[tuple[str, str, str]] = [
    ("[solve]", "[solver]", 'unknown section [solver], did you mean "solve"?'),
    ("[contact]", "[geometry]", 'unknown section [geometry], did you mean "contact"?'),
    ("[solve]", "[[repeat]]\nn = 3\n[solve]", "unknown section [[repeat]]; repeat is a key in [[load]] or [history]"),
    (
        "[solve]",
        "[xyzzy]\n[solve]",
        "unknown section [xyzzy]; the sections are [about], [pin], [plate], [dundurs], [contact],",
    ),
    ("[solve]", "[pin.title]\n[solve]", 'unknown key "title" in [pin]; the keys are material, E, nu, rigid,'),
    ("[pin]  ", "mu = 0.4\n[pin]  ", 'unknown key "mu" before the first section, did you mean "friction" in [contact]'),
    ('method = "path"', 'method = "exact"', 'method: must be "path" or "increment", not "exact", did you mean "path"?'),
]
"""The same for other parts, with the whole answer."""


def unknown_key(line: str, typed: str, answer: str) -> tuple[str, str, str]:
    key = typed.splitlines()[-1].split(" = ")[0]
    return line, typed, f'unknown key "{key}" in {answer}'


@pytest.mark.parametrize(
    ("line", "typed", "sentence"), [*(unknown_key(*each) for each in UNKNOWN_KEYS), *UNKNOWN_PARTS]
)
def test_an_unknown_key_is_answered_with_the_key_that_is_meant(line: str, typed: str, sentence: str) -> None:
    assert EXAMPLE.count(line) >= 1
    assert fault_of(parse_case, EXAMPLE.replace(line, typed, 1))[1].startswith(sentence)


UNKNOWN_IN_PLANS = [
    ("[grid]\ncontact.mu = [0.1]", '"contact.mu": there is no key "mu" in [contact], did you mean "friction"?'),
    (
        "[grid]\ncontact.diameter = [0.1]",
        '"contact.diameter": there is no key "diameter" in [contact]; hole_radius is half of it',
    ),
    (
        "[grid]\nsolve.mu = [0.1]",
        '"solve.mu": there is no key "mu" in [solve], did you mean "friction" in [contact] or',
    ),
    (
        "[grid]\nsolver.nodes = [0.1]",
        '"solver.nodes": there is no section [solver] in a case file, did you mean "solve"?',
    ),
    ("[grid]\nload.1.F = [0.1]", '"load.1.F": there is no key "F" in [load], did you mean "P"?'),
    (
        "[contact]\nfriction = [0.1]\n[grid]\ncontact.friction = [0.1]",
        "unknown section [contact]; it belongs in the case file, which a plan names",
    ),
    ("[xyzzy]", "unknown section [xyzzy]; a plan has title, units, case, [grid], [[list]], [outcomes] and [labels]"),
    ("friction = [0.1]", 'unknown key "friction"; a plan varies it in [grid]: contact.friction = ...'),
    ("Q = [1e5]", 'unknown key "Q"; a plan varies it in [grid]: load.1.Q = ...'),
    ("[[grid]]\ncontact.friction = [0.1]", "grid: must be a section [grid], not [[grid]]"),
]
"""The text of a plan, and the beginning of the first answer."""


@pytest.mark.parametrize(("text", "sentence"), UNKNOWN_IN_PLANS)
def test_an_unknown_part_of_a_plan_is_answered_with_what_is_meant_or_allowed(text: str, sentence: str) -> None:
    assert faults_of(parse_plan, text)[0][1].startswith(sentence)


@pytest.mark.parametrize(
    ("text", "read", "kind", "sentence"),
    [
        (EXAMPLE, parse_plan, "plan", "is a case file, not a plan; see fastpin run"),
        (EXAMPLE, parse_lug, "lug file", "is a case file, not a lug file; see fastpin run"),
        (LUG_EXAMPLE, parse_case, "case file", "is a lug file, not a case file; see fastpin compliance"),
        ("[grid]\na.b = [1]\n", parse_case, "case file", "is a plan, not a case file; see fastpin sweep"),
    ],
)
def test_a_file_of_another_kind_is_told_in_one_sentence(text, read, kind, sentence):
    assert str(refused(read, text)) == f"{kind}: {sentence}"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["repot", "a.h5"], 'must be example, check, .*, not "repot", did you mean "report"\\?'),
        (["plot", "a.h5", "tracton"], 'kind: must be tractions, .*, not "tracton", did you mean "tractions"\\?'),
        (["completion", "powershell"], 'shell: must be bash, zsh, fish or tcsh, not "powershell"'),
    ],
)
def test_a_word_of_the_command_line_that_is_not_allowed_is_answered_with_the_one_that_is_meant(words, sentence, capsys):
    with pytest.raises(SystemExit):
        main(words)
    assert re.search(f"error: .*{sentence}\n$", capsys.readouterr().err)


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
def test_an_unknown_keyword_is_answered_with_the_one_that_is_meant(function, keyword, hint):
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
def test_an_unknown_option_is_answered_with_the_one_that_is_meant(words, sentence, capsys):
    with pytest.raises(SystemExit):
        main(words)
    assert capsys.readouterr().err.endswith(f"fastpin: error: {sentence}\n")


def test_every_name_with_synonyms_is_a_name_of_fastpin() -> None:
    allowed = {*KEYS, *(key for keys in KEYS.values() for key in keys), *LUG_KEYS, "title"}
    allowed |= set(parser().format_help().split()) | {"workers", "output", "plot", "table"}
    allowed |= {"fatigue_strength", "fatigue_ductility", "strength_exponent", "ductility_exponent", "yield_strength"}
    allowed |= {"path", "increment", "spring", "fixed", "free", "centre", "body", "held", "bush"}
    allowed |= {*LIFE_CONSTANTS, *dir(fastpin.State), *(each.name for each in dataclasses.fields(fastpin.State))}
    allowed |= {*fastpin.MATERIALS, "materials", *WORD_KEYS, *(each.name for each in dataclasses.fields(PlyStrengths))}
    names = {name for word in [*synonyms._NOTES, *synonyms._MEANT] for name in synonyms.meant(word)}
    assert names - allowed == {"thickness"} - allowed
    assert {"friction", "hole_radius", "P", "nodes"} <= names


# -- doubtful values -----------------------------------------------------------------------------------------

ONLY_P = "P = 2.42e6\n\n[[load]]\nQ = [7.26e5, -7.26e5, 7.26e5]"
SMALL_E = "softer than rubber; moduli are in Pa"
ALUMINIUM = "did you mean 69000 MPa, which is 69e9?"

DOUBTFUL: list[tuple[str, str]] = [
    ("E = 69", f"E: 69 Pa of the plate is {SMALL_E}; did you mean 69 GPa, which is 69e9?"),
    ("E = 69e3", f"E: 69000 Pa of the plate is {SMALL_E}; {ALUMINIUM}"),
    (
        "E = 69e15",
        "E: 69e15 Pa of the plate is stiffer than diamond; moduli are in Pa: 69 GPa is 69e9; a body that does not "
        "deform is rigid",
    ),
    ("nu = 0.033", "nu: 0.033 of the plate is very small; metals have 0.25 to 0.45"),
    ("nu = 0.48", "nu: 0.48 of the plate is unusual for a stiff body; metals have 0.25 to 0.45"),
    (
        "nu = 0.33\nyield_strength = 345",
        "yield_strength: 345 Pa of the plate is very small; stresses are in Pa; did you mean 345 MPa, which is 345e6?",
    ),
    (
        "nu = 0.33\nyield_strength = 345e6\nultimate_strength = 310e6",
        "ultimate_strength: 310e6 Pa of the plate is less than its yield strength of 345e6 Pa",
    ),
    (
        "nu = 0.33\nfatigue = { fatigue_strength = 1100, strength_exponent = -0.124 }",
        "fatigue_strength: 1100 Pa of the plate is very small; stresses are in Pa; did you mean 1100 MPa, which "
        "is 1.1e9?",
    ),
    (
        "hole_radius = 10",
        "hole_radius: 10 m is larger than any pin; lengths are in m; did you mean 10 mm, which is 10e-3?",
    ),
    (
        "clearance = 9.98e-3",
        "clearance: 9.98e-3 is more than half of the hole radius 10e-3; clearance is the hole radius minus the "
        "pin radius",
    ),
    ("clearance = -2e-3", "clearance: the interference is 20 % of the hole radius; metals yield at 0.5 %"),
    ("friction = 40", "friction: 40 is above 2, more than dry metals have; did you mean 40 %, which is 0.4?"),
    (
        "friction = 2.72647",
        "friction: 2.72647 is above 2, more than dry metals have; did you mean 2.7 %, which is 0.027?",
    ),
    (
        "P = 2.42e9",
        "P: 2.42e9 N/m strains the bodies by 10, far beyond linear elasticity; forces are per thickness, in N/m",
    ),
    (
        "P = 2.42e6\nsxx = 80.1234",
        "sxx: 80.1234 Pa is very small; stresses are in Pa; did you mean 80.1 MPa, which is 80.1e6?",
    ),
    (
        "P = 2.42e6\nsyy = -80e9",
        "syy: -80e9 Pa strains the bodies by 6.6, far beyond linear elasticity; stresses are in Pa",
    ),
    ('pin_load = "centre"\ndrive = "uy"', "uy: -0.5 m is 50 hole radii; lengths are in m: 1 mm is 1e-3"),
    ('rotation = "fixed"', "rotation: 5 rad is 286 degrees; rotations are in rad, and small"),
    ("nodes = 401\narc = [-90, -87]", "arc: -90 rad is more than two turns; angles are in rad"),
]
"""A line that is typed in place of that of the example with its key, and the only doubt."""

FEW_NEWTONS = (
    "P: 12100 N/m is a bearing stress of 0.605 MPa only; forces are per thickness, in N/m: 1 N/mm is 1e3; "
    "divide a force in N by the thickness in m, or give the thickness"
)


def doubtful_text(line: str, typed: str) -> str:
    """The example with a doubtful line. Some lines need another load, or another load of the pin."""
    text = EXAMPLE.replace(line, typed, 1)
    if "drive" in typed:
        return text.replace("P = 2.42e6", "uy = -0.5", 1)
    if "fixed" in typed:
        return text.replace('"body"', '"centre"', 1).replace("P = 2.42e6", "P = 2.42e6\nrotation = 5", 1)
    return text


def line_of(typed: str) -> str:
    """The line of the example that has the key of a typed one."""
    key = typed.partition(" = ")[0]
    return re.search(rf"^{key} *= \S+", EXAMPLE, re.MULTILINE)[0]


@pytest.mark.parametrize(
    ("line", "typed", "sentence"),
    [*((line_of(typed), typed, sentence) for typed, sentence in DOUBTFUL), (ONLY_P, "P = 12.1e3", FEW_NEWTONS)],
)
def test_a_doubtful_value_gets_one_sentence_in_python_and_on_the_command_line(line, typed, sentence, tmp_path, capsys):
    assert line in EXAMPLE
    path = tmp_path / "case.toml"
    path.write_text(doubtful_text(line, typed))
    case = fastpin.read_case(path)
    assert [str(doubt) for doubt in doubts(case.problem, case.history, case.options)] == [sentence]
    assert main(["check", str(path)]) == 0
    assert capsys.readouterr().err == f"fastpin: warning: {sentence}\n"


def joint(pin: float, plate: float, **fields: Any) -> fastpin.Problem:
    """A pin and a plate with these moduli."""
    pair = fastpin.MaterialPair(fastpin.Material(pin, 0.3), fastpin.Material(plate, 0.3))
    return fastpin.Problem(pair, **{"hole_radius": 0.01, "clearance": 1e-5, "friction": 0.3} | fields)


PRESSED_IN = fastpin.bodies.Bushing(fastpin.Material(110e9, 0.34), 12e-3, 1e-3)


@pytest.mark.parametrize(
    ("problem", "force", "sentence"),
    [
        (
            joint(1e5, 210e9),
            1.0,
            "E: 100000 Pa of the pin and 210e9 Pa of the plate differ by more than a factor 1,000,000; moduli are "
            "in Pa: 69 GPa is 69e9",
        ),
        (joint(1e14, 1e14), 1e3, "E: 100e12 Pa of the pin is stiffer than diamond; moduli are in Pa: 69 GPa is 69e9"),
        (
            joint(210e9, 210e9, clearance=1.1e-3, plate_body=PRESSED_IN),
            1e6,
            "interference: 1e-3 m is 8.33 % of the outer radius of the bush; metals yield at 0.5 %",
        ),
    ],
    ids=["unlike", "stiff", "pressed in"],
)
def test_a_doubtful_body_gets_one_sentence(problem: fastpin.Problem, force: float, sentence: str) -> None:
    assert [str(doubt) for doubt in doubts(problem, fastpin.LoadHistory([{"P": force}]))] == [sentence]


HARD = EXAMPLE.replace("friction = 0.4", "friction = 40").replace("nodes = 401", "nodes = 51")
FRICTION = "friction: 40 is above 2, more than dry metals have; did you mean 40 %, which is 0.4?"


@pytest.mark.parametrize(
    "work",
    [
        lambda case, folder: fastpin.solve(case.problem, case.history, nodes=51),
        lambda case, folder: fastpin.record(case.problem, case.history, folder / "a.h5", nodes=51),
        *gate(lambda case, folder: fastpin.converge(case.problem, case.history, [51, 61, 71])),
        lambda case, folder: fastpin.Session(case.problem, nodes=51),
    ],
    ids=["solve", "record", "converge", "Session"],
)
def test_python_warns_on_the_line_of_the_user(work: Callable[..., Any], tmp_path: Path) -> None:
    with pytest.warns(InputWarning) as given:
        work(parse_case(HARD), tmp_path)
    (warning,) = given
    assert str(warning.message) == FRICTION
    assert warning.filename == __file__


@pytest.mark.gate
def test_a_run_prints_each_warning_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.toml"
    path.write_text(HARD)
    for more in ([], ["-o", str(tmp_path / "a.h5")], ["--error-bars", "--nodes", "101"]):
        assert main(["run", str(path), *more]) == 0
        assert capsys.readouterr().err == f"fastpin: warning: {FRICTION}\n"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert main(["show", str(tmp_path / "a.h5")]) == 0


def test_a_plan_names_the_runs_in_doubt(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("[grid]\ncontact.friction = [0.1, 30, 40]\ncontact.clearance = [0, 1e-5]\n")
    with pytest.warns(InputWarning) as given:
        plan = read_plan(path)
    (warning,) = given
    assert str(warning.message) == (
        "friction: 30 is above 2, more than dry metals have; did you mean 30 %, which is 0.3? "
        "(in 4 runs, first contact.friction = 30, contact.clearance = 0)"
    )
    assert warning.filename == __file__
    assert len(plan.points) == 6


def test_a_plan_doubts_the_coefficients_of_its_outcomes_of_wear(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    outcomes = "".join(
        f'{name} = {{ wear = "{name}", cycles = 10, coefficient = {size} }}\n'
        for name, size in {"depth": 1e-9, "volume": 1e-9, "pressure": 1e-15}.items()
    )
    path.write_text(f"[grid]\ncontact.friction = [0.1, 0.2]\n[outcomes]\n{outcomes}")
    with pytest.warns(InputWarning) as given:
        read_plan(path)
    (warning,) = given
    assert str(warning.message).startswith("coefficient: 1e-09 1/Pa is more than any surface wears")


@pytest.mark.gate
@pytest.mark.parametrize("other", [False, True], ids=["named", "given"])
def test_a_pressure_above_the_yield_strength_is_doubted(other, tmp_path, capsys, undrawn):
    strength = "fatigue = { yield_strength = 100e6 }" if other else "yield_strength = 100e6"
    text = EXAMPLE.replace("nu = 0.33", f"nu = 0.33\n{strength}").replace("nodes = 401", "nodes = 51")
    case = parse_case(text)
    with pytest.warns(InputWarning) as given:
        result = fastpin.solve(case.problem, case.history, nodes=51)
    peak = max(state.pressure.max() for state in result)
    sentence = (
        f"peak pressure: {peak / 1e6:.4g} MPa is above the yield strength 100 MPa of the plate; fastpin is elastic, "
        "but a real contact yields there"
    )
    said = [str(warning.message) for warning in given]
    assert said[0] == sentence
    (mises,) = said[1:]
    assert re.fullmatch(
        r"von Mises stress: [\d.]+ MPa at the hole of the plate, at -?[\d.]+ deg, load point \d, is above the yield "
        "strength 100 MPa of the plate; fastpin is elastic, but a real plate yields there",
        mises,
    )
    path, stored = tmp_path / "case.toml", tmp_path / "a.h5"
    with pytest.warns(InputWarning) as given:
        fastpin.record(case.problem, case.history, stored, nodes=51)
    assert [(str(warning.message), warning.filename) for warning in given] == [(each, __file__) for each in said]
    path.write_text(text)
    for command in (["run", str(path)], ["show", str(stored)], ["report", str(stored), "-o", str(tmp_path / "a.html")]):
        assert main(command) == 0
        printed = "".join(f"fastpin: warning: {each}\n" for each in said)
        assert without_progress(capsys.readouterr().err) == ("" if command[0] == "report" else printed)
    page = (tmp_path / "a.html").read_text()
    assert sentence in page
    assert mises in page
    higher = dataclasses.replace(case.problem.pair.plate, yield_strength=2.0 * peak)
    problem = dataclasses.replace(case.problem, pair=fastpin.MaterialPair(case.problem.pair.pin, higher))
    assert pressure_doubts(problem, case.history, [result[0].pressure]) == []


def test_a_large_contact_strain_is_doubted_unless_the_loads_are() -> None:
    case = parse_case(EXAMPLE.replace('"Ti-6Al-4V"', '"steel"'))
    beta = case.problem.pair.beta_star
    for strain, expected in ((0.04, 0), (0.06, 1)):
        found = pressure_doubts(case.problem, case.history, [np.array([0.0, strain / beta])])
        assert len(found) == expected
    assert "contact strains of about 0.06 are beyond linear elasticity" in str(found[0])
    heavy = fastpin.LoadHistory([{"P": 1e9}])
    assert pressure_doubts(case.problem, heavy, [np.array([1.0 / beta])]) == []


# -- input that raises no doubt ------------------------------------------------------------------------------

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTED = [EXAMPLE, *((ROOT / "docs" / name).read_text() for name in ("cycles.toml", "riveted-joint.toml"))]


@pytest.mark.parametrize("text", DOCUMENTED)
@pytest.mark.parametrize("units", [(1.0, 1.0), (1e3, 1e-6), (1e3, 1e-3), (39.37, 1.45e-7), (100.0, 10.0)])
def test_consistent_units_of_any_kind_raise_no_doubt(text: str, units: tuple[float, float]) -> None:
    """In m and Pa; mm and MPa; mm and kPa; inch and ksi; cm and dyn/cm^2."""
    length, stress = units
    case = parse_case(text)
    problem, pair = case.problem, case.problem.pair
    pin, plate = (fastpin.Material(stress * body.E, body.nu) for body in (pair.pin, pair.plate))
    size = {"hole_radius": length * problem.hole_radius, "clearance": length * problem.clearance}
    changed = dataclasses.replace(problem, pair=fastpin.MaterialPair(pin, plate, pair.plane), **size)
    factor = {"force": stress * length, "moment": stress * length**2, "traction": stress, "displacement": length}
    factors = [factor.get(kind, 1.0) for kind in LOAD_KIND.values()]
    history = fastpin.LoadHistory.from_array(case.history.distinct() * factors)
    assert doubts(changed, history, case.options) == []


STEEL = fastpin.MATERIALS["steel"]
UNIT = fastpin.Material(1.0, 0.3)
FIRM = fastpin.Material(2e9, 0.5)
SOLID: dict[str, tuple[fastpin.Problem, dict[str, float]]] = {
    "unit radius and modulus": (fastpin.Problem(fastpin.MaterialPair(UNIT, UNIT), 1.0, 0.1, 0.3), {"P": 1.0}),
    "unit radius": (fastpin.Problem(PAIR, 1.0, 1e-3, 0.3), {"P": 1.0}),
    "unit modulus": (fastpin.Problem(fastpin.MaterialPair(UNIT, UNIT), 0.01, 1e-5, 0.3), {"P": 5.0}),
    "unit load": (fastpin.Problem(PAIR, 0.01, 1e-5, 0.3), {"P": 1.0}),
    "dimensionless": (fastpin.Problem.from_load_parameter(PAIR, 3.0, 0.3), {"P": 1.0, "sxx": 5.0}),
    "rigid pin": (fastpin.Problem(fastpin.MaterialPair(fastpin.Material.rigid(), STEEL), 0.01, 1e-5, 0.3), {"P": 1e6}),
    "rubber": (fastpin.Problem(fastpin.MaterialPair(STEEL, fastpin.Material(5e6, 0.499)), 0.01, 0.0, 0.8), {"P": 1e3}),
    "incompressible": (fastpin.Problem(fastpin.MaterialPair(STEEL, FIRM), 0.01, 0.0, 1.0), {"P": 1e5}),
    "all sticks": (fastpin.Problem(PAIR, 0.01, 1e-5, 1e6), {"P": 1e6}),
    "interference alone": (fastpin.Problem(PAIR, 0.01, -1e-5, 0.3), {"P": 10.0}),
    "no load": (fastpin.Problem(PAIR, 0.01, 1e-5, 0.3), {"P": 0.0}),
    "small force beside a stress": (fastpin.Problem(PAIR, 0.01, 1e-5, 0.3), {"P": 5.0, "sxx": 5e7}),
}


@pytest.mark.parametrize("name", SOLID)
def test_a_legitimate_problem_raises_no_doubt(name: str) -> None:
    problem, loads = SOLID[name]
    assert doubts(problem, fastpin.LoadHistory([loads])) == []


def test_examples_of_the_documents_raise_no_doubt() -> None:
    """The numbers of all problems in Python that the documents build in units."""
    pattern = r"hole_radius=([\d.e-]+), clearance=([\d.e-]+), friction=([\d.]+)"
    texts = [path.read_text() for path in (ROOT / "README.md", *(ROOT / "docs").glob("*.md"))]
    found = {numbers for text in texts for numbers in re.findall(pattern, text)}
    assert len(found) >= 4
    for numbers in found:
        radius, clearance, friction = map(float, numbers)
        assert doubts(fastpin.Problem(PAIR, radius, clearance, friction)) == []
