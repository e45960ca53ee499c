"""Tables of text: rows that repeat earlier ones, and rows that are left out."""

import re
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Result, solve
from fastpin.assess.outputs import (
    MAX_ROWS,
    LeftOut,
    Repeat,
    printed_rows,
    table,
    table_of_lines,
    with_rows,
)
from fastpin.casefile import EXAMPLE, parse_case
from fastpin.report.states import folded_lines, row_numbers, state_table, stored_rows
from fastpin.states.quantities import load_point
from tests.support.samples import sample_result
from tests.support.tiers import gate


def lines(letters: str) -> list[str]:
    """The lines of a table with a numbered row for each letter, without its head. Equal letters are equal rows."""
    numbers = [str(number) for number in range(1, len(letters) + 1)]
    found = folded_lines(row_numbers(letters))
    rows = printed_rows(found)
    columns = [("point", "", [numbers[row] for row in rows]), ("value", "m", [letters[row] for row in rows])]
    return without_head(table_of_lines(columns, found, numbers))


def without_head(text: str) -> list[str]:
    return [" ".join(line.split()) for line in text.splitlines()[2:]]


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


def test_several_repeats_follow_one_another() -> None:
    assert lines("aaaabbbb") == [
        "1 a", "... 2 to 4: repeat point 1, 3 times ...", "5 b", "... 6 to 8: repeat point 5, 3 times ...",
    ]  # fmt: skip


@pytest.mark.parametrize(("rows", "hidden", "more"), [(3, 0, 0), (8, 100, 100), (60, 7, 27), (60, 0, 20)])
def test_rows_that_are_not_given_are_counted_in_the_middle(rows: int, hidden: int, more: int) -> None:
    columns = [("point", "", [str(row) for row in range(1, rows + 1)])]
    found = without_head(table(columns, hidden))
    printed = min(rows, MAX_ROWS)
    assert len(found) == printed + (more > 0)
    assert (found[0], found[-1]) == ("1", str(rows))
    assert (found[printed // 2] == f"... {more} more ...") == (more > 0)


def test_a_table_that_is_long_in_spite_of_repeats_is_cut() -> None:
    text = "".join(chr(0x4E00 + number) for number in range(45))
    found = lines("a" * 1000 + text)
    assert len(found) == MAX_ROWS + 1
    assert found[:3] == ["1 a", "... 2 to 1000: repeat point 1, 999 times ...", f"1001 {text[0]}"]
    assert found[MAX_ROWS // 2] == "... 7 more ..."
    assert found[-1] == f"1045 {text[-1]}"


@pytest.mark.gate
@pytest.mark.parametrize(("cycles", "most"), [(1, 4), (7, 16), *gate((1000, 16))])
def test_a_fretting_history_prints_a_readable_table(cycles: int, most: int) -> None:
    """4, 22 and 3,001 states. The last state is always printed."""
    text = EXAMPLE.replace("# repeat = 1000  ", f"repeat = {cycles}  ")
    case = parse_case(text)
    result = solve(case.problem, case.history, nodes=61)
    assert len(result) == 1 + 3 * cycles
    text = state_table(case.problem, list(result))
    stored = stored_rows(case.problem, points_of(result), result.cycles, lambda places: [result[k] for k in places])
    assert state_table(case.problem, [result[k] for k in stored.printed], stored) == text
    rows = text.splitlines()[2:]
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


def points_of(result: Result) -> np.ndarray:
    return np.array([load_point(state) for state in result])


def test_of_a_stored_result_few_states_are_read() -> None:
    """The states between the first steady cycle and the last one are taken as known."""
    case = parse_case(EXAMPLE.replace("# repeat = 1000  ", "repeat = 200  "))
    result = solve(case.problem, case.history, nodes=61)
    read: list[int] = []
    stored_rows(case.problem, points_of(result), result.cycles, lambda at: read.extend(at) or [result[k] for k in at])
    assert len(result) == 601
    assert len(read) < 60
    assert read[-3:] == [598, 599, 600]


def test_kept_states_out_of_phase_with_the_cycles_are_not_taken_for_equal() -> None:
    case = parse_case(EXAMPLE.replace("# repeat = 1000  ", "repeat = 60  "))
    result = solve(case.problem, case.history, nodes=61, keep="every 2")
    rows = stored_rows(case.problem, points_of(result), result.cycles, lambda places: [result[k] for k in places])
    text = state_table(case.problem, list(result))
    assert state_table(case.problem, [result[k] for k in rows.printed], rows) == text
    assert re.search(r"repeat load points \d+ to \d+, \d+ times", text)


def test_a_stored_result_of_many_different_states_is_cut_without_reading_them() -> None:
    points = np.arange(1.0, 5001.0)
    rows = stored_rows(sample_result().problem, points, (), lambda places: pytest.fail("states were read"))
    assert rows.printed == [*range(20), *range(4980, 5000)]


def test_states_with_equal_loads_and_other_tractions_have_their_own_rows() -> None:
    state = sample_result()[0]
    for change, folded in ((0.0, True), (1e-12, True), (1e-3, False)):
        states = [replace(state, step=k, pressure=(1.0 + change * k) * state.pressure) for k in range(4)]
        assert ("repeat load point 1, 3 times" in state_table(state.problem, states)) == folded


def test_loads_that_are_rounding_are_printed_as_0() -> None:
    result = sample_result([{"P": 1e6, "Q": 1e-8}, {"P": 1e6, "Q": 5.0}])
    cells = [row.split()[2] for row in state_table(result.problem, list(result)).splitlines()[2:]]
    assert cells == ["0", "5e-06"]


def test_wanted_rows_are_not_left_out() -> None:
    lines = [0, 1, LeftOut(5), 7, Repeat(8, 2, 3), LeftOut(2), 16]
    assert with_rows(lines, ()) == lines
    assert with_rows(lines, (0, 9, 40)) == lines
    assert with_rows(lines, (6, 2, 4, 15)) == [
        0, 1, 2, LeftOut(1), 4, LeftOut(1), 6, 7, Repeat(8, 2, 3), LeftOut(1), 15, 16
    ]  # fmt: skip
