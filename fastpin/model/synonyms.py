"""Words that users write for the names of fastpin, and hints at the names that are meant.

Case files, plans, the command line and the keywords of Python classes take their hints from here. Nothing heavy is
imported: wrong options of the command line are answered without NumPy.
"""

from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from fastpin.model.fields import FIELDS

T = TypeVar("T")

_SYNONYMS: dict[str, str] = {
    # materials
    "E": "young youngs_modulus young_s_modulus young_modulus modulus elastic_modulus e_modulus emod stiffness",
    "nu": "v poisson poissons_ratio poisson_s_ratio poisson_ratio",
    "yield_strength": "yield yield_stress yield_point sigma_y sy fy rp02 rp0_2 re proof_stress",
    "ultimate_strength": "ultimate ultimate_stress uts tensile_strength sigma_u su fu ftu rm breaking_strength",
    "expansion": "alpha cte thermal_expansion expansion_coefficient coefficient_of_thermal_expansion",
    "material": "mat alloy",
    "rigid": "is_rigid stiff",
    "fatigue": "fatigue_constants",
    "growth": "crack_growth growth_law growth_constants da_dn dadn paris walker nasgro",
    "fatigue_strength": "sigma_f sf sf_prime",
    "fatigue_ductility": "epsilon_f ef ef_prime",
    "strength_exponent": "b basquin_exponent",
    "ductility_exponent": "c coffin_manson_exponent",
    "layup": "stacking stacking_sequence stack lay_up sequence laminate plies angles",
    "ply": "lamina layer prepreg ply_material",
    "E1": "ex e_x e11 e_11 e_1 longitudinal_modulus",
    "E2": "ey e_y e22 e_22 e_2 transverse_modulus",
    "G12": "gxy g_xy g_12 shear_modulus_12 in_plane_shear_modulus",
    "nu12": "nuxy nu_xy nu_12 v12 v_12 poisson_12 major_poisson_ratio",
    "compliance": "compliances a_matrix",
    "Xt": "xt f1t longitudinal_tensile_strength",
    "Xc": "xc f1c longitudinal_compressive_strength",
    "Yt": "yt f2t transverse_tensile_strength",
    "Yc": "yc f2c transverse_compressive_strength",
    "S": "s12 sl f6 f12 in_plane_shear_strength",
    "pin": "pin_material disk disc",
    "plate": "plate_material lug_material",
    # contact
    **{name: field.also for name, field in FIELDS.items() if field.also},
    "load_parameter": "lp l_p",
    "plane": "state plane_state stress_state",
    "bore_radius": "radius inner_radius r_i ri bore r_bore hollow",
    "outer_radius": "radius r_o ro r_outer rim_radius",
    # loads
    "P": "load force f vertical_force pin_force pin_load normal_force n bearing_load",
    "Q": "fx f_x h horizontal_force tangential_force shear_force",
    "M": "moment torque mz m_z",
    "sxx": "sigma sigma_x sigma_xx stress remote_stress bypass bypass_stress s_xx sx",
    "syy": "sigma_y sigma_yy s_yy sy",
    "sxy": "tau tau_xy sigma_xy shear_stress s_xy txy",
    "ux": "u u_x dx displacement_x displacement",
    "uy": "v u_y dy displacement_y",
    "units": "unit system unit_system unitsystem unit_sys",
    "repeat": "cycles n_cycles count times number_of_cycles repeats",
    "points": "n_points steps",
    "phase": "phi phase_angle lag",
    "amplitude": "amp range",
    "csv": "file filename path spectrum",
    "skip": "skiprows skip_rows skip_lines header header_lines",
    # solver
    "nodes": "n n_nodes num_nodes number_of_nodes mesh elements resolution points",
    "increments": "steps n_steps n_increments substeps load_steps",
    "method": "solver algorithm",
    "keep": "store save_states output",
    "between": "intermediate substates",
    "error_bars": "errors uncertainty",
    "arc": "angles window",
    "solve": "options settings numerics",
    "load": "loads loading forces step steps",
    "contact": "geometry problem joint hole interface",
    "history": "loadhistory load_history",
    # profiles along the rim
    "ellipse": "oval ovality elliptic elliptical",
    "lobes": "lobe lobing polygon waves",
    "harmonic": "wave fourier order",
    "flat": "chord flattening flattened",
    "crown": "crowning bump bulge",
    "zone": "region patch coating sector",
    "constant": "uniform value",
    "angles": "samples points theta",
    "axis": "direction orientation",
    "centre": "center middle",
    "half_width": "width",
    "plate_body": "lug ring bush bushing",
    "pin_body": "tube hollow_pin",
    "title": "name description",
    "materials": "material_file materials_file library",
    # attributes of results and states
    "peak_pressure": "max_pressure maximum_pressure p_max pmax contact_pressure",
    "peak_shear": "max_shear maximum_shear q_max",
    "peak_hoop_stress": "hoop hoop_stress max_hoop peak_hoop kt",
    "dissipation": "dissipated energy_loss friction_work",
    # options of the command line
    "workers": "jobs n_jobs processes threads cores",
    "run": "solve calculate compute execute simulate start",
    "output": "out save to",
    "plot": "figure fig picture",
    "table": "results",
}
"""Other words for each name, in lower case. A word may belong to several names; the names that are allowed decide."""

_NOTES: dict[str, tuple[str, str]] = {
    "diameter": ("hole_radius", "hole_radius is half of it"),
    "d": ("hole_radius", "hole_radius is half of the diameter"),
    "hole_diameter": ("hole_radius", "hole_radius is half of it"),
    "pin_radius": ("clearance", "clearance is the hole radius minus the pin radius"),
    "r_pin": ("clearance", "clearance is the hole radius minus the pin radius"),
    "pin_diameter": ("clearance", "clearance is the hole radius minus the pin radius"),
    "diametral_clearance": ("clearance", "clearance is half of it: hole radius minus pin radius"),
    "diametrical_clearance": ("clearance", "clearance is half of it: hole radius minus pin radius"),
    "interference": ("clearance", "a negative clearance is an interference fit"),
    "interference_fit": ("clearance", "a negative clearance is an interference fit"),
    "bore_diameter": ("bore_radius", "bore_radius is half of it"),
    "inner_diameter": ("bore_radius", "bore_radius is half of it"),
    "outer_diameter": ("outer_radius", "outer_radius is half of it"),
    "hub_diameter": ("hub_radius", "hub_radius is half of it"),
    "g": ("E", "with the shear modulus G, E is 2 G (1 + nu)"),
    "shear_modulus": ("E", "with the shear modulus G, E is 2 G (1 + nu)"),
    "fy": ("P", "P is the force downwards: the opposite of a force along +y"),
    "f_y": ("P", "P is the force downwards: the opposite of a force along +y"),
    "plane_strain": ("plane", 'write plane = "strain"'),
    "plane_stress": ("plane", 'write plane = "stress"'),
}
"""Words whose value must be changed to give a name: the name, and how."""

_VALUES: dict[str, str] = {
    "path": "exact event_driven",
    "increment": "incremental steps",
    "spring": "elastic",
    "fixed": "held clamped none",
    "free": "frictionless released",
    "centre": "center point concentrated",
    "body": "body_force distributed",
    "held": "fixed clamped rigid core",
    "smith-watson-topper": "swt smith_watson_topper",
    "fatemi-socie": "fs fatemi_socie",
    "plate": "lug sheet",
    "pin": "bolt rivet shaft fastener",
    "bush": "bushing sleeve liner",
    "aluminium": "aluminum al alu",
    "Ti-6Al-4V": "titanium titan ti64 ti6al4v ti_6_4 grade_5",
    "2024-T3": "2024 al2024 aa2024",
    "7075-T6": "7075 al7075 aa7075",
    "SAE 1020": "1020 aisi_1020",
    "4340 normalized": "4340 aisi_4340",
    "304": "aisi_304 304l stainless stainless_steel 1_4301",
    "316": "aisi_316 316l 1_4401",
    "17-4PH H900": "17_4 17_4ph 17_4_ph 1_4542",
    "Inconel 718": "718 in718 inconel",
    "nickel alloy": "nickel",
    "C93200": "bronze sae_660 bearing_bronze",
}
"""Other words for the words that a value may be."""


def _by_word(names: dict[str, str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, words in names.items():
        for word in words.split():
            found.setdefault(word, []).append(name)
    return found


_MEANT = _by_word(_SYNONYMS)
for _word, _names in _by_word(_VALUES).items():
    _MEANT.setdefault(_word, []).extend(_names)


def closest(word: str, known: Iterable[str], spelling: bool = True) -> str:
    """Return a hint at the known name that `word` means; empty if there is none.

    A name that is spelt nearly so counts only with `spelling`.
    """
    names = tuple(known)
    written = _plain(word)
    if written in _NOTES and _NOTES[written][0] in names:
        return f"; {_NOTES[written][1]}"
    found = meant_name(word, names, spelling)
    return "" if found is None else f', did you mean "{found}"?'


def meant_name(word: str, known: Iterable[str], spelling: bool = True) -> str | None:
    """Return the known name that `word` means, or None. A name that is spelt nearly so counts only with `spelling`."""
    lower = {name.lower(): name for name in known}
    names = lower.values()
    found = lower.get(word.lower()) or next((name for name in _MEANT.get(_plain(word), ()) if name in names), None)
    if found is None and spelling:
        found = next((lower[near] for near in difflib.get_close_matches(word.lower(), lower, n=1)), None)
    return found


def meant(word: str) -> list[str]:
    """Return all names that `word` may mean, wherever they belong. A name means itself first."""
    written = _plain(word)
    if written in _NOTES:
        return [_NOTES[written][0]]
    return [name for name in (word, word.upper()) if name in _SYNONYMS] + _MEANT.get(written, [])


def _plain(word: str) -> str:
    """A word in lower case, with underscores for all signs between its parts."""
    return re.sub(r"[^a-z0-9]+", "_", word.lower()).strip("_")


_KEYWORDS: dict[str, tuple[str, ...]] = {}
"""Names of the parameters of all classes and functions that explain their keywords."""


def explains_keywords(made: T) -> T:
    """Make a class or function name the meant keyword in the :class:`TypeError` of an unknown one."""
    function: Any = getattr(made, "__init__") if isinstance(made, type) else made  # noqa: B009 - for mypy
    name, code = made.__name__, function.__code__  # type: ignore[attr-defined]
    known = frozenset(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])
    _KEYWORDS[name] = tuple(word for word in code.co_varnames if word in known - {"self", "cls"})

    @functools.wraps(function)
    def explaining(*arguments: Any, **keywords: Any) -> Any:
        for word in keywords:
            if word not in known:
                raise unknown_keyword(name, word, _KEYWORDS[name])
        return function(*arguments, **keywords)

    if isinstance(made, type):
        setattr(made, "__init__", explaining)  # noqa: B010 - for mypy
        return made
    return explaining  # type: ignore[return-value]


def explains_attributes(of: str = "", others: Callable[[], type] | None = None) -> Callable[[type[T]], type[T]]:
    """Make a class name the meant attribute in the :class:`AttributeError` of an unknown one.

    Parameters
    ----------
    of : str
        How an object of another class is had, whose attributes users may look for here, such as ``result[-1]``.
    others : callable
        ``others()`` gives this class.
    """

    def public(made: type) -> list[str]:
        names = {*dir(made), *getattr(made, "__dataclass_fields__", ())}
        return sorted(name for name in names if not name.startswith("_"))

    def explained(made: type[T]) -> type[T]:
        def missing(self: T, name: str) -> Any:
            words = f"{made.__name__!r} object has no attribute {name!r}"
            if name.startswith("_"):
                raise AttributeError(words)
            found, owner = meant_name(name, public(made)), ""
            if found is None and others is not None:
                found, owner = meant_name(name, public(others())), f"{of}."
            raise AttributeError(words if found is None else f"{words}, did you mean {owner}{found}?")

        made.__getattr__ = missing  # type: ignore[attr-defined]
        return made

    return explained


def unknown_keyword(function: str, word: str, known: Iterable[str]) -> TypeError:
    """Return the error of a keyword that a function does not know, with a hint at the keyword that is meant."""
    hint = closest(word, known)
    if not hint:
        owners = {owner: name for name in meant(word) for owner, names in _KEYWORDS.items() if name in names}
        usual = ("Problem", "Material", "MaterialPair", "SolveOptions")  # most cases need them
        first = next((owner for owner in (*usual, *owners) if owner in owners), None)
        hint = f", did you mean {owners[first]} of {first}?" if first else ""
    return TypeError(f"{function}() got an unexpected keyword argument {word!r}{hint}")
