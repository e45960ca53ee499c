"""The draft of the JOSS paper: its front matter, sections, length, citations and figures; the citation file."""

import re
from pathlib import Path

import pytest

from fastpin.version import __version__
from tests.support.documents import statements

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "joss"
_, FRONT, BODY = (FOLDER / "paper.md").read_text(encoding="utf-8").split("---\n", 2)
BIBLIOGRAPHY = (FOLDER / "paper.bib").read_text(encoding="utf-8")
SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
"""The sections that JOSS requires, in its order."""


def fields(text: str) -> dict[str, str]:
    """The keys of the front matter without indentation, each with the text up to the next key."""
    parts = re.split(r"^(\w+):", text, flags=re.MULTILINE)[1:]
    return {key: value.strip() for key, value in zip(parts[::2], parts[1::2], strict=True)}


def test_the_front_matter_is_complete() -> None:
    found = fields(FRONT)
    assert list(found) == ["title", "tags", "authors", "affiliations", "date", "bibliography"]
    assert all(found.values())
    assert "`" not in found["title"]
    assert found["bibliography"] == "paper.bib"
    assert found["tags"].count("- ") >= 3
    assert re.fullmatch(r"\d{1,2} [A-Z][a-z]+ 20\d\d", found["date"])
    affiliations = re.findall(r"^    index: (\d+)$", FRONT, re.MULTILINE)
    authors = re.findall(r"^  - name: .+\n    affiliation: (\d+)$", FRONT, re.MULTILINE)
    assert len(authors) == found["authors"].count("- name:")
    assert set(authors) == set(affiliations)


def test_the_sections_are_those_that_joss_requires() -> None:
    assert re.findall(r"^# (.*)$", BODY, re.MULTILINE) == SECTIONS
    parts = re.split(r"^# .*$", BODY, flags=re.MULTILINE)[1:]
    assert all(part.strip() for part in parts[:-1])
    assert not parts[-1].strip()  # JOSS writes the references


def test_the_paper_has_a_length_that_joss_takes() -> None:
    assert 750 <= len(BODY.split()) <= 1750


def test_every_citation_has_an_entry_and_every_entry_is_cited() -> None:
    cited = set(re.findall(r"(?<![\w.])@([\w:-]+)", BODY))
    entries = re.findall(r"^@\w+\{([\w:-]+),$", BIBLIOGRAPHY, re.MULTILINE)
    assert len(entries) == len(set(entries))
    assert cited == set(entries)


def test_entries_have_the_fields_that_references_need() -> None:
    for kind, key, content in re.findall(r"^@(\w+)\{([\w:-]+),\n(.*?)^\}$", BIBLIOGRAPHY, re.MULTILINE | re.DOTALL):
        names = set(re.findall(r"^  (\w+)\s*= \{", content, re.MULTILINE))
        venue = {"article": "journal", "book": "publisher", "inproceedings": "booktitle", "phdthesis": "school"}
        assert {"author", "title"} <= names, key
        assert ("url" if kind == "misc" else venue[kind]) in names, key
        assert kind == "misc" or "year" in names, key


@pytest.mark.parametrize("doi", re.findall(r"doi\s*= \{(.*?)\}", BIBLIOGRAPHY))
def test_a_doi_is_no_address(doi: str) -> None:
    assert re.fullmatch(r"10\.\d{4,9}/\S+", doi)


def test_figures_exist() -> None:
    figures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", BODY)
    assert figures
    assert all((FOLDER / figure).exists() for figure in figures)


def test_the_verdicts_on_the_paper_are_counted_as_in_its_table() -> None:
    verdicts = [row[4].strip() for row in statements()]
    confirmed, refused = (sum(entry.startswith(word) for entry in verdicts) for word in ("confirmed", "**not"))
    in_part = len(verdicts) - confirmed - refused
    assert f"checks {len(verdicts)} statements" in BODY
    counted = f"{confirmed} are confirmed, {in_part} hold only for a part of the parameters, and {refused} do not hold"
    assert counted in " ".join(BODY.split())


def test_the_citation_file_has_the_version_and_the_paper() -> None:
    text = (FOLDER.parents[1] / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in text
    (title,) = re.findall(r"^title: \"(.*)\"$", text, re.MULTILINE)
    assert title == fields(FRONT)["title"].strip("'")
    (paper,) = re.findall(r"@article\{sundaram2010,\n(.*?)^\}$", BIBLIOGRAPHY, re.MULTILINE | re.DOTALL)
    for name in ("title", "journal", "volume", "year"):
        (value,) = re.findall(rf"^  {name}\s*= \{{(.*?)\}},?$", paper, re.MULTILINE)
        assert f"    {name}: {value}\n" in text
