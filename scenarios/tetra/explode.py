"""explode: split many tetras into four around their centroids. Thesis, 4.6.2."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario, at_most_half, first_refs
from tetrabench.scenarios.tetra.delete import delete_from_end
from tetrabench.tetra.interface import split_many
from tetrabench.tetra.net import TetraNet


class Explosion(NamedTuple):
    """Which tetras of which net are to be split."""

    net: TetraNet
    refs: NDArray[np.int64]


class Explode(TetraScenario):
    """Split the first tetras, in a net where `delete` has left its holes: the first inserts fill them.

    insert_point, delete, four inserts. The refs are taken before the first split, and in the order of the file, so that
    every contestant splits the same tetras, whatever its order is by then. What delete has left for later is not finished
    in between: splitting has to cope with it.
    """

    name = "explode"
    title = "split 50,000 tetras into four around their centroids, after delete has made holes"
    options = thesis = {"splits": 50_000, "deletions": 20_000}

    def prepare(self, stage: Any, options: Options) -> Explosion:
        """A net of its own with delete's holes."""
        net = stage.own_net()
        if not stage.chained:  # else delete has come before
            delete_from_end(net.storage, at_most_half(net, options["deletions"]))
        return Explosion(net, first_refs(stage, net, at_most_half(net, options["splits"])))

    def run(self, explosion: Explosion) -> int:
        """Split them; returns how many were skipped because their centroid is a point already."""
        explosion.net.storage, skipped = split_many(explosion.net.storage, explosion.refs)
        return int(skipped)

    def answer(self, explosion: Explosion, skipped: int) -> Answer:
        """All of the net, children with their parents' states."""
        whole = explosion.net.answer()
        return Answer(whole.digest, {**whole.figures, "skipped": skipped})

    def work(self, explosion: Explosion, skipped: int) -> Work:
        """Split tetras."""
        return Work(len(explosion.refs) - skipped, "splits")
