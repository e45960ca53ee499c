"""Products in two threads: the right numbers, on parts of arrays, and the same bits whatever the machine has."""

from __future__ import annotations

import multiprocessing
import os

import numpy as np
import pytest

from fastpin.runtime import products
from fastpin.runtime.products import add_product
from fastpin.runtime.threads import in_one_thread
from tests.support.processes import finished, python


def arrays(m, k, n):
    rng = np.random.default_rng(m + k + n)
    return [np.asfortranarray(rng.normal(size=shape)) for shape in ((m, n), (m, k), (k, n))]


@pytest.mark.parametrize("shape", [(1, 1, 1), (5, 3, 4), (7, 1, 1), (1, 6, 3), (0, 3, 2), (4, 0, 3), (601, 300, 40)])
def test_it_adds_the_product(shape):
    out, left, right = arrays(*shape)
    expected = out + left @ right
    add_product(out, left, right)
    assert np.allclose(out, expected, rtol=1e-13, atol=1e-12)


def test_parts_of_arrays_are_changed_in_place():
    out, left, right = arrays(900, 200, 70)
    expected = out.copy()
    expected[10:810, 3:60] += left[10:810, 5:150] @ right[20:165, 3:60]
    add_product(out[10:810, 3:60], left[10:810, 5:150], right[20:165, 3:60])
    assert np.allclose(out, expected, rtol=1e-13, atol=1e-12)


@pytest.mark.parametrize("wrong", ["rows", "type", "strides"])
def test_arrays_of_another_layout_are_refused(wrong):
    out, left, right = arrays(6, 5, 4)
    every_second = np.asfortranarray(np.repeat(left, 2, axis=0))[::2]
    left = {"rows": np.ascontiguousarray(left), "type": left.astype(np.float32), "strides": every_second}[wrong]
    with pytest.raises(ValueError, match="column by column"):
        add_product(out, left, right)


def test_shapes_that_do_not_fit_are_refused():
    out, left, right = arrays(6, 5, 4)
    for wrong in ((out[1:], left, right), (out, left[:, 1:], right), (out[:, 1:], left, right)):
        with pytest.raises(ValueError, match="shapes"):
            add_product(*wrong)


def test_a_thread_that_outlives_the_interpreter_s_end_still_multiplies(monkeypatch):
    class Ended:
        def submit(self, *_):
            raise RuntimeError("cannot schedule new futures after interpreter shutdown")

    out, left, right = arrays(1203, 120, 64)
    expected = out.copy(order="F")
    add_product(expected, left, right)
    monkeypatch.setattr(products, "_second", Ended())
    add_product(out, left, right)
    assert np.array_equal(out, expected)


def test_the_second_thread_changes_no_bit(monkeypatch):
    out, left, right = arrays(1203, 120, 64)
    half = out.copy(order="F")
    add_product(out, left, right)
    monkeypatch.setattr(products, "WORTHWHILE", np.inf)
    for rows in (slice(0, 601), slice(601, 1203)):
        add_product(half[rows], left[rows], right)
    assert np.array_equal(out, half)


def forked(out, left, right):
    add_product(out, left, right)
    os._exit(0)


@pytest.mark.gate
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no processes by forking")
def test_a_forked_process_makes_its_own_thread():
    out, left, right = arrays(1203, 120, 64)
    add_product(out, left, right)  # the thread is there
    process = multiprocessing.get_context("fork").Process(target=forked, args=(out, left, right))
    process.start()
    process.join(20.0)
    assert process.exitcode == 0


HISTORY = """
import hashlib
import fastpin
from fastpin.elasticity import operator
from fastpin.solver import tableau
pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4, pin_load="body")
result = fastpin.solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=701, arc=(-3.0, -0.1))
digest = hashlib.sha256()
operator.LARGEST_DENSE, tableau.WORTHWHILE = 3, 1  # Fourier transforms
transformed = fastpin.solve(problem, [{"P": 1.0}, {"Q": 0.3}], nodes=521, arc=(-3.0, -0.1))
for state in [*result, *transformed]:
    for name in ("pressure", "shear", "gap", "slip"):
        digest.update(getattr(state, name).tobytes())
    digest.update(repr((state.dx, state.dy, state.rotation, state.dissipation, state.work, state.energy)).encode())
print(digest.hexdigest())
"""


@pytest.mark.survey
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="cores can't be chosen")
def test_results_have_the_same_bits_with_any_number_of_threads_and_cores():
    one_core = f"import os; os.sched_setaffinity(0, {{{min(os.sched_getaffinity(0))}}})\n"
    digests = set()
    for threads, before in (("1", ""), ("4", ""), ("2", one_core)):
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": threads, "OMP_NUM_THREADS": threads}
        environment["NUMBA_NUM_THREADS"] = threads
        digests.add(finished(python(before + HISTORY), env=environment).stdout)
    assert len(digests) == 1


def test_one_thread_makes_the_same_bits(monkeypatch):
    out, left, right = arrays(1203, 120, 64)
    alone, expected = out.copy(order="F"), out.copy(order="F")
    add_product(expected, left, right)
    monkeypatch.setattr(products, "_second", None)
    with in_one_thread():
        add_product(alone, left, right)
    assert products._second is None
    assert np.array_equal(alone, expected)
    add_product(out, left, right)
    assert products._second is not None
