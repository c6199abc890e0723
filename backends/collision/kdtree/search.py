"""What is near: pairs in contact, and objects in a rectangle. Source: section 3.1, the search for a rectangle.

How a leaf's contacts are found:

- PER_LEAF: one search for a leaf, with the rectangle of all that its objects can touch; each pair of leaves is met once.
- PER_OBJECT: a search for each object, with the square of what it can touch, as the source's text describes it.
- OWN_LEAF: none, as the source's code does: contacts across the borders of leaves are missed.

A search begins at the lowest node that holds the rectangle, found upward from the leaf, not at the root.
"""

import numpy as np

from tetrabench.backends.collision.kdtree.storage import (
    NODES,
    NOWHERE,
    OWN_LEAF,
    PER_LEAF,
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
        if tree.search == OWN_LEAF:
            continue
        if tree.search == PER_LEAF:
            count = pairs_beyond(tree, leaf, out, count)
        else:
            count = pairs_of_each(tree, leaf, out, count)
    return count


@kernel(allocates=False, inline=True)
def note(tree, b, place, c, other, out, count):
    """Write down two objects if they are in contact."""
    dx, dy = tree.x[b, place] - tree.x[c, other], tree.y[b, place] - tree.y[c, other]
    reach = tree.r[b, place] + tree.r[c, other]
    if dx * dx + dy * dy < reach * reach:
        if count < len(out):
            i, j = tree.number[b, place], tree.number[c, other]
            out[count, 0], out[count, 1] = min(i, j), max(i, j)
        count += 1
    return count


@kernel(allocates=False)
def pairs_within(tree, leaf, out, count):
    """Of objects of one leaf."""
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            for other in range(place + 1, tree.held[b]):
                count = note(tree, b, place, b, other, out, count)
            c = np.int64(tree.chained[b])
            while c != NOWHERE:
                for other in range(tree.held[c]):
                    count = note(tree, b, place, c, other, out, count)
                c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False)
def pairs_beyond(tree, leaf, out, count):
    """Of the objects of a leaf and those of all leaves with a higher number, by one search."""
    x_low = y_low = np.inf
    x_high = y_high = -np.inf
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            px, py, reach = tree.x[b, place], tree.y[b, place], tree.r[b, place] + tree.largest
            x_low, x_high = min(x_low, px - reach), max(x_high, px + reach)
            y_low, y_high = min(y_low, py - reach), max(y_high, py + reach)
        b = np.int64(tree.chained[b])
    if not x_low <= x_high:
        return count  # an empty leaf
    stack = tree.stack
    stack[0] = node_around(tree, leaf, x_low, y_low, x_high, y_high)
    waiting = 1
    while waiting:
        waiting -= 1
        node = np.int64(stack[waiting])
        if tree.buffer[node] != NOWHERE:
            if node > leaf:
                count = pairs_between(tree, leaf, node, out, count)
            continue
        split, child = tree.split[node], tree.child[node]
        low, high = (y_low, y_high) if tree.axis[node] else (x_low, x_high)
        if high >= split:
            stack[waiting] = child + 1
            waiting += 1
        if low < split:
            stack[waiting] = child
            waiting += 1
    return count


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
def pairs_between(tree, leaf, node, out, count):
    """Of the objects of two leaves; only those whose reach enters the other's rectangle are tested."""
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            px, py, reach = tree.x[b, place], tree.y[b, place], tree.r[b, place] + tree.largest
            if (
                px - reach < tree.rect[node, X_HIGH]
                and px + reach >= tree.rect[node, X_LOW]
                and py - reach < tree.rect[node, Y_HIGH]
                and py + reach >= tree.rect[node, Y_LOW]
            ):
                c = np.int64(tree.buffer[node])
                while c != NOWHERE:
                    for other in range(tree.held[c]):
                        count = note(tree, b, place, c, other, out, count)
                    c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False)
def pairs_of_each(tree, leaf, out, count):
    """Of the objects of a leaf and those of other leaves, by a search for each; the lesser number finds the greater."""
    stack = tree.stack
    b = np.int64(tree.buffer[leaf])
    while b != NOWHERE:
        for place in range(tree.held[b]):
            i, reach = tree.number[b, place], tree.r[b, place] + tree.largest
            x_low, x_high = tree.x[b, place] - reach, tree.x[b, place] + reach
            y_low, y_high = tree.y[b, place] - reach, tree.y[b, place] + reach
            stack[0] = node_around(tree, leaf, x_low, y_low, x_high, y_high)
            waiting = 1
            while waiting:
                waiting -= 1
                node = np.int64(stack[waiting])
                if tree.buffer[node] == NOWHERE:
                    split, child = tree.split[node], tree.child[node]
                    low, high = (y_low, y_high) if tree.axis[node] else (x_low, x_high)
                    if high >= split:
                        stack[waiting] = child + 1
                        waiting += 1
                    if low < split:
                        stack[waiting] = child
                        waiting += 1
                elif node != leaf:
                    c = np.int64(tree.buffer[node])
                    while c != NOWHERE:
                        for other in range(tree.held[c]):
                            if i < tree.number[c, other]:
                                count = note(tree, b, place, c, other, out, count)
                        c = np.int64(tree.chained[c])
        b = np.int64(tree.chained[b])
    return count


@kernel(allocates=False)
def look_into(tree, x_low, y_low, x_high, y_high, out):
    """All objects with their centre in a rectangle, its border included."""
    count = 0
    stack = tree.stack
    stack[0] = 0
    waiting = 1
    while waiting:
        waiting -= 1
        node = np.int64(stack[waiting])
        if tree.buffer[node] == NOWHERE:
            split, child = tree.split[node], tree.child[node]
            low, high = (y_low, y_high) if tree.axis[node] else (x_low, x_high)
            if high >= split:
                stack[waiting] = child + 1
                waiting += 1
            if low < split:
                stack[waiting] = child
                waiting += 1
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
