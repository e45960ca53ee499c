"""Limits of case files: hostile texts end soon, in a short list of sentences."""

from __future__ import annotations

import time

import pytest

from fastpin import casefile
from fastpin.casefile.toml_text import MOST_FAULTS
from fastpin.errors import CaseFileError

SECONDS = 20.0
"""Far more than a hostile text takes, and less than it took without limits."""

HOSTILE = {
    "unknown keys": "[contact]\n" + "".join(f"k{number} = 1\n" for number in range(40_000)),
    "a dotted key": ".".join(["a"] * 100_000) + " = 1\n",
    "a dotted key of quoted parts": ".".join(['"a"'] * 100_000) + " = 1\n",
    "a dotted key inside a table": "x = {" + ".".join(["a"] * 100_000) + " = 1}\n",
    "load blocks": "".join("[[load]]\nP = 1\n" for _ in range(100_000)),
    "faulty lines": "".join(f"k{number} = x\n" for number in range(100_000)),
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=list(HOSTILE))
def test_a_hostile_text_ends_in_few_sentences(text: str) -> None:
    began = time.monotonic()
    with pytest.raises(CaseFileError) as caught:
        casefile.parse_case(text)
    assert time.monotonic() - began < SECONDS
    assert len(caught.value.problems) <= MOST_FAULTS + 1
    assert len(str(caught.value)) < 100_000


@pytest.mark.parametrize("title", ["a\x1b[31m", "a\nb", "a\tb", "a\u202eb", "a\x7f"])
def test_a_title_has_printable_characters_only(title: str) -> None:
    words = "".join(f"\\u{ord(letter):04x}" for letter in title)
    with pytest.raises(CaseFileError, match="title: must be one line of printable characters, without"):
        casefile.parse_case(casefile.EXAMPLE.replace('title = "', f'title = "{words}', 1))
