"""The rows: which format beside which peer, with the bar where there is one; how their answers are compared."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.contest import Contest, Row
from tests.polygon_peers.library import Peer
from tetrabench.backends.polygon import FORMATS
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import connect
from tetrabench.polygon.digest import sum_of_lists
from tetrabench.polygon.net import PolygonNet
from tetrabench.polygon.queries import QUERIES, Query

PICKS = 1_000_000
BUILD_BAR = 1.2
"""Of each format, beside CGAL."""
BARS = {
    "cell-nodes": (1.6, 2.0),
    "cell-neighbours": (1.8, 2.2),
    "node-cells": (1.8, 2.2),
    "node-neighbours": (1.8, 2.2),
}
"""Of the best format, beside plain tables in C: all in order, some at random."""
BEST = {"cell-nodes": "by-cell", "cell-neighbours": "by-cell", "node-cells": "by-node", "node-neighbours": "by-node"}
"""Which of the source's formats has the list of a query ready, and is held against the bar; so are our tables."""
STEADY = 1.25
"""What a peer may take longer for the same beside one format than beside another."""


@dataclass
class Case:
    """A mesh in a format, and what is asked of it."""

    mesh: PolygonMesh
    name: str

    def __post_init__(self) -> None:
        self.net = PolygonNet(self.mesh, FORMATS[self.name])
        self.out = np.zeros(self.net.room, np.int32)

    def picks(self, query: Query) -> NDArray[np.int32]:
        """Elements at random, (PICKS,) int32."""
        elements = query.elements(self.net.storage)
        return np.random.default_rng(1).choice(elements, PICKS)


def in_order(query: Query, case: Case, peer: Peer) -> Contest:
    """All elements in order."""
    return Contest(
        ours=lambda: query.sweep(case.net.storage, case.out),
        theirs=lambda: peer.sweep(query, case.out),
        differ=partial(differ, query, case, peer),
    )


def at_random(query: Query, case: Case, peer: Peer) -> Contest:
    """A million at random."""
    picks = case.picks(query)
    return Contest(
        ours=lambda: query.sample(case.net.storage, picks, case.out),
        theirs=lambda: peer.sample(query, picks, case.out),
        differ=partial(differ, query, case, peer),
    )


def differ(query: Query, case: Case, peer: Peer, ours: int, theirs: int) -> str:
    """In what the answers differ: sums, then all lists as circles without boundary conditions."""
    if ours != theirs:
        return f"the sums are {ours} and {theirs}"
    elements = query.elements(case.net.storage)
    both = [case.net.lists(query.name), peer.lists(query, len(elements), case.net.room)]
    mixes = [sum_of_lists(elements, starts, items, drops=True) for starts, items in both]
    return "" if mixes[0] == mixes[1] else "the lists are others"


def building(case: Case, peer: Peer) -> Contest:
    """From the cells' nodes to the format; connections included."""
    built: list[Any] = []

    def theirs() -> None:
        built.append(peer.build())

    def tidy() -> None:
        while built:
            peer.drop(built.pop())

    return Contest(
        ours=lambda: FORMATS[case.name].build(connect(case.mesh)), theirs=theirs, differ=lambda *_: "", tidy=tidy
    )


def one_table(case: Case, xugrid: Any) -> Contest:
    """All four tables of ours; the neighbours of cells alone of xugrid's."""
    mesh, width = case.mesh, int(np.diff(case.mesh.starts).max())
    table = np.full((mesh.number_of_cells, width), -1, np.int64)
    for place in range(width):
        has = np.diff(mesh.starts) > place
        table[has, place] = mesh.nodes[mesh.starts[:-1][has] + place]

    def theirs() -> Any:
        return xugrid.Ugrid2d(mesh.points[:, 0], mesh.points[:, 1], -1, table).face_face_connectivity

    def differences(ours: Any, found: Any) -> str:
        _, items = case.net.lists("cell-neighbours")
        return "" if found.nnz == np.count_nonzero(items >= 0) else "xugrid has another number of neighbours"

    return Contest(ours=lambda: FORMATS[case.name].build(connect(mesh)), theirs=theirs, differ=differences)


def _query_rows() -> list[Row]:
    rows = []
    ways: list[tuple[str, Callable[..., Contest]]] = [("", in_order), ("random ", at_random)]
    for name, query in QUERIES.items():
        for (prefix, way), bar in zip(ways, BARS[name], strict=True):
            contest = partial(way, query)
            for form in FORMATS:
                rows.append(Row(prefix + name, form, "c", bar if form in (BEST[name], "tables") else None, contest))
            for peer, ahead in (("cgal", 1.0), ("openmesh", None)):
                rows += [Row(prefix + name, form, peer, ahead, contest) for form in (BEST[name], "tables")]
    return rows


ROWS = [
    *_query_rows(),
    *(Row("build", form, "cgal", BUILD_BAR, building) for form in FORMATS),
    *(Row("build", form, peer, None, building) for form in ("by-edge", "tables") for peer in ("c", "openmesh")),
    Row("build", "tables", "xugrid", None, one_table),
]


def elements_of(operation: str, mesh: PolygonMesh) -> int:
    """How many cells or nodes an operation is about: what its time is divided by."""
    if operation == "build":
        return mesh.number_of_cells
    if operation.startswith("random "):
        return PICKS
    return len(mesh.points) if QUERIES[operation].of_nodes else mesh.number_of_cells


def bars_of(results: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Each bar among these rows, and which of the formats that are held against it stay under it.

    The bar of a query is reached where one format does, for it is the best one's; that of building where all do. Whoever
    answers wrong, or had help from other threads, does not.
    """
    bars: dict[tuple[str, str], dict[str, Any]] = {}
    for row in results:
        if row["bar"] is not None:
            head = {name: row[name] for name in ("operation", "peer", "bar")}
            bar = bars.setdefault((row["operation"], row["peer"]), head | {"formats": {}})
            bar["formats"][row["numbering"]] = bool(row.get("met") and row["one_thread"])
    for bar in bars.values():
        bar["reached"] = (all if bar["operation"] == "build" else any)(bar["formats"].values())
    return list(bars.values())


def unsteady(results: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Operations that took a peer longer beside one format than beside another, though it did the same: [low_s, high_s].

    Somebody else was at work on the machine, and slowed one side of a ratio more than the other: the pairs do not help.
    """
    times: dict[tuple[str, str], list[float]] = {}
    for row in results:
        if "peer_s" in row:
            times.setdefault((row["operation"], row["peer"]), []).append(row["peer_s"])
    return [
        {"operation": operation, "peer": peer, "low_s": min(found), "high_s": max(found)}
        for (operation, peer), found in times.items()
        if max(found) > STEADY * min(found)
    ]
