"""docs/reference/public-api.md, made from the code: `python -m tests.public_api`. A test compares, so that no name of the
public face goes, comes or changes unnoticed."""

import inspect
from collections.abc import Iterator
from enum import EnumType
from importlib import import_module
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "public-api.md"

HEAD = """# The public API on one page

What programs may rely on: a release says in its changelog what changes here. Made by `python -m tests.public_api`; a test
compares it with the code. Types and the rest of each docstring are a `help(...)` away.
"""

SECTIONS = {
    "The package": ("tetrabench", ["*"]),
    "Tetrahedra as input": ("tetrabench.mesh", ["TetraMesh"]),
    "A net of tetrahedra": ("tetrabench.tetra.net", ["TetraNet"]),
    "Its fields without a copy": ("tetrabench.tetra.by_ref", ["ByRef"]),
    "Polygons as input": ("tetrabench.mesh.polygon", ["PolygonMesh"]),
    "A mesh of polygons": ("tetrabench.polygon.net", ["PolygonNet"]),
    "Objects as input": ("tetrabench.collision.objects", ["Start", "make_objects"]),
    "Objects that collide": ("tetrabench.collision.simulation", ["Simulation"]),
    "Half-faces": (
        "tetrabench.backends.tetra.halfface",
        ["HalfFaceMesh", "EventualMesh", "ElementSet", "ElementMultiset", "Element"],
    ),
    "The interface of a net, for kernels and contestants": ("tetrabench.tetra.interface", ["*"]),
    "Changes in kernels": ("tetrabench.tetra.edit", ["reserve", "insert_point", "check_editable"]),
    "The interface of a mesh of polygons": ("tetrabench.polygon.interface", ["*"]),
    "The interface of a structure for collisions": ("tetrabench.collision.interface", ["*"]),
    "Kernels": ("tetrabench.jit", ["kernel", "generic", "implements"]),
    "Sides": ("tetrabench.mesh.sides", ["side_neighbours"]),
    "Tetras around vertices": ("tetrabench.mesh.incidence", ["vertex_tetras"]),
    "Numbering": ("tetrabench.mesh.hilbert", ["hilbert_order"]),
    "Nearest points": ("tetrabench.tetra.nearest", ["build_tree", "nearest_points"]),
    "Pictures": ("tetrabench.report.picture", ["draw_net"]),
    "Plug-ins": (
        "tetrabench.protocols",
        [
            *("Family", "Tour", "Needs", "ModelFacts", "Rule", "Workload"),
            *("Contestant", "Option", "Scenario", "Stage", "Answer", "Work"),
        ],
    ),
    "Errors": (
        "tetrabench.errors",
        [
            "InputError",
            "RepairableError",
            "MemoryRefusedError",
            "UnsupportedError",
            "NotComparableError",
            "PluginWarning",
        ],
    ),
    "Contestants of tetra": ("tetrabench.tetra.contestant", ["TetraContestant"]),
    "Contestants of polygon": ("tetrabench.polygon.contestant", ["PolygonContestant"]),
    "Contestants of collision": ("tetrabench.collision.contestant", ["CollisionContestant"]),
    "Scenarios of tetra": ("tetrabench.scenarios.tetra.base", ["TetraScenario"]),
    "Scenarios of polygon": ("tetrabench.scenarios.polygon.base", ["PolygonScenario"]),
    "Scenarios of collision": ("tetrabench.scenarios.collision.base", ["CollisionScenario"]),
    "Models of tetra": ("tetrabench.mesh.models.model", ["Model", "Regular"]),
    "Models of polygon": ("tetrabench.mesh.polygon.models.model", ["PolygonModel", "Division"]),
    "Models of collision": ("tetrabench.collision.start.models", ["Model"]),
}
"""Title -> module, and its names; "*" are those that it defines, or lists in `__all__`."""


def page() -> str:
    """The page."""
    parts = [HEAD]
    for title, (module_name, names) in SECTIONS.items():
        module = import_module(module_name)
        rows = [row for name in names_of(module, names) for row in rows_of(name, getattr(module, name))]
        if module_name == "tetrabench":  # what its classes hold stands where they are at home
            rows = [row for row in rows if not row.startswith(" ")]
        parts += [f"## {title}: `{module_name}`\n", "\n".join(rows) + "\n"]
    return "\n".join(parts)


def names_of(module: Any, names: list[str]) -> list[str]:
    """The names of a module that are public."""
    if names != ["*"]:
        return names
    if hasattr(module, "__all__"):
        return [name for name in module.__all__ if not name.startswith("__")]
    return [
        name
        for name, member in vars(module).items()
        if not name.startswith("_") and callable(member) and getattr(member, "__module__", "") == module.__name__
    ]


def rows_of(name: str, member: Any) -> Iterator[str]:
    """A line for a function; for a class, its own and one for each of its public members."""
    yield f"- `{spell(name, member)}`{first_line(member)}"
    if inspect.isclass(member) and not issubclass(member, Exception):
        ours = [cls for cls in member.__mro__ if cls.__module__.split(".")[0] == "tetrabench"]
        for inner in dict.fromkeys(name for cls in ours for name in vars(cls)):
            if not inner.startswith("_") and not (hasattr(member, "_fields") and inner in member._fields):
                found = inspect.getattr_static(member, inner)
                if isinstance(found, property | staticmethod | classmethod) or inspect.isfunction(found):
                    yield f"  - `{spell(inner, found)}`{first_line(found)}"


def spell(name: str, member: Any) -> str:
    """A name with its parameters and their defaults. No types: their spelling follows the versions of others."""
    if isinstance(member, staticmethod | classmethod):
        member = member.__func__
    if isinstance(member, EnumType):
        return name
    if isinstance(member, property) or (inspect.isclass(member) and issubclass(member, Exception)):
        return name
    if inspect.isclass(member) and getattr(member, "_is_protocol", False):
        return name
    signature = inspect.signature(getattr(member, "py_func", member))
    parameters = [
        one.replace(annotation=inspect.Parameter.empty)
        for one in signature.parameters.values()
        if one.name not in ("self", "cls")
    ]
    bare = inspect.Signature(parameters)
    return name + str(bare).replace("<factory>", "...")


def first_line(member: Any) -> str:
    """What it is, in a line; of what is its name and no more, nothing."""
    if isinstance(member, staticmethod | classmethod):
        member = member.__func__
    lines = (inspect.getdoc(getattr(member, "py_func", member)) or "").splitlines()
    paragraph = " ".join(line for line in lines[: lines.index("") if "" in lines else None])
    return f": {paragraph}" if paragraph else ""


if __name__ == "__main__":
    PAGE.write_text(page())
