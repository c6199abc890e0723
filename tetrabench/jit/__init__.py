"""Kernel machinery: `kernel` (a cached njit), `generic` and `implements` (one interface, many storages), `heap`."""

from tetrabench.folders import cache_root
from tetrabench.jit.cache import count_compiled, kernel, kernels
from tetrabench.jit.generic import generic, implements

__all__ = ["cache_root", "count_compiled", "generic", "implements", "kernel", "kernels"]
