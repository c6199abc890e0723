"""The bench of peers: answers are compared before times, missing peers are said, no figure without what it needs."""

import json
import subprocess
import sys
from copy import deepcopy
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import bench_peers
import numpy as np
import pytest
from contests import ROWS, Case, misplaced
from examples import EXAMPLES
from peers import MODULES, MissingPeerError, load_peer

from tests.contest import line

SMALL = ["--tets", "600", "--queries", "100", "--turns", "6"]


def bench(*words, **more):
    script = Path(bench_peers.__file__)
    return subprocess.run([sys.executable, str(script), *words], capture_output=True, text=True, **more)


def test_all_rows_from_answers_to_json(tmp_path):
    """With whatever peers there are; on their own they may warn of things that are not ours."""
    result = tmp_path / "peers.json"
    done = bench(*SMALL, "-o", str(result))
    assert done.returncode == 0, done.stdout + done.stderr
    document = json.loads(result.read_text())
    assert {row["peer"] for row in document["rows"]} | set(document["missing"]) == {row.peer for row in ROWS + EXAMPLES}
    assert not {row["peer"] for row in document["rows"]} & set(document["missing"])
    for row in document["rows"]:
        assert line(row) in done.stdout
        assert row["turns"] == len(row["pairs_s"]) == 6
        assert row["low"] <= row["ratio"] <= row["high"]
    for name, reason in document["missing"].items():
        assert f"{name} is missing, its rows are left out: {reason}" in done.stdout


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--turns", "5"], "a number from 6"),
        (["--turns", "nobody=7"], "not 'nobody=7'"),
        (["--only", "sides,sidse"], "not sidse"),
        (["--queries", "0"], "take numbers from 100"),
        (["-o", "nowhere/at/all.json"], "there is no folder nowhere/at"),
    ],
)
def test_a_wrong_command_line_is_refused_in_one_line(words, reason):
    done = bench(*words)
    assert done.returncode == 2
    assert reason in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr


def test_a_missing_peer_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(MODULES, "meshio", "no_such_module_at_all")
    with pytest.raises(MissingPeerError, match=r"no_such_module_at_all.*pip install 'tetrabench\[peers\]'"):
        load_peer("meshio")


def test_a_missing_library_of_gmsh_is_named(monkeypatch, tmp_path):
    (tmp_path / "gmsh_without_glu.py").write_text("raise OSError('libGLU.so.1: cannot open shared object file')")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(MODULES, "gmsh", "gmsh_without_glu")
    with pytest.raises(MissingPeerError, match=r"libGLU.so.1.*apt install libglu1-mesa"):
        load_peer("gmsh")


@pytest.fixture(scope="module", params=["natural", "shuffled"])
def case(request, tmp_path_factory):
    return Case(600, 50, request.param, tmp_path_factory.mktemp("peers"))


def as_gmsh(mesh):
    return (mesh.point_ids, mesh.points.ravel(), None), (mesh.tet_ids, mesh.point_ids[mesh.tets].ravel())


def as_meshio(mesh):
    return SimpleNamespace(points=mesh.points, cells_dict={"tetra": mesh.tets})


def as_libigl(neighbours):
    return neighbours[:, [3, 2, 0, 1]], None  # its faces are 012, 013, 123, 203


def as_scipy(table):
    return SimpleNamespace(indptr=table[0], indices=table[1])


ANSWERS = {
    ("read-small", "gmsh"): (as_gmsh, lambda theirs: theirs[0][1], "coordinates differ in 1 places"),
    ("read-large", "gmsh"): (as_gmsh, lambda theirs: theirs[1][1], "vertices of the tetras differ in 1 places"),
    ("read-small", "meshio"): (as_meshio, lambda theirs: theirs.points, "coordinates differ in 1 places"),
    ("read-large", "meshio"): (as_meshio, lambda theirs: theirs.cells_dict["tetra"], "vertices of the tetras differ"),
    ("sides", "libigl"): (as_libigl, lambda theirs: theirs[0], "side neighbours differ in 1 places"),
    ("vertex-tetras", "scipy"): (as_scipy, lambda theirs: theirs.indices, "tetras around the points differ"),
    ("nearest", "pynanoflann"): (np.array, np.array, "1 of 50 distances differ"),
}
"""How the right answer looks when the peer says it, one array in it, and what is said when an entry of that is wrong."""


@pytest.mark.parametrize(("operation", "peer"), ANSWERS)
def test_each_judge_sees_one_wrong_entry(operation, peer, case):
    """No peer is needed: ours says what the peer would."""
    put, choose, complaint = ANSWERS[operation, peer]
    make = next(row.contest for row in ROWS if (row.operation, row.peer) == (operation, peer))
    contest = make(case, MagicMock())
    theirs = deepcopy(put(contest.ours()))
    assert contest.differ(contest.ours(), theirs) == ""
    wrong = choose(theirs)
    wrong.flat[7] = wrong.flat[20] if wrong.flat[7] != wrong.flat[20] else wrong.flat[21]
    if operation == "nearest":
        theirs = wrong
    assert complaint in contest.differ(contest.ours(), theirs)


def test_the_judge_of_located_points(case):
    rows = case.net.locate(case.queries)
    assert misplaced(case, rows, "we") == ""
    rows[3], rows[5] = -1, rows[6]
    assert misplaced(case, rows, "they") == "they find 2 of 50 points in a wrong tetra"


# ---- the examples of the half-face thesis


def example(operation, peer, case):
    """The contest, with the peer's module where it is installed."""
    try:
        module = load_peer(peer)
    except MissingPeerError:
        pytest.skip(f"{peer} is not installed")
    row = next(row for row in EXAMPLES if (row.operation, row.peer) == (operation, peer))
    return row.contest(case, module)


@pytest.mark.parametrize("peer", ["meshio", "scikit-fem", "scipy"])
@pytest.mark.parametrize("operation", ["centroid", "centroid-hf"])
def test_the_middle_of_a_mesh_beside_each_peer(operation, peer, case):
    contest = example(operation, peer, case)
    ours, theirs = contest.ours(), contest.theirs()
    assert contest.differ(ours, theirs) == ""
    assert "beside our" in contest.differ(ours, theirs * (1 + 1e-11))
    others = np.delete(case.net.volumes, np.abs(case.net.volumes - ours).argmin())
    assert all(contest.differ(ours, other) for other in others)  # a volume tells who was found


def test_the_judge_of_half_faces(case):
    contest = example("construct-hf", "libigl", case)
    ours, theirs = contest.ours(), contest.theirs()
    assert contest.differ(ours, theirs) == ""
    theirs[0][5, 1] += 1
    assert contest.differ(ours, theirs) == "side neighbours differ in 1 places"


@pytest.mark.parametrize("operation", ["generate", "generate-hf"])
def test_the_judge_of_cubes_by_formula(operation, case):
    contest = example(operation, "numpy", case)
    ours, theirs = contest.ours(), contest.theirs()
    assert contest.differ(ours, theirs) == ""
    theirs[7, 2] += 1
    assert contest.differ(ours, theirs) == "side neighbours differ in 1 places"


def test_the_judge_of_cubes_of_scikit_fem(case):
    contest = example("generate", "scikit-fem", case)
    ours, (points, tets, pairs) = contest.ours(), contest.theirs()
    assert contest.differ(ours, (points, tets, pairs)) == ""
    wrong = pairs.copy()
    inner = np.flatnonzero(pairs[1] >= 0)
    wrong[1, inner[7]] = wrong[1, inner[8]]
    assert "pairs of tetras differ" in contest.differ(ours, (points, tets, wrong))
    assert "pairs of tetras" in contest.differ(ours, (points, tets, pairs[:, 1:]))
    assert "pairs of tetras differ" in contest.differ(ours, ([[1], [0], [0]] - points * [[1], [-1], [-1]], tets, pairs))


def test_the_judge_of_delaunay_cubes(case):
    contest = example("generate", "scipy", case)
    ours, (points, tets, neighbours) = contest.ours(), contest.theirs()
    assert contest.differ(ours, (points, tets, neighbours)) == ""
    assert "a volume of" in contest.differ(ours, (points * 1.001, tets, neighbours))
    neighbours = neighbours.copy()
    neighbours[tuple(np.argwhere(neighbours >= 0)[7])] = -1
    assert "1729 sides on the surface beside our 1728" in contest.differ(ours, (points, tets, neighbours))
