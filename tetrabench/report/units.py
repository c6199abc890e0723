"""Figures for people: three digits and the unit that fits."""


def digits(value: float) -> str:
    """Three digits, or all before the point where there are more: 0.62, 1.24, 12.4, 124, 1,240."""
    return f"{value:,.0f}" if value >= 99.95 else f"{value:.1f}" if value >= 9.995 else f"{value:.2f}"


def two_digits(ratio: float) -> str:
    """A ratio in two digits; near 1, where they would say nothing, in three: 0.62, 1.03, 1.2, 12, 1,240."""
    return f"{ratio:,.0f}" if ratio >= 9.95 else f"{ratio:.1f}" if ratio >= 1.05 else f"{ratio:.2f}"


def times(ratio: float) -> str:
    """How many times as much, in two digits where that is enough: 0.62x, 1.2x, 12x, 1,240x."""
    return f"{two_digits(ratio)}x"


def span(low: float, high: float) -> str:
    """An interval: 0.98-1.03, 11.9-12.4."""
    return f"{digits(low)}-{digits(high)}"


def percent(share: float) -> str:
    """A share: 43 %, 0.4 %, <0.1 %."""
    if 0 < share < 0.0005:
        return "<0.1 %"
    return f"{100 * share:.0f} %" if share >= 0.0095 or share == 0 else f"{100 * share:.1f} %"


def duration(seconds: float) -> str:
    """A time with its unit: 1.24 s, 842 ms, 3.10 us, 84.0 ns."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.9995 * size:
            return f"{digits(seconds / size)} {unit}"
    return f"{digits(seconds / 1e-9)} ns"


def singular(things: str) -> str:
    """One of what `protocols` counts in the plural: tetras -> tetra, splits -> split."""
    return things.removesuffix("s")


def one_of(thing: str) -> str:
    """A tetra, an object."""
    return f"an {thing}" if thing[0] in "aeiou" else f"a {thing}"


def counted(number: int, things: str) -> str:
    """1 tetra, 642,816 tetras, of what `protocols` counts in the plural."""
    return f"{number:,} {singular(things) if number == 1 else things}"


def plural(number: int, thing: str) -> str:
    """1 launch, 8 launches."""
    return f"{number:,} {thing}" + ("" if number == 1 else "es" if thing.endswith("ch") else "s")
