"""What the machine can do: the work is what it says, whatever the machine."""

import numpy as np
import pytest

from tetrabench.bench.yardsticks import LINE, copy, follow, measure_yardsticks, random_cycle, triad


@pytest.mark.parametrize("places", [LINE, 2 * LINE, 7 * LINE, 1000 * LINE, 1000 * LINE + 5])
def test_the_walk_is_one_cycle_through_all_lines(places):
    walk = random_cycle(places)
    assert (walk.dtype, walk.shape) == (np.int32, (places,))
    seen, place = set(), 0
    while place not in seen:
        seen.add(place)
        place = int(walk[place])
    assert place == 0
    assert seen == set(range(0, places // LINE * LINE, LINE))


def test_the_walk_goes_to_and_fro():
    """In order it would be foreseen."""
    steps = np.diff(np.ravel([follow(random_cycle(1000 * LINE), step) for step in range(1000)]))
    assert len(np.unique(steps)) > 500


def test_to_follow_is_to_take_so_many_steps():
    walk = random_cycle(50 * LINE)
    place = 0
    for steps in range(120):
        assert follow(walk, steps) == place
        place = int(walk[place])


def test_copy_and_triad(rng):
    a, b, c = np.zeros(100), rng.random(100), rng.random(100)
    copy(a, b)
    assert np.array_equal(a, b)
    triad(a, b, c)
    assert np.array_equal(a, b + 3.0 * c)


@pytest.mark.parametrize("array_bytes", [64, 2**12, 2**16])
def test_figures_are_positive(array_bytes):
    found = measure_yardsticks(array_bytes, steps=500)
    assert 0 < found.copy_gb_s < 1e4
    assert 0 < found.triad_gb_s < 1e4
    assert 0 < found.latency_ns < 1e6


def test_bytes_are_counted_as_the_program_names_them(monkeypatch):
    """Two arrays for a copy, three for a triad; the best of all tries; a walk by its step."""
    spent = iter([9.0, 2.0, 9.0, 9.0, 9.0, 9.0, 9.0, 3.0, 9.0, 9.0, 5.0, 4.0])
    monkeypatch.setattr("tetrabench.bench.yardsticks._seconds", lambda work, *arguments: next(spent))
    found = measure_yardsticks(1024, steps=1000)
    assert found.copy_gb_s == pytest.approx(2 * 1024 / 2.0 / 1e9)
    assert found.triad_gb_s == pytest.approx(3 * 1024 / 3.0 / 1e9)
    assert found.latency_ns == pytest.approx(4.0 / 1000 * 1e9)
