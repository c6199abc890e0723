"""What workers find wrong with the contestants of a plug-in file, in plain Python."""

import os
from contextlib import closing
from pathlib import Path

from tetrabench.bench.conformance import MODES, PLAIN
from tetrabench.bench.messages import Describe, Examine, Examined, Open
from tetrabench.bench.spawn import WorkerProcess

ROOT = Path(__file__).parents[1]


def environment(plugin):
    """What lets a worker import a plug-in file of the tests."""
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    return {"TETRABENCH_PLUGINS": str(plugin), "PYTHONPATH": os.pathsep.join(filter(None, paths))}


def first_sentences(family, plugin, names, notes):
    """By contestant: what the first rule that it breaks has to say; nothing of one that breaks none."""
    found = {}
    with closing(WorkerProcess(environment={**environment(plugin), **MODES[PLAIN]}, timeout_s=120)) as worker:
        rules = [rule.name for rule in worker.ask(Describe(family)).rules]
        assert rules
        for name in names:
            worker.ask(Open(family, name))
            for rule in rules:
                reply = worker.ask(Examine(rule, str(notes), 100))
                assert isinstance(reply, Examined), reply
                if reply.faults:
                    found[name] = reply.faults[0]
                    break
    return found
