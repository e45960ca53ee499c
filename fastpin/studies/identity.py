"""The identity of a run: its canonical input, and an id of this input and the version of fastpin.

The order of keys, comments, names of materials, sources of constants and the spelling of a number make no difference.
Every bit of a number makes a difference.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np

from fastpin.assess.outputs import kept
from fastpin.model import LOADS, Case, LoadHistory, Material, Problem, SolveOptions
from fastpin.model.fields import FIELDS
from fastpin.model.growth import law_entries
from fastpin.version import __version__

FIRST_LOADS = 6
"""Loads that were known first. Later ones enter an id only where they are given, so that older ids stay."""

ID_LENGTH = 16
"""Hexadecimal digits of an id."""


def canonical(case: Case, strengths: bool = False) -> dict[str, Any]:
    """Return the run's complete input as a JSON-ready dict.

    Two runs with equal dicts and the same version of fastpin have equal results. Numbers survive JSON exactly. They are
    in SI units, or in the units of the paper for a dimensionless problem. The load history enters as its number of
    corners, the loads at its last corner and the SHA-256 of all its numbers. A load that is never given is left out.
    Strengths change no state, and enter on demand only: for margins of safety that are read from the results.
    """
    problem, pair = case.problem, case.problem.pair
    material = partial(_material, strengths=strengths)
    return {
        "pin": material(pair.pin),
        "plate": material(pair.plate),
        "plane": pair.plane,
        **_fields(problem),
        # A solid pin and an infinite plate are left out, so that older ids stay. The friction of a bush changes no
        # state, and enters like fatigue constants: a result says whether the bush slips.
        **{name: _plain(body.as_json(material)) for name, body in problem.given_bodies.items()},
        "dimensionless": problem.dimensionless,
        "loads": _digested(case.history),
        "solve": _options(case.options),
    }


def run_id(document: dict[str, Any], version: str = __version__) -> str:
    """Return the id of a run: 16 hexadecimal digits of the SHA-256 of its canonical input and the version."""
    return id_of_json(canonical_json(document), version)


def id_of_json(text: str, version: str = __version__) -> str:
    """Return the id of a run with the canonical input `text`, see :func:`canonical_json`."""
    both = f'{{"fastpin":{json.dumps(version)},"input":{text}}}'
    return hashlib.sha256(both.encode()).hexdigest()[:ID_LENGTH]


def canonical_json(document: dict[str, Any]) -> str:
    """Return a dict as JSON with sorted keys. A number has the fewest digits that give it back exactly.

    Negative zeros are written as 0, infinity as "inf".
    """
    return json.dumps(_plain(document), sort_keys=True, separators=(",", ":"), allow_nan=False)


def _material(material: Material, strengths: bool) -> dict[str, Any]:
    elastic: dict[str, Any] = _plain(material.constants())
    constants = {} if material.fatigue is None else material.fatigue.given()
    constants.pop("source", None)
    growth = {} if material.growth is None else law_entries(material.growth)
    growth.pop("source", None)
    later = {"fatigue": constants, "growth": growth, "strengths": material.strengths if strengths else {}}
    return elastic | {name: given for name, given in later.items() if given}


def _fields(problem: Problem) -> dict[str, Any]:
    """Return the fields of a problem. A later field with its default is left out, so that older ids stay."""
    usual = {each.name: each.default for each in fields(Problem)}
    return {
        name: _plain(value)
        for name, value in problem.entries().items()
        if FIELDS[name].in_ids == "always" or (FIELDS[name].in_ids == "given" and value != usual[name])
    }


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return "inf" if value == math.inf else float(value) + 0.0  # -0 becomes 0.
    return value


@kept
def _digested(history: LoadHistory) -> dict[str, Any]:
    """Return the loads of a history. A load that is never given differs from a load of zero."""
    digest, last = hashlib.sha256(), np.full(len(LOADS), np.nan)
    given = np.any([np.any(~np.isnan(block.given), axis=0) for block in history.blocks], axis=0)
    width = max(FIRST_LOADS, 1 + int(np.flatnonzero(given).max(initial=0)))
    for block in history.blocks:
        if block.cycle:
            digest.update(f"{block.count} times {len(block.given)}".encode())
        if block.lengths:
            digest.update(f"cycles {block.lengths}".encode() + block.ends.astype("<i8").tobytes())
        for _ in range(min(block.count, 2)):  # Every later time equals the second.
            values = LoadHistory.from_array(block.given).values(initial=last) + 0.0  # -0 becomes 0.
            values[np.isnan(values)] = np.nan  # NaN has many bit patterns.
            digest.update(np.ascontiguousarray(values[:, :width], dtype="<f8").tobytes())
            last = values[-1]
    named = {name: float(value) for name, value in zip(LOADS, last, strict=True) if not math.isnan(value)}
    return {"corners": len(history), "last": named, "sha256": digest.hexdigest()}


def _options(options: SolveOptions) -> dict[str, Any]:
    keywords = options.written
    del keywords["shortcut"]  # It changes no state.
    if options.method == "path":
        del keywords["increments"]
    return keywords
