"""The collision family as the harness sees it: models that are found, and a stage whose simulations begin at the start."""

from pathlib import Path

import numpy as np
import pytest

from tests.collision.test_files import same
from tetrabench import registry
from tetrabench.collision.family import FAMILY
from tetrabench.collision.simulation import Simulation
from tetrabench.collision.start import files, models
from tetrabench.collision.start.files import read_objects, write_objects
from tetrabench.collision.start.models import generate_objects
from tetrabench.errors import InputError
from tetrabench.io import shelf
from tetrabench.protocols import ModelFacts


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache and a folder of their own."""
    monkeypatch.setenv("TETRABENCH_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)


def find(model: str, size: int | None = None, numbering: str = "natural", seed: int = 0) -> Path:
    """The file of a model."""
    return FAMILY.find_model(model, size=size, numbering=numbering, seed=seed)


def test_it_is_registered() -> None:
    assert registry.family("collision") is FAMILY
    assert list(FAMILY.models) == list(models.MODELS)
    assert FAMILY.default_model in FAMILY.models


def test_a_model_is_made_once_and_exact() -> None:
    path = find("mixed", 48, "hilbert", 3)
    assert same(read_objects(path).objects, generate_objects("mixed", 48, numbering="hilbert", seed=3).objects)
    path.write_text("kept")
    assert find("mixed", 48, "hilbert", 3).read_text() == "kept"
    assert len({path, find("mixed", 48), find("mixed", 6), find("mixed", 48, seed=1)}) == 4


@pytest.mark.parametrize("changed", [models, files])
def test_a_model_that_other_code_made_is_not_taken(changed: object, monkeypatch: pytest.MonkeyPatch) -> None:
    old, read_bytes = find("uniform", 9), Path.read_bytes
    source = Path(str(changed.__file__))  # type: ignore[attr-defined]
    monkeypatch.setattr(Path, "read_bytes", lambda path: read_bytes(path) + b"# changed" * (path == source))
    shelf._stamp.cache_clear()
    try:
        assert find("uniform", 9) != old
    finally:
        shelf._stamp.cache_clear()


def test_a_file_is_taken_as_it_is(tmp_path: Path) -> None:
    write_objects(generate_objects("uniform", 3), tmp_path / "a.csv")
    assert find("a.csv") == Path("a.csv")
    with pytest.raises(InputError, match=r"a\.csv is a file: a size or numbering can only be given for uniform, "):
        find("a.csv", size=3)
    with pytest.raises(
        InputError, match=r"no such file. Make one with `tetrabench generate uniform -o uniform.npz`, or"
    ):
        find("uniform.xyz")
    with pytest.raises(
        InputError, match=r"models are uniform, clustered, halo, mixed, separated; did you mean uniform\?$"
    ):
        find("unifrm")
    with pytest.raises(InputError, match="objects have no graph"):
        find("uniform", numbering="rcm")


def test_models_are_described(tmp_path: Path) -> None:
    assert FAMILY.describe_model(FAMILY.small_model()) == ModelFacts({"objects": 300}, ())
    (tmp_path / "a.csv").write_text("# box 9 9\nx,y\n1,1\n-1,1\n1,10\n")
    told = FAMILY.describe_model(tmp_path / "a.csv")
    assert told == ModelFacts({"objects": 3}, ("2 of 3 objects begin outside of the box",))


def test_simulations_begin_at_the_start() -> None:
    stage = FAMILY.stage(registry.contestant("collision", FAMILY.reference), find("uniform", 40), chained=True)
    before = generate_objects("uniform", 40).objects
    assert stage.model_size() == {"objects": 40}
    assert stage.structure_bytes() == {}
    first = stage.simulation()
    first.step(3)
    second = stage.simulation(gravity=0.5, bounce=0.9, mode="full")
    assert (second.gravity, second.bounce, second.mode) == (0.5, 0.9, "full")
    assert same(second.objects, before)
    assert same(stage.start.objects, before)
    assert not np.array_equal(first.objects.x, before.x)
    assert stage.structure_bytes() == second.structure_bytes() != {}
    second.step()
    assert same(stage.start.objects, before)


def test_the_structure_that_is_told_of_is_the_last_one() -> None:
    stage = FAMILY.stage(registry.contestant("collision", FAMILY.reference), find("uniform", 40), chained=False)
    stage.build()
    built = stage.structure_bytes()
    assert built
    large = Simulation(generate_objects("uniform", 400), stage.contestant)
    stage.adopt(large)
    assert stage.structure_bytes() == large.structure_bytes() != built
    stage.build()
    assert stage.structure_bytes() == large.structure_bytes()  # one stands
    stage.close()
    assert stage.structure_bytes() == {}
