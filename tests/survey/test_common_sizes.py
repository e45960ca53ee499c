"""A walk over common sizes, in mm and inches, through commands and readings: rounding stops none of them."""

import itertools
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin.model.points import bodies_of
from tests.support.commands import printed, said
from tests.support.common_sizes import bushed, sizes

pytestmark = pytest.mark.survey

KINDS = {
    "plain": "",
    "hollow pin": '[pin_body]\nkind = "tube"\nbore_radius = {bore!r}\n',
    "ring": '[plate_body]\nkind = "ring"\nouter_radius = {rim!r}\n',
    "bush": '[plate_body]\nkind = "bushing"\nmaterial = "C93200"\nouter_radius = {outer!r}\ninterference = 1e-5\n',
}
SLIPS = "bonded = false\nfriction = 0.2\n"
CASE = """
[pin]
material = "4340 normalized"
[plate]
material = "7075-T6"
[contact]
plane = "stress"
hole_radius = {radius!r}
clearance = 2e-5
friction = 0.3
pin_load = "{pin_load}"
{body}
[[load]]
P = 2e6
[[load]]
Q = [1e5, -1e5]
repeat = 2
[solve]
nodes = 41
"""


def text_of(kind: str, radius: float, outer: float) -> str:
    name, _, slips = kind.partition(", ")
    body = KINDS[name].format(bore=0.4 * radius, rim=2.0 * outer, outer=outer) + (SLIPS if slips else "")
    return CASE.format(radius=radius, body=body, pin_load="body" if name == "plain" else "centre")


@pytest.mark.parametrize("first", range(0, 36, 3))
@pytest.mark.parametrize("kind", [*KINDS, "bush, slips"])
@pytest.mark.usefixtures("undrawn")
def test_commands_and_readings_take_common_sizes(
    kind: str, first: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every third size is tried. Each test takes a twelfth of them: all together take longer than a test may."""
    monkeypatch.chdir(tmp_path)
    for number, (radius, outer) in enumerate(itertools.islice(sizes(), first, None, 36)):
        Path("case.toml").write_text(text_of(kind, radius, outer))
        said("run", "case.toml", "-o", "a.h5", "--overwrite")
        printed("show", "a.h5", "--json", "-")
        if number % 5 == 0:
            said("report", "a.h5", "-o", "a.html")
        result = fastpin.load("a.h5")
        result.extremes()
        for body in bodies_of(result.problem):
            depth = fastpin.Points.at_depth(0.0, 0.0)
            assert np.isfinite(result[-1].stress(depth, body).hoop)
            assert np.isfinite(result[-1].peak_hoop_stress(body).value)


@pytest.mark.parametrize("any_outline", [True, False])
def test_states_of_bushes_of_common_sizes_are_read(any_outline: bool) -> None:
    for radius, outer in itertools.islice(sizes(), 0, None, 3):
        result = fastpin.solve(bushed(radius, outer, any_outline), [{"P": 1e6}, {"Q": 1e5}], nodes=31)
        assert result.extremes()["peak_pressure"].largest.value > 0.0
