"""The C yardsticks: build them, run them on the memory of a net, and compare what both leave behind.

One shared library for each contestant, from the same source (`net.h`, `nearest.h`, `sweeps.c`, `locate.c`, `edits.c`);
C sees the arrays of the net where they are, V4's nodes included.
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

BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS if contestant.name in MACROS}
"""The contestants that have a yardstick."""

EDITABLE = ("v3y", "v4", "v5y")
"""Those whose edits have one, too."""

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
    """The yardstick of a contestant: its functions take a `c_net`, and arrays by their address."""
    here, library = Path(__file__).parent, folder / f"{name}.so"
    sources = [here / "sweeps.c", here / "locate.c"] + ([here / "edits.c"] if name in EDITABLE else [])
    macros = [f"-D{macro}" for macro in MACROS[name]]
    subprocess.run([*COMPILER, *macros, *map(str, sources), "-lm", "-o", str(library)], check=True)
    yardstick = ctypes.CDLL(str(library))
    net, array, integer, number = ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
    declare(yardstick.alfa, None, net, integer)
    declare(yardstick.flow, None, net, integer, number)
    declare(yardstick.locate, integer, net, array, integer, array)
    if name in EDITABLE:
        declare(yardstick.delete_from_end, integer, net, integer)
        declare(yardstick.explode, integer, net, array, integer)
        declare(yardstick.replace, integer, net, array, integer)
    return yardstick


def declare(function: Any, result: Any, *arguments: Any) -> None:
    """Say what a C function takes and returns."""
    function.restype, function.argtypes = result, arguments


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
