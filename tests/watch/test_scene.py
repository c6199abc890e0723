"""What is drawn: places and contacts against naive twins, leaves that divide the box, views there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.watch.made import SIDE, make_start, naive_contacts
from tetrabench.backends.collision import STRUCTURES
from tetrabench.collision.objects import Start, make_objects
from tetrabench.collision.simulation import Simulation
from tetrabench.watch.opening import with_option
from tetrabench.watch.scene import (
    LEAST_LEAF,
    LEAST_RADIUS,
    LONGEST_SIDE,
    View,
    bar_height,
    clipped,
    make_scene,
    picture_size,
    to_pixels,
    whole_view,
)

LINES = ("some", "words")


def scene_of(simulation, view=None, **words):
    view = view or whole_view(simulation.start, *picture_size(simulation.start, 2), 2)
    return make_scene(simulation, view, simulation.find_pairs(), LINES, **words), view


@pytest.mark.parametrize("backend", ["kdtree", "grid", "brute", "ckdtree"])
def test_objects_and_contacts_are_those_of_a_naive_twin(rng: np.random.Generator, backend: str) -> None:
    simulation = Simulation(make_start(rng, 50), STRUCTURES[backend], gravity=0.1, bounce=0.5)
    for _ in range(3):
        simulation.step(4)
        scene, view = scene_of(simulation)
        x, y, _, _, r, _ = simulation.objects
        contacts = naive_contacts(simulation.objects)
        assert contacts
        touching = {number for pair in contacts for number in pair}
        drawn = sorted(zip(*scene.places.T, scene.radii, scene.in_contact, strict=True))
        assert drawn == sorted(
            (
                view.width / 2 + (x[i] - view.x) * view.scale,
                view.height / 2 - (y[i] - view.y) * view.scale,
                max(r[i] * view.scale, LEAST_RADIUS),
                i in touching,
            )
            for i in range(50)
        )
        order = scene.in_contact.tolist()
        assert order == sorted(order)  # so that none in contact is hidden by one that is not
        assert scene.lines == LINES


def test_a_structure_that_misses_contacts_shows_that_it_does(rng: np.random.Generator) -> None:
    start = make_start(rng, 120)
    seen = {}
    for name in ("kdtree", "leaf-only"):
        scene, _ = scene_of(Simulation(start, STRUCTURES[name]))
        seen[name] = {tuple(place) for place in scene.places[scene.in_contact].tolist()}
    assert seen["leaf-only"] < seen["kdtree"]


def test_leaves_of_a_tree_divide_the_box(rng: np.random.Generator) -> None:
    """Rounded alike on both sides of a border, they leave no gap and overlap nowhere."""
    simulation = Simulation(make_start(rng, 60), with_option(STRUCTURES["kdtree"], "capacity", 8))
    scene, view = scene_of(simulation)
    width, height = np.rint(scene.box[2:]) - np.rint(scene.box[:2])
    covered = np.zeros((view.width, view.height), np.int64)
    for left, top, right, bottom in scene.leaves.astype(int):
        covered[left:right, top:bottom] += 1
    assert len(scene.leaves) == simulation.stats()["leaves"] > 3
    assert covered.max() == 1
    assert covered.sum() == width * height
    assert len(scene_of(simulation, has_leaves=False)[0].leaves) == 0


def test_leaves_beside_the_box_or_the_picture_and_the_smallest_are_left_out() -> None:
    view = View(50.0, 50.0, 1.0, 100, 100)  # pixels are units
    box = np.array([20.0, 20.0, 300.0, 80.0])
    leaves = np.array(
        [
            [-np.inf, -np.inf, 40.4, np.inf],
            [40.4, 30.0, np.inf, 40.0],
            [0.0, 0.0, 19.0, 100.0],  # beside the box
            [150.0, 30.0, 170.0, 40.0],  # beside the picture
            [50.0, 50.0, 50.0 + LEAST_LEAF / 2, 60.0],  # too small
            [50.0, 50.0, 50.0 + LEAST_LEAF, 60.0],
        ]
    )
    assert clipped(leaves, box, view).tolist() == [[20, 20, 40, 80], [40, 30, 101, 40], [50, 50, 53, 60]]
    assert clipped(leaves, box + 500, view).shape == (0, 4)
    assert clipped(np.empty((0, 4)), box, view).shape == (0, 4)


def test_what_is_not_seen_is_not_drawn() -> None:
    objects = make_objects([50.0, 150.0, 109.0, 111.0, np.float64(50)], [50.0, 50.0, 50.0, 50.0, -70.0], r=10.0)
    simulation = Simulation(Start(objects, 100.0, 100.0), STRUCTURES["brute"])
    scene, _ = scene_of(simulation, View(50.0, 50.0, 1.0, 100, 100))
    assert sorted(scene.places.tolist()) == [[50.0, 50.0], [109.0, 50.0]]  # the second by its rim
    assert scene.in_contact.tolist() == [False, True]  # with one that is not seen
    simulation.objects.x[0] = np.nan
    assert scene_of(simulation, View(50.0, 50.0, 1.0, 100, 100))[0].places.tolist() == [[109.0, 50.0]]


@pytest.mark.parametrize("count", [0, 1])
def test_no_object_or_one(count: int) -> None:
    objects = make_objects([10.0] * count, [5.0] * count)
    for backend in STRUCTURES.values():
        scene, _ = scene_of(Simulation(Start(objects, 100.0, 50.0), backend))
        assert scene.places.shape == (count, 2)
        assert not scene.in_contact.any()


@pytest.mark.parametrize("sides", [(SIDE, SIDE), (10.0, 3000.0), (1e-3, 1e-4), (5e7, 1.0)])
@pytest.mark.parametrize("lines", [0, 2, 3])
def test_the_whole_box_lies_beneath_the_words(sides: tuple[float, float], lines: int) -> None:
    start = Start(make_objects([], []), *sides)
    width, height = picture_size(start, lines)
    assert (width % 2, height % 2) == (0, 0)  # a film takes no others
    assert max(width, height) < 1100
    left, top, right, bottom = to_pixels(np.array([[0.0, 0.0, *sides]]), whole_view(start, width, height, lines))[0]
    assert 0 < left < right < width
    assert bar_height(lines) < top < bottom < height
    assert max(right - left, bottom - top) > LONGEST_SIDE - 2
    np.testing.assert_allclose((right - left) / (bottom - top), sides[0] / sides[1], rtol=1e-6)


places = st.floats(-1e3, 1e3)


@given(places, places, st.floats(0.01, 100), st.floats(0.1, 10), st.floats(0, 800), st.floats(0, 600))
def test_zooming_keeps_what_is_under_the_mouse_and_shifting_takes_it_along(x, y, scale, factor, across, down) -> None:
    view = View(x, y, scale, 800, 600)
    under = np.array([x + (across - 400) / scale]), np.array([y - (down - 300) / scale])
    np.testing.assert_allclose([view.across(under[0]), view.down(under[1])], [[across], [down]], atol=1e-6)
    near = view.zoomed(factor, across, down)
    np.testing.assert_allclose([near.across(under[0]), near.down(under[1])], [[across], [down]], atol=1e-6)
    assert near.scale == scale * factor
    moved = view.shifted(7.0, -5.0)
    np.testing.assert_allclose(
        [moved.across(under[0]), moved.down(under[1])], [[across + 7], [down - 5]], rtol=1e-9, atol=1e-6
    )
