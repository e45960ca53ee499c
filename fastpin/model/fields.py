"""The fields of a problem, beside its materials and bodies: each is described once.

Case files, plans, ids, HDF5 files and JSON walk this list. :class:`fastpin.Problem` has an attribute of each name, with
its default and its check. Nothing heavy is imported: the hints of the command line need the other words.
"""

from __future__ import annotations

from typing import Literal, NamedTuple


class Field(NamedTuple):
    """A field of a problem.

    Attributes
    ----------
    kind : str
        Its kind of quantity, a key of :func:`fastpin.model.units.units`; empty for a word or a plain number.
    choices : tuple of str
        The words that it may be; empty for a number.
    is_optional : bool
        Whether it may be None.
    in_ids : {"always", "given", "never"}
        Whether it enters the id of a run: a later field does where it has another value than its default.
    words : str
        Its name on an axis; empty if the name of the field is made of words.
    also : str
        Other words that users write for its name, in lower case.
    is_profile : bool
        Whether it may be a profile along the rim instead of a number.
    place : {"[contact]", "section", "root"}
        Where it stands in a case file: a key of [contact], a section of its own with a profile along the rim for each
        key, or a key before the first section.
    """

    kind: str = ""
    choices: tuple[str, ...] = ()
    is_optional: bool = False
    in_ids: Literal["always", "given", "never"] = "always"
    words: str = ""
    also: str = ""
    is_profile: bool = False
    place: Literal["[contact]", "section", "root"] = "[contact]"


FIELDS = {
    "hole_radius": Field("length", also="r radius r_hole plate_radius a"),
    "clearance": Field("length", also="delta delta_r dr gap play radial_clearance initial_gap c"),
    "friction": Field(
        words="friction coefficient",
        also="mu cof f friction_coefficient coefficient_of_friction coulomb",
        is_profile=True,
    ),
    "pin_load": Field(choices=("centre", "body"), words="load of the pin", also="load_type loading load_model"),
    "rotation": Field(choices=("free", "fixed", "spring"), also="theta omega phi angle twist rotate pin_rotation"),
    "hub_radius": Field("length", is_optional=True, also="r_hub hub"),
    "hub_stiffness": Field(
        "stiffness",
        is_optional=True,
        in_ids="given",
        also="stiffness spring_stiffness k k_theta rotational_stiffness",
    ),
    "drive": Field(choices=("force", "ux", "uy", "both"), in_ids="given"),
    "gauge_radius": Field("length", is_optional=True, in_ids="given", also="r_gauge gauge"),
    "rig_stiffness": Field(
        "rig stiffness", is_optional=True, in_ids="given", also="series_stiffness machine_stiffness rig_spring k_rig"
    ),
    "thickness": Field("length", is_optional=True, in_ids="never", also="t h width plate_thickness depth b"),
    "gap": Field(
        "displacement",
        in_ids="given",
        words="initial gap",
        also="initial_gap profile profiles form ovality roundness initial_profile",
        place="section",
    ),
    "unit_system": Field(in_ids="never", place="root"),
}
"""The fields by name, in the order of case files."""
