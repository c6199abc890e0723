"""The source of the tetra family: the thesis of József Martin (Győr 2011), its tables and what it found in them.

Figures are in the two files beside this one, as printed; sections are those of the thesis.
"""

import csv
from collections.abc import Iterator, Sequence
from importlib.resources import files

from tetrabench.bench.statistics import BEYOND
from tetrabench.sources import Facts, Finding, Reading, Source

LIKE = 1.1
"""Up to here the source calls two times alike: its own differ by so much where it sees no difference."""
HOPELESS = 5.0
"""What takes so many times as long as V3Y is hopeless: the least of those that the source calls so took 6.4 times."""
ORDER = 3.0
"""Half an order of magnitude: beyond it a multiple is nearer to ten than to one."""
LITTLE = 0.05
"""A share of the total that nobody would notice."""
BYTES_A_HOLE = 8.0
MISSED = 34 / 155_325
SWEEPS = ("alfa", "flow")
OTHERS = ("v3", "v3x", "v4", "v5", "v5x", "v5y")  # than v3y
ARRAYS = {"v4": "v3y", "v5": "v3", "v5x": "v3x", "v5y": "v3y"}  # who stores a tetra in one piece: the like in arrays


def takes(facts: Facts, task: str, one: str, other: str, *, least: float = 0.0, most: float = float("inf")) -> Reading:
    """The time of one contestant in a task beside another's."""
    words = f"{one} takes {{}} as long as {other} in {task}"
    return Reading(f"{one} / {other} in {task}", words, facts.ratio(task, one, other), least, most)


def totals(facts: Facts) -> list[Reading]:
    """All others' sums over the source's scenarios."""
    return [
        Reading(f"{one} / v3y in all", f"{one} takes {{}} as long as v3y in all", facts.total(one, "v3y"), BEYOND)
        for one in OTHERS
    ]


def deletion(facts: Facts) -> list[Reading]:
    """Sorted lists of holes."""
    return [takes(facts, "delete", one, "v3y", least=HOPELESS) for one in ("v3", "v5")]


def deletion_by_size(facts: Facts) -> list[Reading]:
    """Sorted lists of holes on the larger net and on the smaller one."""
    return [
        Reading(
            f"{one} in delete, nozzle / intake",
            f"{one} takes {{}} as long to delete on the nozzle as on the intake",
            facts.between_models("intake", "delete", one),
            0.5,
            2.0,
        )
        for one in ("v3", "v5")
    ]


def scanning(facts: Facts) -> list[Reading]:
    """Scans for the next hole."""
    return [takes(facts, "explode", one, "v3y", least=HOPELESS) for one in ("v3x", "v5x")]


def scanning_records(facts: Facts) -> list[Reading]:
    """A scan over records beside one over volumes alone."""
    return [takes(facts, "explode", "v5x", "v3x", least=ORDER)]


def sweeps(facts: Facts) -> list[Reading]:
    """Tetras in one piece beside the like in arrays."""
    return [takes(facts, task, one, like, least=BEYOND) for one, like in ARRAYS.items() for task in SWEEPS]


def sweeps_by_fields(facts: Facts) -> list[Reading]:
    """What arrays gain in a sweep that uses one field, beside one that uses three."""
    return [
        Reading(
            f"{one} / v3y, alfa / flow",
            f"{one}'s multiple of v3y's time is {{}} as large in alfa as in flow",
            facts.change("alfa", "flow", one, "v3y"),
            BEYOND,
        )
        for one in ("v4", "v5y")
    ]


def sweeps_by_holes(facts: Facts) -> list[Reading]:
    """Skipping holes by a list beside skipping them by a flag."""
    return [takes(facts, task, "v3", "v3x", least=1 / LIKE, most=LIKE) for task in SWEEPS]


def sweeps_of_the_intake(facts: Facts) -> list[Reading]:
    """Two contestants whose sweeps are the same code."""
    return [takes(facts, task, "v3y", "v3x", least=BEYOND) for task in SWEEPS]


def memory(facts: Facts) -> list[Reading]:
    """Links between nodes."""
    return [
        Reading("v4 / v3y, memory", "v4 needs {} as much memory as v3y", facts.memory("v4", "v3y"), 1.02, 1.06)
    ]  # fmt: skip


def freeing(facts: Facts) -> list[Reading]:
    """Single nodes given back."""
    words = "free takes {} of all that v4 does"
    share = Reading("free, share of v4's total", words, facts.share("free", "v4"), most=LITTLE, unit="%")
    return [takes(facts, "free", "v4", "v3y", least=LIKE), share]


def allocating(facts: Facts) -> list[Reading]:
    """Single nodes beside one array."""
    return [takes(facts, "init", "v4", other, most=LIKE) for other in ("v3y", "v5")]


def edits(facts: Facts) -> list[Reading]:
    """Two ways of keeping holes beside none at all."""
    return [takes(facts, task, "v3y", "v4", most=LIKE) for task in ("delete", "explode")]


def holes(facts: Facts) -> list[Reading]:
    """What a list of holes adds to a flag."""
    words = "v3y's structure has grown by {} for each deletion, beside v3x's"
    figure = facts.grown("delete", "init", "v3y", "v3x")
    return [Reading("v3y - v3x, delete", words, figure, most=BYTES_A_HOLE, unit=" bytes", printed=BYTES_A_HOLE)]


def searching(facts: Facts) -> list[Reading]:
    """The search tree beside asking every tetra."""
    words = "a point takes {} as long by brute force as with the search tree (v3y)"
    figure = facts.between_tasks("locate-brute", "locate-source", "v3y")
    return [Reading("v3y, locate-brute / locate-source", words, figure, least=100.0)]


def missing(facts: Facts) -> list[Reading]:
    """How many points may have been asked of every tetra, had all the time of the search gone into that."""
    figure = facts.between_tasks("locate-source", "locate-brute", "v3y")
    bound = figure and figure._replace(low=0.0)
    words = "the tree misses {} of the points: more would take longer by brute force than the whole search took"
    printed = MISSED if figure else None
    return [Reading("v3y, points missed by the tree", words, bound, most=0.01, unit="%", printed=printed)]


FINDINGS = (
    Finding(
        "best-overall",
        "V3Y, property arrays with flag and list, is the best of the seven, without compromise.",
        "6.1",
        "each of the others takes longer than v3y over all scenarios with the source's counts",
        totals,
    ),
    Finding(
        "deletion",
        "V3 and V5 are strikingly bad at deletion, for they keep their list of holes sorted.",
        "5.2.3",
        f"both take {HOPELESS:g} times as long as v3y at least",
        deletion,
    ),
    Finding(
        "deletion-size",
        "How long V3 and V5 take to delete does not depend on the size of the net, for the list is as long.",
        "5.2.3",
        "a deletion takes neither twice nor half as long on the nozzle as on the intake, which has a quarter of the tetras",
        deletion_by_size,
        remark="Times of two models come from different rounds: the range over the launches stands for an interval.",
        models=("nozzle",),
    ),
    Finding(
        "scanning",
        "V3X and V5X are unfit where many tetras are inserted: they look through the whole net for the next free slot.",
        "5.2.2",
        f"both take {HOPELESS:g} times as long as v3y in explode at least",
        scanning,
    ),
    Finding(
        "scanning-records",
        "V5X takes an order of magnitude longer than V3X to explode, for it scans whole records, V3X volumes alone.",
        "5.2.2",
        f"v5x takes {ORDER:g} times as long as v3x at least: beyond that it is nearer to ten times than to once",
        scanning_records,
        remark="By its tables V5X took 7.2 times as long as V3X on the nozzle, 9.4 times on the intake.",
    ),
    Finding(
        "sweeps",
        "Property arrays are swept faster than records and linked nodes.",
        "5.2.4",
        "in alfa and flow v4 takes longer than v3y, and each of v5, v5x, v5y than the v3, v3x, v3y that keeps its holes alike",
        sweeps,
    ),
    Finding(
        "sweeps-fields",
        "The more fields of a tetra a sweep uses, the less property arrays gain: V4 takes 93 % more time than V3Y in alfa, "
        "58 % more in flow.",
        "5.2.4",
        "v4's and v5y's multiples of v3y's time are larger in alfa than in flow",
        sweeps_by_fields,
        remark="Its tables give 89 and 53 % on the nozzle, 80 and 42 % on the intake.",
    ),
    Finding(
        "sweeps-holes",
        "There is no considerable difference between the sweeps of V3 and those of V3X.",
        "4.4.2",
        f"in alfa and flow v3 and v3x differ by less than a factor of {LIKE:g}",
        sweeps_by_holes,
        remark="Its own tables say otherwise: V3 takes 12 to 26 % longer than V3X.",
    ),
    Finding(
        "sweeps-flag",
        "On the intake V3X sweeps faster than V3Y, though their sweeps are the same: V3Y takes 14 % longer in alfa, 20 % "
        "in flow.",
        "table of figure 11",
        "in alfa and flow v3y takes longer than v3x",
        sweeps_of_the_intake,
        remark="Its text does not mention it.",
        models=("intake",),
    ),
    Finding(
        "memory",
        "Linked nodes (V4) need about 4 % more memory than arrays.",
        "5.1",
        "v4 needs 2 to 6 % more than v3y at the peak; in its structure alone where no peak was measured",
        memory,
        remark="Its pointers had 4 bytes, today's have 8.",
    ),
    Finding(
        "freeing",
        "V4 takes somewhat longer to free, which is still negligible beside all else.",
        "5.2.1",
        f"v4 takes more than {LIKE:g} times as long as v3y, and less than {100 * LITTLE:g} % of its own total",
        freeing,
        remark="By its tables V4 took 3.5 times as long as V3Y on the nozzle, 1.4 times on the intake.",
    ),
    Finding(
        "allocating",
        "To allocate 640,000 nodes one by one is not noticeably slower than to allocate one array: reading dominates init.",
        "5.2.1, 6.1",
        f"in init v4 takes less than {LIKE:g} times as long as v3y and as v5",
        allocating,
    ),
    Finding(
        "edits",
        "V3Y deletes and inserts as fast as linked nodes (V4).",
        "5.2.3",
        f"in delete and explode v3y takes less than {LIKE:g} times as long as v4",
        edits,
    ),
    Finding(
        "holes",
        "V3Y pays 8 bytes for a deleted tetra, which V4 pays for every tetra: it never needs more memory than V4.",
        "5.2.3",
        "v3y's structure grows by 8 bytes for each deletion at most, beside that of v3x, which has no list",
        holes,
        remark="The 8 bytes are reckoned, not measured: an index and a pointer. Ours is a stack of indices.",
    ),
    Finding(
        "searching",
        "With the search tree 155,325 points are found in 2.3 s, by brute force in 1443 s (V3Y on the intake).",
        "5.2.5",
        "a point takes 100 times as long by brute force as with the tree at least",
        searching,
        remark="Brute force takes longer the larger the net; today's asks for a sample of the points.",
    ),
    Finding(
        "missing",
        "The tree misses only 34 of 155,325 points (0.02 %), which every tetra has then to be asked for.",
        "5.2.5",
        "the tree misses less than 1 % of the points",
        missing,
        remark="Today's search asks every tetra by itself and does not count how often: its time sets a bound.",
    ),
)


def _rows(name: str) -> list[dict[str, str]]:
    """The lines of a file beside this one, by the names of the columns."""
    text = files("tetrabench.sources").joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def _numbers(row: dict[str, str], names: Sequence[str]) -> Iterator[tuple[str, float | None]]:
    return ((name, float(row[name]) if row[name] else None) for name in names)


CONTESTANTS = {
    "v3": "property arrays, sorted list of holes",
    "v3x": "property arrays, flag + scan",
    "v3y": "property arrays, flag + list",
    "v4": "linked nodes, no holes",
    "v5": "array of records, sorted list of holes",
    "v5x": "array of records, flag + scan",
    "v5y": "array of records, flag + list",
}
"""Titles as in the family's table, which decides how they look."""


def _times() -> dict[str, dict[str, dict[str, float | None]]]:
    times: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in _rows("tetra-times-seconds.csv"):
        times.setdefault(row["model"], {})[row["scenario"]] = dict(_numbers(row, list(CONTESTANTS)))
    return times


SOURCE = Source(
    title="Nagyméretű tetraéderhálózatok hatékony kezelési módszereinek vizsgálata",
    author="József Martin",
    place="Széchenyi István University, Győr",
    year=2011,
    machine="Intel Core2 T6400, 2 GHz, 2 MB of L2, 2 GB; gcc 4.4.3 -O3 -march=native -fprefetch-loop-arrays "
    "-funroll-loops -ffast-math",
    reference="v3y",
    contestants=CONTESTANTS,
    figures={"nozzle": "figure 10", "intake": "figure 11"},
    models={"nozzle": "642,700 tetras", "intake": "155,325 tetras"},
    counts={
        "delete": {"deletions": 20_000},
        "explode": {"splits": 50_000},
        "alfa": {"sweeps": 200},
        "flow": {"sweeps": 200},
    },
    times=_times(),
    spoken={"intake": {"locate-source": {"v3y": 2.3}, "locate-brute": {"v3y": 1443.0}}},
    memory={row["model"]: {name: int(row[name]) for name in CONTESTANTS} for row in _rows("tetra-memory-kB.csv")},
    findings=FINDINGS,
    notes=(
        "V5Y's init on the nozzle is printed as 0.00 s, a misprint: it is left empty, here and in totals.",
        "Both models are lost; today's have their shape and their size.",
        "Each of the source's times was taken once and printed to a hundredth of a second, which is a tenth of some.",
    ),
)
