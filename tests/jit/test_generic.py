"""One declaration, one registration, the same answer in numba and in plain Python; mistakes are named."""

import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba import config
from numba.core.errors import TypingError

from tetrabench.jit import generic, implements, kernel
from tetrabench.jit.generic import generics_of, is_implemented, lacks


class Doubles(NamedTuple):
    values: np.ndarray


class Constant(NamedTuple):  # all fields alike: numba has another type for these
    a: float
    b: float


class Nothing(NamedTuple):
    values: np.ndarray


class Holder(NamedTuple):
    part: object


@generic(on="part")
def first_value(net, index):
    """A value."""


@implements(first_value, Doubles)
def of_doubles(net, index):
    return 2.0 * net.part.values[index]


@implements(first_value, Constant)
def of_constant(net, index):
    return net.part.a


@kernel
def ask(net, index):
    return first_value(net, index) + 1.0


@pytest.mark.parametrize("function", [ask, lambda net, index: first_value(net, index) + 1.0], ids=["kernel", "python"])
def test_dispatch_on_the_type_of_the_part(function):
    assert function(Holder(Doubles(np.array([1.0, 4.0]))), 1) == 9.0
    assert function(Holder(Constant(5.0, 6.0)), 1) == 6.0


def test_missing_implementation_is_named():
    net = Holder(Nothing(np.zeros(1)))
    with pytest.raises(TypeError, match=r"Nothing does not implement first_value\(net, index\)"):
        first_value(net, 0)
    error = TypeError if config.DISABLE_JIT else TypingError
    with pytest.raises(error, match="Nothing does not implement first_value"):
        ask(net, 0)


def test_wrong_registrations_are_refused():
    with pytest.raises(TypeError, match="implements first_value already"):
        implements(first_value, Doubles)(of_doubles)
    with pytest.raises(TypeError, match=r"takes \(net, index\)"):
        implements(first_value, Nothing)(lambda net: 0.0)


def test_contract_is_kept():
    assert first_value.__doc__ == "A value."
    assert first_value.__name__ == "first_value"


@generic()
def size(storage, scale):
    """Another, of the storage itself."""


@implements(size, Doubles)
def size_of_doubles(storage, scale):
    return scale * len(storage.values)


def test_what_a_storage_lacks():
    functions = generics_of(sys.modules[__name__])
    assert functions == [first_value, size]  # not the implementations, nor the kernel
    storage = Constant(5.0, 6.0)
    assert [one for one in functions if not is_implemented(one, Holder(Doubles(np.zeros(1))))] == [size]
    assert not is_implemented(size, storage)
    assert is_implemented(size, Doubles(np.zeros(1)))
    told = ["first_value(net, index) of its part, Nothing", "size(storage, scale)"]
    assert lacks(sys.modules[__name__], Holder(Nothing(np.zeros(1)))) == told
    assert lacks(sys.modules[__name__], Holder(Nothing(np.zeros(1))), {"size"}) == told[:1]
