"""The plane through a mesh, against an exact twin, areas that are known, and the theorem of Cavalieri."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes import mesh_of, pair, single
from tetrabench.errors import InputError
from tetrabench.mesh.cut import Plane, check_plane, cut_mesh, cut_triangles, find_plane
from tetrabench.mesh.models import generate
from tetrabench.mesh.surface import find_surface

CROOKED = generate("box", 162, seed=3)
GRID = [[x, y, z] for z in range(3) for y in range(3) for x in range(3)]


def regular_box(turn=False):
    """A box of 2 x 2 x 2 cubes whose points lie on the planes x, y, z = 0, 1, 2; 48 tetras, every third inside out."""
    mesh = mesh_of(GRID, generate("box", 48).tets)
    mesh.tets[::3] = mesh.tets[::3][:, [1, 0, 2, 3]]
    return mesh


def exact_cut(points, tet, normal, offset):
    """The corners of a tetra's polygon, a set of exact places: where its edges meet the plane, without rounding."""
    corners = [[Fraction(x) for x in points[v]] for v in tet]
    heights = [sum(Fraction(n) * x for n, x in zip(normal, p, strict=True)) - Fraction(offset) for p in corners]
    places = {tuple(p) for p, h in zip(corners, heights, strict=True) if h == 0}
    for (p, g), (q, h) in combinations(zip(corners, heights, strict=True), 2):
        if g * h < 0:
            places.add(tuple(a + (b - a) * g / (g - h) for a, b in zip(p, q, strict=True)))
    return places, heights


def naive_area(places):
    """The largest area of the polygon of up to four places: around them in each order."""
    if len(places) < 3:
        return 0.0
    p = np.array([[float(x) for x in place] for place in places])
    orders = [(0, 1, 2, 2)] if len(p) == 3 else [(0, 1, 2, 3), (0, 2, 1, 3), (0, 1, 3, 2)]
    return max(np.linalg.norm(np.cross(p[c] - p[a], p[d] - p[b])) / 2 for a, b, c, d in orders)


def assert_sound(cut, points, tets, normal, offset):
    """Polygons in the plane, in their tetras, and convex."""
    scale = np.abs(points).max()
    normal = np.asarray(normal, float)
    np.testing.assert_allclose(cut.corners @ normal, offset, atol=1e-12 * scale * np.linalg.norm(normal))
    for corners, t in zip(cut.corners, cut.tetras, strict=True):
        frame = np.vstack([points[tets[t]].T, np.ones(4)])
        if abs(np.linalg.det(frame)) > 1e-12:
            shares = np.linalg.solve(frame, np.vstack([corners.T, np.ones(4)]))
            assert shares.min() > -1e-9
        turns = [np.cross(corners[i - 1] - corners[i - 2], corners[i] - corners[i - 1]) @ normal for i in range(4)]
        assert min(turns) * max(turns) >= -1e-20


numbers = st.integers(-3, 3)


@given(st.tuples(numbers, numbers, numbers).filter(any), st.integers(-8, 8), st.integers(0, 5))
def test_against_the_exact_twin(normal, offset, seed):
    """Small whole numbers: most planes go through vertices, many through edges and sides."""
    rng = np.random.default_rng(seed)
    mesh = mesh_of(rng.integers(-2, 3, (8, 3)), rng.permuted([range(8)] * 6, axis=1)[:, :4])
    cut = cut_mesh(mesh.points, mesh.tets, normal, offset)
    found = {}
    for corners, t in zip(cut.corners.tolist(), cut.tetras.tolist(), strict=True):
        assert t not in found
        found[t] = np.array(corners)
    taken = {}
    for t, tet in enumerate(mesh.tets.tolist()):
        places, heights = exact_cut(mesh.points, tet, normal, offset)
        signs = sorted((h > 0) - (h < 0) for h in heights)
        if signs in ([0, 0, 0, 1], [-1, 0, 0, 0]):
            side = frozenset(v for v, h in zip(tet, heights, strict=True) if h == 0)
            taken.setdefault(side, []).append((signs[3] == 0, t))  # who stands on it comes first
        elif signs[0] < 0 < signs[3]:
            assert_corners(found.pop(t), places)
        else:
            assert t not in found
    for side, rows in taken.items():
        mine = [t for _, t in rows if t in found]
        assert mine == [min(rows)[1]]
        assert_corners(found.pop(mine[0]), {tuple(mesh.points[v]) for v in side})
    assert not found
    assert_sound(cut, mesh.points, mesh.tets, normal, offset)


def assert_corners(corners, places):
    distinct = np.array([[float(x) for x in place] for place in places])
    gaps = np.abs(corners[:, None] - distinct[None]).max(axis=2)
    assert gaps.min(axis=0).max() < 1e-14  # each place is a corner
    assert gaps.min(axis=1).max() < 1e-14  # and each corner a place


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_vertex_on_the_plane_is_a_corner_bit_by_bit(axis, rng):
    mesh = mesh_of(rng.normal(size=(200, 3)), rng.permuted([range(200)] * 1000, axis=1)[:, :4])
    seen = 0
    for vertex in range(20):
        cut = cut_mesh(mesh.points, mesh.tets, np.eye(3)[axis], mesh.points[vertex, axis])
        around = (mesh.tets[cut.tetras] == vertex).any(axis=1)
        corners = cut.corners[around]
        seen += len(corners)
        assert (corners == mesh.points[vertex]).all(axis=2).any(axis=1).all()
    assert seen > 100


@given(st.integers(0, 10**6))
def test_areas_of_tetras(seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    offset = float(CROOKED.points.mean(axis=0) @ normal) + rng.normal() / 3
    cut = cut_mesh(CROOKED.points, CROOKED.tets, normal, offset)
    assert_sound(cut, CROOKED.points, CROOKED.tets, normal, offset)
    areas = dict(zip(cut.tetras.tolist(), cut.areas.tolist(), strict=True))
    for t, tet in enumerate(CROOKED.tets):
        places, _ = exact_cut(CROOKED.points, tet, normal, offset)
        assert areas.get(t, 0.0) == pytest.approx(naive_area(places), abs=1e-12)


@given(st.sampled_from([0, 1, 2]), st.sampled_from([0.0, 1.0, 2.0]), st.booleans())
def test_a_plane_in_sides_cuts_each_area_once(axis, offset, flip):
    """Through the middle, where two tetras share each side, and along the surface; seen from either side."""
    mesh = regular_box()
    sign = -1.0 if flip else 1.0
    cut = cut_mesh(mesh.points, mesh.tets, sign * np.eye(3)[axis], sign * offset)
    assert cut.areas.sum() == 4.0
    assert len(cut.tetras) == 8
    assert (cut.corners[..., axis] == offset).all()  # bit by bit
    middles = mesh.points[mesh.tets[cut.tetras]].mean(axis=1)[:, axis]
    inwards = {0.0: 1.0, 1.0: sign, 2.0: -1.0}[offset]  # at the surface there is no choice
    assert ((middles - offset) * inwards > 0).all()
    rims = cut_triangles(mesh.points, find_surface(mesh.points, mesh.tets).triangles, np.eye(3)[axis], offset)
    assert np.linalg.norm(rims[:, 0] - rims[:, 1], axis=1).sum() == (8.0 if offset else 0.0)


@given(st.integers(0, 10**6), st.sampled_from(["free", "through a vertex", "through three"]))
def test_area_of_a_slanting_cut_is_that_of_the_box(seed, how):
    """By the area of the cut of the 6 pieces that the box has without inner points: 6 exact tetras."""
    rng = np.random.default_rng(seed)
    mesh = regular_box()
    normal, place = rng.normal(size=3), rng.uniform(0, 2, 3)
    if how == "through a vertex":
        place = mesh.points[rng.integers(27)]
    if how == "through three":
        a, b, c = (mesh.points[v] for v in rng.choice(27, 3, replace=False))
        normal, place = np.cross(b - a, c - a), a
        if not normal.any():
            return
    offset = float(normal @ place)
    whole = mesh_of([[2 * (n >> k & 1) for k in range(3)] for n in range(8)], generate("box", 6).tets)
    expected = sum(naive_area(exact_cut(whole.points, tet, normal, offset)[0]) for tet in whole.tets)
    found = cut_mesh(mesh.points, mesh.tets, normal, offset).areas.sum()
    if how == "through three":  # may lie in sides of the 6, which `naive_area` counts in both
        assert found <= expected + 1e-12
    else:
        assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("model", ["box", "nozzle", "intake"])
def test_areas_add_up_to_the_volume(model):
    """Cavalieri: the integral of the areas over the height is the volume. By Simpson, many planes."""
    mesh = generate(model, 2000, seed=5)
    normal = np.array([2.0, -1.0, 2.0]) / 3
    height = mesh.points @ normal
    places, step = np.linspace(height.min(), height.max(), 401, retstep=True)
    areas = np.array([cut_mesh(mesh.points, mesh.tets, normal, place).areas.sum() for place in places])
    weights = np.ones(401)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    a, b, c, d = mesh.points[mesh.tets].transpose(1, 0, 2)
    volume = np.abs(np.einsum("kx,kx->k", np.cross(b - a, c - a), d - a)).sum() / 6
    assert step / 3 * (weights @ areas) == pytest.approx(volume, rel=1e-3)


@pytest.mark.parametrize("model", ["box", "nozzle", "intake"])
def test_neighbours_meet_in_the_same_bits(model):
    """Every edge of a polygon belongs to two, but for those of the rim, which the surface has."""
    mesh = generate(model, 2000, seed=5)
    plane = find_plane("z=37%", mesh.points)
    cut = cut_mesh(mesh.points, mesh.tets, plane.normal, plane.value)
    count = {}
    for corners in cut.corners.tolist():
        for ends in zip(corners, corners[1:] + corners[:1], strict=True):
            if ends[0] != ends[1]:
                edge = frozenset(map(tuple, ends))
                count[edge] = count.get(edge, 0) + 1
    assert set(count.values()) == {1, 2}
    triangles = find_surface(mesh.points, mesh.tets).triangles
    rim = {
        frozenset(map(tuple, ends))
        for ends in cut_triangles(mesh.points, triangles, plane.normal, plane.value).tolist()
    }
    assert rim == {edge for edge, times in count.items() if times == 1}


def test_what_only_touches_has_no_polygon():
    mesh = single()
    for normal, offset in (([1, 0, 0], 1), ([1, 1, 0], 1), ([0, 0, 1], 1.5), ([1, -1, 0], 1)):
        touched = cut_mesh(mesh.points, mesh.tets, normal, offset)
        area = touched.areas.sum()
        assert area == 0
        assert len(touched.tetras) == 0
    assert len(cut_mesh(mesh.points, np.empty((0, 4), np.int32), [1, 0, 0], 0).tetras) == 0


def test_one_who_stands_on_a_side_goes_before_one_who_hangs():
    mesh = pair()
    normal = np.array([1.0, 1.0, 1.0])
    for sign, expected in ((1, 1), (-1, 0)):
        cut = cut_mesh(mesh.points, mesh.tets, sign * normal, sign)
        assert cut.tetras.tolist() == [expected]
        assert cut.areas.sum() == pytest.approx(np.sqrt(3) / 2)


@pytest.mark.parametrize(
    ("text", "axis", "value"),
    [
        ("x=0.25", 0, 0.25),
        (" Y = 50% ", 1, -1.0),
        ("z=-1e-1", 2, -0.1),
        ("z=0%", 2, -1),
        ("z=100%", 2, 3),
        ("y=.5", 1, 0.5),
    ],
)
def test_planes_as_people_write_them(text, axis, value):
    points = np.array([[0.0, -4.0, -1.0], [1.0, 2.0, 3.0]])
    assert find_plane(text, points) == Plane(axis, value)


def test_planes_are_shown_as_they_are_written():
    assert str(find_plane("y=50%", np.array([[0.0, -4.0, -1.0], [1.0, 2.0, 3.0]]))) == "y = -1"


@pytest.mark.parametrize("text", ["", "x", "x=", "w=1", "x=1m", "0.3", "x=0.3,y=2", "x=nan", "x=inf", "x=50%%", "x==1"])
def test_what_is_no_plane(text):
    with pytest.raises(InputError, match="is no plane such as"):
        check_plane(text)


@pytest.mark.parametrize("text", ["x=1.5", "x=-0.1", "x=101%", "x=-1%"])
def test_a_plane_outside_says_the_range(text):
    with pytest.raises(InputError, match="lies outside: x goes from 0 to 1, 0% to 100%"):
        find_plane(text, np.array([[0.0, 9.0, 9.0], [1.0, 9.5, 9.0]]))
