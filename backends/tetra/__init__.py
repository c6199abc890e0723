"""The contestants: seven layouts of a net, three places for the fields times ways to keep the holes, and a half-face kernel.

|                                    | sorted list of holes | flag + scan | flag + list | no holes | flags, collected |
|------------------------------------|----------------------|-------------|-------------|----------|------------------|
| property arrays                    | v3                   | v3x         | v3y         |          |                  |
| array of records                   | v5                   | v5x         | v5y         |          |                  |
| linked nodes (a heap node a tetra) |                      |             |             | v4       |                  |
| half-faces and attributes          |                      |             |             |          | halfface         |

The seven keep lists of the tetras around each point; half-faces need none: see `halfface`, which has its own thesis.
"The thesis", here and in scenarios/, is József Martin, Nagyméretű tetraéderhálózatok hatékony kezelési módszereinek vizsgálata
(Handling large tetrahedral meshes efficiently: a study of methods), Széchenyi István University, Győr 2011; this is its 4.4.
"""

from functools import partial

import numpy as np

from tetrabench.backends.tetra.halfface.topology import make_halfface_net
from tetrabench.backends.tetra.layouts.linked_nodes import make_linked_nodes
from tetrabench.backends.tetra.layouts.property_arrays import make_property_arrays
from tetrabench.backends.tetra.layouts.records import make_records
from tetrabench.backends.tetra.slots.chain import make_chain
from tetrabench.backends.tetra.slots.flag_list import make_flag_list
from tetrabench.backends.tetra.slots.flag_scan import make_flag_scan
from tetrabench.backends.tetra.slots.sorted_list import make_sorted_list
from tetrabench.tetra.build import build_net
from tetrabench.tetra.contestant import TetraContestant

SOURCE = "J. Martin, thesis, Győr 2011, section 4.4"

LAYOUTS = [
    ("v3", "property arrays", "a sweep reads only the fields it uses", make_property_arrays),
    (
        "v5",
        "array of records",
        "all of a tetra lies together, so a sweep reads what it does not use",
        make_records,
    ),
]

SLOT_POLICIES = [
    ("", "sorted list of holes", "nothing but the list to look at; delete walks it", make_sorted_list),
    ("x", "flag + scan", "no list at all; insert scans for the next hole", make_flag_scan),
    ("y", "flag + list", "insert and delete at once; the list takes room", make_flag_list),
]

V4 = TetraContestant(
    name="v4",
    title="linked nodes, no holes",
    trade_off="insert and delete anywhere, refs are pointers; a sweep waits for memory at every step",
    build=partial(build_net, make_layout=make_linked_nodes, make_slots=make_chain, ref_dtype=np.int64),
    layout="linked nodes",
    slots="no holes",
    source=SOURCE,
)

HALFFACE = TetraContestant(
    name="halfface",
    title="half-faces and attributes, deletions collected",
    trade_off="least memory, local queries without lists; refs change when deleted tetras are collected",
    build=make_halfface_net,
    layout="half-faces and attributes",
    slots="flags, collected",
    source="D. Hromádka, thesis, Brno 2013, chapter 5",
    stable_refs=False,
)

PRODUCT = [
    TetraContestant(
        name=layout + suffix,
        title=f"{place}, {policy}",
        trade_off=f"{gain}; {price}",
        build=partial(build_net, make_layout=make_layout, make_slots=make_slots),
        layout=place,
        slots=policy,
        source=SOURCE,
    )
    for layout, place, gain, make_layout in LAYOUTS
    for suffix, policy, price, make_slots in SLOT_POLICIES
]

CONTESTANTS = [*sorted([*PRODUCT, V4], key=lambda contestant: contestant.name), HALFFACE]
