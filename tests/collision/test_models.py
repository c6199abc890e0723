"""Models of objects: as many as wanted, as their titles say, the same bits for the same seed."""

import math
import re

import numpy as np
import pytest
from scipy.spatial import cKDTree

from tetrabench.collision.objects import Objects, Start, check_objects
from tetrabench.collision.start.models import MODELS, MOST_OBJECTS, ROOM, generate_objects
from tetrabench.collision.start.numbering import NUMBERINGS, renumber_objects
from tetrabench.collision.start.sweep import sweep
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh.hilbert import hilbert_keys


def bits(start: Start) -> tuple[bytes, ...]:
    """All of the objects."""
    return tuple(column.tobytes() for column in start.objects)


def rows(start: Start) -> list[tuple[float, ...]]:
    """The objects in no order."""
    return sorted(zip(*(column.tolist() for column in start.objects), strict=True))


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("count", [0, 1, 2, 3, 250])
def test_models_are_sound(name: str, count: int) -> None:
    start = generate_objects(name, count, seed=1)
    check_objects(start.objects)
    for column in start.objects:
        assert (column.shape, column.dtype, column.flags.c_contiguous) == ((count,), np.float64, True)
    assert start.width == start.height == math.sqrt(ROOM * max(count, 1))
    x, y, vx, vy, r, m = start.objects
    for places in (x, y):
        assert ((places >= 0) & (places <= start.width)).all()
    for velocities in (vx, vy):
        assert set(velocities.tolist()) <= {-2.5 + 0.5 * k for k in range(10)}
    assert (m == 5 * r * r / 100).all()
    assert start.source.startswith(f"{name}: {count} objects, {MODELS[name].title}, in a box of ")


def test_what_the_titles_say() -> None:
    uniform, clustered, halo, mixed, separated = (generate_objects(name, 2000).objects for name in MODELS)
    side = math.sqrt(ROOM * 2000)
    for objects in (uniform, clustered, halo, separated):
        assert set(objects.r.tolist()) == {10}
        assert set(objects.m.tolist()) == {5}
    for column in (clustered.x, clustered.y):
        assert abs(column - side / 2).max() <= 0.05 * side
        assert abs(column - side / 2).max() > 0.049 * side
    inside = (abs(halo.x - side / 2) <= 0.05 * side) & (abs(halo.y - side / 2) <= 0.05 * side)
    assert 0 < np.count_nonzero(~inside) <= 20
    assert sorted(mixed.r.tolist()) == [7.0] * 1980 + [70.0] * 20
    assert set(mixed.m.tolist()) == {2.45, 245.0}
    assert np.sum(mixed.r**2) == pytest.approx(np.sum(uniform.r**2), rel=0.03)
    assert len(np.unique(np.flatnonzero(mixed.r == 70) // 200)) > 5  # not the first ones
    assert sweep(separated.x, separated.y, separated.r)[0] == 0
    assert sweep(uniform.x, uniform.y, uniform.r)[0] > 20


@pytest.mark.parametrize("name", ["uniform", "mixed", "separated"])
def test_places_are_irregular_and_everywhere(name: str) -> None:
    """Each of 16 parts of the box has its share, and distances to the nearest one are those of chance, but for the least."""
    start = generate_objects(name, 3200, seed=2)
    x, y = start.objects.x, start.objects.y
    counts, _, _ = np.histogram2d(x, y, bins=4, range=[[0, start.width]] * 2)
    assert counts.min() > 140
    assert counts.max() < 260
    assert counts.std() > 6
    nearest = cKDTree(np.column_stack([x, y])).query(np.column_stack([x, y]), k=2)[0][:, 1]
    assert nearest.mean() == pytest.approx(math.sqrt(ROOM) / 2, rel=0.07)
    assert nearest.std() == pytest.approx(math.sqrt(ROOM * (4 - math.pi) / (4 * math.pi)), rel=0.12)


def test_all_velocities_occur() -> None:
    objects = generate_objects("uniform", 1000).objects
    pairs = set(zip(objects.vx.tolist(), objects.vy.tolist(), strict=True))
    assert len(pairs) == 100
    assert (min(objects.vx), max(objects.vx)) == (-2.5, 2.0)


@pytest.mark.parametrize("name", MODELS)
def test_same_seed_same_bits(name: str) -> None:
    for numbering in NUMBERINGS:
        one, same, other = (generate_objects(name, 60, numbering=numbering, seed=seed) for seed in (3, 3, 4))
        assert bits(one) == bits(same)
        assert bits(one) != bits(other)
        assert one.source == same.source


def test_the_default_is_in_the_table() -> None:
    assert len(generate_objects("uniform").objects.x) == MODELS["uniform"].objects == 100_000


def test_numberings_change_the_order_and_nothing_else() -> None:
    start = generate_objects("mixed", 200, seed=5)
    assert renumber_objects(start, "natural") is start
    shuffled = renumber_objects(start, "shuffled", seed=2)
    curve = renumber_objects(shuffled, "hilbert")
    assert rows(start) == rows(shuffled) == rows(curve)
    assert len({bits(start), bits(shuffled), bits(curve)}) == 3
    assert bits(curve) == bits(generate_objects("mixed", 200, numbering="hilbert", seed=5))
    assert shuffled.source == f"{start.source}, shuffled numbering (seed 2)"
    assert curve.source == f"{shuffled.source}, hilbert numbering"
    assert bits(renumber_objects(start, "shuffled", seed=3)) != bits(shuffled)
    keys = hilbert_keys(np.column_stack([curve.objects.x, curve.objects.y, np.zeros(200)]))
    assert (np.diff(keys.astype(np.int64)) >= 0).all()
    for column in curve.objects:
        assert column.flags.c_contiguous


def test_refusals(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        InputError,
        match=r"^no model 'unifrm'; did you mean 'uniform'\? there are: uniform, clustered, halo, mixed, separated$",
    ):
        generate_objects("unifrm")
    for count in (-1, MOST_OBJECTS + 1):
        with pytest.raises(
            InputError, match=re.escape(f"a model of {count:,} objects cannot be made; ask for 0 to 2,14")
        ):
            generate_objects("uniform", count)
    start = Start(Objects(*[np.ones(3)] * 6), 1.0, 1.0)
    for call in (
        lambda name: generate_objects("uniform", 3, numbering=name),
        lambda name: renumber_objects(start, name),
    ):
        with pytest.raises(InputError, match=r"^objects have no graph, .*; number them natural, shuffled, hilbert$"):
            call("rcm")
        with pytest.raises(InputError, match=r"^no numbering 'random'; there are: natural, shuffled, hilbert$"):
            call("random")
    with pytest.raises(InputError, match=r"^a seed is 0 or more, not -1$"):
        generate_objects("uniform", 3, seed=-1)
    with pytest.raises(InputError, match=r"^a seed is 0 or more, not -1$"):
        renumber_objects(start, "shuffled", -1)
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 10**6)
    with pytest.raises(MemoryRefusedError, match=r"^a model of 10,000 objects needs about 1.5 MiB of memory, "):
        generate_objects("separated", 10_000)
