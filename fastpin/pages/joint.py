"""The page of a joint of several pins: shares, holes, margins, and the contact of one pin in one plate."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.assess.outputs import MAX_ROWS, PERCENT, Column, number_column
from fastpin.casefile.toml_text import read_text
from fastpin.cracks import Growth
from fastpin.errors import CaseFileError, InputError
from fastpin.figures.fatigue import crack_growth_of
from fastpin.figures.joint import displacement_of, joint_of, share_bars_of, shares_of
from fastpin.figures.joint_sketch import joint_sketch_of
from fastpin.joints import JointFile, JointResult, parse_joint
from fastpin.joints.document import document_of
from fastpin.joints.pins import BEAM
from fastpin.joints.solving import load_values
from fastpin.model import ties
from fastpin.model.case import About
from fastpin.model.checks import file_path
from fastpin.model.doubts import pressure_doubts
from fastpin.model.units import PLAIN
from fastpin.pages import sections
from fastpin.pages.content import Album, Facts, Items, Listing, Page, PageSection, SectionPart, Table, Text
from fastpin.pages.source import PageParts, Source, merged, now, origin_of, sentence
from fastpin.pages.writing import write_sections
from fastpin.report import joints as report
from fastpin.solver.configuration import MAX_RESIDUAL
from fastpin.states.margins import over_yield_words
from fastpin.storage.holes import HeldHole
from fastpin.storage.joint_files import case_of
from fastpin.storage.joint_files import joint_of as result_of
from fastpin.storage.stored import StoredResult
from fastpin.studies.joint_outcomes import QUANTITIES, largest_load
from fastpin.version import __version__

MOST_DOUBTS = 5
"""Most holes whose doubts are written out."""

RESIDUALS = sections.RESIDUAL_WORDS | {"bodies": "equilibrium of every pin and plate, in parts of the largest force"}
"""Words for the residuals of a state of a joint."""


@dataclass(frozen=True, eq=False)
class JointSource:
    """A joint for a page, and what its sections share.

    Attributes
    ----------
    case : JointFile
    result : JointResult
    origin : list of (str, str)
        Where the result comes from: names and values.
    path : Path or None
        The file.
    error : str or None
        Why the history ended early.
    case_text : str
        The text of the joint file; empty if it is not known.
    about : About
    hole : (str, str) or None
        Names of the pin and the plate whose contact is shown.
    album : Album
    """

    case: JointFile
    result: JointResult
    origin: list[tuple[str, str]]
    path: Path | None = None
    error: str | None = None
    case_text: str = field(default="", repr=False)
    about: About = field(default_factory=About)
    hole: tuple[str, str] | None = None
    album: Album = field(default_factory=Album)

    @classmethod
    def of(cls, shown: StoredResult | JointResult, file: str | Path | None) -> JointSource:
        """Return a joint in a file or in memory, with the text of its joint `file`.

        Of a stored joint it is the file beside it with its name, unless given. One in memory is judged as it says.
        """
        if isinstance(shown, JointResult):
            return cls._of_result(shown, file)
        found = cls(case_of(shown), result_of(shown), origin_of(shown), shown.path, shown.error)
        if file is not None:
            return replace(found, case_text=_same_file(found.case, file)[1])
        with contextlib.suppress(InputError, CaseFileError):  # the file is another joint, or none
            found = replace(found, case_text=_same_file(found.case, shown.path.with_suffix(".toml"))[1])
        return found

    @classmethod
    def _of_result(cls, result: JointResult, file: str | Path | None) -> JointSource:
        corners = [{name: state.load[name] for name in result.joint.given_names} for state in result.states.bare]
        case, text = JointFile(result.joint, corners, nodes=result.nodes), ""
        if file is not None:
            case, text = _same_file(case._replace(harmonics=None), file)
        return cls(case, result, origin_of(None), case_text=text)

    def named(self, title: str, about: About | None) -> JointSource:
        """The same with another title and other persons, as far as they are given."""
        return replace(self, case=self.case._replace(title=title or self.case.title), about=merged(self.about, about))

    @property
    def is_complete(self) -> bool:
        """Whether the history has come to its end."""
        return len(self.result) == len(self.case.corners)

    @cached_property
    def judged(self) -> report.Judged:
        """Margins, fatigue and crack."""
        return report.judged(self.result, self.case.fatigue, self.is_complete, None, self.case.crack)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """What is largest at each pin in each plate; empty without a state."""
        names = [(pin.name, plate.name) for pin, plate in self.joint.sections]
        return [row for row in self.interfaces if (row["pin"], row["plate"]) in names]

    @cached_property
    def interfaces(self) -> list[dict[str, Any]]:
        """The same, also at each bush in its plate."""
        return report.contact_rows(self.result)

    @property
    def joint(self) -> Any:
        """The joint."""
        return self.result.joint

    @cached_property
    def worst(self) -> dict[str, Any]:
        """The row with the largest hoop stress."""
        return self.rows[ties.top([row["hoop"] for row in self.rows])]

    @cached_property
    def chosen(self) -> PageParts:
        """The contact that is shown, as the parts of the page of one pin."""
        pin, plate = self.hole or (self.worst["pin"], self.worst["plate"])
        held = HeldHole(self.case, self.result, pin, plate, path=self.path)
        return PageParts(Source(held.case, held, self.origin), self.album)

    @property
    def hole_words(self) -> str:
        """The pin and the plate that are shown."""
        return " in ".join(self.hole or (self.worst["pin"], self.worst["plate"]))


def write_joint(source: JointSource, path: Path, progress: Callable[[float, float], None] | None = None) -> None:
    """Write the page of a joint, see :func:`fastpin.pages.write_report`."""
    if source.hole is not None:
        source.joint.place(*source.hole)
    lead = "Load shares and frictional contact of elastic pins in the holes of elastic plates."
    made = f"Made by fastpin {__version__} on {now()}."
    page = Page(source.case.title or "Report of a joint", lead, [], made, source.about)
    makers = [make for make in SECTIONS if source.rows or make in WITHOUT_STATES]
    left_out = [fatigue] * (source.case.fatigue is None) + [crack] * (source.case.crack is None)
    write_sections([make for make in makers if make not in left_out], source, page, path, progress, source.path)


def _same_file(case: JointFile, path: str | Path) -> tuple[JointFile, str]:
    """Read a joint file, which must have the joint and the loads of a result; return it with its text."""
    file = file_path("case", path)
    text = read_text(file)
    given = parse_joint(text, str(file))
    same = {
        "joint": given.joint == case.joint,
        "loads": given.joint == case.joint
        and np.array_equal(load_values(case.joint, case.corners), load_values(case.joint, given.corners)),
    }
    for name, is_same in same.items():
        if not is_same:
            raise InputError("case", f"{file} is not the joint file of this result: {name} differs")
    return given, text


def overview(source: JointSource) -> PageSection:
    """Return the most important sentences on the joint."""
    result, case = source.result, source.case
    reached, corners = len(result), len(case.corners)
    status = Text(f"Complete: {'the only load point' if corners == 1 else f'all {corners:,} load points'} solved.")
    if not source.is_complete:
        why = f" The reason: {source.error}." if source.error else ""
        how = f" Continue with: fastpin joint --resume {source.path}." if source.path is not None else ""
        status = Text(f"Unfinished: {reached:,} of {corners:,} load points.{why}{how}", "note")
    parts: list[SectionPart] = [status, *_warnings(source)]
    parts += [Text(f"Note: {line}", "note") for line in report.remarks(source.judged)]
    if source.rows:
        parts.append(Items([sentence(line) for line in _sentences(source)]))
    parts.append(Text(f"{sections.ANGLES} Shares are parts of the force of all pins on a plate, without friction."))
    return PageSection("overview", "Overview", parts)


def _warnings(source: JointSource) -> list[Text]:
    """Return doubts about pressures and stresses, of the first holes that have some."""
    found = []
    for pin, plate in source.joint.sections if source.rows else ():
        kept = HeldHole(source.case, source.result, pin.name, plate.name)
        doubts = pressure_doubts(kept.case.problem, kept.case.history, [np.array([kept.pressure])])
        over = source.judged.over.get((pin.name, plate.name), {})
        yields = [over_yield_words(over, owner).removeprefix("; above yield: ") for owner in over]
        words = [str(doubt) for doubt in doubts] or [f"{each}, and fastpin is elastic" for each in yields]
        found += [Text(f"Warning: {pin.name} in {plate.name}: {each}.", "note") for each in words]
    more = [Text(f"Warning: {len(found) - MOST_DOUBTS} more of this kind.", "note")] * (len(found) > MOST_DOUBTS)
    return found[:MOST_DOUBTS] + more


def _sentences(source: JointSource) -> list[str]:
    """What is largest in the joint, the least margin, the shortest life, and the crack."""
    unit, rows, judged = report.joint_units(source.joint), source.rows, source.judged
    force = max(rows, key=lambda row: abs(row["force"]))
    peak, worst = max(rows, key=lambda row: row["pressure"]), source.worst
    mark = "" if worst["resolved"] else report.UNRESOLVED
    lines = [
        f"largest force of a pin: {unit['force'].text(abs(force['force']), 5)}, {force['pin']} on {force['plate']}",
        f"largest contact pressure: {unit['traction'].text(peak['pressure'], 5)}, {peak['pin']} in {peak['plate']}",
        f"largest hoop stress: {unit['traction'].text(worst['hoop'], 5)}{mark}, {worst['pin']} in {worst['plate']}, "
        f"load point {worst['hoop_step']:,}",
    ]
    known = report.margin_cells(judged)
    lines += [f"smallest margin: {known[0][2]}, {known[0][0]}, {known[0][3]}"] if known else []
    if judged.how is not None:
        cells = report.fatigue_cells(judged, judged.how)
        lines.append(f"shortest life: {', '.join(filter(None, cells[0]))}" if cells else f"fatigue: {judged.reason}")
    return [*lines, *report.crack_lines(judged)[1:]]


def case(source: JointSource) -> PageSection:
    """Return plates, pins, materials and options."""
    joint, unit = source.joint, report.joint_units(source.joint)
    length = unit["length"]
    rows = []
    for plate in joint.plates:
        held = ", ".join(f"{part} ({how})" for part, how in plate.supports.items()) or "no supports"
        way = {"": "", "free": "; floats between its pins"}.get(plate.moves, f"; moves along {plate.moves}")
        edge = "infinite"
        if not plate.is_infinite:
            points = np.concatenate([part.at(np.linspace(0.0, 1.0, 33)) for part in plate.outline])
            edge = " by ".join(length.text(float(np.ptp(each))) for each in (points.real, points.imag))
        sliced = f"; {plate.slices} slices" if plate.slices > 1 else ""
        of = f"{plate.material.label or 'a material without a name'}, {length.text(plate.thickness)} thick"
        rows.append((plate.name, of, f"outline within {edge}; {held}{way}{sliced}" if not plate.is_infinite else edge))
    plates = Facts("Plates", rows, ("plate", "material", "shape"))
    rows, (factor, label) = [], length.scale([abs(pin.at) for pin in joint.pins])
    for pin in joint.pins:
        at = f"{factor * pin.at.real:.6g}, {factor * pin.at.imag:.6g} {label}"
        fits = ", ".join(
            f"{name}: clearance {unit['displacement'].text(pin.value_in('clearance', name), 5)}, "
            f"friction {pin.value_in('friction', name):.4g}{_bush_words(pin.bush_in(name), unit)}"
            + "".join(
                f", {of} profile {each.words(unit['displacement'].text)}" for of, each in pin.gap_in(name).given.items()
            )
            for name in pin.plates
        )
        soft = "" if pin.flexibility in (0.0, BEAM) else f"; flexibility {unit['flexibility'].text(pin.flexibility, 4)}"
        soft = "; a beam" if pin.flexibility == BEAM else soft
        clamp = pin.clamp
        tight = "" if clamp is None else f"; clamp {unit['force'].text(clamp.force, 5)}, friction {clamp.friction:.4g}"
        bore = f", bore radius {length.text(pin.bore_radius)}" if pin.bore_radius else ""
        rows.append((pin.name, f"{pin.material.label or 'no name'}{bore}, at {at}", f"{fits}{soft}{tight}"))
    wide = ", ".join(dict.fromkeys(length.text(2.0 * joint.radius_in(plate)) for plate in joint.plates))
    pins = Facts(f"Pins, holes {wide} wide", rows, ("pin", "material and place", "fit"))
    orders = ", ".join(dict.fromkeys(map(str, source.result.harmonics)))
    options = [("plane", joint.plane), ("nodes of each contact", f"{source.result.nodes}"), ("harmonics", orders)]
    sketch = source.album.figure(joint_sketch_of(source.result))
    facts = [plates, pins, _materials(source), Facts("Options", options, ("option", "value"))]
    return PageSection("case", "Joint", [sketch, *facts])


def _bush_words(bush: Any, unit: Any) -> str:
    """Words for a bush; empty without one."""
    if bush is None:
        return ""
    fit, size = unit["displacement"].text(bush.interference, 5), unit["length"].text(bush.outer_radius)
    held = "bonded" if bush.bonded else f"friction {bush.friction:.4g} in the plate"
    return f", bush of {bush.material.label or 'no name'} to radius {size}, interference {fit}, {held}"


def _materials(source: JointSource) -> Facts:
    """The constants of all materials."""
    unit = report.joint_units(source.joint)
    found: dict[Any, list[str]] = {}
    for owner in (*source.joint.plates, *source.joint.pins):
        found.setdefault(owner.material, []).append(owner.name)
    for pin in source.joint.pins:
        for bush in filter(None, map(pin.bush_in, pin.plates)):
            if (name := f"bush of {pin.name}") not in found.setdefault(bush.material, []):
                found[bush.material].append(name)
    rows = []
    for material, owners in found.items():
        yields = material.known_yield_strength
        given = {} if material.fatigue is None else material.fatigue.given()
        strength = "yield strength not known" if yields is None else f"yield strength {unit['modulus'].text(yields, 5)}"
        life = f"; fatigue constants: {given.get('source', 'given')}" if given else "; no fatigue constants"
        of = f"E {unit['modulus'].text(material.E, 5)}, nu {material.nu:.5g}; {strength}{life}"
        rows.append((material.label or "no name", ", ".join(owners), of))
    return Facts("Materials", rows, ("material", "of", "constants"))


def _cut(caption: str, columns: Sequence[Column]) -> Table:
    """A table of the load points, perhaps without its middle."""
    count, half = len(columns[0][2]), MAX_ROWS // 2
    if count <= MAX_ROWS:
        return Table(caption, columns)
    kept: list[Column] = [(name, unit, [*cells[:half], *cells[-half:]]) for name, unit, cells in columns]
    return Table(caption, kept, {half: f"{count - MAX_ROWS:,} load points not shown here"})


def shares(source: JointSource) -> PageSection:
    """Return who carries how much at each load point, with the first touches, and the friction of clamped plates."""
    result, album = source.result, source.album
    parts = sections.drawn_or_reason(lambda: album.figure(share_bars_of(result)))
    parts.append(_cut("Shares of the pins, and where they touch first", _share_columns(source)))
    parts.append(album.figure(shares_of(result)))
    forces = [column for column in report.forces_columns(result) if column[0] != "share"]
    parts.append(_cut("Loads, displacements and forces of the pins", forces))
    if source.joint.faying:
        columns = report.faying_columns(result)
        parts.append(Table("Faying surfaces of clamped plates: the largest of all load points", columns))
    if bent := report.bending_rows(result):
        columns = report.bending_columns(source.joint, bent)
        parts.append(Table("Bending of the pins: the largest of all load points", columns))
    return PageSection("shares", "Load shares", parts)


def _share_columns(source: JointSource) -> list[Column]:
    """The share of each pin in each plate that has other shares than the plates before, and the first touches."""
    result, columns, seen = source.result, list[Column](), list[np.ndarray]()
    columns.append(("load point", "", [str(state.step + 1) for state in result.states.bare]))
    for plate in source.joint.plates:
        found = result.shares(plate.name)
        values = np.array([*found.values()])
        if len(found) < 2 or any(
            one.shape == values.shape and np.allclose(one, values, 0.0, 1e-3, equal_nan=True) for one in seen
        ):
            continue
        seen.append(values)
        for pin, row in found.items():
            cells = ["-" if math.isnan(share) else f"{100.0 * share:.3g}" for share in row]
            columns.append((pin, f"% of {plate.name}", cells))
    touches: dict[int, list[str]] = {}
    for (pin, plate), step in result.first_touches.items():
        touches.setdefault(step, []).append(f"{pin} {plate}")
    cells = [", ".join(touches.get(state.step, ["-"])) for state in result.states.bare]
    return [*columns, ("first touch", "", cells)]


def holes(source: JointSource) -> PageSection:
    """Return the map of all holes at the largest hoop stress, and tables of all pins in all plates."""
    result, step = source.result, source.worst["hoop_step"]
    largest = report.largest_columns(source.joint, source.interfaces)
    parts: list[SectionPart] = [source.album.figure(joint_of(result, step - 1))]
    parts.append(Table("Largest of all load points at each pin in each plate", largest))
    unit, at = report.joint_units(source.joint), [(row["pin"], row["plate"]) for row in source.rows]
    points = {plate: largest_load(result, plate) for _, plate in at}
    columns: list[Column] = [("pin", "", [pin for pin, _ in at]), ("plate", "", [plate for _, plate in at])]
    columns.append(("load point", "", [f"{points[plate] + 1:,}" for _, plate in at]))
    states = {place: result[place] for place in set(points.values())}
    for name in ("share", "bypass", "kt_gross", "kt_net"):
        found = [QUANTITIES[name].of(states[points[plate]], pin, plate) for pin, plate in at]
        of_name = {"share": PERCENT, "bypass": unit["force"]}.get(name, PLAIN)
        name, label, cells = number_column(name.replace("kt_", "Kt "), found, of_name, ".4g")
        unsure = [name.startswith("Kt") and not row["resolved"] for row in source.rows]
        marks = [report.UNRESOLVED * (each and cell != "-") for each, cell in zip(unsure, cells, strict=True)]
        columns.append((name, label, [f"{a}{b}" for a, b in zip(cells, marks, strict=True)]))
    parts.append(Table("At the largest force of the pins on each plate", columns))
    words = (
        "Bypass is the force in the plate that passes the hole: that of the pins ahead. Kt is the largest hoop stress "
    )
    words += "over the stress by the force of all pins on the plate, gross or net; it needs an outline."
    return PageSection("holes", "Holes", [*parts, Text(words)])


def displacement(source: JointSource) -> PageSection:
    """Return the loads over the displacements of the plates, and the dissipation."""
    parts = sections.drawn_or_reason(lambda: source.album.figure(displacement_of(source.result)))
    lost = sum(row["dissipation"] for row in source.interfaces)
    rubbed = sum(surface.dissipation for surface in source.result.states.bare[-1].faying)
    energy = report.joint_units(source.joint)["energy"]
    words = f"Friction has dissipated {energy.text(lost, 5)} in the holes in all"
    words += f", and {energy.text(rubbed, 5)} between the plates." if source.joint.faying else "."
    return PageSection("displacement", "Load and displacement", [*parts, Text(words)])


def margins(source: JointSource) -> PageSection:
    """Return the known margins, the smallest first."""
    cells = report.margin_cells(source.judged)
    if not cells:
        words = "No margin is known: no material has a yield or an ultimate strength."
        return PageSection("margins", "Margins", [Text(words, "missing")])
    heads = ("subject", "value of allowable", "margin", "where")
    words = "Margins of safety over all load points: allowable/value - 1, near the holes and in the pins"
    return PageSection("margins", "Margins", [Facts(words, cells, heads)])


def fatigue(source: JointSource) -> PageSection:
    """Return lives and damages at all pins."""
    judged, how = source.judged, source.case.fatigue
    if judged.reason or how is None:
        return PageSection("fatigue", "Fatigue", [Text(f"Not known: {judged.reason}.", "missing")])
    words = report.fatigue_lines(judged)[1].removesuffix(":")
    heads = ("hole and criterion", "life", "damage", "where")
    caption = sentence(words).removesuffix(".")
    return PageSection("fatigue", "Fatigue", [Facts(caption, report.fatigue_cells(judged, how), heads)])


def crack(source: JointSource) -> PageSection:
    """Return what becomes of the crack."""
    growth = source.judged.growth
    _, line = report.crack_lines(source.judged)
    parts: list[SectionPart] = [Text(sentence(line), "plain" if isinstance(growth, Growth) else "missing")]
    if isinstance(growth, Growth):
        parts.append(source.album.figure(crack_growth_of(growth)))
        parts += [Text(sentence(f"Doubt: {doubt}")) for doubt in growth.doubts]
    return PageSection("crack", "Crack", parts)


def tractions(source: JointSource) -> PageSection:
    """Return tractions and quantities of the chosen contact."""
    found = sections.tractions(source.chosen)
    why = "chosen" if source.hole is not None else "the hole with the largest hoop stress"
    words = (
        f"This section and the next two show {source.hole_words}: {why}. fastpin report --pin NAME --plate NAME shows "
    )
    words += "another one, fastpin plot its figures."
    quantities = sections.key_figures(source.chosen).parts[1]
    return PageSection("tractions", f"{source.hole_words}: tractions", [Text(words), *found.parts, quantities])


def zones(source: JointSource) -> PageSection:
    """Return stick and slip of the chosen contact."""
    page = source.chosen
    parts = [*sections.zones(page).parts]
    if page.source.cycle is not None:
        parts += sections.slip_parts(page, page.source.cycle)
    return PageSection("zones", f"{source.hole_words}: stick and slip", parts)


def stresses(source: JointSource) -> PageSection:
    """Return the stresses round the chosen hole."""
    return replace(sections.stresses(source.chosen), title=f"{source.hole_words}: stresses")


def checks(source: JointSource) -> PageSection:
    """Return the residuals of all states, and what the solver tells."""
    states, parts = source.result.states.bare, list[SectionPart]()
    if states:
        largest = {name: max(state.residuals[name] for state in states) for name in states[0].residuals}
        rows = [
            (name, f"{value:.1e}", "met" if value <= MAX_RESIDUAL else "not met", RESIDUALS.get(name, ""))
            for name, value in largest.items()
        ]
        heads = ("condition", "largest violation", f"at most {MAX_RESIDUAL:g}", "meaning")
        words = f"Largest violations of the conditions of contact and equilibrium at {len(states):,} load points"
        parts.append(Facts(words, rows, heads))
    parts.append(Text(f"The solution took {source.result.seconds:.3g} s."))
    return PageSection("checks", "Checks", parts)


def provenance(source: JointSource) -> PageSection:
    """Return versions, place and time of the run, and its input."""
    parts: list[SectionPart] = [Facts("Origin", source.origin, ("subject", "value"))]
    if source.case_text:
        parts.append(Listing("Joint file", sections.shortened(source.case_text)))
    else:
        words = "The text of the joint file is not in a result file: fastpin report --case JOINT.toml shows it."
        parts.append(Text(words, "missing"))
    document = sections.shortened(json.dumps(document_of(source.joint), indent=1))
    parts.append(Listing("The joint (JSON, SI units)", document))
    return PageSection("provenance", "Versions and provenance", parts)


SECTIONS: Sequence[Callable[[JointSource], PageSection]] = (
    overview, shares, holes, displacement, margins, fatigue, crack, tractions, zones, stresses, case, checks,
    provenance,
)  # fmt: skip
"""All sections, in the order of the page."""

WITHOUT_STATES = (overview, case, checks, provenance)
"""The sections of a joint that has no state."""
