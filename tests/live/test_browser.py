"""The live page in a real browser, without a screen.

These tests need Chromium and its driver. They run where FASTPIN_BROWSER is set, as in ``.ci/run``.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

import fastpin
from fastpin import casefile
from fastpin.bodies import Ring
from fastpin.joints import parse_joint
from fastpin.live.contact import LiveContact
from fastpin.live.joint import LiveJoint
from fastpin.live.pictures import CURVE_ERROR
from fastpin.live.recording import record_life, record_page
from fastpin.live.server import Server
from fastpin.model.units import units
from fastpin.states.curves import traction_patches
from fastpin.wear_lives import WearResult
from tests.support import seats
from tests.support.laps import SHEETS
from tests.support.live_pages import FREE, LIMIT, contact, served, solved
from tests.support.lives import fretting
from tests.support.processes import fastpin as fastpin_command
from tests.support.processes import started
from tests.support.tiers import some_survey

BROWSER, DRIVER = (shutil.which(name) for name in ("chromium", "chromedriver"))
if not os.environ.get("FASTPIN_BROWSER"):
    pytest.skip("tests in a browser: set FASTPIN_BROWSER=1, as .ci/run does", allow_module_level=True)
if BROWSER is None or DRIVER is None:
    pytest.skip("tests in a browser: apt-get install chromium chromium-driver", allow_module_level=True)

pytestmark = pytest.mark.browser

SWITCHES = ("headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run", "disable-background-networking",
            "disable-component-update", "disable-sync", "hide-scrollbars")  # fmt: skip
LOOP = 200_000
"""Additions of the loop in plain Python that measures how fast the processor is."""

MOST_LOOPS = 10.0
"""Loops in the time that an update with 100 or 200 nodes may take. It usually takes five."""

QUIET = 25.0
"""Percent of the processors that other processes may take on a quiet machine."""


@pytest.fixture(scope="module")
def chrome(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    options = webdriver.ChromeOptions()
    options.binary_location = str(BROWSER)
    folder = tmp_path_factory.mktemp("chromium")
    for switch in (*SWITCHES, f"user-data-dir={folder}", "window-size=1400,1043"):
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.add_experimental_option("prefs", {"download.default_directory": str(folder)})
    driver = webdriver.Chrome(options=options, service=Service(str(DRIVER)))
    driver.folder = folder
    yield driver
    driver.quit()


def until(is_so: Callable[[], bool], why: str | Callable[[], str]) -> None:
    """Wait until something is so."""
    end = time.monotonic() + LIMIT
    while not is_so():
        if time.monotonic() > end:
            raise AssertionError(why if isinstance(why, str) else why())
        time.sleep(0.02)


class Tab:
    """A tab of the browser that shows the page of a server, or one at an address."""

    def __init__(self, chrome: webdriver.Chrome, shown: Server | str) -> None:
        self.chrome, self.server = chrome, None if isinstance(shown, str) else shown
        chrome.switch_to.new_window("tab")
        self.handle = chrome.current_window_handle
        chrome.get(shown if isinstance(shown, str) else shown.address)
        self.wait("return window.fastpin?.history.case && fastpin.times.length > 0")

    def run(self, script: str, *arguments: Any) -> Any:
        self.chrome.switch_to.window(self.handle)
        return self.chrome.execute_script(script, *arguments)

    def wait(self, script: str, *arguments: Any) -> None:
        """Wait until a script returns something true."""
        until(lambda: bool(self.run(script, *arguments)), lambda: f"nothing came of: {script}; page: {self.message}")

    def text(self, name: str) -> str:
        """The text of an element, without those of its cells apart."""
        return str(self.run("return document.getElementById(arguments[0]).textContent", name))

    def value(self, name: str) -> str:
        return str(self.run("return document.getElementById(arguments[0]).value", name))

    def shown(self, name: str) -> Any:
        """An attribute of the history that the page shows."""
        return self.run(f"return fastpin.history.{name}")

    def click(self, name: str) -> None:
        self.chrome.switch_to.window(self.handle)
        self.chrome.find_element(By.ID, name).click()
        self.settle()

    def keys(self, name: str, *keys: str) -> None:
        self.chrome.switch_to.window(self.handle)
        self.chrome.find_element(By.ID, name).send_keys(*keys)
        self.settle()

    def press(self, *keys: str) -> None:
        """Press keys where the focus is, as a user does who has just opened the page."""
        self.chrome.switch_to.window(self.handle)
        webdriver.ActionChains(self.chrome).send_keys(*keys).perform()
        self.settle()

    def set(self, key: str, value: object, event: str = "change") -> None:
        """Set a field, a slider or a choice, as a user does."""
        self.run(
            "const place = document.querySelector(`[data-key='${arguments[0]}']`) ??"
            "document.getElementById(arguments[0]); place.value = arguments[1];"
            "place.dispatchEvent(new Event(arguments[2], {bubbles: true}))", key, value, event,
        )  # fmt: skip
        self.settle()

    def mouse(self, kind: str, x: float, y: float, buttons: int = 1) -> None:
        self.chrome.execute_cdp_cmd(
            "Input.dispatchMouseEvent",
            {"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1},
        )

    def tip(self) -> tuple[float, float]:
        """The place of the arrow's tip in the window."""
        x, y = self.run(
            "const box = fastpin.drawing.canvas.getBoundingClientRect(); window.scrollTo(0, 0);"
            "const tip = fastpin.drawing.tip(fastpin.history.latest.load); return [box.x + tip[0], box.y + tip[1]]"
        )
        return x, y

    def swipe(self, first: tuple[float, float], *others: tuple[float, float]) -> None:
        """Press the mouse at the first place, move it through the others, and release it at the last one."""
        self.mouse("mousePressed", *first)
        for place in others:
            self.mouse("mouseMoved", *place)
        self.mouse("mouseReleased", *others[-1], 0)
        self.settle()

    def drag(self, path: Callable[[float], tuple[float, float]], events: int) -> None:
        """Drag the arrow's tip along a path, in pixels from where it is."""
        x, y = self.tip()
        moves = [path(k / events) for k in range(1, events + 1)]
        self.swipe((x, y), *((x + right, y + down) for right, down in moves))

    def settle(self) -> None:
        """Wait until nothing is under way, and all is drawn. A page without a server asks for nothing."""
        if self.server is None:
            return
        self.wait("return !fastpin.leader.busy && fastpin.link.waiting.size === 0 && !fastpin.player.plays")
        self.chrome.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    @property
    def message(self) -> str:
        return "" if self.run("return document.getElementById('message').hidden") else self.text("sentence")

    @property
    def live(self) -> LiveContact:
        """The contact of the page, in the server."""
        return self.server.contacts[self.run("return fastpin.link.session")]

    def curve(self, name: str) -> np.ndarray:
        """The data of a chart, shape (series, points); a gap is NaN."""
        script = "return JSON.stringify(fastpin.charts.charts[arguments[0]].data.map((one) => Array.from(one)))"
        return np.array(json.loads(self.run(script, name)), dtype=float)

    @contextlib.contextmanager
    def sized(self, width: int, height: int = 900) -> Iterator[None]:
        """Let the page have this size. A window has at least 500 pixels."""
        sizes = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", sizes)
        yield
        self.chrome.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with served(lambda: contact(nodes=101)) as running:
        yield running


@pytest.fixture(autouse=True)
def _close_tabs(chrome: webdriver.Chrome) -> Iterator[None]:
    """Close the tabs of a test at its end. The console of the browser has no message."""
    chrome.get_log("browser")
    yield
    trouble = chrome.get_log("browser")
    for handle in chrome.window_handles[1:]:
        chrome.switch_to.window(handle)
        chrome.close()
    chrome.switch_to.window(chrome.window_handles[0])
    assert trouble == []


@pytest.fixture
def tab(chrome: webdriver.Chrome, server: Server) -> Tab:
    return Tab(chrome, server)


Opened = Callable[..., Tab]


@pytest.fixture
def opened(chrome: webdriver.Chrome) -> Iterator[Opened]:
    """Opens the page of a case's text, at a server of its own."""
    with contextlib.ExitStack() as stack:
        yield lambda text=None, nodes=61: Tab(chrome, stack.enter_context(served(lambda: contact(text, nodes))))


def circle(part: float) -> tuple[float, float]:
    """A drag to the right, up and back."""
    return 70.0 * np.sin(np.pi * part), -25.0 * (1.0 - np.cos(np.pi * part))


def test_a_drag_has_the_state_of_the_same_history_in_python_bit_by_bit(tab: Tab) -> None:
    tab.drag(circle, 40)
    state, result = tab.live.session.state, solved(tab.live)
    assert len(result) > 5
    for name in ("pressure", "shear", "gap", "slip", "status"):
        assert np.array_equal(getattr(state, name), getattr(result[-1], name))
    assert tab.shown("latest.load") == state.load
    assert tab.shown("latest.dissipation") == state.dissipation


def test_charts_show_the_tractions_of_solve(tab: Tab) -> None:
    tab.drag(circle, 20)
    state = solved(tab.live)[-1]
    angle, _, pressure = tab.curve("pressure")
    ((degrees, found, shears),) = [points.T for points in traction_patches(state)]
    close = {"rtol": 0.0, "atol": 5.0 * CURVE_ERROR * 1e-6 * state.peak_pressure}  # of four thinnings, in MPa
    assert np.allclose(pressure, 1e-6 * np.interp(angle, degrees, found), **close)
    _, _, upper, lower, shear = tab.curve("shear")
    assert np.allclose(shear, 1e-6 * np.interp(angle, degrees, shears), **close)
    assert np.allclose(upper, 0.4 * pressure)
    assert np.array_equal(lower, -upper)
    where, *_, hoop = tab.curve("hoop")
    assert f"{hoop.max():#.4g} MPa" in tab.text("numbers")
    assert np.allclose(hoop, 1e-6 * state.hoop_stress("plate", np.radians(where - 90.0)), rtol=1e-5, atol=1e-4)
    (shown,) = re.findall(r"peak pressure([\d.]+) MPa", tab.text("numbers"))
    assert float(shown) == float(f"{1e-6 * state.peak_pressure:.4g}")


def test_a_joint_is_led_and_each_of_its_holes_is_shown(chrome: webdriver.Chrome) -> None:
    with served(lambda: LiveJoint(parse_joint(SHEETS), SHEETS, 32)) as running:
        tab = Tab(chrome, running)
        assert tab.run("return fastpin.joint.places.length") == 2
        assert [tab.run(f"return document.getElementById('hole').options[{k}].text") for k in (0, 1)] == [
            "A in sheet", "B in sheet"
        ]  # fmt: skip
        tab.set("A.x", "3")  # kN
        tab.set("hole", "1")
        (_, pin), state = tab.live.session.state.contacts, tab.live.session.state
        assert state.load["A.x"] == 3e3
        assert len(tab.live.session.history) == 2
        _, _, pressure = tab.curve("pressure")
        assert np.nanmax(pressure) == pytest.approx(1e-6 * pin.peak_pressure, rel=1e-3)
        assert f"{pin.load['Q'] * 2e-3 / 1e3:#.4g} kN" in tab.text("numbers")  # the plate is 2 mm thick
        x, y = tab.run(
            "const box = fastpin.joint.map.getBoundingClientRect(), place = fastpin.joint.places[0];"
            "return [box.x + place.x, box.y + place.y]"
        )
        tab.swipe((x, y), (x, y))
        assert tab.run("return fastpin.history.hole") == 0
        path = chrome.folder / "recording.html"
        tab.click("save-recording")
        until(path.exists, "the recording was not saved")
    replayed = Tab(chrome, path.as_uri())
    replayed.set("hole", "1")
    assert replayed.shown("pictures.length") == 2
    assert replayed.shown("latest.peak_pressure") == pin.peak_pressure
    path.unlink()  # other tests save files of this name


DRAWN = """
const plot = fastpin.charts.charts[arguments[0]], lines = [], {lineTo, moveTo} = Path2D.prototype;
for (const name of ["lineTo", "moveTo"]) {
  const drawn = Path2D.prototype[name];
  Path2D.prototype[name] = function (x, y) { lines.push([x, y]); drawn.call(this, x, y); };
}
fastpin.charts.show();
return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
  Object.assign(Path2D.prototype, {lineTo, moveTo});
  done([lines, [[0, "x"], [1, "x"], [0, "y"], [1, "y"]].map(([value, axis]) => plot.valToPos(value, axis, true))]);
})));
"""
"""Draws the charts once more. The answer has the points of all lines on the canvas, and the places of 0 and 1."""


def test_curves_on_the_canvas_follow_the_roots_at_the_edges(tab: Tab) -> None:
    """Whole pixels and straight segments from the outermost node to the edge were wrong by several pixels."""
    state = tab.live.session.state
    lines, (x0, x1, y0, y1) = tab.run(DRAWN, "pressure")
    points = np.array([place for place in lines if None not in place])  # a gap has no place
    ((edge, _),) = [np.degrees(ends) + 90.0 for ends in state.contact]
    edges = state.refined.tractions.patches[0]
    degrees, pressure = np.degrees(edges[:, 0]) + 90.0, 1e-6 * edges[:, 1]
    x, y = (points[:, 0] - x0) / (x1 - x0), (points[:, 1] - y0) / (y1 - y0)
    near = (x > edge) & (x < edge + 3.0) & (y > 0.0)
    off = abs(y - np.interp(x, degrees, pressure)) * abs(y1 - y0)
    drawn = near & (off < 0.5)
    assert np.count_nonzero(drawn) >= 12  # where two nodes stand
    assert off[drawn].max() < 0.1
    assert np.any(abs(points[drawn] - np.round(points[drawn])) > 0.1)
    assert abs((points[:, 0] - x0) / (x1 - x0) - edge).min() < 1e-3  # the curve begins at the edge


def zoomed(tab: Tab) -> list[tuple[float, float]]:
    """Return the windows of the charts round the hole, and that of the map."""
    tab.settle()
    found = tab.run(
        "return [...Object.values(fastpin.charts.charts).map((one) => one.scales.x), fastpin.map.chart.scales.y]"
        ".map((scale) => [scale.min, scale.max])"
    )
    return [tuple(ends) for ends in found]


def test_a_marked_part_of_a_curve_fills_all_charts(tab: Tab) -> None:
    x, y, width = tab.run(
        "const box = document.querySelector('#shear-chart .u-over').getBoundingClientRect();"
        "return [box.x, box.y + box.height / 2, box.width]"
    )
    tab.swipe(*((x + part * width, y) for part in (0.25, 0.3, 0.4, 0.5)))
    for ends in zoomed(tab):
        assert ends == pytest.approx([-90.0, 0.0], abs=3.0)
    tab.drag(circle, 5)  # new curves keep the window
    assert zoomed(tab)[0] == pytest.approx([-90.0, 0.0], abs=3.0)
    tab.run("document.querySelector('#shear-chart .u-over').dispatchEvent(new MouseEvent('dblclick', {bubbles: true}))")
    assert zoomed(tab) == [(-180, 180)] * 4


NARROW = FREE.replace("clearance = 1e-5", "clearance = 1e-4").replace("P = 1e6", "P = 1e5")
"""A case with a contact of twelve degrees."""


@pytest.mark.parametrize("load", [{"P": 1e5}, {"P": -1e5}, {"P": 0.0, "Q": -1e5}])
def test_charts_show_a_narrow_contact_larger_until_the_whole_hole_is_wanted(opened, load):
    tab = opened(NARROW, 100)
    tab.run("return fastpin.link.ask('reset')")
    tab.run("return fastpin.link.ask('load', {loads: arguments[0], gesture: 1})", load)
    state = tab.live.session.state
    ((start, stop),) = [np.degrees(ends) + 90.0 for ends in state.contact]
    for low, high in zoomed(tab):
        turn = 360.0 * round((0.5 * (low + high - start - stop)) / 360.0)
        assert low < start + turn < stop + turn < high
        assert high - low < 2.0 * (stop - start)
    angle, _, pressure = tab.curve("pressure")
    assert np.isfinite(pressure).sum() > 30
    assert np.nanmax(pressure) == pytest.approx(1e-6 * state.peak_pressure, rel=1e-3)
    tab.click("zoom")
    assert zoomed(tab) == [(-180, 180)] * 4
    tab.click("zoom")
    assert zoomed(tab)[0][1] - zoomed(tab)[0][0] < 2.0 * (stop - start)
    assert np.array_equal(tab.curve("pressure")[0], angle)
    tab.set("clearance", "-5")  # a contact all round is shown with the whole hole
    assert zoomed(tab) == [(-180, 180)] * 4
    assert not tab.run("return document.getElementById('zoom').offsetWidth")


def test_the_loop_shows_the_work_of_the_load(tab: Tab) -> None:
    tab.click("play-cycle")
    (way, load) = tab.run("return fastpin.loops.chart.data[1]")
    cycle = solved(tab.live).cycle(first=1, last=len(way))
    loop = cycle.loops["Q"]
    assert np.allclose(way, 1e6 * loop.displacement, rtol=1e-9, atol=1e-9)
    assert np.allclose(load, 1e-3 * loop.load)
    tab.click("loop-bent")
    bent, same = tab.run("return fastpin.loops.chart.data[1]")
    scale = {"nm": 1e-9, "µm": 1e-6}[tab.text("loop-unit").split("[")[-1][:-1]]
    assert np.ptp(bent) * scale < 0.2 * np.ptp(loop.displacement)

    def area(way: list[float], unit: float) -> float:
        """The area from the first turn of the load to the third one, where it is the same."""
        loads, ways = np.array(same)[24:73], unit * np.array(way)[24:73]
        return float(np.sum(0.5 * (loads[1:] + loads[:-1]) * np.diff(ways)))

    assert area(bent, scale) == pytest.approx(area(way, 1e-6), rel=1e-6)


def test_the_loop_begins_with_the_load_that_acts(tab: Tab) -> None:
    assert tab.value("loop-load") == "P"  # only P acts
    assert tab.run("return fastpin.loops.chart.data[1][1]") == [2.42]
    tab.drag(lambda part: (40.0 * part, 0.0), 5)
    assert tab.value("loop-load") == "Q"
    tab.set("sxx", "20")
    assert tab.value("loop-load") == "sxx"
    tab.set("loop-load", "P")
    tab.set("sxx", "30")
    assert tab.value("loop-load") == "P"  # a choice of the user stays


def test_undo_redo_and_reset(tab: Tab) -> None:
    start = tab.shown("latest.load")
    tab.drag(circle, 10)
    there = tab.shown("latest.load")
    tab.click("undo")
    assert tab.shown("latest.load") == start
    tab.keys("drawing", Keys.CONTROL, "y")
    assert tab.shown("latest.load") == there
    tab.click("reset")
    assert tab.shown("pictures.length") == 0
    tab.keys("drawing", Keys.CONTROL, "z")
    assert tab.shown("latest.load") == there


def test_arrow_keys_move_the_load_wherever_the_focus_is(tab: Tab) -> None:
    size, start = tab.shown("case.axes[0].size"), tab.shown("latest.load")
    with tab.sized(800, 500):
        tab.press(Keys.ARROW_RIGHT)
        tab.keys("drawing", Keys.SHIFT + Keys.ARROW_UP)
        load = tab.shown("latest.load")
        assert (load["Q"], load["P"]) == (pytest.approx(0.02 * size), pytest.approx(start["P"] - 0.1 * size))
        assert tab.shown("undos") == 2
        assert tab.run("return window.scrollY") == 0
        tab.run("document.getElementById('field-friction').focus({preventScroll: true})")
        tab.press(Keys.ARROW_RIGHT)
        tab.run("document.querySelector(`[data-key='Q slider']`).focus({preventScroll: true})")
        tab.press(Keys.ARROW_UP)  # a slider has its own keys
        assert tab.shown("latest.load.P") == load["P"]
        tab.run("document.activeElement.blur(); window.scrollTo(0, document.body.scrollHeight)")
        before = tab.run("return window.scrollY")
        assert tab.run("return fastpin.drawing.canvas.getBoundingClientRect().bottom") < 0
        tab.press(Keys.ARROW_UP)  # the drawing is out of sight: the key scrolls the page
        tab.wait("return window.scrollY < arguments[0]", before)
        assert tab.shown("latest.load.P") == load["P"]


TYPED = {"0,3": 0.3, "0.25": 0.25, " ,3 ": 0.3, "2e-1": 0.2, "2,5E-1": 0.25, "1,000.5": None, "0,3,1": None, "a": None,
         "1 0": None, "-1": None}  # fmt: skip
"""What a user types as friction, and the number that it is."""


def test_a_decimal_comma_is_read_as_one_and_wrong_input_gets_a_sentence(tab: Tab) -> None:
    """The browser is English. Its number fields would take 0,3 for 3."""
    expected = 0.4
    for text, friction in TYPED.items():
        tab.keys("field-friction", Keys.CONTROL, "a")
        tab.keys("field-friction", text, Keys.ENTER)
        expected = expected if friction is None else friction
        sentence = f'friction μ: "{text}" is no number; write 1234.5 or 1234,5' if friction is None else ""
        assert tab.live.session.problem.friction == expected, text
        assert tab.message == ("friction: must not be negative, not -1" if text == "-1" else sentence)
        assert friction is not None or tab.value("field-friction") == ("-1" if text == "-1" else f"{expected:.4f}")
    tab.drag(circle, 5)
    assert tab.message == ""


def test_the_handle_of_a_large_load_stays_inside(tab: Tab) -> None:
    def tip() -> list[float]:
        return tab.run(
            "const {drawing, history} = fastpin, tip = drawing.tip(history.latest.load);"
            "return [tip[0] / drawing.canvas.clientWidth, tip[1] / drawing.canvas.clientHeight]"
        )

    tab.set("P", "30")
    assert max(tip()) < 0.99
    assert min(tip()) > 0.01
    note = tab.text("scale-note")
    assert note.endswith("; arrow of the load at 1/10")
    before = tab.live.session.state.load["Q"]
    tab.drag(lambda part: (30.0 * part, 0.0), 3)  # a drag keeps the scale
    moved = tab.live.session.state.load["Q"] - before
    tab.click("undo")
    tab.click("undo")
    tab.drag(lambda part: (30.0 * part, 0.0), 3)
    assert moved == pytest.approx(10.0 * tab.live.session.state.load["Q"], rel=0.1)


def test_gaps_are_described_plainly(opened: Opened) -> None:
    tab = opened(FREE.replace("clearance = 1e-5", "clearance = 1e-3"))
    assert tab.text("scale-note") == "gaps to scale"
    tab.set("clearance", "0.01")
    assert re.fullmatch(r"gaps enlarged \d+ times", tab.text("scale-note"))


def test_rounding_is_shown_as_zero(opened: Opened) -> None:
    numbers = opened(None, 200).text("numbers")
    assert "pin turns0 rad" in numbers
    assert "pin moves right0 m" in numbers


def test_a_bush_that_slips_is_drawn_with_its_zones(opened: Opened) -> None:
    tab = opened(seats.TEXT, 48)
    tab.set("Q", "20")
    assert re.search("bush turns.*bush slips up to", tab.text("numbers"), re.DOTALL)
    assert tab.shown("shown.seat.zones.length") > 1


@pytest.mark.parametrize("thickness", ["", "thickness = 0.01\n"])
def test_units_of_kilonewtons_and_millimetres(opened: Opened, thickness: str) -> None:
    text = FREE.replace("friction = 0.3\n", f"friction = 0.3\n{thickness}")
    if thickness:
        text = text.replace("P = 1e6", "P = 1e4")
    tab = opened(text)
    tab.set("units", "kN, mm")
    force = "kN" if thickness else "kN/m"
    page = tab.run("return document.body.innerText").replace("\t", " ")
    assert f"\nP {'10.00' if thickness else '1000'} {force} " in page
    assert "µm" not in page
    assert ("/m" not in page) == bool(thickness)
    assert tab.value("field-clearance") == "0.01000"
    tab.set("P", "5,5" if thickness else "550")
    tab.set("clearance", "0,02")
    assert tab.live.session.state.load["P"] == pytest.approx(5.5e5, rel=1e-15)
    assert tab.live.session.problem.clearance == 2e-5


def test_a_prescribed_rotation_and_its_kind_have_controls_of_their_own(opened: Opened) -> None:
    text = FREE.replace("friction = 0.3\n", 'friction = 0.3\nrotation = "fixed"\n') + "rotation = 0.001\n"
    tab = opened(text)
    assert tab.value("field-rotation") == "1.000"
    assert tab.run("return document.querySelector(`select[data-key='rotation']`).value") == "fixed"


@pytest.mark.parametrize("width", [420, 360])
def test_texts_of_the_drawing_do_not_overlap(opened: Opened, width: int) -> None:
    tab = opened(FREE)
    with tab.sized(width):
        tab.set("P", "30")
        edges = "return document.getElementById(arguments[0]).getBoundingClientRect()[arguments[1]]"
        assert tab.run(edges, "help", "bottom") < tab.run(edges, "scale-note", "top")


OUTLINE = """
const drawn = [], pen = fastpin.drawing.context, line = pen.lineTo, {x, y, radius} = fastpin.drawing.frame();
pen.lineTo = function (px, py) { drawn.push([px, py]); line.call(pen, px, py); };
fastpin.drawing.draw();
delete pen.lineTo;
return drawn.slice(0, 721).map(([px, py]) => Math.hypot(px - x, py - y) / radius);
"""
"""Draws once more. The answer has the distances of the hole's edge from the centre, in hole radii: each half degree
from the top on."""


def test_lobes_are_chosen_by_words_and_drawn_enlarged(tab: Tab) -> None:
    assert tab.run(OUTLINE) == pytest.approx([1.0] * 721)
    tab.set("hole_lobes", "2")
    tab.set("hole_amplitude", "8")
    tab.set("hole_axis slider", "30", "input")
    gap = tab.live.session.problem.gap
    theta = np.radians(np.arange(-180.0, 180.5, 0.5) - 90.0)
    oval = 8e-6 * np.cos(2.0 * (theta + np.radians(60.0)))
    assert np.allclose(gap.values(theta, 0.01)[0], oval, rtol=0.0, atol=1e-18)
    (times,) = re.findall(r"gaps enlarged (\S+) times", tab.text("scale-note"))
    enlarged = 1.0 + float(times) / 0.01 * gap.values(theta, 0.01)[0]
    assert tab.run(OUTLINE) == pytest.approx(enlarged.tolist(), abs=1e-3)  # the words have two digits
    assert "hole profile: oval of 8 um" in tab.text("profiles")
    assert tab.shown("latest.peak_pressure") == solved(tab.live)[-1].peak_pressure
    tab.set("hole_lobes", "0")
    assert tab.run(OUTLINE) == pytest.approx([1.0] * 721)
    assert not tab.run("return document.querySelector(`[data-key='hole_amplitude']`)")


def test_bounds_of_the_shear_follow_friction_along_the_rim_and_its_change(opened: Opened) -> None:
    varied = "friction = [{ constant = 0.2 }, { zone = 0.2, start = -10, stop = 180 }]"
    tab = opened(FREE.replace("friction = 0.3", varied))
    for change in (0.0, 0.5):
        tab.set("friction_change", str(change))
        angle, _, upper, lower, _ = tab.curve("shear")
        pressure = tab.curve("pressure")[2]
        state, apart = tab.live.session.state, np.abs(angle + 10.0) > 0.25  # the page has four values a degree
        bound = state.friction_at(np.radians(angle - 90.0)) * pressure
        assert np.allclose(upper[apart], bound[apart], rtol=1e-5, equal_nan=True)
        assert np.array_equal(lower, -upper, equal_nan=True)
        assert np.nanmax(upper / pressure) == pytest.approx(0.4 * (1.0 + change))
    tab.set("most_friction slider", "0.1", "input")
    assert tab.live.session.problem.most_friction == pytest.approx(0.1)
    assert tab.live.session.problem.least_friction == pytest.approx(0.05)


def test_fields_and_sliders_change_the_problem_and_the_load(tab: Tab) -> None:
    tab.set("sxx", "50")
    tab.set("Q slider", "300000", "input")
    load = tab.live.session.state.load
    assert (load["sxx"], load["Q"]) == (50e6, 300000.0)
    tab.set("sxx", "0")  # a ring has no remote stress
    for key, value in (("clearance", "40"), ("friction slider", "0.3"), ("pin_bore", "4"), ("plate_body", "ring")):
        tab.set(key, value, "input" if "slider" in key else "change")
        assert tab.shown("latest.peak_pressure") == solved(tab.live)[-1].peak_pressure
        assert tab.message == ""
    problem = tab.live.session.problem
    assert (problem.clearance, problem.friction) == (4e-5, 0.3)
    assert (problem.pin_body.bore_radius, type(problem.plate_body)) == (4e-3, Ring)


def test_a_slider_can_be_dragged_while_the_contact_follows(tab: Tab) -> None:
    x, y, width = tab.run(
        "const place = document.querySelector(`[data-key='friction slider']`); place.scrollIntoView();"
        "const box = place.getBoundingClientRect(); return [box.x, box.y + box.height / 2, box.width]"
    )
    tab.swipe((x + width / 3, y), *((x + width * (1 / 3 + 0.02 * k), y) for k in range(25)))
    friction = tab.live.session.problem.friction
    assert friction == pytest.approx(0.81 * 1.2, abs=0.05)
    assert float(tab.value("field-friction")) == pytest.approx(friction, abs=1e-3)
    tab.chrome.switch_to.active_element.send_keys(Keys.CONTROL, "z")  # the slider has the focus
    tab.settle()
    assert tab.live.session.problem.friction == 0.4
    assert tab.value("field-friction") == "0.4000"


def test_two_ways_to_the_same_load_have_two_shears(tab: Tab) -> None:
    tab.click("play-two")
    words = tab.text("lesson")
    assert words.startswith("Same load as the reference, reached in another way: the shear differs by up to")
    _, before, _, _, shear = tab.curve("shear")
    straight = np.max(np.abs(np.nan_to_num(before) - np.nan_to_num(shear)))
    assert f"{straight:.3g} MPa" in words
    # The page's reference is the state of one straight step, and its curve the state of the detour.
    problem, load = tab.live.session.problem, tab.live.session.state.load
    result = fastpin.solve(problem, [{"P": load["P"], "Q": load["Q"]}], grid=tab.live.session.grid)
    kept = tab.run("return Array.from(fastpin.history.reference.shear)")
    assert np.allclose(kept, result[-1].shear, rtol=1e-5, atol=100.0)


def test_the_case_is_played_and_the_history_scrubbed(tab: Tab) -> None:
    tab.click("play-case")
    assert tab.shown("latest.load.Q") == 7.26e5
    count = tab.shown("pictures.length")
    tab.set("scrub", 3, "input")
    assert tab.shown("place") == 3
    assert tab.text("step") == f"step 4 of {count}"
    tab.keys("drawing", Keys.ARROW_LEFT)  # goes on from the latest state, not from the one that is shown
    assert tab.run("return fastpin.history.isLatest && fastpin.history.pictures.length") == count + 1


def test_two_tabs_have_two_contacts(tab: Tab, chrome: webdriver.Chrome, server: Server) -> None:
    other = Tab(chrome, server)
    tab.drag(circle, 5)
    assert tab.live is not other.live
    assert other.shown("pictures.length") == 1
    other.drag(circle, 5)
    assert np.array_equal(solved(other.live)[-1].shear, other.live.session.state.shear)


def test_a_lost_connection_and_a_reloaded_page_come_back_with_their_history(tab: Tab) -> None:
    tab.drag(circle, 10)
    serials = "return fastpin.history.pictures.map((one) => one.serial)"
    before = tab.run(serials)
    tab.run("fastpin.link.socket.close()")
    tab.wait("return !fastpin.link.open")
    tab.wait("return fastpin.link.open && fastpin.link.waiting.size === 0")
    assert tab.run(serials) == before
    tab.chrome.refresh()
    tab.wait("return window.fastpin?.history.case && fastpin.link.waiting.size === 0")
    assert tab.run(serials) == before
    tab.drag(circle, 5)
    assert tab.run(serials)[: len(before)] == before
    assert tab.shown("pictures.length") > len(before)
    assert tab.message == ""


def test_a_killed_server_leaves_the_history_on_the_page(chrome: webdriver.Chrome) -> None:
    with started(fastpin_command("live", "--no-browser", "--nodes", 61)) as process:
        address = process.stdout.readline().split()[-1]
        tab = Tab(chrome, address)
        tab.keys("drawing", Keys.ARROW_RIGHT)
        tab.wait("return fastpin.history.pictures.length === 2")
        process.kill()
        process.wait()
    tab.wait("return document.getElementById('connection').textContent === 'no server'")
    assert tab.message.startswith("The server has ended. The history stays on this page")
    tab.keys("drawing", Keys.ARROW_RIGHT)  # no harm
    tab.click("csv")
    file = chrome.folder / "loads.csv"
    until(file.exists, "no file was saved")
    loads = fastpin.LoadHistory.from_csv(file).values()
    assert loads.shape[0] == 2
    assert loads[-1, 0] == 2.42e6
    chrome.get_log("browser")  # the refused connections


def test_a_load_that_nothing_carries_says_so(opened: Opened) -> None:
    tab = opened(FREE)
    tab.set("M", "5")
    before = tab.live.session.state
    assert "spins" in tab.message
    assert tab.message.endswith("The contact stays at the last load that was carried.")
    tab.drag(circle, 5)
    assert tab.message == ""
    assert tab.live.session.state is not before


def test_a_case_that_fails_at_once_says_so_on_the_page(opened: Opened) -> None:
    tab = opened(FREE + "M = 1e6\n")
    assert "the pin spins" in tab.message
    assert tab.shown("pictures.length") == 0
    tab.set("P", "1")
    assert (tab.message, tab.live.session.state.load["P"]) == ("", pytest.approx(1e6, rel=1e-15))


def test_case_picture_and_recording_are_saved(tab: Tab, chrome: webdriver.Chrome) -> None:
    tab.drag(circle, 10)
    files = [chrome.folder / name for name in ("case.toml", "recording.html", "fastpin.png")]
    for name in ("save-case", "save-recording", "save-image"):
        tab.click(name)
    until(lambda: all(file.exists() for file in files), "the files were not saved")
    case = casefile.read_case(files[0])
    result = fastpin.solve(case.problem, case.history, **case.options.keywords())
    assert np.array_equal(result[-1].shear, tab.live.session.state.shear)
    assert files[2].read_bytes().startswith(b"\x89PNG")
    assert_replays(chrome, files[1], tab.shown("pictures.length"))


def assert_replays(chrome: webdriver.Chrome, file: Path, count: int) -> None:
    """A recording is replayed from a file, without server."""
    tab = Tab(chrome, file.as_uri())
    assert tab.shown("pictures.length") == count
    tab.run("fastpin.history.place = 0")
    tab.click("replay")
    tab.wait("return fastpin.history.isLatest && !fastpin.player.plays")
    assert_alone(tab)


def test_the_recording_of_a_run_is_replayed(chrome: webdriver.Chrome, tmp_path: Path) -> None:
    case = casefile.builtin_case()
    result = fastpin.solve(case.problem, case.history, nodes=61, between=4)
    file = tmp_path / "page.html"
    file.write_text(record_page(case, list(result)), encoding="utf-8")
    assert_replays(chrome, file, len(result))


def assert_alone(tab: Tab) -> None:
    """A page asks for nothing over a network."""
    assert not tab.run("return performance.getEntriesByType('resource').some((one) => one.name.startsWith('http'))")


SLIDE = """
const slider = document.getElementById('cycles'); slider.value = arguments[0];
slider.dispatchEvent(new Event('input'));
return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(Number(slider.value)))));
"""
"""Moves the slider of cycles as a user does. The answer is the place to which it snaps."""


def life_of(chrome: webdriver.Chrome, folder: Path, life: WearResult) -> Tab:
    """Open the recording of a life of wear from a file."""
    file = folder / "life.html"
    file.write_text(record_life(life, "Fretting"), encoding="utf-8")
    return Tab(chrome, file.as_uri())


def test_the_slider_of_cycles_moves_through_a_life_of_wear(chrome: webdriver.Chrome, tmp_path: Path) -> None:
    life = fretting()
    tab = life_of(chrome, tmp_path, life)
    words, numbers, unit_words = (
        f"return document.getElementById('{name}').textContent" for name in ("cycle", "numbers", "worn-unit")
    )
    assert tab.run(words) == "after 3,000 cycles"
    places = tab.shown("life.scale.places")
    assert places[0] == 0.0
    assert places[1:] == pytest.approx(0.08 + 0.92 * np.log10(life.numbers[1:] / 3.0) / 3.0)
    for k in (0, 4, 2):
        near = places[k] + (0.02 if k < 4 else -0.02)
        assert tab.run(SLIDE, near) == pytest.approx(places[k])  # only stored cycles are shown
        cycle = life[k]
        assert tab.run(words) == f"after {cycle.cycle:,} cycles"
        worn = tab.curve("worn")
        unit = {"[pm]": 1e-12, "[nm]": 1e-9, "[µm]": 1e-6}[tab.run(unit_words)]
        assert unit * np.nanmax(worn[-1]) == pytest.approx(cycle.depth, rel=1e-6)
        assert np.allclose(worn[2] + worn[3], worn[4], equal_nan=True)  # pin and hole
        angle, _, pressure = tab.curve("pressure")
        ((degrees, drawn, _),) = [points.T for points in traction_patches(cycle.states[-1])]
        assert np.allclose(pressure, 1e-6 * np.interp(angle, degrees, drawn), rtol=0.0, atol=5.0 * CURVE_ERROR * 160.0)
        text = tab.run(numbers)
        factor, label = units(life.problem)["work per stress"].scale([cycle.volume])
        ((done, volume, unit),) = re.findall(r"cycles([\d,]+)worn volume(\S+) (\S+³)", text)
        assert (done, unit) == (f"{cycle.cycle:,}", label.replace("^3", "³").replace("u", "µ"))
        assert float(volume.replace("−", "-")) == pytest.approx(factor * cycle.volume, rel=1e-3)
        assert f"largest pressure{1e-6 * cycle.largest_pressure:#.4g} MPa" in text
        assert tab.run("return fastpin.map.columns.length") == k + 1
    assert np.nanmax(tab.curve("damage")[-1]) == pytest.approx(life.fatigue().hot_spots[2].damage, rel=1e-6)
    before = tab.shown("shown.serial")
    tab.set("scrub", 0, "input")
    assert tab.shown("shown.serial") == before - 2
    tab.keys("drawing", Keys.ARROW_RIGHT)
    assert tab.run("return [fastpin.history.cycle.cycle, fastpin.history.place]") == [100, 0]  # the state stays
    tab.keys("cycles", Keys.HOME)
    assert tab.shown("cycle.cycle") == 0
    tab.click("play-life")
    tab.wait("return fastpin.history.cycle.cycle === 3000 && !fastpin.player.plays")
    assert_alone(tab)


WIDTHS = "return [document.documentElement.scrollWidth, innerWidth]"


@pytest.mark.parametrize("width", [1400, 800, 400])
def test_nothing_lies_beyond_the_window(tab: Tab, chrome: webdriver.Chrome, tmp_path: Path, width: int) -> None:
    with tab.sized(width):
        tab.drag(circle, 5)
        wide, inner = tab.run(WIDTHS)
        boxes = tab.run(
            "return Array.from(document.querySelectorAll('button, canvas, input, select'), (one) => "
            "{const box = one.getBoundingClientRect();"
            " return [one.id || one.dataset.key || one.className, box.left, box.right, box.width]})"
        )
        assert [box for box in boxes if box[3] > 0 and not 0 <= box[1] <= box[2] <= inner] == []
        assert wide <= inner == width
    life = life_of(chrome, tmp_path, fretting(1, ()))
    with life.sized(width):
        wide, inner = life.run(WIDTHS)
        assert wide <= inner == width
        assert life.text("cycle") == "after 1 cycle"


DRAG = """
const [x, y, frames, done] = arguments, begin = fastpin.times.length;
let k = 0;
function move() {  // a mouse sends an event for each frame
  const part = k / frames, [right, down] = [60 * Math.sin(6 * Math.PI * part), -20 * Math.sin(4 * Math.PI * part)];
  fastpin.drawing.canvas.dispatchEvent(new PointerEvent("pointermove", {clientX: x + right, clientY: y + down}));
  if (++k <= frames) requestAnimationFrame(move);
  else setTimeout(() => done(fastpin.times.slice(begin)), 500);
}
move();
"""
"""Moves the pressed mouse in the page itself: the driver would be too slow."""


@pytest.mark.parametrize("nodes", some_survey([100, 200, 400], 400))
def test_updates_come_fast_enough_for_a_drag(chrome: webdriver.Chrome, nodes: int) -> None:
    """From the message of the page to its picture, while the mouse moves.

    The processor time of server and browser together has a limit with 100 and 200 nodes. It is counted in loops of
    plain Python, which take as long as the processor is slow. Other processes take time from both, so the time that
    passes for 95 % of the updates has its limit on a quiet machine only. It is printed in any case.
    """
    with served(lambda: contact(nodes=nodes)) as running:
        tab = Tab(chrome, running)
        tab.drag(circle, 20)  # the first steps load compiled code
        busy, loops = psutil.cpu_percent(0.5), [loop_time()]
        x, y = tab.tip()
        tab.mouse("mousePressed", x, y)
        began = processor_time()
        times = chrome.execute_async_script(DRAG, x, y, 120)
        spent = 1e3 * (processor_time() - began) / len(times)
        tab.mouse("mouseReleased", x, y, 0)
        loops.append(loop_time())
    updates = [one["drawn"] - one["asked"] for one in times]
    between = np.diff([one["drawn"] for one in times])
    slow, median = np.quantile(updates, 0.95), np.median(updates)
    rate = f"{len(times)} updates, {1e3 / np.median(between):.0f} a second, {spent:.0f} ms of the processor each"
    text = (
        f"{nodes} nodes: {rate}; median {median:.0f} ms, 95 % {slow:.0f} ms, others took {busy:.0f} % before; "
        f"a loop took {loops[0]:.1f} ms before and {loops[1]:.1f} ms after"
    )
    print(text)
    assert len(times) > 20
    if nodes <= 200:
        most = MOST_LOOPS * float(np.mean(loops))
        assert spent < most, text
        if busy < QUIET:
            assert slow < most, text


def loop_time() -> float:
    """Return the processor time of a loop in plain Python, ms: the median of half a second."""
    times: list[float] = []
    while sum(times) < 500.0:
        began = time.thread_time()
        total = 0
        for number in range(LOOP):
            total += number
        times.append(1e3 * (time.thread_time() - began))
    return float(np.median(times))


def processor_time() -> float:
    """Return the processor time of this process and all processes of the browser, s."""
    total = 0.0
    for process in [psutil.Process(), *psutil.Process().children(recursive=True)]:
        with contextlib.suppress(psutil.Error):
            total += sum(process.cpu_times()[:2])
    return total
