"""hotcold: a record of what sweeps use, and a record of the rest; free slots as V3Y finds them."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.slots.flag_list import make_flag_list
from tetrabench.jit import implements
from tetrabench.tetra import interface
from tetrabench.tetra.build import build_net
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.points import grown

HOT = np.dtype(
    [
        ("neighbour", np.int32, 4),
        ("volume", np.float64),
        ("side_area", np.float64, 4),
        ("state", np.float64, interface.STATES),
    ],
    align=True,
)
"""What sweeps over states and neighbours use: 96 bytes."""

COLD = np.dtype(
    [("vertex", np.int32, 4), ("centroid", np.float64, 3), ("side_normal", np.float64, (4, 3))],
    align=True,
)
"""The rest: 136 bytes."""


class HotCold(NamedTuple):
    """All slots, each in two records.

    Attributes:
        hot: (capacity,) HOT.
        cold: (capacity,) COLD.
    """

    hot: NDArray[np.void]
    cold: NDArray[np.void]


def make_hot_cold(capacity: int) -> HotCold:
    """Records for `capacity` slots."""
    return HotCold(np.empty(capacity, HOT), np.empty(capacity, COLD))


@implements(interface.grown_layout, HotCold)
def grown_layout(net, capacity):
    return HotCold(grown(net.layout.hot, capacity), grown(net.layout.cold, capacity))


@implements(interface.capacity, HotCold)
def capacity(net):
    return len(net.layout.hot)


@implements(interface.vertex, HotCold)
def vertex(net, t, i):
    return np.int64(net.layout.cold[t]["vertex"][i])


@implements(interface.set_vertex, HotCold)
def set_vertex(net, t, i, point):
    net.layout.cold[t]["vertex"][i] = point


@implements(interface.neighbour, HotCold)
def neighbour(net, t, i):
    return np.int64(net.layout.hot[t]["neighbour"][i])


@implements(interface.set_neighbour, HotCold)
def set_neighbour(net, t, i, other):
    net.layout.hot[t]["neighbour"][i] = other


@implements(interface.volume, HotCold)
def volume(net, t):
    return net.layout.hot[t]["volume"]


@implements(interface.set_volume, HotCold)
def set_volume(net, t, value):
    net.layout.hot[t]["volume"] = value


@implements(interface.centroid, HotCold)
def centroid(net, t, k):
    return net.layout.cold[t]["centroid"][k]


@implements(interface.set_centroid, HotCold)
def set_centroid(net, t, k, value):
    net.layout.cold[t]["centroid"][k] = value


@implements(interface.side_area, HotCold)
def side_area(net, t, i):
    return net.layout.hot[t]["side_area"][i]


@implements(interface.set_side_area, HotCold)
def set_side_area(net, t, i, value):
    net.layout.hot[t]["side_area"][i] = value


@implements(interface.side_normal, HotCold)
def side_normal(net, t, i, k):
    return net.layout.cold[t]["side_normal"][i, k]


@implements(interface.set_side_normal, HotCold)
def set_side_normal(net, t, i, k, value):
    net.layout.cold[t]["side_normal"][i, k] = value


@implements(interface.state, HotCold)
def state(net, t, k):
    return net.layout.hot[t]["state"][k]


@implements(interface.set_state, HotCold)
def set_state(net, t, k, value):
    net.layout.hot[t]["state"][k] = value


CONTESTANTS = [
    TetraContestant(
        name="hotcold",
        title="hot and cold records, flag + list",
        trade_off="a sweep finds what it uses together, and nothing else; everything else is a second access",
        build=partial(build_net, make_layout=make_hot_cold, make_slots=make_flag_list),
        layout="hot and cold records",
        slots="flag + list",
        source="an example of tetrabench's documentation",
        extension=True,
    )
]
