"""Refusal of what needs more memory than there is, on machines made of files."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tetrabench import memory
from tetrabench.errors import MemoryRefusedError
from tetrabench.memory import available_bytes, refuse_if_too_large, spell_bytes

GIB = 2**30
MEMINFO = "MemTotal: 24000000 kB\nMemFree: 1000 kB\nMemAvailable: 22020096 kB\nBuffers: 5 kB\n"  # 21 GiB

Machine = Callable[..., None]


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Machine:
    """A machine with these files and no limit of its own."""
    monkeypatch.setattr(memory, "ROOT", tmp_path)
    if memory.resource:
        unlimited = (memory.resource.RLIM_INFINITY,) * 2
        monkeypatch.setattr(memory.resource, "getrlimit", lambda _: unlimited)

    def make(files: dict[str, str]) -> None:
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)

    return make


def test_what_the_machine_has_left(machine: Machine) -> None:
    machine({"proc/meminfo": MEMINFO})
    assert available_bytes() == 21 * GIB


def test_no_linux_has_at_most_what_is_built_in(machine: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.sysconf", {"SC_PHYS_PAGES": 1000, "SC_PAGE_SIZE": 4096}.get)
    assert available_bytes() == 4096000
    monkeypatch.setattr("os.sysconf_names", {})
    assert available_bytes() is None
    refuse_if_too_large("anything", 1e30)  # nobody knows


GROUPS = {
    "none": ({}, 21 * GIB),
    "version 2": (
        {
            "proc/self/cgroup": "0::/user/app\n",
            "sys/fs/cgroup/user/app/memory.max": f"{4 * GIB}\n",
            "sys/fs/cgroup/user/app/memory.current": f"{GIB}\n",
        },
        3 * GIB,
    ),
    "version 2, files in the cache": (
        {
            "proc/self/cgroup": "0::/app\n",
            "sys/fs/cgroup/app/memory.max": f"{4 * GIB}\n",
            "sys/fs/cgroup/app/memory.current": f"{3 * GIB}\n",
            "sys/fs/cgroup/app/memory.stat": f"anon 7\ninactive_file {2 * GIB}\nactive_file 5\n",
        },
        3 * GIB,
    ),
    "version 2, around it": (
        {
            "proc/self/cgroup": "0::/user/app\n",
            "sys/fs/cgroup/user/memory.max": f"{2 * GIB}\n",
            "sys/fs/cgroup/user/memory.current": f"{GIB}\n",
            "sys/fs/cgroup/user/app/memory.max": "max\n",
            "sys/fs/cgroup/user/app/memory.current": f"{GIB}\n",
        },
        GIB,
    ),
    "version 2, in a container": (
        {
            "proc/self/cgroup": "0::/../../system/x\n",
            "sys/fs/cgroup/memory.max": f"{5 * GIB}\n",
            "sys/fs/cgroup/memory.current": f"{GIB}\n",
        },
        4 * GIB,
    ),
    "version 1": (
        {
            "proc/self/cgroup": "9:name=systemd:/\n4:cpu,memory:/docker/x\n0::/\n",
            "sys/fs/cgroup/memory/docker/x/memory.limit_in_bytes": f"{6 * GIB}\n",
            "sys/fs/cgroup/memory/docker/x/memory.usage_in_bytes": f"{GIB}\n",
        },
        5 * GIB,
    ),
    "version 1, none set": (
        {
            "proc/self/cgroup": "4:memory:/x\n",
            "sys/fs/cgroup/memory/x/memory.limit_in_bytes": "9223372036854771712\n",
            "sys/fs/cgroup/memory/x/memory.usage_in_bytes": f"{GIB}\n",
        },
        21 * GIB,
    ),
    "over its limit": (
        {
            "proc/self/cgroup": "0::/app\n",
            "sys/fs/cgroup/app/memory.max": "10\n",
            "sys/fs/cgroup/app/memory.current": "20\n",
        },
        0,
    ),
}


@pytest.mark.parametrize(("files", "left"), GROUPS.values(), ids=GROUPS.keys())
def test_what_the_control_groups_leave(machine: Machine, files: dict[str, str], left: int) -> None:
    machine({"proc/meminfo": MEMINFO, **files})
    assert available_bytes() == left


@pytest.mark.skipif(memory.resource is None, reason="no limits on Windows")
def test_limit_of_addresses(machine: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    machine({"proc/meminfo": MEMINFO, "proc/self/statm": "1000 1 1 1 0 1 0\n"})
    monkeypatch.setattr(memory.resource, "getrlimit", lambda _: (GIB, 2 * GIB))
    assert available_bytes() == GIB - 1000 * memory.os.sysconf("SC_PAGE_SIZE")


def test_refusal_says_what_is_needed_and_what_there_is(machine: Machine) -> None:
    machine({"proc/meminfo": MEMINFO})
    refuse_if_too_large("a model of 10 tets", 21 * GIB)
    with pytest.raises(MemoryRefusedError) as caught:
        refuse_if_too_large("a model of 3,000,000,000 tets", 310 * GIB)
    expected = (
        "a model of 3,000,000,000 tets needs about 310 GiB of memory, 21 GiB are available; "
        "take a smaller one, or a machine with more"
    )
    assert str(caught.value) == expected
    assert caught.value.exit_code == 6


def test_sizes_in_words() -> None:
    sizes = {0: "0.0 MiB", 2**20 * 1.5: "1.5 MiB", GIB - 1: "1,024 MiB", GIB: "1.0 GiB", 2345.6 * GIB: "2,346 GiB"}
    assert {size: spell_bytes(size) for size in sizes} == sizes


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux limits addresses")
def test_allocations_beyond_it_fail() -> None:
    """In a process of its own: the allocator of this one may hold a GiB that earlier tests gave back."""
    subprocess.run([sys.executable, "-c", BEYOND], check=True)


BEYOND = """
import numpy as np
from tetrabench import memory
from tetrabench.memory import held_to_available

GIB = 2**30
before = memory.resource.getrlimit(memory.resource.RLIMIT_AS)
memory.available_bytes = lambda: GIB // 2
with held_to_available():
    try:
        np.empty(GIB, np.uint8)
    except MemoryError:
        pass
    else:
        raise AssertionError("there is more than there is")
assert memory.resource.getrlimit(memory.resource.RLIMIT_AS) == before
assert np.empty(GIB, np.uint8).size == GIB
memory.available_bytes = lambda: None
with held_to_available():
    assert np.empty(GIB, np.uint8).size == GIB
"""
