"""The peers answer as the naive twin does, and a contest finds whoever does not."""

import itertools
import json
import shutil
import subprocess

import numpy as np
import pytest

from tests.polygon.twin import Twin
from tests.polygon_peers.__main__ import main
from tests.polygon_peers.contests import ROWS, Case, at_random, bars_of, differ, elements_of, in_order, unsteady
from tests.polygon_peers.library import FLAGS, HERE, PEERS, Peer
from tetrabench.errors import InputError
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.polygon.queries import QUERIES

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")


@pytest.fixture(scope="module", params=PEERS)
def load(request, tmp_path_factory):
    """Load a peer with a mesh."""
    folder = tmp_path_factory.mktemp("peers")

    def load(mesh):
        try:
            return Peer(request.param, folder, mesh)
        except InputError as error:
            pytest.skip(str(error))

    return load


def circle(items):
    """A list from its least item on, without boundary conditions."""
    kept = [item for item in items if item >= 0]
    least = kept.index(min(kept)) if kept else 0
    return kept[least:] + kept[:least]


@pytest.mark.parametrize("model", MODELS)
def test_a_peer_answers_as_the_twin_does(load, model):
    mesh = generate_polygons(model, 20, seed=3)
    twin, peer, room = Twin(mesh), load(mesh), 40
    for name, query in QUERIES.items():
        wanted = [
            {
                "cell-nodes": twin.cell_nodes,
                "cell-neighbours": twin.cell_neighbours,
                "node-cells": lambda v: twin.star(v)[1],
                "node-neighbours": lambda v: twin.star(v)[0],
            }[name](element)
            for element in range(len(mesh.points) if query.of_nodes else mesh.number_of_cells)
        ]
        starts, items = peer.lists(query, len(wanted), room)
        found = [items[begin:end].tolist() for begin, end in itertools.pairwise(starts)]
        assert list(map(circle, found)) == list(map(circle, wanted))
        out = np.zeros(room, np.int32)
        sums = [sum(item for item in items if item >= 0) for items in wanted]
        assert peer.sweep(query, out) == sum(sums)
        assert peer.sample(query, np.array([3, 3, 1], np.int32), out) == 2 * sums[3] + sums[1]


@pytest.mark.parametrize("way", [in_order, at_random])
def test_a_contest_compares_sums_and_lists(tmp_path, way, monkeypatch):
    monkeypatch.setattr("tests.polygon_peers.contests.PICKS", 50)
    mesh = generate_polygons("quad", 30)
    peer, query = Peer("c", tmp_path, mesh), QUERIES["cell-nodes"]
    case = Case(mesh, "by-edge")
    contest = way(query, case, peer)
    assert contest.differ(contest.ours(), contest.theirs()) == ""
    assert "the sums are" in contest.differ(1, 2)
    turned = generate_polygons("quad", 30)
    turned.nodes[:4] = turned.nodes[:4][::-1].copy()
    monkeypatch.setattr(peer, "lists", lambda query, *_: (turned.starts.astype(np.int64), turned.nodes))
    assert differ(query, case, peer, 1, 1) == "the lists are others"


@pytest.mark.parametrize("name", PEERS)
def test_a_peer_compiles_without_a_warning(name, tmp_path):
    """Headers of the system may warn of what they like."""
    (compiler, standard, source, *_), packages = PEERS[name]
    command = [compiler, standard, *FLAGS, "-Wall", "-Wextra", "-c", str(HERE / source), "-o", str(tmp_path / "peer.o")]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode and "No such file" in done.stderr:
        pytest.skip(f"needs {packages}")
    ours = [line for line in done.stderr.splitlines() if line.startswith(str(HERE)) and "warning:" in line]
    assert (done.returncode, ours) == (0, [])


def test_a_bar_of_a_query_is_the_best_formats_and_that_of_building_everyones():
    def row(operation, form, *, met, one_thread=True):
        head = {"operation": operation, "numbering": form, "peer": "c", "bar": 1.6}
        return head | ({"difference": "wrong"} if met is None else {"met": met, "one_thread": one_thread})

    def reached(*rows):
        return [bar["reached"] for bar in bars_of(rows)]

    for operation, one_is_enough in (("cell-nodes", True), ("build", False)):
        good = row(operation, "by-cell", met=True)
        assert reached(good) == [True]
        bad = [{"met": False}, {"met": None}, {"met": True, "one_thread": False}]
        for how in bad:
            assert reached(good, row(operation, "tables", **how)) == [one_is_enough]
            assert reached(row(operation, "tables", **how)) == [False]
    assert reached(row("build", "tables", met=None) | {"bar": None}) == []


def test_a_peer_that_takes_longer_for_the_same_is_not_believed():
    def rows(*times, operation="cell-nodes", peer="c"):
        return [{"operation": operation, "peer": peer, "peer_s": time} for time in times]

    wrong = {"operation": "cell-nodes", "peer": "c", "difference": "the lists are others"}
    assert unsteady([*rows(1.0, 1.24), wrong]) == []
    assert unsteady([*rows(1.0), *rows(2.0, peer="cgal"), *rows(3.0, operation="node-cells")]) == []
    assert unsteady(rows(1.1, 2.0, 1.0)) == [{"operation": "cell-nodes", "peer": "c", "low_s": 1.0, "high_s": 2.0}]


def test_a_time_is_divided_by_what_was_asked():
    mesh = generate_polygons("quad", 30)
    wanted = {"build": mesh.number_of_cells, "cell-nodes": mesh.number_of_cells, "node-cells": len(mesh.points)}
    assert {name: elements_of(name, mesh) for name in wanted} == wanted
    assert elements_of("random node-cells", mesh) == 1_000_000


def test_the_rows_name_what_there_is(capsys, tmp_path):
    assert {row.peer for row in ROWS} == {*PEERS, "xugrid"}
    target = tmp_path / "peers.json"
    words = ["--cells", "40", "--turns", "6", "--only", "cell-nodes,by-cell,c", "-o", str(target)]
    assert main(words) == 0
    assert "bars reached: " in capsys.readouterr().out
    document = json.loads(target.read_text())
    assert (
        {row["operation"] for row in document["rows"]}
        == {bar["operation"] for bar in document["bars"]}
        == {"cell-nodes"}
    )
    assert [row["elements"] for row in document["rows"]] == [generate_polygons("quad", 40).number_of_cells]
    assert document["bytes_a_cell"]["by-cell"] > 0
    with pytest.raises(SystemExit):
        main(["--only", "by-magic"])
