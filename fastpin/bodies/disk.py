"""A solid pin."""

from __future__ import annotations

from dataclasses import dataclass

from fastpin.bodies.body import PinBody


@dataclass(frozen=True)
class Disk(PinBody):
    """A solid pin. Its load enters as the problem's ``pin_load`` says."""

    kind = "disk"
    bore_radius = 0.0
