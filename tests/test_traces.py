"""Exceptions in a line: the function and the line of the person who can mend it, whatever the compiler wraps around that."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numba import config
from numba.core.errors import TypingError

from tetrabench.jit import generic, implements, kernel
from tetrabench.traces import spell_error, spell_refusal


class Whole(NamedTuple):
    part: Any


class Adder(NamedTuple):
    numbers: Any


class Misspelt(NamedTuple):
    numbers: Any


class Forgetful(NamedTuple):
    numbers: Any


class Wavering(NamedTuple):
    numbers: Any


@generic(on="part")
def value(net):
    """A number."""


@implements(value, Adder)
def added(net):
    return net.part.numbers[0] + net.part  # of an array and its owner


@implements(value, Misspelt)
def misspelt(net):
    return net.part.numers[0]


@implements(value, Forgetful)
def forgetful(net):
    return undefined_name[0]  # noqa: F821


@implements(value, Wavering)
def wavering(net):
    return 3 if len(net.part.numbers) > 5 else "many"


@kernel
def through(net):
    return value(net)


@kernel
def outer(net):
    return through(net) + 1


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")
@pytest.mark.parametrize(
    ("part", "said", "function"),
    [
        (Adder, "there is no add(float64, Adder(", added),
        (Misspelt, "Unknown attribute 'numers' of type Misspelt(", misspelt),
        (Forgetful, "NameError: name 'undefined_name' is not defined", forgetful),
        (Wavering, "Cannot unify ", wavering),
    ],
)
def test_what_cannot_be_compiled(part, said, function):
    with pytest.raises(TypingError) as caught:
        outer(Whole(part(np.arange(3.0))))
    line = function.__code__.co_firstlineno + 2  # its decorator and its head
    told = spell_error(caught.value)
    name, place = (function.__name__, f" (test_traces.py:{line})") if part is not Forgetful else ("value", "")
    assert told.startswith(f"{name}: it cannot be compiled: {said}")
    assert told.endswith(place)
    assert "\n" not in told


def test_what_is_left_out_is_said_in_a_line():
    text = "Failed in nopython mode pipeline\n  x\n TypingError: Half does not implement vertex(net, t, i)\nmore"
    assert spell_refusal(text) == "Half does not implement vertex(net, t, i)"


def test_an_exception_is_told_by_where_it_was_raised():
    def raising():
        raise ValueError("  so\nand so")

    with pytest.raises(ValueError, match="so") as caught:
        raising()
    line = raising.__code__.co_firstlineno + 1
    assert spell_error(caught.value) == f"raising: ValueError: so (test_traces.py:{line})"
    assert spell_error(KeyError()) == "KeyError: no reason given"


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        (
            "\nimport json\njson.loads('')",
            ValueError,
            "JSONDecodeError: Expecting value: line 1 column 1 (char 0) (theirs.py:3)",
        ),
        ("import no_such", ImportError, "ModuleNotFoundError: No module named 'no_such' (theirs.py:1)"),
        ("\n\nx = = 1", SyntaxError, "SyntaxError: invalid syntax (theirs.py, line 3)"),
    ],
)
def test_or_by_the_first_line_behind_whoever_called(tmp_path, text, kind, told):
    with pytest.raises(kind) as caught:
        exec(compile(text, tmp_path / "theirs.py", "exec"), {})
    assert spell_error(caught.value, entered_from=(__file__,)) == told
