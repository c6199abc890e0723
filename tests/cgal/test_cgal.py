"""The bench beside CGAL: what is compared is the same, every judge sees a wrong answer, and what is missing is said."""

import json

import numpy as np
import pytest

from tests.cgal import __main__ as bench
from tests.cgal import contests, kernels, library, weigh
from tests.cgal.contests import CUBES, ROWS, Case, Cube
from tests.cgal.library import Held, at, neighbours
from tests.contest import line
from tetrabench.errors import InputError
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.mesh.quality import signed_volumes
from tetrabench.mesh.sides import side_neighbours

pytestmark = pytest.mark.xdist_group("cgal")  # one process compiles


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The library, or a reason to skip."""
    try:
        return library.build(tmp_path_factory.mktemp("cgal"))
    except InputError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def functions(built):
    return library.load(built)


@pytest.fixture(scope="module", params=["natural", "shuffled"])
def case(request, functions):
    return Case(functions, 600, request.param)


def test_all_of_it_from_answers_to_json(built, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(bench, "build", lambda *_: built)
    output, picture = tmp_path / "cgal.json", tmp_path / "curve.svg"
    words = ["--tets", "600", "--turns", "6", "--sizes", "200,600", "--picture", str(picture), "-o", str(output)]
    assert bench.main(words) == 0
    said, document = capsys.readouterr().out, json.loads(output.read_text())
    assert "CGAL_NDEBUG" in said
    assert [row["operation"] for row in document["rows"]] == [
        row.operation for row in ROWS if row.peer not in document["missing"]
    ]
    for row in document["rows"]:
        assert line(row) in said
        assert row["turns"] == len(row["pairs_s"]) == 6
    assert len(document["curve"]) == 12
    for point in document["curve"]:
        assert (point["ratio"] == 1.0) == (point["tetras"] < 400)
    assert "<svg" in picture.read_text()
    for row in document["memory"]:
        assert weigh.line(row) in said
        assert row["retained"] is None or row["retained"] > 10 * row["tetras"]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--turns", "5"], "a number from 6"),
        (["--turns", "cgal-all=7"], "such as cgal-call=7"),
        (["--only", "construct,curved"], "not curved"),
        (["--sizes", "200,99"], "take numbers from 100"),
        (["-o", "nowhere/at/all.json"], "there is no folder nowhere/at"),
    ],
)
def test_a_wrong_command_line_is_refused_in_one_line(words, reason, capsys):
    with pytest.raises(SystemExit) as stop:
        bench.parse(words)
    assert stop.value.code == 2
    assert reason in capsys.readouterr().err.splitlines()[-1]


def test_what_is_asked_for():
    def asked(only):
        options = bench.parse(["--only", only])
        return len(options.rows), options.parts

    assert asked("") == (len(ROWS), ["curve", "memory"])
    assert asked("curve") == (0, ["curve"])
    assert asked("memory,centroid") == (sum(row.operation == "centroid" for row in ROWS), ["memory"])


def test_a_missing_compiler_is_one_line(monkeypatch, capsys):
    monkeypatch.setattr(library, "COMPILER", "no-such-compiler")
    assert bench.main([]) == 2
    said = capsys.readouterr().err.splitlines()
    assert said == [f"bench-cgal: there is no no-such-compiler; on Debian and Ubuntu: {library.PACKAGES}"]


@pytest.mark.parametrize("header", ["CGAL/version.h", "gmp.h"])
def test_a_missing_header_is_one_line(header, monkeypatch, tmp_path):
    compiler = tmp_path / "compiler"
    compiler.write_text(
        f"#!/bin/sh\necho '<stdin>:1:10: fatal error: {header}: No such file or directory' >&2\nexit 1\n"
    )
    compiler.chmod(0o755)
    monkeypatch.setattr(library, "COMPILER", str(compiler))
    with pytest.raises(InputError, match=f"does not find {header}; on Debian and Ubuntu: apt install"):
        library.build(tmp_path)


# ---- the C++ side


def test_plain_tables(case, functions):
    opposite = np.empty_like(case.tets)
    functions.plain_sides(at(case.tets), len(case.tets), case.vertices, at(opposite))
    np.testing.assert_array_equal(opposite >> 2, side_neighbours(case.tets))
    inner = np.flatnonzero(opposite.ravel() >= 0)
    np.testing.assert_array_equal(opposite.ravel()[opposite.ravel()[inner]], inner)  # there and back
    starts, rows = case.table
    wanted_starts, wanted_rows = vertex_tetras(case.tets, case.vertices)
    np.testing.assert_array_equal(starts, wanted_starts)
    np.testing.assert_array_equal(rows, wanted_rows)


def test_plain_sums(case, functions):
    starts, rows = case.table
    visits = np.zeros(1, np.int64)
    assert functions.plain_walk(at(starts), at(rows), case.vertices, at(visits)) == rows.sum()
    assert visits[0] == case.tets.size
    smallest = case.tets.min(axis=1)
    arguments = at(starts), at(rows), case.vertices, at(case.ascending), at(visits)
    assert functions.plain_touch(*arguments) == smallest[rows].sum()
    queries = np.array([3, 0, 3, case.vertices - 1])
    wanted = sum(smallest[rows[starts[v] : starts[v + 1]]].sum() for v in queries)
    assert functions.plain_ask(at(starts), at(rows), at(case.ascending), at(queries), len(queries)) == wanted


def test_centroid_beside_numpy(case, functions):
    volumes, centroids = np.abs(signed_volumes(case.xyz, case.tets)), case.xyz[case.tets].mean(axis=1)
    centre = np.average(centroids, axis=0, weights=volumes)
    wanted = volumes[np.linalg.norm(centroids - centre, axis=1).argmin()]
    assert functions.plain_centroid(at(case.tets), len(case.tets), at(case.xyz)) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("side", [1, 2, 5])
def test_both_cubes_are_the_same_bits(side, functions):
    tets, xyz = Cube(functions, 0.0).make(side)
    ours = contests.room_for_cube(side)
    kernels.cube(side, *ours)
    np.testing.assert_array_equal(ours[0], tets)
    np.testing.assert_array_equal(ours[1], xyz)
    volumes = signed_volumes(xyz, tets)
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(1.0)
    assert (side_neighbours(tets) < 0).sum() == 12 * side**2


def test_replaced_cells_leave_a_valid_structure(case, functions):
    held = Held(functions.bare_build(at(case.tets), len(case.tets), case.vertices), functions.bare_free)
    assert functions.bare_valid(held.pointer)
    before = neighbours(functions, "bare", held, len(case.tets))
    functions.bare_choose(held.pointer, at(case.edited), len(case.edited))
    for _ in range(2):
        assert functions.bare_replace(held.pointer) == len(case.edited)
    assert functions.bare_valid(held.pointer)
    np.testing.assert_array_equal(neighbours(functions, "bare", held, len(case.tets)), before)


# ---- the judges


def rows_of(operation):
    return [pytest.param(row, id="-".join(row[:3])) for row in ROWS if row.operation.startswith(operation)]


def contest_of(row, functions):
    if row.peer == "cgal-call" and not functions.call_there():
        pytest.skip("this CGAL has no such call")
    cube = row.numbering in CUBES
    made = Cube(functions, CUBES[row.numbering]) if cube else Case(functions, 600, row.numbering)
    return row.contest(made, functions)


@pytest.mark.parametrize("row", rows_of(("construct", "generate", "collect", "add")))
def test_the_judge_of_meshes_sees_one_tetra_less(row, functions):
    contest = contest_of(row, functions)
    contest.fresh()
    ours, theirs = contest.ours(), contest.theirs()
    assert contest.differ(ours, theirs) == ""
    ours.set_delete_flag(0)
    ours.garbage_collect()
    assert contest.differ(ours, theirs) != ""


@pytest.mark.parametrize("row", rows_of("construct"))
def test_the_judge_of_constructs_sees_a_wrong_neighbour_and_a_fault(row, functions):
    contest = contest_of(row, functions)
    ours, theirs = contest.ours(), contest.theirs()
    words = ours.storage.adjacency
    t, x = np.argwhere(words >> 29 != 0)[7]
    words[t, x] ^= 1  # another tetra
    assert "side neighbours differ in 1 places" in contest.differ(ours, theirs)


@pytest.mark.parametrize("row", rows_of(("centroid", "around")))
def test_the_judge_of_sums_sees_small_differences(row, functions):
    contest = contest_of(row, functions)
    ours, theirs = contest.ours(), contest.theirs()
    assert contest.differ(ours, theirs) == ""
    wrong = ours * (1 + 1e-9) if row.operation == "centroid" else (ours[0] + 1, ours[1])
    assert contest.differ(wrong, theirs) != ""


@pytest.mark.parametrize("row", rows_of("list-around"))
def test_the_judge_of_lists_sees_one_wrong_entry(row, functions):
    contest = contest_of(row, functions)
    (starts, found), theirs = contest.ours(), contest.theirs()
    assert contest.differ((starts, found), theirs) == ""
    found[7] += 1
    assert contest.differ((starts, found), theirs) == "tetras around vertices differ in 1 places"


@pytest.mark.parametrize("row", rows_of(("collect", "add")))
def test_each_edit_begins_with_the_same_arrays(row, functions):
    contest = contest_of(row, functions)
    left_behind = []
    for _ in range(3):
        contest.fresh()
        mesh = contest.ours()
        theirs = contest.theirs()
        contest.tidy()
        assert contest.differ(mesh, theirs) == ""
        left_behind.append(mesh.connectivity)
    np.testing.assert_array_equal(left_behind[0], left_behind[1])
    np.testing.assert_array_equal(left_behind[0], left_behind[2])
