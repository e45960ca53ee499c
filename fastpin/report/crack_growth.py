"""The growth of a crack as a curve."""

from __future__ import annotations

from fastpin.cracks import Growth
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.report.curves import Curve


def growth_curve(found: Growth) -> Curve:
    """Return length, stress intensities, range, threshold, rate and cycles of a crack, by its length."""
    unit = units(found.problem)
    length, intensity, rate = (unit[kind].name for kind in ("length", "stress intensity", "crack growth"))
    return Curve(
        {"mouth [deg]": from_bottom(found.crack.theta), "body": found.crack.body},
        {
            f"length [{length}]": found.length,
            f"K_I largest [{intensity}]": found.K_max,
            f"K_I smallest [{intensity}]": found.K_min,
            f"K_II [{intensity}]": found.K_II,
            f"range [{intensity}]": found.delta_K,
            f"threshold [{intensity}]": found.threshold,
            f"rate [{rate}]": found.rate,
            "cycles": found.cycles,
        },
    )
