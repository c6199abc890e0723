"""What one can ask of a half-face mesh, main or eventual, and the changes that both know. Source: thesis, 5.2.

Names are the source's. A handle is an int; each method says in its annotations of which kind, and refuses one that is none
with InputError. A call costs some microseconds of Python: what is asked of many elements has a method for many, and
kernels of one's own take `storage`.
"""

import operator
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.backends.tetra.halfface import audit, collect, edit, find, queries, storage
from tetrabench.backends.tetra.halfface.block import whole_number
from tetrabench.backends.tetra.halfface.circulate import Circulator, list_around_edge
from tetrabench.backends.tetra.halfface.compound import BORDER, DELETED, FLAG, INNER, refuse_beyond
from tetrabench.backends.tetra.halfface.construct import rows_of
from tetrabench.backends.tetra.halfface.handles import (
    INVALID,
    Edge,
    Element,
    Face,
    HalfFace,
    Tetrahedron,
    Vertex,
)
from tetrabench.backends.tetra.halfface.permutations import PLACES
from tetrabench.backends.tetra.halfface.sets import ElementSet, Operand
from tetrabench.backends.tetra.halfface.storage import HalfFaces
from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.mesh.tetra_mesh import as_vertices

KINDS = {
    Element.VERTEX: queries.VERTEX,
    Element.EDGE: queries.EDGE,
    Element.HALFFACE: queries.HALFFACE,
    Element.TETRAHEDRON: queries.TETRAHEDRON,
}
"""The kinds of elements that `one_to_all` knows."""

USER_FLAGS = 6
_SHARE_TO_SORT = 8  # beyond an eighth of the vertices
_FACE_PLACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))


class Mesh:
    """The half-faces of tetras, and all that can be asked of them."""

    def __init__(self, faces: HalfFaces) -> None:
        """Over a storage, which it owns from now on."""
        self._faces = faces
        self._bits = 29 if faces.adjacency.itemsize == 4 else 60
        self._mask = (1 << self._bits) - 1

    @property
    def storage(self) -> HalfFaces:
        """What kernels take. It is another one after a change that made it grow."""
        return self._faces

    @property
    def bits(self) -> int:
        """Bits of a word, 32 or 64."""
        return 32 if self._bits == 29 else 64

    def _count(self, place: int) -> int:
        return int(self._faces.counters[place])

    # ------------------------------------------------------------------ sizes and iteration

    @property
    def n_tetrahedra(self) -> int:
        """Tetrahedra, flagged ones too."""
        return self._count(storage.TETRAS)

    @property
    def n_vertices(self) -> int:
        """Vertices, without deleted ones."""
        return self._count(storage.VERTICES) - self._count(storage.DELETED_VERTICES)

    @property
    def n_border_halffaces(self) -> int:
        """Half-faces on the border."""
        return self._count(storage.BORDERS) - self._count(storage.FREE_BORDERS)

    def mesh_size(self, element: Element) -> int:
        """How many there are of a kind: VERTEX, TETRAHEDRON, BORDER_HALFFACE, HALFFACE (inner and border)."""
        if element == Element.HALFFACE:
            return 4 * self.n_tetrahedra + self.n_border_halffaces
        sizes = {
            Element.VERTEX: self.n_vertices,
            Element.TETRAHEDRON: self.n_tetrahedra,
            Element.BORDER_HALFFACE: self.n_border_halffaces,
        }
        return sizes[_of_these(element, sizes)]

    def kernel_iterator(self, element: Element) -> range:
        """All indices of a kind, those of deleted, flagged and free elements too."""
        places = {
            Element.VERTEX: storage.VERTICES,
            Element.TETRAHEDRON: storage.TETRAS,
            Element.BORDER_HALFFACE: storage.BORDERS,
        }
        return range(self._count(places[_of_these(element, places)]))

    @property
    def vertices(self) -> "Skipping":
        """The vertices, without deleted ones."""
        return Skipping(self, Element.VERTEX)

    @property
    def tetrahedra(self) -> "Skipping":
        """The tetrahedra, without flagged ones."""
        return Skipping(self, Element.TETRAHEDRON)

    @property
    def border_halffaces(self) -> "Skipping":
        """The half-faces on the border."""
        return Skipping(self, Element.BORDER_HALFFACE)

    def _live(self, element: Element, begin: int, end: int) -> NDArray[np.bool_]:
        """Which of the indices begin..end - 1 of a kind are neither deleted, flagged nor free: (end - begin,) bool."""
        words = {
            Element.TETRAHEDRON: self._faces.connectivity[:, 0],
            Element.VERTEX: self._faces.v2hf,
            Element.BORDER_HALFFACE: self._faces.bhf2hf,
        }[element]
        extensions = words[begin:end].astype(np.int64) >> self._bits
        live: NDArray[np.bool_] = extensions < FLAG if element == Element.TETRAHEDRON else extensions != DELETED
        return live

    @property
    def connectivity(self) -> NDArray[np.int64]:
        """(n, 4) int64, the vertices of all tetrahedra as they were given, flagged ones too."""
        words = self._faces.connectivity[: self.n_tetrahedra].astype(np.int64)
        numbers = (words[:, 0] >> self._bits & 3) << 3 | words[:, 1] >> self._bits
        places = PLACES[numbers].astype(np.int64)[:, None] >> 2 * np.arange(4) & 3
        return np.take_along_axis(words & self._mask, places, axis=1)

    # ------------------------------------------------------------------ handles

    def is_valid(self, element: Element, handle: int) -> bool:
        """Whether a handle stands for an element: a flagged tetrahedron does, a deleted vertex does not."""
        handle = whole_number(handle)
        if handle < 0:
            return False
        if element in (Element.VERTEX, Element.BORDER_HALFFACE, Element.TETRAHEDRON):
            known = handle in self.kernel_iterator(element)
            return known and (element == Element.TETRAHEDRON or bool(self._live(element, handle, handle + 1)[0]))
        if element == Element.EDGE:
            a, b = handle >> queries.EDGE_BITS, handle & ((1 << queries.EDGE_BITS) - 1)
            if a >= b or not (self.is_valid(Element.VERTEX, a) and self.is_valid(Element.VERTEX, b)):
                return False
            return int(find.find_halfface_by_edge(self._faces, a, b)) != INVALID
        extension, base = handle >> self._bits, handle & self._mask
        if element == Element.HALFFACE and extension == BORDER:
            return self.is_valid(Element.BORDER_HALFFACE, base)
        inner = INNER <= extension < INNER + 4 and base < self.n_tetrahedra
        return inner and (element == Element.HALFFACE or self.halfface_to_face(HalfFace(handle)) == handle)

    def _checked(self, element: Element, handle: int) -> int:
        if not self.is_valid(element, handle):
            raise InputError(f"there is no {element.value} {handle}")
        return operator.index(handle)

    def handle_to_index(self, element: Element, handle: int) -> int:
        """The place of a vertex, tetrahedron or border half-face among those of its kind."""
        _of_these(element, (Element.VERTEX, Element.TETRAHEDRON, Element.BORDER_HALFFACE))
        return self._checked(element, handle)

    def index_to_handle(self, element: Element, index: int) -> int:
        """The vertex, tetrahedron or border half-face at a place among those of its kind, deleted ones too."""
        if whole_number(index) not in self.kernel_iterator(element):
            raise InputError(f"there is no {element.value} number {index}")
        return operator.index(index)

    # ------------------------------------------------------------------ conversions

    def edge_to_vertices(self, edge: Edge) -> tuple[Vertex, Vertex]:
        """The two vertices of an edge, the lower one first; it need not be there."""
        edge = Edge(whole_number(edge))
        if edge < 0:
            raise InputError(f"{edge} is no edge")
        return Vertex(edge >> queries.EDGE_BITS), Vertex(edge & ((1 << queries.EDGE_BITS) - 1))

    def vertices_to_edge(self, a: Vertex, b: Vertex) -> Edge:
        """The edge of two different vertices; whether it is there, `is_valid` says."""
        a, b = Vertex(self._checked(Element.VERTEX, a)), Vertex(self._checked(Element.VERTEX, b))
        if a == b:
            raise InputError(f"an edge has two vertices, not {a} twice")
        return Edge(int(queries.edge_of(a, b)))

    def tetrahedron_to_vertices(self, t: Tetrahedron) -> tuple[Vertex, ...]:
        """The four vertices, ascending."""
        words = self._faces.connectivity[self._checked(Element.TETRAHEDRON, t)]
        return tuple(Vertex(int(word) & self._mask) for word in words)

    def tetrahedron_to_vertices_ordered(self, t: Tetrahedron) -> tuple[Vertex, ...]:
        """The four vertices, as they were given."""
        vertices, number = self.tetrahedron_to_vertices(t), int(storage.permutation_of(self._faces, t))
        return tuple(vertices[PLACES[number] >> 2 * i & 3] for i in range(4))

    def tetrahedron_to_edges(self, t: Tetrahedron) -> tuple[Edge, ...]:
        """The six edges."""
        return _edges(self.tetrahedron_to_vertices(t))

    def tetrahedron_to_halffaces(self, t: Tetrahedron) -> tuple[HalfFace, ...]:
        """The four half-faces; number X lacks vertex 3 - X of the ascending ones."""
        t = Tetrahedron(self._checked(Element.TETRAHEDRON, t))
        return tuple(HalfFace((INNER + x) << self._bits | t) for x in range(4))

    def tetrahedron_to_faces(self, t: Tetrahedron) -> tuple[Face, ...]:
        """The four faces."""
        return tuple(self.halfface_to_face(halfface) for halfface in self.tetrahedron_to_halffaces(t))

    def face_to_vertices(self, face: Face) -> tuple[Vertex, ...]:
        """The three vertices, ascending."""
        return self.halfface_to_vertices(HalfFace(self._checked(Element.FACE, face)))

    def face_to_edges(self, face: Face) -> tuple[Edge, ...]:
        """The three edges."""
        return _edges(self.face_to_vertices(face))

    def face_to_halffaces(self, face: Face) -> tuple[HalfFace, HalfFace]:
        """The two half-faces; the second one may be on the border."""
        halfface = HalfFace(self._checked(Element.FACE, face))
        return halfface, self.get_opposite_halfface(halfface)

    def face_to_tetrahedra(self, face: Face) -> tuple[Tetrahedron, ...]:
        """The one or two tetrahedra."""
        tetras = (self.halfface_to_tetrahedron(halfface) for halfface in self.face_to_halffaces(face))
        return tuple(t for t in tetras if t != INVALID)

    def halfface_to_vertices(self, halfface: HalfFace) -> tuple[Vertex, ...]:
        """The three vertices, ascending."""
        halfface = self._inner(halfface)
        vertices = self.tetrahedron_to_vertices(Tetrahedron(halfface & self._mask))
        return tuple(vertices[place] for place in _FACE_PLACES[(halfface >> self._bits) - INNER])

    def halfface_to_edges(self, halfface: HalfFace) -> tuple[Edge, ...]:
        """The three edges."""
        return _edges(self.halfface_to_vertices(halfface))

    def halfface_to_face(self, halfface: HalfFace) -> Face:
        """The face, named by that of its inner half-faces with the lower handle."""
        inner = self._inner(halfface)
        opposite = self.get_opposite_halfface(inner)
        return Face(inner if self._is_border(opposite) else min(inner, opposite))

    def halfface_to_tetrahedron(self, halfface: HalfFace) -> Tetrahedron:
        """The tetrahedron, INVALID for a half-face on the border."""
        halfface = HalfFace(self._checked(Element.HALFFACE, halfface))
        return Tetrahedron(INVALID if self._is_border(halfface) else halfface & self._mask)

    def get_opposite_halfface(self, halfface: HalfFace) -> HalfFace:
        """The other half-face with the same vertices."""
        halfface = HalfFace(self._checked(Element.HALFFACE, halfface))
        if self._is_border(halfface):
            return HalfFace(int(self._faces.bhf2hf[halfface]))
        return HalfFace(int(self._faces.adjacency[halfface & self._mask, (halfface >> self._bits) - INNER]))

    def get_neighbour_tetrahedron(self, t: Tetrahedron, k: int) -> Tetrahedron:
        """The tetrahedron behind half-face k (0..3) of a tetrahedron, INVALID at the border."""
        return self.halfface_to_tetrahedron(
            self.get_opposite_halfface(self.tetrahedron_to_halffaces(t)[_below(k, 4, "half-face")])
        )

    def _is_border(self, halfface: int) -> bool:
        return halfface >> self._bits == BORDER

    def _inner(self, halfface: HalfFace) -> HalfFace:
        """A half-face itself, or the opposite one of a half-face on the border."""
        halfface = HalfFace(self._checked(Element.HALFFACE, halfface))
        return self.get_opposite_halfface(halfface) if self._is_border(halfface) else halfface

    def _vertices_of(self, element: Element, handle: int) -> tuple[Vertex, ...]:
        """The vertices of an element, ascending."""
        if element == Element.VERTEX:
            return (Vertex(self._checked(element, handle)),)
        if element == Element.EDGE:
            return self.edge_to_vertices(Edge(self._checked(element, handle)))
        if element == Element.TETRAHEDRON:
            return self.tetrahedron_to_vertices(Tetrahedron(handle))
        return self.halfface_to_vertices(HalfFace(self._checked(element, handle)))

    # ------------------------------------------------------------------ finding

    def find_halfface(self, a: Vertex, b: Vertex, c: Vertex) -> HalfFace:
        """A half-face with three vertices: the border one if there is one, else that of the lower handle; or INVALID."""
        vertices = self._distinct(a, b, c)
        return HalfFace(int(find.find_halfface(self._faces, *vertices)) if vertices else INVALID)

    def find_halfface_by_edge(self, a: Vertex, b: Vertex) -> HalfFace:
        """A half-face with two vertices, a border one if there is one; or INVALID."""
        vertices = self._distinct(a, b)
        return HalfFace(int(find.find_halfface_by_edge(self._faces, *vertices)) if vertices else INVALID)

    def find_tetrahedron(self, a: Vertex, b: Vertex, c: Vertex, d: Vertex) -> Tetrahedron:
        """The tetrahedron with four vertices, flagged or not; or INVALID."""
        vertices = self._distinct(a, b, c, d)
        return Tetrahedron(int(find.find_tetrahedron(self._faces, *vertices)) if vertices else INVALID)

    def _distinct(self, *vertices: int) -> tuple[int, ...]:
        """The vertices, none where one comes twice: nothing has it twice."""
        checked = tuple(self._checked(Element.VERTEX, v) for v in vertices)
        return checked if len(set(checked)) == len(checked) else ()

    # ------------------------------------------------------------------ what belongs to what

    def one_to_all(self, target: Element, source: Element, handle: int) -> ElementSet:
        """All elements of a kind that belong to one, by the sets of their vertices.

        Of a larger or smaller kind: those that contain it, or that it contains (of a tetrahedron its half-faces and their
        opposite ones). Of the same kind: vertices joined to it by an edge, edges that share just one vertex with it,
        half-faces that share just an edge, tetrahedra that share a face. Flagged tetrahedra and half-faces on the border
        belong to it.
        """
        _, found = self.one_to_all_many(target, source, [handle])
        return ElementSet(target, found)

    def one_to_all_many(
        self, target: Element, source: Element, handles: ArrayLike | Operand
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """`one_to_all` of many elements: starts (n + 1,), found (m,) int64.

        Those of handles[i] are `found[starts[i]:starts[i + 1]]`, ascending.
        """
        kinds = KINDS[_of_these(target, KINDS)], KINDS[_of_these(source, KINDS)]
        handles = _handles(handles)
        self._check_many(source, handles)
        if (target, source) == (Element.TETRAHEDRON, Element.VERTEX) and _SHARE_TO_SORT * len(
            handles
        ) > self.n_vertices:
            return self._sorted_around(handles)
        starts = np.zeros(len(handles) + 1, np.int64)
        found, vertices, done = np.empty(64 + 32 * len(handles), np.int64), np.empty(4, np.int64), 0
        while True:
            done = int(queries.list_many(self._faces, *kinds, handles, done, starts, found, vertices))
            if done == len(handles):
                return starts, found[: starts[-1]].copy()
            found = np.concatenate([found[: starts[done]], np.empty(2 * len(found), np.int64)])

    def _sorted_around(self, vertices: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The tetrahedra of many vertices, by sorting all there are: faster than walking around a good part of the mesh."""
        tets = (self._faces.connectivity[: self.n_tetrahedra].astype(np.int64) & self._mask).astype(np.int32)
        begins, rows = vertex_tetras(tets, self._count(storage.VERTICES))
        starts = np.concatenate([[0], np.cumsum(begins[vertices + 1] - begins[vertices])])
        places = np.arange(starts[-1]) + np.repeat(begins[vertices] - starts[:-1], np.diff(starts))
        return starts, rows[places].astype(np.int64)

    def _check_many(self, element: Element, handles: NDArray[np.int64]) -> None:
        if element in (Element.VERTEX, Element.TETRAHEDRON):
            known = (handles >= 0) & (handles < len(self.kernel_iterator(element)))
            if element == Element.VERTEX:
                known[known] = self._faces.v2hf[handles[known]].astype(np.int64) >> self._bits != DELETED
            strange = handles[~known][:1].tolist()
        else:
            strange = [handle for handle in handles.tolist() if not self.is_valid(element, handle)][:1]
        for handle in strange:
            self._checked(element, handle)

    def one_to_any(self, target: Element, source: Element, handle: int) -> int:
        """One of `one_to_all`, or INVALID where there is none, without listing them all."""
        _of_these(target, KINDS)
        t = self._any_tetrahedron(source, handle)
        if t == INVALID:
            return INVALID
        if target == Element.TETRAHEDRON and source == Element.TETRAHEDRON:
            return max(self.get_neighbour_tetrahedron(t, k) for k in range(4))
        if target == Element.TETRAHEDRON:
            return t
        parts: tuple[int, ...] = self.tetrahedron_to_vertices(t)
        if target == Element.EDGE:
            parts = self.tetrahedron_to_edges(t)
        elif target == Element.HALFFACE:
            parts = self.tetrahedron_to_halffaces(t)
        return next(part for part in parts if self.is_incident(target, part, source, handle))

    def _any_tetrahedron(self, element: Element, handle: int) -> Tetrahedron:
        """A tetrahedron that has an element; INVALID for an isolated vertex."""
        _of_these(element, KINDS)
        handle = self._checked(element, handle)
        if element == Element.TETRAHEDRON:
            return Tetrahedron(handle)
        if element == Element.EDGE:
            handle = self.find_halfface_by_edge(*self.edge_to_vertices(Edge(handle)))
        elif element == Element.VERTEX:
            handle = int(storage.first_record(self._faces, handle)[0])
        return Tetrahedron(INVALID if handle == INVALID else self._inner(HalfFace(handle)) & self._mask)

    def is_incident(self, target: Element, x: int, source: Element, y: int) -> bool:
        """Whether x, of kind `target`, is in `one_to_all(target, source, y)`, without listing that."""
        ours = set(self._vertices_of(_of_these(target, KINDS), x))
        theirs = set(self._vertices_of(_of_these(source, KINDS), y))
        if target != source:
            return ours <= theirs or theirs <= ours
        if target == Element.VERTEX:
            return self.find_halfface_by_edge(Vertex(x), Vertex(y)) != INVALID
        return len(ours & theirs) == KINDS[target] - 1

    def is_border(self, element: Element, handle: int) -> bool:
        """Whether an element lies on the border: is or has a half-face there, or is part of one."""
        if element in (Element.HALFFACE, Element.BORDER_HALFFACE):
            return self._is_border(self._checked(element, handle))
        if element == Element.EDGE:
            edge = Edge(self._checked(element, handle))
            return self._is_border(self.find_halfface_by_edge(*self.edge_to_vertices(edge)))
        if element == Element.TETRAHEDRON:
            return any(self.get_neighbour_tetrahedron(Tetrahedron(handle), k) == INVALID for k in range(4))
        if element == Element.FACE:
            return self._is_border(self.face_to_halffaces(Face(handle))[1])
        return bool(self._faces.vborders[self._checked(Element.VERTEX, handle)] > 0)

    def tetrahedra_around_edge(self, edge: Edge, start: Tetrahedron = Tetrahedron(INVALID)) -> Circulator:  # noqa: B008
        """The tetrahedra around an edge, in order; from border to border where they do not close.

        `start`: one of those wanted, where they fall apart in several fans (a non-manifold edge).

        Raises:
            InputError: there is no such edge, or it is none of `start`.
        """
        a, b = self.edge_to_vertices(Edge(self._checked(Element.EDGE, edge)))
        t = self._any_tetrahedron(Element.EDGE, edge) if start == INVALID else start
        if not {a, b} <= set(self.tetrahedron_to_vertices(t)):
            raise InputError(f"tetrahedron {t} does not have the edge ({a}, {b})")
        found = np.empty(8, np.int64)
        count = int(list_around_edge(self._faces, t, a, b, found))
        if count > len(found):
            found = np.empty(count, np.int64)
            list_around_edge(self._faces, t, a, b, found)
        return Circulator(found[:count].tolist())

    # ------------------------------------------------------------------ flags

    def get_delete_flag(self, t: Tetrahedron) -> bool:
        """Whether a tetrahedron is flagged, to go at the next garbage_collect."""
        return bool(storage.is_flagged(self._faces, self._checked(Element.TETRAHEDRON, t)))

    def set_delete_flag(self, t: Tetrahedron, value: bool = True) -> None:
        """Flag a tetrahedron, or take the flag away."""
        edit.set_delete_flag(self._faces, self._checked(Element.TETRAHEDRON, t), bool(value))

    def set_delete_flags(self, tetras: ArrayLike | Operand, value: bool = True) -> None:
        """Flag many tetrahedra, (n,) or a set of them, or take the flags away."""
        handles = _handles(tetras)
        self._check_many(Element.TETRAHEDRON, handles)
        _set_delete_flags(self._faces, handles, bool(value))

    def get_tetrahedron_flag(self, t: Tetrahedron, k: int) -> bool:
        """User flag k, 0..5."""
        return bool(edit.user_flag(self._faces, self._checked(Element.TETRAHEDRON, t), _below(k, USER_FLAGS, "flag")))

    def set_tetrahedron_flag(self, t: Tetrahedron, k: int) -> None:
        """Set user flag k, 0..5."""
        self._write_flag(t, k, True)

    def reset_tetrahedron_flag(self, t: Tetrahedron, k: int) -> None:
        """Take user flag k, 0..5, away."""
        self._write_flag(t, k, False)

    def flip_tetrahedron_flag(self, t: Tetrahedron, k: int) -> None:
        """Turn user flag k, 0..5, over."""
        self._write_flag(t, k, not self.get_tetrahedron_flag(t, k))

    def _write_flag(self, t: Tetrahedron, k: int, value: bool) -> None:
        t = Tetrahedron(self._checked(Element.TETRAHEDRON, t))
        edit.set_user_flag(self._faces, t, _below(k, USER_FLAGS, "flag"), value)

    # ------------------------------------------------------------------ changes

    def reserve(self, vertices: int = 0, tetrahedra: int = 0, border_halffaces: int = 0) -> None:
        """Make room for so many more of each, and for kernels that add so many tetrahedra one by one.

        Raises:
            InputError: more than the words can count, or less than nothing.
        """
        vertices, tetrahedra, border_halffaces = (
            whole_number(vertices),
            whole_number(tetrahedra),
            whole_number(border_halffaces),
        )
        if min(vertices, tetrahedra, border_halffaces) < 0:
            raise InputError("there cannot be room for less than nothing")
        self._refuse_beyond(vertices=vertices, tetrahedra=tetrahedra, border_halffaces=border_halffaces)
        self._faces = storage.reserve(
            self._faces,
            vertices=vertices,
            tetras=tetrahedra,
            borders=max(border_halffaces, 4 * tetrahedra),
            records=8 * tetrahedra,
            fan=tetrahedra,
        )

    def _refuse_beyond(self, **more: int) -> None:
        have = {
            "vertices": self._count(storage.VERTICES),
            "tetrahedra": self.n_tetrahedra,
            "border_halffaces": self.n_border_halffaces,
        }
        refuse_beyond(self.bits, **{what: have[what] + count for what, count in more.items() if count})

    def _add_vertices(self, count: int, reuse: bool) -> NDArray[np.int64]:
        """So many vertices more, in the place of deleted ones if `reuse`: (count,) int64."""
        self._faces = storage.reserve(self._faces, vertices=count)
        added = np.empty(count, np.int64)
        _add_vertices(self._faces, added, reuse)
        return added

    def add_tetrahedron(self, a: Vertex, b: Vertex, c: Vertex, d: Vertex) -> Tetrahedron:
        """Add the tetrahedron of four vertices, behind the others.

        Raises:
            InputError: equal, unknown or deleted vertices; a tetrahedron that is there already, or two that share one of its
                faces, flagged ones too. The mesh is then as it was.
        """
        return Tetrahedron(int(self.add_tetrahedra([(a, b, c, d)])[0]))

    def add_tetrahedra(self, tets: ArrayLike) -> NDArray[np.int64]:
        """Add tetrahedra (n, 4), one after the other; returns their handles, (n,) int64.

        Raises:
            InputError: as `add_tetrahedron`, naming the row; those before it are in, and none after it.
        """
        self._refuse_beyond(tetrahedra=rows_of(tets))  # before they are copied
        self._after_kernels()
        rows = as_vertices(tets).astype(np.int64)
        bound = self._count(storage.LARGEST_FAN)
        self._faces = storage.reserve(self._faces, tetras=len(rows))
        before, done = self.n_tetrahedra, 0
        refusal = edit.FULL
        while refusal == edit.FULL:
            done, refusal = _add_many(self._faces, rows, done)
            if refusal == edit.FULL:
                self._faces = storage.reserve(self._faces, borders=4, records=8, fan=1)
        self._after_adding(before)
        if done == 0:  # nothing happened, so not even that bound shall be another
            self._faces.counters[storage.LARGEST_FAN] = bound
        if refusal:
            row = f"row {done}: " if len(rows) > 1 else ""
            raise InputError(
                f"{row}cannot add the tetrahedron {tuple(rows[done].tolist())}: {edit.REFUSALS[int(refusal)]}"
            )
        return np.arange(before, self.n_tetrahedra)

    def garbage_collect(self) -> int:
        """Remove the flagged tetrahedra; returns how many. Handles of tetrahedra and half-faces are invalid afterwards."""
        self._after_kernels()
        before = self._before_collecting()
        gone = self._count(storage.FLAGGED)
        self._faces, moved_from, moved_to = collect.collect(self._faces)
        self._after_collecting(before, moved_from, moved_to)
        return gone

    def clear_mesh(self) -> None:
        """Remove all tetrahedra."""
        _set_all_flags(self._faces)
        self.garbage_collect()

    def _after_kernels(self) -> None:
        """What has to follow tetrahedra that kernels have added to the storage since the last change."""

    def _after_adding(self, before: int) -> None:
        """What has to follow tetrahedra that have come, those from `before` on."""

    def _before_collecting(self) -> Any:
        """What has to be known after tetrahedra have gone."""

    def _after_collecting(self, before: Any, moved_from: NDArray[np.int64], moved_to: NDArray[np.int64]) -> None:
        """What has to follow tetrahedra that have gone or moved."""

    # ------------------------------------------------------------------ for people

    def check(self) -> list[str]:
        """Audit the whole structure: sentences about what is wrong, empty if it is sound."""
        return [audit.CHECKS[name] for name in audit.audit(self._faces)]

    def structure_bytes(self) -> dict[str, tuple[int, int]]:
        """Bytes (used, reserved) of each array, by name."""
        return storage.array_sizes(self._faces)

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"<{kind}: {self.n_tetrahedra:,} tetrahedra, {self.n_border_halffaces:,} border half-faces>"


class Skipping:
    """The elements of a kind in the order of their handles, without those that are deleted, flagged or free.

    It steps through the mesh as it is; the mesh must not change on the way.
    """

    _BLOCK = 1024

    def __init__(self, mesh: Mesh, element: Element) -> None:
        """The elements of one kind."""
        self._mesh, self._element = mesh, element

    @property
    def handles(self) -> NDArray[np.int64]:
        """All at once, (n,) int64."""
        size = len(self._mesh.kernel_iterator(self._element))
        return np.flatnonzero(self._mesh._live(self._element, 0, size))

    def _block(self, begin: int) -> list[int]:
        end = min(begin + self._BLOCK, len(self._mesh.kernel_iterator(self._element)))
        return [begin + int(n) for n in np.flatnonzero(self._mesh._live(self._element, begin, end))]

    def _blocks(self) -> range:
        return range(0, len(self._mesh.kernel_iterator(self._element)), self._BLOCK)

    def __iter__(self) -> Iterator[int]:
        for begin in self._blocks():
            yield from self._block(begin)

    def __reversed__(self) -> Iterator[int]:
        for begin in reversed(self._blocks()):
            yield from reversed(self._block(begin))

    def __len__(self) -> int:
        flagged = self._mesh.storage.counters[storage.FLAGGED] if self._element == Element.TETRAHEDRON else 0
        return self._mesh.mesh_size(self._element) - int(flagged)


def _handles(handles: ArrayLike | Operand) -> NDArray[np.int64]:
    given = np.asarray(handles.evaluate().handles if isinstance(handles, Operand) else handles)
    if given.ndim != 1 or (given.dtype.kind not in "iu" and given.size):
        raise InputError(f"handles are whole numbers of the shape (n,), not {given.dtype} {given.shape}")
    return np.require(given, np.int64, ["C", "W", "O"])


def _below(k: object, count: int, what: str) -> int:
    if not 0 <= whole_number(k) < count:
        raise InputError(f"a tetrahedron has the {what}s 0 to {count - 1}, not {k}")
    return whole_number(k)


def _of_these(element: Any, elements: Any) -> Element:
    if element not in elements:
        raise InputError(f"this wants one of {', '.join(one.name for one in elements)}, not {element}")
    known: Element = element
    return known


def _edges(vertices: tuple[Vertex, ...]) -> tuple[Edge, ...]:
    """The edges between ascending vertices."""
    return tuple(Edge(a << queries.EDGE_BITS | b) for n, a in enumerate(vertices) for b in vertices[n + 1 :])


@kernel(allocates=False)
def _add_many(mesh: HalfFaces, tets: Any, begin: int) -> tuple[Any, Any]:
    """Add tetras (n, 4) from a row on; how many rows are in, and the refusal of the next one, or 0."""
    for row in range(begin, len(tets)):
        t = edit.add_tetrahedron(mesh, tets[row, 0], tets[row, 1], tets[row, 2], tets[row, 3])
        if t < 0:
            return row, t
    return len(tets), np.int64(0)


@kernel(allocates=False)
def _add_vertices(mesh: HalfFaces, added: Any, reuse: bool) -> None:
    for n in range(len(added)):
        added[n] = edit.add_vertex(mesh, reuse)


@kernel(allocates=False)
def _set_delete_flags(mesh: HalfFaces, tetras: Any, value: bool) -> None:
    for t in tetras:
        edit.set_delete_flag(mesh, t, value)


@kernel(allocates=False)
def _set_all_flags(mesh: HalfFaces) -> None:
    for t in range(mesh.counters[storage.TETRAS]):
        edit.set_delete_flag(mesh, t, True)
