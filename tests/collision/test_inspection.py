"""What `info` tells of objects."""

import math
from dataclasses import fields

import pytest

from tetrabench.collision.objects import Start, make_objects
from tetrabench.collision.start.inspection import ObjectsInspection, inspect_objects
from tetrabench.collision.start.models import generate_objects


def test_a_few_objects() -> None:
    objects = make_objects(
        [0, 3, 10, -1e-9], [0, 4, 8, 4], [3, 0, -1, 0], [4, 0, 0, 0.5], [2, 3.001, 1, 4], [1, 2, 3, 4]
    )
    told = inspect_objects(Start(objects, 10.0, 8.0, "by hand"))
    assert told == ObjectsInspection(
        source="by hand",
        objects=4,
        width=10.0,
        height=8.0,
        lowest=(-1e-9, 0.0),
        highest=(10.0, 8.0),
        outside=1,
        radii=(1.0, 4.0),
        masses=(1.0, 4.0),
        speeds=(0.0, 5.0),
        covered=pytest.approx(math.pi * (4 + 3.001**2 + 1 + 16) / 80),
        contacts=3,
        stride=pytest.approx((5 + math.hypot(7, 4) + math.hypot(10, 4)) / 3 / math.sqrt(80 / 4)),
    )
    for x, y in ((-1, 1), (11, 1), (1, -1), (1, 9)):
        assert inspect_objects(Start(make_objects([x], [y]), 10.0, 8.0)).outside == 1


def test_no_objects() -> None:
    told = inspect_objects(generate_objects("mixed", 0))
    assert told.stride is None
    assert (told.objects, told.outside, told.contacts, told.covered) == (0, 0, 0, 0.0)
    assert told.lowest == told.highest == told.radii == told.masses == told.speeds == ()


def test_numbers_beyond_all_bounds() -> None:
    told = inspect_objects(Start(make_objects([-1e308, 1e308], 0.0, 1e308, 1e308, 1e308), 1.0, 1.0))
    assert (told.speeds, told.covered, told.outside) == ((pytest.approx(2**0.5 * 1e308),) * 2, math.inf, 2)


def test_keys_are_documented() -> None:
    for key in fields(ObjectsInspection):
        assert f"        {key.name}: " in (ObjectsInspection.__doc__ or "")


def test_models_have_the_contacts_that_their_titles_say() -> None:
    contacts = {name: inspect_objects(generate_objects(name, 1000)).contacts for name in ("uniform", "separated")}
    assert contacts["separated"] == 0
    assert 20 < contacts["uniform"] < 70
