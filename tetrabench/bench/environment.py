"""What figures depend on: processor, memory, system, versions, load. No host name, no path of the user's."""

import os
import platform
import subprocess
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TypeVar

PACKAGES = ("tetrabench", "numpy", "numba", "llvmlite")

Fact = TypeVar("Fact")
Facts = dict[str, str | int | float | None]


def describe_environment() -> Facts:
    """The environment as it is now, flat; None for what this system cannot tell. Sizes in bytes."""
    return {
        "processor": _try(_processor) or platform.processor() or None,
        "architecture": platform.machine(),
        "cores": len(usable_cores()),
        **{f"cache_{name}_bytes": size for name, size in (_try(_caches) or {}).items()},
        "governor": _try(lambda: _text("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")),
        "memory_bytes": _try(lambda: os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")),
        "system": platform.system(),
        "kernel": platform.release(),
        "python": platform.python_version(),
        **{package: _version(package) for package in PACKAGES},
        "revision": _try(_revision),
        "load_1_minute": load(),
    }


def load() -> float | None:
    """Processes that were running or waiting to, over the last minute."""
    return _try(lambda: os.getloadavg()[0])


def usable_cores() -> list[int]:
    """The cores this process may run on, in order."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def cpu_ticks() -> tuple[int, int] | None:
    """Ticks of all cores since boot: (stolen by other guests of the machine, all); None off Linux."""
    return _try(_cpu_ticks)


def steal_share(before: tuple[int, int] | None, after: tuple[int, int] | None) -> float | None:
    """Share of the machine's time that other guests of the host took between two readings of `cpu_ticks`."""
    if before is None or after is None or before[1] == after[1]:
        return None
    return (after[0] - before[0]) / (after[1] - before[1])


def _cpu_ticks() -> tuple[int, int]:
    ticks = [int(field) for field in _text("/proc/stat").splitlines()[0].split()[1:9]]
    return ticks[7], sum(ticks)  # user, nice, system, idle, iowait, irq, softirq, steal


def _processor() -> str | None:
    lines = _text("/proc/cpuinfo").splitlines()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), None)


def _caches() -> dict[str, int]:
    """Bytes of each cache of the first core, such as {"l1d": 32768, "l2": ...}."""
    caches = {}
    for folder in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        letter = {"Data": "d", "Instruction": "i"}.get(_text(folder / "type"), "")
        caches[f"l{_text(folder / 'level')}{letter}"] = int(_text(folder / "size").removesuffix("K")) * 1024
    return caches


def _revision() -> str | None:
    """The git revision of the checkout, with a "+" where files were changed; None for an installed one."""
    top = Path(__file__).parents[2]
    if not (top / ".git").exists():
        return None
    revision = _git(top, "rev-parse", "HEAD")
    return revision + ("+" if _git(top, "status", "--porcelain") else "")


def _git(top: Path, *arguments: str) -> str:
    command = ["git", "-C", str(top), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _text(path: str | Path) -> str:
    return Path(path).read_text().strip()


def _try(fact: Callable[[], Fact]) -> Fact | None:
    try:
        return fact()
    except (OSError, ValueError, AttributeError, subprocess.SubprocessError):
        return None
