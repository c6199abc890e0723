"""Whether a structure is sound, in plain Python: each function returns what is wrong with it, in words; [] if nothing is.

They are called when the structure has followed the objects to where they are, and nothing has moved since.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from tetrabench.backends.collision.grid import BOTTOM, COLUMNS, LEFT, ROWS, SIDE, Grid
from tetrabench.backends.collision.kdtree.storage import BUFFERS, DEPTH, FREE, LEAVES, NODES, NOWHERE, SPARE, KdTree
from tetrabench.backends.collision.skin import LISTED, Skin
from tetrabench.collision.interface import Storage, structure_bytes
from tetrabench.collision.objects import Objects

Rectangle = tuple[float, float, float, float]
PLANE = (-np.inf, -np.inf, np.inf, np.inf)


def audit(storage: Storage, objects: Objects) -> list[str]:
    """Of whatever structure; of one that keeps nothing of its own there is nothing to be said."""
    audits = {KdTree: audit_tree, Grid: audit_grid, Skin: audit_skin}
    found = audits[type(storage)](storage, objects) if type(storage) in audits else []
    for name, (used, reserved) in structure_bytes(storage).items():
        if not 0 <= used <= reserved:
            found.append(f"{name}: {used} of {reserved} bytes used")
    return found


# ---- the tree


def audit_tree(tree: KdTree, objects: Objects) -> list[str]:
    """Each object in one place, where the splits lead it to; rectangles, buffers, counts, and nothing left to be merged."""
    found: list[str] = []
    leaves = dict(walk(tree, 0, NOWHERE, 0, PLANE, found))
    chains = {leaf: chain_of(tree, leaf) for leaf in leaves}
    for leaf, chain in chains.items():
        found += audit_leaf(tree, leaf, chain, leaves[leaf], objects)
    held = sorted(number for chain in chains.values() for number in numbers_in(tree, chain))
    if held != list(range(len(objects.x))):
        found.append(f"objects held: {held}")
    buffers = sorted([*(b for chain in chains.values() for b in chain), *tree.spare[: tree.state[SPARE]].tolist()])
    if buffers != list(range(tree.state[BUFFERS])):
        found.append(f"buffers in use, chained or spare: {buffers} of {tree.state[BUFFERS]}")
    if tree.state[LEAVES] != len(leaves) or tree.state[DEPTH] < max(tree.level[leaf] for leaf in leaves):
        found.append(f"{len(leaves)} leaves; {tree.state[LEAVES]} and depth {tree.state[DEPTH]} counted")
    nodes = sorted([0, *(side for left in pairs_of_nodes(tree, leaves) for side in (left, left + 1))])
    if nodes != list(range(tree.state[NODES])):
        found.append(f"nodes in use or free: {nodes} of {tree.state[NODES]}")
    if set(np.flatnonzero(tree.buffer[: tree.state[NODES]] != NOWHERE).tolist()) != set(leaves):
        found.append(f"nodes with buffers: {np.flatnonzero(tree.buffer != NOWHERE)}, leaves: {sorted(leaves)}")
    return found + (audit_merges(tree, leaves) if tree.recycles else [])


def walk(
    tree: KdTree, node: int, parent: int, level: int, rectangle: Rectangle, found: list[str]
) -> Iterator[tuple[int, Rectangle]]:
    """The leaves below a node and their rectangles, as the splits on the way have made them."""
    while True:  # down to the right; a chain may be deeper than Python's stack
        if tree.up[node] != parent or tree.level[node] != level or tuple(tree.rect[node].tolist()) != rectangle:
            found.append(f"node {node}: up {tree.up[node]}, level {tree.level[node]}, rectangle {tree.rect[node]}")
        if tree.buffer[node] != NOWHERE:
            yield node, rectangle
            return
        child, axis, split = int(tree.child[node]), int(tree.axis[node]), float(tree.split[node])
        if not 0 < child < tree.state[NODES] - 1 or not rectangle[axis] <= split <= rectangle[axis + 2]:
            found.append(f"node {node}: child {child}, split {split} of {rectangle}")
            return
        below, above = list(rectangle), list(rectangle)
        below[axis + 2] = above[axis] = split
        yield from walk(tree, child, node, level + 1, tuple(below), found)  # type: ignore[arg-type]
        node, parent, level, rectangle = child + 1, node, level + 1, tuple(above)  # type: ignore[assignment]


def pairs_of_nodes(tree: KdTree, leaves: Iterable[int]) -> list[int]:
    """The left one of each pair: those above leaves, once each, and those that are free, as far as there is no circle."""
    above = set()
    for leaf in leaves:
        node = leaf
        while node and node not in above:
            above.add(node)
            node = int(tree.up[node])
    lefts = [int(tree.child[node]) for node in {int(tree.up[node]) for node in above}]
    free = int(tree.state[FREE])
    while free != NOWHERE and free not in lefts:
        lefts.append(free)
        free = int(tree.child[free])
    return lefts


def chain_of(tree: KdTree, leaf: int) -> list[int]:
    """The buffers of a leaf, as far as there is no circle."""
    chain = [int(tree.buffer[leaf])]
    while tree.chained[chain[-1]] != NOWHERE and tree.chained[chain[-1]] not in chain:
        chain.append(int(tree.chained[chain[-1]]))
    return chain


def numbers_in(tree: KdTree, chain: list[int]) -> list[int]:
    """The objects in some buffers."""
    return [number for b in chain for number in tree.number[b, : tree.held[b]].tolist()]


def audit_leaf(tree: KdTree, leaf: int, chain: list[int], rectangle: Rectangle, objects: Objects) -> list[str]:
    """Objects are copied as they are, inside of the rectangle; more than fit only where all lie in one place."""
    found = []
    x_low, y_low, x_high, y_high = rectangle
    places = set()
    for b in chain:
        for place in range(tree.held[b]):
            i = tree.number[b, place]
            x, y = objects.x[i], objects.y[i]
            places.add((float(x), float(y)))
            if (tree.x[b, place], tree.y[b, place], tree.r[b, place]) != (x, y, objects.r[i]):
                found.append(f"object {i} in leaf {leaf}: an old copy")
            if not (x_low <= x < x_high and y_low <= y < y_high):
                found.append(f"object {i} at {x}, {y}: not in {rectangle}")
    capacity = tree.number.shape[1]
    if any(not 0 < tree.held[b] <= capacity for b in chain[1:]) or tree.held[chain[0]] > capacity:
        found.append(f"leaf {leaf}: {[int(tree.held[b]) for b in chain]} in buffers of {capacity}")
    if len(chain) > 1 and (len(places) > 1 or tree.held[chain[0]] < capacity):
        found.append(f"leaf {leaf}: {len(chain)} buffers, {len(places)} places")
    return found


def audit_merges(tree: KdTree, leaves: dict[int, Rectangle]) -> list[str]:
    """No leaf with at most a quarter of the capacity has a sibling leaf that would fit in with it, two thirds at most."""
    found = []
    capacity = tree.number.shape[1]
    for leaf in leaves:
        sibling = leaf + 1 if leaf % 2 else leaf - 1
        if leaf and sibling in leaves:
            here, there = int(tree.held[tree.buffer[leaf]]), int(tree.held[tree.buffer[sibling]])
            if 4 * here <= capacity and 3 * (here + there) <= 2 * capacity:
                found.append(f"leaves {leaf} and {sibling}: {here} and {there} not merged")
    return found


# ---- squares, and lists


def audit_grid(grid: Grid, objects: Objects) -> list[str]:
    """Each object once, in its square, with its place and radius."""
    found, held = [], grid.old
    columns, rows = grid.shape[COLUMNS], grid.shape[ROWS]
    starts = grid.starts[: columns * rows + 1].tolist()
    if sorted(held.number.tolist()) != list(range(len(objects.x))):
        found.append(f"objects held: {held.number}")
    if starts[0] != 0 or starts[-1] != len(objects.x) or starts != sorted(starts):
        found.append(f"squares begin at {starts}")
    left, bottom, side = grid.frame[LEFT], grid.frame[BOTTOM], grid.frame[SIDE]
    for c in range(columns * rows):
        for place in range(starts[c], starts[c + 1]):
            i = held.number[place]
            if (held.x[place], held.y[place], held.r[place]) != (objects.x[i], objects.y[i], objects.r[i]):
                found.append(f"object {i}: an old copy")
            column, row = (objects.x[i] - left) / side, (objects.y[i] - bottom) / side
            if (min(int(column), columns - 1), min(int(row), rows - 1)) != (c % columns, c // columns):
                found.append(f"object {i} in square {c}, not {column}, {row}")
    if len(objects.x) and side < 2 * objects.r.max():
        found.append(f"squares of {side}")
    return found


def audit_skin(skin: Skin, objects: Objects) -> list[str]:
    """The list holds all pairs that were within the skin when it was made, which is long enough ago for none else to touch."""
    found = []
    listed = list(map(tuple, skin.near[: skin.state[LISTED]].tolist()))
    x, y, r = skin.then_x, skin.then_y, objects.r
    near = []
    for i in range(len(x)):
        dx, dy, reach = x[i] - x[i + 1 :], y[i] - y[i + 1 :], r[i] + r[i + 1 :] + skin.skin
        near += [(i, i + 1 + int(k)) for k in np.flatnonzero(dx * dx + dy * dy < reach * reach)]
    if listed != near:
        found.append(f"listed: {listed}, near: {near}")
    moved = np.hypot(objects.x - x, objects.y - y).max(initial=0.0)
    if len(x) and not moved < skin.skin / 2:
        found.append(f"moved by {moved} with a skin of {skin.skin}")
    then = objects._replace(x=x, y=y)
    return found + audit_grid(skin.grid, then)
