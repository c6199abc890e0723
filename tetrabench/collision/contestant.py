"""What the collision family knows of a contestant."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from tetrabench.collision.interface import Storage
from tetrabench.collision.objects import Floats
from tetrabench.errors import InputError
from tetrabench.protocols import Option, Options


@dataclass(frozen=True)
class CollisionContestant:
    """A structure that finds which objects touch.

    Attributes:
        name: what people type, such as `kdtree`.
        title: how it holds the objects, in words.
        trade_off: one line: what it is good at, and what it pays for that.
        build: places x and y, radii r and the values of the options -> storage.
        options: what can be chosen about it.
        is_compiled: whether kernels can take its storage; else the same steps run in Python.
        is_exact: False of one that misses pairs, and is there to show that this is noticed.
        is_quadratic: it tests all pairs: too slow for long runs.
        source: where it was described first.
        extension: whether it is ours rather than the source's; tables mark it.
        family: the family that it belongs to.
    """

    name: str
    title: str
    trade_off: str
    build: Callable[[Floats, Floats, Floats, Options], Storage]
    options: Mapping[str, Option] = field(default_factory=dict)
    is_compiled: bool = True
    is_exact: bool = True
    is_quadratic: bool = False
    source: str = ""
    extension: bool = False
    family: str = "collision"

    def make(self, x: Floats, y: Floats, r: Floats) -> Storage:
        """The storage of objects, with the options as they are chosen.

        Raises:
            InputError: an option is out of its range.
        """
        for name, option in self.options.items():
            if not option.least <= option.value <= option.most:
                limits = f"{option.least} to {option.most}"
                raise InputError(f"{self.name}: {name}={option.value} cannot be; it takes {limits}: {option.title}")
        return self.build(x, y, r, {name: option.value for name, option in self.options.items()})

    def callable(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """A kernel as this structure's storage can be given to it: itself, or the Python that it was compiled of."""
        return function if self.is_compiled else getattr(function, "py_func", function)
