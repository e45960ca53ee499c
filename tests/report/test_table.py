"""Tables of text: rows that repeat earlier ones, and rows that are left out."""

from __future__ import annotations

import re

import pytest

from fastpin.casefile.reader import EXAMPLE, parse_case
from fastpin.report.states import state_table
from fastpin.report.table import MAX_ROWS, table
from fastpin.solver.solving import solve
from tests.support.samples import sample_result


def lines(letters: str, hidden: int = 0, sums: bool = False) -> list[str]:
    """The lines of a table with a numbered row for each letter, without its head."""
    numbers = [str(number) for number in range(1, len(letters) + 1)]
    columns = [("point", "", numbers), ("value", "m", list(letters))]
    if sums:
        columns.append(("sum", "J", numbers))
    return [" ".join(line.split()) for line in table(columns, hidden, ("point", "sum")).splitlines()[2:]]


def test_repeats_become_one_line() -> None:
    rest = ["... 5 to 10: repeat points 2 to 4, 2 times ...", "11 a", "12 b"]
    assert lines("xabcabcabcab") == ["1 x", "2 a", "3 b", "4 c", *rest]
    assert lines("abababa") == ["1 a", "2 b", "... 3 to 6: repeat points 1 to 2, 2 times ...", "7 a"]
    assert lines("xaaaay") == ["1 x", "2 a", "... 3 to 5: repeat point 2, 3 times ...", "6 y"]
    assert lines("abcabc") == ["1 a", "2 b", "3 c", "... 4 to 6: repeat points 1 to 3, once ..."]


def test_few_repeats_stay() -> None:
    assert lines("xaay") == ["1 x", "2 a", "3 a", "4 y"]
    assert lines("abab") == ["1 a", "2 b", "3 a", "4 b"]


def test_the_longest_repeats_win() -> None:
    assert lines("aabaabaab") == ["1 a", "2 a", "3 b", "... 4 to 9: repeat points 1 to 3, 2 times ..."]


def test_a_sum_may_grow_in_repeats() -> None:
    assert lines("ababab", sums=True)[2:] == ["... 3 to 6: repeat points 1 to 2, 2 times ..."]


def test_several_repeats_follow_one_another() -> None:
    assert lines("aaaabbbb") == [
        "1 a", "... 2 to 4: repeat point 1, 3 times ...", "5 b", "... 6 to 8: repeat point 5, 3 times ...",
    ]  # fmt: skip


def test_rows_that_are_not_given_are_counted_between_the_repeats() -> None:
    assert lines("aaaaaaaa", hidden=100) == [
        "1 a", "... 2 to 4: repeat point 1, 3 times ...", "... 100 more ...",
        "5 a", "... 6 to 8: repeat point 5, 3 times ...",
    ]  # fmt: skip
    text = "".join(chr(0x4E00 + number) for number in range(60))
    found = lines(text, hidden=7)
    assert len(found) == MAX_ROWS + 1
    assert found[MAX_ROWS // 2] == "... 27 more ..."
    assert found[0].startswith("1 ")
    assert found[-1].startswith("60 ")


def test_a_table_that_is_long_in_spite_of_repeats_is_cut() -> None:
    text = "".join(chr(0x4E00 + number) for number in range(45))
    found = lines("a" * 1000 + text)
    assert len(found) == MAX_ROWS + 1
    assert found[:3] == ["1 a", "... 2 to 1000: repeat point 1, 999 times ...", f"1001 {text[0]}"]
    assert found[MAX_ROWS // 2] == "... 7 more ..."
    assert found[-1] == f"1045 {text[-1]}"


@pytest.mark.parametrize("own", [None, ("point",)])
def test_without_repeats_all_rows_are_printed(own: tuple[str, ...] | None) -> None:
    columns = [("point", "", ["1", "2"]), ("value", "m", ["a", "b"])]
    assert table(columns, 0, own).splitlines()[2:] == ["    1      a", "    2      b"]


@pytest.mark.parametrize(("cycles", "most"), [(1, 4), (7, 16), (1000, 16)])
def test_a_fretting_history_prints_a_readable_table(cycles: int, most: int) -> None:
    """4, 22 and 3,001 states. The last state is always printed."""
    text = EXAMPLE.replace("# repeat = 1000  ", f"repeat = {cycles}  ")
    case = parse_case(text)
    result = solve(case.problem, case.history, nodes=61)
    assert len(result) == 1 + 3 * cycles
    rows = state_table(case.problem, list(result)).splitlines()[2:]
    assert len(rows) <= most
    pattern = r"\.\.\. (\d+) to (\d+): repeat load points (\d+) to (\d+), (\d+) times"
    found = [match for row in rows if (match := re.search(pattern, row))]
    assert len(found) == (cycles > 1)
    printed = len(rows) - len(found)
    for match in found:
        first, last, begin, end, times = map(int, match.groups())
        assert (first, last) == (end + 1, end + times * (end - begin + 1))
        printed += times * (end - begin + 1)
    assert printed == len(result)
    assert rows[-1].split()[0] == str(len(result))


def test_loads_that_are_rounding_are_printed_as_0() -> None:
    result = sample_result([{"P": 1e6, "Q": 1e-8}, {"P": 1e6, "Q": 5.0}])
    cells = [row.split()[2] for row in state_table(result.problem, list(result)).splitlines()[2:]]
    assert cells == ["0", "5e-06"]
