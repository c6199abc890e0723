"""The source of the collision family: a Slovene paper about a 2D simulator with a k-d tree, its figures and what it found.

Its pictures have no figures in the text that we have, so that its curves are drawn anew rather than compared. Each finding
is asked twice: of `leaf-only`, which searches as its published code does, and of `kdtree`, which searches as its text says.
Sections are those of the paper.
"""

from collections.abc import Callable

from tetrabench.bench.statistics import Interval
from tetrabench.sources import Curve, Curves, Figure, Finding, Reading, Source

LIKE = 1.1
"""Up to here two times are alike: no curve of the source could show less."""
LITTLE = 1.5
"""Up to here a time depends little on something; the source's word for its figure 11."""
MUCH = 2.0
"""From here on it depends much on it."""
FLAT = 1.25
"""Up to here a curve is nearly flat along the run."""
GROWN = 1.5
"""From here on leaves have multiplied."""
KINK = 1.15
"""What an object costs more at twice as many, beyond the 8 % that O(log n) asks for at 50,000."""
OPTIMUM = (8, 10)  # objects a leaf
KNEE = 50_000  # objects
LARGE, LARGEST = 100_000, 200_000

OBJECTS, CAPACITY, CONCENTRATION = "figure 7", "figure 8", "figure 11"
WEIGHTLESS, WEIGHTLESS_OFF, GRAVITY_OFF, GRAVITY = "figure 12", "figure 13", "figure 14", "figure 15"
LEAVES = "leaves"


def over(figure: Interval | None, number: float) -> Interval | None:
    """A figure divided by a number, ends and all."""
    return figure and Interval(figure.ratio / number, figure.low / number, figure.high / number, figure.is_whole)


def an_object(curves: Curves, objects: int, others: int, *, least: float = 0.0, most: float = float("inf")) -> Reading:
    """The time of an object at one size, beside another size."""
    return Reading(
        f"{curves.contestant}, an object at {objects:,} / at {others:,}",
        f"an object of {objects:,} takes {{}} as long as one of {others:,}",
        over(curves.between(OBJECTS, objects, others), objects / others),
        least,
        most,
    )


def kink(curves: Curves) -> list[Reading]:
    """An object below the knee and beyond it."""
    return [an_object(curves, LARGE, KNEE, least=KINK)]


def linear(curves: Curves) -> list[Reading]:
    """An object of many and one of twice as many."""
    return [an_object(curves, LARGEST, LARGE, least=1 / FLAT, most=FLAT)]


def optimum(curves: Curves) -> list[Reading]:
    """The ends of the curve beside its least place."""
    places = curves.places(CAPACITY)
    best = curves.least(CAPACITY, places)
    ends = (("least", min(places, default=None)), ("greatest", max(places, default=None)))
    return [
        Reading(
            f"{curves.contestant}, the {which} capacity / the best",
            f"capacity {_spelled(end)} takes {{}} as long as capacity {_spelled(best)}",
            curves.between(CAPACITY, end, best),
            LIKE,
        )
        for which, end in ends
    ]


def optimum_at(curves: Curves) -> list[Reading]:
    """The best of the source's optimum beside the best of all."""
    places = curves.places(CAPACITY)
    best = curves.least(CAPACITY, places)
    known = curves.least(CAPACITY, [place for place in places if OPTIMUM[0] <= place <= OPTIMUM[1]])
    return [
        Reading(
            f"{curves.contestant}, capacity 8 to 10 / the best",
            f"capacity {_spelled(known)} takes {{}} as long as capacity {_spelled(best)}",
            curves.between(CAPACITY, known, best),
            most=LIKE,
        )
    ]


def concentration(least: float = 0.0, most: float = float("inf")) -> Callable[[Curves], list[Reading]]:
    """The dearest concentration beside the cheapest."""

    def readings(curves: Curves) -> list[Reading]:
        places = curves.places(CONCENTRATION)
        best = curves.least(CONCENTRATION, places)
        worst = curves.most(CONCENTRATION, places)
        return [
            Reading(
                f"{curves.contestant}, the dearest concentration / the cheapest",
                f"at {_spelled(worst)} square units an object a step takes {{}} as long as at {_spelled(best)}",
                curves.between(CONCENTRATION, worst, best),
                least,
                most,
            )
        ]

    return readings


def grown(
    curves: Curves, curve: str, when: str, count: str = "", *, least: float = 0.0, most: float = float("inf")
) -> Reading:
    """The end of a run beside its beginning."""
    what = count or "time of a step"
    words = f"the last tenth of a run {when} has {{}} as many {count} as the first"
    if not count:
        words = f"a step in the last tenth of a run {when} takes {{}} as long as in the first"
    return Reading(
        f"{curves.contestant}, {what} {when}, last tenth / first", words, curves.grown(curve, count), least, most
    )


def recycled(
    curves: Curves, off: str, on: str, when: str, count: str = "", *, least: float = 0.0, most: float = float("inf")
) -> Reading:
    """A run without recycling beside one with it."""
    words = f"{when} a run without recycling takes {{}} as long as one with it"
    if count:
        words = f"{when} a run without recycling ends with {{}} as many {count} as one with it"
    about = f"{curves.contestant}, {count or 'time'} {when}, without recycling / with it"
    return Reading(about, words, curves.beside(off, on, count), least, most)


def rebuilding(curves: Curves) -> list[Reading]:
    """Leaves of a tree that is recycled: those of one that is built of the same objects are as many as at first."""
    return [
        grown(curves, curve, f"{when} with recycling", LEAVES, most=GROWN)
        for curve, when in ((WEIGHTLESS, "without gravity"), (GRAVITY, "under gravity"))
    ]


def distribution(curves: Curves) -> list[Reading]:
    """What recycling saves in leaves where space stays empty, beside what it saves where it does not."""
    emptied = curves.beside(GRAVITY_OFF, GRAVITY, LEAVES)
    spread = curves.beside(WEIGHTLESS_OFF, WEIGHTLESS, LEAVES)
    return [
        Reading(
            f"{curves.contestant}, leaves without recycling / with it, under gravity / without gravity",
            "what a run without recycling has in leaves at its end, as a multiple of one with it, is {} as much under "
            "gravity as without",
            over(emptied, spread.ratio) if spread else None,
            GROWN,
        )
    ]


def no_effect(curves: Curves) -> list[Reading]:
    """Recycling where no space stays empty."""
    return [recycled(curves, WEIGHTLESS_OFF, WEIGHTLESS, "without gravity", least=1 / LIKE, most=LIKE)]


def growing(curves: Curves) -> list[Reading]:
    """Gravity without recycling."""
    return [
        grown(curves, GRAVITY_OFF, "under gravity without recycling", LEAVES, least=GROWN),
        grown(curves, GRAVITY_OFF, "under gravity without recycling", least=FLAT),
    ]


def flat(curves: Curves) -> list[Reading]:
    """Gravity with recycling."""
    return [grown(curves, GRAVITY, "under gravity with recycling", most=FLAT)]


def _spelled(place: float | None) -> str:
    return "?" if place is None else f"{place:,.0f}"


FINDINGS = (
    Finding(
        "hypothesis 1",
        "Hypothesis 1: there is an optimal number of objects in a leaf.",
        "1.1, 5.2",
        f"the least and the greatest capacity take {LIKE:g} times as long as the best one at least",
        optimum,
    ),
    Finding(
        "optimum",
        "It found the optimum between 8 and 10.",
        "5.2, figure 8",
        f"the better one of 8 and 10 takes at most {LIKE:g} times as long as the best capacity",
        optimum_at,
        remark="A search in the own leaf alone makes small leaves cheap: that they miss more contacts costs nothing.",
    ),
    Finding(
        "hypothesis 2",
        "Hypothesis 2: the concentration of objects strongly influences the speed.",
        "1.1, 5.3",
        f"the dearest concentration takes {MUCH:g} times as long as the cheapest at least",
        concentration(least=MUCH),
    ),
    Finding(
        "concentration",
        "It found that concentration matters relatively little.",
        "5.3, figure 11",
        f"the dearest concentration takes at most {LITTLE:g} times as long as the cheapest",
        concentration(most=LITTLE),
        remark="Its code keeps one hit an object; leaf-only hands over all pairs in a leaf, of which there are many where "
        "circles cannot but overlap.",
    ),
    Finding(
        "hypothesis 3",
        "Hypothesis 3: recycling avoids having to rebuild the tree.",
        "1.1, 5.4",
        f"with recycling a run ends with at most {GROWN:g} times the leaves that it began with, a tree just built",
        rebuilding,
    ),
    Finding(
        "hypothesis 4",
        "Hypothesis 4: how the objects are distributed strongly influences what recycling achieves.",
        "1.1, 5.4",
        f"what recycling saves in leaves by the end of a run is {GROWN:g} times as much under gravity as without at least",
        distribution,
    ),
    Finding(
        "no effect",
        "It found that without gravity recycling has next to no effect on the speed.",
        "5.4.1, figures 12 and 13",
        f"with and without recycling a run takes the same within {LIKE:g} times",
        no_effect,
    ),
    Finding(
        "growing",
        "It found that under gravity without recycling leaves multiply, which slows the simulator down a lot.",
        "5.4.2, figure 14",
        f"the last tenth of the run has {GROWN:g} times the leaves and {FLAT:g} times the time of a step at least",
        growing,
        remark="Objects on the floor come to overlap more and more, which takes time of its own.",
    ),
    Finding(
        "flat",
        "It found that under gravity with recycling the speed stays nearly constant.",
        "5.4.2, figure 15",
        f"a step of the last tenth of the run takes at most {FLAT:g} times as long as one of the first",
        flat,
        remark="Objects on the floor come to overlap more and more, which takes time of its own.",
    ),
    Finding(
        "kink",
        "Beyond some 50,000 objects the time rises more steeply, for caches are full.",
        "5.1, figure 7",
        f"of 100,000 objects each takes {KINK:g} times as long as of 50,000 at least",
        kink,
        remark="Where the caches of a machine are full is its own affair: today's are larger.",
    ),
    Finding(
        "linear",
        "Beyond some 80,000 objects the time grows nearly linearly.",
        "5.1, figure 7",
        f"of 200,000 objects each takes as long as of 100,000, within {FLAT:g} times",
        linear,
    ),
)

CONTESTANTS = {"leaf-only": "as published", "kdtree": "as it should have been"}

FIGURES = (
    Figure(
        "figure 7",
        "the time over the number of objects",
        (Curve("figure 7", "motion", "objects"),),
        across="objects",
        up="time of 1,000 steps, s",
        said=(KNEE, KNEE),
        said_words="the source: steeper from here",
    ),
    Figure(
        "figure 8",
        "the time over the capacity of a leaf",
        (Curve("figure 8", "motion", "capacity"),),
        across="capacity, objects a leaf",
        up="time of 1,000 steps, s",
        said=OPTIMUM,
        said_words="the source: least here",
    ),
    Figure(
        "figure 11",
        "the time over the concentration",
        (Curve("figure 11", "concentration", "area"),),
        across="square units an object: few are a high concentration",
        up="time of 1,000 steps, s",
        is_log=True,
        notes=("A circle covers 314 square units: below that they cannot but overlap.",),
    ),
    Figure(
        "figures 12 to 15",
        "the time of a step along the run, with recycling and without it, without gravity and under it",
        (
            Curve(WEIGHTLESS, "weightless", "step", {"recycle": 1}, "recycling, no gravity"),
            Curve(WEIGHTLESS_OFF, "weightless", "step", {"recycle": 0}, "no recycling, no gravity"),
            Curve(GRAVITY_OFF, "gravity", "step", {"recycle": 0}, "no recycling, gravity"),
            Curve(GRAVITY, "gravity", "step", {"recycle": 1}, "recycling, gravity"),
        ),
        across="step",
        up="time of a step, ms",
        up_s=1e-3,
        count=LEAVES,
    ),
)

SOURCE = Source(
    title="Optimizacija zaznave trkov v 2D",
    author="telvivace",
    place="github.com/telvivace/firja, branch mr25",
    year=2025,
    machine="a machine that the paper does not name",
    reference="kdtree",
    contestants=CONTESTANTS,
    figures={},
    models={"uniform": "10,000 objects or more, anywhere in the box, of one size"},
    counts={
        "motion": {"steps": 1000},
        "concentration": {"steps": 1000},
        "weightless": {"steps": 5000},
        "gravity": {"steps": 5000},
    },
    times={},
    memory={},
    findings=(),
    drawn=FIGURES,
    curve_findings=FINDINGS,
    notes=(
        "The paper names neither its authors nor its year: it is known here by the account and the branch of its code, and "
        "cites a book of 2024.",
        "Its published code never searches the tree for contacts: each object is tested against its own leaf alone, so that "
        "one pair in seven is missed at capacity 8. Its curves are of that. leaf-only does the same, its answers are wrong, "
        "and it ranks nowhere; kdtree finds all pairs, as the paper describes it.",
        "The other defects of its code are not repeated: objects that are processed twice in a step, impulses between "
        "strangers, pairs that depend on the order of the leaves. All contestants move their objects by the same rules.",
        "The text gives no parameters: radius 10, mass 5, velocities and the 15,000 square units an object are those of its "
        "code, or decided here.",
    ),
)
