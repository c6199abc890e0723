"""The gate on trial: identical code must pass, and a scenario that has become 1.3 times slower must be caught.

    python tests/bench/gate_selftest.py

Works on a clone of the checkout, as it is committed, and with a cache of its own; takes some minutes. Exit code 0 if
the gate did both.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
WHAT = ["--model", "nozzle", "--tets", "10k", "--backend", "v3y", "--scenario", "alfa,flow"]
EFFORT = ["--launches", "12", "--rounds", "3"]  # as the gate has them: of 8, one disturbed launch leaves it open
CALL = "        average(averaging.net.storage, averaging.sweeps)\n"
SLOWER = f"""        from time import thread_time

        begin = thread_time()
{CALL}        end = thread_time()
        while thread_time() < end + 0.3 * (end - begin):
            pass
"""
NOBODY = {f"GIT_{role}_{fact}": "selftest" for role in ("AUTHOR", "COMMITTER") for fact in ("NAME", "EMAIL")}


def main() -> int:
    with tempfile.TemporaryDirectory(prefix="gate-selftest-") as folder:
        clone = Path(folder) / "clone"
        environment = {**os.environ, **NOBODY, "TETRABENCH_CACHE": f"{folder}/cache"}
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        problems = expect("identical code", gate(clone, "HEAD", environment), 0, failed=[])
        slow_down(clone / "scenarios/tetra/alfa.py")
        command = ["git", "-C", str(clone), "commit", "--quiet", "--all", "--message", "alfa takes 1.3 times as long"]
        subprocess.run(command, check=True, env=environment)
        problems += expect("alfa 1.3 times slower", gate(clone, "HEAD~1", environment), 1, failed=["alfa"])
    return 1 if problems else 0


def slow_down(file: Path) -> None:
    """The same answer, 1.3 times the CPU time."""
    text = file.read_text()
    assert text.count(CALL) == 1, f"{file}: no longer calls its kernel as this test supposes"
    file.write_text(text.replace(CALL, SLOWER))


def gate(clone: Path, base: str, environment: dict[str, str]) -> tuple[int, dict]:
    """Exit code, and what was found."""
    command = [sys.executable, "-P", "-m", "tetrabench", "gate", "--base", base, "--format", "json", *WHAT, *EFFORT]
    done = subprocess.run(command, cwd=clone, env=environment, stdout=subprocess.PIPE, text=True)
    return done.returncode, json.loads(done.stdout or '{"findings": []}')


def expect(name: str, found: tuple[int, dict], code: int, failed: list[str]) -> list[str]:
    """Say what came out; the complaints if that is not what should have."""
    exit_code, facts = found
    for one in facts["findings"]:
        ratio = f"{one['first']['ratio']:.2f}x" if one["first"] else "no ratio"
        print(f"{name}: {one['task']} {one['outcome']}, {ratio} {one['reason']}", flush=True)
    caught = [one["task"] for one in facts["findings"] if one["outcome"] == "failed"]
    problems = [] if exit_code == code else [f"exit code {exit_code}, not {code}"]
    problems += [] if caught == failed else [f"failed: {caught}, not {failed}"]
    print(f"{name}: {'; '.join(problems) or 'as it should be'}", flush=True)
    return problems


if __name__ == "__main__":
    sys.exit(main())
