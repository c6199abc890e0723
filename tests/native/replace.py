"""Our side of `replace` in edits.c: delete a tetra and insert it again, with all that an edit keeps right."""

from typing import Any

from tetrabench.jit import kernel
from tetrabench.tetra.interface import Net, delete_tetra, insert_tetra, vertex


@kernel(allocates=False)
def replace(net: Net, refs: Any) -> int:
    """Delete each tetra of `refs` (n,) int64 and insert it again, between the same points. How many could be."""
    for t in refs:
        a, b, c, d = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
        delete_tetra(net, t)
        insert_tetra(net, a, b, c, d)
    return len(refs)
