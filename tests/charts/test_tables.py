"""The tables: interpolation, error bounds, the file."""

from pathlib import Path

import numpy as np
import pytest

from fastpin.charts.groups import (
    DATA,
    GROUPS,
    STORED,
    VERSION,
    ChartTable,
    load_parameter_at,
    read_tables,
    width_coordinate,
    write_tables,
)
from fastpin.errors import InputError
from scripts.charts_data import cell_bounds

MOST_BYTES = 2_000_000


def polynomial_table(name: str, order: int) -> ChartTable:
    """A table whose stored values are a product of polynomials that its interpolation reproduces."""
    group = GROUPS[name]
    units = np.meshgrid(*(np.linspace(0.0, 1.0, nodes) for nodes in group.shape), indexing="ij")
    values = np.stack([polynomial(units, order) + k for k in range(len(group.quantities))], axis=-1)
    cells = [nodes - 1 for nodes in group.shape]
    bounds = np.stack([np.arange(np.prod(cells)).reshape(cells) + 1.0] * len(group.quantities), axis=-1)
    return ChartTable(group, values, [order] * len(group.quantities), bounds)


def polynomial(units: list[np.ndarray], order: int) -> np.ndarray:
    degree = min(order - 1, 2)
    return np.prod([1.0 + k * unit - 0.3 * unit**degree for k, unit in enumerate(units, start=1)], axis=0)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("name", GROUPS)
def test_polynomials_are_exact_for_numbers_and_arrays(name: str, order: int) -> None:
    table = polynomial_table(name, order)
    quantity = table.group.quantities[1]
    units = list(np.random.default_rng(3).random((len(table.group.axes), 20)))
    expected = polynomial(units, order) + 1.0
    np.testing.assert_allclose(table.stored_at(quantity, units), expected, rtol=1e-12)
    one = [table.stored_at(quantity, place) for place in np.transpose(units).tolist()]
    np.testing.assert_allclose(one, expected, rtol=1e-12)


def test_nodes_and_ends_of_the_axes_are_exact() -> None:
    table = polynomial_table("held", 4)
    quantity = table.group.quantities[0]
    for place in ([0.0] * 4, [1.0] * 4, [0.0, 1.0, 0.5, 1.0 / 3.0]):
        expected = float(polynomial([np.array(unit) for unit in place], 4))
        assert table.stored_at(quantity, place) == pytest.approx(expected, rel=1e-12)


def test_each_cell_has_its_own_bound() -> None:
    table = polynomial_table("held", 4)
    assert table.cell([0.0] * 4) == (0, 0, 0, 0)
    assert table.cell([1.0] * 4) == (10, 7, 1, 8)
    units = [np.array([0.0, 1.0]) for _ in range(4)]
    assert [index.tolist() for index in table.cell(units)] == [[0, 10], [0, 7], [0, 1], [0, 8]]
    assert table.value_at("cycle_energy", [0.0] * 4, 0.02)[1] == 1.0
    assert table.value_at("cycle_energy", [1.0] * 4, 3.0)[1] == 11 * 8 * 2 * 9


def kinked_table() -> ChartTable:
    """A table of Kt is smooth, but has a kink across the first axis. It bends one cell and its neighbours."""
    group = GROUPS["like_body"]
    x, y, _ = np.meshgrid(*(np.linspace(0.0, 1.0, nodes) for nodes in group.shape), indexing="ij")
    kt = 2.0 + 0.1 * np.sin(x + y) + np.abs(x - 0.512)
    none = np.zeros((*(nodes - 1 for nodes in group.shape), len(group.quantities)))
    return ChartTable(group, np.stack([kt] * len(group.quantities), axis=-1), [4] * len(group.quantities), none)


def test_bounds_are_large_beside_a_kink_only() -> None:
    table = kinked_table()
    draw = np.random.default_rng(1)
    low, high = np.array([(axis.least, axis.most) for axis in table.group.axes]).T
    units = draw.random((400, 3))
    near = np.abs(units[:, 0] - 0.512) < 1.0 / 40.0
    errors = np.where(near, 4e-3, 1e-5) * draw.random(400)
    most = np.full(table.group.regions, 16e-3)
    bounds = cell_bounds(table, "kt_bearing", low + (high - low) * units, errors, most)
    assert bounds.shape == (40, 32, 2)
    assert 4e-3 < bounds[20].min() <= bounds.max() < 20e-3
    assert bounds[:15].max() < 1e-4
    assert (bounds[tuple(table.cell(list(units.T)))] >= errors).all()
    jumping = cell_bounds(table, "peak_hoop_angle", low + (high - low) * units, errors, most)
    assert 16e-3 <= jumping.min() <= jumping.max() < 17e-3


def test_scales_and_coordinates_have_their_inverses() -> None:
    at = np.array([0.0, 0.1, 10.0])
    np.testing.assert_allclose(load_parameter_at(width_coordinate(at)), at, atol=1e-15)
    for stored in STORED.values():
        np.testing.assert_allclose(stored.value(stored.stored(0.7, at), at), 0.7)


@pytest.mark.parametrize("name", GROUPS)
def test_parameters_of_a_place_lead_back_to_it(name: str) -> None:
    from fastpin.charts.groups import COORDINATES

    group = GROUPS[name]
    for part in (0.0, 0.3, 1.0):
        place = np.array([axis.least + part * (axis.most - axis.least) for axis in group.axes])
        given = group.parameters_at(place)
        found = [COORDINATES[axis.name](given) for axis in group.axes]
        np.testing.assert_allclose(found, place, rtol=1e-12, atol=1e-12)


def test_a_file_comes_back(tmp_path: Path) -> None:
    written = {name: polynomial_table(name, 4) for name in GROUPS}
    write_tables(tmp_path / "charts.npz", written)
    for name, table in read_tables(tmp_path / "charts.npz").items():
        for quantity in table.group.quantities:
            np.testing.assert_allclose(table.values[quantity], written[name].values[quantity], rtol=1e-7)
        np.testing.assert_array_equal(table.bounds, written[name].bounds)


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "charts.npz"
    content = DATA.read_bytes()
    for damaged in (b"", b"no tables", content[:1000], content[:-1000]):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="charts: the file of the charts is damaged"):
            read_tables(path)
    np.savez(path, version=np.array(99))
    with pytest.raises(InputError, match="has the version 99, not"):
        read_tables(path)
    np.savez(path, version=np.array(VERSION), like_body_values=np.array([{}], dtype=object))
    with pytest.raises(InputError, match="is damaged"):
        read_tables(path)


def test_the_data_is_small_and_whole() -> None:
    assert DATA.stat().st_size < MOST_BYTES
    for table in read_tables(DATA).values():
        assert all(np.isfinite(values).all() for values in table.values.values())
        assert np.isfinite(table.bounds).all()
        assert (table.bounds > 0.0).all()
