"""The shelf: what `--model` may name in a family, generated models, which are kept in the user's cache, and files."""

import functools
import hashlib
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType
from typing import Any

from tetrabench.errors import InputError
from tetrabench.folders import cache_root
from tetrabench.io import is_file
from tetrabench.jit.reach import reach


@dataclass(frozen=True)
class Shelf:
    """The models of a family.

    Attributes:
        models: that can be generated, by name; plug-ins may add some.
        files: of ours, by the name of their model.
        size_of: (model) -> its default size, in elements.
        maker_of: (model) -> the function that makes it.
        suffix: of the files that these are kept in.
        make: (name, size or None, numbering, seed, path): generate a model into a file.
        made_by: packages that generated models depend on, beside the files of their makers, and of what these call: those
            that other code made are not taken.
        check_source, check_target: refuse a path that no reader reads, or no writer writes, with an InputError.
    """

    models: Mapping[str, Any]
    size_of: Callable[[Any], int]
    maker_of: Callable[[Any], Callable[..., Any]]
    suffix: str
    make: Callable[[str, int | None, str, int, Path], None]
    made_by: tuple[ModuleType, ...]
    check_source: Callable[[Path], object]
    check_target: Callable[[Path], object]
    files: Mapping[str, Path] = field(default_factory=dict)

    def find(self, model: str, *, size: int | None, numbering: str, seed: int) -> Path:
        """The file of a model: `model` is a path, or the name of one that is generated if it is not there yet.

        Raises:
            InputError: there is no such file and no such model; says how to get one. Or what `make` refuses.
        """
        if model not in self.models:
            path = self.files.get(model, Path(model))
            if not is_file(path):
                raise InputError(self._how_to_get(path))
            self.check_source(path)
            if size is not None or numbering != "natural":
                raise InputError(
                    f"{model} is a file: a size or numbering can only be given for {', '.join(self.models)}"
                )
            return path
        folder = cache_root() / "models"
        row = self.models[model]
        stamp = _stamp(self.made_by, self.maker_of(row))
        path = folder / f"{model}-{size or self.size_of(row)}-{numbering}-{seed}-{stamp}{self.suffix}"
        if not path.is_file():
            folder.mkdir(parents=True, exist_ok=True)
            self.make(model, size, numbering, seed, path)
        return path

    def _how_to_get(self, path: Path) -> str:
        if path.stem in self.models:
            try:
                self.check_target(path)
                file = path
            except InputError:
                file = path.with_suffix(self.suffix)
            return (
                f"{path}: no such file. Make one with `tetrabench generate {path.stem} -o {file}`, "
                f"or say `--model {path.stem}` to have one made for you"
            )
        near = get_close_matches(path.stem, self.models, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        return f"{path}: no such file, and no model of that name; models are {', '.join(self.models)}{hint}"


@functools.cache
def _stamp(packages: tuple[ModuleType, ...], maker: Callable[..., Any]) -> str:
    """Eight digits that change with the sources of packages, and with those that a function is made from."""
    digest = hashlib.sha256()
    for package in packages:
        for source in sorted(Path(package.__path__[0]).rglob("*.py")):
            digest.update(source.read_bytes())
    function = _function_of(maker)
    modules, constants = reach([function])
    sources = {inspect.getfile(function), *(inspect.getfile(sys.modules[name]) for name in modules)}
    for part in [
        *(Path(source).read_bytes() for source in sorted(sources)),
        *(text.encode() for text in sorted(constants)),
    ]:
        digest.update(part)
    return digest.hexdigest()[:8]


def _function_of(maker: Callable[..., Any]) -> Callable[..., Any]:
    """What is called in the end: of a function with some arguments bound, or of an object."""
    while isinstance(maker, functools.partial):
        maker = maker.func
    return maker if inspect.isroutine(maker) else type(maker).__call__
