"""The scenarios on objects that move, each written once, against the interface alone."""

from tetrabench.scenarios.collision.build import Build
from tetrabench.scenarios.collision.motion import Concentration, Gravity, Impulses, Motion, Weightless
from tetrabench.scenarios.collision.windows import Windows

SCENARIOS = [Build(), Motion(), Concentration(), Weightless(), Gravity(), Impulses(), Windows()]
