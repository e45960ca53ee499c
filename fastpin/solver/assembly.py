"""The pin before any load: concentric and without contact, or under the pressure of an interference fit.

:func:`one_step` makes the finite step of the load from rest in which a contact begins.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, TURN, JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.angles import angle_between
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import LOADS, ROTATION
from fastpin.model.profile import widest_place
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    NODAL,
    SLIGHT,
    Configuration,
    accept_solution,
    resting_status,
    review,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.errors import ConvergenceError
from fastpin.solver.increment import implicit_step
from fastpin.solver.interfaces import PinView, with_part
from fastpin.solver.rest import place_between, put_at_rest
from fastpin.solver.settling import FiniteStep


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
    bodies = system.bodies
    if system.problem.gap or (bodies is not None and (bodies.matrix.size or bodies.anisotropy)):
        found = _uneven(system, configuration)
    else:  # in a symmetric, isotropic plate a uniform pressure, without shear and slip
        solution = solve_statuses(system, configuration.status, configuration.slip, load, gap)
        found = None
        if solution is not None and solution.pressure.min() > 0.0:
            found = configuration.changed(pressure=solution.pressure)
    if found is None:
        raise ConvergenceError("the pressure of the interference fit was not found; use more nodes")
    found.work = review(system, found).energy  # the work of the assembly, without that of its friction
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
    found.work = review(joint, found).energy
    return found


def _is_gripped(system: System) -> bool:
    """Whether the nodes grip the unloaded pin. The hole may be a little too narrow for it between two nodes only."""
    problem = system.problem
    if not problem.gap:
        return system.rest_clearance < 0.0
    if not problem.is_gripped:
        return False
    return widest_place(system.grid.theta, system.concentric_gap, problem.driven)[0] < 0.0


def _uneven(system: System, start: Configuration) -> Configuration | None:
    """The tractions of an interference that grows from a neat fit, as of a cooled pin that warms up; or None.

    All grows in proportion to the interference, so one implicit increment is exact, friction included. With an initial
    gap the pin may touch in some places only.
    """
    found = implicit_step(system, start, start.load) or FiniteStep(system, start, everywhere=True).to(start.load)
    is_laminate = system.bodies is not None and system.bodies.anisotropy is not None
    if found is not None and (system.problem.gap or is_laminate):
        n = system.grid.size
        left = system.displacement(found.tractions, found.motion, found.load, found.rest_gap)
        # One step of iterative refinement.
        more = solve_statuses(system, found.status, start.slip - left[n:], np.zeros_like(found.load), left[:n])
        if more is not None:
            whole = more._replace(
                pressure=found.pressure + more.pressure, shear=found.shear + more.shear, slip=left[n:] + more.slip,
                motion=found.motion + more.motion,
            )  # fmt: skip
            found = accept_solution(start, whole, found.load)
    if found is None or not found.closed.any() or worst_residual(system, found) > MAX_RESIDUAL:
        return None
    return found


def one_step(
    system: System, resting: Configuration, load: np.ndarray, everywhere: bool = False
) -> Configuration | None:
    """The implicit increment from rest; by Lemke's method where its iteration fails, see :class:`FiniteStep`.

    Where all nodes may close, three more beginnings are tried: the nodes that are closed without friction, for either
    method, and the statuses on fewer nodes.
    """

    def is_right(found: Configuration | None) -> bool:
        return found is not None and (not everywhere or worst_residual(system, found) <= MAX_RESIDUAL)

    quick = implicit_step(system, resting, load, patient=False) or FiniteStep(system, resting, everywhere).to(load)
    found = quick or implicit_step(system, resting, load)
    if is_right(found) or not (everywhere and system.has_friction):
        return found
    smooth = shearless_step(system, resting, load)
    if smooth is not None:
        start = resting.changed(status=smooth.status)
        found = implicit_step(system, start, load) or FiniteStep(system, start, everywhere).to(load)
    return found if is_right(found) else _refined(system, resting, load)


def _refined(system: System, resting: Configuration, load: np.ndarray) -> Configuration | None:
    """The implicit increment that begins with the statuses of the same increment on fewer nodes.

    A neat pin that turns freely may slip and stick in many zones. From rest they are found on few nodes only.
    """
    count, theta = int(0.8 * system.grid.size), system.grid.theta
    if count < LEAST_NODES or not system.grid.closed:
        return None
    coarse = System.build(system.problem, Grid.circle(count, float(theta[0])), system.scales.force)
    distances = np.abs(angle_between(theta[:, None], coarse.grid.theta))
    to, back = distances.argmin(axis=0), distances.argmin(axis=1)
    begun = unloaded_configuration(coarse).changed(status=resting.status[to])
    put_at_rest(coarse, begun, resting.load, resting.rest, resting.rest_gap[to])
    found = one_step(coarse, begun, load, everywhere=True)
    if found is None or worst_residual(coarse, found) > MAX_RESIDUAL:
        return None
    return implicit_step(system, resting.changed(status=found.status[back]), load)


def shearless_step(system: System, resting: Configuration, load: np.ndarray) -> Configuration | None:
    """The implicit increment without friction. After it the closed nodes stick where they are."""
    smooth, start, held_load = system.without_friction(), resting.copy(), load.copy()
    start.status[start.closed] = resting_status(smooth)[start.closed]
    if not system.motion_rows[TURN, TURN]:  # the pin turns freely
        held_load[ROTATION] = resting.motion[TURN]
    found = one_step(smooth, start, held_load)
    if found is not None:
        pressed = found.pressure > SLIGHT * found.pressure.max()  # others count as open: they must not stick
        found.status[:] = np.where(found.closed & pressed, resting_status(system), OPEN)
        found.load = load
    return found
