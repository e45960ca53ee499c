"""The seat of a bush that slips as a dataset, a data frame and a file."""

from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import storage
from fastpin.storage import packed, store
from fastpin.storage.layout import WITH_SEAT
from tests.support.refusals import refused
from tests.support.seats import sample_case, sample_seat, stored_sample


@pytest.mark.gate
def test_joint_and_seat_are_datasets_of_their_own(tmp_path: Path) -> None:
    path, result = stored_sample(tmp_path / "joint.h5"), sample_seat()
    for joint in (result.to_xarray(), storage.to_xarray(path)):
        assert joint["pressure"].shape == (10, 48)
        assert not any(name.startswith("seat") for name in joint)
    seat = result.seat.to_xarray()
    assert seat["pressure"].shape == (10, result.seat.grid.size)
    assert np.array_equal(seat["slip"].values[-1], result[-1].seat.slip)
    assert seat["rotation"].values[-1] == result[-1].seat.rotation
    assert fastpin.load(path).seat.to_xarray().equals(seat)


@pytest.mark.gate
def test_the_data_frame_of_the_seat() -> None:
    seat = sample_seat().seat
    frame = seat.to_dataframe()
    assert frame["rotation"].tolist() == [state.rotation for state in seat]
    assert frame["peak_hoop"].tolist() == [state.peak_hoop_stress().value for state in seat]
    assert frame["peak_hoop_seat"].isna().all()


def test_the_cycles_of_the_seat_are_those_of_the_bush() -> None:
    result = sample_seat()
    seat = result.seat
    for number, (cycle, own) in enumerate(zip(result.cycles, seat.cycles, strict=True)):
        first, last = seat[3 * number], seat[3 * number + 3]
        assert own.rotation_change == last.rotation - first.rotation
        assert own.dissipation == last.dissipation - first.dissipation
        assert own.dissipation < cycle.dissipation
        assert (own.corner, own.shear_change) == (cycle.corner, cycle.shear_change)
    case = sample_case()
    few = fastpin.solve(case.problem, case.history, nodes=48, keep="every 4").seat
    assert np.isnan([cycle.rotation_change for cycle in few.cycles]).any()


def test_a_seat_is_saved_with_its_joint_only(tmp_path: Path) -> None:
    error = refused(sample_seat().seat.save, tmp_path / "seat.h5")
    assert str(error) == "result: is the seat of a bush: save the result of its joint, which holds the seat"


def test_a_packed_joint_keeps_its_seat() -> None:
    result = sample_seat()
    content = store.pack(result, None, 10**7)
    assert packed.from_bytes(content).attrs["format_version"] == WITH_SEAT == 5
    back = store.unpack(content, Path("a"))[0].seat
    assert all(np.array_equal(one.slip, other.slip) for one, other in zip(back, result.seat, strict=True))
