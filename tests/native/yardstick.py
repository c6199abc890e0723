"""The C yardsticks: build them, run them on the memory of a net, and compare what both leave behind.

One shared library for each contestant, from the same source (`net.h`, `nearest.h`, `sweeps.c`, `edits.c`); C sees
the arrays of the net where they are, V4's nodes included.
"""

import ctypes
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.recfunctions import repack_fields

from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.backends.tetra.layouts.linked_nodes import NODE, LinkedNodes
from tetrabench.tetra.incidence import END as END_OF_LIST
from tetrabench.tetra.interface import NONE, Net, capacity, tetra_refs
from tetrabench.tetra.points import COUNT

BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS}

MACROS = {
    "v3": ("ARRAYS", "SORTED_LIST"),
    "v3x": ("ARRAYS", "FLAGS"),
    "v3y": ("ARRAYS", "FLAGS_AND_LIST"),
    "v4": ("NODES", "CHAIN"),
    "v5": ("RECORDS", "SORTED_LIST"),
    "v5x": ("RECORDS", "FLAGS"),
    "v5y": ("RECORDS", "FLAGS_AND_LIST"),
}
"""Where the fields live, and how an iteration finds the live tetras."""

EDITABLE = ("v3y", "v4", "v5y")
"""The contestants whose delete and explode have a yardstick."""

COMPILER = [
    "gcc",
    "-O3",
    "-march=native",
    "-std=c11",
    "-shared",
    "-fPIC",
]  # -std=c11: no fused multiply-add, as ours

_C_TYPES = {int: ctypes.c_int64, float: ctypes.c_double, ctypes.c_void_p: ctypes.c_void_p}


def build(name: str, folder: Path) -> ctypes.CDLL:
    """The yardstick of a contestant: its `alfa`, `flow`, `delete_from_end` and `explode` take a `c_net`."""
    here, library = Path(__file__).parent, folder / f"{name}.so"
    sources = [here / "sweeps.c"] + ([here / "edits.c"] if name in EDITABLE else [])
    macros = [f"-D{macro}" for macro in MACROS[name]]
    subprocess.run([*COMPILER, *macros, *map(str, sources), "-lm", "-o", str(library)], check=True)
    yardstick = ctypes.CDLL(str(library))
    net, integer, number, refs = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
    yardstick.alfa.argtypes, yardstick.flow.argtypes = [net, integer], [net, integer, number]
    yardstick.alfa.restype = yardstick.flow.restype = None
    if name in EDITABLE:
        yardstick.delete_from_end.argtypes, yardstick.explode.argtypes = [net, integer], [net, refs, integer]
        yardstick.delete_from_end.restype = yardstick.explode.restype = integer
    return yardstick


def c_net(net: Net) -> ctypes.Structure:
    """The struct `Net` of net.h: the fields of the NamedTuples, depth first, and how much room there is."""
    values = [*_fields(net), capacity(net), len(net.points.xyz)]
    types = [(f"field_{n}", _C_TYPES[type(value)]) for n, value in enumerate(values)]
    return type("Net", (ctypes.Structure,), {"_fields_": types})(*values)


def _fields(storage: Any) -> Iterator[Any]:
    for field in storage:
        if isinstance(field, tuple):
            yield from _fields(field)
        else:
            yield ctypes.c_void_p(field.ctypes.data) if isinstance(field, np.ndarray) else field


def is_linked(net: Net) -> bool:
    """Whether the tetras are nodes on the C heap."""
    return isinstance(net.layout, LinkedNodes)


def copy_arrays(source: Net, target: Net) -> None:
    """Make one net of arrays the same as another, down to what is not in use. Both have the same room."""
    for old, new in zip(_arrays(source), _arrays(target), strict=True):
        np.copyto(new, old)


def _arrays(storage: Any) -> Iterator[np.ndarray]:
    for field in storage:
        if isinstance(field, tuple):
            yield from _arrays(field)
        elif isinstance(field, np.ndarray):
            yield field


def content(net: Net) -> list[bytes]:
    """All that a net holds, bit for bit; of linked nodes in a form that does not know where on the heap they lie."""
    if not is_linked(net):
        return [_bits(array) for array in _arrays(net)]
    refs = tetra_refs(net)
    order = np.argsort(refs)

    def places(addresses: np.ndarray) -> np.ndarray:
        """Where in the chain; NONE for what is not in it."""
        found = order[np.minimum(np.searchsorted(refs, addresses, sorter=order), len(refs) - 1)]
        return np.where(refs[found] == addresses, found, NONE)

    nodes = np.frombuffer(b"".join(ctypes.string_at(int(ref), NODE.itemsize) for ref in refs), NODE).copy()
    for field in ("neighbour", "next", "previous"):
        nodes[field] = places(nodes[field])
    used, free = net.incidence.counters
    entries = net.incidence.entries[:used].copy()
    while free != END_OF_LIST:
        entries[free]["ref"] = NONE  # what it held once
        free = entries[free]["next"]
    points, (live, *ends) = net.points.counters[COUNT], net.slots.counters
    parts = [nodes, places(entries["ref"]), entries["next"].copy(), np.array([live, *places(np.array(ends))])]
    parts += [net.points.xyz[:points], net.incidence.heads[:points], net.tree.nodes[:points]]
    parts += [net.points.counters, net.incidence.counters, net.tree.counters]
    return [_bits(part) for part in parts]


def _bits(array: np.ndarray) -> bytes:
    """The bytes of an array, without what pads its records."""
    return repack_fields(array).tobytes()
