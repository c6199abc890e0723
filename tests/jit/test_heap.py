"""The C heap from kernels and from plain Python: the same memory either way."""

import numpy as np
import pytest

from tetrabench.jit import heap, kernel


@kernel
def write(address, number):
    heap.store(np.int32, address, number)
    heap.store(np.int64, address + 8, -number)
    heap.store(np.float64, address + 16, number * 0.5)


@kernel
def read(address):
    return heap.load(np.int32, address), heap.load(np.int64, address + 8), heap.load(np.float64, address + 16)


@kernel
def take(size):
    return heap.allocate(size)


@kernel
def give_back(address):
    heap.release(address)


@kernel
def size_of(address):
    return heap.usable_size(address)


def plain(function):
    """The function itself, also where the JIT has compiled it."""
    return getattr(function, "py_func", function)


PAIRS = [(write, read), (plain(write), read), (write, plain(read))]


@pytest.mark.parametrize(("writer", "reader"), PAIRS)
def test_what_was_stored_is_loaded(writer, reader):
    address = take(24)
    writer(address, 7)
    assert reader(address) == (7, -7, 3.5)
    give_back(address)


def test_sizes():
    address = heap.allocate(264)
    assert size_of(address) == heap.usable_size(address) >= 264
    assert address % 8 == 0
    heap.release(address)
