"""The verb that shows a net."""

from pathlib import Path

import numpy as np
import pytest

from tests.meshes import apart, single
from tests.oracle import OracleNet
from tests.test_cli import refusal, say
from tetrabench.io import read_mesh, write_mesh
from tetrabench.io.values import read_values
from tetrabench.mesh.models import generate

STATES = [f"state_{place}" for place in range(5)]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list:
    """What is given to `draw_net`."""
    from tetrabench.report import picture

    draw_net, calls = picture.draw_net, []

    def draw(mesh, values, cut, **words):
        calls.append((mesh, values, cut, words))
        return draw_net(mesh, values, cut, **words)

    monkeypatch.setattr(picture, "draw_net", draw)
    return calls


INITIAL = ", in the states that every scenario starts from: it holds none itself"


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".PDF", b"%PDF")])
def test_a_picture_of_a_file(tmp_path: Path, drawn: list, suffix: str, magic: bytes) -> None:
    mesh = generate("box", 48, seed=1)
    write_mesh(mesh, tmp_path / "a$b$.vtk")
    output = tmp_path / f"a${suffix}"
    result = say("view", tmp_path / "a$b$.vtk", "-o", output, "--cut", "z=25%")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", f"wrote {output}{INITIAL}\n")
    assert output.read_bytes().startswith(magic)
    ((shown, values, cut, words),) = drawn
    assert (cut, words) == ("z=25%", {"title": "a$b$.vtk: 48 tetras", "label": "state 0"})
    net = OracleNet(shown.points, shown.tets)
    net.set_initial_states()
    np.testing.assert_allclose(values, [net.states[t][0] for t in range(48)], rtol=1e-13)
    np.testing.assert_array_equal(shown.tets, mesh.tets)


def test_a_model_by_name_in_an_order(tmp_path: Path, drawn: list) -> None:
    words = ("view", "box", "--tets", 48, "--numbering", "shuffled", "--seed", 3, "-o", tmp_path / "a.png")
    assert say(*words, "--state", "volume").exit_code == 0
    ((mesh, values, cut, said),) = drawn
    shuffled = generate("box", 48, numbering="shuffled", seed=3)
    np.testing.assert_array_equal(mesh.tets, shuffled.tets)
    net = OracleNet(mesh.points, mesh.tets)
    np.testing.assert_allclose(values, [net.volume(t) for t in range(48)])
    assert (cut, said["title"], said["label"]) == (None, "box: 48 tetras", "volume")


def test_states_of_a_file_are_those_that_are_shown_and_written(tmp_path: Path, drawn: list) -> None:
    mesh = generate("box", 48, numbering="shuffled", seed=1)
    values = {name: np.arange(48.0) * (place + 1) for place, name in enumerate(STATES)} | {"heat": -np.arange(48.0)}
    write_mesh(mesh, tmp_path / "a.vtu", values=values)
    for state, name in (("3", "state_3"), ("state_4", "state_4"), ("heat", "heat")):
        assert say("view", tmp_path / "a.vtu", "--state", state, "-o", tmp_path / "a.png").exit_code == 0
        np.testing.assert_array_equal(drawn[-1][1], values[name])
        np.testing.assert_array_equal(drawn[-1][0].tets, mesh.tets)
    assert INITIAL not in say("view", tmp_path / "a.vtu", "-o", tmp_path / "a.png").stderr
    result = say("view", tmp_path / "a.vtu", "--vtu", tmp_path / "b.vtu")
    assert result.stderr == f"wrote {tmp_path / 'b.vtu'}: 48 tetras with {', '.join(STATES)}, heat\n"
    assert (tmp_path / "b.vtu").read_bytes() == (tmp_path / "a.vtu").read_bytes()


def test_a_file_for_paraview_holds_what_scenarios_start_from(tmp_path: Path) -> None:
    write_mesh(apart(), tmp_path / "a.nas")
    words = ("view", tmp_path / "a.nas", "-o", tmp_path / "a.png", "--vtu", tmp_path / "a.vtu")
    result = say(*words)
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr.splitlines() == [
        f"wrote {tmp_path / 'a.png'}{INITIAL}",
        f"wrote {tmp_path / 'a.vtu'}: 2 tetras with {', '.join(STATES)}",
    ]
    mesh, values = read_mesh(tmp_path / "a.vtu"), read_values(tmp_path / "a.vtu")
    net = OracleNet(mesh.points, mesh.tets)
    net.set_initial_states()
    assert list(values) == STATES
    for place, name in enumerate(STATES):
        np.testing.assert_allclose(values[name], [net.states[t][place] for t in range(2)], rtol=1e-13)
    assert values["state_0"].min() > 0


def test_a_file_with_values_but_no_states_shows_both(tmp_path: Path, drawn: list) -> None:
    write_mesh(single(), tmp_path / "a.vtu", values={"heat": np.array([7.0])})
    for state in ("heat", "0"):
        assert say("view", tmp_path / "a.vtu", "--state", state, "-o", tmp_path / "a.png").exit_code == 0
    assert drawn[0][1].tolist() == [7.0]
    assert 0 < drawn[1][1][0] < 1


def test_what_is_refused_before_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tetrabench.io.read_mesh", None)
    monkeypatch.setattr("tetrabench.registry.family", None)
    there = tmp_path / "a.png"
    assert "-o FILE.png draws a picture, --vtu FILE.vtu writes" in refusal("view", "box")
    assert "a.jpg: pictures are .png .svg .pdf, by the suffix" in refusal("view", "box", "-o", tmp_path / "a.jpg")
    assert "there is no folder" in refusal("view", "box", "-o", tmp_path / "no" / "a.png")
    assert "'z' is no plane such as x=0.3" in refusal("view", "box", "-o", there, "--cut", "z")
    assert "no values of tetras are kept" in refusal("view", "box", "--vtu", tmp_path / "a.nas")
    assert "there is no folder" in refusal("view", "box", "--vtu", tmp_path / "no" / "a.vtu")
    assert "'.vtux' names no known format" in refusal("view", "box", "--vtu", tmp_path / "a.vtux")
    assert not list(tmp_path.iterdir())


def test_what_is_refused_once_the_net_is_known(tmp_path: Path) -> None:
    write_mesh(apart(), tmp_path / "a.vtu")
    before = (tmp_path / "a.vtu").read_bytes()
    words = ("view", tmp_path / "a.vtu", "-o", tmp_path / "a.png")
    assert "the plane x=9 lies outside: x goes from 0 to 6" in refusal(*words, "--cut", "x=9")
    assert "the plane x = 3 meets no tetra" in refusal(*words, "--cut", "x=50%")
    assert "no state 'state_5'; did you mean" in refusal(*words, "--state", "5")
    assert "no state 'heat'; there are: volume, state_0" in refusal(*words, "--state", "heat")
    assert "nowhere.vtu: no such file" in refusal("view", tmp_path / "nowhere.vtu", "-o", tmp_path / "a.png")
    assert "is a file: a size or numbering" in refusal(*words, "--tets", "100")
    assert "is what is read, and would be lost" in refusal("view", tmp_path / "a.vtu", "--vtu", tmp_path / "a.vtu")
    assert (tmp_path / "a.vtu").read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["a.vtu"]
