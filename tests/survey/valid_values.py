"""Valid arguments for the calls of :mod:`tests.survey.calls`: objects of fastpin, and values by parameter."""

from __future__ import annotations

import contextlib
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import fastpin
from fastpin import (
    assess,
    bodies,
    casefile,
    charts,
    cracks,
    damage,
    joints,
    lugs,
    model,
    published,
    reading,
    report,
    sessions,
    studies,
    wear_lives,
)
from fastpin.assess.outputs import Curve
from fastpin.errors import FastpinError
from fastpin.model.loads import LOADS
from fastpin.studies.measured_loop import measured_loop
from scripts.inline import Inline

LEFT_OUT = object()
"""The valid value of a parameter that has a default."""

NODES = 31
"""Nodes of all results."""

PLAN = 'title = "Friction"\n[grid]\n"contact.friction" = [0.2, 0.4]\n"solve.nodes" = [31]\n'

TOLERANCES = 'case = "few.toml"\nsamples = 3\n[tolerances]\n"contact.friction" = { from = 0.2, to = 0.5 }\n'

LUG = (
    '[plate]\nnu = 0.3\nplane = "strain"\nhole_radius = 1.0\n[outline]\nshape = "rectangle"\nx = [-2.5, 2.5]\n'
    'y = [-2.5, 6.0]\n[[support]]\nparts = ["top"]\nhold = "both"\n'
)

MATRIX = np.diag(0.1 ** np.repeat([0.0, 0.0, 1.0, 4.0], [2, 4, 4, 4]))
"""The matrix of a compliance."""

JOINT = joints.parse_joint(joints.JOINT_EXAMPLE).joint
"""A joint of three pins in two straps."""

RUBBED = np.cos(np.linspace(0.0, 4.0 * np.pi, 81))
"""Displacement and force of a measured loop, in parts of their largest."""

HISTORY = [[[1.0, 0.5, 0.1, 0.2], [-1.0, 0.0, 0.3, 0.1]]]
"""A history of stresses of one point."""

PROBLEM_FIELDS = ("pair", "clearance", "friction", "rotation", "pin_body", "plate_body", "hole_radius", "thickness")

LOOK_FIELDS = ("path", "title", "width", "dpi", "ax")

KEYWORDS: dict[str, tuple[str, ...]] = {
    "LoadHistory.monotonic": ("P", "Q", "x"),
    "Session.change": PROBLEM_FIELDS,
    "SolveOptions.changed": ("nodes", "method", "arc", "between", "keep"),
    "Result.plot": LOOK_FIELDS,
    "WearResult.plot": LOOK_FIELDS,
    "Result.wear": ("coefficient", "law", "at", "tolerance", "output"),
    "WearResult.fatigue": ("theta", "depth", "constants"),
    "wear": ("nodes", "arc"),
    "Result.fatigue": ("points", "depth", "constants"),
    "Result.spectrum_damage": ("criterion", "body", "points", "depth", "constants", "straight", "small_cycles", "knee"),
    "FatigueAssessment.changed": ("criterion", "bodies", "method", "length", "angles", "small_cycles", "knee"),
    "Result.report": ("title", "about", "case", "convergence", "progress"),
    "Look.sheet": ("sharex",),
    "lookup": ("load_parameter", "friction", "alpha", "beta", "kolosov", "pin_load"),
    "record": ("nodes", "method", "arc", "between", "keep", "slip_sums"),
}
"""Keywords that are tried where a callable takes any."""


STRENGTHS = model.FatigueConstants(1e9, -0.1, 0.5, -0.6, 5e8, -0.1, 0.5, -0.6, bending_limit=2e8, torsion_limit=1.2e8)
"""Constants of fatigue for all criteria."""

NASGRO = cracks.Nasgro(1e-10, 3.0, 1.0, 1.0, 1e6, 1e8)
"""A law of growth."""

PLATE = fastpin.Material(72e9, 0.33, "aluminium", STRENGTHS, 4e8, 5e8, cracks.Walker(1e-10, 3.0))
"""A plate with constants of fatigue and of crack growth."""


PLY = model.PLIES["AS4/3501-6"]
"""A ply with strengths."""

LAMINATE = model.Laminate.from_layup("[0/45/-45/90]s", PLY)
"""A laminate of plies."""


PAIRED = joints.Joint(
    (joints.JointPlate("sheet", PLATE, 1.0),),
    tuple(
        joints.JointPin(name, at, fastpin.MATERIALS["steel"], 5e-3, ("sheet",), 1e-5, 0.3)
        for name, at in (("a", 0j), ("b", 0.02 + 0j))
    ),
)
"""A joint that is solved fast: two pins in an infinite plate."""


class Enough(FastpinError):  # noqa: N818 - no fault
    """The end of a call that would take long."""


def enough(done: float, total: float) -> None:
    """Progress of a long call, which ends it."""
    raise Enough("the call is valid")


def half(done: float, total: float) -> None:
    """Progress of a run, which ends it half-way."""
    if done > 0.5 * total:
        raise KeyboardInterrupt


class Valid:
    """Valid objects and arguments. It writes files that can be read into the present folder.

    Attributes
    ----------
    objects : dict of str to callable
        ``objects[name]()`` is a valid object of the class of this name, which the call may change.
    """

    def __init__(self) -> None:
        pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], PLATE)
        problem = fastpin.Problem.from_load_parameter(pair, 0.1, 0.4)
        history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(2)
        result = fastpin.solve(problem, history, nodes=NODES, between=1, slip_sums=True)
        state, cycle = result[-1], result.cycle()
        options = fastpin.SolveOptions(nodes=NODES)
        case = fastpin.Case(problem, history, options, "a case")
        session = fastpin.Session(problem, nodes=NODES)
        session.advance({"P": 1.0})
        session.advance({"Q": 0.1})
        session.undo()
        self._write_files(result, case)
        plan = studies.read_plan("plan.toml")
        studies.sweep.run(plan, "sweep", executor=Inline())
        shutil.copytree("sweep", "part")
        rows = studies.sweep.rows(plan, "sweep")
        limited = studies.read_tolerances("tolerances.toml")
        studies.sweep.run(limited.plan, "tolerances", executor=Inline())
        tolerance_rows = studies.sweep.rows(limited.plan, "tolerances")
        pressure = report.tolerances.tolerance_chart(limited, tolerance_rows, "largest_pressure")
        convergence = fastpin.converge(problem, history, (51, 61, 71))
        study = convergence.studies[0]
        fatigue = damage.fatigue(result, "smith-watson-topper")
        crack, law = cracks.Crack(-1.5), cracks.Walker(1e-10, 3.0)
        length = 0.01  # in radii
        planned = model.CrackGrowth(length, 2.0 * length, law, -1.5)
        grown = cracks.growth(result, crack, law, length, 2.0 * length)
        steel = fastpin.Problem(pair, 0.01, 1e-5, 0.4)
        cycle_in_newtons = fastpin.LoadHistory([{"P": 1e6}]) + fastpin.LoadHistory([{"Q": 2e5}, {"Q": 0.0}]).repeated(2)
        life = fastpin.wear(steel, cycle_in_newtons, coefficient=1e-14, nodes=NODES)
        worn = damage.worn_fatigue(life)
        spectrum = damage.spectrum_damage(result, constants=STRENGTHS)
        laminated = fastpin.Problem(fastpin.MaterialPair(pair.pin, LAMINATE, "stress"), 0.01, 1e-5, 0.4)
        stressed = fastpin.solve(laminated, [{"P": 1e5}], nodes=NODES)
        jointed = fastpin.storage.record_joint(
            joints.JointFile(PAIRED, [{"a.x": 1e6}, {"a.x": 0.0}], nodes=16), "joint.h5"
        )
        pulses = [{"a.x": 1e6}, {"a.x": 1e5}] * 2
        jointed_life = wear_lives.wear_joint(PAIRED, pulses, model.Wear(1e-14), nodes=16)
        led = sessions.JointSession(PAIRED, nodes=16)
        led.advance({"a.x": 1e6})
        led.advance({"a.x": 1e5})
        led.undo()
        loop = measured_loop(("ux", "Q"), 1e-5 * RUBBED, 1e5 * RUBBED)
        fitted = studies.FittedValue(0.4, 0.3, 0.5)
        identified = studies.Identified(
            _driven(steel), ("ux", "Q"), {"friction": fitted}, {}, 1.0, loop, (loop.displacement, loop.force),
            np.ones((1, 3)), (), 9,
        )  # fmt: skip
        lug = casefile.parse_lug(LUG).lug
        compliance = bodies.Compliance(0.3, "strain", 1.0, MATRIX)
        clamp = joints.Clamp(1e3, 0.2)
        points = np.linspace(1.0, 2.0, 3)
        hoop = reading.OutlineHoop(points, points, points, ["left", "left", "top"], set(), 1e6 * points)
        grid = result.grid
        made: Sequence[Any] = (
            pair, pair.pin, problem, history, history.blocks[0], result, state, cycle, result.cycles[-1], options, case,
            grid, convergence, study, study.series[0], fatigue, fatigue.hot_spot, lug, compliance, plan, plan.points[0],
            spectrum, spectrum.hot_spot, spectrum.cycles,
            result.restart, fastpin.Points.at_depth(0.0, state.theta), state.stress(fastpin.Points.at_depth(0.0, -1.5)),
            state.peak_hoop_stress(), cycle.loops["Q"], bodies.Disk(), bodies.Plate(), bodies.Ring(3.0),
            bodies.Tube(0.5), bodies.Bushing(pair.plate, 2.0), model.FatigueConstants(1e9, -0.1, 0.5, -0.6),
            lugs.Hole("bolt", 3j, 0.5),
            lugs.PartLoad("sxx", ("left", "right"), normal=1.0), lug.outline[0], casefile.parse_lug(LUG),
            limited, limited.limits["contact.friction"], limited.effects("tolerances")["largest_pressure"], pressure,
            report.sweep.chart(plan, rows, "peak_pressure"), studies.sweep.status(plan, "sweep"),
            damage.findley(HISTORY, 0.3),
            report.convergence.reported_series(study, problem, study.series[0].corner)[0],
            lugs.PlateResult(compliance, 0.0, 0.0, 0.0, 100), published.Row("peak", "1", "0.5", 0.5),
            Curve({"mu": 0.4}, {"angle (deg)": np.zeros(3)}), model.About("a project", revision="B"),
            fastpin.Session,
            model.Profile.ellipse(1e-5), model.InitialGap(pin=model.Profile.lobes(3, 1e-5)), model.Wear(1e-14), life,
            model.FatigueAssessment(),
            life[-1], jointed_life, jointed_life[-1],
            worn, worn.crack, crack, law, grown, cracks.stress_intensity(state, crack, [length]), NASGRO,
            cracks.growth_along_edge(result, law, length, 2.0 * length, [-1.5]), planned,
            cracks.spectrum_growth(result, crack, law, length, 2.0 * length), cracks.CrackFate.STOPS,
            LAMINATE, PLY, PLY.strengths, damage.ply_failure(LAMINATE, [1e8, 1e7, 1e7]),
            damage.first_ply_failure(LAMINATE, [1e8, 1e7, 1e7]), model.StrengthAssessment(distance=1e-3),
            damage.joint_strength(stressed[-1], distance=1e-3), charts.CHARTS["kt_bearing"],
            charts.lookup("kt_bearing", load_parameter=0.1, friction=0.4), charts.chart_formulas()[0],
            assess.failure_load(laminated, [{"P": 1e5}], distance=1e-3, nodes=NODES), PAIRED, PAIRED.pins[0],
            PAIRED.plates[0], jointed, jointed[0], identified, fitted,
            joints.parse_joint(joints.JOINT_EXAMPLE), clamp, joints.Faying("a", clamp, "sheet", "other"),
            joints.FayingState(np.zeros(2), np.zeros(2), 0.0), joints.SectionCrack("a", "sheet", planned), hoop,
            hoop.peak, cracks.GrowthTogether(
                problem, (crack,), law, points, *[points[:, None]] * 4, cracks.CrackFate.STOPS, 0.0, ()
            ),
        )  # fmt: skip
        self.objects: dict[str, Callable[[], Any]] = {type(one).__name__: _always(one) for one in made}
        del self.objects["type"]
        bush = fastpin.Problem.from_load_parameter(pair, 0.1, 0.4, plate_body=bodies.Bushing(pair.pin, 2.0, 0.01))
        bushed = fastpin.solve(bush, [{"P": 1.0}], nodes=NODES)[-1]
        self._bushed = bushed
        self._with_constants = fastpin.solve(steel, cycle_in_newtons, nodes=NODES)  # of the plate, for fatigue
        self.objects |= {
            "StoredResult": lambda: fastpin.storage.StoredResult("result.h5"),
            "StressReserve": _always(self._with_constants.assessed_reserves()[0]),
            "BushFit": _always(bushed.bush_fit()),
            "GrowthLaw": _always(law),  # the class alone has no rate
            "Session": session.copy,
            "JointSession": led.copy,
            "Outcome": lambda: published.Outcome([published.Row("peak", "1", "0.5", 0.5)]),
        }
        self._by_target = self._targets(result) | {"worn_fatigue.cycles": _always(life), "after.cycles": _always(1)}
        self._by_target["of_life.life"] = _always(life)
        self._by_target["damage_ranking.states"] = _always(list(life[0].states))
        self._by_target["assessed_fatigue.states"] = _always(list(life[0].states))
        self._by_target["assessed_reserves.states"] = _always(list(life[0].states))
        self._by_target["identify.problem"] = self._by_target["read_loop.problem"] = _always(_driven(steel))
        self._by_target |= {name: _always(stressed[-1]) for name in ("joint_strength.state", "ply_stresses.state")}
        self._by_target |= {name: _always(stressed) for name in ("least_strength.states", "plot_strength.result")}
        self._by_target |= {name: _always(laminated) for name in ("failure_load.problem", "plot_stiffness.joint")}
        self._by_annotation = self._annotations(result)

    def _write_files(self, result: fastpin.Result, case: fastpin.Case) -> None:
        """Write a case, a plan, a lug, a history, materials, a compliance and a result into the present folder."""
        texts = {
            "case.toml": casefile.EXAMPLE,
            "few.toml": re.sub("nodes = [0-9]+", f"nodes = {NODES}", casefile.EXAMPLE),
            "plan.toml": PLAN,
            "tolerances.toml": TOLERANCES,
            "lug.toml": LUG,
            "loads.csv": "P, Q\n1.0, 0\n1.0, 0.2\n",
            "loop.csv": "ux, Q\n0, 0\n1e-6, 1\n",
            "joint.toml": joints.JOINT_EXAMPLE,
            "rim.csv": "angle, gap\n0, 0\n90, 1e-5\n180, 2e-5\n270, 1e-5\n",
            "outcomes.toml": '[outcomes]\nwork = {quantity = "work"}\n',
            "materials.toml": '["own steel"]\nE = 2e11\nnu = 0.3\n',
            "lug.json": bodies.Compliance(0.3, "strain", 1.0, MATRIX).to_text(),
        }
        for name, text in texts.items():
            Path(name).write_text(text, encoding="utf-8")
        fastpin.save(result, "result.h5")
        fastpin.wear(result.problem, result.history, cycles=1, coefficient=1.0, nodes=NODES, output="wear.h5")
        with contextlib.suppress(KeyboardInterrupt):
            fastpin.record(result.problem, result.history, "unfinished.h5", nodes=NODES, arc=(-3.1, 0.0), progress=half)

    @property
    def _fitted(self) -> fastpin.Problem:
        """A problem with an interference fit."""
        return fastpin.Problem.from_load_parameter(self.objects["MaterialPair"](), -0.1, 0.4)

    def object_of(self, owner: type, target: str = "") -> Any:
        """A valid object of a class, for a call of one of its methods."""
        if target == "fastpin.State.bush_fit":
            return self._bushed
        if target in ("fastpin.joints.Joint.lug", "fastpin.joints.JointPlate.lug"):  # an infinite plate is none
            return JOINT if owner is joints.Joint else JOINT.plates[0]
        if target in ("fastpin.Result.assessed_fatigue", "fastpin.Result.assessed_reserves"):
            return self._with_constants
        if owner.__name__ not in self.objects:
            raise LookupError(f"valid_values.py has no object of the class {owner.__name__}")
        return self.objects[owner.__name__]()

    def argument(self, target: str, name: str, annotation: str, is_optional: bool) -> Any:
        """The valid argument of a parameter; LEFT_OUT if it has a default."""
        words = (target + "." + name).split(".")
        last = words[-2]
        for key in (".".join(words[place:]) for place in range(len(words) - 1)):
            if key in self._by_target:
                return self._by_target[key]()
        if is_optional:
            return LEFT_OUT
        if last in self.objects and hasattr(found := self.objects[last](), name):
            return getattr(found, name)
        for key in (annotation, annotation.split(" | ")[0]):
            if key in self._by_annotation:
                return self._by_annotation[key]()
            if key in self.objects:
                return self.objects[key]()
        if name in BY_NAME:
            return BY_NAME[name]
        raise LookupError(
            f"tests/survey/valid_values.py has no value for the parameter {name} of {target}, {annotation}"
        )

    def _annotations(self, result: fastpin.Result) -> dict[str, Callable[[], Any]]:
        return {
            "Sequence[State]": _always(result),
            "LoadHistory | Sequence[dict[str, float]]": _always([{"P": 1.0}]),
            "ToleranceChart | Sequence[ToleranceChart]": lambda: [self.objects["ToleranceChart"]()],
            "Corner": _always({"P": 1.0}),
            "Mapping[str, float]": _always({"P": 1.0, "Q": 1.0}),
        }

    def _targets(self, result: fastpin.Result) -> dict[str, Callable[[], Any]]:
        n = result.grid.size
        values: dict[str, Any] = {
            "Grid.theta": np.linspace(-3.0, 0.0, 11),
            "LoadHistory.corners": [{"P": 1.0}, {"Q": 0.2}],
            "of_blocks.blocks": result.history.blocks,
            "damage_sum.cycles": result.cycles,
            "damage_sum.constants": STRENGTHS,
            "spectrum_damage.constants": STRENGTHS,
            "fatigue_at_distance.length": 0.01,
            "read_case.path": "case.toml",
            "from_csv.path": "loads.csv",
            "column_choices.field": "columns",
            "column_choices.given": {"P": {"column": "P"}},
            "read_samples.path": "rim.csv",
            "read_samples.columns": {"angles": {"column": 1}, "values": "gap"},
            "read_loop.path": "loop.csv",
            "read_joint.path": "joint.toml",
            "parse_joint.text": joints.JOINT_EXAMPLE,
            "solve_joint.corners": [{"a.x": 1e6}],
            "solve_joint.nodes": 16,
            "JointSession.advance.loads": {"a.x": 1e6},
            "Joint.place.pin": "a",
            "Joint.place.plate": "sheet",
            "Joint.load_kind.load": "sheet.sxx",
            "JointPin.value_in.name": "friction",
            "JointPin.value_in.plate": "sheet",
            "JointPin.gap_in.plate": "sheet",
            "wear_joint.corners": [{"a.x": 1e6}, {"a.x": 1e5}] * 2,
            "wear_joint.nodes": 16,
            "JointWearResult.of.pin": "a",
            "JointWearResult.of.plate": "sheet",
            "cycles_to.depth": 1e-9,
            "JointResult.of.pin": "a",
            "JointResult.of.plate": "sheet",
            "shares.plate": "sheet",
            "JointPlate.lug.pins": {"a": 0j},
            "JointPlate.lug.plane": "stress",
            "Joint.has_outline.plate": "sheet",
            "Joint.places.pin": "a",
            "Joint.places.plate": "sheet",
            "Joint.lug.pin": JOINT.pins[0].name,
            "Joint.lug.plate": JOINT.pins[0].plates[0],
            "JointPin.bush_in.plate": "sheet",
            "JointPin.hole_radius.plate": "sheet",
            "JointState.force.pin": "a",
            "JointState.force.plate": "sheet",
            "JointResult.knowing_plate.pin": "a",
            "JointResult.knowing_plate.plate": "sheet",
            "growth_together.first": 0.01,
            "growth_together.last": 0.011,
            "growth_together.cracks": [cracks.Crack(-1.5), cracks.Crack(-1.0)],
            "solve_many.cases": [casefile.parse_case(casefile.EXAMPLE)],
            "Plan.words.field": "contact.friction",
            "Lug.from_document.content": casefile.parse_lug(LUG).lug.document(),
            "Lug.from_document.hole_radius": 1.0,
            "JointPlate.lug.radius": 2.5e-3,
            "tate_rosenfeld.diameter": 5e-3,
            "tate_rosenfeld.pin": PLATE,
            "tate_rosenfeld.one": (PLATE, 2e-3),
            "tate_rosenfeld.other": (PLATE, 2e-3),
            "identify.history": [{"P": 1e5}],
            "identify.loop": {"ux": 1e-5 * RUBBED, "Q": 1e5 * RUBBED},
            "identify.progress": enough,
            "check_temperature.name": "temperature",
            "check_temperature.largest": 0.0,
            "from_csv.columns": {"P": {"column": "P", "scale": -1.0}},
            "from_csv.thickness": 5e-3,
            "json_schema.command": "run",
            "read_lug.path": "lug.toml",
            "read_materials.path": "materials.toml",
            "read_plan.path": "plan.toml",
            "read_outcomes.path": "outcomes.toml",
            "from_file.path": "lug.json",
            "parse_case.text": casefile.EXAMPLE,
            "parse_lug.text": LUG,
            "parse_plan.text": PLAN,
            "read_tolerances.path": "tolerances.toml",
            "parse_tolerances.text": TOLERANCES,
            "LoadHistory.scaled.factors": {"P": 1.1},
            "Tolerances.effects.directory": "tolerances",
            "from_document.content": bodies.Compliance(0.3, "strain", 1.0, MATRIX).document(),
            "with_outcomes.outcomes": {"work": {"quantity": "work"}},
            "angle_of_largest.values": np.arange(float(n)),
            "elliptic_stress.pressure": 1.0,
            "merge.directory": "whole",
            "charts.lookup.quantity": "kt_bearing",
            "charts.lookup.load_parameter": 0.1,
            "charts.lookup.friction": 0.4,
            "joint_values.P": 1.0,
            "ChartFormula.at.friction": 0.4,
            "run.directory": "sweep",
            "run.executor": Inline(),
            "fatigue.criterion": "smith-watson-topper",
            "bonded_opening_load.problem": self._fitted,
            "first_slip_load.problem": self._fitted,
            "first_slip_moment.problem": self._fitted,
            "frictionless_opening_load.problem": self._fitted,
            "verify.progress": enough,
            "animate.progress": enough,
            "write_report.progress": enough,
            "Result.report.progress": enough,
            "plate_compliance.progress": enough,
            "plate_compliance.lug": casefile.parse_lug(LUG).lug,
            "bush_fit.friction": 0.3,
            "Session.change.friction": 0.3,
            "FatigueConstants.required.names": ["fatigue_strength"],
            "Lug.supports": {"top": "both"},
            "archard_depth.pressure": [[1.0], [2.0]],
            "archard_depth.slip": [[1e-6], [2e-6]],
            "ruiz.shear": [[1.0], [2.0]],
            "read.places": [0],
            "resume.path": "unfinished.h5",
            "bulk_stress_eccentricity.bulk_stress": 0.01,
            "bulk_stress_eccentricity.load_ratio": 0.1,
            "animate.path": "out.gif",
            "animate.states": "all",
            "write_report.path": "out.html",
            "write_report.result": result,
            "write_sweep_report.path": "out.html",
            "save.path": "out.h5",
            "Result.report.path": "out.html",
            "WearResult.report.path": "out.html",
            "record.path": "out.h5",
            "record_joint.path": "out.h5",
            "load_joint.path": "joint.h5",
            "stored_joint.path": "joint.h5",
            "record.nodes": NODES,
            "solve.nodes": NODES,
            "converge.nodes": (51, 101, 201),
            "is_being_written.path": Path("result.h5"),
            "plot_gap.joint": fastpin.Problem(result.problem.pair, 0.01, 1e-5, 0.4, gap=model.Profile.ellipse(1e-5)),
            "InitialGap.of.value": model.Profile.ellipse(1e-5),
            "Profile.constant.value": 0.4,
            "Profile.of.value": 0.4,
            "Profile.samples.angles": [-3.0, -1.0, 0.0, 2.0],
            "Profile.samples.values": [0.1, 0.2, 0.3, 0.2],
            "Profile.from_csv.path": "rim.csv",
            "Profile.from_csv.columns": {"angles": {"column": 1}, "values": "gap"},
            "failure_probability.life": [1e5],
            "equivalent_stress.m": 0.5,
            "FatigueAssessment.reliability": None,
            "FatigueAssessment.confidence": None,
            "Profile.words.text": "{:g}".format,
            "Profile.zone.value": 0.4,
            "Wear.coefficient": 1e-14,
            "load_wear.path": "wear.h5",
            "stress_intensity.lengths": [0.01, 0.02],
            "growth.first": 0.01,
            "growth.last": 0.02,
            "spectrum_growth.first": 0.01,
            "spectrum_growth.last": 0.02,
            "spectrum_growth.law": cracks.Walker(1e-10, 3.0),
            "planned_growth.how": model.CrackGrowth(0.01, 0.02, cracks.Walker(1e-10, 3.0), -1.5),
            "CrackGrowth.residual.s": [0.0, 0.005],
            "CrackGrowth.first": 0.01,
            "CrackGrowth.last": 0.02,
            "record.crack": model.CrackGrowth(0.01, 0.02, cracks.Walker(1e-10, 3.0), -1.5),
            "growth_along_edge.progress": enough,
            "planned_growth.progress": half,
            "growth_along_edge.first": 0.01,
            "growth_along_edge.last": 0.02,
            "Crack.theta": -1.5,
            "paris.C": 1e-10,
            "paris.m": 3.0,
            "growth.law": cracks.Walker(1e-10, 3.0),
            "growth_along_edge.law": cracks.Walker(1e-10, 3.0),
            "wear.coefficient": 1e-3,
            "wear.cycles": 2,
            "wear.history": result.history,
            "wear.nodes": NODES,
            "Laminate.compliance": LAMINATE.compliance,
            "Laminate.plies": LAMINATE.plies,
            "from_plies.plies": LAMINATE.plies,
            "turned.angle": 0.3,
            "point_stress_ratio.profile": np.exp,
            "average_stress_ratio.profile": np.exp,
            "joint_strength.distance": 1e-3,
            "StrengthAssessment.distance": 1e-3,
            "failure_load.distance": 1e-3,
            "failure_load.history": [{"P": 1e5}],
            "failure_load.nodes": NODES,
            "filtered.harmonics": 15,
            "characteristic_radius.theta": [0.0, 0.5],
            "characteristic_radius.tension": 0.1,
            "characteristic_radius.compression": 0.2,
            "published.Outcome.rows": [published.Row("peak", "1", "0.5", 0.5)],
        }
        return {name: _always(value) for name, value in values.items()}


BY_NAME: dict[str, Any] = {
    "E": 2e11, "E1": 1e11, "E2": 1e10, "G12": 5e9, "K_max": [2e6], "K_min": [1e6], "R": [0.1], "a": 0.3, "alpha": 0.25,
    "amplitude": 1e8, "bending_limit": 2e8, "beta": 0.06, "beta_star": 1.0, "body": "plate", "centre": -1.5,
    "corners": [[1.0] * len(LOADS)],
    "count": 3, "counts": [1.0, 2.0], "criterion": "smith-watson-topper", "depth": 0.01,
    "directory": "sweep", "distance": 0.01, "ductility_exponent": -0.6, "factor": 2.0, "fatigue_ductility": 0.5,
    "fatigue_strength": 1e9, "first": 1, "force": 1.0, "friction": 0.4, "half_angle": 1.0, "half_width": 1.0,
    "height": 1e-5, "high": 0.5, "history": HISTORY, "host": "127.0.0.1", "index": 1, "k": 0.3, "knee_amplitude": 1e8,
    "knee_cycles": 1e6, "last": 3, "layup": "[0/90]s", "length": 0.01, "limit_range": 2e8, "lives": [1e5, 1e6],
    "load_parameter": 0.1, "load_ratio": 0.5, "low": -0.5, "mu_over_beta": 2.0, "name": "sxx", "nodes": NODES,
    "nu": 0.3, "nu12": 0.3, "nu_pin": 0.3, "order": 2, "parameter": [1e6], "path": "result.h5",
    "paths": [[[0.0, 1.0], [1.0, 0.0]]], "peak_pressure": 2.0, "phi": [0.0, 0.5], "place": "gap",
    "places": [(-3.0, 0.1), (-1.5, 0.05), (0.0, 0.1)], "plane": "strain", "purpose": "fatigue", "radius": 2.0,
    "reliability": 0.99, "confidence": 0.95, "samples": 25, "fitted": 4, "median": [1e6], "scatter": 0.3, "skip": 0,
    "curve_a": 40.0, "curve_b": 4.0, "curve_c": 1e8, "curve_m": 0.5, "curve_kt": 1.0, "curve_scatter": 0.3,
    "curve_samples": 25, "curve": "2024-T3 sheet, Kt 1",
    "remote": [1e7, 0.0, 1e6], "share": np.array([0.0, 0.5]), "shear_ductility_exponent": -0.6,
    "shear_fatigue_ductility": 0.5, "shear_fatigue_strength": 5e8, "shear_modulus": 8e10,
    "shear_strength_exponent": -0.1, "size": 1e-5, "slip_range": [1e-6], "slope": 5.0, "sources": ["part"],
    "start": -3.0, "stop": 0.0, "strength": 1e8, "stress": [1e8, 1e7, 1e7], "strength_exponent": -0.1, "sxx": 1.0,
    "sxy": 0.1, "syy": 0.0, "theta": [-1.5, -1.0], "thickness": 0.01, "threshold_range": 5e6, "torsion_limit": 1.2e8,
    "ultimate_strength": 5e8, "values": [0.0, 1.0, -1.0], "wear_coefficient": 1e-14, "x": [0.0, 0.5], "y": [0.0, 0.5],
    "yield_strength": 4e8,
}  # fmt: skip
"""Valid values by the name of a parameter."""


def _driven(problem: fastpin.Problem) -> fastpin.Problem:
    """The problem with a prescribed displacement along x."""
    return replace(problem, drive="ux", rotation="fixed")


def _always(value: Any) -> Callable[[], Any]:
    return lambda: value
