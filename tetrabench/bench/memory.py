"""Memory of this process: what is its own, its high-water mark, which can be reset, and what the allocator holds back.

VmHWM rather than `ru_maxrss`, which a child inherits from its parent. A structure built in memory that the
allocator had kept would not show at all: trim first, then reset. Where the system has none of this, functions
say None or do nothing.
"""

import ctypes
import gc
from pathlib import Path

_PROCESS = Path("/proc/self")

WEIGHING = {
    "MALLOC_MMAP_THRESHOLD_": "65536",  # what is freed goes back to the system at once
    "MALLOC_TRIM_THRESHOLD_": "65536",
    "MALLOC_ARENA_MAX": "1",
    "NUMPY_MADVISE_HUGEPAGE": "0",  # a page that is touched is not two megabytes
}
"""Environment of a process whose memory is looked at: what it holds is then what its structures hold."""


def trim_heap() -> bool:
    """Give the allocator's free memory back to the system (C: malloc_trim); False where the C library cannot."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (AttributeError, OSError, TypeError):  # not the GNU C library
        return False
    return True


def reset_peak() -> bool:
    """Lower the high-water mark to what is in use now; False where the system refuses."""
    try:
        (_PROCESS / "clear_refs").write_text("5")
    except OSError:
        return False
    return True


def peak_bytes() -> int | None:
    """The high-water mark of resident memory since the start or the last reset."""
    try:
        status = (_PROCESS / "status").read_text()
    except OSError:
        return None
    fields = dict(line.split(":", 1) for line in status.splitlines())
    return int(fields["VmHWM"].split()[0]) * 1024 if "VmHWM" in fields else None  # given in KiB


def private_bytes() -> int | None:
    """Resident bytes that this process has written to and shares with none, without the allocator's free ones."""
    gc.collect()
    trim_heap()
    try:
        rollup = (_PROCESS / "smaps_rollup").read_text()
    except OSError:
        return None
    return sum(int(line.split()[1]) * 1024 for line in rollup.splitlines() if line.startswith("Private_Dirty:"))
