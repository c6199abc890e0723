"""What the tetra family knows of a contestant."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tetrabench.mesh import TetraMesh
from tetrabench.protocols import Option
from tetrabench.tetra.interface import Net


@dataclass(frozen=True)
class TetraContestant:
    """A way to store a tetrahedral net.

    Attributes:
        name: what people type, such as `v3y`.
        title: layout and slot policy in words.
        trade_off: one line: what it is good at, and what it pays for that.
        build: mesh -> storage, with exactly the room that the mesh needs; point refs are the rows of `mesh.points`.
        layout, slots: the words for the two axes of the table of contestants.
        source: where it was described first.
        extension: whether it is ours rather than the source's; tables mark it.
        stable_refs: whether the refs of surviving tetras stay the same through every edit; else `collect` and what calls it
            (see `TetraNet`) may change them all, and with them the order of iteration.
        family: the family that it belongs to.
        options, is_exact: see protocols.Contestant.
    """

    name: str
    title: str
    trade_off: str
    build: Callable[[TetraMesh], Net]
    layout: str = ""
    slots: str = ""
    source: str = ""
    extension: bool = False
    stable_refs: bool = True
    family: str = "tetra"
    options: Mapping[str, Option] = field(default_factory=dict)
    is_exact: bool = True
