"""The memory pass: what a contestant's structure takes, in a process of its own that does nothing else."""

from collections.abc import Callable
from pathlib import Path

from tetrabench.bench.messages import Done, Failed, Open, Reply, Request, Weigh, Weighed
from tetrabench.bench.record import Backend, Memory
from tetrabench.bench.ring import Worker
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError


def weigh(spawn: Callable[[], Worker], family: str, backend: Backend, model: str, path: Path) -> Memory:
    """Let a fresh worker build the structure of a model, and say what memory that takes.

    Args:
        spawn: makes a worker in the environment `memory.WEIGHING`.
        family: that the contestant belongs to.
        backend: the contestant.
        model: name of the model; path: its file.

    Raises:
        InputError: the model cannot be used.
    """
    requests: list[Request] = [
        Open(family, backend.contestant, options=backend.options),
        Weigh(str(path)),
    ]
    reply = _last_reply(spawn(), requests)
    if isinstance(reply, Weighed) and reply.compiled:  # the compiler got in the way: again, without it
        reply = _last_reply(spawn(), requests)
    match reply:
        case Weighed():
            return Memory(
                model=model,
                backend=backend.name,
                structure=reply.structure,
                retained_bytes=reply.retained_bytes,
                peak_bytes=reply.peak_bytes,
            )
        case WorkerDied():
            return Memory(model=model, backend=backend.name, status=reply.status, reason=str(reply))
        case Failed(reason, exit_code, oom):
            if exit_code and not oom:
                raise InputError(reason)
            return Memory(model=model, backend=backend.name, status="oom" if oom else "error", reason=reason)
    raise AssertionError(reply)


def _last_reply(worker: Worker, requests: list[Request]) -> Reply | WorkerDied:
    """What the worker says last, or the first thing that is not Done."""
    reply: Reply = Done(0.0)
    try:
        for request in requests:
            if isinstance(reply, Done):
                reply = worker.ask(request)
        worker.close()
    except WorkerDied as death:
        return death
    finally:
        worker.kill()
    return reply
