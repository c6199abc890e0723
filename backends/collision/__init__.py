"""Structures that find which objects touch, on two axes: how the plane is divided, and what is done when objects have moved.

| the plane is divided   | kept, and mended    | made anew in each step  | made anew when need be | nothing is done |
|------------------------|---------------------|-------------------------|------------------------|-----------------|
| by a tree of leaves    | kdtree, leaf-only   | ckdtree*                |                        |                 |
| into squares           |                     | grid*                   | skin*                  |                 |
| not at all             |                     |                         |                        | brute*          |

* ours, beyond the source. leaf-only is the source's published code: it misses contacts across the borders of leaves.
"""

from tetrabench.backends.collision.brute import make_brute
from tetrabench.backends.collision.ckdtree import make_ckdtree
from tetrabench.backends.collision.grid import make_grid
from tetrabench.backends.collision.kdtree import follow, search  # they implement the interface
from tetrabench.backends.collision.kdtree.build import make_kdtree, make_leaf_only
from tetrabench.backends.collision.skin import make_skin
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.protocols import Option

__all__ = ["CONTESTANTS", "STRUCTURES", "follow", "search"]

_SOURCE = "Optimizacija zaznave trkov v 2D, Slovenia, 2025"

_TREE = {
    "capacity": Option(32, 1, 63, "objects that a leaf holds at most"),
    "recycle": Option(1, 0, 1, "whether sparse leaves are merged"),
    "median": Option(0, 0, 1, "whether a leaf is split at the median of a coordinate, rather than at the mean"),
}
_PER_TEN = Option(10, 1, 1000, "objects wanted in ten squares")

STRUCTURES = {
    contestant.name: contestant
    for contestant in (
        CollisionContestant(
            name="kdtree",
            title="a k-d tree with objects in its leaves, mended as they move",
            trade_off="fits any distribution, and only what leaves its leaf is moved; each search walks nodes",
            build=make_kdtree,
            options=_TREE
            | {
                "per_leaf": Option(
                    1, 0, 1, "whether leaves are held against each other, rather than each object looking around"
                )
            },
            source=_SOURCE,
        ),
        CollisionContestant(
            name="grid",
            title="squares of one size, objects sorted into them in each step",
            trade_off="nothing to be searched for and nothing to be mended; squares are as large as the largest object",
            build=make_grid,
            options={"per_ten": _PER_TEN},
            extension=True,
        ),
        CollisionContestant(
            name="skin",
            title="a list of pairs that are nearly in contact, made by a grid when objects have moved far enough",
            trade_off="most steps only test the list; the faster the fastest object, the more often it is made",
            build=make_skin,
            options={"skin": Option(300, 1, 2000, "its width, percent of the largest diameter"), "per_ten": _PER_TEN},
            extension=True,
        ),
        CollisionContestant(
            name="brute",
            title="no structure: all pairs are tested",
            trade_off="nothing can be simpler; the time grows with the square of the number of objects",
            build=make_brute,
            is_quadratic=True,
            extension=True,
        ),
        CollisionContestant(
            name="ckdtree",
            title="scipy's cKDTree, built anew in each step",
            trade_off="there already; built from nothing in each step, and called from Python",
            build=make_ckdtree,
            options={
                "capacity": Option(16, 1, 1000, "objects that a leaf holds at most"),
                "balanced": Option(1, 0, 1, "whether it is split at medians and shrunk, as scipy does by default"),
            },
            is_compiled=False,
            extension=True,
        ),
        CollisionContestant(
            name="leaf-only",
            title="the k-d tree as published: each leaf is searched alone",
            trade_off="wrong: contacts across the borders of leaves are missed",
            build=make_leaf_only,
            options=_TREE,
            is_exact=False,
            source=_SOURCE,
        ),
    )
}
CONTESTANTS = list(STRUCTURES.values())
