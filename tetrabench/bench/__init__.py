"""Measuring: workers in a ring, samples in pairs, answers compared."""

from tetrabench.bench.benchmark import exit_code, run, run_benchmark
from tetrabench.bench.frame import load_results, load_summary
from tetrabench.bench.plan import EFFORTS, Plan, make_plan
from tetrabench.bench.progress import Progress, Silence
from tetrabench.bench.record import Backend, Effort, Results, Sample, Task, read_results, save_results
from tetrabench.bench.statistics import Row, summary

__all__ = [
    "EFFORTS",
    "Backend",
    "Effort",
    "Plan",
    "Progress",
    "Results",
    "Row",
    "Sample",
    "Silence",
    "Task",
    "exit_code",
    "load_results",
    "load_summary",
    "make_plan",
    "read_results",
    "run",
    "run_benchmark",
    "save_results",
    "summary",
]
