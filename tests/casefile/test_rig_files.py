"""Case files that read the loads from columns of a CSV file."""

from pathlib import Path

import pytest

from fastpin import CaseFileError, read_case
from tests.support.case_texts import PRESSED

RIG = "Time [s];Force [kN];Shear [N]\n0,0;12,5;0\n0,1;12,5;-300\n;;\n"


RIG_LOAD = '[[load]]\ncsv = "rig.csv"\n'
THICK = "thickness = 5e-3"


def values(folder: Path, block: str, contact: str = THICK, rig: str = RIG) -> list[list[float]]:
    (folder / "rig.csv").write_text(rig, encoding="utf-8-sig")
    path = folder / "case.toml"
    text = PRESSED.replace("[contact]", f"[contact]\n{contact}").replace("[[load]]\nP = 1e6", block)
    assert block in text
    path.write_text(text)
    return read_case(path).history.values()[:, :2].tolist()


def test_columns_with_scale_and_unit(tmp_path: Path) -> None:
    block = f'{RIG_LOAD}P = {{ column = "Force [kN]", scale = 2.0 }}\nQ.column = "Shear"\nQ.scale = -1.0'
    assert values(tmp_path, block + "\nrepeat = 2") == [[5e6, 0.0], [5e6, 6e4]] * 2


def test_a_column_may_be_given_alone(tmp_path: Path) -> None:
    assert values(tmp_path, f'{RIG_LOAD}P = "Force"') == [[2.5e6, 0.0], [2.5e6, 0.0]]


def test_headers_with_units_need_no_columns(tmp_path: Path) -> None:
    rig = "P [kN/m],Q [N/mm]\n1,2\n"
    assert values(tmp_path, '[history]\ncsv = "rig.csv"', "", rig) == [[1e3, 2e3]]


@pytest.mark.parametrize(
    ("block", "contact", "words"),
    [
        (
            f'{RIG_LOAD}P = "Forze"',
            THICK,
            'line {csv}: csv: rig.csv, line 1: P: the file has no column "Forze"; its columns are "Time [s]", '
            '"Force [kN]", "Shear [N]", did you mean "Force"?',
        ),
        (
            f'{RIG_LOAD}P = "Force"',
            "",
            'csv: rig.csv, line 1: P: a force must be in N/m, kN/m, MN/m, N/mm, kN/mm or lbf/in, not "kN"; give the '
            'thickness for loads in N and N m (column "Force [kN]")',
        ),
        (f'{RIG_LOAD}P = {{ column = "Force", scale = 0 }}', THICK, "line {P}: P.scale: must not be 0"),
        (
            f"{RIG_LOAD}P = 5",
            "",
            'line {P}: P: must be a column of the CSV file, such as P = { column = "Force [N]", scale = -1.0, unit = '
            '"kN" }, not 5',
        ),
        (
            '[[load]]\nP = { column = "Force" }',
            "",
            'line {P}: P: a column needs the file of the block, such as csv = "rig.csv"',
        ),
        ('[[load]]\nfile = "rig.csv"\nP = "Force"', "", 'unknown key "file" in [[load]], did you mean "csv"?'),
        (f"{RIG_LOAD}points = 3", "", "points: can't be given together with csv"),
    ],
)
def test_faults(block: str, contact: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(CaseFileError) as caught:
        values(tmp_path, block, contact)
    for number, line in enumerate((tmp_path / "case.toml").read_text().splitlines(), 1):
        words = words.replace(f"{{{line.partition(' =')[0]}}}", str(number))
    assert any(words in line for line in str(caught.value).splitlines())


def test_a_dimensionless_case_has_no_units(tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_text("P [kN]\n1\n")
    path = tmp_path / "case.toml"
    dundurs = "[dundurs]\nalpha = 0.0\nbeta = 0.0\nnu_pin = 0.3\n"
    contact = "[contact]\nload_parameter = 0.1\nfriction = 0.3\n"
    path.write_text(dundurs + contact + '[history]\ncsv = "rig.csv"\n')
    with pytest.raises(CaseFileError, match="the loads of a problem with load_parameter have no units; leave the unit"):
        read_case(path)
