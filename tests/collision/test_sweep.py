"""The sweep from left to right finds what a look at all pairs finds."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tetrabench.collision.start.sweep import sweep

LATTICE = st.integers(-4, 4).map(float)  # so that many touch exactly, or lie on each other
PLACES = st.one_of(LATTICE, st.floats(-50, 50), st.floats(1e8, 1e8 + 10))


def brute(x: list[float], y: list[float], r: list[float]) -> tuple[int, list[bool]]:
    """All pairs, one after another."""
    count, is_later = 0, [False] * len(x)
    for j in range(len(x)):
        for i in range(j):
            if (x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2 < (r[i] + r[j]) ** 2:
                count, is_later[j] = count + 1, True
    return count, is_later


@settings(deadline=None)
@given(st.lists(st.tuples(PLACES, PLACES, st.sampled_from([0.5, 1.0, 2.0, 30.0, 1e-9])), max_size=12))
def test_pairs_are_those_of_brute_force(circles: list[tuple[float, float, float]]) -> None:
    x, y, r = np.array(circles).reshape(-1, 3).T.copy()
    count, is_later = sweep(x, y, r)
    assert (count, is_later.tolist()) == brute(x.tolist(), y.tolist(), r.tolist())


def test_a_touch_is_no_contact() -> None:
    for apart, found in ((2.0, 0), (np.nextafter(2.0, 0), 1)):
        assert sweep(np.array([0.0, apart]), np.zeros(2), np.ones(2))[0] == found
        assert sweep(np.zeros(2), np.array([0.0, apart]), np.ones(2))[0] == found


def test_rounding_hides_no_contact() -> None:
    """Where circles begin and end is rounded, but whether they are in contact is decided without that."""
    random = np.random.default_rng(0)
    found = 0
    for _ in range(300):
        x = 1e8 + random.random(2)  # the next number is 1e-8 away
        r = random.random(2)
        x[1] = x[0] + (r[0] + r[1])
        for _ in range(4):
            x[1] = np.nextafter(x[1], 0)
            expected = brute(x.tolist(), [0, 0], r.tolist())[0]
            assert sweep(x, np.zeros(2), r)[0] == expected
            found += expected
    assert found > 500
