"""Memory of each contestant, for each item of the model."""

from collections.abc import Callable

from tetrabench.bench.record import Memory
from tetrabench.report.cells import MISSING
from tetrabench.report.parts import Part

Sizes = dict[str, float | str]  # contestant -> bytes an item, or the word that stands where no figure may

MEMORY_ERROR = 0.01
"""What a process retains, and its peak, differ by so much between equal runs."""

_ENDS = {"oom": "no memory", "timeout": "timed out", "crash": "crashed", "unsupported": "cannot", "skipped": "skipped"}


def memory_of(part: Part) -> dict[str, Sizes]:
    """Bytes an item by kind, "structure", "retained" and "peak" as far as they are known, and by contestant.

    Without a memory pass the structure is that which the contestant said it had when the run began, which holds for
    the first model alone.
    """
    measured = memories(part)
    kinds: dict[str, Callable[[Memory], int | None]] = {
        "structure": lambda one: one.structure_bytes or None,
        "retained": lambda one: one.retained_bytes,
        "peak": lambda one: one.peak_bytes,
    }
    sizes = {kind: _sizes(part, measured, bytes_of) for kind, bytes_of in kinds.items()}
    return {kind: known for kind, known in sizes.items() if any(isinstance(size, float) for size in known.values())}


def memories(part: Part) -> dict[str, Memory]:
    """What is known of the memory of each contestant."""
    model, is_first = part.model.name, part.model == part.results.models[0]
    known = {
        backend.name: Memory(model=model, backend=backend.name, structure=backend.structure)
        for backend in part.backends
        if backend.structure and is_first
    }
    names = {backend.name for backend in part.backends}
    return known | {one.backend: one for one in part.results.memory if one.model == model and one.backend in names}


def _sizes(part: Part, measured: dict[str, Memory], bytes_of: Callable[[Memory], int | None]) -> Sizes:
    sizes: Sizes = {}
    items = next(iter(part.model.size.values()), 0)
    for backend in part.backends:
        memory = measured.get(backend.name)
        size = bytes_of(memory) if memory else None
        if memory is not None and memory.status != "ok":
            sizes[backend.name] = _ENDS.get(memory.status, "failed")
        elif size is not None and items:
            sizes[backend.name] = size / items
        else:
            sizes[backend.name] = MISSING if part.results.ended else "no figure"
    return sizes
