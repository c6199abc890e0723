"""Turns that alternate, and the interval of the sign test against the binomial distribution."""

from itertools import product

import numpy as np
import pytest

from tetrabench.bench.pairs import CONFIDENCE, FEWEST, in_turn, interval_rank, paired_ratio


def test_every_other_turn_begins_with_the_other():
    said = []
    pairs = list(in_turn(3, lambda: said.append("ours") or len(said), lambda: said.append("theirs") or len(said)))
    assert said == ["ours", "theirs", "theirs", "ours", "ours", "theirs"]
    assert pairs == [(1, 2), (4, 3), (5, 6)]


@pytest.mark.parametrize("n", range(FEWEST, 13))
def test_the_interval_is_the_shortest_that_holds_the_median(n):
    """By counting all ways in which n samples can fall on either side of the median."""
    below = [sum(sides) for sides in product((0, 1), repeat=n)]

    def missed(rank):  # all but `rank` samples or fewer are on one side
        return sum(count <= rank or count >= n - rank for count in below) / len(below)

    rank = interval_rank(n)
    assert missed(rank) <= 1 - CONFIDENCE < missed(rank + 1)


def test_the_interval_of_21_turns():
    assert interval_rank(21) == 5  # the textbook's 6th smallest and 6th largest


def test_too_few_pairs():
    with pytest.raises(ValueError, match="needs 6 values at least, not 5"):
        paired_ratio([1.0] * 5, [2.0] * 5)


def test_ratios_are_paired():
    """The machine slows down sixfold on the way; the ratio knows nothing of it."""
    theirs = np.array([1.0, 6.0, 2.0, 3.0, 5.0, 4.0, 1.0])
    ratio = paired_ratio(0.5 * theirs + [0, 0, 0, 0, 0, 0, 9], theirs)
    assert ratio == (0.5, 0.5, 9.5)
