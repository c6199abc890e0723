"""Every field of every contestant is damaged in turn, and the audit must find every damage."""

import ctypes

import numpy as np
import pytest

from tests.meshes import box
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.backends.tetra.halfface.storage import HalfFaces
from tetrabench.backends.tetra.layouts.linked_nodes import NODE
from tetrabench.tetra.net import TetraNet

# What may hold any value: (class, field, place) -> why. Everything else has to be found.
HARMLESS = {
    ("Points", "counters", 1): "STALE says that the storage was outgrown; edits refuse then",
    ("Points", "counters", 2): "EDITS only ever grows",
    ("Tree", "counters", 3): "REBUILDS is a statistic",
    ("SortedList", "counters", 3): "SPARE is only read together with USED, see the next",
}
CONTESTANTS = [c.name for c in OURS]


def edited_net(name):
    """A net with holes, free entries and spare room, so that all bookkeeping is in use."""
    net = TetraNet(box(), registry.contestant("tetra", name))
    refs = net.refs.tolist()
    net.split(refs[3:6])
    for t in [refs[20], refs[21], refs[9], refs[30], refs[25]]:
        net.delete(t)
    # fills one hole; the others stay
    a, b, c, d = (int(v) for v in box().tets[20])
    net.insert(a, b, c, d)
    return net


def scalars(array):
    """Every number of an array, field by field: (label, numeric view of one column)."""
    if array.dtype.names is None:
        flat = array.reshape(len(array), -1)
        return [(str(column), flat[:, column]) for column in range(flat.shape[1])]
    return [(f"{name}.{label}", view) for name in array.dtype.names for label, view in scalars(array[name])]


def rows_in_use(net, part, field):
    """A few rows that hold something that matters, per part of the net."""
    storage = net.storage
    live = net.refs.tolist()
    points = [0, len(net.points) - 1]
    if field == "counters":
        return range(len(getattr(part, field)))
    if part is storage.layout:
        return [live[0], live[len(live) // 2], live[-1]]
    if part is storage.points or field == "heads":
        return points
    if field == "nodes":
        return [0, len(net.points) // 2, len(net.points) - 1]
    if field == "entries":
        return [int(storage.incidence.heads[net.vertices_of(live[2])[0]])]
    if field == "elements":  # the first hole, and the end
        return [int(part.counters[1]), int(part.counters[2])]
    if field == "holes":
        return [int(part.counters[2]) - 1]
    raise AssertionError(f"how is {type(part).__name__}.{field} used?")


def other_value(value):
    """Another value of the same type, of a kind that damage could leave."""
    return value * 1.5 + 0.25 if isinstance(value, float | np.floating) else value + 1


@pytest.mark.parametrize("name", CONTESTANTS)
def test_every_damage_is_found(name):
    net = edited_net(name)
    assert net.check() == []
    missed = []
    for part in net.storage:
        if isinstance(part, HalfFaces):
            continue  # each of its words is damaged in tests/halfface
        for field, array in part._asdict().items():
            if not isinstance(array, np.ndarray):
                continue
            for row in rows_in_use(net, part, field):
                for label, column in scalars(array):
                    if (type(part).__name__, field, row) in HARMLESS:
                        continue
                    before = column[row].item()
                    after = np.nan if field == "state" or label.startswith("state") else other_value(before)
                    if type(part).__name__ == "Chain" and row > 0:  # an address must stay one that can be followed
                        after = net.refs.tolist()[5]
                    column[row] = after
                    if net.check() == []:
                        missed.append((type(part).__name__, field, label, row, before, after))
                    column[row] = before
    assert missed == []
    assert net.check() == []


def test_every_damage_to_a_node_is_found():
    """V4's nodes lie on the C heap: reached by address, each field of a few of them."""
    net = edited_net("v4")
    refs = net.refs.tolist()
    missed = []
    for place in (0, len(refs) // 2, len(refs) - 1):
        memory = (ctypes.c_char * NODE.itemsize).from_address(refs[place])
        node = np.frombuffer(memory, NODE)
        for label, column in scalars(node):
            before = column[0].item()
            after = np.nan if label.startswith("state") else other_value(before)
            if label.startswith("next"):  # a link must stay one that can be followed
                after = -1 if before != -1 else refs[0]
            column[0] = after
            if net.check() == []:
                missed.append((place, label, before, after))
            column[0] = before
    assert missed == []
    assert net.check() == []


@pytest.mark.parametrize("name", CONTESTANTS)
def test_lost_tetra_is_found(name):
    """A tetra that neighbours and lists know but iteration does not."""
    net = edited_net(name)
    counters = net.storage.slots.counters
    counters[0] -= 1
    assert net.check() != []
    counters[0] += 1
