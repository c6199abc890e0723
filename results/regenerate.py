"""Repeat the committed runs, and write what the pages show of them anew: `make results`, `make reference`, `make thesis`."""

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import collision_tables
import library
import polygon_tables

RESULTS = Path(__file__).parent
README, FINDINGS, HALFFACE, POLYGON, COLLISION, LIBRARY = (
    RESULTS.parent / "README.md",
    RESULTS / "README.md",
    RESULTS.parent / "docs" / "halfface.md",
    RESULTS.parent / "docs" / "polygon.md",
    RESULTS.parent / "docs" / "collision.md",
    RESULTS.parent / "docs" / "library.md",
)
COLLISIONS = {
    "objects": "--objects 10k,20k,50k,100k,200k --scenario motion --option motion.steps=100 "
    "--backend kdtree,grid,skin,ckdtree,leaf-only",
    "capacity": "--objects 10k --scenario motion --option motion.steps=1000 --backend kdtree,leaf-only "
    "--option capacity=1,2,3,4,6,8,10,12,16,20,24,32,40,48,63",
    "concentration": "--objects 10k --scenario concentration --option concentration.steps=1000 "
    "--option concentration.area=100,300,1000,3000,10000,30000,100000,300000,1000000 "
    "--backend kdtree,grid,skin,leaf-only",
    "recycling": "--objects 10k --scenario weightless,gravity --option steps=5000 --option recycle=0,1 "
    "--backend kdtree,leaf-only",
}
"""The experiments of the source of the collision family, with its counts but for the first, which would take hours."""
RUNS = (
    {
        "nozzle-120k-quick": "--model nozzle --tets 120k --quick",
        "reference-nozzle": "--model nozzle --numbering natural,shuffled --rounds 1",
        "reference-intake": "--model intake --numbering natural,shuffled --rounds 1",
        "numbering-nozzle": "--model nozzle --numbering natural,hilbert,rcm,shuffled --backend v3y,v4,v5y "
        "--scenario alfa,flow,locate --rounds 1",
        "thesis-nozzle": "--model nozzle --thesis",
        "thesis-nozzle-shuffled": "--model nozzle --numbering shuffled --thesis",
        "thesis-intake": "--model intake --thesis",
        "thesis-intake-shuffled": "--model intake --numbering shuffled --thesis",
    }
    | {
        f"polygon-{model}": f"--family polygon --model {model} --scenario {','.join(polygon_tables.TASKS)} --rounds 1"
        + " --quick" * (model != "quad")
        for model in polygon_tables.MODELS
    }
    | {
        f"collision-{name}": f"--family collision --model uniform --rounds 1 {options}"
        for name, options in COLLISIONS.items()
    }
    | {
        "collision-bars": "--family collision --model uniform --objects 100k --scenario motion "
        "--backend kdtree,grid,skin,ckdtree --option kdtree.capacity=8,16,24,32,48,63 --reference ckdtree --rounds 1",
    }
    | {
        f"collision-{model}": f"--family collision --model {model} --objects 100k "
        f"--scenario {','.join(collision_tables.TASKS)} --backend kdtree,grid,skin,ckdtree --rounds 1"
        for model in collision_tables.MODELS
    }
)
"""File in this folder -> what `tetrabench run` is told."""
REFERENCE = ["reference-nozzle", "reference-intake"]
"""What is concluded from."""
SOURCES = {
    "source": ("tetra", REFERENCE),
    "polygon-source": ("polygon", [f"polygon-{model}" for model in polygon_tables.MODELS]),
    "collision-source": ("collision", [f"collision-{name}" for name in COLLISIONS]),
}
"""Pages about what the source of a family found: the family, and the runs that they put beside it."""


def tetrabench(*arguments: str) -> str:
    """Run the command line and return what it printed; progress goes where it always goes."""
    command = [sys.executable, "-m", "tetrabench", *arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def table(name: str) -> str:
    """The table of a committed run."""
    return tetrabench("show", file_of(name), "--format", "md").strip()


def advice() -> str:
    """What to use, by the reference runs: a line for each usual mix of work, a column for each model; then what they are."""
    from tetrabench.bench import read_results
    from tetrabench.registry import workloads
    from tetrabench.report.advice.mix import mix_words
    from tetrabench.report.advice.recommend import recommend_usual
    from tetrabench.report.advice.words import advice_of, title_of

    known = workloads("tetra")
    given = [one for name in REFERENCE for one in recommend_usual(read_results(Path(file_of(name))), known.values())]
    models = list(dict.fromkeys(one.model for one in given))
    cells = {(one.workload, one.model): title_of(one).removeprefix("use ") for one in given}
    lines = [["use", *models], ["---"] * (1 + len(models))]
    lines += [[f"for {name}", *(cells[name, model] for model in models)] for name in known]
    first = {one.workload: one for one in reversed(given)}
    words = [f"- **{name}**, {one.title}: {mix_words(first[name].mix)}." for name, one in known.items()]
    costs = [f"- {one.model}, {one.workload}: {advice_of(one)}" for one in given]
    return "\n".join([_markdown(lines), "", *words, "", "What it costs to take the next one:", "", *costs])


def findings(page: str) -> str:
    """Which findings of a source still hold: the overview of a page about it."""
    from tetrabench.bench import read_results
    from tetrabench.registry import source
    from tetrabench.report.thesis.comparison import compare_with_source
    from tetrabench.report.thesis.page import overview_as_markdown

    family, names = SOURCES[page]
    runs = [read_results(Path(file_of(name))) for name in names]
    return overview_as_markdown(compare_with_source(runs, source(family)))


def numbering() -> str:
    """Layout beside numbering."""
    from tetrabench.bench import read_results
    from tetrabench.report.numbering import make_numbering_pages
    from tetrabench.report.table import markdown_of

    return markdown_of(make_numbering_pages(read_results(Path(file_of("numbering-nozzle"))))).strip()


def beside_cgal() -> str:
    """The half-face kernel beside CGAL and plain C++: rows, memory, and what a query costs in meshes of all sizes."""
    found = json.loads(Path(file_of("cgal-623k")).read_text())
    sizes = list(dict.fromkeys(point["tetras"] for point in found["curve"]))
    costs = {(one["way"], one["numbering"], one["tetras"]): 1e9 * one["query_s"] for one in found["curve"]}
    curve = [["ns a query", *(f"{size:,}" for size in sizes)], ["---"] + ["---:"] * len(sizes)]
    for way, numbering in dict.fromkeys(key[:2] for key in costs):
        curve.append([f"{way}, {numbering}", *(f"{costs[way, numbering, size]:,.0f}" for size in sizes)])
    weights = ", ".join(f"{one['structure']}, {one['numbering']} {one['per_tetra']:.1f}" for one in found["memory"])
    return "\n\n".join([contests("cgal-623k"), f"Retained bytes a tetra: {weights}.", _markdown(curve)])


def contests(name: str) -> str:
    """The rows of a bench that puts something of ours beside a peer."""
    verdict = {None: "", True: "met", False: "**missed**"}
    lines = [
        ["operation", "numbering", "beside", "ours, ms", "theirs, ms", "ratio", "95 %", "bar", ""],
        ["---"] * 3 + ["---:"] * 5 + ["---"],
    ]
    for row in json.loads(Path(file_of(name)).read_text())["rows"]:
        about = [row["operation"], row["numbering"], row["peer"]]
        times = [_figure(1e3 * row[side]) for side in ("ours_s", "peer_s")]
        interval, bar = f"{_figure(row['low'])} to {_figure(row['high'])}", f"{row['bar']:g}" if row["bar"] else ""
        lines.append([*about, *times, _figure(row["ratio"]), interval, bar, verdict[row["met"]]])
    return _markdown(lines)


def made(make: Callable[[], list[list[str]]]) -> str:
    """A table of docs/polygon.md or docs/collision.md."""
    return _markdown(make())


def polygon_peers() -> str:
    """The formats of polygon meshes beside other libraries."""
    return "\n\n".join(map(_markdown, polygon_tables.peers()))


def _figure(value: float) -> str:
    return f"{value:.3g}" if value < 100 else f"{value:,.0f}"


def _markdown(lines: list[list[str]]) -> str:
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def file_of(name: str) -> str:
    """The results file of a run."""
    return str(RESULTS / f"{name}.json")


BLOCKS: dict[str, tuple[Path, Callable[[], str]]] = {
    "what to use": (FINDINGS, advice),
    "findings of the source": (FINDINGS, partial(findings, "source")),
    "layout and numbering": (FINDINGS, numbering),
    "half-faces beside CGAL": (HALFFACE, beside_cgal),
    "half-faces beside packages": (HALFFACE, partial(contests, "peers-examples")),
    "findings about polygons": (POLYGON, partial(findings, "polygon-source")),
    "findings about collisions": (COLLISION, partial(findings, "collision-source")),
    "collision bars": (COLLISION, partial(made, collision_tables.bars)),
    "collision models": (COLLISION, partial(made, collision_tables.models)),
    "polygon values": (POLYGON, partial(made, polygon_tables.values)),
    "polygon queries": (POLYGON, partial(made, polygon_tables.queries)),
    "polygon shares": (POLYGON, partial(made, polygon_tables.shares)),
    "polygon peers": (POLYGON, polygon_peers),
    "library speed": (LIBRARY, partial(made, library.table)),
} | {
    f"table {name}": (README if name == "nozzle-120k-quick" else FINDINGS, partial(table, name))
    for name in RUNS
    if name != "numbering-nozzle" and not name.startswith(("polygon-", "collision-"))
}
"""What stands between two marks: on which page, and what it says."""


def marks(block: str) -> tuple[str, str]:
    """What stands around a block on its page."""
    return f"<!-- {block}: begin -->", f"<!-- {block}: end -->"


def shown(block: str) -> str:
    """What the page shows."""
    begin, end = marks(block)
    page, _ = BLOCKS[block]
    return page.read_text().partition(begin)[2].partition(end)[0].strip()


def rewrite(block: str) -> None:
    """Write a block anew."""
    (page, make), (begin, end) = BLOCKS[block], marks(block)
    text = f"{begin}\n{make()}\n{end}"
    page.write_text(re.sub(f"{begin}.*{end}", lambda _: text, page.read_text(), flags=re.DOTALL))


def regenerate(names: list[str], *, run: bool) -> Iterator[str]:
    """Run what is named, draw its charts, and write all that the pages show anew; or only draw and write."""
    for name in names:
        folder = RESULTS / name
        folder.mkdir(exist_ok=True)
        if run:
            yield f"running {name}"
            tetrabench("run", *RUNS[name].split(), "-o", file_of(name))
        yield f"drawing {name}"
        tetrabench("show", file_of(name), "--charts", str(folder))
    for page, (_, beside) in SOURCES.items():
        if set(names) & set(beside):
            yield f"writing {page}.md"
            tetrabench("report", *map(file_of, beside), "--thesis", "-o", str(RESULTS / f"{page}.md"))
    for block in BLOCKS:
        yield f"writing {block}"
        rewrite(block)


def main() -> None:
    """The runs named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="*", metavar="RUN", help=", ".join(RUNS))
    parser.add_argument("--table", action="store_true", help="run nothing, show what is committed")
    options = parser.parse_args()
    strange = ", ".join(name for name in options.runs if name not in RUNS)
    if strange:
        parser.error(f"no run {strange}; there are: {', '.join(RUNS)}")
    for done in regenerate(options.runs or list(RUNS), run=not options.table):
        print(done, file=sys.stderr)


if __name__ == "__main__":
    main()
