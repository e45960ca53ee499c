"""Animations: their pictures, their formats, and one sentence for each fault."""

import base64
import shutil

import pytest
from PIL import Image

from fastpin import InputError, figures
from fastpin.figures import animation
from fastpin.states.cycles import Cycle
from tests.support.refusals import refused
from tests.support.samples import sample_result

CORNERS = [{"P": 2.42e6, "Q": 1e5 * k} for k in (0, 1, 2, -1)]


@pytest.fixture
def result():
    return sample_result(CORNERS, nodes=41)


@pytest.mark.gate
def test_a_gif_has_a_picture_for_each_state_of_the_last_cycle(result, tmp_path):
    result.cycles = (Cycle(3, 2, 1, 0.0, 0.0, 0.0, 0.0, True),)
    done = []
    path = tmp_path / "cycle.gif"
    figures.animate(result, path, dpi=50, rate=5, progress=lambda now, total: done.append((now, total)))
    assert done == [(1, 3), (2, 3), (3, 3)]
    with Image.open(path) as picture:
        assert picture.n_frames == 3
        assert picture.size == (400, 215)
        assert picture.info["duration"] == 200
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.gate
def test_without_a_path_a_notebook_shows_the_animation(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = sample_result(CORNERS[:2], nodes=41)
    figures.animate(result, tmp_path / "a.gif", dpi=50)
    shown = figures.animate(result, dpi=50)
    assert shown.gif == (tmp_path / "a.gif").read_bytes()
    assert base64.b64encode(shown.gif).decode() in shown._repr_html_()
    assert repr(shown) == f"<Animation: GIF of {len(shown.gif):,} bytes>"
    assert [path.name for path in tmp_path.iterdir()] == ["a.gif"]


@pytest.mark.gate
def test_axes_keep_their_limits_and_the_heading_names_the_loads(result):
    scene = animation._Scene(figures.states.drawn_states(result), figures.sheet.Look(title="Joint"))
    limits = []
    for place, state in enumerate(result):
        scene.show(place, state)
        limits.append([(panel.get_xlim(), panel.get_ylim()) for panel in scene.panels])
    assert all(each == limits[0] for each in limits)
    assert scene.heading.get_text() == "Joint:  load point 4:  P = 2.42 MN/m,  Q = −0.1 MN/m"
    assert len(scene.panels[0].lines) == 1
    assert [text.get_text() for text in scene.joint.texts][1].startswith("Q = −100")


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("a.avi", {}, "path: the animation's name must end in .gif or .mp4, not 'a.avi'"),
        ("a.gif", {"states": "last"}, "states: an animation needs two states or more"),
        ("a.gif", {"rate": 0}, "rate: must lie between 0.1 and 50, not 0"),
        ("a.gif", {"states": [9]}, "states: there is no state at load point 9; the last is 4"),
        ("none/a.gif", {}, "the directory"),
    ],
)
def test_faults_leave_no_file(result, name, options, message, tmp_path):
    assert message in str(refused(figures.animate, result, tmp_path / name, **options))
    assert list(tmp_path.iterdir()) == []


def test_a_film_needs_ffmpeg(result, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(InputError, match=r"path: a film \(.mp4\) needs the program ffmpeg, which is not on the PATH"):
        figures.animate(result, tmp_path / "a.mp4")


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not on the PATH")
def test_a_film(result, tmp_path):
    figures.animate(result, tmp_path / "a.mp4", dpi=50)
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"


@pytest.mark.gate
def test_an_interrupted_animation_leaves_the_old_file(result, tmp_path):
    path = tmp_path / "a.gif"
    path.write_bytes(b"old")

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        figures.animate(result, path, dpi=50, progress=stop)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
