"""Hints at what is meant: attributes, names of folders, words and units that users try first."""

import copy
import pickle
import warnings
from typing import Any

import pytest

import fastpin
from fastpin.cli.options import parser
from fastpin.errors import InputError, InputWarning
from fastpin.model import FatigueAssessment, Wear
from tests.support.samples import sample_result

ATTRIBUTES = {
    ("result", "max_pressure"): "result[-1].peak_pressure",
    ("result", "peak_presure"): "result[-1].peak_pressure",
    ("result", "statez"): "states",
    ("state", "max_pressure"): "peak_pressure",
    ("problem", "mu"): "friction",
    ("problem", "radius"): "hole_radius",
}


@pytest.mark.parametrize(("owner", "name"), ATTRIBUTES)
def test_an_unknown_attribute_names_the_meant_one(owner: str, name: str) -> None:
    result = sample_result()
    thing: Any = {"result": result, "state": result[-1], "problem": result.problem}[owner]
    with pytest.raises(AttributeError, match=f"no attribute '{name}', did you mean ") as caught:
        getattr(thing, name)
    assert str(caught.value).endswith(f"did you mean {ATTRIBUTES[owner, name]}?")


def test_other_attributes_have_the_usual_error_and_copies_work() -> None:
    result = sample_result()
    with pytest.raises(AttributeError, match=r"^'Result' object has no attribute 'zzz'$"):
        result.zzz  # noqa: B018
    with pytest.raises(AttributeError, match=r"^'State' object has no attribute '__array__'$"):
        result[-1].__array__  # noqa: B018
    assert pickle.loads(pickle.dumps(result))[-1].peak_pressure == result[-1].peak_pressure
    assert copy.deepcopy(result[-1]).peak_pressure == result[-1].peak_pressure


def test_the_package_says_which_folder_has_a_name() -> None:
    for name, home in {"Bushing": "bodies", "Laminate": "model", "failure_load": "assess"}.items():
        with pytest.raises(AttributeError, match=f"there is fastpin.{home}.{name}$"):
            getattr(fastpin, name)
    with pytest.raises(AttributeError, match=r"there is fastpin\.studies\.sweep or fastpin\.figures\.sweep or "):
        fastpin.sweep  # noqa: B018
    with pytest.raises(AttributeError, match=r"No fastpin attribute nothing$"):
        fastpin.nothing  # noqa: B018


def test_words_that_users_write_first(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match='did you mean "smith-watson-topper"'):
        FatigueAssessment(criterion="SWT")
    with pytest.raises(InputError, match='did you mean "plate"'):
        FatigueAssessment(bodies=["lug"])
    with pytest.raises(InputError, match=r'pin: must be a Material, such as MATERIALS\["steel"\], not "steel"'):
        fastpin.MaterialPair("steel", fastpin.MATERIALS["steel"])  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r'path: must be the name of a file, not "hoop"; .* write kind="hoop"'):
        sample_result().plot("hoop")
    with pytest.raises(SystemExit):
        parser().parse_args(["solve"])
    assert 'did you mean "run"?' in capsys.readouterr().err


def test_a_list_of_cycles_takes_what_their_number_takes() -> None:
    assert Wear(1e-15, cycles=1e6, at=[1e5, 10**6]).at == (100_000, 1_000_000)  # type: ignore[arg-type, list-item]
    with pytest.raises(InputError, match=r"at: must be a whole number, not 1\.5"):
        Wear(1e-15, cycles=10, at=[1.5])  # type: ignore[list-item]


def test_degrees_for_radians_are_doubted() -> None:
    with pytest.warns(InputWarning, match="theta: 90 rad is 5,157 degrees; angles are in rad"):
        fastpin.Points.at_depth(0.0, [-90.0, 0.0, 90.0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fastpin.Points.at_depth(0.0, [-7.0, 12.5])
