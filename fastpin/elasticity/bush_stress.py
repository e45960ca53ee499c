"""Stresses in a bush that slips in its seat, from the tractions on both of its rims.

The bush under the tractions of the pin, which leave by a uniform traction on its outer rim, and the bush under the
tractions of the seat, which enter by a uniform traction at its bore, are fields of a ring and of a tube. Their sum has
the two uniform tractions too many: the field of a bush that these alone load is taken away.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.stress import pin_stress, plate_stress, traction_harmonics
from fastpin.elasticity.tractions import Tractions
from fastpin.kernels import harmonics
from fastpin.model.problem import Problem


def bush_stress(
    problem: Problem, of_pin: Tractions, of_seat: Tractions, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in the bush, shape (3, m).

    Those that both fields have stem from a uniform traction on either rim, which carries the force and the moment.

    Parameters
    ----------
    problem : Problem
    of_pin, of_seat : Tractions
        Tractions on the bore and in the seat.
    theta, depth : ndarray, shape (m,)
        Angles of the points, rad, and their distances from the bore, in units of R.
    """
    pin, seat = problem.interfaces
    outer = seat.hole_radius / pin.hole_radius
    found = plate_stress(pin, of_pin, np.zeros(3), theta, depth)
    found += pin_stress(seat, of_seat, theta, np.clip((outer - 1.0 - depth) / outer, 0.0, None))
    t, radius = traction_harmonics(of_pin, 1), 1.0 + depth
    force, amplitudes = t[1, 1], harmonics.first(outer, pin.surfaces.plate_kolosov, "uniform")
    A, D, L = (each[1] * force for each in (amplitudes.A, amplitudes.D, amplitudes.L))
    z = radius * np.exp(1j * theta)
    both = 4.0 * np.real(2.0 * A * z - np.conj(L) / z)
    forward = 2.0 * (A * radius + D * radius**-3.0 - L / radius)
    traction = forward * np.exp(1j * theta) + np.conj(force) / radius * np.exp(-1j * theta)
    radial = traction.real
    found -= np.array([radial, both - radial, traction.imag + t[0, 0].imag / radius**2])
    return found
