"""The verb on results that people look at: report."""

from __future__ import annotations

from pathlib import Path

import click

from tetrabench.cli.options import FILE, check_folder
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError


@click.command()
@click.argument("results", type=FILE, nargs=-1, required=True, metavar="RESULTS.json ...")
@click.option("-o", "--output", required=True, metavar="FILE.html", type=FILE, callback=check_folder, help="The page.")
@click.option("--thesis", is_flag=True, help="Beside what the source published, finding by finding. Also as FILE.md.")
def report(results: tuple[Path, ...], output: Path, thesis: bool) -> None:
    """Make one page of runs that were saved: charts that answer, the numbers beside them, no network needed.

    The page opens in any browser from anywhere. With --thesis the comparison with the source leads it; FILE.md is that
    comparison alone, its figures beside it.
    """
    from tetrabench.bench import read_results
    from tetrabench.drafts import drafted
    from tetrabench.report.page import make_page

    suffixes = (".html", ".htm", ".md") if thesis else (".html", ".htm")
    if output.suffix.lower() not in suffixes:
        more = "" if thesis else "; with --thesis also as FILE.md"
        raise InputError(f"{output}: a report is written as FILE{' or FILE'.join(suffixes)}{more}")
    runs = [(path.stem, read_results(path)) for path in results]
    if output.suffix.lower() == ".md":
        from tetrabench.report.thesis.page import write_markdown

        write_markdown([run for _, run in runs], output)
    else:
        extra = []
        if thesis:
            from tetrabench.report.thesis.page import make_section

            with patience("drawing the source's figures"):
                extra.append(make_section([run for _, run in runs]))
        with patience(f"drawing the charts of {len(runs)} run{'s' * (len(runs) > 1)}") as step:
            page = make_page(runs, extra=extra, step=step)
        with drafted(output) as draft:
            draft.write_text(page, encoding="utf-8")
    is_page = output.suffix.lower() != ".md"
    say(
        f"wrote {output}; open it in a browser"
        if is_page
        else f"wrote {output}, its figures in {output.with_suffix('')}"
    )
