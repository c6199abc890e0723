"""The naive twin of the half-face kernel: a mesh as sets of vertices, every question answered by looking at all tetras.

Elements have names that nothing renumbers: a vertex is its number; an edge, a face, a tetra is the frozenset of its vertices;
a half-face is (face, tetra), one on the border (face, None). What handles stand for is read off the words as they are
documented, and not asked of the code under test.
"""

from dataclasses import dataclass, field
from itertools import combinations

from tetrabench.backends.tetra.halfface import Element

KINDS = (Element.VERTEX, Element.EDGE, Element.HALFFACE, Element.TETRAHEDRON)
"""The kinds of elements between which one_to_all is asked."""


class RefusedError(Exception):
    """The mesh stays as it was; says why."""


@dataclass
class NaiveTetra:
    """A tetra: its vertices as they were given, the delete flag, the user flags that are set."""

    vertices: tuple[int, ...]
    flagged: bool = False
    flags: set[int] = field(default_factory=set)


class NaiveMesh:
    """A mesh as a dict of tetras by their sets of vertices.

    An eventual mesh is one with a `main` mesh, whose vertices it has.
    """

    def __init__(self, vertices=0, *, reuse_vertices=True, main=None):
        self.deleted = main.deleted if main else [False] * vertices
        self.removed = []  # the last one is reused first
        self.reuse_vertices = reuse_vertices
        self.eventual = []
        self.tetras: dict[frozenset, NaiveTetra] = {}

    @classmethod
    def of(cls, tets, vertices, **traits):
        mesh = cls(vertices, **traits)
        for tet in tets:
            mesh.add_tetrahedron(tuple(int(v) for v in tet))
        return mesh

    # ------------------------------------------------------------------ elements

    def elements(self, kind):
        """The names of all elements of a kind, flagged ones too."""
        if kind == Element.VERTEX:
            return {v for v, deleted in enumerate(self.deleted) if not deleted}
        if kind == Element.EDGE:
            return {frozenset(pair) for tetra in self.tetras for pair in combinations(tetra, 2)}
        if kind == Element.FACE:
            return set(self.faces())
        if kind == Element.BORDER_HALFFACE:
            return {(face, None) for face, tetras in self.faces().items() if len(tetras) == 1}
        if kind == Element.HALFFACE:
            inner = {(face, tetra) for face, tetras in self.faces().items() for tetra in tetras}
            return inner | self.elements(Element.BORDER_HALFFACE)
        return set(self.tetras)

    def faces(self):
        """Face -> the tetras that have it."""
        faces = {}
        for tetra in self.tetras:
            for face in combinations(tetra, 3):
                faces.setdefault(frozenset(face), []).append(tetra)
        return faces

    def sharing(self, face):
        """The tetras that have a face."""
        return [tetra for tetra in self.tetras if face < tetra]

    def opposite(self, halfface):
        """The other half-face with the same vertices."""
        face, tetra = halfface
        others = [other for other in self.sharing(face) if other != tetra]
        return face, others[0] if others else None

    def neighbour(self, tetra, face):
        """The other tetra that has a face, None at the border."""
        return self.opposite((face, tetra))[1]

    def is_border(self, kind, name):
        if kind in (Element.HALFFACE, Element.BORDER_HALFFACE):
            return name[1] is None
        vertices = vertices_of(kind, name)
        border = [face for face, _ in self.elements(Element.BORDER_HALFFACE)]
        return any(face <= vertices or vertices <= face for face in border)

    # ------------------------------------------------------------------ what belongs to what

    def one_to_all(self, target, source, name):
        return {other for other in self.elements(target) if self.is_incident(target, other, source, name)}

    def is_incident(self, target, x, source, y):
        """The definition: other kinds contain or are contained, the same kind shares all vertices but one of each."""
        ours, theirs = vertices_of(target, x), vertices_of(source, y)
        if target != source:
            return ours <= theirs or theirs <= ours
        if target == Element.VERTEX:
            return x != y and any(ours | theirs <= tetra for tetra in self.tetras)
        return len(ours & theirs) == len(ours) - 1

    def components(self, vertices):
        """The tetras that have these vertices, as sets within which one gets about through faces that have them all."""
        left = [tetra for tetra in self.tetras if vertices <= tetra]
        found = []
        while left:
            component, fresh = set(), {left[0]}
            while fresh:
                component |= fresh
                fresh = {t for t in left if t not in component and any(through(t, c, vertices) for c in fresh)}
            found.append(component)
            left = [tetra for tetra in left if tetra not in component]
        return found

    def is_manifold(self):
        """Whether the tetras of each vertex hang together."""
        return all(len(self.components(frozenset({v}))) <= 1 for v in range(len(self.deleted)))

    # ------------------------------------------------------------------ changes

    def why_not(self, vertices):
        """Why the tetra of these vertices cannot be added, None if it can."""
        if any(not 0 <= v < len(self.deleted) for v in vertices):
            return "unknown"
        if len(set(vertices)) < 4:
            return "equal"
        if any(self.deleted[v] for v in vertices):
            return "deleted"
        if frozenset(vertices) in self.tetras:
            return "twice"
        if any(len(self.sharing(frozenset(face))) == 2 for face in combinations(vertices, 3)):
            return "shared"
        return None

    def can_add(self, vertices):
        return self.why_not(vertices) is None

    def add_tetrahedron(self, vertices):
        if why := self.why_not(vertices):
            raise RefusedError(why)
        self.tetras[frozenset(vertices)] = NaiveTetra(tuple(vertices))

    def garbage_collect(self):
        before = len(self.tetras)
        self.tetras = {name: tetra for name, tetra in self.tetras.items() if not tetra.flagged}
        return before - len(self.tetras)

    def eventual_mesh(self):
        self.eventual.append(NaiveMesh(main=self))
        return self.eventual[-1]

    def conjoin_mesh(self, eventual):
        """All tetras of an eventual mesh, or none."""
        together = NaiveMesh(main=self)
        for tetra in [*self.tetras.values(), *eventual.tetras.values()]:
            together.add_tetrahedron(tetra.vertices)
        for name, tetra in eventual.tetras.items():
            self.tetras[name] = NaiveTetra(tetra.vertices, tetra.flagged, set(tetra.flags))

    def add_vertex(self):
        if self.reuse_vertices and self.removed:
            v = self.removed.pop()
            self.deleted[v] = False
            return v
        self.deleted.append(False)
        return len(self.deleted) - 1

    def remove_vertex(self, v):
        if not 0 <= v < len(self.deleted) or self.deleted[v]:
            raise RefusedError("unknown")
        if any(v in tetra for mesh in [self, *self.eventual] for tetra in mesh.tetras):
            raise RefusedError("in use")
        self.deleted[v] = True
        self.removed.append(v)

    def clear_mesh(self, tetrahedra_only=False):
        if not tetrahedra_only and any(eventual.tetras for eventual in self.eventual):
            raise RefusedError("in use")
        self.tetras = {}
        if not tetrahedra_only:
            self.deleted.clear()  # eventual meshes have the same list
            self.removed = []


def vertices_of(kind, name):
    """The vertices of an element: a frozenset."""
    if kind == Element.VERTEX:
        return frozenset({name})
    return name[0] if kind in (Element.HALFFACE, Element.BORDER_HALFFACE) else name


def through(tetra, other, vertices):
    """Whether one gets from one tetra to another through a face that has these vertices."""
    return len(tetra & other) == 3 and vertices <= tetra & other


class Names:
    """What all handles of a mesh stand for at this moment: {kind: {handle: name}}, and back."""

    def __init__(self, mesh):
        counters, self.bits = mesh.storage.counters, 29 if mesh.bits == 32 else 60
        mask = (1 << self.bits) - 1
        words = mesh.storage.connectivity[: counters[0]].tolist()
        corners = [tuple(word & mask for word in row) for row in words]
        inner = {
            (1 + x) << self.bits | t: (frozenset(row[: 3 - x] + row[4 - x :]), frozenset(row))
            for t, row in enumerate(corners)
            for x in range(4)
        }
        border = {
            b: (inner[word][0], None)
            for b, word in enumerate(mesh.storage.bhf2hf[: counters[2]].tolist())
            if word >> self.bits != 5
        }
        faces = {}
        for handle, (face, _) in inner.items():
            faces[face] = min(handle, faces.get(face, handle))
        self.of = {
            Element.VERTEX: {
                v: v for v, word in enumerate(mesh.storage.v2hf[: counters[5]].tolist()) if word >> self.bits != 5
            },
            Element.EDGE: {min(e) << 31 | max(e): frozenset(e) for row in corners for e in combinations(row, 2)},
            Element.HALFFACE: inner | border,
            Element.TETRAHEDRON: {t: frozenset(row) for t, row in enumerate(corners)},
            Element.FACE: {handle: face for face, handle in faces.items()},
            Element.BORDER_HALFFACE: border,
        }
        self.handles = {kind: {name: handle for handle, name in names.items()} for kind, names in self.of.items()}
