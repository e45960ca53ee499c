"""The interface between bush and plate: does the press fit keep it closed, and does it stick?"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fastpin.model.angles import near_bottom
from fastpin.model.read_only import ReadOnly
from fastpin.model.ties import top_angle


@dataclass(frozen=True, eq=False)
class BushFit(ReadOnly):
    """The tractions between bush and plate in one state, and what the press fit must supply.

    The bush is bonded in the calculation. That holds where the pressure is positive all round, and the shear below
    friction times pressure.

    Attributes
    ----------
    theta : ndarray, shape (n,)
        Angles, rad.
    pressure : ndarray, shape (n,)
        Pressure between bush and plate, the press fit included, Pa; negative where the bond is in tension.
    shear : ndarray, shape (n,)
        Shear stress s_rtheta at the interface, Pa.
    press_fit_pressure : float
        The part of the press fit, Pa.
    friction : float or None
        Coefficient of friction between bush and plate.
    """

    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    press_fit_pressure: float
    friction: float | None

    @property
    def open_margin(self) -> float:
        """Smallest pressure, Pa. Below 0 the interface would open."""
        return float(self.pressure.min())

    @property
    def open_angle(self) -> float:
        """Place of the smallest pressure, rad."""
        return self._angle_of_least(self.pressure)

    @property
    def slip_margin(self) -> float:
        """Smallest pressure beyond \\|shear\\|/friction, Pa; NaN without friction. Below 0 the interface would slip."""
        return math.nan if self.friction is None else float(self._reserve(self.friction).min())

    @property
    def slip_angle(self) -> float:
        """Place where the interface is nearest to slip, rad; NaN without friction."""
        return math.nan if self.friction is None else self._angle_of_least(self._reserve(self.friction))

    @property
    def pressure_to_close(self) -> float:
        """Press-fit pressure that just keeps the interface closed, Pa."""
        return self.press_fit_pressure - self.open_margin

    @property
    def pressure_to_stick(self) -> float:
        """Press-fit pressure that just keeps the interface from slip, Pa; NaN without friction."""
        return self.press_fit_pressure - self.slip_margin

    @property
    def least_friction(self) -> float:
        """Coefficient of friction that just keeps the interface from slip; infinite if it opens."""
        if self.open_margin <= 0.0:
            return math.inf
        return float((np.abs(self.shear) / self.pressure).max())

    def _angle_of_least(self, values: np.ndarray) -> float:
        largest = float(self.pressure.max())  # a small difference of large pressures has their rounding
        return near_bottom(float(self.theta[top_angle(largest - values, self.theta)]))

    def _reserve(self, friction: float) -> np.ndarray:
        needed = np.abs(self.shear) / friction if friction > 0.0 else np.where(self.shear == 0.0, 0.0, math.inf)
        return self.pressure - needed
