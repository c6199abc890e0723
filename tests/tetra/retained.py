"""What a net keeps in memory, in bytes a tetra: as its buffers say, and as the system sees it, in a fresh process.

python tests/tetra/retained.py [--tets N] [--json] [v3y v5y ...]

Retained is what `Private_Dirty` of /proc/self/smaps_rollup has grown by, once the mesh that the net was made from is
gone and the allocator has given back what is free.
"""

import argparse
import gc
import json
import subprocess
import sys
from pathlib import Path

from tetrabench import registry
from tetrabench.bench.memory import trim_heap
from tetrabench.mesh.models import generate
from tetrabench.tetra.net import TetraNet

ROLLUP = Path("/proc/self/smaps_rollup")
FIELDS = ("vertex", "neighbour", "volume", "centroid", "side_area", "side_normal", "state", "records", "nodes")


def private_bytes() -> int:
    """Resident bytes that this process has written to and shares with none, without the allocator's free ones."""
    gc.collect()
    trim_heap()
    (line,) = (line for line in ROLLUP.read_text().splitlines() if line.startswith("Private_Dirty:"))
    return int(line.split()[1]) * 1024


def measure(name: str, tets: int) -> dict[str, float]:
    """Bytes a tetra of each part of a net, their sum, and what is retained; run it in a fresh process."""
    contestant = registry.contestant("tetra", name)
    TetraNet(generate("box", 100), contestant).close()  # so that the compiler has come and gone
    generate("nozzle", tets)
    before = private_bytes()
    net = TetraNet(generate("nozzle", tets), contestant)
    retained = private_bytes() - before
    parts = {part: used for part, (used, _) in net.structure_bytes().items()}
    parts["fields"] = sum(parts.pop(field, 0) for field in FIELDS)
    parts["sum"] = sum(parts.values())
    return {part: size / len(net) for part, size in [*parts.items(), ("retained", retained)] if size}


def in_fresh_process(name: str, tets: int) -> dict[str, float]:
    """`measure`, in a process of its own."""
    command = [sys.executable, __file__, "--tets", str(tets), "--json", name]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contestants", nargs="*", default=["v3y", "v5y"])
    parser.add_argument("--tets", type=int, default=642_700)
    parser.add_argument("--json", action="store_true", help="of one contestant, measured in this very process")
    options = parser.parse_args()
    if options.json:
        print(json.dumps(measure(options.contestants[0], options.tets)))
        return
    for name in options.contestants:
        parts = in_fresh_process(name, options.tets)
        print(
            name, *(f"{part} {size:.1f}" for part, size in parts.items()), f"({parts['retained'] / parts['sum']:.3f})"
        )


if __name__ == "__main__":
    main()
