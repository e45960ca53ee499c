"""Loops as a rig measures them: computed with a known friction, rig and offsets, with noise and drift."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fastpin import MATERIALS, MaterialPair, Problem, solve

THICKNESS = 8e-3
PRESSED = {"P": 6000.0 / THICKNESS}
TITANIUM = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["Ti-6Al-4V"])


def joint(friction: float = 0.6, **more: Any) -> Problem:
    """A pin of 5 mm whose rotation is held, driven by ux."""
    given: dict[str, Any] = {"drive": "ux", "gauge_radius": 20e-3, "hub_radius": 2e-3, "rotation": "fixed"}
    return Problem(TITANIUM, 5e-3, 30e-6, friction, **(given | {"thickness": THICKNESS} | more))


@dataclass(frozen=True)
class Measured:
    """What a rig does.

    `travel` is the amplitude of the displacement at the far end of the rig, m or rad, `samples` those of a cycle,
    `noise` and `drift` are parts of the amplitudes. `begins` is a part of a cycle that the record leaves out. An
    amplifier has averaged the noise of `filtered` samples.
    """

    travel: float
    samples: int = 80
    noise: float = 0.0
    drift: float = 0.0
    friction: float = 0.68
    rig: float = 250e6 / THICKNESS
    cycles: float = 2.25
    begins: float = 0.0
    names: tuple[str, str] = ("ux", "Q")
    changes: tuple[float, ...] = ()
    nodes: int = 121
    filtered: int = 1

    def joint(self) -> Problem:
        """The joint in its rig."""
        if self.names[0] == "rotation":
            fixed = {"drive": "force", "gauge_radius": None, "rotation": "spring", "hub_stiffness": self.rig}
            return joint(self.friction, **fixed)
        return joint(self.friction, rig_stiffness=self.rig)

    def clean(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacement and force of all samples without noise, offsets and drift."""
        turns = np.arange(1, round((self.begins + self.cycles) * self.samples) + 1) / self.samples
        rows = np.column_stack([self.travel * np.sin(2.0 * np.pi * turns), np.zeros(turns.size)])
        for cycle, change in enumerate(self.changes):
            rows[turns > cycle + 0.25 * bool(cycle), 1] = change
        history = [PRESSED, *({self.names[0]: move, "friction_change": change} for move, change in rows)]
        result = solve(self.joint(), history, nodes=self.nodes)
        force = np.array([state.resultants[self.names[1]] for state in result[1:]])
        skip = round(self.begins * self.samples)
        return rows[skip:, 0], force[skip:]

    def loop(self, clean: tuple[np.ndarray, np.ndarray], seed: int) -> dict[str, np.ndarray]:
        """The record of a test: offsets of a part of the amplitudes, drift and noise."""
        rng, found = np.random.default_rng(seed), {}
        for name, values, offset in zip(self.names, clean, (0.2, 0.03), strict=True):
            size = 0.5 * float(np.ptp(values))
            drift = self.drift * np.linspace(0.0, 1.0, values.size)
            white = rng.normal(size=values.size + self.filtered - 1)
            noise = np.convolve(white, np.full(self.filtered, self.filtered**-0.5), "valid")
            found[name] = values + size * (offset + drift + self.noise * noise)
        return found

    def guess(self) -> Problem:
        """The joint as one knows it before: another friction, and no rig."""
        return replace(self.joint(), friction=0.5, rig_stiffness=None, **self.unheld())

    def unheld(self) -> dict[str, Any]:
        """The fields of a rotation that is held without a spring."""
        return {"rotation": "fixed", "hub_stiffness": None} if self.names[0] == "rotation" else {}
