"""The scenarios on tetrahedral nets, each written once, against the interface alone."""

from tetrabench.scenarios.tetra.alfa import Alfa
from tetrabench.scenarios.tetra.centroid import Centroid
from tetrabench.scenarios.tetra.deform import Deform
from tetrabench.scenarios.tetra.delete import Delete
from tetrabench.scenarios.tetra.explode import Explode
from tetrabench.scenarios.tetra.flow import Flow
from tetrabench.scenarios.tetra.free import Free
from tetrabench.scenarios.tetra.generate import Generate, GenerateByAdding
from tetrabench.scenarios.tetra.init import Init
from tetrabench.scenarios.tetra.locate import Locate, LocateBrute, LocateSource
from tetrabench.scenarios.tetra.select import Select
from tetrabench.scenarios.tetra.write import Write

SCENARIOS = [
    Init(),
    Delete(),
    Explode(),
    Alfa(),
    Flow(),
    Locate(),
    LocateSource(),
    LocateBrute(),
    Deform(),
    Select(),
    Centroid(),
    Generate(),
    GenerateByAdding(),
    Write(),
    Free(),
]
