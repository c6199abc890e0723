"""delete: many tetras from the end, each next to the one before. Thesis, 4.6.1."""

from typing import Any, NamedTuple

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario, at_most_half
from tetrabench.tetra.interface import NONE, Net, collect, delete_tetra, last_tetra, neighbour
from tetrabench.tetra.net import TetraNet


class Deletion(NamedTuple):
    """How many tetras of which net are to go."""

    net: TetraNet
    wanted: int


class Delete(TetraScenario):
    """Take the last tetra, delete it, go on with its first neighbour until there is none, then the last again."""

    name = "delete"
    title = "delete 20,000 tetras from the end, going from neighbour to neighbour"
    options = thesis = {"deletions": 20_000}

    def prepare(self, stage: Any, options: Options) -> Deletion:
        """A net of its own."""
        net = stage.own_net()
        return Deletion(net, at_most_half(net, options["deletions"]))

    def run(self, deletion: Deletion) -> None:
        """Delete them, and finish what that has left: whoever puts it off pays for it here."""
        delete_from_end(deletion.net.storage, deletion.wanted)
        deletion.net.storage, _ = collect(deletion.net.storage)

    def answer(self, deletion: Deletion, outcome: None) -> Answer:
        """All that is left."""
        return deletion.net.answer()

    def work(self, deletion: Deletion, outcome: None) -> Work:
        """Deleted tetras."""
        return Work(deletion.wanted, "deletions")


@kernel(allocates=False)
def delete_from_end(net: Net, count: int) -> None:
    """Delete `count` tetras, beginning with the last one, from neighbour to neighbour."""
    t = NONE
    for _ in range(count):
        if t == NONE:
            t = last_tetra(net)
        following = NONE
        for i in range(4):  # the first neighbour that exists, in side order, read before the deletion
            if following == NONE:
                following = neighbour(net, t, i)
        delete_tetra(net, t)
        t = following
