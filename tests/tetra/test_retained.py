"""What the buffers of a net say that they take is what the process keeps."""

import pytest
from numba import config

from tests.tetra.retained import ROLLUP, in_fresh_process


@pytest.mark.skipif(not ROLLUP.is_file(), reason="the system does not say how much memory is private")
@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="a net of this size takes minutes without the JIT")
@pytest.mark.parametrize("name", ["v3y", "v5y"])
def test_a_net_keeps_what_its_buffers_take(name):
    parts = in_fresh_process(name, 100_000)
    assert parts["fields"] == 232
    assert 32 < parts["incidence"] < 33  # four entries of 8 bytes, and a head for each point
    assert set(parts) == {"fields", "incidence", "tree", "points", "sum", "retained"}
    assert abs(parts["retained"] / parts["sum"] - 1) < 0.05
