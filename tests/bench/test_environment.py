"""What a process can tell of itself and of the machine."""

import os
import platform
import socket
import sys

import msgspec
import numpy as np
import pytest

from tetrabench.bench.environment import describe_environment, usable_cores
from tetrabench.bench.memory import peak_bytes, reset_peak, trim_heap

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


def test_the_environment_is_flat_and_names_nobody():
    facts = describe_environment()
    assert facts["python"] == platform.python_version()
    assert facts["numpy"] == np.__version__
    assert facts["cores"] == len(usable_cores()) >= 1
    text = msgspec.json.encode(facts).decode()
    assert all(value is None or isinstance(value, str | int | float) for value in facts.values())
    assert os.path.expanduser("~") + "/" not in text
    assert socket.gethostname() not in facts.values()


@LINUX
def test_the_peak_shows_what_has_gone_again():
    trim_heap()
    if not reset_peak():
        pytest.skip("this system does not reset the high-water mark")
    before = peak_bytes()
    block = np.ones(8_000_000)
    del block
    trim_heap()
    assert peak_bytes() - before > 60_000_000
    assert reset_peak()
    assert peak_bytes() - before < 10_000_000
