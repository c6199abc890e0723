"""Objects into leaves: the search for a point, and the split of a leaf that is full. Source: sections 3.1 to 3.3.

A split is at the mean of one coordinate of what the leaf holds (as the source's code has it; its text says the median, which
is an option), x and y in turn. One child takes over the buffer, and only what belongs to the other one moves. Where all
have one and the same coordinate, it is the other coordinate's turn; where they have both, there is nothing to be split.
"""

import numpy as np

from tetrabench.backends.collision.kdtree.storage import (
    DEPTH,
    LEAVES,
    MOVERS,
    NOWHERE,
    SPLITS,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
    grow,
    has_room,
    put,
    take_buffer,
    take_out,
    take_pair,
)
from tetrabench.jit import kernel


@kernel
def insert_movers(tree, x, y):
    """All of the movers, from the root. Returns the tree, which may have grown."""
    place = 0
    while place < tree.state[MOVERS]:
        place = insert_while_room(tree, x, y, place)
        if place < tree.state[MOVERS]:
            tree = grow(tree)
    tree.state[MOVERS] = 0
    return tree


@kernel(allocates=False)
def insert_while_room(tree, x, y, first):
    """Movers from number `first` on; returns the number of the first that there was no room for."""
    for place in range(first, tree.state[MOVERS]):
        if not has_room(tree):
            return place
        i = tree.movers[place]
        px, py = x[i], y[i]
        node = 0
        while True:
            while tree.buffer[node] == NOWHERE:
                coordinate = py if tree.axis[node] else px
                node = tree.child[node] + (0 if coordinate < tree.split[node] else 1)
            b = np.int64(tree.buffer[node])
            if tree.held[b] < tree.number.shape[1] or not split_leaf(tree, node, px, py):
                break
        put(tree, with_room(tree, b), i, px, py, tree.radius[i])
    return tree.state[MOVERS]


@kernel(allocates=False, inline=True)
def with_room(tree, b):
    """The buffer of a leaf that has room; of a chain a new one, first behind the leaf's own, where the last new one is full."""
    if tree.held[b] < tree.number.shape[1]:
        return b
    following = np.int64(tree.chained[b])
    if following != NOWHERE and tree.held[following] < tree.number.shape[1]:
        return following
    new = take_buffer(tree)
    tree.chained[new] = following
    tree.chained[b] = new
    return new


@kernel(allocates=False)
def split_leaf(tree, node, px, py):
    """Make two leaves of one that is full, to which an object at (px, py) is to come. False: all are in that very place."""
    b = np.int64(tree.buffer[node])
    axis = tree.level[node] % 2
    if not is_spread(tree, b, axis, px, py):
        axis = 1 - axis
        if not is_spread(tree, b, axis, px, py):
            return False
    split = middle(tree, b, axis, px, py)
    left = attach_children(tree, node, axis, split)
    right = left + 1
    other = take_buffer(tree)
    # What a chain holds is in one place, so that it goes to one side as a whole.
    if tree.chained[b] != NOWHERE and coordinate_of(tree, b, 0, axis) >= split:
        tree.buffer[left], tree.buffer[right] = other, b
    else:
        tree.buffer[left], tree.buffer[right] = b, other
        place = 0
        while place < tree.held[b]:
            if coordinate_of(tree, b, place, axis) < split:
                place += 1
                continue
            put(tree, other, tree.number[b, place], tree.x[b, place], tree.y[b, place], tree.r[b, place])
            take_out(tree, b, place)
    tree.buffer[node] = NOWHERE
    tree.state[LEAVES] += 1
    tree.state[SPLITS] += 1
    return True


@kernel(allocates=False, inline=True)
def coordinate_of(tree, b, place, axis):
    """Of an object in a buffer."""
    return tree.y[b, place] if axis else tree.x[b, place]


@kernel(allocates=False)
def is_spread(tree, b, axis, px, py):
    """Whether a coordinate differs anywhere; what is chained to a full buffer lies where the first one does.

    What is no number, as after an overflow, differs from nothing: else it would be split off from the rest for ever.
    """
    new = py if axis else px
    for place in range(tree.held[b]):
        coordinate = coordinate_of(tree, b, place, axis)
        if coordinate < new or coordinate > new:
            return True
    return False


@kernel(allocates=False)
def middle(tree, b, axis, px, py):
    """Where to split: at least one object is below it, and one is not."""
    new = py if axis else px
    low = high = total = new
    for place in range(tree.held[b]):
        coordinate = coordinate_of(tree, b, place, axis)
        low, high = coordinate if coordinate < low else low, coordinate if coordinate > high else high
        total += coordinate
    split = median(tree, b, axis, new) if tree.by_median else total / (tree.held[b] + 1)
    return split if low < split <= high else high


@kernel(allocates=False)
def median(tree, b, axis, new):
    """The coordinate that as many are below as not, of a buffer and a new one: the one with so many below it."""
    held = tree.held[b]
    best, best_below = new, -1
    for place in range(held + 1):
        coordinate = new if place == held else coordinate_of(tree, b, place, axis)
        below = 1 if new < coordinate else 0
        for other in range(held):
            below += 1 if coordinate_of(tree, b, other, axis) < coordinate else 0
        if best_below < below <= (held + 1) // 2:
            best, best_below = coordinate, below
    return best


@kernel(allocates=False)
def attach_children(tree, node, axis, split):
    """Divide the rectangle of a node between two children; returns the left one."""
    left = take_pair(tree)
    tree.child[node], tree.axis[node], tree.split[node] = left, axis, split
    for side in (left, left + 1):
        tree.up[side] = node
        tree.level[side] = tree.level[node] + 1
        for end in range(4):
            tree.rect[side, end] = tree.rect[node, end]
    tree.rect[left, Y_HIGH if axis else X_HIGH] = split
    tree.rect[left + 1, Y_LOW if axis else X_LOW] = split
    tree.state[DEPTH] = max(tree.state[DEPTH], np.int64(tree.level[left]))
    return left
