"""The examples in docstrings do what they say."""

import doctest
from importlib import import_module

import pytest

MODULES = [
    "tetrabench",
    "tetrabench.tetra.net",
    "tetrabench.tetra.by_ref",
    "tetrabench.polygon.net",
    "tetrabench.collision.simulation",
]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    found = doctest.testmod(import_module(name), optionflags=doctest.ELLIPSIS)
    assert found.attempted
    assert not found.failed
