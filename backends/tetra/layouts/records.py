"""Array of records (V5, V5X, V5Y): one 232-byte struct per slot. Source: thesis, 4.4.5.

Refs index as unsigned numbers: with signed ones numba looks at every access whether to count from the end.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.points import grown

RECORD = np.dtype(
    [
        ("vertex", np.int32, 4),
        ("neighbour", np.int32, 4),
        ("volume", np.float64),
        ("centroid", np.float64, 3),
        ("side_area", np.float64, 4),
        ("side_normal", np.float64, (4, 3)),
        ("state", np.float64, interface.STATES),
    ],
    align=True,
)
"""All fields of one tetra, as a C struct: 232 bytes."""


class Records(NamedTuple):
    """The slots, each a record of all fields.

    Attributes:
        records: (capacity,) RECORD.
    """

    records: NDArray[np.void]


def make_records(capacity: int) -> Records:
    """Records for `capacity` slots."""
    return Records(np.empty(capacity, RECORD))


@implements(interface.grown_layout, Records)
def grown_layout(net, capacity):
    return Records(grown(net.layout.records, capacity))


@implements(interface.columns, Records)
def columns(net):
    return {name: net.layout.records[name] for name in RECORD.names}


@implements(interface.capacity, Records)
def capacity(net):
    return len(net.layout.records)


@implements(interface.vertex, Records)
def vertex(net, t, i):
    return np.int64(net.layout.records[np.uint64(t)]["vertex"][i])


@implements(interface.set_vertex, Records)
def set_vertex(net, t, i, point):
    net.layout.records[np.uint64(t)]["vertex"][i] = point


@implements(interface.neighbour, Records)
def neighbour(net, t, i):
    return np.int64(net.layout.records[np.uint64(t)]["neighbour"][i])


@implements(interface.set_neighbour, Records)
def set_neighbour(net, t, i, other):
    net.layout.records[np.uint64(t)]["neighbour"][i] = other


@implements(interface.volume, Records)
def volume(net, t):
    return net.layout.records[np.uint64(t)]["volume"]


@implements(interface.set_volume, Records)
def set_volume(net, t, value):
    net.layout.records[np.uint64(t)]["volume"] = value


@implements(interface.centroid, Records)
def centroid(net, t, k):
    return net.layout.records[np.uint64(t)]["centroid"][k]


@implements(interface.set_centroid, Records)
def set_centroid(net, t, k, value):
    net.layout.records[np.uint64(t)]["centroid"][k] = value


@implements(interface.side_area, Records)
def side_area(net, t, i):
    return net.layout.records[np.uint64(t)]["side_area"][i]


@implements(interface.set_side_area, Records)
def set_side_area(net, t, i, value):
    net.layout.records[np.uint64(t)]["side_area"][i] = value


@implements(interface.side_normal, Records)
def side_normal(net, t, i, k):
    return net.layout.records[np.uint64(t)]["side_normal"][i, k]


@implements(interface.set_side_normal, Records)
def set_side_normal(net, t, i, k, value):
    net.layout.records[np.uint64(t)]["side_normal"][i, k] = value


@implements(interface.state, Records)
def state(net, t, k):
    return net.layout.records[np.uint64(t)]["state"][k]


@implements(interface.set_state, Records)
def set_state(net, t, k, value):
    net.layout.records[np.uint64(t)]["state"][k] = value
