"""Three clocks read together: CPU time of the thread, CPU time of all threads, wall time."""

import time
from typing import NamedTuple


class Clocks(NamedTuple):
    """Readings, or the difference of two readings, in seconds."""

    cpu_s: float
    process_cpu_s: float
    wall_s: float

    def since(self, start: "Clocks") -> "Clocks":
        """What has passed since `start`."""
        return Clocks(*(end - begin for end, begin in zip(self, start, strict=True)))

    def plus(self, other: "Clocks") -> "Clocks":
        """Both spans together."""
        return Clocks(*(one + another for one, another in zip(self, other, strict=True)))


def read_clocks() -> Clocks:
    """The clocks as they stand. Only differences mean something."""
    return Clocks(time.thread_time(), time.process_time(), time.perf_counter())
