"""What can be trusted on this machine: facts that measuring depends on, what each means, what to do about it."""

import functools
import os
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from statistics import quantiles
from typing import TYPE_CHECKING

import msgspec

from tetrabench import memory
from tetrabench.bench.environment import cpu_ticks, load, steal_share, usable_cores
from tetrabench.bench.memory import peak_bytes, reset_peak, trim_heap
from tetrabench.bench.pairs import FEWEST, Ratio, in_turn, paired_ratio
from tetrabench.errors import TetrabenchError
from tetrabench.folders import cache_root
from tetrabench.memory import spell_bytes

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

OK, CAREFUL, BAD = "ok", "careful", "bad"
GIB = 2**30
PAIRS = 60
"""Of the A/A, which takes some seconds."""


class Fact(msgspec.Struct, frozen=True, kw_only=True):
    """A fact about the machine. `state` is OK, CAREFUL or BAD; `advice` says what it means and what to do."""

    name: str
    value: str
    state: str = OK
    advice: str = ""


def examine(root: Path = Path("/")) -> Iterator[Fact]:
    """All facts, one after the other; some take seconds.

    Args:
        root: where /proc and /sys are; a test puts another one here.
    """
    yield cores(root)
    yield pinning()
    yield load_of(load(), len(usable_cores()))
    yield governor(root)
    yield turbo(root)
    yield siblings(root)
    yield clock()
    before = cpu_ticks()
    yield from yardsticks()
    yield same_work_twice()
    yield steal(steal_share(before, cpu_ticks()))
    yield free_memory(memory.available_bytes())
    yield huge_pages(root)
    yield peaks()
    yield rollup(root)
    yield trimming()
    yield cache(cache_root())


def cores(root: Path) -> Fact:
    """Cores that may be used, and how much of them the control group allows."""
    count = len(usable_cores())
    quota, _, period = _read(root / "sys/fs/cgroup/cpu.max").partition(" ")
    if quota.isdigit() and period.isdigit() and int(quota) < count * int(period):
        share = int(quota) / int(period)
        advice = "the control group stops the process when that is used up: wall times are worthless, CPU times are not"
        return Fact(name="cores", value=f"{count}, of which {share:g} may be used", state=CAREFUL, advice=advice)
    if count == 1:
        return Fact(name="cores", value="1", state=CAREFUL, advice="the harness itself disturbs what it measures")
    return Fact(name="cores", value=str(count))


def pinning() -> Fact:
    """Whether a process can be kept on one core."""
    if not hasattr(os, "sched_setaffinity"):
        advice = "workers move between cores: a whole launch may be off; make more of them, or measure on Linux"
        return Fact(name="pinning", value="not on this system", state=CAREFUL, advice=advice)
    before = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(before)})
        os.sched_setaffinity(0, before)
    except OSError as error:
        return Fact(name="pinning", value=f"refused: {error.strerror}", state=CAREFUL, advice="make more launches")
    return Fact(name="pinning", value="possible")


def load_of(running: float | None, count: int) -> Fact:
    """`running`: the mean number of processes over the last minute; `count`: cores."""
    if running is None:
        return Fact(name="load", value="unknown", state=CAREFUL, advice="see for yourself that nothing else runs")
    value = f"{running:.1f} on {count} cores"
    if running < 0.3 * count:
        return Fact(name="load", value=value)
    advice = "other work runs: ratios of CPU times still hold, those of wall times may not; close what is not needed"
    return Fact(name="load", value=value, state=CAREFUL if running < count else BAD, advice=advice)


def steal(share: float | None) -> Fact:
    """The share of the machine's time that other guests of its host took."""
    if share is None:
        return Fact(name="steal", value="unknown", state=CAREFUL, advice="nobody tells whether the machine is shared")
    value = f"{100 * share:.1f} % of the time"
    if share < 0.01:
        return Fact(name="steal", value=value)
    advice = "other guests of the host take time: believe ratios and intervals only, never a time; try another hour"
    return Fact(name="steal", value=value, state=CAREFUL if share < 0.1 else BAD, advice=advice)


def governor(root: Path) -> Fact:
    """Who chooses the clock rate of the processor."""
    name = _read(root / "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")
    if name == "performance":
        return Fact(name="governor", value=name)
    advice = "the clock rate follows the load: times vary, ratios hardly; `cpupower frequency-set -g performance`"
    if not name:
        advice = "a virtual machine does not tell: its host may change the clock rate; ratios hardly suffer"
    return Fact(name="governor", value=name or "not shown", state=CAREFUL, advice=advice)


def turbo(root: Path) -> Fact:
    """Whether the clock rate depends on how warm the processor is, and on what other cores do."""
    cpu = root / "sys/devices/system/cpu"
    boost = {"0": "on", "1": "off"}.get(_read(cpu / "intel_pstate/no_turbo"))
    boost = boost or {"1": "on", "0": "off"}.get(_read(cpu / "cpufreq/boost"))
    if boost == "off":
        return Fact(name="turbo", value=boost)
    advice = "the first samples run faster than later ones: balanced turns take care of that; or switch it off"
    return Fact(name="turbo", value=boost or "not shown", state=CAREFUL, advice=advice)


def siblings(root: Path) -> Fact:
    """Whether two of the cores are one (simultaneous multithreading)."""
    active = _read(root / "sys/devices/system/cpu/smt/active")
    if active != "1":
        return Fact(name="core siblings", value="none" if active == "0" else "not shown")
    advice = "what runs on the other half of a core takes its caches: keep the machine idle"
    return Fact(name="core siblings", value="two threads a core", state=CAREFUL, advice=advice)


def clock() -> Fact:
    """The smallest step of the CPU clock of a thread, as seen."""
    step = min(_step(time.thread_time_ns) for _ in range(20))
    value = f"{step / 1000:.3g} us"
    if step <= 10_000:
        return Fact(name="CPU clock", value=value)
    advice = "samples of less than a thousand steps say nothing: take larger models or greater counts"
    return Fact(name="CPU clock", value=value, state=CAREFUL if step <= 1_000_000 else BAD, advice=advice)


def yardsticks() -> Iterator[Fact]:
    """What memory can do; nothing where that cannot be measured."""
    from tetrabench.bench.yardsticks import measure_yardsticks

    try:
        found = measure_yardsticks()
    except (MemoryError, TetrabenchError) as error:
        yield Fact(
            name="memory bandwidth", value="not measured", state=CAREFUL, advice=str(error) or "too little memory"
        )
        return
    yield Fact(name="memory bandwidth", value=f"copy {found.copy_gb_s:.1f}, triad {found.triad_gb_s:.1f} GB/s")
    yield Fact(name="memory latency", value=f"{found.latency_ns:.0f} ns")


def same_work_twice(
    work: Callable[[], None] | None = None, read: Callable[[], float] = time.thread_time, pairs: int = PAIRS
) -> Fact:
    """A/A: one and the same work in two roles, in turns: how far single pairs are apart, and what comes out in the end.

    Args:
        work: what is done; sweeps over an array in and beyond the caches unless given.
        read: a clock, seconds.
        pairs: how many.
    """
    return spread_of(*zip(*in_turn(pairs, *[lambda: _timed(work or _sweep, read)] * 2), strict=True))


def spread_of(ours: Sequence[float], theirs: Sequence[float]) -> Fact:
    """What pairs of samples of the same work say."""
    assert len(ours) >= FEWEST
    ratio: Ratio = paired_ratio(ours, theirs)
    tenths = quantiles([abs(one / other - 1) for one, other in zip(ours, theirs, strict=True)], n=10)
    value = (
        f"ratio {ratio.median:.3f}, interval {ratio.low:.3f}-{ratio.high:.3f}; one pair in ten off by {tenths[-1]:.0%}"
    )
    width = max(ratio.high - 1, 1 - ratio.low)
    if width <= 0.02 and tenths[-1] <= 0.1:
        return Fact(name="A/A", value=value)
    advice = (
        f"differences under {max(width, 0.02) * 100:.0f} % cannot be told here in a few seconds: make more launches"
    )
    return Fact(name="A/A", value=value, state=CAREFUL if width <= 0.1 else BAD, advice=advice)


def free_memory(available: int | None) -> Fact:
    """What the machine and the control groups leave."""
    if available is None:
        return Fact(
            name="free memory", value="unknown", state=CAREFUL, advice="nothing is refused before it is too late"
        )
    if available >= 2 * GIB:
        return Fact(name="free memory", value=spell_bytes(available))
    advice = "contestants will run in groups, or not at all: take smaller models"
    return Fact(
        name="free memory", value=spell_bytes(available), state=CAREFUL if available >= GIB // 2 else BAD, advice=advice
    )


def huge_pages(root: Path) -> Fact:
    """Whether the system gives pages of 2 MiB unasked."""
    text = _read(root / "sys/kernel/mm/transparent_hugepage/enabled")
    chosen = text.partition("[")[2].partition("]")[0]
    if chosen == "always":
        advice = "memory of small structures comes in steps of 2 MiB: compare structure bytes, not peaks"
        return Fact(name="huge pages", value=chosen, state=CAREFUL, advice=advice)
    return Fact(name="huge pages", value=chosen or "not shown")


def peaks() -> Fact:
    """Whether the high-water mark of memory can be read and reset."""
    if reset_peak() and peak_bytes() is not None:
        return Fact(name="peak memory", value="can be read and reset (clear_refs)")
    advice = "peaks are of the whole process since its start, or not known; structure bytes are exact as ever"
    return Fact(name="peak memory", value="cannot be reset", state=CAREFUL, advice=advice)


def rollup(root: Path) -> Fact:
    """Whether the system tells what memory is a process's own."""
    if "Private_Dirty:" in _read(root / "proc/self/smaps_rollup"):
        return Fact(name="retained memory", value="can be read (smaps_rollup)")
    return Fact(name="retained memory", value="not shown", state=CAREFUL, advice="that column stays empty")


def trimming() -> Fact:
    """Whether the allocator gives back what is free."""
    if trim_heap():
        return Fact(name="trimming", value="possible (malloc_trim)")
    advice = "what the allocator keeps counts as the next structure's: peaks are too low, retained memory too high"
    return Fact(name="trimming", value="not with this C library", state=CAREFUL, advice=advice)


def cache(folder: Path) -> Fact:
    """Whether kernels and models can be kept, and how much room there is."""
    nearest = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not os.access(nearest, os.W_OK):
        advice = "each run compiles and generates everything anew: say where with TETRABENCH_CACHE"
        return Fact(name="cache folder", value=f"{folder}: cannot be written to", state=BAD, advice=advice)
    free = shutil.disk_usage(nearest).free
    value = f"{folder}, {spell_bytes(free)} free"
    if free >= GIB:
        return Fact(name="cache folder", value=value)
    return Fact(name="cache folder", value=value, state=CAREFUL, advice="large models will not fit: make room")


@functools.cache
def _numbers() -> "NDArray[np.float64]":
    import numpy as np

    return np.ones(2_000_000)


def _sweep() -> None:
    """Some milliseconds of sums over 16 MB."""
    for _ in range(12):
        _numbers().sum()


def _timed(work: Callable[[], None], read: Callable[[], float]) -> float:
    begin = read()
    work()
    return read() - begin


def _step(read: Callable[[], int]) -> int:
    begin = read()
    while (now := read()) == begin:
        pass
    return now - begin


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
