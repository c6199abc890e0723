"""ByRef: the fields of a net's tetras as they lie in memory, numpy arrays that are indexed by ref, without a copy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit.generic import is_implemented
from tetrabench.tetra import interface
from tetrabench.tetra.interface import Net


class ByRef:
    """Views of a net's fields, one row a slot: row t is tetra t's, and rows of holes hold anything.

    They are views until the net grows (an insertion or a split may do that) or an `edit` is undone: take them anew after
    edits. All but `states` must not be written to.

    | field | property arrays: v3, v3x, v3y | records: v5, v5x, v5y | halfface | linked nodes: v4 |
    |---|---|---|---|---|
    | vertices, neighbours | contiguous | strided | none: words of half-faces | none: refs are addresses |
    | volumes, centroids, side_areas, side_normals, states | contiguous | strided | contiguous | none |

    >>> import tetrabench
    >>> net = tetrabench.open(tetrabench.generate("box", 48), backend="v5y")
    >>> net.by_ref.states[7] = 1.0
    >>> net.states_of(7)
    array([1., 1., 1., 1., 1.])
    >>> bool(net.by_ref.volumes[7] == net.volume_of(7))
    True

    Where there is none, the property of the same name on the net, a copy in iteration order, is what to take.

    Raises:
        InputError: the contestant has no such array.
    """

    def __init__(self, net: Net, contestant: str) -> None:
        self._net = net
        self._contestant = contestant

    @property
    def vertices(self) -> NDArray[np.int32]:
        """Point refs, (slots, 4) int32."""
        return self._view("vertex")

    @property
    def neighbours(self) -> NDArray[np.int32]:
        """Refs of the tetras behind the sides, (slots, 4) int32, -1 at the surface."""
        return self._view("neighbour")

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes, (slots,) float64."""
        return self._view("volume")

    @property
    def centroids(self) -> NDArray[np.float64]:
        """Means of the vertices, (slots, 3) float64."""
        return self._view("centroid")

    @property
    def side_areas(self) -> NDArray[np.float64]:
        """Areas of the sides, (slots, 4) float64."""
        return self._view("side_area")

    @property
    def side_normals(self) -> NDArray[np.float64]:
        """Outward unit normals of the sides, (slots, 4, 3) float64."""
        return self._view("side_normal")

    @property
    def states(self) -> NDArray[np.float64]:
        """State vectors, (slots, 5) float64; these may be written to."""
        return self._view("state", writeable=True)

    def _view(self, field: str, *, writeable: bool = False) -> Any:
        has_arrays = is_implemented(interface.columns, self._net)
        columns = interface.columns(self._net) if has_arrays else {}
        if field not in columns:
            raise InputError(
                f"{self._contestant} keeps no array of this kind ({field}) that numpy could see: take the net's property of "
                "the same name, which is a copy"
            )
        view = columns[field][: int(interface.slots_used(self._net))]
        view.flags.writeable = writeable
        return view
