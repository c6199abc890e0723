"""Groups: which contestants are alive together, where not all of them fit into memory at once."""

from collections.abc import Sequence

from tetrabench.bench.record import Backend, Memory

BARE_BYTES = 300e6
"""Of a worker with the compiler and all kernels loaded, without a model."""
COPIES = 2.5
"""Times the peak of building: a scenario may work on a net of its own beside the fresh one, and the mesh lies there."""
SHARE = 0.8
"""Of what is available, that workers may take together."""


def make_groups(backends: Sequence[Backend], memory: Sequence[Memory], available: float | None) -> list[list[Backend]]:
    """The contestants in groups that fit, each with the references of its members, and with their controls.

    Args:
        backends: all, in order.
        memory: the memory pass on this model; who is not there counts as bare.
        available: bytes, None where nobody knows: then all are one group.
    """
    peaks = {one.backend: one.peak_bytes or sum(size for _, size in one.structure.values()) for one in memory}
    shared = {one.name: one for one in backends if one.control or one.against == one.name}
    rest = [one for one in backends if one.name not in shared]
    if available is None or not rest:
        return [list(backends)]

    def size(group: Sequence[Backend]) -> float:
        return sum(BARE_BYTES + COPIES * peaks.get(one.name if not one.control else one.against, 0) for one in group)

    def company(group: Sequence[Backend]) -> list[Backend]:
        wanted = {one.against for one in group} | {one.name for one in group}
        return [one for one in backends if one.name in wanted or (one.control and one.against in wanted)]

    groups: list[list[Backend]] = [[]]
    for one in rest:
        if groups[-1] and size(company([*groups[-1], one])) > SHARE * available:
            groups.append([])
        groups[-1].append(one)
    return [company(group) for group in groups]
