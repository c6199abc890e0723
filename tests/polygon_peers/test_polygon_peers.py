"""The peers answer as the naive twin does, and a contest finds whoever does not."""

import itertools
import shutil
import subprocess

import numpy as np
import pytest

from tests.polygon.twin import Twin
from tests.polygon_peers.__main__ import main
from tests.polygon_peers.contests import ROWS, Case, at_random, differ, in_order
from tests.polygon_peers.library import HERE, PEERS, Peer
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


def test_the_tables_compile_without_a_warning(tmp_path):
    command = ["gcc", "-std=c11", "-O3", "-Wall", "-Wextra", "-Werror", "-c", str(HERE / "tables.c"), "-o"]
    assert subprocess.run([*command, str(tmp_path / "tables.o")], capture_output=True).returncode == 0


def test_the_rows_name_what_there_is(capsys, tmp_path):
    assert {row.peer for row in ROWS} == {*PEERS, "xugrid"}
    target = tmp_path / "peers.json"
    words = ["--cells", "40", "--turns", "6", "--only", "cell-nodes,by-cell,c", "-o", str(target)]
    assert main(words) == 0
    assert "cell-nodes" in capsys.readouterr().out
    assert '"bytes_a_cell"' in target.read_text()
    with pytest.raises(SystemExit):
        main(["--only", "by-magic"])
