"""The worker: one process, one contestant, one model. Takes samples when it is told to.

`python -m tetrabench.bench.worker`, spawned by `spawn`. Requests come in by what was its standard input,
replies go out by what was its standard output; both are moved out of the way before a contestant is imported,
which may print as it likes (it goes to standard error), and reads nothing.
"""

import gc
import math
import os
import sys
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import BinaryIO

from tetrabench import registry
from tetrabench.bench.catalogue import Registry
from tetrabench.bench.clock import Clocks, read_clocks
from tetrabench.bench.examination import faults_of, noted
from tetrabench.bench.memory import peak_bytes, private_bytes, reset_peak, trim_heap
from tetrabench.bench.messages import (
    PROTOCOL,
    Describe,
    Done,
    Examine,
    Examined,
    Failed,
    Find,
    Gauge,
    Gauged,
    Load,
    Loaded,
    Measure,
    Measured,
    Open,
    Reply,
    Request,
    Skipped,
    Warm,
    Weigh,
    Weighed,
    decode_reply,
    decode_request,
    encode,
)
from tetrabench.bench.yardsticks import measure_yardsticks
from tetrabench.errors import InputError, MemoryRefusedError, PluginWarning, TetrabenchError, UnsupportedError
from tetrabench.jit import count_compiled
from tetrabench.memory import held_to_available
from tetrabench.protocols import Contestant, Family, Options, Scenario, Stage
from tetrabench.traces import spell_error


class Worker:
    """Serves requests. Its contestant stands on a stage with the small model first, then the real one."""

    def __init__(self) -> None:
        self._stage: Stage | None = None

    def serve(self, request: Request) -> Reply:
        """Do what is asked. An exception of a contestant's becomes the reply."""
        try:
            return self._do(request)
        except MemoryError as error:
            return Failed(f"not enough memory: {_one_line(error)}", oom=True)
        except MemoryRefusedError as error:
            return Failed(_one_line(error), error.exit_code, oom=True)
        except UnsupportedError as error:
            return Skipped(_one_line(error))
        except (Exception, SystemExit) as error:
            return Failed(_one_line(error), error.exit_code if isinstance(error, InputError) else 0)

    def close(self) -> None:
        """Clear the stage."""
        if self._stage is not None:
            self._stage.close()
            self._stage = None

    def _do(self, request: Request) -> Reply:
        start = perf_counter()
        match request:
            case Open():
                if request.protocol != PROTOCOL:
                    raise InputError(f"messages of version {request.protocol}; this tetrabench knows {PROTOCOL}")
                self._family: Family = registry.family(request.family)
                self._contestant: Contestant = registry.contestant(request.family, request.contestant, request.options)
                self._chained = request.chained
                return Done(perf_counter() - start)
            case Warm():
                if self._stage is None:
                    self._set_stage(self._family.small_model())
                compiled = count_compiled()
                reply = self._measure(request.scenario, request.options, 1)
                if isinstance(reply, Skipped):
                    return reply
                return Done(perf_counter() - start, count_compiled() - compiled)
            case Load():
                stage = self._set_stage(Path(request.model))
                stage.model_size()  # reads the model
                gc.collect()
                gc.freeze()  # the compiler's objects: to look through them before each sample takes 50 ms
                return Loaded(_structure(stage))
            case Measure():
                return self._measure(request.scenario, request.options, request.repeats)
            case Weigh():
                return self._weigh(Path(request.model))
            case Examine():
                with noted(Path(request.notes), request.patience_s):
                    return Examined(faults_of(self._family, self._contestant, request.rule))
            case Gauge():
                return Gauged(measure_yardsticks())
            case Describe():
                return Registry().describe(request.family)
            case Find():
                return Registry().find_model(request)

    def _set_stage(self, model: Path) -> Stage:
        self.close()
        self._stage = self._family.stage(self._contestant, model, chained=self._chained)
        return self._stage

    def _weigh(self, model: Path) -> Weighed:
        """Build the structure of a model where it has been built once before, of a small one: the compiler has come and
        gone, and what it left is no part of the difference."""
        self._set_stage(self._family.small_model()).build()
        compiled = count_compiled()
        stage = self._set_stage(model)
        stage.model_size()  # the model is read: that it lies in memory is not the structure's doing
        floor, has_peak = private_bytes(), reset_peak()
        before = peak_bytes()
        stage.build()
        peak, retained = peak_bytes(), private_bytes()
        return Weighed(
            structure=_structure(stage),
            retained_bytes=None if floor is None or retained is None else retained - floor,
            peak_bytes=peak - before if has_peak and peak is not None and before is not None else None,
            compiled=compiled,
        )

    def _measure(self, name: str, options: Options, repeats: int) -> Measured | Skipped:
        scenario = registry.scenario(self._family.name, name)
        reason = scenario.skip(self._contestant)
        if reason is not None:
            return Skipped(reason)
        assert self._stage is not None, "Warm and Load set the stage"
        return take_sample(scenario, self._stage, options, repeats)


def take_sample(scenario: Scenario, stage: Stage, options: Options, repeats: int = 1) -> Measured:
    """Prepare, run, and look at what came out; only the runs are timed, each on a subject of its own."""
    prepare_s, passed, peak = 0.0, Clocks(0.0, 0.0, 0.0), 0
    for _ in range(repeats):
        subject = outcome = None  # what the one before left is gone before the next is made
        start = perf_counter()
        subject = scenario.prepare(stage, options)
        prepare_s += perf_counter() - start

        gc.collect()
        gc.disable()
        trim_heap()
        has_peak = reset_peak()
        try:
            begin = read_clocks()
            outcome = scenario.run(subject)
            passed = passed.plus(read_clocks().since(begin))
        finally:
            gc.enable()
        peak = max(peak, (peak_bytes() if has_peak else None) or 0)

    start = perf_counter()
    answer = scenario.answer(subject, outcome)
    work = scenario.work(subject, outcome)
    return Measured(
        repeats=repeats,
        prepare_s=prepare_s,
        cpu_s=passed.cpu_s,
        process_cpu_s=passed.process_cpu_s,
        wall_s=passed.wall_s,
        answer_s=perf_counter() - start,
        peak_bytes=peak or None,
        structure=_structure(stage),
        digest=answer.digest,
        figures={name: _number(figure) for name, figure in answer.figures.items()},
        items=repeats * int(work.items),
        unit=work.unit,
        least_bytes=None if work.least_bytes is None else repeats * int(work.least_bytes),
        series=_series(answer.series),
    )


def _structure(stage: Stage) -> dict[str, tuple[int, int]]:
    return {name: (int(used), int(reserved)) for name, (used, reserved) in stage.structure_bytes().items()}


def _series(series: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """The series of an answer as plain numbers.

    Raises:
        TetrabenchError: they cannot be drawn beside each other: another length, or what is no finite number.
    """
    plain = {name: [float(value) for value in values] for name, values in series.items()}
    for name, values in plain.items():
        if len(values) != len(next(iter(plain.values()))):
            lengths = ", ".join(f"{other} {len(one)}" for other, one in plain.items())
            raise TetrabenchError(f"series of one answer are all of one length, and these are not: {lengths}")
        odd = next((place for place, value in enumerate(values) if not math.isfinite(value)), None)
        if odd is not None:
            raise TetrabenchError(f"series {name}: {values[odd]}, at place {odd}, is no finite number")
    return plain


def _number(figure: float) -> float | None:
    return float(figure) if math.isfinite(figure) else None  # JSON has no other numbers


def _one_line(error: BaseException) -> str:
    """What went wrong, in a line: ours as it stands, a contestant's with its place."""
    return str(error).splitlines()[0] if isinstance(error, TetrabenchError) and str(error) else spell_error(error)


def _move_pipes() -> tuple[BinaryIO, BinaryIO]:
    """Both pipes under new numbers; 0 then reads nothing and 1 is standard error."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return requests, replies


def main() -> None:
    """Serve requests until there are no more."""
    requests, replies = _move_pipes()
    warnings.simplefilter("ignore", PluginWarning)  # whoever asks is told (`Described.skipped`), once
    worker = Worker()
    with held_to_available(), suppress(BrokenPipeError):  # nobody is there any more who asked
        for line in requests:
            replies.write(_spell(worker.serve(decode_request(line))))
            replies.flush()
            with suppress(Exception):  # a contestant may have closed it
                sys.stdout.flush()  # what it printed appears when it printed it
        worker.close()
    with suppress(OSError):
        replies.close()  # here rather than at the end of the interpreter, which would complain


def _spell(reply: Reply) -> bytes:
    """A reply as a line; where a contestant put into it what is no JSON, that is the reply."""
    try:
        line = encode(reply)
        decode_reply(line)
    except (TypeError, ValueError, OverflowError) as error:
        return encode(Failed(f"a reply that cannot be sent: {_one_line(error)}"))
    return line


if __name__ == "__main__":
    main()
