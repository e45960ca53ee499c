"""Case files: what is read, and that every fault is reported with its line."""

import re
from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, CaseFileError, InputError, LoadHistory, MaterialPair, SolveOptions, read_case
from fastpin.casefile import EXAMPLE, builtin_case, parse_case
from fastpin.casefile.toml_text import MOST_BYTES
from fastpin.model import LOADS
from tests.support.body_texts import HEAD
from tests.support.faults import fault_of, faults_of


def faults(text: str) -> list[tuple[int, str]]:
    return faults_of(parse_case, text)


def the_fault(text: str, folder: Path | str = ".") -> tuple[int, str]:
    return fault_of(parse_case, text, folder=folder)


def replaced(line: str, by: str) -> str:
    assert line in HEAD
    return HEAD.replace(line, by)


# -- what is read --------------------------------------------------------------------------------------------


def test_builtin_case_is_the_example() -> None:
    case = builtin_case()
    problem = case.problem
    assert problem.pair.pin == MATERIALS["Ti-6Al-4V"]
    assert (problem.pair.plate.E, problem.pair.plate.nu) == (69e9, 0.33)
    assert (problem.friction, problem.pin_load, problem.rotation) == (0.4, "body", "free")
    loads = case.history.values()
    force = loads[0, 0]
    assert problem.load_parameter(force) == pytest.approx(0.1, rel=1e-3)
    assert np.allclose(loads[:, 1], force * np.array([0.0, 0.3, -0.3, 0.3]))
    assert case.options == SolveOptions(nodes=401, method="path")


def test_every_commented_line_of_the_example_is_valid() -> None:
    """The alternatives that the example mentions can be switched on as they stand."""
    text = EXAMPLE.replace("# between", "between").replace("# arc", "arc")
    text = text.replace("# repeat = 1\n\n# Instead", "repeat = 1\n\n# Instead")
    case = parse_case(text)
    assert case.options.between == 3
    assert case.options.arc == (-3.5, 0.4)
    increments = text.replace("\n# increments", "\nincrements").replace('\nmethod = "path"', '\nmethod = "increment"')
    assert parse_case(increments).options.increments == 80
    pins = re.search(r"\[pin\].*?(?=# Instead of \[pin\])", EXAMPLE, re.DOTALL)
    assert pins
    dundurs = EXAMPLE.replace(pins[0], "")
    for line in ("[dundurs]", "alpha =", "beta =", "nu_pin =", "convention =", "beta_star ="):
        assert f"# {line}" in dundurs
        dundurs = dundurs.replace(f"# {line}", line)
    assert parse_case(dundurs).problem.pair.dundurs() == pytest.approx((0.2507, 0.0595))
    fixed = EXAMPLE.replace('"body"  ', '"centre"').replace('rotation = "free"', 'rotation = "fixed"')
    assert parse_case(fixed.replace("# hub_radius", "hub_radius")).problem.hub_radius == 5e-3
    scaled = EXAMPLE.replace("hole_radius = 10e-3", "").replace("clearance = 20e-6", "")
    assert parse_case(scaled.replace("# load_parameter", "load_parameter")).problem.dimensionless


def test_materials_by_name_moduli_and_rigid() -> None:
    assert parse_case(HEAD).problem.pair == MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    case = parse_case(replaced('material = "steel"', "rigid = true"))
    assert case.problem.pair.pin.is_rigid
    case = parse_case(replaced('material = "steel"', "E = 1e9\nnu = 0.25\nrigid = false"))
    assert case.problem.pair.pin.E == 1e9


@pytest.mark.parametrize("convention", ["usual", "paper"])
def test_dundurs(convention: str) -> None:
    sign = 1.0 if convention == "usual" else -1.0
    text = f"""
    [dundurs]
    alpha = {sign * 0.25}
    beta = {sign * 0.06}
    nu_pin = 0.32
    convention = "{convention}"
    [contact]
    plane = "stress"
    load_parameter = 0.1
    friction = 0.4
    [[load]]
    P = 1
    """
    problem = parse_case(text).problem
    assert problem.dimensionless
    assert problem.load_parameter(1.0) == pytest.approx(0.1)
    assert problem.pair.plane == "stress"
    assert problem.pair.dundurs() == pytest.approx((0.25, 0.06))


def test_load_blocks_in_order_with_lists_and_repeats() -> None:
    text = HEAD + "[[load]]\nQ = [1, -1]\nsxx = 5.5\nrepeat = 2\n[[load]]\nQ = [\n  7, # seven\n  8,\n]\n"
    values = parse_case(text).history.values()
    assert values[:, LOADS.index("Q")].tolist() == [0, 1, -1, 1, -1, 7, 8]
    assert values[:, LOADS.index("sxx")].tolist() == [0, 5.5, 5.5, 5.5, 5.5, 5.5, 5.5]
    assert values[:, LOADS.index("P")].tolist() == [1e6] * 7


def test_a_list_of_one_is_a_corner() -> None:
    assert len(parse_case(replaced("P = 1e6", "P = [1e6]")).history) == 1


def test_history_from_csv_beside_the_case_file(tmp_path: Path) -> None:
    (tmp_path / "loads.csv").write_text("P,Q\n1e6,0\n,2e5\n")
    path = tmp_path / "case.toml"
    path.write_text(HEAD.replace("[[load]]\nP = 1e6", '[history]\ncsv = "loads.csv"\nrepeat = 2'))
    assert read_case(path).history.values()[:, 1].tolist() == [0, 2e5, 0, 2e5]


def test_solver_options() -> None:
    text = HEAD + '[solve]\nnodes = 51\nmethod = "increment"\nincrements = 7\narc = [-3, 0]\nbetween = [0.25, 0.5]\n'
    options = parse_case(text + 'keep = "every 3"\nshortcut = false\n').options
    assert options.keywords() == {
        "nodes": 51,
        "method": "increment",
        "increments": 7,
        "arc": (-3.0, 0.0),
        "between": (0.25, 0.5),
        "keep": "every 3",
        "shortcut": False,
        "error_bars": False,
        "slip_sums": False,
    }


@pytest.mark.parametrize("ends", ["\r\n", "\n"])
def test_line_ends_and_byte_order_mark(tmp_path: Path, ends: str) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + HEAD.replace("\n", ends).encode())
    assert read_case(path).problem.friction == 0.3


# -- faults: one for each rule -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "by", "number", "words"),
    [
        # unknown names
        ("friction = 0.3", "friction = 0.3\nfrction = 0.3", 9, 'did you mean "friction"'),
        ("friction = 0.3", "friction = 0.3\nnodes = 9", 9, "belongs in [solve]"),
        ("friction = 0.3", "friction = 0.3\nxyz = 9", 9, "the keys are"),
        ("[[load]]", "[slove]\n[[load]]", 9, 'unknown section [slove], did you mean "solve"'),
        ("[[load]]", "[xyzzy]\n[[load]]", 9, "the sections are"),
        ("[pin]", "friction = 0.2\n[pin]", 1, "belongs in [contact]"),
        ("P = 1e6", "P = 1e6\nQx = 3", 11, 'unknown key "Qx" in [[load]]'),
        # types
        ("friction = 0.3", "friction = -inf", 8, "friction: must be a finite number"),
        ("friction = 0.3", f"friction = 1{'0' * 400}", 8, "friction: must be a finite number"),
        ("friction = 0.3", "friction = 2020-01-01", 8, "friction: must be a number"),
        ("P = 1e6", "P = true", 10, "P: must be a number"),
        ("P = 1e6", "P = [1e6, false]", 10, "value 2 of P: must be a number"),
        ("P = 1e6", "P = [1e6,\n2e6,\ninf]", 10, "value 3 of P: must be a finite number"),
        ("P = 1e6", "P = []", 10, "not an empty list"),
        ('material = "steel"', "material = 3", 2, "material: must be"),
        ('material = "steel"', 'rigid = "yes"', 2, "rigid: must be true or false"),
        ("[pin]", "title = 3\n[pin]", 1, "title: must be text"),
        # materials
        ('material = "steel"', 'material = "steal"', 2, 'did you mean "steel"'),
        ('material = "steel"', 'material = "steel"\nE = 1e9', 3, "E can't be given together with material"),
        ('material = "steel"', "rigid = true\nnu = 0.3", 3, "nu can't be given together with rigid"),
        ('material = "steel"', "E = 1e9", 1, "nu is missing"),
        ('material = "steel"', "", 1, "needs material, or E and nu, or rigid"),
        ('material = "steel"', "E = inf\nnu = 0.3", 2, "write rigid = true"),
        # contact
        ("friction = 0.3", "", 5, "friction is missing"),
        ("hole_radius = 10e-3", "load_parameter = 0.1", 7, "clearance: can't be given together"),
        ("friction = 0.3", 'friction = 0.3\nplane = "strian"', 9, 'did you mean "strain"'),
        ("friction = 0.3", 'friction = 0.3\npin_load = "body"\nrotation = "fixed"', 10, "must rotate freely"),
        ("friction = 0.3", 'friction = 0.3\nrotation = "fixed"\nhub_radius = 1', 10, "hole radius"),
        # loads
        ("[[load]]\nP = 1e6", "", 0, "no loads"),
        ("[[load]]", "[load]", 9, "double brackets"),
        ("P = 1e6", "repeat = 2", 9, "gives no load"),
        ("P = 1e6", "P = 1e6\nrepeat = 0", 11, "repeat: must be a whole number of at least 1"),
        ("P = 1e6", "P = 1e6\nrepeat = 1.5", 11, "repeat: must be a whole number"),
        ("P = 1e6", "P = 1e6\nrepeat = 1000000000", 11, "more than"),
        ("P = 1e6", "P = [1, 2]\nQ = [1, 2, 3]", 11, "equally long"),
        ("P = 1e6", "P = 1e6\n[history]\ncsv = 'x.csv'", 12, "either csv or [[load]]"),
        ("P = 1e6", "amplitude = {Q = 1e5}\nP = 1", 11, "P: can't be given together with amplitude"),
        ("P = 1e6", "P = 1\nphase = {Q = 90}", 11, "phase: needs an amplitude"),
        ("P = 1e6", "amplitude = 3", 10, "amplitude: must be a table of loads"),
        ("P = 1e6", "amplitude = {Q = 'x'}", 10, "amplitude.Q: must be a number"),
        ("P = 1e6", "amplitude = {q = 1}", 10, 'did you mean "Q"'),
        ("P = 1e6", "amplitude = {Q = 1}\nphase = {P = 1}", 11, "P has a phase but no amplitude"),
        ("P = 1e6", "amplitude = {Q = 1}\npoints = 1", 11, "points: must be a whole number from 2 to 100000"),
        ("P = 1e6", "amplitude = {Q = 1}\nrepeat = 100000000", 11, "more than"),
        ("P = 1e6", "P = 1e6\n[history]\nrepeat = 0", 12, "repeat: must be a whole number"),
        ("[[load]]\nP = 1e6", "[history]\ncsv = 'no such file.csv'", 10, "there is no such file"),
        ("[[load]]\nP = 1e6", "[history]\nrepeat = 2", 9, "csv is missing"),
        ("P = 1e6", "P = 1e6\n[[load]]\nrotation = 0.1", 12, "rotation"),
        # solver
        ("P = 1e6", "P = 1e6\n[solve]\nnodes = 4", 12, "nodes: must be a whole number from 5"),
        ("P = 1e6", 'P = 1e6\n[solve]\nmethod = "paht"', 12, 'did you mean "path"'),
        ("P = 1e6", "P = 1e6\n[solve]\narc = [-90, 90]", 12, "in rad"),
        # TOML itself
        ("friction = 0.3", "friction = .3", 8, "digit before its point, 0.3"),
        ("friction = 0.3", "friction = 0.3\nplane = stress", 9, 'text must stand in quotes, "stress"'),
        ("friction = 0.3", "friction = ", 8, "friction: its value is missing"),
        ("friction = 0.3", "friction = 30 %", 8, "friction: must be a number without a unit, not 30 %; SI units"),
        ("hole_radius = 10e-3", "hole_radius = 10 mm", 6, "hole_radius: must be a number without a unit, not 10 mm"),
        ("friction = 0.3", "friction = 0,3", 8, "friction: a number has a decimal point, 0.3"),
        ("friction = 0.3", "friction = 0.3 or so", 8, "friction: must be one value, not 0.3 or so"),
        ("[[load]]", "[load]\nP = 1\n[[load]]", 11, '"load" is given twice; several loads are [[load]] blocks'),
        ("friction = 0.3", "friction = 0.3\nfriction = 0.4", 9, '"friction" is given twice'),
        ("friction = 0.3", "friction = 0.3\nplane", 9, 'not of the form "key = value"'),
        ("friction = 0.3", "friction = 0.3\n[pin]", 9, "[pin] appears twice"),
        ("P = 1e6", "P = [1, 2\n\nQ = 3", 10, "not closed"),
    ],
)  # fmt: skip
def test_fault(line: str, by: str, number: int, words: str, tmp_path: Path) -> None:
    found, message = the_fault(replaced(line, by), tmp_path)
    assert words in message
    assert found == number


def test_moment_on_a_body_loaded_pin_names_the_line_that_gives_it() -> None:
    text = replaced("friction = 0.3", 'friction = 0.3\npin_load = "body"') + "M = 0\n[[load]]\nM = [0, 3.0]\n"
    number, message = the_fault(text)
    assert number == 14
    assert message.startswith("M: ")


@pytest.mark.parametrize("name", [name for name in LOADS if name not in ("ux", "uy", "rotation")])
def test_each_load_is_a_load_alone(name: str) -> None:
    text = HEAD.replace("P = 1e6", f"P = 1e6\n[[load]]\n{name} = 0.1")
    if "temperature" in name:
        text = text.replace('um"\n', 'um"\nexpansion = 1e-5\n').replace('steel"\n', 'steel"\nexpansion = 1e-5\n')
    case = parse_case(text)
    assert case.history.values()[1, LOADS.index(name)] == 0.1


def test_two_loads_that_can_not_act() -> None:
    text = replaced("friction = 0.3", 'friction = 0.3\npin_load = "body"') + "M = 1\nrotation = 0.1\n"
    assert [(line, message.split(":")[0]) for line, message in faults(text)] == [(12, "M"), (13, "rotation")]


def test_interference_fit_needs_the_whole_circle() -> None:
    text = replaced("clearance = 20e-6", "clearance = -1e-5") + "[solve]\narc = [-3, 0]\n"
    number, message = the_fault(text)
    assert number == 12
    assert "interference" in message


def test_dundurs_faults_are_mapped_to_their_lines() -> None:
    head = "[dundurs]\nalpha = {}\nbeta = {}\nnu_pin = {}\n"
    tail = "[contact]\nload_parameter = 0.1\nfriction = 0.3\n[[load]]\nP = 1\n"
    assert the_fault(head.format(1.5, 0, 0.3) + tail)[0] == 2
    assert the_fault(head.format(0.25, 0.5, 0.3) + tail)[0] == 3
    assert [line for line, _ in faults(head.format(2, 0, 0.7) + tail)] == [2, 4]
    number, message = the_fault(head.format(0.25, 0.06, 0.3) + "beta_star = 1e-10\n" + tail)
    assert (number, "no meaning" in message) == (5, True)
    sized = tail.replace("load_parameter = 0.1", "hole_radius = 1\nclearance = 0.1")
    number, message = the_fault(head.format(0.25, 0.06, 0.3) + sized)
    assert (number, "beta_star is missing" in message) == (1, True)
    assert any("either [dundurs]" in message for _, message in faults("[pin]\nrigid = true\n" + head + tail))


# -- faults: all at once -----------------------------------------------------------------------------------


def test_all_faults_at_once_in_the_order_of_their_lines() -> None:
    text = """\
friction = 3
[pin]
material = "Ti6Al4V"
[plate]
E = -69e9
nu = 0.7
[contact]
hole_radius = -1
clearance = nan
friction = true
pin_load = "body"
rotation = fixed
clearence = 2
[[load]]
P = "2"
[[load]]
Q = [1, 2,
   inf]
[solve]
nodes = 3
"""
    found = faults(text)
    assert [line for line, _ in found] == [1, 3, 5, 6, 8, 9, 10, 12, 13, 15, 17, 20]


def test_message_names_file_and_line() -> None:
    with pytest.raises(InputError, match=r"case\.toml, line 8: friction: must not be negative, not -1") as caught:
        parse_case(replaced("friction = 0.3", "friction = -1"), "case.toml")
    assert "\n" not in str(caught.value)


def test_empty_file_says_what_is_missing() -> None:
    found = [(line, re.search(r"\[+\w+\]+", message)[0]) for line, message in faults("")]  # type: ignore[index]
    assert found == [(0, name) for name in ("[pin]", "[plate]", "[contact]", "[[load]]")]


@pytest.mark.parametrize(
    "text",
    ["contact = 3\npin = [1]\nload = 5\nsolve = 'x'", "a = " + "[" * 5000, "a = " + "9" * 5000, "[[pin]]\n[[load]]\n"],
    ids=["no tables", "nested", "digits", "arrays"],
)
def test_strange_files_give_a_case_file_error(text: str) -> None:
    assert faults(text)


def test_inline_tables_and_dotted_keys() -> None:
    text = "pin = {rigid = true}\nplate.E = 1e9\nplate.nu = 0.7\n"
    text += "contact = {load_parameter = 0.1, friction = 0.3}\n"
    number, message = the_fault(text + "load = [{P = 1}]\n")
    assert (number, message.split(":")[0]) == (3, "nu")


def test_a_file_cut_anywhere_is_read_or_refused_in_words() -> None:
    for cut in range(0, len(EXAMPLE), 97):
        problems: list[tuple[int, str]] = []
        try:
            parse_case(EXAMPLE[:cut])
        except CaseFileError as error:
            problems = error.problems or [(-1, "")]
        assert all(0 <= line <= EXAMPLE.count("\n", 0, cut) + 1 and message for line, message in problems)


def test_files_that_can_not_be_read(tmp_path: Path) -> None:
    with pytest.raises(CaseFileError, match="there is no such file"):
        read_case(tmp_path / "none.toml")
    with pytest.raises(CaseFileError, match="is a directory, a file is needed"):
        read_case(tmp_path)
    (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\x1a\n and more")
    with pytest.raises(CaseFileError, match=r"is a stored result \(HDF5\), not text; fastpin show prints it"):
        read_case(tmp_path / "a.h5")
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b"[pin]\ntitle = 'M\xfcller'\n")
    with pytest.raises(CaseFileError, match="line 2: is not UTF-8"):
        read_case(latin)


def test_a_file_of_one_endless_line_is_refused(tmp_path):
    path = tmp_path / "endless"
    path.write_text("#" * (MOST_BYTES + 1))
    with pytest.raises(CaseFileError, match=f"is larger than {MOST_BYTES:,} bytes"):
        read_case(path)
    with pytest.raises(CaseFileError, match=r"is longer than 1,000,000 characters"):
        LoadHistory.from_csv(path)
