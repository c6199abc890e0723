"""Memory of this process: its high-water mark, which can be reset, and what the allocator holds back.

VmHWM rather than `ru_maxrss`, which a child inherits from its parent. A structure built in memory that the
allocator had kept would not show at all: trim first, then reset. Where the system has none of this, functions
say None or do nothing.
"""

import ctypes
from contextlib import suppress
from pathlib import Path

_PROCESS = Path("/proc/self")


def trim_heap() -> None:
    """Give the allocator's free memory back to the system (C: malloc_trim)."""
    with suppress(AttributeError, OSError, TypeError):  # not the GNU C library
        ctypes.CDLL(None).malloc_trim(0)


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
