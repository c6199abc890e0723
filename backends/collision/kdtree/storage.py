"""The arrays of the tree: nodes, and buffers that hold the objects of leaves.

A node is a leaf if it has a buffer. The two children of a node are neighbours in memory. A buffer has room for `capacity`
objects, which lie in its first places (the source has an occupancy mask instead). What a leaf holds beyond that, objects in
one and the same place, is in buffers that are chained to its first. Nodes and buffers that are not needed any more are
kept for the next split.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision import interface
from tetrabench.collision.objects import Floats
from tetrabench.jit import implements, kernel

NOWHERE = -1
X_LOW, Y_LOW, X_HIGH, Y_HIGH = range(4)
NODES, FREE, BUFFERS, SPARE, MOVERS, SPARSE, LEAVES, DEPTH, RELOCATIONS, SPLITS, MERGES = range(11)
OWN_LEAF, PER_OBJECT, PER_LEAF = range(3)


class KdTree(NamedTuple):
    """A tree.

    Attributes:
        child: (nodes,) int32: the left child, the right one is the next; of a pair that is not in use the next such pair.
        up: (nodes,) int32: the parent, NOWHERE of the root, which is node 0.
        axis: (nodes,) int8: 0, x < split is left, or 1, y < split is left.
        split: (nodes,) float64.
        rect: (nodes, 4) float64: X_LOW, Y_LOW, X_HIGH, Y_HIGH, the high ends excluded; the outermost are infinite.
        extent: (nodes, 4) float64: of a leaf's centres, when pairs were looked for last.
        level: (nodes,) int32: of the root 0.
        buffer: (nodes,) int32: of a leaf, else NOWHERE.
        held: (buffers,) int32: objects in a buffer.
        chained: (buffers,) int32: the next buffer of the same leaf, or NOWHERE.
        number: (buffers, capacity) int32: objects; x, y, r: (buffers, capacity) float64: theirs.
        spare: (buffers,) int32: a stack of buffers that are not in use.
        movers: (n,) int32: objects that are to be inserted; sparse: (nodes,) int32: leaves that may be merged.
        stack: (depth, 2) int32: nodes, or pairs of them, that a search comes back to.
        radius: (n,) float64: by number; not the tree's own.
        state: (11,) int64: NODES and BUFFERS that were ever in use; the first FREE pair of nodes, or NOWHERE; SPARE buffers;
            MOVERS, SPARSE leaves, LEAVES, the greatest DEPTH ever; counts of RELOCATIONS, SPLITS and MERGES.
        largest: the largest radius.
        recycles, by_median: whether leaves are merged, and split at the median, not the mean.
        search: OWN_LEAF, PER_OBJECT or PER_LEAF: see `search`.
    """

    child: NDArray[np.int32]
    up: NDArray[np.int32]
    axis: NDArray[np.int8]
    split: Floats
    rect: Floats
    extent: Floats
    level: NDArray[np.int32]
    buffer: NDArray[np.int32]
    held: NDArray[np.int32]
    chained: NDArray[np.int32]
    number: NDArray[np.int32]
    x: Floats
    y: Floats
    r: Floats
    spare: NDArray[np.int32]
    movers: NDArray[np.int32]
    sparse: NDArray[np.int32]
    stack: NDArray[np.int32]
    radius: Floats
    state: NDArray[np.int64]
    largest: float
    recycles: bool
    by_median: bool
    search: int


NODE_ARRAYS = ("child", "up", "axis", "split", "rect", "extent", "level", "buffer", "sparse")
BUFFER_ARRAYS = ("held", "chained", "number", "x", "y", "r", "spare")


def empty_tree(r: Floats, capacity: int, *, recycles: bool, by_median: bool, search: int) -> KdTree:
    """A root that is a leaf and holds nothing."""
    nodes, buffers = 64, 32
    tree = KdTree(
        child=np.full(nodes, NOWHERE, np.int32),
        up=np.full(nodes, NOWHERE, np.int32),
        axis=np.zeros(nodes, np.int8),
        split=np.zeros(nodes),
        rect=np.zeros((nodes, 4)),
        extent=np.zeros((nodes, 4)),
        level=np.zeros(nodes, np.int32),
        buffer=np.full(nodes, NOWHERE, np.int32),
        held=np.zeros(buffers, np.int32),
        chained=np.full(buffers, NOWHERE, np.int32),
        number=np.zeros((buffers, capacity), np.int32),
        x=np.zeros((buffers, capacity)),
        y=np.zeros((buffers, capacity)),
        r=np.zeros((buffers, capacity)),
        spare=np.zeros(buffers, np.int32),
        movers=np.zeros(len(r), np.int32),
        sparse=np.zeros(nodes, np.int32),
        stack=np.zeros((256, 2), np.int32),
        radius=r,
        state=np.zeros(11, np.int64),
        largest=float(r.max(initial=0.0)),
        recycles=recycles,
        by_median=by_median,
        search=search,
    )
    tree.rect[0] = -np.inf, -np.inf, np.inf, np.inf
    tree.buffer[0] = 0
    tree.state[FREE] = NOWHERE
    tree.state[NODES] = tree.state[BUFFERS] = tree.state[LEAVES] = 1
    return tree


@kernel(allocates=False, inline=True)
def has_depth(state, stack):
    """Whether the stack serves a tree with one level more: a walk leaves two pairs waiting at each level of both nodes."""
    return 4 * (state[DEPTH] + 2) <= len(stack)


@kernel(allocates=False, inline=True)
def has_room(tree):
    """Whether an object can be inserted, which takes two nodes, a buffer and a level at most."""
    state = tree.state
    return (
        (state[FREE] != NOWHERE or state[NODES] + 2 <= len(tree.child))
        and (state[SPARE] > 0 or state[BUFFERS] < len(tree.held))
        and has_depth(tree.state, tree.stack)
    )


@kernel
def grow(tree):
    """The tree with half as much room again wherever it is short."""
    state = tree.state
    child, up, axis, split = tree.child, tree.up, tree.axis, tree.split
    rect, extent, level, buffer, sparse = tree.rect, tree.extent, tree.level, tree.buffer, tree.sparse
    held, chained, spare = tree.held, tree.chained, tree.spare
    number, x, y, r, stack = tree.number, tree.x, tree.y, tree.r, tree.stack
    if state[FREE] == NOWHERE and state[NODES] + 2 > len(child):
        more = len(child) // 2
        child, up = np.append(child, np.full(more, NOWHERE, np.int32)), np.append(up, np.full(more, NOWHERE, np.int32))
        axis, split = np.append(axis, np.zeros(more, np.int8)), np.append(split, np.zeros(more))
        rect, extent = np.concatenate((rect, np.zeros((more, 4)))), np.concatenate((extent, np.zeros((more, 4))))
        level, sparse = np.append(level, np.zeros(more, np.int32)), np.append(sparse, np.zeros(more, np.int32))
        buffer = np.append(buffer, np.full(more, NOWHERE, np.int32))
    if state[SPARE] == 0 and state[BUFFERS] == len(held):
        more = len(held) // 2
        held, spare = np.append(held, np.zeros(more, np.int32)), np.append(spare, np.zeros(more, np.int32))
        chained = np.append(chained, np.full(more, NOWHERE, np.int32))
        number = np.concatenate((number, np.zeros((more, number.shape[1]), np.int32)))
        room = np.zeros((more, number.shape[1]))
        x, y, r = np.concatenate((x, room)), np.concatenate((y, room)), np.concatenate((r, room))
    if not has_depth(state, stack):
        stack = np.zeros((2 * len(stack), 2), np.int32)
    return KdTree(
        child,
        up,
        axis,
        split,
        rect,
        extent,
        level,
        buffer,
        held,
        chained,
        number,
        x,
        y,
        r,
        spare,
        tree.movers,
        sparse,
        stack,
        tree.radius,
        state,
        tree.largest,
        tree.recycles,
        tree.by_median,
        tree.search,
    )


@kernel(allocates=False, inline=True)
def take_pair(tree):
    """Two nodes side by side; the left one."""
    state = tree.state
    left = state[FREE]
    if left != NOWHERE:
        state[FREE] = tree.child[left]
    else:
        left = state[NODES]
        state[NODES] += 2
    return left


@kernel(allocates=False, inline=True)
def give_pair_back(tree, left):
    """Two nodes that are not needed any more."""
    tree.buffer[left] = tree.buffer[left + 1] = NOWHERE
    tree.child[left] = tree.state[FREE]
    tree.state[FREE] = left


@kernel(allocates=False, inline=True)
def take_buffer(tree):
    """An empty buffer."""
    state = tree.state
    if state[SPARE] > 0:
        state[SPARE] -= 1
        b = np.int64(tree.spare[state[SPARE]])
    else:
        b = state[BUFFERS]
        state[BUFFERS] += 1
    tree.held[b] = 0
    tree.chained[b] = NOWHERE
    return b


@kernel(allocates=False, inline=True)
def give_back(tree, b):
    """A buffer that is not needed any more."""
    tree.spare[tree.state[SPARE]] = b
    tree.state[SPARE] += 1


@kernel(allocates=False, inline=True)
def put(tree, b, i, x, y, r):
    """An object into a buffer that has room for it."""
    place = tree.held[b]
    tree.number[b, place] = i
    tree.x[b, place], tree.y[b, place], tree.r[b, place] = x, y, r
    tree.held[b] = place + 1


@kernel(allocates=False, inline=True)
def take_out(tree, b, place):
    """The last object of a buffer moves to where one has been."""
    last = tree.held[b] - 1
    tree.number[b, place] = tree.number[b, last]
    tree.x[b, place], tree.y[b, place], tree.r[b, place] = tree.x[b, last], tree.y[b, last], tree.r[b, last]
    tree.held[b] = last


@implements(interface.stats, KdTree)
def stats(storage):
    state, capacity = storage.state, storage.number.shape[1]
    leaves = int(state[LEAVES])
    in_use = storage.buffer[: state[NODES]] != NOWHERE
    return {
        "leaves": leaves,
        "depth": int(storage.level[: state[NODES]][in_use].max()),
        "fill": len(storage.movers) / (leaves * capacity),
        "relocations": int(state[RELOCATIONS]),
        "splits": int(state[SPLITS]),
        "merges": int(state[MERGES]),
    }


@implements(interface.leaf_rectangles, KdTree)
def leaf_rectangles(storage):
    nodes = storage.state[NODES]
    return storage.rect[:nodes][storage.buffer[:nodes] != NOWHERE]


@implements(interface.structure_bytes, KdTree)
def structure_bytes(storage):
    state = storage.state
    used = dict.fromkeys(NODE_ARRAYS, int(state[NODES])) | dict.fromkeys(BUFFER_ARRAYS, int(state[BUFFERS]))
    whole = interface.bytes_of(storage, without=("radius",))
    rows = {name: getattr(storage, name) for name in used}
    return whole | {name: (used[name] * rows[name][:1].nbytes, rows[name].nbytes) for name in used}
