"""The scenarios on objects that move, each written once, against the interface alone."""

SCENARIOS: list[object] = []
