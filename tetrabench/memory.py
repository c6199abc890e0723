"""How much memory there is, and refusal of what needs more of it, before it is gone."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from tetrabench.errors import MemoryRefusedError

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

ROOT = Path("/")  # a test puts another one here


def refuse_if_too_large(what: str, needed: float, advice: str = "take a smaller one, or a machine with more") -> None:
    """Refuse what would exhaust the memory.

    Args:
        what: the thing that needs it, the subject of the message.
        needed: an estimate of it, in bytes.
        advice: what to do next.

    Raises:
        MemoryRefusedError: `needed` is more than `available_bytes`.
    """
    available = available_bytes()
    if available is not None and needed > available:
        sizes = f"needs about {spell_bytes(needed)} of memory, {spell_bytes(available)} are available"
        raise MemoryRefusedError(f"{what} {sizes}; {advice}")


def available_bytes() -> int | None:
    """Memory that this process can still take, in bytes: the least of what the machine has left, the control groups
    of the process leave it, and its limit of address space. None where the system tells nothing."""
    return min((max(0, limit) for limit in _limits()), default=None)


@contextlib.contextmanager
def held_to_available() -> Iterator[None]:
    """Let an allocation of more than there is fail with MemoryError, rather than end the process or its neighbours: for
    code of others, which takes what a damaged file tells it to. Does nothing where the system has no such limit."""
    available, used = available_bytes(), _address_space()
    if resource is None or available is None or not used:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = used + available
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def spell_bytes(count: float) -> str:
    """Write a number of bytes in GiB, or below one in MiB."""
    size, unit = (count / 2**30, "GiB") if count >= 2**30 else (count / 2**20, "MiB")
    return f"{size:,.{0 if size >= 10 else 1}f} {unit}"


def _limits() -> Iterator[int]:
    machine = _read(ROOT / "proc/meminfo").partition("MemAvailable:")[2].split()
    if machine:
        yield 1024 * int(machine[0])
    elif "SC_PHYS_PAGES" in getattr(os, "sysconf_names", {}):  # no Linux: at least all that was ever built in
        yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    for line in _read(ROOT / "proc/self/cgroup").splitlines():
        _, controllers, group = line.split(":", 2)
        if not controllers:  # version 2
            yield from _left_in_groups("sys/fs/cgroup", group, "memory.max", "memory.current")
        elif "memory" in controllers.split(","):
            names = "memory.limit_in_bytes", "memory.usage_in_bytes"
            yield from _left_in_groups("sys/fs/cgroup/memory", group, *names)
    yield from _left_in_address_space()


def _left_in_groups(mount: str, group: str, limit_name: str, usage_name: str) -> Iterator[int]:
    """What a control group and those around it leave. A container may see its own group at the mount point."""
    top = ROOT / mount
    folder = top / group.lstrip("/")
    for place in (folder, *folder.parents):
        limit, usage = _read(place / limit_name).strip(), _read(place / usage_name).strip()
        if limit.isdigit() and usage.isdigit():
            # Pages of files that nobody has touched lately count as used, and are given back when wanted.
            cached = dict(line.split() for line in _read(place / "memory.stat").splitlines())
            yield int(limit) - int(usage) + int(cached.get("inactive_file", 0))
        if place == top:
            break


def _left_in_address_space() -> Iterator[int]:
    limit = resource.getrlimit(resource.RLIMIT_AS)[0] if resource else -1
    if resource and limit != resource.RLIM_INFINITY:
        yield limit - _address_space()


def _address_space() -> int:
    """Bytes of addresses that the process has in use, of which memory stands behind some. 0 where nobody knows."""
    pages = _read(ROOT / "proc/self/statm").split()
    return int(pages[0]) * os.sysconf("SC_PAGE_SIZE") if pages else 0


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:
        return ""
