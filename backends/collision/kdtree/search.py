"""What is near: pairs in contact, and objects in a rectangle. Source: section 3.1, the search for a rectangle.

How a leaf's contacts are found:

- PER_LEAF: the tree is walked against itself, so that each pair of neighbouring leaves is met once, for all objects in them.
- PER_OBJECT: a search for each object, with the square of what it can touch, as the source's text describes it; it begins
  at the lowest node that holds the square, found upward from the leaf, not at the root.
- OWN_LEAF: none, as the source's code does: contacts across the borders of leaves are missed.
"""

import numpy as np

from tetrabench.backends.collision.kdtree.storage import (
    NODES,
    NOWHERE,
    PER_LEAF,
    PER_OBJECT,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
    KdTree,
)
from tetrabench.collision import interface
from tetrabench.jit import implements, kernel


@implements(interface.pairs, KdTree)
def pairs(storage, x, y, r, out):
    return find_pairs(storage, out)


@implements(interface.query_rect, KdTree)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    return look_into(storage, x_low, y_low, x_high, y_high, out)


@kernel(allocates=False)
def find_pairs(tree, out):
    """All pairs in contact, by whichever search."""
    count = 0
    for leaf in range(tree.state[NODES]):
        if tree.buffer[leaf] == NOWHERE:
            continue
        count = pairs_within(tree, leaf, out, count)
        if tree.search == PER_OBJECT:
            count = pairs_of_each(tree, leaf, out, count)
        elif tree.search == PER_LEAF:
            measure(tree, leaf)
    return walk(tree, out, count) if tree.search == PER_LEAF else count


@kernel(allocates=False)
def measure(tree, leaf):
    """The extent of the centres in a leaf."""
    x_low = y_low = np.inf
    x_high = y_high = -np.inf
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            px, py = tree.x[b, place], tree.y[b, place]
            x_low, x_high = min(x_low, px), max(x_high, px)
            y_low, y_high = min(y_low, py), max(y_high, py)
        b = np.int64(tree.chained[b])
    tree.extent[leaf, X_LOW], tree.extent[leaf, X_HIGH] = x_low, x_high
    tree.extent[leaf, Y_LOW], tree.extent[leaf, Y_HIGH] = y_low, y_high


@kernel(allocates=False)
def walk(tree, out, count):
    """The tree against itself, from the root: two nodes are looked into only where they are near enough to each other."""
    reach, stack = 2 * tree.largest, tree.stack
    stack[0, 0] = stack[0, 1] = 0
    waiting = 1
    while waiting:
        waiting -= 1
        one, other = np.int64(stack[waiting, 0]), np.int64(stack[waiting, 1])
        is_leaf, is_other_leaf = tree.buffer[one] != NOWHERE, tree.buffer[other] != NOWHERE
        if one == other:
            if not is_leaf:
                left = np.int64(tree.child[one])
                stack[waiting, 0], stack[waiting, 1] = left, left + 1
                stack[waiting + 1, 0] = stack[waiting + 1, 1] = left + 1
                stack[waiting + 2, 0] = stack[waiting + 2, 1] = left
                waiting += 3
        elif is_leaf and is_other_leaf:
            if are_near(tree.extent, one, other, reach):
                count = pairs_between(tree, one, other, out, count)
        elif are_near(tree.rect, one, other, reach):
            if is_leaf or (not is_other_leaf and tree.level[other] < tree.level[one]):
                one, other = other, one
            left = np.int64(tree.child[one])  # of the larger one
            stack[waiting, 0], stack[waiting, 1] = left, other
            stack[waiting + 1, 0], stack[waiting + 1, 1] = left + 1, other
            waiting += 2
    return count


@kernel(allocates=False, inline=True)
def are_near(boxes, one, other, reach):
    """Whether objects of two nodes can touch, by the boxes that their centres are in."""
    return not (
        boxes[other, X_LOW] - boxes[one, X_HIGH] >= reach
        or boxes[one, X_LOW] - boxes[other, X_HIGH] >= reach
        or boxes[other, Y_LOW] - boxes[one, Y_HIGH] >= reach
        or boxes[one, Y_LOW] - boxes[other, Y_HIGH] >= reach
    )


@kernel(allocates=False, inline=True)
def test_buffer(tree, b, place, c, first, out, count):
    """One object against those of a buffer, from a place on; looked at one by one only where there is a contact."""
    px, py, pr = tree.x[b, place], tree.y[b, place], tree.r[b, place]
    row, contacts = np.uint64(c), 0
    for other in range(first, tree.held[c]):
        column = np.uint64(other)
        dx, dy, reach = px - tree.x[row, column], py - tree.y[row, column], pr + tree.r[row, column]
        contacts += dx * dx + dy * dy < reach * reach
    if contacts:
        i = tree.number[b, place]
        for other in range(first, tree.held[c]):
            dx, dy, reach = px - tree.x[c, other], py - tree.y[c, other], pr + tree.r[c, other]
            if dx * dx + dy * dy < reach * reach:
                if count < len(out):
                    j = tree.number[c, other]
                    out[count, 0], out[count, 1] = min(i, j), max(i, j)
                count += 1
    return count


@kernel(allocates=False)
def pairs_within(tree, leaf, out, count):
    """Of objects of one leaf."""
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            count = test_buffer(tree, b, place, b, place + 1, out, count)
            c = np.int64(tree.chained[b])
            while c != NOWHERE:
                count = test_buffer(tree, b, place, c, 0, out, count)
                c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False)
def pairs_between(tree, leaf, node, out, count):
    """Of the objects of two leaves; only those whose reach enters the other's extent are tested."""
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        entering = 0
        for place in range(tree.held[b]):
            entering += enters(tree, b, place, node)
        for place in range(tree.held[b] if entering else 0):
            if enters(tree, b, place, node):
                c = np.int64(tree.buffer[node])
                while c != NOWHERE:
                    count = test_buffer(tree, b, place, c, 0, out, count)
                    c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False, inline=True)
def enters(tree, b, place, node):
    """Whether an object can touch one of a leaf. Without branches, so that several are tested at once."""
    row, column = np.uint64(b), np.uint64(place)
    px, py, reach = tree.x[row, column], tree.y[row, column], tree.r[row, column] + tree.largest
    return (
        (px - reach <= tree.extent[node, X_HIGH])
        & (px + reach >= tree.extent[node, X_LOW])
        & (py - reach <= tree.extent[node, Y_HIGH])
        & (py + reach >= tree.extent[node, Y_LOW])
    )


@kernel(allocates=False, inline=True)
def node_around(tree, leaf, x_low, y_low, x_high, y_high):
    """The lowest node that holds a leaf and a rectangle."""
    node = np.int64(leaf)
    while tree.up[node] != NOWHERE and not (
        tree.rect[node, X_LOW] <= x_low
        and x_high < tree.rect[node, X_HIGH]
        and tree.rect[node, Y_LOW] <= y_low
        and y_high < tree.rect[node, Y_HIGH]
    ):
        node = np.int64(tree.up[node])
    return node


@kernel(allocates=False, inline=True)
def open_node(tree, node, x_low, y_low, x_high, y_high, waiting):
    """Children that a rectangle enters go onto the stack; returns how many nodes wait there."""
    split, child = tree.split[node], tree.child[node]
    low, high = (y_low, y_high) if tree.axis[node] else (x_low, x_high)
    if high >= split:
        tree.stack[waiting, 0] = child + 1
        waiting += 1
    if low < split:
        tree.stack[waiting, 0] = child
        waiting += 1
    return waiting


@kernel(allocates=False)
def pairs_of_each(tree, leaf, out, count):
    """Of the objects of a leaf and those of other leaves, by a search for each; leaves find those with a higher number."""
    stack = tree.stack
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            reach = tree.r[b, place] + tree.largest
            x_low, x_high = tree.x[b, place] - reach, tree.x[b, place] + reach
            y_low, y_high = tree.y[b, place] - reach, tree.y[b, place] + reach
            stack[0, 0] = node_around(tree, leaf, x_low, y_low, x_high, y_high)
            waiting = 1
            while waiting:
                waiting -= 1
                node = np.int64(stack[waiting, 0])
                if tree.buffer[node] == NOWHERE:
                    waiting = open_node(tree, node, x_low, y_low, x_high, y_high, waiting)
                elif node > leaf:
                    c = np.int64(tree.buffer[node])
                    while c != NOWHERE:
                        count = test_buffer(tree, b, place, c, 0, out, count)
                        c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False)
def look_into(tree, x_low, y_low, x_high, y_high, out):
    """All objects with their centre in a rectangle, its border included."""
    count = 0
    stack = tree.stack
    stack[0, 0] = 0
    waiting = 1
    while waiting:
        waiting -= 1
        node = np.int64(stack[waiting, 0])
        if tree.buffer[node] == NOWHERE:
            waiting = open_node(tree, node, x_low, y_low, x_high, y_high, waiting)
            continue
        b = np.int64(tree.buffer[node])
        while b != NOWHERE:
            for place in range(tree.held[b]):
                px, py = tree.x[b, place], tree.y[b, place]
                if x_low <= px <= x_high and y_low <= py <= y_high:
                    if count < len(out):
                        out[count] = tree.number[b, place]
                    count += 1
            b = np.int64(tree.chained[b])
    return count
