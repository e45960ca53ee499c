"""The option ``--interface`` of ``fastpin show`` and ``plot``: the contact of a bush that slips in its seat."""

from __future__ import annotations

from pathlib import Path

from fastpin import solver, storage
from fastpin.errors import InputError


def seat_title(title: str) -> str:
    """Return the title of a case with words that tell the contact in the seat from the contact of the pin."""
    return f"{title}, seat of the bush" if title else "seat of the bush"


def load_seat(path: Path) -> solver.Result:
    """Return the contact of the bush in its seat, of a stored result. Without one raise :class:`InputError`."""
    seat = None if storage.holds_wear(path) else storage.load(path).seat
    if seat is None:
        raise InputError("--interface", f"{path}: the joint has no seat of a bush that slips (bonded = false)")
    return seat
