"""How fast our kernels are beside C: both in turn on the same memory, thread CPU time, medians of paired ratios.

    python tests/native/bench_native.py [--tets N] [--numbering natural] [--turns 21] [--only v4,alfa] [--json FILE]

A turn is one sample of ours and one of C, the order alternating. A sample of alfa or flow is SWEEPS sweeps over the
fresh net; one of delete or explode is the whole scenario on a fresh net (arrays copied back; V4: built anew), explode
after delete. The interval holds the median ratio with at least 95 % (order statistics, sign test); the bar is met
where its upper end is. A first pair warms up, is not counted, and must leave the same bits behind.
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
from yardstick import BY_NAME, EDITABLE, build, c_net, content, copy_arrays, is_linked

from tetrabench.bench.pairs import in_turn, paired_ratio
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.scenarios.tetra.alfa import average
from tetrabench.scenarios.tetra.delete import delete_from_end
from tetrabench.scenarios.tetra.flow import diffuse
from tetrabench.tetra.edit import reserve, split_many
from tetrabench.tetra.interface import STATES, Net, tetra_refs
from tetrabench.tetra.net import TetraNet

BARS = {"alfa": 1.10, "flow": 1.10, "delete": 1.30, "explode": 1.30}
SWEEPS, DELETED, SPLIT = 5, 20_000, 50_000
STEP = 1e-3  # of flow; any will do

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

    def fresh() -> TetraNet:
        net = TetraNet(mesh, BY_NAME[name])
        net.storage = reserve(net.storage, 3 * split + 1, split)
        return net

    pristine, work = fresh(), fresh()
    left_behind = []

    def sample(side: Callable[[Net, int, int], Sample], keep: bool = False) -> Sample:
        if is_linked(work.storage):
            net = fresh()
        else:
            net = work
            copy_arrays(pristine.storage, work.storage)
        seconds = side(net.storage, deleted, split)
        if keep:
            left_behind.append(content(net.storage))
        return seconds

    sides = [edits_of_ours, partial(edits_of_c, yardstick)]
    for side in sides:
        sample(side, keep=True)
    assert left_behind[0] == left_behind[1], f"{name}: edits of ours and of C differ"
    left_behind.clear()
    return list(in_turn(turns, *(partial(sample, side) for side in sides)))


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
    parser.add_argument("--turns", type=int, default=21, help="at least 6")
    parser.add_argument("--only", default="", help="contestants and operations, comma separated")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    only = set(filter(None, options.only.split(",")))
    contestants = [name for name in BY_NAME if name in only or not only & set(BY_NAME)]
    operations = [name for name in BARS if name in only or not only & set(BARS)]
    mesh = generate("nozzle", options.tets, numbering=options.numbering)
    print(f"{len(mesh.tets)} tets, {options.numbering} numbering, {options.turns} turns; ms a sweep or scenario")
    print(f"{'contestant':<11}{'':<9}{'ours':>10}{'C':>10}{'ratio':>8}  {'95 %':<14}{'bar':>7}")
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for name in contestants:
            yardstick = build(name, Path(folder))
            for measure, some in ((measure_sweeps, {"alfa", "flow"}), (measure_edits, {"delete", "explode"})):
                if some & set(operations) and (measure is measure_sweeps or name in EDITABLE):
                    for row in rows(name, measure(name, mesh, yardstick, options.turns)):
                        if row["operation"] in operations:
                            _print(row)
                            table.append(row)
    if options.json:
        options.json.write_text(json.dumps({"tets": len(mesh.tets), **vars(options), "rows": table}, default=str))


if __name__ == "__main__":
    main()
