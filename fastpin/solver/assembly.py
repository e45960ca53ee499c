"""The pin before any load: concentric and without contact, or under the pressure of an interference fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.loads import LOADS
from fastpin.model.profile import widest_place
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    NODAL,
    Configuration,
    accept_solution,
    elastic_energy,
    resting_status,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.errors import ConvergenceError
from fastpin.solver.increment import implicit_step
from fastpin.solver.interfaces import PinView, with_part
from fastpin.solver.rest import place_between
from fastpin.solver.settling import FiniteStep

NOT_FOUND = "the pressure of the interference fit was not found; use more nodes"


def unloaded_configuration(system: System) -> Configuration:
    """The configuration before any load: concentric without contact, or the pressure of an interference fit.

    The work is 0, or the elastic energy of the assembly.

    Raises
    ------
    ConvergenceError
        If the pressure of an interference fit was not found on this grid.
    """
    if isinstance(system, JointSystem):
        return _assembled_joint(system)
    n, drive, load = system.grid.size, system.drive, np.zeros(len(LOADS))
    zeros = np.zeros(n)
    is_gripped = _is_gripped(system)
    rest = zeros[:2] if is_gripped else place_between(system, load)
    gap = system.concentric_gap + drive.translation[:n] @ rest
    configuration = Configuration(
        pressure=zeros.copy(),
        shear=zeros.copy(),
        gap=np.maximum(gap, 0.0),
        slip=zeros.copy(),
        status=np.full(n, OPEN, dtype=np.int8),
        motion=np.zeros(system.motions),
        load=load,
        origin=np.zeros(2) if drive.has_displacements else np.full(2, np.nan),
        rest=rest.copy(),
        rest_gap=gap,
        rest_slip=zeros.copy(),
    )
    if not is_gripped:
        return configuration
    overlaps = system.concentric_gap < 0.0
    configuration.status[:] = np.where(overlaps, resting_status(system), OPEN)
    configuration.origin = np.zeros(2)
    configuration.gap = zeros.copy()
    # In a plate that is not symmetric or not isotropic, or with a gap.
    bodies = system.bodies
    is_uneven = bool(system.problem.gap) or (bodies is not None and bool(bodies.matrix.size or bodies.anisotropy))
    found = (_uneven if is_uneven else _uniform)(system, configuration)
    found.work = elastic_energy(system, found)  # the work of the assembly, without that of its friction
    return found


def _assembled_joint(joint: JointSystem) -> Configuration:
    """The configuration of a joint before any load: the bush pressed in its seat first, then the pin in the bush."""
    seat = unloaded_configuration(joint.alone[SEAT])
    n = joint.grid.size
    nodal: dict[str, Any] = {name: np.zeros(n) for name in NODAL if name != "status"}
    whole = Configuration(
        **nodal, status=np.full(n, OPEN, dtype=np.int8),
        motion=np.zeros(joint.motions), load=seat.load, origin=np.full(4, np.nan), rest=np.zeros(4),
    )  # fmt: skip
    whole = with_part(joint, whole, SEAT, seat)
    if not joint.is_pressed:
        return with_part(joint, whole, PIN, unloaded_configuration(joint.alone[PIN]))
    view = PinView(joint, whole)
    found = view.whole(unloaded_configuration(view.system))
    found.dissipation = found.seat_dissipation = 0.0
    found.work = elastic_energy(joint, found)
    return found


def _is_gripped(system: System) -> bool:
    """Whether the nodes grip the unloaded pin. The hole may be a little too narrow for it between two nodes only."""
    problem = system.problem
    if not problem.gap:
        return system.rest_clearance < 0.0
    if not problem.is_gripped:
        return False
    return widest_place(system.grid.theta, system.concentric_gap, problem.driven)[0] < 0.0


def _uniform(system: System, start: Configuration) -> Configuration:
    """The uniform pressure of an interference fit, without shear and slip."""
    solution = solve_statuses(system, start.status, start.slip, start.load, start.rest_gap)
    if solution is None or solution.pressure.min() <= 0.0:
        raise ConvergenceError(NOT_FOUND)
    start.pressure = solution.pressure
    return start


def _uneven(system: System, start: Configuration) -> Configuration:
    """The tractions of an interference that grows from a neat fit, as of a cooled pin that warms up.

    All grows in proportion to the interference, so one implicit increment is exact, friction included. With an initial
    gap the pin may touch in some places only.
    """
    found = implicit_step(system, start, start.load) or FiniteStep(system, start, everywhere=True).to(start.load)
    is_laminate = system.bodies is not None and system.bodies.anisotropy is not None
    if found is not None and (system.problem.gap or is_laminate):
        found = _corrected(system, start, found)
    if found is None or not found.closed.any() or worst_residual(system, found) > MAX_RESIDUAL:
        raise ConvergenceError(NOT_FOUND)
    return found


def _corrected(system: System, start: Configuration, found: Configuration) -> Configuration:
    """The configuration `found` from `start` without the rounding of its solve: one more solve with what is left."""
    n = system.grid.size
    left = system.displacement(found.tractions, found.motion, found.load, found.rest_gap)
    more = solve_statuses(system, found.status, start.slip - left[n:], np.zeros_like(found.load), left[:n])
    if more is None:
        return found
    whole = more._replace(
        pressure=found.pressure + more.pressure, shear=found.shear + more.shear, slip=left[n:] + more.slip,
        motion=found.motion + more.motion,
    )  # fmt: skip
    return accept_solution(start, whole, found.load)
