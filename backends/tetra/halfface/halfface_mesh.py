"""HalfFaceMesh, a mesh of tetrahedra with vertices and attributes, and EventualMesh, what is to be put into one as a whole.

Source: thesis, 5.2, 5.6.5, 5.7. Geometry is no part of either: coordinates are an attribute of vertices, of any dimension.
"""

import weakref
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from tetrabench.backends.tetra.halfface import conjoin, edit, storage
from tetrabench.backends.tetra.halfface.attributes import Attributes, DenseAttribute, SparseAttribute
from tetrabench.backends.tetra.halfface.block import whole_number
from tetrabench.backends.tetra.halfface.compound import BORDER, refuse_beyond
from tetrabench.backends.tetra.halfface.construct import construct
from tetrabench.backends.tetra.halfface.handles import INVALID, Element, HalfFace, Tetrahedron, Vertex
from tetrabench.backends.tetra.halfface.mesh import Mesh
from tetrabench.backends.tetra.halfface.storage import HalfFaces
from tetrabench.errors import InputError

_DENSE = {
    Element.VERTEX: storage.VERTICES,
    Element.TETRAHEDRON: storage.TETRAS,
    Element.BORDER_HALFFACE: storage.BORDERS,
}


class HalfFaceMesh(Mesh):
    """A mesh of tetrahedra, manifold or not: each face has at most two, and no two have the same four vertices."""

    def __init__(self, vertices: int = 0, *, bits: int = 32, reuse_vertices: bool = True) -> None:
        """A mesh without tetrahedra.

        Args:
            vertices: how many isolated ones it has.
            bits: of a word. 32 are enough for 2^29 - 1 vertices, tetrahedra, and half-faces on the border.
            reuse_vertices: whether a new vertex takes the place of the one that was deleted last.

        Raises:
            InputError: more than the words can count, or no such words.
        """
        vertices = whole_number(vertices)
        refuse_beyond(bits, vertices=vertices)
        self._adopt(storage.make_halffaces(vertices, 0, 0, bits=bits), reuse_vertices)

    @classmethod
    def construct_mesh(
        cls,
        tets: ArrayLike,
        vertices: int | None = None,
        *,
        bits: int = 32,
        reuse_vertices: bool = True,
        manifold: bool = False,
    ) -> Self:
        """The mesh of an element connectivity, (n, 4) whole numbers; traits as above. O(n).

        `vertices`: how many there are, by default the largest in `tets` and one. `manifold`: a promise that the tetrahedra
        of each vertex hang together through faces that have it, which is then not looked for, and takes half the time.

        Raises:
            InputError: another shape, an unknown vertex, a tetrahedron with a vertex twice, two with the same four vertices,
                three with one face, or more than the words can count.
        """
        mesh = cls.__new__(cls)
        mesh._adopt(construct(tets, vertices, bits=bits, manifold=manifold), reuse_vertices)
        return mesh

    def _adopt(self, faces: HalfFaces, reuse_vertices: bool) -> None:
        super().__init__(faces)
        self._reuse_vertices = reuse_vertices
        self._attributes = Attributes()
        self._followed = self.n_tetrahedra  # those that attributes know
        self._eventual: weakref.WeakSet[EventualMesh] = weakref.WeakSet()

    # ------------------------------------------------------------------ vertices

    def add_vertex(self) -> Vertex:
        """A new isolated vertex, in the place of the one that was deleted last, if there is one."""
        return Vertex(int(self.add_vertices(1)[0]))

    def add_vertices(self, count: int) -> NDArray[np.int64]:
        """New isolated vertices, (count,) int64.

        Raises:
            InputError: more than the words can count.
        """
        count = whole_number(count)
        if count < 0:
            raise InputError(f"{count} vertices cannot be added")
        self._refuse_beyond(vertices=count)
        for mesh in (*self._eventual, self):  # room for all, before any of them is another
            mesh._faces = storage.reserve(mesh._faces, vertices=count)
        for eventual in self._eventual:
            eventual._add_vertices(count, self._reuse_vertices)
        added = self._add_vertices(count, self._reuse_vertices)
        for attribute in self._attributes.dense(Element.VERTEX):
            attribute.fit(self._count(storage.VERTICES))
            attribute.reset(added)
        return added

    def remove_vertex(self, v: Vertex) -> None:
        """Delete a vertex.

        Raises:
            InputError: a tetrahedron has it, here or in an eventual mesh.
        """
        v = Vertex(self._checked(Element.VERTEX, v))
        for mesh in (self, *self._eventual):
            if storage.first_record(mesh.storage, v)[0] != INVALID:
                where = "" if mesh is self else " of an eventual mesh"
                raise InputError(f"vertex {v} cannot be removed: a tetrahedron{where} has it")
        for mesh in (self, *self._eventual):
            edit.remove_vertex(mesh.storage, v)
        for attribute in self._attributes.sparse(Element.VERTEX):
            attribute.forget((v,))

    def vertex_deleted(self, v: Vertex) -> bool:
        """Whether a vertex was deleted, and is not in use again."""
        if whole_number(v) not in self.kernel_iterator(Element.VERTEX):
            raise InputError(f"there is no vertex {v}")
        return bool(storage.says_deleted(self._faces, v))

    def clear_mesh(self, tetrahedra_only: bool = False) -> None:
        """Remove all tetrahedra, and unless `tetrahedra_only` all vertices.

        Raises:
            InputError: vertices are to go, and an eventual mesh has tetrahedra at them. The mesh is then as it was.
        """
        if not tetrahedra_only and any(mesh.n_tetrahedra for mesh in self._eventual):
            raise InputError("the vertices cannot go: an eventual mesh has tetrahedra at them")
        super().clear_mesh()
        if not tetrahedra_only:
            for mesh in (self, *self._eventual):
                mesh._faces = storage.make_halffaces(0, 0, 0, bits=self.bits)
            for attribute in self._attributes.dense(Element.VERTEX) + self._attributes.dense(Element.BORDER_HALFFACE):
                attribute.fit(0)
            for sparse in self._attributes.sparse(*Element):
                sparse.purge()

    # ------------------------------------------------------------------ eventual meshes

    def eventual_mesh(self) -> "EventualMesh":
        """An empty mesh with the vertices of this one, to be filled and put into it by `conjoin_mesh`."""
        eventual = EventualMesh(self)
        self._eventual.add(eventual)
        return eventual

    def conjoin_mesh(self, eventual: "EventualMesh") -> NDArray[np.int64]:
        """Put the tetrahedra of an eventual mesh into this one, as a whole; returns their handles here, (n,) int64.

        The eventual mesh stays as it was.

        Raises:
            InputError: it is the eventual mesh of another one; a face would be shared by three, or a tetrahedron be there
                twice; more than the words can count. The mesh is then as it was.
        """
        if eventual not in self._eventual:
            raise InputError("this is no eventual mesh of this mesh")
        self._refuse_beyond(tetrahedra=eventual.n_tetrahedra, border_halffaces=eventual.n_border_halffaces)
        self._after_kernels()
        before = self.n_tetrahedra
        self._faces, refusal = conjoin.conjoin(self._faces, eventual.storage)
        if refusal:
            raise InputError(f"cannot conjoin the eventual mesh: {edit.REFUSALS[refusal]}")
        self._after_adding(before)
        return np.arange(before, self.n_tetrahedra)

    # ------------------------------------------------------------------ attributes

    def add_attribute(
        self,
        element: Element,
        name: str,
        dtype: DTypeLike = np.float64,
        shape: tuple[int, ...] = (),
        default: Any = 0,
    ) -> DenseAttribute:
        """One value, of a shape and dtype, for each VERTEX, TETRAHEDRON or BORDER_HALFFACE; it follows them.

        Raises:
            InputError: another kind of element, or there is an attribute of that name.
        """
        if element not in _DENSE:
            raise InputError(f"there are dense attributes of {', '.join(one.name for one in _DENSE)}, not of {element}")
        size = self._count(_DENSE[element])
        attribute = DenseAttribute(element, name, size, dtype=dtype, shape=shape, default=default)
        self._attributes.add(attribute)
        return attribute

    def add_sparse_attribute(self, element: Element, name: str, default: Any = None) -> SparseAttribute:
        """Values of a few elements of any kind, the default for all others.

        Raises:
            InputError: there is an attribute of that name.
        """
        attribute = SparseAttribute(element, name, default, key_of=self._key_of, handle_of=self._handle_of)
        self._attributes.add(attribute)
        return attribute

    def attribute(self, name: str) -> DenseAttribute | SparseAttribute:
        """The attribute of that name, or InputError."""
        return self._attributes.get(name)

    def remove_attribute(self, name: str) -> None:
        """Forget the attribute of that name, or InputError."""
        self._attributes.remove(name)

    def _key_of(self, element: Element, handle: int) -> tuple[int, ...]:
        """What an element is called whatever its number is: its vertices, and those of its tetra if it is a half-face.

        A half-face on the border is its three vertices.
        """
        vertices = self._vertices_of(element, self._checked(element, handle))
        if element == Element.HALFFACE and not self._is_border(handle):
            t = self.halfface_to_tetrahedron(HalfFace(handle))
            vertices += tuple(v for v in self.tetrahedron_to_vertices(t) if v not in vertices)
        return vertices

    def _handle_of(self, element: Element, key: tuple[Vertex, ...]) -> int:
        """The element with such a key, INVALID if it is no more."""
        if not all(self.is_valid(Element.VERTEX, v) for v in key):
            return INVALID
        if element == Element.VERTEX:
            return key[0]
        if element == Element.EDGE:
            edge = self.vertices_to_edge(*key)
            return edge if self.is_valid(element, edge) else INVALID
        if element == Element.TETRAHEDRON:
            return self.find_tetrahedron(*key)
        if element == Element.HALFFACE and len(key) == 4:
            t = self.find_tetrahedron(*key)
            if t == INVALID:
                return INVALID
            return next(h for h in self.tetrahedron_to_halffaces(t) if self.halfface_to_vertices(h) == key[:3])
        halfface = self.find_halfface(*key)
        if element == Element.FACE:
            return INVALID if halfface == INVALID else self.halfface_to_face(halfface)
        return halfface if halfface != INVALID and self._is_border(halfface) else INVALID

    # ------------------------------------------------------------------ what follows a change

    def _after_kernels(self) -> None:
        self._after_adding(min(self._followed, self.n_tetrahedra))

    def _after_adding(self, before: int) -> None:
        self._followed = self.n_tetrahedra
        for attribute in self._attributes.dense(Element.TETRAHEDRON):
            attribute.fit(self.n_tetrahedra)
        self._fit_border(before)
        sparse = self._attributes.sparse(Element.HALFFACE, Element.BORDER_HALFFACE)
        for t in range(before, self.n_tetrahedra) if sparse else ():
            for halfface in self.tetrahedron_to_halffaces(Tetrahedron(t)):
                if not self._is_border(self.get_opposite_halfface(halfface)):  # then nothing is on the border any more
                    for values in sparse:
                        values.forget(self.halfface_to_vertices(halfface))

    def _fit_border(self, before: int) -> None:
        """New half-faces on the border are those of the tetras from `before` on."""
        for attribute in self._attributes.dense(Element.BORDER_HALFFACE):
            attribute.fit(self._count(storage.BORDERS))
            opposite = self._faces.adjacency[before : self.n_tetrahedra].astype(np.int64)
            attribute.reset(opposite[opposite >> self._bits == BORDER])

    def _before_collecting(self) -> NDArray[np.int64]:
        """What each border half-face is opposite of."""
        wanted = self._attributes.dense(Element.BORDER_HALFFACE)
        return self._faces.bhf2hf[: self._count(storage.BORDERS) if wanted else 0].astype(np.int64)

    def _after_collecting(
        self, before: NDArray[np.int64], moved_from: NDArray[np.int64], moved_to: NDArray[np.int64]
    ) -> None:
        self._followed = self.n_tetrahedra
        for attribute in self._attributes.dense(Element.TETRAHEDRON):
            attribute.move(moved_from, moved_to)
            attribute.fit(self.n_tetrahedra)
        for attribute in self._attributes.dense(Element.BORDER_HALFFACE):
            attribute.fit(self._count(storage.BORDERS))
            attribute.reset(self._newly_on_border(before, moved_from, moved_to))
        for sparse in self._attributes.sparse(*Element):
            sparse.purge()

    def _newly_on_border(
        self, before: NDArray[np.int64], moved_from: NDArray[np.int64], moved_to: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """The border half-faces that are not what they were: opposite another half-face, however tetras moved."""
        now = self._faces.bhf2hf[: self._count(storage.BORDERS)].astype(np.int64)
        tetras = now & self._mask
        back = np.arange(self.n_tetrahedra + 1)  # (a free half-face may name any)
        back[moved_to] = moved_from
        old = back[np.minimum(tetras, self.n_tetrahedra)]
        was = np.full(len(now), INVALID, np.int64)
        was[: len(before)] = before
        return np.flatnonzero((now - tetras + old) != was)


class EventualMesh(Mesh):
    """Tetrahedra on the vertices of a main mesh, to be put into that by its `conjoin_mesh`. Source: thesis, 5.7."""

    def __init__(self, main: HalfFaceMesh) -> None:
        """An empty one; main meshes make them, and keep its vertices like theirs: `main.eventual_mesh()`."""
        of_main = main.storage
        vertices = len(main.kernel_iterator(Element.VERTEX))
        super().__init__(storage.make_halffaces(vertices, 0, 0, bits=main.bits))
        deleted = ~main._live(Element.VERTEX, 0, vertices)
        self._faces.v2hf[deleted] = of_main.v2hf[:vertices][deleted]
        for place in (storage.DELETED_VERTEX, storage.DELETED_VERTICES):
            self._faces.counters[place] = of_main.counters[place]
