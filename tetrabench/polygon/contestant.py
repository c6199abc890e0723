"""What the polygon family knows of a contestant."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tetrabench.mesh.polygon.connect import Connections
from tetrabench.polygon.interface import Storage
from tetrabench.protocols import Option


@dataclass(frozen=True)
class PolygonContestant:
    """A way to store a mesh of polygons.

    Attributes:
        name: what people type, such as `by-edge`.
        title: which element carries the adjacency, in words.
        trade_off: one line: what it is good at, and what it pays for that.
        build: connections of a mesh -> storage.
        main_element: cell, edge or node: the element that carries the full adjacency.
        values: formula of the int32 values that it takes: N cells, K edges, L nodes, i nodes a cell, k edges a node.
        source: where it was described first.
        extension: whether it is ours rather than the source's; tables mark it.
        family: the family that it belongs to.
        options, is_exact: see protocols.Contestant.
    """

    name: str
    title: str
    trade_off: str
    build: Callable[[Connections], Storage]
    main_element: str = ""
    values: str = ""
    source: str = ""
    extension: bool = False
    family: str = "polygon"
    options: Mapping[str, Option] = field(default_factory=dict)
    is_exact: bool = True
