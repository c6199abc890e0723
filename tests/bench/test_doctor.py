"""What can be trusted: each fact on machines made of files, and what is said about it."""

import os
from pathlib import Path

import pytest

from tetrabench.bench import doctor
from tetrabench.bench.doctor import BAD, CAREFUL, OK, Fact

GIB = 2**30
CPU = "sys/devices/system/cpu"


def machine(folder: Path, **files: str) -> Path:
    """A machine with these files, named by what `FILES` says."""
    for name, text in files.items():
        path = folder / FILES[name]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


FILES = {
    "cpu_max": "sys/fs/cgroup/cpu.max",
    "governor": f"{CPU}/cpu0/cpufreq/scaling_governor",
    "no_turbo": f"{CPU}/intel_pstate/no_turbo",
    "boost": f"{CPU}/cpufreq/boost",
    "smt": f"{CPU}/smt/active",
    "huge": "sys/kernel/mm/transparent_hugepage/enabled",
    "rollup": "proc/self/smaps_rollup",
}


@pytest.mark.parametrize(
    ("files", "look", "value", "state"),
    [
        ({}, doctor.cores, "4", OK),
        ({"cpu_max": "max 100000\n"}, doctor.cores, "4", OK),
        ({"cpu_max": "800000 100000\n"}, doctor.cores, "4", OK),
        ({"cpu_max": "150000 100000\n"}, doctor.cores, "4, of which 1.5 may be used", CAREFUL),
        ({"governor": "performance\n"}, doctor.governor, "performance", OK),
        ({"governor": "powersave\n"}, doctor.governor, "powersave", CAREFUL),
        ({}, doctor.governor, "not shown", CAREFUL),
        ({"no_turbo": "1\n"}, doctor.turbo, "off", OK),
        ({"no_turbo": "0\n"}, doctor.turbo, "on", CAREFUL),
        ({"boost": "0\n"}, doctor.turbo, "off", OK),
        ({"boost": "1\n"}, doctor.turbo, "on", CAREFUL),
        ({}, doctor.turbo, "not shown", CAREFUL),
        ({"smt": "1\n"}, doctor.siblings, "two threads a core", CAREFUL),
        ({"smt": "0\n"}, doctor.siblings, "none", OK),
        ({}, doctor.siblings, "not shown", OK),
        ({"huge": "always [madvise] never\n"}, doctor.huge_pages, "madvise", OK),
        ({"huge": "[always] madvise never\n"}, doctor.huge_pages, "always", CAREFUL),
        ({}, doctor.huge_pages, "not shown", OK),
        ({"rollup": "Rss: 5 kB\nPrivate_Dirty: 4 kB\n"}, doctor.rollup, "can be read (smaps_rollup)", OK),
        ({}, doctor.rollup, "not shown", CAREFUL),
    ],
)
def test_what_the_system_tells(tmp_path, monkeypatch, files, look, value, state):
    monkeypatch.setattr(doctor, "usable_cores", lambda: [0, 1, 2, 3])
    found = look(machine(tmp_path, **files))
    assert (found.value, found.state) == (value, state)
    assert bool(found.advice) == (state != OK)


def test_a_single_core(tmp_path, monkeypatch):
    monkeypatch.setattr(doctor, "usable_cores", lambda: [0])
    assert doctor.cores(tmp_path).state == CAREFUL


@pytest.mark.parametrize(
    ("found", "state"),
    [
        (doctor.load_of(0.1, 2), OK),
        (doctor.load_of(1.5, 2), CAREFUL),
        (doctor.load_of(2.5, 2), BAD),
        (doctor.load_of(2.5, 64), OK),
        (doctor.load_of(None, 2), CAREFUL),
        (doctor.steal(0.0), OK),
        (doctor.steal(0.05), CAREFUL),
        (doctor.steal(0.2), BAD),
        (doctor.steal(None), CAREFUL),
        (doctor.free_memory(8 * GIB), OK),
        (doctor.free_memory(GIB), CAREFUL),
        (doctor.free_memory(GIB // 4), BAD),
        (doctor.free_memory(None), CAREFUL),
    ],
)
def test_figures_and_what_they_mean(found: Fact, state: str):
    assert found.state == state
    assert bool(found.advice) == (state != OK)


def test_a_process_that_must_not_be_pinned(monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setaffinity", refuse, raising=False)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    assert (doctor.pinning().value, doctor.pinning().state) == ("refused: Operation not permitted", CAREFUL)
    monkeypatch.delattr(os, "sched_setaffinity")
    assert doctor.pinning().value == "not on this system"


def test_pinning_leaves_the_process_where_it_was():
    before = os.sched_getaffinity(0)
    assert doctor.pinning().state == OK
    assert os.sched_getaffinity(0) == before


@pytest.mark.parametrize(("step", "state"), [(500, OK), (50_000, CAREFUL), (10_000_000, BAD)])
def test_a_coarse_clock(monkeypatch, step, state):
    ticks = iter(range(10**6))
    monkeypatch.setattr(doctor.time, "thread_time_ns", lambda: next(ticks) // 3 * step)
    assert (doctor.clock().value, doctor.clock().state) == (f"{step / 1000:.3g} us", state)


def test_peaks_that_cannot_be_reset(monkeypatch):
    monkeypatch.setattr(doctor, "reset_peak", lambda: False)
    assert doctor.peaks().state == CAREFUL
    monkeypatch.setattr(doctor, "reset_peak", lambda: True)
    monkeypatch.setattr(doctor, "peak_bytes", lambda: 5)
    assert doctor.peaks().state == OK


def test_the_cache_folder(tmp_path, monkeypatch):
    assert doctor.cache(tmp_path / "not" / "yet").state == OK
    full = type("usage", (), {"free": GIB // 2})
    monkeypatch.setattr(doctor.shutil, "disk_usage", lambda _: full)
    assert doctor.cache(tmp_path).state == CAREFUL
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert doctor.cache(tmp_path / "not").state == BAD
    assert not (tmp_path / "not").exists()


def spread(*jumps: float) -> Fact:
    """Of sixty pairs that differ by these shares in turn."""
    ours = [1 + jumps[k % len(jumps)] for k in range(60)]
    return doctor.spread_of(ours, [1.0] * 60)


def test_the_same_work_twice():
    assert spread(0.01, -0.01).state == OK
    assert "ratio 1.000, interval 0.990-1.010; one pair in ten off by 1%" in spread(0.01, -0.01).value
    assert spread(0.3, -0.3, 0.0, 0.01, -0.01).state == CAREFUL  # single pairs lie
    assert "under 2 %" in spread(0.3, -0.3, 0.0, 0.01, -0.01).advice
    assert spread(0.2, 0.21).state == BAD


def test_the_roles_of_the_a_a_take_turns():
    now = iter(range(1000))
    found = doctor.same_work_twice(lambda: None, lambda: float(next(now)), pairs=12)
    assert found.value.startswith("ratio 1.000, interval 1.000-1.000")


def test_too_little_memory_for_the_yardsticks(monkeypatch):
    def fail():
        raise MemoryError

    monkeypatch.setattr("tetrabench.bench.yardsticks.measure_yardsticks", fail)
    (found,) = doctor.yardsticks()
    assert (found.state, found.advice) == (CAREFUL, "too little memory")


def test_all_facts_on_a_machine_that_tells_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(doctor, "yardsticks", lambda: iter(()))
    monkeypatch.setattr(doctor, "same_work_twice", lambda: spread(0.0))
    facts = list(doctor.examine(tmp_path))
    assert len({fact.name for fact in facts}) == len(facts) == 15
    assert all(fact.advice for fact in facts if fact.state != OK)
