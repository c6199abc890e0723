"""The scenarios on meshes of polygons, each written once, against the interface alone."""

from tetrabench.scenarios.polygon.build import Build
from tetrabench.scenarios.polygon.gasdynamics import GAS_SCENARIOS
from tetrabench.scenarios.polygon.queries import QUERY_SCENARIOS

SCENARIOS = [Build(), *QUERY_SCENARIOS, *GAS_SCENARIOS]
