"""`mix`: 64 bits scrambled, one to one; what digests are made of.

Mixing function: MurmurHash3's 64-bit finalizer with the constants of David Stafford's variant 13.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit.cache import kernel

SEED = 0x9E3779B97F4A7C15
_ALL = 0xFFFFFFFFFFFFFFFF


@kernel(allocates=False)
def mix(z: Any) -> Any:
    """Scramble 64 bits, one to one. Outside of kernels that wrap around, under `np.errstate(over="ignore")`."""
    z ^= z >> np.uint64(30)
    z *= np.uint64(0xBF58476D1CE4E5B9)
    z ^= z >> np.uint64(27)
    z *= np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def mix_exactly(z: int) -> int:
    """`mix` in Python's own integers."""
    z ^= z >> 30
    z = z * 0xBF58476D1CE4E5B9 & _ALL
    z ^= z >> 27
    z = z * 0x94D049BB133111EB & _ALL
    return z ^ (z >> 31)


def mixed_with(total: int, *counts: float) -> str:
    """A digest as 16 hexadecimal digits: a sum of mixes, and the counts that belong to the answer."""
    for count in counts:
        total = mix_exactly(total ^ int(count))
    return f"{total:016x}"


def mix_of_arrays(*arrays: NDArray[np.float64]) -> int:
    """64 bits that change with any bit of any array, or its place: to compare states to the last bit."""
    digest = 0
    for values in arrays:
        total = np.zeros(1, np.uint64)
        with np.errstate(over="ignore"):  # 64 bits that wrap around are meant to, also with the JIT off
            add_bits(values.reshape(-1).view(np.uint64), total)
        digest = int(mixed_with(digest, int(total[0])), 16)
    return digest


@kernel(allocates=False)
def add_bits(bits: NDArray[np.uint64], total: NDArray[np.uint64]) -> None:
    """Add the mixes of all values and their places to total[0]."""
    for place in range(len(bits)):
        total[0] += mix(mix(np.uint64(SEED) ^ np.uint64(place)) ^ bits[place])
