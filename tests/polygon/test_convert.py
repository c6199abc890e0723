"""From every format back to plain cell lists, and into every other format: nothing is lost, and nothing depends on the way."""

import numpy as np
import pytest
from hypothesis import given

from tests.polygon.meshes import ALL, divisions
from tetrabench.backends.polygon import FORMATS
from tetrabench.polygon.net import PolygonNet


def assert_the_same_mesh(mesh, other):
    for array in ("points", "starts", "nodes", "conditions"):
        one, two = getattr(mesh, array), getattr(other, array)
        np.testing.assert_array_equal(one, two, array)
        assert one.dtype == two.dtype, array


def assert_the_same_storage(one, other):
    assert type(one) is type(other)
    for name, array in one._asdict().items():
        np.testing.assert_array_equal(array, getattr(other, name), name)
        assert array.dtype == getattr(other, name).dtype


def assert_nothing_is_lost(mesh):
    direct = {name: PolygonNet(mesh, contestant) for name, contestant in FORMATS.items()}
    for net in direct.values():
        back = net.to_mesh()
        assert_the_same_mesh(back, mesh)
        for name, contestant in FORMATS.items():
            assert_the_same_storage(PolygonNet(back, contestant).storage, direct[name].storage)


@pytest.mark.parametrize("mesh", ALL)
def test_from_every_format_into_every_other(mesh):
    assert_nothing_is_lost(ALL[mesh]())


@given(divisions())
def test_any_division(mesh):
    assert_nothing_is_lost(mesh)


def test_the_source_is_kept():
    mesh = ALL["quad, 5 cells, natural"]()
    for contestant in FORMATS.values():
        assert PolygonNet(mesh, contestant).to_mesh().report.source == mesh.report.source != ""
