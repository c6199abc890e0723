"""Formats of a mesh of polygons, one file each, on two axes: which element carries the adjacency, and which lists are kept.

| main element      | the others know one      | cells list their edges   | and nodes theirs    | everything is listed |
|-------------------|--------------------------|--------------------------|---------------------|----------------------|
| node              | by-node                  |                          |                     |                      |
| cell              | by-cell                  |                          |                     |                      |
| edge              | by-edge                  | edge-cell                | edge-cell-node      |                      |
| side of an edge   | half-edge*               |                          |                     |                      |
| none              |                          |                          |                     | tables*              |

* ours, beyond the source. So is `faces`: edge-cell in space, for polyhedra, which takes no part.

N cells, K edges, L nodes; i nodes a cell, k edges a node.
"""

from tetrabench.backends.polygon.by_cell import make_by_cell
from tetrabench.backends.polygon.by_edge import make_by_edge
from tetrabench.backends.polygon.by_node import make_by_node
from tetrabench.backends.polygon.edge_cell import make_edge_cell
from tetrabench.backends.polygon.edge_cell_node import make_edge_cell_node
from tetrabench.backends.polygon.half_edge import make_half_edge
from tetrabench.backends.polygon.tables import make_tables
from tetrabench.polygon.contestant import PolygonContestant

_SAROV = "A. A. Voropinov, Some data formats for two-dimensional unstructured meshes of any kind, Sarov, about 2008"

FORMATS = {
    contestant.name: contestant
    for contestant in (
        PolygonContestant(
            name="by-node",
            title="a node lists its neighbours and its cells",
            trade_off="lists around nodes lie ready; those of cells are searched for, node by node",
            build=make_by_node,
            main_element="node",
            values="N + (2k + 2) L",
            source=_SAROV,
        ),
        PolygonContestant(
            name="by-edge",
            title="an edge knows two nodes, two cells and two edges",
            trade_off="every query is a walk of the same length and nothing is searched for; no list lies ready",
            build=make_by_edge,
            main_element="edge",
            values="N + 6K + L",
            source=_SAROV,
        ),
        PolygonContestant(
            name="by-cell",
            title="a cell lists its nodes and its neighbours",
            trade_off="lists of cells lie ready; those around nodes are searched for, cell by cell",
            build=make_by_cell,
            main_element="cell",
            values="(2i + 2) N + L",
            source=_SAROV,
        ),
        PolygonContestant(
            name="edge-cell",
            title="a cell lists its edges, an edge knows two nodes and two cells",
            trade_off="carries over to polyhedra, with faces for edges; around nodes it searches",
            build=make_edge_cell,
            main_element="edge",
            values="(i + 2) N + 4K + L",
            source=_SAROV,
        ),
        PolygonContestant(
            name="edge-cell-node",
            title="cells and nodes list their edges, an edge knows two nodes and two cells",
            trade_off="one step to everything, at the most memory of the source's formats",
            build=make_edge_cell_node,
            main_element="edge",
            values="(i + 2) N + 4K + (k + 2) L",
            source=_SAROV,
        ),
        PolygonContestant(
            name="half-edge",
            title="each side of an edge knows its end, the sides before and after, and its cell",
            trade_off="the usual choice of mesh libraries: walks without a question, two records an edge",
            build=make_half_edge,
            main_element="side of an edge",
            values="N + 8K + L",
            source="Campagna, Kobbelt, Seidel, Directed edges, 1998",
            extension=True,
        ),
        PolygonContestant(
            name="tables",
            title="all four lists as they are asked for",
            trade_off="the speed limit: every answer is copied; cannot be changed without making it anew",
            build=make_tables,
            values="(2i + 1) N + (2k + 1) L + 2",
            extension=True,
        ),
    )
}

CONTESTANTS = list(FORMATS.values())
