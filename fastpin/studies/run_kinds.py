"""What a worker does with the two kinds of files: it solves one, keeps its result, and reads it again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fastpin import joints, storage
from fastpin.model.case import Case, beside_of
from fastpin.solver import solve
from fastpin.solver.result import Result, without_restart
from fastpin.storage import store
from fastpin.studies.run_end import JOINT_FIGURES, figures_of, key_bars, key_figures


class OfCases:
    """Runs of one pin."""

    @staticmethod
    def solve(case: Case) -> Result:
        """Follow the history."""
        return solve(case.problem, case.history, **case.options.keywords())

    @staticmethod
    def keep(case: Case, result: Result, reason: str | None, path: str, most: int) -> bytes | None:
        """Return the packed result, with the `reason` why it is incomplete.

        A result of more than `most` bytes is written to a file, and None is returned.
        """
        sections = beside_of(case)
        content = store.pack(result, reason, most, sections)
        if content is None:
            store.save(result, path, error=reason, restart=False, sections=sections)
        return content

    @staticmethod
    def figures(result: Result) -> tuple[dict[str, Any], dict[str, float]]:
        """Return the key figures and their error bars."""
        return key_figures(result), key_bars(result)

    @staticmethod
    def judged(result: Result) -> Result:
        """Return the result as outcomes see it: without its restart it is the same as the stored one."""
        return without_restart(result)

    @staticmethod
    def read(path: str, content: bytes | None) -> Result:
        """Read a kept result."""
        return store.load(path) if content is None else store.unpack(content, Path(path))[0]

    @staticmethod
    def write(path: Path, content: bytes) -> None:
        """Write a packed result to a file."""
        result, sections = store.unpack(content, path)
        store.save(result, path, restart=False, sections=sections)


class OfJoints:
    """Runs of joints of several pins; see :class:`OfCases`."""

    @staticmethod
    def solve(case: joints.JointFile) -> joints.JointResult:
        """Follow the history."""
        return joints.solve_joint(case.joint, case.corners, nodes=case.nodes, harmonics=case.harmonics)

    @staticmethod
    def keep(
        case: joints.JointFile, result: joints.JointResult, reason: str | None, path: str, most: int
    ) -> bytes | None:
        """Return the packed result, or write it to a file and return None."""
        content = storage.pack_joint(case, result, reason)
        if len(content) <= most:
            return content
        storage.save_joint(content, Path(path))
        return None

    @staticmethod
    def figures(result: joints.JointResult) -> tuple[dict[str, Any], dict[str, float]]:
        """Return the key figures. There are no error bars."""
        return figures_of(JOINT_FIGURES, result), {}

    @staticmethod
    def judged(result: joints.JointResult) -> joints.JointResult:
        """Return the result as outcomes see it."""
        return result

    @staticmethod
    def read(path: str, content: bytes | None) -> joints.JointResult:
        """Read a kept result. A packed one is found by its path, too."""
        return storage.load_joint(path)

    @staticmethod
    def write(path: Path, content: bytes) -> None:
        """Write a packed result to a file."""
        storage.save_joint(content, path)


RUNS: dict[str, type[OfCases | OfJoints]] = {"case file": OfCases, "joint file": OfJoints}
"""What is done, by the form of a base, see :class:`fastpin.studies.plan.Base`."""
