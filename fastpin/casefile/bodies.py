"""The bodies of a case file: [pin_body] and [plate_body]. Each body reads its own keys.

A body whose keys are wrong is reported and replaced by a solid pin or an infinite plate, so that the rest is still
checked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from fastpin.bodies.body import BodyBase, PinBody, PlateBody
from fastpin.bodies.kinds import INFINITE_PLATE, PINS, PLATES, SOLID_PIN
from fastpin.casefile.materials import read_material
from fastpin.casefile.toml_text import CaseText, Section
from fastpin.errors import InputError
from fastpin.model.checks import choice
from fastpin.model.materials import Material, MaterialPair

B = TypeVar("B", bound=BodyBase)

Kinds = Mapping[str, type[BodyBase]]
"""The kinds of body of a section, by name."""

BODY_KINDS: dict[str, Kinds] = {"pin_body": PINS, "plate_body": PLATES}
"""The kinds of body of each section."""


class BodySection(Section):
    """A `section` as that of a body. Relative paths in it start in `folder`; `materials` are those with a name."""

    def __init__(self, source: CaseText, section: Section, folder: Path, materials: Mapping[str, Material]) -> None:
        super().__init__(source, (section.name,), section.table, section.present)
        self.folder, self._source, self._section, self._materials = folder, source, section, materials

    def report(self, message: str, *key: str) -> None:
        self._section.report(message, *key)

    def material(self) -> Material | None:
        """The material of a bush. None if it can't be used. The reason is reported."""
        material = read_material(self._source, self, self._materials, may_be_rigid=False)
        if (
            "material" in self
            and "dundurs" in self._source.root
            and "load_parameter" in self._source.section("contact")
        ):
            words = "with [dundurs] and load_parameter the moduli count in units of 1/beta* of pin and plate"
            self.report(f"material: {words}; give E and nu of the bush", "material")
            return None
        return material

    def passes(self, check: Callable[[], None], names: Mapping[str, str] | None = None) -> bool:
        """Whether a check passes; else its fault is reported. `names` are the keys of fields with other names."""
        try:
            check()
        except InputError as error:
            key = (names or {}).get(error.field, error.field)
            self.report(f"{key}: {error.reason}", key)
            return False
        return True

    def body(self, kinds: Mapping[str, type[B]]) -> B | None:
        """Read the body. None if it is wrong. Keys of other kinds are reported."""
        kind = self.checked("kind", choice, tuple(kinds)) if "kind" in self else implied_kind(kinds, self.table)
        if kind is None:
            return None
        for key in self.table:
            owners = [f'"{name}"' for name, made in kinds.items() if key in made.keys]
            if owners and f'"{kind}"' not in owners:
                self.report(f'{key}: belongs to kind = {" or ".join(owners)}, not to kind = "{kind}"', key)
        return kinds[kind].read(self)


def keys_of(kinds: Kinds) -> tuple[str, ...]:
    """All keys of a section with these kinds of body."""
    return tuple(dict.fromkeys(["kind", *(key for made in kinds.values() for key in made.keys)]))


def implied_kind(kinds: Kinds, table: Mapping[str, Any]) -> str:
    """The kind of body that the keys of a table tell: the first kind that has most of them."""
    return max(kinds, key=lambda kind: len(table.keys() & kinds[kind].keys))


def read_bodies(
    source: CaseText, folder: Path, radius: float | None, pair: MaterialPair | None, materials: Mapping[str, Material]
) -> dict[str, PinBody | PlateBody]:
    """Read the bodies of a case.

    Parameters
    ----------
    source : CaseText
        The text of the case file. All faults of the bodies are reported to it.
    folder : Path
        Folder in which the relative path of a compliance starts.
    radius : float or None
        Radius of the hole. None if it is unknown; the bodies are then a solid pin and an infinite plate.
    pair : MaterialPair or None
        Materials of pin and plate. None if they are unknown; a compliance is then an infinite plate.
    materials : mapping of str to Material
        The materials with a name, for a bush.

    Returns
    -------
    dict
        The arguments ``pin_body`` and ``plate_body`` of a :class:`Problem`.
    """
    pin: PinBody = SOLID_PIN
    plate: PlateBody = INFINITE_PLATE
    if source.root.table.keys() & BODY_KINDS:
        pins, plates = (BodySection(source, source.section(name), folder, materials) for name in BODY_KINDS)
        read_pin, read_plate = pins.body(PINS) or SOLID_PIN, plates.body(PLATES) or INFINITE_PLATE
        if radius is not None:
            whole = "load_parameter" in source.section("contact")
            pin = read_pin if pins.passes(partial(read_pin.check, radius)) else SOLID_PIN
            plate = read_plate.fitted(plates, radius, whole, pair) or INFINITE_PLATE
    return {"pin_body": pin, "plate_body": plate}
