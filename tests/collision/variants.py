"""The structures with their options at the ends and in the middle."""

from dataclasses import replace
from itertools import product

from tests.collision.starts import SLOW
from tetrabench.backends.collision import STRUCTURES
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.registry import choose_options

CAPACITIES = (1, 3, 63) if SLOW else (1, 2, 3, 8, 63)


def variant(name: str, **options: int) -> CollisionContestant:
    """A structure with some options other than its own."""
    structure = STRUCTURES[name]
    return replace(structure, options=choose_options(name, structure.options, options))


def kdtrees() -> dict[str, CollisionContestant]:
    """All capacities with all kinds of tree; without the JIT two kinds, which differ in everything."""
    kinds = [(1, 0, 1), (0, 1, 0)] if SLOW else product((0, 1), repeat=3)
    return {
        f"kdtree {capacity} {recycle}{median}{per_leaf}": variant(
            "kdtree", capacity=capacity, recycle=recycle, median=median, per_leaf=per_leaf
        )
        for capacity in CAPACITIES
        for recycle, median, per_leaf in kinds
    }


EXACT: dict[str, CollisionContestant] = kdtrees() | {
    "grid 1": variant("grid", per_ten=1),
    "grid 10": variant("grid"),
    "grid 200": variant("grid", per_ten=200),
    "skin 1": variant("skin", skin=1),
    "skin 200": variant("skin"),
    "skin 1000": variant("skin", skin=1000, per_ten=50),
    "ckdtree": variant("ckdtree"),
    "ckdtree 1": variant("ckdtree", capacity=1),
    "ckdtree sliding": variant("ckdtree", capacity=2, balanced=0),
    "brute": variant("brute"),
}
