"""Pins: a solid one, a hollow one, and a bush as the pin of its seat."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.body import THINNEST, Control, Harmonics, InWords, PinBody, PinLoad, Rim, Shape, Table
from fastpin.bodies.walls import Amplitudes, Wall, first_change, free_at_contact
from fastpin.errors import InputError
from fastpin.model.checks import check_fields, choice, is_above, positive
from fastpin.model.synonyms import explains_keywords

TubeLoad = Literal["uniform", "normal", "shear", "held", "body"]
"""Kinds of load in the bore of a hollow pin."""

TUBE_LOADS: tuple[TubeLoad, ...] = ("uniform", "normal", "shear", "held", "body")


@dataclass(frozen=True)
class Disk(PinBody):
    """A solid pin. Its load enters as the problem's ``pin_load`` says."""

    kind = "disk"
    bore_radius = 0.0


@explains_keywords
@dataclass(frozen=True)
class Tube(PinBody):
    """A hollow pin. The forces on the pin enter at its bore.

    Parameters
    ----------
    bore_radius : float
        Radius of the bore, m, less than the hole radius.
    load : {"uniform", "normal", "shear", "held", "body"}
        "uniform": a traction of one size and direction all round the bore. "normal": normal traction alone, like the
        cosine of the angle from the force. "shear": shear traction alone, like the sine. "held": a rigid core is bonded
        to the bore. "body": a uniform body force; the bore is free. A moment enters by a uniform shear traction.

    Raises
    ------
    InputError
        If the radius is not positive, or the load is unknown.
    """

    kind = "tube"
    keys: ClassVar = {"bore_radius": "length", "load": ""}
    controlled = ("pin_bore", "bore_load")

    bore_radius: float
    load: TubeLoad = "uniform"

    def __post_init__(self) -> None:
        check_fields(self, positive, "bore_radius")
        check_fields(self, choice, "load", TUBE_LOADS)

    @property
    def held(self) -> bool:
        """Whether a rigid core holds the bore."""
        return self.load == "held"

    @classmethod
    def read(cls, table: Table) -> Tube | None:
        table.require("bore_radius")
        bore, load = table.checked("bore_radius", positive), table.choice("load", TUBE_LOADS)
        return None if bore is None or load is None else cls(bore, load)

    def check(self, radius: float) -> None:
        if is_above(self.bore_radius, (1.0 - THINNEST) * radius):
            limit = f"must be at most {(1.0 - THINNEST) * radius:g}, {1.0 - THINNEST:g} of the hole radius"
            raise InputError("bore_radius", f"{limit}, not {self.bore_radius:g}")

    def check_load(self, pin_load: PinLoad) -> None:
        if pin_load == "body":
            words = 'a hollow pin has its load in its own body, load = "body" of the tube; leave pin_load out'
            raise InputError("pin_load", words)

    def check_hub(self, radius: float) -> None:
        if is_above(self.bore_radius, radius):
            raise InputError("hub_radius", f"must be at least the bore radius {self.bore_radius:g}, not {radius:g}")

    def change(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        return rim.compliance * harmonics.tube(order, self.inner(rim), rim.kolosov, self.bore_kind)

    def wall(self, rim: Rim, tractions: Harmonics) -> Wall:
        bore, kolosov = max(self.inner(rim), 1e-30), rim.kolosov  # powers of a smaller bore are no numbers
        highest = harmonics.harmonics_needed(math.sqrt(bore))
        t = tractions(highest)
        n, q = np.arange(2.0, highest + 1.0), bore * bore
        found = Amplitudes.zero(highest)
        growing, (B, _) = free_at_contact(harmonics.tube(n, bore, kolosov, self.bore_kind), t[2:], kolosov)
        found.A[2:], found.C[2:] = growing
        found.B[2:] = B * bore**-n
        s = kolosov if self.held else -1.0
        # (n - 1) B - A cancels for a narrow bore: the condition at the bore gives D
        right = s * t[2:, 0] * bore**n / (n + 1.0) + (s + 1.0) * growing[0] * bore**n
        right -= (n - 1.0) * np.expm1(n * math.log(q)) * found.B[2:]
        found.D[2:] = right / -np.expm1((n + 1.0) * math.log(q))
        outward = (kolosov - 1.0) / (2.0 + (kolosov - 1.0) * q) if self.held else -1.0 / ((1.0 - bore) * (1.0 + bore))
        found.A[0], found.D[0] = -0.5 * q * outward * t[0, 0].real, outward * t[0, 0].real
        found.first[:] = first_change(self.first(rim, "centre"), harmonics.first(0.0, kolosov, "centre"), t[1])
        return found.wall(kolosov, bore, 1.0)

    def translation(self, rim: Rim, pin_load: PinLoad, hub: float | None) -> tuple[float, float]:
        first, bore = self.first(rim, pin_load), self.inner(rim)
        is_mean = hub is None and self.load == "body"
        of_traction, of_force = first.mean_translation(bore) if is_mean else first.translation(hub or bore)
        return of_force * rim.compliance, -of_traction * rim.compliance

    def load_words(self, pin_load: PinLoad) -> str:
        others = {"held": "force on a rigid core in the bore", "body": "uniform body force"}
        return others.get(self.load, f"{self.load} traction in the bore")

    def rows(self, length: InWords, material: InWords) -> list[tuple[str, str]]:
        return [("pin body", f"hollow, bore radius {length(self.bore_radius)}")]

    def caption(self, pin_load: PinLoad, length: InWords) -> str:
        return f", bore radius {length(self.bore_radius)}"

    def drawing(self, rim: Rim) -> list[Shape]:
        return [Shape("circle", self.inner(rim), "bore")]

    def page_controls(self, radius: float) -> list[Control]:
        return [*super().page_controls(radius), Control("bore_load", self.load, choices=TUBE_LOADS)]


class SeatedBush(Tube):
    """A bush as the pin of its seat. Its stress also depends on the tractions in its bore, which the seat lacks."""

    is_bush = True
