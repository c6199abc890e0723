"""A plug-in of broken structures: brute, or the grid, with one function wrong, each named after that. Plain Python only."""

import os
import signal
from dataclasses import replace

import numpy as np

from tests.broken import broken_type
from tetrabench.backends.collision import STRUCTURES
from tetrabench.backends.collision.brute import Brute
from tetrabench.backends.collision.grid import Grid
from tetrabench.collision import interface
from tetrabench.protocols import Option

TYPES = {"brute": Brute, "grid": Grid}


def broken(name, good, function, wrap, without=(), **says):
    structure = STRUCTURES[good]
    made = broken_type(TYPES[good], {function: wrap} if function else {}, without)

    def build(x, y, r, values):
        seen = len(x) - values.get("blind", 0)
        return made(*structure.build(x[:seen], y[:seen], r[:seen], values))

    return replace(structure, name=name, build=build, **says)


def as_many_as_built(good):
    """It knows as many objects as it was built of."""

    def pairs(storage, x, y, r, out):
        return good(storage, x[: storage.objects], y, r, out)

    return pairs


def pairs_changed(change):
    """`change(x, y, r, found)` gives what is stored instead of the pairs found."""

    def wrap(good):
        def pairs(storage, x, y, r, out):
            room = np.empty((len(x) ** 2, 2), np.int32)
            found = change(x, y, r, room[: good(storage, x, y, r, room)].tolist())
            for place, pair in enumerate(found[: len(out)]):
                out[place] = pair
            return len(found)

        return pairs

    return wrap


def near_the_border(x, y, r, found):
    return [(i, j) for i, j in found if x[i] > 1 or j - i > 1]


def touching_too(x, y, r, found):
    every = [(i, j) for i in range(len(x)) for j in range(i + 1, len(x))]
    return [(i, j) for i, j in every if (x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2 <= (r[i] + r[j]) ** 2]


def twice(x, y, r, found):
    return [*found, *found[:1]]


def turned(x, y, r, found):
    return [(j, i) for i, j in found]


def overflowing(good):
    def pairs(storage, x, y, r, out):
        whole = np.empty((len(out) + 1, 2), np.int32) if out.base is None else out.base
        return good(storage, x, y, r, whole)

    return pairs


def counts_what_fits(good):
    def pairs(storage, x, y, r, out):
        return min(good(storage, x, y, r, out), len(out))

    return pairs


def open_border(good):
    def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
        return good(storage, x, y, x_low, y_low, np.nextafter(x_high, -np.inf), y_high, out)

    return query_rect


def sorted_ends(good):
    def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
        return good(storage, x, y, min(x_low, x_high), y_low, max(x_low, x_high), y_high, out)

    return query_rect


def stays(good):
    def update(storage, x, y):
        return storage

    return update


def stats(good):
    def stats(storage):
        return {"leaves": float("nan")}

    return stats


def leaf_rectangles(good):
    def leaf_rectangles(storage):
        return np.zeros((3, 2))

    return leaf_rectangles


def structure_bytes(good):
    def structure_bytes(storage):
        return {"x": (16, 8)}

    return structure_bytes


def crashing(good):
    def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
        os.kill(os.getpid(), signal.SIGSEGV)

    return query_rect


def endless(good):
    def update(storage, x, y):
        while True:
            pass

    return update


OPTIONS = {"blind": Option(0, 0, 1, "how many objects, of those built of, it does not see")}
# name -> what is broken; what its sentence must name
FAULTS = {
    "misses": ("brute", interface.pairs, pairs_changed(near_the_border), "pairs"),
    "touching-too": ("brute", interface.pairs, pairs_changed(touching_too), "pairs, circles that but touch"),
    "twice": ("brute", interface.pairs, pairs_changed(twice), "comes twice"),
    "turned": ("brute", interface.pairs, pairs_changed(turned), "pairs"),
    "overflowing": ("brute", interface.pairs, overflowing, "pairs writes beyond its room"),
    "counts-what-fits": ("brute", interface.pairs, counts_what_fits, "pairs with room for 0 returns 0"),
    "open-border": ("brute", interface.query_rect, open_border, "query_rect"),
    "sorted-ends": ("brute", interface.query_rect, sorted_ends, "query_rect"),
    "stays": ("grid", interface.update, stays, "after update in step"),
    "strange-stats": ("brute", interface.stats, stats, "stats"),
    "flat-leaves": ("brute", interface.leaf_rectangles, leaf_rectangles, "leaf_rectangles"),
    "blind-at-its-limit": ("brute", interface.pairs, as_many_as_built, "pairs, with blind=1"),
    "more-than-there-is": ("brute", interface.structure_bytes, structure_bytes, "structure_bytes"),
}
CONTESTANTS = [
    *(
        broken(name, good, function, wrap, options=OPTIONS if good == "brute" else STRUCTURES[good].options)
        for name, (good, function, wrap, _) in FAULTS.items()
    ),
    broken("half", "brute", None, None, without=(interface.stats, interface.update)),
    broken("crashing", "brute", interface.query_rect, crashing),
    broken("endless", "brute", interface.update, endless),
]
