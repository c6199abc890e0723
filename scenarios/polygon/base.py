"""What the scenarios on meshes of polygons share."""

from tetrabench.scenarios.base import BaseScenario


class PolygonScenario(BaseScenario):
    """A workload on a net of polygons."""

    family = "polygon"
