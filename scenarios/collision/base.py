"""What the scenarios on moving objects share."""

from tetrabench.scenarios.base import BaseScenario


class CollisionScenario(BaseScenario):
    """A workload on objects."""

    family = "collision"
