"""From step to step: objects that have left their leaf are inserted again, and sparse leaves are merged.

Source: sections 4.2 and 4.3. A leaf that holds at most a quarter of the capacity is queued; where it and its sibling, a
leaf too, hold at most two thirds together, their parent takes over the fuller one's buffer and all objects, and may be
merged in turn. The source leaves the children where they are, for the next split there (its second variant); here nodes and
buffer go back, for the next split anywhere (as in its first), so that memory does not grow where objects move on.
"""

import numpy as np

from tetrabench.backends.collision.kdtree.insert import insert_movers
from tetrabench.backends.collision.kdtree.storage import (
    LEAVES,
    MERGES,
    MOVERS,
    NODES,
    NOWHERE,
    RELOCATIONS,
    SPARSE,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
    KdTree,
    give_back,
    give_pair_back,
    put,
    take_out,
)
from tetrabench.collision import interface
from tetrabench.jit import implements, kernel


@implements(interface.update, KdTree)
def update(storage, x, y):
    return follow(storage, x, y)


@kernel
def follow(tree, x, y):
    """Write the objects' places into the leaves; move those that have left theirs; merge."""
    visit_leaves(tree, x, y)
    tree = insert_movers(tree, x, y)
    if tree.recycles:
        merge_sparse(tree)
    return tree


@kernel(allocates=False)
def visit_leaves(tree, x, y):
    """Bring the places up to date, list the movers, take them out, and list the leaves that are sparse then."""
    state, capacity = tree.state, tree.number.shape[1]
    state[MOVERS] = state[SPARSE] = 0
    for node in range(state[NODES]):
        b = np.int64(tree.buffer[node])
        if b == NOWHERE:
            continue
        empty_chain(tree, node, b, x, y)
        x_low, y_low = tree.rect[node, X_LOW], tree.rect[node, Y_LOW]
        x_high, y_high = tree.rect[node, X_HIGH], tree.rect[node, Y_HIGH]
        place = 0
        while place < tree.held[b]:
            i = tree.number[b, place]
            px, py = x[i], y[i]
            if px < x_low or px >= x_high or py < y_low or py >= y_high:
                tree.movers[state[MOVERS]] = i
                state[MOVERS] += 1
                state[RELOCATIONS] += 1
                take_out(tree, b, place)
            else:
                tree.x[b, place], tree.y[b, place] = px, py
                place += 1
        if 4 * tree.held[b] <= capacity:
            tree.sparse[state[SPARSE]] = node
            state[SPARSE] += 1


@kernel(allocates=False)
def empty_chain(tree, node, b, x, y):
    """What a leaf holds beyond its capacity was in one place, and may not be any more: it is inserted again."""
    state, rect = tree.state, tree.rect
    following = np.int64(tree.chained[b])
    tree.chained[b] = NOWHERE
    while following != NOWHERE:
        for place in range(tree.held[following]):
            i = tree.number[following, place]
            tree.movers[state[MOVERS]] = i
            state[MOVERS] += 1
            is_in_x = rect[node, X_LOW] <= x[i] < rect[node, X_HIGH]
            state[RELOCATIONS] += 0 if is_in_x and rect[node, Y_LOW] <= y[i] < rect[node, Y_HIGH] else 1
        emptied = following
        following = np.int64(tree.chained[emptied])
        give_back(tree, emptied)


@kernel(allocates=False)
def merge_sparse(tree):
    """Merge the leaves of the queue with their siblings, and what comes of it again."""
    state, capacity = tree.state, tree.number.shape[1]
    for place in range(state[SPARSE]):
        node = np.int64(tree.sparse[place])
        while tree.up[node] != NOWHERE and tree.buffer[node] != NOWHERE:
            parent = np.int64(tree.up[node])
            left = np.int64(tree.child[parent])
            b, other = np.int64(tree.buffer[left]), np.int64(tree.buffer[left + 1])
            if b == NOWHERE or other == NOWHERE:
                break
            if tree.held[b] < tree.held[other]:
                b, other = other, b
            # either of them may be the sparse one: the other may have become a leaf only now
            if 4 * tree.held[other] > capacity or 3 * (tree.held[b] + tree.held[other]) > 2 * capacity:
                break
            for moved in range(tree.held[other]):
                put(
                    tree, b, tree.number[other, moved], tree.x[other, moved], tree.y[other, moved], tree.r[other, moved]
                )
            give_back(tree, other)
            give_pair_back(tree, left)
            tree.buffer[parent] = b
            state[LEAVES] -= 1
            state[MERGES] += 1
            node = parent
