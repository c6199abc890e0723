"""Figures for people: three digits and the unit that fits."""


def digits(value: float) -> str:
    """Three digits, or all before the point where there are more: 0.62, 1.24, 12.4, 124, 1,240."""
    return f"{value:,.0f}" if value >= 99.95 else f"{value:.1f}" if value >= 9.995 else f"{value:.2f}"


def times(ratio: float) -> str:
    """How many times as much, in two digits where that is enough: 0.62x, 1.2x, 12x, 1,240x."""
    return f"{ratio:,.0f}x" if ratio >= 9.95 else f"{ratio:.1f}x" if ratio >= 0.995 else f"{ratio:.2f}x"


def duration(seconds: float) -> str:
    """A time with its unit: 1.24 s, 842 ms, 3.10 us, 84.0 ns."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.9995 * size:
            return f"{digits(seconds / size)} {unit}"
    return f"{digits(seconds / 1e-9)} ns"


def singular(things: str) -> str:
    """One of what `protocols` counts in the plural: tetras -> tetra, splits -> split."""
    return things.removesuffix("s")
