"""How far rounding carries: tractions of random histories under two versions of packages, or two kinds of BLAS.

``python -m scripts.rounding FILE.npz [--count 12]`` solves `count` histories of each of five classes of
``scripts/histories.py`` and stores pressure and shear. ``python -m scripts.rounding --compare A.npz B.npz`` prints the
differences between two such files. The difference of a history is the largest one of all nodes and states, in parts
of the peak pressure of the state. ``OPENBLAS_CORETYPE=Prescott`` chooses the BLAS code of an old processor.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from fastpin.errors import FastpinError
from fastpin.solver.solving import solve
from scripts.histories import generate

CLASSES = ("general", "remote", "fits", "fixed", "moderate_stress")
"""Classes without extremes: their histories hang on no single digit."""


def tractions(count: int) -> dict[str, np.ndarray]:
    """Pressure and shear of all corners, shape (states, 2, n), by the name of the history. Refusals are left out."""
    found = {}
    for kind in CLASSES:
        for seed in range(count):
            case = generate(kind, seed)
            try:
                result = solve(case.problem, case.history, **case.options)
            except FastpinError:
                continue
            found[f"{kind} {seed}"] = np.array([(state.pressure, state.shear) for state in result])
    return found


def differences(old: Path, new: Path) -> np.ndarray:
    """The difference of each history, in increasing order; infinite if shapes or histories differ."""
    with np.load(old) as before, np.load(new) as after:
        names = sorted({*before.files, *after.files})
        return np.sort([_difference(before, after, name) for name in names])


def _difference(before: np.lib.npyio.NpzFile, after: np.lib.npyio.NpzFile, name: str) -> float:
    if name not in before.files or name not in after.files or before[name].shape != after[name].shape:
        return float("inf")
    one, other = before[name], after[name]
    peaks = one[:, 0].max(axis=1)
    apart = np.abs(one - other).max(axis=(1, 2))
    return float((apart[peaks > 0.0] / peaks[peaks > 0.0]).max(initial=0.0))


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--count", type=int, default=12, help="histories of each class")
    parser.add_argument("--compare", action="store_true", help="compare two files")
    options = parser.parse_args()
    if not options.compare:
        np.savez(options.files[0], **tractions(options.count))
        return
    found = differences(*options.files)
    print(f"{len(found)} histories, {np.sum(found == 0.0)} with the same bits, median {np.median(found):.1e}, ", end="")
    print(f"largest {found[-1]:.1e}")


if __name__ == "__main__":
    main()
