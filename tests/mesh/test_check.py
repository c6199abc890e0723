"""What no net may hold is refused or left out, and nothing else: against a naive twin."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes import mesh_of, single
from tetrabench.errors import InputError, RepairableError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.check import PLACES, REASONS, check_mesh, has_crowd, is_suspect, settle

CORNER = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def where(kind: str, row: int) -> str:
    return f"deck.nas:{row + 10}: {kind} {row + 1}"


def cloud(tets: object) -> TetraMesh:
    """Tetras over eight points in general position."""
    return mesh_of(np.random.default_rng(1).uniform(size=(8, 3)), tets)


# ---------------------------------------------------------------------- check_mesh


def test_sound_meshes_pass(small_mesh: TetraMesh) -> None:
    check_mesh(small_mesh)
    small_mesh.tets = np.asfortranarray(small_mesh.tets).astype(np.int64)
    small_mesh.points.flags.writeable = False
    check_mesh(small_mesh)


FAULTS = {
    "index too large": (
        "tets",
        [[0, 1, 2, 4]],
        r"tetra 1 \(row 0\) has the vertices 0 1 2 4, .* from 0 to 3",
    ),
    "index negative": ("tets", [[0, -1, 2, 3]], "has the vertices 0 -1 2 3"),
    "index beyond int32": ("tets", [[0, 1, 2, 2**32 + 3]], "has the vertices 0 1 2 4294967299"),
    "vertex twice": ("tets", [[0, 1, 2, 0]], r"tetra 1 \(row 0\) repeats a node$"),
    "NaN": (
        "points",
        np.where(np.eye(4, 3, -3), np.nan, 0),
        r"point 4 \(row 3\) has a coordinate that is NaN",
    ),
    "infinite": ("points", np.full((4, 3), np.inf), r"point 1 \(row 0\) has a coordinate"),
    "real indices": ("tets", [[0.0, 1.0, 2.0, 3.0]], "tets must be integers"),
    "triangles": ("tets", [[0, 1, 2]], r"integers of shape \(m, 4\), not int64 \(1, 3\)"),
    "points in the plane": ("points", np.zeros((4, 2)), r"points must be numbers of shape \(n, 3\)"),
    "ids missing": ("tet_ids", [], "one number for each"),
}


@pytest.mark.parametrize(("attribute", "value", "reason"), FAULTS.values(), ids=FAULTS.keys())
def test_fault_is_named(attribute: str, value: object, reason: str) -> None:
    mesh = single()
    setattr(mesh, attribute, np.array(value))
    with pytest.raises(InputError, match=f"^mesh: .*{reason}"):
        check_mesh(mesh)


@pytest.mark.parametrize(
    ("tets", "reason"),
    [
        ([[0, 1, 2, 3], [2, 3, 0, 1]], r"tetra 2 \(row 1\) has the same four nodes as an earlier one"),
        ([[0, 1, 2, 3], [4, 1, 2, 3], [2, 3, 0, 1]], r"tetra 3 \(row 2\) has the same four nodes as an earlier one"),
        ([[0, 1, 2, 3], [1, 2, 3, 4], [5, 3, 2, 1]], r"tetra 3 \(row 2\) shares a side with two earlier ones"),
    ],
)
def test_fault_between_tetras_is_named(tets: list[list[int]], reason: str) -> None:
    with pytest.raises(InputError, match=f"^mesh: {reason}$"):
        check_mesh(cloud(tets))


# ---------------------------------------------------------------------- settle


def naive_faults(rows: list[list[int]]) -> dict[str, list[int]]:
    """Rows by reason, in plain Python."""
    faults: dict[str, list[int]] = {reason: [] for reason in REASONS}
    seen, sharers = set(), {}
    for row, four in enumerate(rows):
        if len(set(four)) < 4:
            faults["repeated node"].append(row)
        elif frozenset(four) in seen:
            faults["duplicate"].append(row)
        else:
            seen.add(frozenset(four))
            for node in four:
                sharers.setdefault(frozenset(four) - {node}, []).append(row)
    faults["crowded side"] = sorted({row for those in sharers.values() for row in those[2:]})
    return {reason: found for reason, found in faults.items() if found}


@given(st.lists(st.lists(st.integers(0, 7), min_size=4, max_size=4), min_size=1, max_size=30))
def test_settle_finds_what_the_naive_twin_finds(rows: list[list[int]]) -> None:
    mesh, faults = cloud(rows), naive_faults(rows)
    kept = sorted(set(range(len(rows))) - {row for found in faults.values() for row in found})
    if faults:
        reason, found = next(iter(faults.items()))
        with pytest.raises(RepairableError) as caught:
            settle(mesh, where=where)
        assert str(caught.value).startswith(f"deck.nas:{found[0] + 10}: tetra {found[0] + 1} {REASONS[reason]}")
    if not kept:
        with pytest.raises(InputError, match="no tetra is left"):
            settle(mesh, where=where, repair="drop")
        return
    settled = settle(mesh, where=where, repair="drop", unused="keep")
    assert settled.report.dropped == {reason: len(found) for reason, found in faults.items()}
    assert len(settled.report.warnings) == (1 if faults else 0)
    assert settled.tet_ids.tolist() == [row + 1 for row in kept]
    assert settled.tets.tolist() == [rows[row] for row in kept]
    check_mesh(settled)
    if not faults:
        np.testing.assert_array_equal(settle(mesh, where=where).tet_ids, settled.tet_ids)


MESSAGES = {
    "one": (
        [[0, 1, 2, 3], [0, 0, 1, 2]],
        "deck.nas:11: tetra 2 repeats a node; convert --repair drop leaves it out",
    ),
    "two": (
        [[0, 0, 1, 2], [0, 1, 2, 3], [1, 1, 1, 2]],
        "deck.nas:10: tetra 1 repeats a node; so does 3; convert --repair drop leaves them out",
    ),
    "many": (
        [[0, 1, 2, 3], *[[4, 4, 5, 6]] * 7],
        "deck.nas:11: tetra 2 repeats a node; so do 3, 4 and 4 others; convert --repair drop leaves them out",
    ),
    "four": (
        [[0, 1, 2, 3], *[[4, 4, 5, 6]] * 4],
        "deck.nas:11: tetra 2 repeats a node; so do 3, 4 and 1 other; convert --repair drop leaves them out",
    ),
    "of several kinds": (
        [[0, 1, 2, 3], [1, 2, 3, 4], [1, 2, 3, 5], [3, 2, 1, 0], [3, 1, 0, 2], [7, 7, 7, 7]],
        "deck.nas:15: tetra 6 repeats a node; also: 2 duplicate, 1 crowded side; convert --repair drop leaves them out",
    ),
}


@pytest.mark.parametrize(("tets", "message"), MESSAGES.values(), ids=MESSAGES.keys())
def test_refusal_is_one_line_with_the_first_and_some_others(tets: list[list[int]], message: str) -> None:
    with pytest.raises(RepairableError) as caught:
        settle(cloud(tets), where=where)
    assert str(caught.value) == message
    settled = settle(cloud(tets), where=where, repair="drop")
    assert settled.report.warnings == [message.partition("; convert --repair")[0] + "; left out"]


def test_what_nobody_can_mend_is_refused_with_its_place() -> None:
    for options in ({}, {"repair": "drop"}):
        with pytest.raises(InputError, match=r"^deck\.nas:11: tetra 2 has the vertices 0 1 2 9, but") as caught:
            settle(cloud([[0, 1, 2, 3], [0, 1, 2, 9]]), where=where, **options)
        assert not isinstance(caught.value, RepairableError)
        mesh = cloud([[0, 1, 2, 3]])
        mesh.points[6, 2] = np.nan
        with pytest.raises(InputError, match=r"^deck\.nas:16: point 7 has a coordinate that is NaN or infinite$"):
            settle(mesh, where=where, **options)


def test_unknown_choices_are_refused() -> None:
    with pytest.raises(InputError, match="'drop' or 'keep', not 'both'"):
        settle(single(), where=where, unused="both")
    with pytest.raises(InputError, match="'refuse' or 'drop', not 'mend'"):
        settle(single(), where=where, repair="mend")


def test_unused_points_are_dropped_or_kept_and_counted() -> None:
    mesh = mesh_of([[9, 9, 9], *CORNER, [8, 8, 8]], [[4, 3, 1, 2]])
    dropped, kept = settle(mesh, where=where), settle(mesh, where=where, unused="keep")
    assert dropped.report.unreferenced == kept.report.unreferenced == 2
    assert dropped.point_ids.tolist() == [2, 3, 4, 5]
    assert dropped.points.tolist() == CORNER
    assert dropped.tets.tolist() == [[3, 2, 0, 1]]
    assert kept.point_ids.tolist() == [1, 2, 3, 4, 5, 6]
    assert kept.tets.tolist() == [[4, 3, 1, 2]]
    assert mesh.report.unreferenced == 0  # the report of the raw mesh is not touched


def test_points_of_dropped_tetras_alone_are_unused() -> None:
    settled = settle(cloud([[0, 1, 2, 3], [4, 4, 5, 6]]), where=where, repair="drop")
    assert settled.report.unreferenced == 4
    assert len(settled.points) == 4


def test_inside_out_and_flat_tetras_are_kept_as_they_are_and_counted() -> None:
    mesh = mesh_of([*CORNER, [1, 1, 0]], [[0, 1, 2, 3], [1, 2, 4, 0], [1, 2, 4, 3]])
    settled = settle(mesh, where=where)
    assert (settled.report.inverted, settled.report.degenerate) == (1, 1)
    np.testing.assert_array_equal(settled.tets, mesh.tets)


def test_settled_arrays_are_what_a_mesh_holds() -> None:
    mesh = cloud([[0, 1, 2, 3]])
    mesh = replace(mesh, points=np.asfortranarray(mesh.points).astype(np.float32), tets=mesh.tets.astype(np.uint64))
    settled = settle(mesh, where=where)
    assert (settled.points.dtype, settled.tets.dtype) == (np.float64, np.int32)
    assert settled.points.flags.c_contiguous
    assert settled.tets.flags.c_contiguous


# ---------------------------------------------------------------------- the filter


def test_sound_meshes_are_not_suspect(small_mesh: TetraMesh) -> None:
    assert not is_suspect(small_mesh.tets, len(small_mesh.points))


@pytest.mark.parametrize("spoil", ["duplicate", "crowded side", None])
def test_filter_holds_where_all_tetras_share_a_vertex(spoil: str | None) -> None:
    count = 300
    ring = np.arange(1, count + 1)
    tets = np.column_stack([np.zeros_like(ring), ring, np.roll(ring, -1), np.full_like(ring, count + 1)])
    if spoil == "duplicate":
        tets = np.concatenate([tets, tets[-1:, ::-1]])
    elif spoil:
        tets = np.concatenate([tets, tets[:1]])
        tets[-1, 1] = count + 2
        tets = np.concatenate([tets, tets[:1]])
        tets[-1, 1] = count + 3
    assert is_suspect(tets.astype(np.int32), count + 4) == (spoil is not None)


CROWDS: dict[str, tuple[list[int], bool]] = {
    "a side twice": ([4, 4], False),
    "a side three times": ([4, 6, 4, 4], True),
    "a tetra": ([5, 7], False),
    "a tetra twice": ([5, 7, 5], True),
    "unlike sides in one place": ([2 * PLACES * k for k in range(5)], False),
    "tetras and sides in one place": ([2 * PLACES * k + k % 2 for k in range(5)], False),
    "alike among unlike in one place": ([2, 2 + 2 * PLACES, 2, 2 + 2 * PLACES, 2], True),
}


@pytest.mark.parametrize(("hashes", "crowded"), CROWDS.values(), ids=CROWDS.keys())
def test_crowds_are_told_from_chance(hashes: list[int], crowded: bool) -> None:
    bucket = np.array([8, 8, *hashes, 8, 8], np.int32)
    assert has_crowd(bucket, np.array([0, 2, len(bucket) - 2, len(bucket), len(bucket)])) == crowded


def test_filter_may_err_on_the_side_of_suspicion(monkeypatch: pytest.MonkeyPatch) -> None:
    always: Callable[..., bool] = lambda tets, points: True  # noqa: E731
    monkeypatch.setattr("tetrabench.mesh.check.is_suspect", always)
    check_mesh(single())
