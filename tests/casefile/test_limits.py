"""Limits of case files: hostile texts end soon, in a short list of sentences."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fastpin import CaseFileError, InputError, casefile
from fastpin.casefile.toml_text import MOST_BYTES, MOST_BYTES_OF_PLAN, MOST_FAULTS, MOST_PARTS, CaseText
from fastpin.model import About
from fastpin.studies import read_outcomes, read_plan
from tests.support.times import growth

HOSTILE = {
    "unknown keys": (lambda size: "[contact]\n" + "".join(f"k{number} = 1\n" for number in range(size)), 1_000),
    "a dotted key": (lambda size: ".".join(["a"] * size) + " = 1\n", 50_000),
    "a dotted key of quoted parts": (lambda size: ".".join(['"a"'] * size) + " = 1\n", 10_000),
    "a dotted key inside a table": (lambda size: "x = {" + ".".join(["a"] * size) + " = 1}\n", 50_000),
    "load blocks": (lambda size: "[[load]]\nP = 1\n" * size, 200),
    "faulty lines": (lambda size: "".join(f"k{number} = x\n" for number in range(size)), 1_000),
}
"""Texts by a size, and a size that takes some milliseconds."""


@pytest.mark.parametrize(("text", "size"), HOSTILE.values(), ids=list(HOSTILE))
def test_a_hostile_text_of_twice_the_size_takes_twice_the_time(text: Callable[[int], str], size: int) -> None:
    texts = {each: text(each) for each in (size, 2 * size)}

    def refused(each: int) -> None:
        with pytest.raises(CaseFileError) as caught:
            casefile.parse_case(texts[each])
        assert len(caught.value.problems) <= MOST_FAULTS + 1
        assert len(str(caught.value)) < 100_000

    assert growth(refused, size) < 3.0


@pytest.mark.parametrize(
    "line",
    ["k = 1 {}", "k = {}", "{} = 1 2", "{} =", "k = .5{}", "[{}]\n[{}]", "x.{}=1\nx.{}=2", "{}", "[pin]\n{} = 1"],
)
def test_a_long_word_is_not_repeated(line: str) -> None:
    with pytest.raises(CaseFileError) as caught:
        casefile.parse_case(line.replace("{}", "a" * 100_000))
    assert max(map(len, str(caught.value).split("\n"))) < 600


@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "[[{}]]", "x = {{ {} = 1 }}"])
@pytest.mark.parametrize("part", ["a", '"a"', "'a'", "a "])
def test_a_key_has_as_many_parts_as_the_message_says(form: str, part: str) -> None:
    for count in (MOST_PARTS, MOST_PARTS + 1):
        faults = CaseText(form.format(".".join([part] * count))).faults
        words = f"a key has more than {MOST_PARTS} parts, joined by points"
        assert faults == ([(0, words)] if count > MOST_PARTS else [])


@pytest.mark.parametrize(
    ("read", "most"),
    [
        (casefile.read_case, MOST_BYTES),
        (casefile.read_lug, MOST_BYTES),
        (casefile.read_materials, MOST_BYTES),
        (read_outcomes, MOST_BYTES),
        (read_plan, MOST_BYTES_OF_PLAN),
    ],
)
def test_a_file_has_a_limit_by_its_kind(read: Callable[[Path], object], most: int, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    for size in (most, most + 1):
        path.write_text("#" * size)
        with pytest.raises(CaseFileError) as caught:
            read(path)
        assert (f"is larger than {most:,} bytes" in str(caught.value)) == (size > most)


@pytest.mark.parametrize("name", ["project", "author", "revision", "date"])
def test_the_table_about_has_printable_characters_only(name: str) -> None:
    def read(value: str) -> About:
        example = casefile.EXAMPLE.replace("title", "# title", 1)
        return casefile.parse_case(f"[about]\n{name} = {value}\n{example}").about

    assert read('"A <b> é"').given() == {name: "A <b> é"}
    assert read('""') == About()
    with pytest.raises(
        CaseFileError, match=rf"line 2: {name}: must be one line of printable characters, without \\x1b"
    ):
        read('"a\\u001b[31m"')
    if name != "date":
        with pytest.raises(CaseFileError, match=f"{name}: must be text in quotes"):
            read("2026-03-31")


def test_a_date_may_be_a_date_of_toml() -> None:
    text = casefile.EXAMPLE.replace("[pin]", "[about]\ndate = 2026-03-31\n[pin]", 1)
    assert casefile.parse_case(text).about == About(date="2026-03-31")
    for wrong in ("2026-03-31T12:00:00", "12:00:00", "20260331"):
        with pytest.raises(CaseFileError, match="date: must be text in quotes"):
            casefile.parse_case(text.replace("2026-03-31", wrong))


@pytest.mark.parametrize("title", ["a\x1b[31m", "a\nb", "a\tb", "a\u202eb", "a\x7f"])
def test_a_title_has_printable_characters_only(title: str) -> None:
    words = "".join(f"\\u{ord(letter):04x}" for letter in title)
    with pytest.raises(CaseFileError, match="title: must be one line of printable characters, without"):
        casefile.parse_case(casefile.EXAMPLE.replace('title = "', f'title = "{words}', 1))


@pytest.mark.parametrize("value", [3, None, (part for part in "ab"), ["Hinge"]])
def test_about_takes_texts_only(value: object) -> None:
    """Also values that can't be copied."""
    with pytest.raises(InputError, match="revision: must be text in quotes"):
        About("Hinge", revision=value)  # type: ignore[arg-type]
