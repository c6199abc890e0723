"""What counts as a regression: how many times slower is too slow, how many times larger too large."""

from collections.abc import Iterable, Iterator

import msgspec

from tetrabench.bench.record import MEBI, Memory


class Limits(msgspec.Struct, frozen=True, kw_only=True):
    """Ratios new / old that are still allowed: of CPU time, of wall time (which varies more), of bytes.

    Sizes hardly vary from run to run, so that their limits are strict; a peak may besides grow by `peak_slack` bytes.
    """

    cpu: float = 1.10
    wall: float = 1.15
    structure: float = 1.02
    peak: float = 1.03
    peak_slack: int = MEBI

    def of(self, clock: str) -> float:
        """That of a clock, "cpu" or "wall"."""
        return self.wall if clock == "wall" else self.cpu


def limits_of(threshold: float) -> Limits:
    """`threshold`: how much slower by CPU time is allowed, such as 0.1; by wall time it is half as much again."""
    return Limits(cpu=1 + threshold, wall=1 + 1.5 * threshold)


class MemoryChange(msgspec.Struct, frozen=True, kw_only=True):
    """What a contestant's structure took and takes.

    Attributes:
        what: "structure" (used bytes of all buffers) or "peak" (of the process while it is built).
        verdict: "larger" or "smaller" (by more than the limit), "same".
    """

    model: str
    backend: str
    what: str
    old_bytes: int
    new_bytes: int
    verdict: str


def compare_memory(old: Memory, new: Memory, limits: Limits, backend: str) -> Iterator[MemoryChange]:
    """What both tell; nothing where one of them did not end well."""
    if (old.status, new.status) != ("ok", "ok"):
        return
    sizes = [("structure", old.structure_bytes, new.structure_bytes, limits.structure, 0)]
    if old.peak_bytes is not None and new.peak_bytes is not None:
        sizes.append(("peak", old.peak_bytes, new.peak_bytes, limits.peak, limits.peak_slack))
    for what, before, after, limit, slack in sizes:
        larger, smaller = after > limit * before + slack, before > limit * after + slack
        verdict = "larger" if larger else "smaller" if smaller else "same"
        yield MemoryChange(
            model=new.model, backend=backend, what=what, old_bytes=before, new_bytes=after, verdict=verdict
        )


def failures(memory: Iterable[Memory]) -> list[str]:
    """What went wrong in a memory pass, a sentence each."""
    return [
        f"{one.backend} on {one.model}: the memory pass ended with {one.status}: {one.reason}"
        for one in memory
        if one.status not in ("ok", "skipped", "unsupported")
    ]
