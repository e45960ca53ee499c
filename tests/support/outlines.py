"""A ring whose rim is free, as cracks see a plate of any outline."""

import numpy as np

from fastpin.cracks.dislocations import CrackLine
from fastpin.lugs import Hole, Lug, images, plates
from fastpin.lugs.panels import Edges
from tests.support.lugs import disc


class FreeOutline:
    """The free rim of a ring as an outline of arcs. No case has it: a plate that nothing holds carries no pin."""

    is_round = False

    def __init__(self, radius: float) -> None:
        self.radius = radius
        lug = Lug(0.3, "stress", 1.0, disc(radius), floats=True)
        hole, rim = plates.boundaries(lug, 8)
        beside = tuple((part, 0.4) for part in Hole("", 0j, 1.0).parts)
        edges = Edges([hole, images.replace(rim, beside=beside)], images.FINENESS)
        self.equations = plates.PlateEquations(lug, edges, lambda done: None)

    def ligament(self, mouth: float, angle: float) -> float:
        side = np.cos(angle)
        return float(np.sqrt(side * side + self.radius**2 - 1.0) - side)

    def deepest(self, lines: tuple[CrackLine, ...]) -> float:
        return max(line.length / self.ligament(line.mouth, line.angle) for line in lines)

    def influence(self, lines: tuple[CrackLine, ...], s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sources and receivers at all distances, without any interpolation."""
        (line,), both = lines, np.concatenate([s[0], t[0]])
        mouth, along = np.exp(1j * line.mouth), np.exp(1j * (line.mouth + line.angle))
        found = images.image(self.equations, mouth + both * along, np.full(both.size, along), np.full(both.size, mouth))
        straight, mirrored = (each[: s.size, s.size :] for each in found)
        return straight, mirrored
