"""What can go wrong for a person, with the exit code the command line gives it."""


class TetrabenchError(Exception):
    """One clear line for a person: what is wrong and what to do next. Never a traceback."""

    exit_code = 2


class InputError(TetrabenchError):
    """A file, mesh or option that cannot be taken. Files are named as `path:line: reason`."""

    exit_code = 2


class RepairableError(InputError):
    """A mesh whose faulty tetras can be left out: `--repair drop` does that."""


class WrongAnswerError(TetrabenchError):
    """A contestant's cell crashed or gave another answer than the others."""

    exit_code = 3


class MemoryRefusedError(InputError):
    """What needs more memory than there is, refused before the memory is gone."""

    exit_code = 6
