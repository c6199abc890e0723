"""Pictures of nets: what is in a pixel is what is in the net."""

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from mpl_toolkits.mplot3d import proj3d

import tetrabench
from tests.meshes import apart, flat, mesh_of
from tetrabench.errors import InputError
from tetrabench.mesh.cut import cut_mesh, find_plane
from tetrabench.mesh.models import generate
from tetrabench.mesh.surface import find_surface
from tetrabench.report.picture import AZIMUTH, DARKEST, ELEVATION, FEW, PLAIN, draw_net, save_picture

BOX = generate("box", 6)
VIRIDIS = np.asarray(colormaps["viridis"](np.linspace(0, 1, 6)))[:, :3]


def pixels(figure, dpi=100):
    """What is seen, (height, width, 3) from 0 to 1, rows upwards as in data coordinates."""
    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[::-1, :, :3] / 255


def at(image, axes, places):
    """The colours at places (k, 2) in data coordinates of flat axes."""
    columns, rows = np.floor(axes.transData.transform(places)).astype(int).T
    return image[rows, columns]


def in_space(axes, places):
    """Places (k, 3) of axes in space, as data coordinates of the picture (k, 2)."""
    x, y, _ = proj3d.proj_transform(*places.T, axes.get_proj())
    return np.column_stack([x, y])


def state_of(mesh):
    return mesh.points[mesh.tets].mean(axis=1) @ [1.0, 2.0, 3.0]


# ---------------------------------------------------------------------- cuts


@pytest.mark.parametrize("cut", ["z=20%", "x=0.7", "y=35%"])
def test_each_polygon_has_the_colour_of_its_tetra(cut):
    figure = draw_net(BOX, np.arange(6.0), cut)
    image, axes = pixels(figure), figure.axes[0]
    plane = find_plane(cut, BOX.points)
    polygons = cut_mesh(BOX.points, BOX.tets, plane.normal, plane.value)
    assert len(polygons.tetras) == 6
    others = [axis for axis in range(3) if axis != plane.axis]
    a, b, c, d = polygons.corners[..., others].transpose(1, 0, 2)
    middles = np.where(polygons.areas[:, None] > 0, (a + b + c + d) / 4, np.nan)
    np.testing.assert_allclose(at(image, axes, middles), VIRIDIS[polygons.tetras], atol=0.01)
    assert (axes.get_xlabel(), axes.get_ylabel()) == tuple("xyz"[axis] for axis in others)


@pytest.mark.parametrize("tets", [2_000, 60_000])
def test_only_the_net_is_coloured(tets):
    mesh = generate("nozzle", tets)
    figure = draw_net(mesh, state_of(mesh), "y=50%")
    image, axes = pixels(figure), figure.axes[0]
    outside = at(image, axes, [[0.08, 0.08], [-0.08, 0.08], [0.06, 0.07]])
    assert (outside == 1).all()
    inside = at(image, axes, np.column_stack([np.linspace(-0.045, 0.045, 50), np.full(50, 0.081)]))
    assert (inside.max(axis=1) - inside.min(axis=1) > 0.1).mean() > 0.8  # coloured, but for edges


@pytest.mark.parametrize("stretch", [[1, 1, 1], [1, 1, 40], [1, 40, 1]])
def test_a_cut_is_as_wide_and_as_high_as_it_is(stretch):
    figure = draw_net((BOX.points * stretch, BOX.tets), cut="x=50%")
    pixels(figure)
    transform = figure.axes[0].transData.transform
    across, up = transform([[1.0, 0.0]]) - transform([[0.0, 0.0]]), transform([[0.0, 1.0]]) - transform([[0.0, 0.0]])
    assert np.linalg.norm(across) == pytest.approx(np.linalg.norm(up))


def test_the_inset_shows_where_the_cut_lies():
    figure = draw_net(BOX, np.arange(6.0), "z=20%")
    inset = next(axes for axes in figure.axes[1:] if axes.name == "3d")
    image = pixels(figure)
    places = np.array([[0.5, 0.9, 0.2], [0.9, 0.5, 0.2], [0.5, 0.5, 1.0]])
    cut_1, cut_2, top = at(image, inset, in_space(inset, places))
    assert min(np.ptp(cut_1), np.ptp(cut_2)) > 0.1
    assert np.ptp(top) < 0.05  # grey
    assert top.max() < 0.99  # but there


# ---------------------------------------------------------------------- surfaces


def test_each_triangle_that_faces_the_eye_has_the_colour_of_its_tetra():
    figure = draw_net(BOX, np.arange(6.0))
    image, axes = pixels(figure), figure.axes[0]
    surface = find_surface(BOX.points, BOX.tets)
    corners = BOX.points[surface.triangles]
    middles = corners.mean(axis=1)
    facing = ((middles == 1) & [True, False, True]).any(axis=1) | (middles[:, 1] == 0)
    assert facing.sum() == 6
    colours = at(image, axes, in_space(axes, middles[facing]))
    shares = colours / VIRIDIS[surface.tetras[facing]]
    np.testing.assert_allclose(shares, np.repeat(shares[:, :1], 3, axis=1), atol=0.05)
    assert DARKEST - 0.02 < shares.min() < shares.max() < 1.02
    assert shares[middles[facing][:, 2] == 1].min() > shares[middles[facing][:, 0] == 1].max()  # the light is above
    assert len(axes.collections[0].get_facecolor()) == 6


def test_what_is_behind_is_covered():
    """Two boxes in one line of sight: the nearer one is all that is seen, whichever comes first in the net."""
    elevation, azimuth = np.radians(ELEVATION), np.radians(AZIMUTH)
    eye = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    tets = np.concatenate([BOX.tets, BOX.tets + 8])
    for near, nets in ((0, [BOX.points, BOX.points - 3 * eye]), (1, [BOX.points - 3 * eye, BOX.points])):
        points = np.concatenate(nets)
        figure = draw_net((points, tets), np.repeat([0.0, 1.0], 6))
        image, axes = pixels(figure), figure.axes[0]
        middle = axes.transData.transform(in_space(axes, points)).mean(axis=0).astype(int)
        seen = image[middle[1] - 40 : middle[1] + 40, middle[0] - 40 : middle[0] + 40].reshape(-1, 3)
        violet, yellow = seen[:, 2] > seen[:, 1] + 0.05, seen[:, 1] > seen[:, 2] + 0.05
        assert (violet.any(), yellow.any()) == (near == 0, near == 1)


def test_one_unit_is_as_long_on_each_axis():
    mesh = mesh_of(BOX.points * [1, 2, 5], BOX.tets)
    figure = draw_net(mesh)
    pixels(figure)
    axes = figure.axes[0]
    unit = axes.transData.transform(in_space(axes, np.vstack([np.zeros(3), np.eye(3)])))
    lengths = np.linalg.norm(unit[1:] - unit[0], axis=1)
    elevation, azimuth = np.radians(ELEVATION), np.radians(AZIMUTH)
    expected = [
        np.hypot(np.sin(azimuth), np.sin(elevation) * np.cos(azimuth)),
        np.hypot(np.cos(azimuth), np.sin(elevation) * np.sin(azimuth)),
        np.cos(elevation),
    ]
    np.testing.assert_allclose(lengths / lengths[2], np.array(expected) / expected[2], rtol=1e-6)


# ---------------------------------------------------------------------- colours


def test_values_beyond_the_limits_get_the_colour_of_the_limit():
    values = np.array([-9.0, 9.0, 0.0, 1.0, -np.inf, np.inf])
    figure = draw_net(BOX, values, "z=20%", limits=(0.0, 1.0))
    plane = find_plane("z=20%", BOX.points)
    polygons = cut_mesh(BOX.points, BOX.tets, plane.normal, plane.value)
    shown = at(pixels(figure), figure.axes[0], polygons.corners[..., :2].mean(axis=1))
    ends = VIRIDIS[[0, 5, 0, 5, 0, 5]]
    np.testing.assert_allclose(shown, ends[polygons.tetras], atol=0.01)


@pytest.mark.parametrize(
    ("values", "extend"),
    [([0, 1], "neither"), ([-1, 1], "min"), ([0, 2], "max"), ([-1, 2], "both"), ([0, np.nan], "neither")],
)
def test_the_colour_bar_points_to_what_is_beyond(monkeypatch, values, extend):
    said = []
    monkeypatch.setattr(
        "matplotlib.figure.Figure.colorbar", lambda figure, *words, **how: said.append(how) or FakeBar()
    )
    draw_net(BOX, np.resize(values, 6), limits=(0.0, 1.0))
    assert said[0]["extend"] == extend


class FakeBar:
    """A colour bar that is not drawn."""

    class outline:  # noqa: N801
        set_visible = staticmethod(lambda shown: None)

    def set_label(self, label, parse_math):
        assert parse_math is False


def test_the_scale_is_that_of_all_tetras_wherever_the_cut_is():
    mesh = generate("box", 3000)
    for cut in (None, "z=90%"):
        figure = draw_net(mesh, state_of(mesh), cut, label="heat")
        pixels(figure)
        bar = next(axes for axes in figure.axes if "heat" in (axes.get_xlabel(), axes.get_ylabel()))
        ends = bar.get_xlim() if cut else bar.get_ylim()
        assert ends == pytest.approx((state_of(mesh).min(), state_of(mesh).max()))


def test_nan_is_grey():
    figure = draw_net(BOX, [0.0, 1.0, np.nan, np.nan, np.nan, np.nan], "z=20%")
    plane = find_plane("z=20%", BOX.points)
    polygons = cut_mesh(BOX.points, BOX.tets, plane.normal, plane.value)
    shown = at(pixels(figure), figure.axes[0], polygons.corners[..., :2].mean(axis=1))
    assert ((np.ptp(shown, axis=1) == 0) == (polygons.tetras > 1)).all()
    assert shown[polygons.tetras > 1].max() < 0.9


def test_without_values_all_look_alike_and_there_is_no_bar():
    figure = draw_net(BOX, cut="z=20%")
    assert [axes.name for axes in figure.axes] == ["rectilinear", "3d"]
    shown = at(pixels(figure), figure.axes[0], [[0.5, 0.9], [0.9, 0.1]])
    np.testing.assert_allclose(shown, [PLAIN[:3]] * 2, atol=0.01)
    assert len(draw_net(BOX).axes) == 1


@pytest.mark.parametrize("cut", [None, "x=10%"])
@pytest.mark.parametrize("values", [None, 0.0, 1e300, np.nan])
def test_whatever_can_be_a_mesh_can_be_drawn(small_mesh, cut, values):
    numbers = None if values is None else np.full(len(small_mesh.tets), values)
    image = pixels(draw_net(small_mesh, numbers, cut))
    assert (image[100:-100, 100:-300] < 0.99).any()


def test_a_net_in_a_plane_and_one_in_a_point():
    plane = mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]])
    point = mesh_of(np.full((4, 3), 7.0), [[0, 1, 2, 3]])
    for mesh in (plane, point, flat()):
        assert pixels(draw_net(mesh, np.zeros(len(mesh.tets)))).min() < 0.5


# ---------------------------------------------------------------------- what is drawn, and how much of it


def test_nets_meshes_and_arrays_are_drawn_alike():
    mesh = generate("nozzle", 500)
    net = tetrabench.open(mesh)
    images = [pixels(draw_net(one, state_of(mesh), "z=40%")) for one in (net, mesh, (mesh.points, mesh.tets.tolist()))]
    assert (images[0] == images[1]).all()
    assert (images[0] == images[2]).all()
    net.delete(net.last)
    assert (pixels(draw_net(net, net.volumes)) < 0.99).any()


def test_formats_of_lines_carry_many_shapes_as_an_image(tmp_path):
    sizes = {}
    for tets in (2_000, 400_000):
        mesh = generate("nozzle", tets)
        for cut in (None, "y=50%"):
            figure = draw_net(mesh, state_of(mesh), cut)
            shapes = next(c for c in figure.axes[0].collections if isinstance(c, PolyCollection))
            many = len(shapes.get_facecolor()) > FEW
            assert many == (tets == 400_000)
            assert bool(shapes.get_rasterized()) == many
            save_picture(figure, tmp_path / "a.svg")
            sizes[tets, cut] = (tmp_path / "a.svg").stat().st_size
    assert max(sizes.values()) < 1_500_000


def test_formulas_in_names_are_words(tmp_path):
    title, label = r"a$\frac{$.nas", r"$\sqrt{$"
    figure = draw_net(BOX, np.arange(6.0), "z=20%", title=title, label=label)
    assert title in figure.texts[0].get_text()
    assert figure.texts[0].get_text().endswith("cut at z = 0.2")
    for suffix in (".png", ".svg", ".pdf"):
        save_picture(figure, tmp_path / f"a{suffix}")
    assert "sqrt" in (tmp_path / "a.svg").read_text()


# ---------------------------------------------------------------------- refusals


def test_a_plane_between_two_parts_is_refused():
    with pytest.raises(InputError, match=r"the plane x = 3 meets no tetra"):
        draw_net(apart(), cut="x=50%")


def test_a_point_that_no_tetra_uses_is_no_part_of_the_extent():
    with pytest.raises(InputError, match="x goes from 0 to 6"):
        draw_net(apart(), cut="x=8")


@pytest.mark.parametrize(
    ("words", "options", "reason"),
    [
        ([(BOX.points, np.empty((0, 4), int))], {}, "there is no tetra to draw"),
        ([(BOX.points[:, :2], BOX.tets)], {}, "points are numbers of the shape"),
        ([(BOX.points[:3], BOX.tets)], {}, "tets have vertices from 0 to 2"),
        ([BOX, [1.0, 2.0]], {}, "one value for each of 6 tetras is needed"),
        ([BOX, np.ones((6, 5))], {}, r"one value for each of 6 tetras is needed, not \(6, 5\)"),
        ([BOX, np.ones(6)], {"limits": (1.0, 0.0)}, "limits are a lower and a higher value"),
        ([BOX, np.ones(6)], {"limits": (np.nan, 0.0)}, "limits are a lower and a higher value"),
        ([BOX, np.ones(6), "x"], {}, "is no plane such as"),
    ],
)
def test_what_cannot_be_drawn(words, options, reason):
    with pytest.raises(InputError, match=reason):
        draw_net(*words, **options)


def test_a_picture_that_cannot_be_written(tmp_path):
    with pytest.raises(InputError, match=r"a\.png: cannot be written: "):
        save_picture(draw_net(BOX), tmp_path / "nowhere" / "a.png")
