"""The kernels of a test file, compiled and as plain Python."""

import pytest

from tests.support.kernels import run_as_python


@pytest.fixture(params=["compiled", "python"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """How the kernels of the module KERNELS run."""
    if request.param == "python":
        run_as_python(request.module.KERNELS, monkeypatch)
    return request.param
