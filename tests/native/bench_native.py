"""How fast our kernels are beside C: both in turn on the same memory, thread CPU time, medians of paired ratios.

    python tests/native/bench_native.py [--tets N] [--numbering natural] [--turns 21] [--only v4,alfa] [-o FILE]

A turn is one sample of ours and one of C, the order alternating. A sample of alfa or flow is SWEEPS sweeps over the
fresh net; one of delete or explode is the whole scenario on a fresh net (arrays copied back; V4: built anew), explode
after delete; one of replace deletes and inserts again REPLACED tetras chosen at random, also on a fresh net; one of
locate finds the scenario's points, one in each tetra, in random order. The interval holds the median ratio with at
least 95 % (order statistics, sign test); the bar is met where its upper end is. A first pair warms up, is not counted,
and must leave the same bits behind, or the same answers.

The three outside rows have no C beside them, but ours itself: as many points outside the net (near its surface, far
away, in holes that deleted tetras left) beside points inside it, the grid that outside points ask built each time.
"""

import argparse
import ctypes
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from replace import replace
from yardstick import BY_NAME, EDITABLE, build, c_net, content, copy_arrays, is_linked

from tetrabench.bench.pairs import FEWEST, in_turn, paired_ratio
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.scenarios.tetra.alfa import average
from tetrabench.scenarios.tetra.delete import delete_from_end
from tetrabench.scenarios.tetra.flow import diffuse
from tetrabench.scenarios.tetra.locate import points_near_sides
from tetrabench.tetra.edit import reserve
from tetrabench.tetra.interface import NONE, STATES, Net, delete_tetra, split_many, tetra_refs
from tetrabench.tetra.locate import locate
from tetrabench.tetra.net import TetraNet

BARS = {
    "alfa": 1.10,
    "flow": 1.10,
    "delete": 1.30,
    "explode": 1.30,
    "replace": 3.00,
    "locate": 1.30,
    "outside": 5.00,
    "far": 5.00,
    "hole": 5.00,
}
SWEEPS, DELETED, SPLIT, REPLACED = 5, 20_000, 50_000, 50_000
STEP = 1e-3  # of flow; any will do
HOLES = 0.05  # of the tetras

Sample = dict[str, float]  # operation -> seconds of thread CPU time
Pairs = list[tuple[Sample, Sample]]  # ours, C


def clock(call: Callable[..., Any], *arguments: Any) -> float:
    """Thread CPU time of one call, in seconds."""
    begin = time.thread_time()
    call(*arguments)
    return time.thread_time() - begin


# ---- one sample of each kind


def sweeps_of_ours(net: Net) -> Sample:
    return {"alfa": clock(average, net, SWEEPS), "flow": clock(diffuse, net, SWEEPS, STEP)}


def sweeps_of_c(yardstick: ctypes.CDLL, net: Net) -> Sample:
    twin = ctypes.byref(c_net(net))
    return {"alfa": clock(yardstick.alfa, twin, SWEEPS), "flow": clock(yardstick.flow, twin, SWEEPS, STEP)}


def edits_of_ours(net: Net, deleted: int, split: int) -> Sample:
    delete = clock(delete_from_end, net, deleted)
    return {"delete": delete, "explode": clock(split_many, net, tetra_refs(net)[:split])}


def edits_of_c(yardstick: ctypes.CDLL, net: Net, deleted: int, split: int) -> Sample:
    twin = ctypes.byref(c_net(net))
    delete = clock(yardstick.delete_from_end, twin, deleted)
    refs = tetra_refs(net)[:split]
    return {"delete": delete, "explode": clock(yardstick.explode, twin, refs.ctypes.data, split)}


def replace_of_ours(net: Net, count: int) -> Sample:
    return {"replace": clock(replace, net, some_refs(net, count))}


def replace_of_c(yardstick: ctypes.CDLL, net: Net, count: int) -> Sample:
    twin, refs = ctypes.byref(c_net(net)), some_refs(net, count)
    return {"replace": clock(yardstick.replace, twin, refs.ctypes.data, count)}


def some_refs(net: Net, count: int) -> np.ndarray:
    """Refs of so many tetras, at random, the same each time."""
    return np.random.default_rng(0).permutation(tetra_refs(net))[:count].copy()


def locate_of_ours(net: Net, points: np.ndarray, found: np.ndarray) -> Sample:
    def ask() -> None:
        found[:] = locate(net, points)[0]

    return {"locate": clock(ask)}


def locate_of_c(yardstick: ctypes.CDLL, net: Net, points: np.ndarray, found: np.ndarray) -> Sample:
    twin = ctypes.byref(c_net(net))
    return {"locate": clock(yardstick.locate, twin, points.ctypes.data, len(points), found.ctypes.data)}


# ---- in turn


def measure_sweeps(name: str, mesh: TetraMesh, yardstick: ctypes.CDLL, turns: int) -> Pairs:
    net = TetraNet(mesh, BY_NAME[name])
    sides = [sweeps_of_ours, partial(sweeps_of_c, yardstick)]
    left_behind = []
    for side in sides:
        net.states = initial_states(mesh)
        side(net.storage)
        left_behind.append(content(net.storage))
    assert left_behind[0] == left_behind[1], f"{name}: sweeps of ours and of C differ"
    pairs = list(in_turn(turns, *(partial(side, net.storage) for side in sides)))
    net.close()
    return pairs


def measure_edits(name: str, mesh: TetraMesh, yardstick: ctypes.CDLL, turns: int) -> Pairs:
    deleted = min(DELETED, len(mesh.tets) // 2)
    split = min(SPLIT, (len(mesh.tets) - deleted) // 2)
    ours = partial(edits_of_ours, deleted=deleted, split=split)
    return measure_on_fresh_nets(name, mesh, turns, ours, partial(edits_of_c, yardstick, deleted=deleted, split=split))


def measure_replace(name: str, mesh: TetraMesh, yardstick: ctypes.CDLL, turns: int) -> Pairs:
    count = min(REPLACED, len(mesh.tets))
    ours, c = partial(replace_of_ours, count=count), partial(replace_of_c, yardstick, count=count)
    return measure_on_fresh_nets(name, mesh, turns, ours, c)


def measure_on_fresh_nets(name: str, mesh: TetraMesh, turns: int, *sides: Callable[[Net], Sample]) -> Pairs:
    """Each sample begins with the same net, which has room for SPLIT splits."""

    def fresh() -> TetraNet:
        net = TetraNet(mesh, BY_NAME[name])
        net.storage = reserve(net.storage, 3 * SPLIT + 1, SPLIT)
        return net

    pristine, work = fresh(), fresh()
    left_behind = []

    def sample(side: Callable[[Net], Sample], keep: bool = False) -> Sample:
        if is_linked(work.storage):
            net = fresh()
        else:
            net = work
            copy_arrays(pristine.storage, work.storage)
        seconds = side(net.storage)
        if keep:
            left_behind.append(content(net.storage))
        return seconds

    for side in sides:
        sample(side, keep=True)
    assert left_behind[0] == left_behind[1], f"{name}: edits of ours and of C differ"
    left_behind.clear()
    return list(in_turn(turns, *(partial(sample, side) for side in sides)))


def measure_locate(name: str, mesh: TetraMesh, yardstick: ctypes.CDLL, turns: int) -> Pairs:
    net = TetraNet(mesh, BY_NAME[name])
    refs = np.random.default_rng(0).permutation(net.refs)
    points, found = points_near_sides(net.storage, refs), np.empty(len(refs), np.int64)
    ours, c = (partial(side, net.storage, points, found) for side in (locate_of_ours, partial(locate_of_c, yardstick)))
    for side in (ours, c):
        found[:] = NONE
        side()
        assert np.array_equal(found, refs), f"{name}: not all points were found in their tetra"
    pairs = list(in_turn(turns, ours, c))
    net.close()
    return pairs


def measure_outside(name: str, mesh: TetraMesh, _yardstick: ctypes.CDLL, turns: int) -> Pairs:
    net = TetraNet(mesh, BY_NAME[name])
    rng = np.random.default_rng(0)
    refs = rng.permutation(net.refs)
    inside, found = points_near_sides(net.storage, refs), np.empty(len(refs), np.int64)
    outside = {"outside": points_off_surface(net, rng), "far": inside + 100.0 * np.ptp(inside, axis=0)}
    gone = rng.permutation(len(refs))[: int(HOLES * len(refs))]
    outside["hole"] = inside[rng.choice(gone, len(refs))]

    def sample(points: dict[str, np.ndarray]) -> Sample:
        return {kind: locate_of_ours(net.storage, some, found)["locate"] for kind, some in points.items()}

    pairs: Pairs = [({}, {}) for _ in range(turns)]
    for kind, points in outside.items():
        if kind == "hole":
            for t in refs[gone]:
                delete_tetra(net.storage, t)
            inside = inside[np.setdiff1d(np.arange(len(refs)), gone)[rng.integers(0, len(refs) - len(gone), len(refs))]]
        sides = partial(sample, {kind: points}), partial(sample, {kind: inside})
        sides[1]()
        assert (found != NONE).all(), f"{name}: a point inside was not found"
        sides[0]()
        assert (found == NONE).all(), f"{name}: a point outside was found"
        for pair, (one, other) in zip(pairs, in_turn(turns, *sides), strict=True):
            pair[0].update(one)
            pair[1].update(other)
    net.close()
    return pairs


def points_off_surface(net: TetraNet, rng: np.random.Generator) -> np.ndarray:
    """As many points as tetras, each a little way off a side at the surface: up to the size of the side."""
    refs, sides = np.nonzero(net.neighbours == NONE)
    pick = rng.integers(0, len(refs), len(net))
    refs, sides = refs[pick], sides[pick]
    corners = net.points[net.vertices[refs[:, None], (sides[:, None] + [1, 2, 3]) % 4]]
    on_side = np.einsum("nc,nck->nk", rng.dirichlet(np.ones(3), len(pick)), corners)
    off = rng.uniform(1e-6, 1.0, len(pick)) * np.sqrt(net.side_areas[refs, sides])
    return on_side + off[:, None] * net.side_normals[refs, sides]


MEASURES = {
    measure_sweeps: {"alfa", "flow"},
    measure_edits: {"delete", "explode"},
    measure_replace: {"replace"},
    measure_locate: {"locate"},
    measure_outside: {"outside", "far", "hole"},
}


def initial_states(mesh: TetraMesh) -> np.ndarray:
    """(n, 5) float64, any smooth function of the centroids."""
    states = np.zeros((len(mesh.tets), STATES))
    states[:, 0] = np.sin(mesh.points[mesh.tets].mean(axis=1) @ [3.0, 2.0, 1.7])
    return states


# ---- the table


def rows(name: str, pairs: Pairs) -> Iterator[dict[str, Any]]:
    for operation in pairs[0][0]:
        ours, c = ([pair[side][operation] for pair in pairs] for side in (0, 1))
        ratio, low, high = paired_ratio(ours, c)
        yield {
            "contestant": name,
            "operation": operation,
            "ours_s": float(np.median(ours)),
            "c_s": float(np.median(c)),
            "ratio": ratio,
            "low": low,
            "high": high,
            "bar": BARS[operation],
            "met": high <= BARS[operation],
            "turns": len(pairs),
        }


def _print(row: dict[str, Any]) -> None:
    per = SWEEPS if row["operation"] in ("alfa", "flow") else 1
    ours, c = 1e3 * row["ours_s"] / per, 1e3 * row["c_s"] / per
    print(
        f"{row['contestant']:<11}{row['operation']:<9}{ours:10.2f}{c:10.2f}{row['ratio']:8.3f}"
        f"  [{row['low']:.3f}, {row['high']:.3f}]{row['bar']:7.2f}  {'met' if row['met'] else 'MISSED'}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tets", type=int, default=642_700)
    parser.add_argument("--numbering", choices=["natural", "shuffled"], default="natural")
    parser.add_argument("--turns", type=int, default=21, help=f"at least {FEWEST}")
    parser.add_argument("--only", default="", help="contestants and operations, comma separated")
    parser.add_argument("-o", "--output", type=Path, help="a JSON file")
    options = parser.parse_args()
    only = set(filter(None, options.only.split(",")))
    if strange := only - {*BY_NAME, *BARS}:
        parser.error(f"--only takes {', '.join([*BY_NAME, *BARS])}; not {', '.join(sorted(strange))}")
    if options.turns < FEWEST:
        parser.error(f"--turns takes a number from {FEWEST}: an interval needs so many")
    contestants = [name for name in BY_NAME if name in only or not only & set(BY_NAME)]
    operations = [name for name in BARS if name in only or not only & set(BARS)]
    mesh = generate("nozzle", options.tets, numbering=options.numbering)
    print(f"{len(mesh.tets)} tets, {options.numbering} numbering, {options.turns} turns; ms a sweep or scenario")
    print(f"{'contestant':<11}{'':<9}{'ours':>10}{'C':>10}{'ratio':>8}  {'95 %':<14}{'bar':>7}")
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for name in contestants:
            yardstick = build(name, Path(folder))
            for measure, some in MEASURES.items():
                if some & set(operations) and (name in EDITABLE or measure not in (measure_edits, measure_replace)):
                    for row in rows(name, measure(name, mesh, yardstick, options.turns)):
                        if row["operation"] in operations:
                            _print(row)
                            table.append(row)
    if options.output:
        options.output.write_text(json.dumps({**vars(options), "tets": len(mesh.tets), "rows": table}, default=str))


if __name__ == "__main__":
    main()
