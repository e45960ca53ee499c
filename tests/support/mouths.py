"""Stress intensities of cracks at edges beyond the hole, under a pressure of 1 in the crack."""

import math

import numpy as np

from fastpin.cracks.dislocations import CrackLine, needed_points, weights
from fastpin.lugs import OtherEdges


def intensity_of(other: OtherEdges, angle: float, length: float) -> np.ndarray:
    """K_I and K_II of a crack with a pressure of 1. Lengths are in hole radii."""
    line = (CrackLine(*other.line(0.0, angle), length / other.radius),)
    found = weights(line, other, needed_points(line, other))[0, :, 0, :, 0].sum(axis=1)
    return np.asarray(found * math.sqrt(other.radius))
