"""Places in other processes where each waits until a test lets it go on."""

import os
import select
from pathlib import Path

from tests.support.processes import LONGEST


class Turnstile:
    """A process that comes to it says so, and waits. A test counts who has come, and lets some go on.

    Attributes
    ----------
    code : str
        A line of Python with which a process passes.
    """

    def __init__(self, folder: Path) -> None:
        pipes = [folder / "come", folder / "go"]
        for pipe in pipes:
            os.mkfifo(pipe)
        # Open at both ends, so that nobody waits for the other end.
        self._come, self._go = (os.open(pipe, os.O_RDWR) for pipe in pipes)
        self.code = (
            f"import os; come, go = os.open({str(pipes[0])!r}, os.O_RDWR), os.open({str(pipes[1])!r}, os.O_RDWR); "
            "os.write(come, b'x'); os.read(go, 1); os.close(come); os.close(go)"
        )

    def come(self, count: int = 1) -> None:
        """Wait until so many more processes have come."""
        for _ in range(count):
            assert select.select([self._come], [], [], LONGEST)[0], "no process comes"
            os.read(self._come, 1)

    def let_go(self, count: int = 1) -> None:
        os.write(self._go, b"x" * count)

    def close(self) -> None:
        os.close(self._come)
        os.close(self._go)
