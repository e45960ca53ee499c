"""Animation of a load cycle: tractions and sketch of the joint, state by state, as GIF or MP4."""

from __future__ import annotations

import base64
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D

from fastpin.errors import InputError
from fastpin.figures import sketch, style
from fastpin.figures.sheet import HEADING, Look, Plot
from fastpin.figures.states import DrawnStates, Frame, InMemory, Subject
from fastpin.figures.stick_slip import LOOKS, zone_look, zone_patch
from fastpin.kernels.status import STICK
from fastpin.model.checks import check_callable, file_path, number
from fastpin.model.units import acting_loads, units
from fastpin.states.choice import StateChoice
from fastpin.states.curves import friction_along
from fastpin.states.state import State
from fastpin.storage.files import check_writable, replacing

MOST_FRAMES = 200
"""Most states of an animation: some 20 seconds at ten states a second."""

FORMATS = (".gif", ".mp4")
"""Endings of an animation's name."""

RATE = 4.0
"""States a second, unless another rate is given."""

DPI = 100.0
"""Dots per inch of a picture, unless others are given."""


@dataclass(frozen=True, repr=False)
class Animation:
    """An animation that a notebook shows.

    Attributes
    ----------
    gif : bytes
        The content of a GIF file.
    """

    gif: bytes

    def __repr__(self) -> str:
        return f"<Animation: GIF of {len(self.gif):,} bytes>"

    def _repr_html_(self) -> str:
        image = base64.b64encode(self.gif).decode("ascii")
        return f'<img alt="animation of a load cycle" src="data:image/gif;base64,{image}">'


def animate(
    result: Sequence[State],
    path: str | Path | None = None,
    title: str = "",
    dpi: float = DPI,
    *,
    states: StateChoice = None,
    rate: float = RATE,
    progress: Callable[[float, float], None] | None = None,
) -> Animation | None:
    """Write an animation of a load cycle: the sketch of the joint with its contact, and the tractions.

    Each picture shows one state; nothing is made up between states. States inside steps (``between`` of
    :func:`fastpin.solve`) make the motion smooth.

    Parameters
    ----------
    result : Result or sequence of State
    path : path, optional
        Ends in .gif, or in .mp4 if the program ffmpeg is on the PATH. Without a path the animation is returned.
    title : str
    dpi : float
        Dots per inch; a picture is 8 inches wide.
    states : str, number, sequence of numbers or slice, optional
        See :func:`fastpin.plot_tractions`. Unless given, the last cycle, or all states of a history without cycles.
        At most :data:`MOST_FRAMES` are shown.
    rate : float
        States a second.
    progress : callable, optional
        ``progress(done, total)`` is called after each state.

    Returns
    -------
    Animation or None
        The animation, which a notebook shows. None if it was written to a file.

    Raises
    ------
    InputError
        If there are less than two states, an argument is out of range, or the file can't be written. Also if its name
        has another ending, or ffmpeg is missing.
    """
    if path is not None:
        check_animation("path", file_path("path", path))
    look = Look(title=title, dpi=dpi)
    check_callable("progress", progress)
    film = animation_plot(InMemory(result), states, rate)
    with tempfile.TemporaryDirectory() as folder:
        shown = Path(folder) / "animation.gif" if path is None else Path(path)
        check_writable(shown)
        film.write(shown, look, progress)
        return Animation(shown.read_bytes()) if path is None else None


class Film(Plot):
    """An animation that is not drawn yet. Its ``draw(look)`` returns a scene."""

    def save(self, path: Path, title: str = "", progress: Callable[[float, float], None] | None = None) -> None:
        """Draw the pictures and write them to a file."""
        self.write(path, Look(title=title, dpi=DPI), progress)

    def write(self, path: Path, look: Look, progress: Callable[[float, float], None] | None) -> None:
        """Draw the pictures in the house style, and write them."""
        with style.house_style():
            self.draw(look).write(path, progress)


def animation_plot(subject: Subject, states: StateChoice = None, rate: float = RATE) -> Film:
    """Return the animation of states, see :func:`animate`."""
    usual = "cycle" if states is None and subject.cycles else states
    drawn = subject.states(usual, most=MOST_FRAMES, in_a_row=True)
    number("rate", rate, 0.1, 50.0)  # GIF has steps of a hundredth of a second
    if len(drawn) < 2:
        raise InputError("states", "an animation needs two states or more")
    return Film(lambda look: _Scene(drawn, look, float(rate)), notes=drawn.notes, frames=len(drawn))


def check_animation(field: str, path: Path) -> None:
    """Raise :class:`InputError` if a name does not end as an animation's, or if the program for it is missing."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(field, f"the animation's name must end in {' or '.join(FORMATS)}, not {path.name!r}")
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise InputError(field, "a film (.mp4) needs the program ffmpeg, which is not on the PATH; .gif needs none")


class _Scene:
    """The picture of an animation. Its axes keep their limits from state to state."""

    def __init__(self, states: DrawnStates, look: Look, rate: float = RATE) -> None:
        self.states, self.frame = states, Frame(states)
        self.rate, self.dpi = rate, look.dpi
        width = 8.0  # inches
        self.figure = style.new_figure(width, 4.3)
        self.figure.set_layout_engine("none")  # the panels must not move
        grid: dict[str, Any] = {"left": 0.42, "right": 0.98, "top": 0.82, "bottom": 0.13, "hspace": 0.12}
        rows = 1 if states[0].problem.frictionless else 2
        self.panels: list[Axes] = list(
            self.figure.subplots(rows, 1, sharex=True, squeeze=False, gridspec_kw=grid)[:, 0]
        )
        self.joint = self.figure.add_axes((0.01, 0.17, 0.33, 0.67))
        self.heading = self.figure.text(0.02, 0.975, "", fontsize=HEADING, va="top", parse_math=False)
        self.title = look.title
        small = "\n".join(style.wrapped_parts(style.caption(states[0].problem, states), width - 0.4))
        self.figure.text(0.02, 0.905, small, fontsize=style.CAPTION_SIZE, color="0.25", va="top", parse_math=False)
        self.names = acting_loads([state.load for state in states])
        self.factor, unit = units(states[0].problem)["traction"].scale([state.peak_pressure for state in states])
        self.largest = self.factor * max(state.peak_pressure for state in states)
        self.most_friction = max(state.most_friction for state in states)
        words = ("pressure N", "shear traction T")
        self.force = max(abs(state.load[name]) for state in states for name in ("P", "Q"))
        looks = dict.fromkeys(zone_look(states[0].problem, status) for status in LOOKS)
        patches: list[Artist] = [zone_patch(look) for look in looks]
        if rows > 1:
            patches.append(Line2D([], [], color=style.COLOURS[0], linewidth=0.5, label="thin: bounds ±μN of T"))
        self.figure.legend(
            handles=patches, loc="lower left", bbox_to_anchor=(0.0, 0.0), fontsize=style.CAPTION_SIZE, ncols=1
        )
        self.labels = [style.quantity(each, unit) for each in words[:rows]]

    def write(self, path: Path, progress: Callable[[float, float], None] | None) -> None:
        """Write the pictures of all states to a file."""
        made_by: Any = PillowWriter if path.suffix.lower() == ".gif" else FFMpegWriter
        writer: AbstractMovieWriter = made_by(fps=self.rate)
        try:
            with replacing(path) as temporary, writer.saving(self.figure, str(temporary), self.dpi):
                for k, state in enumerate(self.states):
                    self.show(k, state)
                    writer.grab_frame()
                    if progress is not None:
                        progress(k + 1, len(self.states))
        except subprocess.CalledProcessError as error:
            reason = f"ffmpeg could not write the film: it ended with code {error.returncode}"
            raise InputError("path", reason) from None

    def show(self, place: int, state: State) -> None:
        """Draw one state in place of the one before."""
        loads = ",  ".join(style.load_text(self.states, place, name) for name in self.names)
        head = f"load point {style.point_text(state)}:  {loads}"
        self.heading.set_text(f"{self.title}:  {head}" if self.title else head)
        angle, pressure, shear = self.frame.curves(state)
        for panel, label in zip(self.panels, self.labels, strict=True):
            panel.clear()
            panel.set_ylabel(label)
            panel.grid(True, color="0.92", linewidth=0.6)
        self.panels[0].plot(angle, self.factor * pressure, **style.line(0))
        self.panels[0].set_ylim(0.0, 1.08 * self.largest or 1.0)
        if len(self.panels) > 1:
            friction = friction_along(state, angle)
            for sign in (1.0, -1.0):
                bound = sign * friction * self.factor * pressure
                self.panels[1].plot(angle, bound, color=style.COLOURS[0], linewidth=0.5, alpha=0.6)
            self.panels[1].plot(angle, self.factor * shear, **style.line(1))
            most = 1.15 * self.most_friction * self.largest or 1.0
            self.panels[1].set_ylim(-most, most)
        self._shade(state)
        self.frame.scale(self.panels[-1])
        self.panels[-1].set_xlabel(style.ANGLE)
        self.joint.clear()
        sketch.draw_sketch(
            state.problem, sketch.load_ranges([state]), Look(ax=self.joint), state, words=False, largest=self.force
        )

    def _shade(self, state: State) -> None:
        """Shade stick and slip in the colours of the sketch."""
        zones = [(*zone, STICK) for zone in state.stick] + state.slip_zones
        for start, stop, status in zones:
            for left, width in self.frame.place(start, stop):
                colour, hatch, _ = zone_look(state.problem, int(status))
                for panel in self.panels:
                    panel.axvspan(
                        left, left + width, facecolor=to_rgba(colour, 0.13), hatch=hatch, edgecolor="0.85", linewidth=0,
                        zorder=-1,
                    )  # fmt: skip
