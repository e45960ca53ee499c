"""``fastpin report``: its kinds of sources, its options, its messages."""

from pathlib import Path

import pytest

from tests.support.commands import printed, refusal, refused, said
from tests.support.html import Page
from tests.support.samples import JOINT

pytestmark = pytest.mark.usefixtures("undrawn")

CASE = f"""title = "A joint"
{JOINT}
[[load]]
P = [1e6, 1.2e6]
[solve]
nodes = 121
"""


def words(path: str) -> str:
    return Page(Path(path).read_text(encoding="utf-8")).text


@pytest.mark.gate
def test_a_stored_result_gets_the_name_of_its_file(case: Path) -> None:
    said("run", case, "-o", "result.h5")
    assert printed("report", "result.h5", "--case", case, "--title", "Another title") == "wrote result.html\n"
    assert "Another title" in words("result.html")
    assert CASE in words("result.html")


@pytest.mark.gate
def test_a_case_is_solved_with_error_bars(case: Path) -> None:
    said("report", case, "-o", "page.html", "--error-bars")
    assert "There are no error bars" not in words("page.html")
    assert CASE in words("page.html")
    assert "A joint" in words("page.html")


@pytest.mark.gate
def test_a_case_that_ends_early_has_a_page_with_the_reason(case: Path) -> None:
    case.write_text(CASE.replace("friction = 0.4", 'friction = 0.4\npin_load = "centre"') + "[[load]]\nM = 1e5\n")
    reason = said("report", case, "-o", "page.html", code=1).err.removeprefix("fastpin: ").strip()
    assert f"The reason: {reason}" in words("page.html")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["case.toml", "-o", "page.png"], "--output: must be the name of a page, which ends in .html, .htm or .pdf"),
        (["case.toml", "--author", "a\tb"], "--author: must be one line of printable characters, without \\t"),
        (["case.toml", "--plan", "x"], "--plan: has no effect on a case file; it is for the directory of a sweep"),
        (["a.h5", "--error-bars"], "--error-bars: has no effect on a stored result; it is for a case file"),
        ([".", "--title", "x"], "--title: has no effect on the directory of a sweep; it is for a stored result or a"),
        (["a.h5"], "a.h5: there is no such file"),
        (["."], ".: holds no sweep: there is no index.sqlite"),
        (["junk.h5"], "junk.h5: is no HDF5 file, and no result"),
        (["plan.toml"], "plan.toml: is a plan: name the directory of its sweep, such as plan"),
    ],
)
def test_wrong_input_is_refused_in_one_sentence(arguments, message, case):
    Path("junk.h5").write_bytes(b"junk")
    Path("plan.toml").write_text('case = "case.toml"\n[grid]\n"contact.friction" = [0.1, 0.2]\n')
    assert refusal("report", *arguments).startswith(f"fastpin: {message}")
    assert sorted(path.name for path in Path().iterdir()) == ["case.toml", "junk.h5", "plan.toml"]


def test_all_faults_of_a_case_are_listed(case: Path) -> None:
    case.write_text(CASE.replace("nodes = 121", "nodes = 1").replace("friction = 0.4", "friction = -1"))
    assert len(refused("report", case).splitlines()) == 2


@pytest.mark.gate
def test_options_replace_who_made_the_case(case: Path) -> None:
    about = '[about]\nproject = "<i>Hinge</i> \\";}</style>"\nrevision = "A"\nauthor = "A. Engineer"\n'
    case.write_text(CASE.replace("[contact]", f"{about}[contact]", 1))
    said("run", case, "-o", "result.h5")
    for source in ("case.toml", "result.h5"):
        said("report", source, "-o", "page.html", "--revision", "B", "--date", "1 May 2026")
        text = Path("page.html").read_text(encoding="utf-8")
        told = " ".join(Page(text).text.split())
        assert 'Project<i>Hinge</i> ";}</style>' in told.replace("Project ", "Project")
        for name, value in {"Author": "A. Engineer", "Revision": "B", "Date": "1 May 2026"}.items():
            assert f"{name}{value}" in told.replace(f"{name} ", name)
        left = text.partition('@top-left { content: "')[2].partition('"')[0]
        assert left.startswith("\\00003ci\\00003eHinge")
        assert left.endswith("A joint")
        assert 'page " counter(page) " of " counter(pages)' in text


@pytest.mark.gate
def test_a_sweep_takes_who_made_its_base_case(case: Path) -> None:
    case.write_text(CASE.replace("[contact]", '[about]\nproject = "Hinge"\n[contact]', 1))
    Path("plan.toml").write_text('case = "case.toml"\n[grid]\n"contact.friction" = [0.1, 0.2]\nsolve.nodes = [41]\n')
    said("sweep", "plan.toml", "--workers", "1")
    said("report", "plan", "-o", "page.html", "--author", "A. Engineer")
    assert "Hinge" in words("page.html")
    assert "A. Engineer" in words("page.html")
