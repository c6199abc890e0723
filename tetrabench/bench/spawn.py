"""The parent's end of a worker: spawn it, ask it, notice when it dies or does not answer."""

import os
import selectors
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tetrabench.bench.messages import Reply, Request, decode_reply, encode

_THREAD_COUNTS = (
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_PATIENCE_S = 10.0  # for a worker that was told to close, or whose pipe is closed
_CHUNK = 2**16


class WorkerDied(Exception):  # noqa: N818 - what happened, and not always by an error
    """The worker is gone; the message says how, such as "signal 11 (Segmentation fault)".

    Attributes:
        status: what that makes of its cell: a status of `record.Sample`.
    """

    def __init__(self, reason: str, status: str = "crash") -> None:
        super().__init__(reason)
        self.status = status


class WorkerProcess:
    """A worker in a process of its own, with an address space of its own."""

    def __init__(
        self,
        threads: int = 1,
        *,
        checkout: Path | None = None,
        environment: Mapping[str, str] | None = None,
        timeout_s: float | None = None,
    ) -> None:
        """Spawn it.

        Args:
            threads: how many it may use.
            checkout: a folder with packages that it imports first: another version of tetrabench.
            environment: what is set there beside our own environment.
            timeout_s: the longest wait for a reply; None: no limit.
        """
        paths = [str(path) for path in (checkout, os.environ.get("PYTHONPATH")) if path]
        self._process = subprocess.Popen(
            # -P: nothing that lies in the current folder gets in the way of what it imports
            [sys.executable, "-P", "-m", "tetrabench.bench.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={
                **os.environ,
                **dict.fromkeys(_THREAD_COUNTS, str(threads)),
                **({"PYTHONPATH": os.pathsep.join(paths)} if paths else {}),
                **(environment or {}),
            },
            start_new_session=True,  # Ctrl-C is for the parent, which then decides
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests, self._replies = self._process.stdin, self._process.stdout
        self._timeout_s = timeout_s
        self._killed_before = _oom_kills()
        self._is_over = False

    def ask(self, request: Request) -> Reply:
        """Send a request and wait for the reply.

        Raises:
            WorkerDied: before, during or instead; or it did not reply in time, and was killed.
        """
        try:
            self._requests.write(encode(request))
            self._requests.flush()
            return decode_reply(self._read_line())
        except TimeoutError as error:
            self.kill()
            raise WorkerDied(f"no reply within {self._timeout_s:g} s", "timeout") from error
        except (OSError, ValueError) as error:  # it had died before; it died now, and the line is none
            raise self._bury() from error

    def pin(self, cores: set[int]) -> None:
        """Let it run on these cores alone, where the system can do that."""
        if hasattr(os, "sched_setaffinity"):
            with suppress(OSError):  # it has died, which the next request will tell
                os.sched_setaffinity(self._process.pid, cores)

    def close(self) -> None:
        """Let it end."""
        with suppress(OSError, subprocess.TimeoutExpired):
            self._requests.close()
            self._process.wait(_PATIENCE_S)
        self.kill()

    def kill(self) -> None:
        """End it, and all that it has started."""
        if self._is_over:
            return
        self._is_over = True
        self._process.kill()
        if hasattr(os, "killpg"):
            with suppress(OSError):  # nobody is left
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        for pipe in (self._requests, self._replies):
            with suppress(OSError):  # there was something left to be sent
                pipe.close()

    def _read_line(self) -> bytes:
        """A reply; nothing follows it before the next request.

        Raises:
            TimeoutError: nothing came for too long.
        """
        line = b""
        with selectors.DefaultSelector() as selector, _watched(self._process.pid) as end:
            watched: list[Any] = [self._replies, *end]
            for file in watched:
                selector.register(file, selectors.EVENT_READ)
            while not line.endswith(b"\n"):
                ready = [key.fileobj for key, _ in selector.select(self._timeout_s)]
                if not ready:
                    raise TimeoutError
                if self._replies not in ready:
                    break  # it has died, though something that it has started still holds the pipe
                part = os.read(self._replies.fileno(), _CHUNK)
                if not part:
                    break
                line += part
        return line

    def _bury(self) -> WorkerDied:
        """How it ended."""
        try:
            code = self._process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.kill()
            return WorkerDied("it broke off the conversation")
        self.kill()
        if code >= 0:
            return WorkerDied(f"exit code {code}")
        if -code == signal.SIGKILL and _oom_kills() > self._killed_before:
            return WorkerDied("the system ran out of memory and killed it", "oom")
        return WorkerDied(f"signal {-code} ({signal.strsignal(-code)})")


@contextmanager
def _watched(pid: int) -> Iterator[list[int]]:
    """Something to select that is ready once a process has ended, where the system has that."""
    if not hasattr(os, "pidfd_open"):
        yield []
        return
    end = os.pidfd_open(pid)
    try:
        yield [end]
    finally:
        os.close(end)


def _oom_kills() -> int:
    """How many processes the system has killed for want of memory since it started; 0 where it does not tell."""
    try:
        fields = dict(line.split() for line in Path("/proc/vmstat").read_text().splitlines())
        return int(fields.get("oom_kill", 0))
    except (OSError, ValueError):
        return 0
