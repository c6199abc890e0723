"""Renumbering changes the order and nothing else; an order that follows the mesh brings neighbours together."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from tests.meshes import apart, mesh_of
from tetrabench.cli import main
from tetrabench.errors import InputError
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.hilbert import hilbert_keys
from tetrabench.mesh.models import generate
from tetrabench.mesh.numbering import NUMBERINGS, renumber

OTHERS = [name for name in NUMBERINGS if name != "natural"]


def contents(mesh: TetraMesh) -> tuple[dict[int, list[float]], dict[int, list[list[float]]]]:
    """The points by id, and the tetras by id as coordinates in their vertex order."""
    points = dict(zip(mesh.point_ids.tolist(), mesh.points.tolist(), strict=True))
    tets = dict(zip(mesh.tet_ids.tolist(), mesh.points[mesh.tets].tolist(), strict=True))
    return points, tets


def with_ids_of_a_file(mesh: TetraMesh) -> TetraMesh:
    """The mesh with ids in no order and with gaps."""
    random = np.random.default_rng(1)
    point_ids = random.permutation(9 * len(mesh.points))[: len(mesh.points)] + 1
    return replace(mesh, point_ids=point_ids, tet_ids=random.permutation(len(mesh.tets)) * 10 + 7)


def gaps(mesh: TetraMesh) -> np.ndarray:
    """How far the vertices of each tetra lie apart in the order of the points."""
    gaps: np.ndarray = np.ptp(mesh.tets, axis=1)
    return gaps


def strip(tets: int) -> TetraMesh:
    """Tetras in a row, each of four consecutive points: the bandwidth is 3, and cannot be less."""
    turns = np.arange(tets + 3)
    points = np.column_stack([np.cos(2.3 * turns), np.sin(2.3 * turns), 0.5 * turns])  # Boerdijk and Coxeter's helix
    return mesh_of(points, np.arange(tets)[:, None] + np.arange(4))


def test_natural_is_the_mesh_as_it_is(small_mesh: TetraMesh) -> None:
    assert renumber(small_mesh, "natural") is small_mesh


@pytest.mark.parametrize("numbering", OTHERS)
def test_points_and_tetras_are_the_same_with_their_ids_and_vertex_order(numbering: str, small_mesh: TetraMesh) -> None:
    mesh = with_ids_of_a_file(small_mesh)
    before = contents(mesh)
    renumbered = renumber(mesh, numbering, seed=5)
    assert contents(renumbered) == before == contents(mesh)
    assert (renumbered.points.dtype, renumbered.tets.dtype) == (np.float64, np.int32)
    assert (renumbered.point_ids.dtype, renumbered.tet_ids.dtype) == (np.int64, np.int64)
    assert renumbered.points.flags.c_contiguous
    assert renumbered.tets.flags.c_contiguous


@pytest.mark.parametrize("numbering", OTHERS)
def test_source_says_so_and_the_rest_of_the_report_stays(numbering: str, small_mesh: TetraMesh) -> None:
    small_mesh.report.inverted = 7
    report = renumber(small_mesh, numbering, seed=5).report
    end = "shuffled numbering (seed 5)" if numbering == "shuffled" else f"{numbering} numbering"
    assert report.source == f"{small_mesh.report.source}, {end}"
    assert report.inverted == 7


@pytest.mark.parametrize("numbering", NUMBERINGS)
def test_a_mesh_without_tetras_and_one_without_points(numbering: str) -> None:
    points = renumber(mesh_of([[0, 0, 0], [1, 0, 0]], []), numbering)
    assert (points.points.shape, points.tets.shape) == ((2, 3), (0, 4))
    nothing = renumber(mesh_of([], []), numbering)
    assert (nothing.points.shape, nothing.tets.shape) == ((0, 3), (0, 4))


def test_seed_decides_where_chance_does() -> None:
    mesh = mesh_of(np.arange(60).reshape(20, 3), np.arange(20).reshape(5, 4))
    one, same, other = (renumber(mesh, "shuffled", seed) for seed in (1, 1, 2))
    assert one.points.tolist() == same.points.tolist()
    assert one.tets.tolist() == same.tets.tolist()
    assert one.points.tolist() != other.points.tolist()
    assert one.points.tolist() != mesh.points.tolist()
    for numbering in ("hilbert", "rcm"):
        assert contents(renumber(mesh, numbering, 1)) == contents(renumber(mesh, numbering, 2))
        assert renumber(mesh, numbering, 1).tets.tolist() == renumber(mesh, numbering, 2).tets.tolist()


@pytest.mark.parametrize("numbering", ["hilbert", "rcm"])
def test_neighbours_come_together(numbering: str) -> None:
    shuffled = generate("box", 3000, numbering="shuffled")
    ordered = renumber(shuffled, numbering)
    assert gaps(ordered).mean() < gaps(shuffled).mean() / 4
    together = [
        np.linalg.norm(np.diff(mesh.points[mesh.tets].mean(axis=1), axis=0), axis=1).mean()
        for mesh in (shuffled, ordered)
    ]
    assert together[1] < together[0] / 2


def test_hilbert_goes_along_the_curve_with_points_and_with_centroids() -> None:
    mesh = generate("intake", 1000, numbering="hilbert")
    for places in (mesh.points, mesh.points[mesh.tets].mean(axis=1)):
        assert (np.diff(hilbert_keys(places).astype(np.int64)) > 0).all()


def test_rcm_lessens_the_bandwidth() -> None:
    for mesh in (generate("intake", 3000), generate("box", 3000)):
        shuffled = renumber(mesh, "shuffled")
        assert gaps(renumber(shuffled, "rcm")).max() <= gaps(mesh).max()  # layer by layer is near the best
        assert gaps(mesh).max() < gaps(shuffled).max() / 4


def test_rcm_finds_the_best_order_of_a_strip() -> None:
    mesh = renumber(renumber(strip(50), "shuffled"), "rcm")
    assert gaps(mesh).tolist() == [3] * 50


def test_rcm_numbers_tetras_by_their_points() -> None:
    mesh = generate("nozzle", 500, numbering="rcm")
    rows = np.sort(mesh.tets, axis=1).tolist()
    assert rows == sorted(rows)


def test_rcm_takes_one_component_after_the_other_and_unused_points_last() -> None:
    parts = [apart(), strip(5), apart()]
    firsts = np.cumsum([0] + [len(part.points) for part in parts])
    whole = mesh_of(
        np.concatenate([part.points + 20 * k for k, part in enumerate(parts)]),
        np.concatenate([part.tets + first for part, first in zip(parts, firsts, strict=False)]),
    )
    unused = sorted(set(range(len(whole.points))) - set(whole.tets.ravel().tolist()))
    assert len(unused) == 2
    for mesh in (renumber(whole, "rcm"), renumber(renumber(whole, "shuffled"), "rcm")):
        assert set(mesh.point_ids[-2:].tolist()) == {row + 1 for row in unused}
        assert gaps(mesh).max() == 3
    assert renumber(whole, "rcm").point_ids[-2:].tolist() == [row + 1 for row in unused]


@pytest.mark.parametrize("numbering", NUMBERINGS)
def test_a_seed_below_0_is_refused(numbering: str, small_mesh: TetraMesh) -> None:
    for function in (
        lambda: renumber(small_mesh, numbering, -1),
        lambda: generate("box", 6, numbering=numbering, seed=-1),
    ):
        with pytest.raises(InputError, match=r"^a seed is 0 or more, not -1$"):
            function()


def test_unknown_numbering(small_mesh: TetraMesh) -> None:
    there = ", ".join(NUMBERINGS)
    with pytest.raises(InputError, match=f"no numbering 'random'; there are: {there}"):
        renumber(small_mesh, "random")
    result = CliRunner().invoke(main, ["run", "--model", "box", "--numbering", "Hilbrt"])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"tetrabench: no numbering 'Hilbrt'; did you mean 'hilbert'? there are: {there}\n"


@pytest.mark.parametrize("verb", ["run", "generate"])
def test_help_names_the_numberings(verb: str) -> None:
    assert f"--numbering {'|'.join(NUMBERINGS)}\n" in CliRunner().invoke(main, [verb, "--help"]).stdout
