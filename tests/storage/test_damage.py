"""Results with damaged parts: every reader says in one sentence what is wrong."""

import resource
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.storage import hdf5, to_xarray
from tests.support.files import replaced, written


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a good file."""
    path = tmp_path_factory.mktemp("whole") / "result.h5"
    steel = fastpin.MATERIALS["steel"]
    problem = fastpin.Problem.from_load_parameter(fastpin.MaterialPair(steel, steel), 0.1, 0.4)
    history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(2)
    fastpin.record(problem, history, path, nodes=31, save_after=[2])
    return path.read_bytes()


@pytest.fixture
def path(whole: bytes, path: Path) -> Path:
    """A copy of the good file."""
    path.write_bytes(whole)
    return path


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (replaced("states/pressure", 5.0), "states/pressure"),
        (replaced("states/pressure", ["a", "b"]), "states/pressure has numbers of the type"),
        (written("states/pressure", (0, 3), np.nan), "states/pressure has a number that is not finite"),
        (written("states/status", (0, 3), 77), "states/status has a number outside -1 to 2"),
        (written("states/step", 0, 1000), "states/step has a number outside 0 to 4"),
        (written("states/fraction", 0, -1.0), "states/fraction has a number outside 0 to 1"),
        (written("history/blocks", (0, 1), -3), "count: must be a whole number"),
        (written("history/corners", (0, 0), np.inf), "given: must be finite numbers"),
        (written("restart/latest/load", 0, np.nan), "load has a number that is not finite"),
        (written("restart/latest/configurations/pressure", (0, 0), np.inf), "is not finite"),
        (lambda file: file["restart/latest"].attrs.__setitem__("force", 0.0), "force: must lie between"),
        (lambda file: file["restart/latest"].attrs.__setitem__("corner", "x"), "corner: must be a whole number"),
        (lambda file: file["solver/statistics"].attrs.__setitem__("events", "x"), "events: must be a number"),
        (lambda file: file.attrs.__setitem__("format", [1, 2]), "is damaged|not a result of fastpin"),
        (lambda file: file.attrs.__delitem__("format"), "not a result of fastpin"),
    ],
)
def test_a_damaged_result_is_described(path, change, reason):
    with h5py.File(path, "r+") as file:
        change(file)
    before = path.read_bytes()
    with pytest.raises(InputError, match=reason) as raised:
        fastpin.load(path)
    assert "\n" not in str(raised.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize("name", ["state", "theta", "load_name", "residual_name"])
def test_a_result_without_its_scales_is_described(path, name):
    """HDF5 itself crashes when it follows a reference to a removed scale."""
    with h5py.File(path, "r+") as file:
        del file[f"states/{name}"]
    with pytest.raises(InputError, match="is damaged"):
        to_xarray(path)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda file: replaced("states/gap", file["states/gap"][()])(file), "states/gap can't grow"),
        (lambda file: file.__delitem__("solver/statistics"), "is damaged"),
    ],
)
def test_a_damaged_unfinished_result_is_not_continued(path, change, reason):
    """Statistics are written again at the end of the run, which must not fail there."""
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
        change(file)
    with pytest.raises(InputError, match=reason):
        fastpin.resume(path)


def linked(name: str, link: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file.move(name, "away")
        file[name] = link

    return change


def external(file: h5py.File) -> None:
    rows, size = file["states/pressure"].shape
    del file["states/pressure"]
    file["states"].create_dataset("pressure", (rows, size), float, external=[("precious.txt", 0, rows * size * 8)])


def virtual(file: h5py.File) -> None:
    shape = file["states/pressure"].shape
    del file["states/pressure"]
    layout = h5py.VirtualLayout(shape, float)
    layout[...] = h5py.VirtualSource("other.h5", "pressure", shape)
    file["states"].create_virtual_dataset("pressure", layout)


def remade(name: str, **how: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        old = file[name]
        del file[name]
        file.create_dataset(name, **({"shape": old.shape, "dtype": old.dtype} | how))

    return change


def resized(names: tuple[str, ...], rows: int) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        for name in names or [f"states/{name}" for name in file["states"] if file["states"][name].maxshape[0] is None]:
            file[name].resize(rows, axis=0)

    return change


HOSTILE = {
    "external link": (linked("states", h5py.ExternalLink("precious.txt", "/states")), "states is a link"),
    "soft link": (linked("states/pressure", h5py.SoftLink("/away")), "states/pressure is a link"),
    "link in a restart": (linked("restart/latest/met", h5py.SoftLink("/away")), "restart/latest/met is a link"),
    "external storage": (external, "states/pressure lies in another file"),
    "virtual": (virtual, "states/pressure lies in another file"),
    "filter": (remade("states/pressure", chunks=(1, 31), compression="lzf"), "is packed in an unknown way"),
    "chunk": (remade("states/gap", chunks=(10**6, 31), shape=(0, 31), maxshape=(None, 31)), "has chunks of the shape"),
    "references": (remade("states/step", dtype=h5py.ref_dtype), "states/step has"),
    "many rows": (resized((), 300_000_000), "only .* bytes in the file"),
    "many history ends": (remade("history/ends", shape=(10**11,), chunks=(1024,)), "only .* bytes in the file"),
    "many lengths": (remade("history/cycle_lengths", shape=(10**11,), chunks=(1024,)), "only .* bytes in the file"),
    "many nodes": (remade("grid/theta", shape=(10**11,), chunks=(1024,)), "only .* bytes in the file"),
    "large restart": (remade("restart/latest/met", shape=(10**11, 5), chunks=(128, 5)), "only .* bytes in the file"),
    "texts": (lambda file: file["solver"].attrs.__setitem__("method", ["x"] * 2000), "has 2000 texts"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_hostile_result_takes_no_memory_and_no_other_file(whole, path, tmp_path, kind):
    change, reason = HOSTILE[kind]
    (tmp_path / "precious.txt").write_bytes(whole if "link" in kind else bytes(10_000))
    with h5py.File(path, "r+") as file:
        change(file)
        file.attrs["complete"] = True
    before = {each: each.read_bytes() for each in tmp_path.iterdir()}
    limits = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    try:
        resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 28), limits[1]))
        with pytest.raises(InputError, match=f"a.h5: is damaged: .*{reason}"):
            fastpin.load(path)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
    before[path] = path.read_bytes()
    with pytest.raises(InputError, match="is damaged"):
        fastpin.resume(path)
    assert {each: each.read_bytes() for each in tmp_path.iterdir() if each.suffix != ".journal"} == before


@pytest.mark.gate
def test_large_arrays_are_read_in_parts_between_which_an_interrupt_is_heard(tmp_path, monkeypatch):
    values = np.random.default_rng(0).random((1000, 7))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = values
    with h5py.File(tmp_path / "a.h5", "r") as file:
        array = hdf5.Group(file)["a"]
        picks = [(), slice(None), slice(3, 999), slice(5, -5), slice(7, 3), slice(0, 1000, 3), 4, -1]
        for most in (hdf5.AT_ONCE, 1, 100, 7 * 8 * 10):
            monkeypatch.setattr(hdf5, "AT_ONCE", most)
            for pick in picks:
                assert np.array_equal(array[pick], values[pick])
        read = h5py.Dataset.read_direct
        parts = []

        def interrupted(*args: Any) -> None:
            parts.append(args)
            if len(parts) == 3:
                signal.raise_signal(signal.SIGINT)
            read(*args)

        monkeypatch.setattr(h5py.Dataset, "read_direct", interrupted)
        with pytest.raises(KeyboardInterrupt):
            array[()]
        assert len(parts) == 3


def test_zeros_of_a_real_result_are_no_claim(tmp_path, monkeypatch):
    """Zeros are packed as fastpin packs them, in rows of the largest number of nodes."""
    monkeypatch.setattr(hdf5, "AT_ONCE", 1)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, dtype in (("gap", float), ("status", np.int8)):
            made = file.create_dataset(
                name, (5, 20_000), dtype, chunks=(1, 20_000), compression="gzip", compression_opts=1, shuffle=True
            )
            made[...] = 0
    with h5py.File(tmp_path / "a.h5", "r") as file:
        assert not any(hdf5.Group(file)[name][()].any() for name in ("gap", "status"))


def test_an_error_of_a_value_names_the_file(path):
    for given, reason in (({"after": 99}, "^after: must be"), ({"states": [99]}, "^states: must be")):
        with pytest.raises(InputError, match=reason):
            fastpin.load(path, **given)
    with h5py.File(path, "r+") as file:
        file["problem/pin"].attrs["E"] = np.nan
    with pytest.raises(InputError, match=r"a\.h5: is damaged: E: must be"):
        fastpin.load(path)


def test_a_special_file_is_not_written(path):
    with pytest.raises(InputError, match=r"^/dev/full: must be an ordinary file"):
        fastpin.save(fastpin.load(path), "/dev/full")


@pytest.mark.gate
def test_zeros_that_are_packed_as_small_as_possible_are_read(tmp_path):
    """Deflate packs zeros best in large chunks. Rows that were never written are refused all the same."""
    rows = 10_000
    with h5py.File(tmp_path / "a.h5", "w") as file:
        packed = file.create_dataset("a", (rows, 401), chunks=(rows, 401), maxshape=(None, 401), dtype=float,
                                     shuffle=True, compression="gzip", compression_opts=9)  # fmt: skip
        packed[()] = 0.0
        file.flush()
        assert 1000 < packed.nbytes / packed.id.get_storage_size() < hdf5.LARGEST_RATIO
        assert hdf5.Group(file)["a"][()].shape == (rows, 401)
        packed.resize(rows * 101 // 100, axis=0)
        with pytest.raises(ValueError, match=r"only .* bytes in the file"):
            hdf5.Group(file)["a"]
