"""Objects are made of lists of numbers; what is no circle is refused, and the first one at fault is named."""

import re

import numpy as np
import pytest

from tetrabench.collision.objects import (
    WORDS,
    Objects,
    check_box,
    check_objects,
    copy_objects,
    make_objects,
)
from tetrabench.errors import InputError


def test_lists_become_columns_of_their_own() -> None:
    x, y = np.arange(6.0)[::2], np.array([3.0, 4.0, 5.0])
    objects = make_objects(x, y, vx=(1, 2, 3), r=7)
    assert [column.tolist() for column in objects] == [
        [0, 2, 4],
        [3, 4, 5],
        [1, 2, 3],
        [0, 0, 0],
        [7, 7, 7],
        [5, 5, 5],
    ]
    for column in objects:
        assert (column.dtype, column.shape) == (np.float64, (3,))
        assert column.flags.c_contiguous
        assert column.flags.writeable
        assert column.flags.owndata
        assert not any(np.shares_memory(column, given) for given in (x, y))
    assert all(len(column) == 0 for column in make_objects([], []))


def test_a_copy_shares_nothing() -> None:
    objects = make_objects([1, 2], [3, 4])
    copy = copy_objects(objects)
    for one, other in zip(objects, copy, strict=True):
        assert one.tolist() == other.tolist()
        assert not np.shares_memory(one, other)


@pytest.mark.parametrize("name", Objects._fields)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused(name: str, value: float) -> None:
    columns = {field: np.ones(5) for field in Objects._fields}
    columns[name][3] = value
    with pytest.raises(
        InputError, match=re.escape(f"object 3: the {WORDS[name]} has to be a finite number, not {value}")
    ):
        make_objects(**columns)
    columns[name][1] = value
    with pytest.raises(InputError, match=r"^object 1: .* \(and 1 more\)$"):
        check_objects(Objects(**columns))


@pytest.mark.parametrize("name", ["r", "m"])
@pytest.mark.parametrize("value", [0.0, -0.0, -1.0])
def test_a_radius_and_a_mass_are_above_0(name: str, value: float) -> None:
    columns = {field: np.ones(5) for field in Objects._fields}
    columns[name][2] = value
    with pytest.raises(InputError, match=f"^object 2: the {WORDS[name]} has to be above 0, not {value}$"):
        make_objects(**columns)
    with pytest.raises(InputError, match=f"^object 0: the {WORDS[name]} has to be above 0, not {value} .and 4 more.$"):
        make_objects(**{**columns, name: value})


def test_lists_of_unequal_lengths_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"^objects: lists of one length are needed, not x 2, y 3, vx 2, vy 2, r 2, m 2$"
    ):
        make_objects([1, 2], [1, 2, 3])
    with pytest.raises(InputError, match=r"not x 2x2, "):
        make_objects(np.ones((2, 2)), [1, 2])
    with pytest.raises(InputError, match=r" m 1$"):
        make_objects([1, 2], [1, 2], m=[1])


def test_what_is_no_number_is_refused() -> None:
    for bad in (["a", "b"], [None, object()], [[1], [2, 3]]):
        with pytest.raises(InputError, match=r"^velocity in y: a list of numbers is needed, one for each object$"):
            make_objects([1, 2], [1, 2], vy=bad)  # type: ignore[arg-type]


def test_a_box_has_a_width_and_a_height() -> None:
    check_box(1e-9, 1e300)
    for width, height in ((0, 1), (1, -1), (np.nan, 1), (1, np.inf)):
        with pytest.raises(InputError, match=f"^a box of {width} x {height}: width and height have to be finite"):
            check_box(width, height)
