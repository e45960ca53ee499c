"""Files that are read: a file named by a stranger may be a pipe, whose end never comes, or a device without an end."""

import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fastpin import InputError, LoadHistory, read_case
from fastpin.bodies import Compliance
from fastpin.casefile import parse_case, read_lug, read_materials
from fastpin.cli.main import main
from fastpin.studies import parse_plan, read_outcomes, read_plan, sweep
from fastpin.studies.index import Index
from tests.support.case_texts import PRESSED

GRID = '[grid]\n"contact.friction" = [0.1]\n'
STEEL_PAIR = PRESSED.partition("[[load]]")[0]

READERS = {
    "case": lambda path: read_case(path),
    "lug": lambda path: read_lug(path),
    "materials": lambda path: read_materials(path),
    "plan": lambda path: read_plan(path),
    "outcomes": lambda path: read_outcomes(path),
    "corners": lambda path: LoadHistory.from_csv(path),
    "compliance": lambda path: Compliance.from_file(path),
    "history of a case": lambda path: parse_case(f'{STEEL_PAIR}[history]\ncsv = "{path}"\n'),
    "block of a case": lambda path: parse_case(f'{PRESSED}[[load]]\ncsv = "{path}"\n'),
    "materials of a case": lambda path: parse_case(f'materials = "{path}"\n{PRESSED}'),
    "compliance of a case": lambda path: parse_case(f'{PRESSED}[plate_body]\nkind = "compliance"\nfile = "{path}"\n'),
    "case of a plan": lambda path: parse_plan(f'case = "{path}"\n{GRID}'),
    "function of a plan": lambda path: parse_plan(
        f'{GRID}[outcomes]\nw = {{ function = "{path.with_suffix(".py").name}:f" }}\n', folder=path.parent
    ),
}


@pytest.fixture
def pipe(tmp_path: Path) -> Iterator[Path]:
    """A pipe to which nothing is written. A reader that waits for it finds its end, and no sentence about a pipe."""
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    (tmp_path / "pipe.py").symlink_to(path)
    is_done = threading.Event()

    def end_each_wait() -> None:
        while not is_done.is_set():
            os.close(os.open(path, os.O_WRONLY))  # waits for a reader

    thread = threading.Thread(target=end_each_wait, daemon=True)
    thread.start()
    yield path
    is_done.set()
    end = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # as long as it is open, the thread waits for no reader
    thread.join()
    os.close(end)


@pytest.mark.parametrize("read", READERS.values(), ids=list(READERS))
def test_a_pipe_is_refused_in_one_sentence(read: Callable[[Path], object], pipe: Path) -> None:
    with pytest.raises(InputError, match="must be an ordinary file, not a pipe or a device"):
        read(pipe)


def test_a_device_is_refused_before_it_is_read() -> None:
    for read in (READERS["case"], READERS["corners"], READERS["compliance"]):
        with pytest.raises(InputError, match="must be an ordinary file, not a pipe or a device"):
            read(Path("/dev/zero"))


def test_pipes_in_the_directory_of_a_sweep_are_no_results(pipe: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = pipe.parent / "runs"
    plan = parse_plan(GRID)
    (folder / "results").mkdir(parents=True)
    os.mkfifo(folder / sweep.PLAN)
    with pytest.raises(InputError, match=r"holds another plan\.toml, but no sweep"):
        sweep.run(plan, folder, workers=1)
    (folder / sweep.PLAN).unlink()
    with Index(folder, write=True) as index:
        index.expect(plan, plan.points)
    os.mkfifo(folder / "results" / f"{plan.points[0].id}.h5")
    pipe.with_name("plan.toml").write_text(GRID)
    assert main(["sweep", str(pipe.with_name("plan.toml")), "-o", str(folder), "--status"]) == 0
    assert "1 waiting" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["/dev/fd/{}", "/dev/stdin"])
def test_an_open_pipe_of_the_shell_is_read(name: str) -> None:
    """Process substitution hands over /dev/fd/63."""
    out, into = os.pipe()
    os.write(into, PRESSED.encode())
    os.close(into)
    kept = os.dup(0)
    try:
        os.dup2(out, 0)
        assert len(read_case(name.format(out)).history) == 1
    finally:
        os.dup2(kept, 0)
        os.close(kept)
        os.close(out)
