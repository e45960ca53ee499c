"""A result shows, draws, stores and exports itself; short forms stay short."""

import copy
import pickle
import sys

import numpy as np
import pytest

import fastpin
from fastpin.kernels import status
from fastpin.solver import run as run_module
from fastpin.solver.step import Stepper
from tests.support.samples import sample_result


@pytest.fixture(scope="module")
def result(titanium_in_aluminium) -> fastpin.Result:
    problem = fastpin.Problem(titanium_in_aluminium, 0.01, 2e-5, 0.4, "body")
    history = fastpin.LoadHistory([{"P": 2.42e6}]) + fastpin.LoadHistory([{"Q": 5e5}, {"Q": -5e5}]).repeated(3)
    return fastpin.solve(problem, history, nodes=101, error_bars=True)


def test_short_forms_have_a_few_lines(result):
    for thing in (result, result[0], result.problem, result.history, result.problem.pair, result.problem.pair.pin):
        text = repr(thing)
        assert 1 <= len(text.splitlines()) <= 5
        assert max(map(len, text.splitlines())) <= 120
        assert "array(" not in text


def test_short_forms_say_the_numbers(result):
    last = result[-1]
    assert f"{1e-6 * last.peak_pressure:.6g} MPa" in repr(last)
    assert "Q = -500 kN/m" in repr(last)
    assert "7 states, 101 nodes, path solver, complete, 3 cycles" in repr(result)
    assert repr(result.history) == "<LoadHistory: 7 corners of P, Q; 1 corner + 2 corners x 3>"
    assert "clearance 2e-05 m, friction 0.4" in repr(result.problem)


def test_states_without_contact_and_empty_results_have_short_forms():
    empty = sample_result()
    empty.states.clear()
    assert repr(empty) == "<Result: 0 states, 81 nodes, path solver, complete>"
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    problem = fastpin.Problem.from_load_parameter(pair, 0.1, 0.4)
    (state,) = fastpin.solve(problem, [{"sxx": 1e-3}], nodes=41)
    assert repr(state) == "<State at load point 1: sxx = 0.001 F/R, no contact, 41 nodes>"


@pytest.mark.gate
def test_notebooks_get_a_table_and_a_picture(result):
    for thing, rows in ((result, 7), (result[1], 1)):
        html = thing._repr_html_()
        assert html.count("\n") == rows + 1
        assert 'src="data:image/png;base64,' in html
    assert "shown: " not in result._repr_html_()


@pytest.mark.gate
def test_a_result_draws_itself(result, tmp_path):
    figure = result.plot(tmp_path / "a.png", title="Here")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert "Here" in figure.get_suptitle()


def test_chosen_states_are_drawn(result):
    for chosen, points in (([1, 7], "17"), (slice(1, 3), "23"), ("cycle", "567"), (None, "1234567")):
        zones = result.plot(states=chosen).axes[-1]
        assert "".join(label.get_text() for label in zones.get_yticklabels()) == points


@pytest.mark.gate
def test_a_result_and_its_file_give_the_same_dataset(result, tmp_path):
    pytest.importorskip("xarray")
    result.save(tmp_path / "a.h5")
    own, stored = result.to_xarray(), fastpin.storage.to_xarray(tmp_path / "a.h5")
    assert set(own.variables) == set(stored.variables)
    for name in own.variables:
        assert own[name].dims == stored[name].dims, name
        assert own[name].attrs == stored[name].attrs, name
        assert np.array_equal(own[name].values, stored[name].values, equal_nan=name == "old_places"), name
    assert set(own.coords) == set(stored.coords)


@pytest.mark.gate
def test_a_data_frame_has_a_row_a_state(result):
    pytest.importorskip("pandas")
    frame = result.to_dataframe()
    assert len(frame) == len(result)
    assert frame["load_point"].tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert frame["load_Q"].iloc[-1] == pytest.approx(-5e5)
    assert frame["peak_pressure"].tolist() == [state.peak_pressure for state in result]
    assert frame["contact_width"].iloc[0] == pytest.approx(result[0].contact[0][1] - result[0].contact[0][0])
    assert frame.attrs["units"]["peak_pressure"] == "Pa"
    assert frame.attrs["units"]["load_P"] == "N/m"
    without = {"load_point", "step", "fraction", "peak_hoop_outline_edge", "unresolved"}
    assert set(frame.attrs["units"]) == set(frame.columns) - without


@pytest.mark.parametrize("library", ["xarray", "pandas"])
def test_a_missing_library_is_named(result, monkeypatch, library):
    monkeypatch.setitem(sys.modules, library, None)
    export = result.to_xarray if library == "xarray" else result.to_dataframe
    with pytest.raises(fastpin.InputError, match=rf"is not installed: pip install 'fastpin\[{library}\]'"):
        export()


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda result: pickle.loads(pickle.dumps(result))])
def test_results_can_be_copied(result, copied):
    other = copied(result)
    assert len(other) == len(result)
    assert np.array_equal(other[-1].shear, result[-1].shear)
    assert dict(other[-1].error_bars) == pytest.approx(dict(result[-1].error_bars), rel=0.0, nan_ok=True)
    assert len(fastpin.solve(other.problem, [{"Q": 1e5}], start=other, error_bars=True)) == 1


def test_statuses_are_named_integers():
    assert [int(one) for one in fastpin.Status] == [-1, 0, 1, 2]
    assert fastpin.Status(0).name == "STICK"
    assert tuple(fastpin.Status) == (status.SLIP_NEGATIVE, status.STICK, status.SLIP_POSITIVE, status.OPEN)


def test_another_solver_is_one_class(result, monkeypatch):
    """A stepper that hands everything to another one is driven by the same loop."""

    class Handing:
        def __init__(self, inner: Stepper) -> None:
            self.inner, self.calls = inner, set()

        def __getattr__(self, name):
            self.calls.add(name)
            return getattr(self.inner, name)

    made: list[Handing] = []
    exact = run_module.stepper_of

    def handing(*arguments) -> Handing:
        made.append(Handing(exact(*arguments)))
        return made[-1]

    monkeypatch.setattr(run_module, "stepper_of", handing)
    other = fastpin.solve(result.problem, result.history, nodes=101)
    assert all(np.array_equal(a.pressure, b.pressure) for a, b in zip(other, result, strict=True))
    assert isinstance(made[-1], Handing)
    assert made[-1].calls == {"begin_piece", "advance", "leave"}


@pytest.mark.gate
def test_a_result_without_states_is_exported(similar):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.1)
    with pytest.raises(fastpin.NoEquilibriumError) as raised:
        fastpin.solve(problem, [{"P": 1.0, "M": 1.0}], nodes=51)
    empty = raised.value.result
    assert len(empty) == 0
    assert dict(empty.to_xarray().sizes) == {"state": 0, "theta": 51, "load_name": 12, "residual_name": 4}
    frame = empty.to_dataframe()
    assert len(frame) == 0
    assert "peak_pressure" in frame.columns
