"""What runs on a model would need, before anybody starts one: memory and time, estimated from runs that are committed."""

from dataclasses import dataclass

from tetrabench import registry
from tetrabench.bench.groups import BARE_BYTES, COPIES
from tetrabench.bench.plan import EFFORTS
from tetrabench.bench.statistics import fewest_launches
from tetrabench.protocols import Needs


@dataclass(frozen=True)
class Forecast:
    """What `tetrabench run` would need. The last keys of `tetrabench info --format json`, under "needs".

    Attributes:
        net_bytes: memory for one structure of the model, at most, while it is built.
        run_bytes: for all contestants and a control, alive together; where there is less, they take turns in groups.
        least_bytes: for the smallest group: a reference, its control and one other.
        quick_s: about how long all scenarios on all contestants take with --quick, in seconds, once everything is compiled, on
            a machine as that of results/; None where nobody can say.
        run_s: without it.
    """

    net_bytes: int
    run_bytes: int
    least_bytes: int
    quick_s: float | None
    run_s: float | None


def forecast(family: str, needs: Needs) -> Forecast:
    """Estimate what runs of all contestants of a family need, where so much is known of the model."""
    contestants = sum(one.is_exact for one in registry.contestants(family))
    worker = BARE_BYTES + COPIES * needs.peak_bytes
    launches = {
        "quick": EFFORTS["quick"].launches,
        "default": max(EFFORTS["default"].launches, fewest_launches(contestants - 1)),
    }
    seconds = {name: needs.launch_s and number * needs.launch_s for name, number in launches.items()}
    return Forecast(
        net_bytes=round(needs.peak_bytes),
        run_bytes=round((contestants + 1) * worker),
        least_bytes=round(3 * worker),
        quick_s=seconds["quick"],
        run_s=seconds["default"],
    )
