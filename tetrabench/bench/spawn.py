"""The parent's end of a worker: spawn it, ask it, notice when it dies."""

import os
import signal
import subprocess
import sys
from contextlib import suppress

from tetrabench.bench.messages import Reply, Request, decode_reply, encode

_THREAD_COUNTS = (
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_PATIENCE_S = 10.0  # for a worker that was told to close, or whose pipe is closed


class WorkerDied(Exception):  # noqa: N818 - what happened, and not always by an error
    """The worker is gone; the message says how, such as "signal 11 (Segmentation fault)"."""


class WorkerProcess:
    """A worker in a process of its own, with an address space of its own."""

    def __init__(self, threads: int) -> None:
        """Spawn it. `threads`: how many it may use."""
        self._process = subprocess.Popen(
            # -P: nothing that lies in the current folder gets in the way of what it imports
            [sys.executable, "-P", "-m", "tetrabench.bench.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, **dict.fromkeys(_THREAD_COUNTS, str(threads))},
            start_new_session=True,  # Ctrl-C is for the parent, which then decides
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests, self._replies = self._process.stdin, self._process.stdout

    def ask(self, request: Request) -> Reply:
        """Send a request and wait for the reply.

        Raises:
            WorkerDied: before, during or instead.
        """
        try:
            self._requests.write(encode(request))
            self._requests.flush()
            return decode_reply(self._replies.readline())
        except (OSError, ValueError) as error:  # it had died before; it died now, and the line is none
            raise WorkerDied(self._bury()) from error

    def pin(self, core: int) -> None:
        """Let it run on this core alone, where the system can do that."""
        if hasattr(os, "sched_setaffinity"):
            with suppress(OSError):  # it has died, which the next request will tell
                os.sched_setaffinity(self._process.pid, {core})

    def close(self) -> None:
        """Let it end."""
        with suppress(OSError, subprocess.TimeoutExpired):
            self._requests.close()
            self._process.wait(_PATIENCE_S)
        self.kill()

    def kill(self) -> None:
        """End it."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._requests, self._replies):
            with suppress(OSError):  # there was something left to be sent
                pipe.close()

    def _bury(self) -> str:
        """How it ended."""
        try:
            code = self._process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.kill()
            return "it broke off the conversation"
        self.kill()
        if code >= 0:
            return f"exit code {code}"
        hint = ", out of memory perhaps" if -code == signal.SIGKILL else ""
        return f"signal {-code} ({signal.strsignal(-code)}{hint})"
