"""Pictures for the docs: the page that `tetrabench report` makes of the committed runs, its figures, and nets.

`make screenshots` makes them all anew, in docs/pictures. It needs Chromium (on Debian: apt install chromium), which
Playwright drives.
"""

import argparse
import io
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image, ImageChops

ROOT = Path(__file__).parents[1]
PICTURES = Path(__file__).parent / "pictures"
RUNS = ["reference-nozzle", "reference-intake"]
PROVISIONAL = ["nozzle-120k-quick"]
"""In results/: what the page is made of, and what of while those are not there."""

DESK = {"viewport": {"width": 1280, "height": 900}}
PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True}
SCREENS: dict[str, tuple[str, dict[str, Any]]] = {
    "report-top": ("", DESK),
    "report-dark": ("scenarios", DESK | {"color_scheme": "dark"}),
    "report-phone": ("scenarios", PHONE),
}
"""The page: name of the picture -> the section that it shows, its top unless given, and what the browser is like."""
FIGURES = {
    "figure-times": ("times", "times-alfa"),
    "figure-samples": ("samples", "samples-alfa"),
    "figure-trade": ("trade", ""),
    "figure-fields": ("fields", ""),
    "figure-growth": ("growth", ""),
    "figure-limits": ("limits", ""),
}
"""One of each kind, the first where the page has not the one named; none where it has not the kind."""
BARE = "#controls { position: static !important } figure:not(.times, .samples) .scroll { display: none }"
"""The controls would lie on a tall figure; tables beneath one, rather than beside it, would make it taller still."""
NETS = {
    "nozzle-surface": "nozzle --tets 30k",
    "nozzle-cut": "nozzle --tets 120k --cut y=50%",
}
"""What `tetrabench view` is told."""
WATCHED = "--objects 1k --gravity 0.1 --bounce 0.9 --steps 1500"
"""What `tetrabench watch` is told."""

MOST_BYTES = 150_000
MARGIN = 12  # pixels
NET_WIDE = 900  # pixels
QUIET = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-sync"]


def tetrabench(*arguments: str | Path) -> None:
    """Run the command line."""
    subprocess.run([sys.executable, "-m", "tetrabench", *map(str, arguments)], check=True)


def save(picture: bytes | Path, name: str, *, is_net: bool = False, is_trimmed: bool = False) -> None:
    """Save a PNG with a palette, which takes a third of the room.

    Args:
        picture: a PNG.
        name: without its suffix.
        is_net: as wide as NET_WIDE, and with all of its colours where there is room: a palette makes steps of shades.
        is_trimmed: without its margins.

    Raises:
        SystemExit: it takes more than MOST_BYTES all the same.
    """
    with Image.open(picture if isinstance(picture, Path) else io.BytesIO(picture)) as opened:
        image = opened.convert("RGB")
    if is_trimmed:
        image = trim(image)
    if is_net:
        image = image.resize((NET_WIDE, round(image.height * NET_WIDE / image.width)), Image.Resampling.LANCZOS)
    path = PICTURES / f"{name}.png"
    image.save(path, optimize=True)
    if not is_net or path.stat().st_size > MOST_BYTES:
        # the only method that keeps rare colours, such as those of marks
        palette: dict[str, Any] = {"method": Image.Quantize.MAXCOVERAGE, "kmeans": 3, "dither": Image.Dither.NONE}
        image.quantize(256, **palette).save(path, optimize=True)
    size = path.stat().st_size
    if size > MOST_BYTES:
        sys.exit(f"{path.name}: {size:,} bytes, more than {MOST_BYTES:,}; show less of it")
    print(f"{path.relative_to(ROOT)}: {image.width} x {image.height}, {size:,} bytes")


def trim(image: Image.Image) -> Image.Image:
    """What differs from the colour of the first pixel, and MARGIN around it."""
    plain = Image.new("RGB", image.size, image.getpixel((0, 0)))
    left, top, right, bottom = ImageChops.difference(image, plain).getbbox() or (0, 0, *image.size)
    framed = Image.new("RGB", (right - left + 2 * MARGIN, bottom - top + 2 * MARGIN), image.getpixel((0, 0)))
    framed.paste(image.crop((left, top, right, bottom)), (MARGIN, MARGIN))
    return framed


def draw_nets(folder: Path) -> None:
    """The pictures of nets."""
    for name, told in NETS.items():
        file = folder / f"{name}.png"
        tetrabench("view", *told.split(), "-o", file)
        save(file, name, is_net=True)


def draw_objects(folder: Path) -> None:
    """The picture of objects that have fallen."""
    file = folder / "collision-watch.png"
    tetrabench("watch", *WATCHED.split(), "--record", file)
    save(file, file.stem, is_net=True)


def make_report(folder: Path) -> Path:
    """The page of the committed runs."""
    page = folder / "report.html"
    files = [ROOT / "results" / f"{name}.json" for name in RUNS]
    if not all(file.exists() for file in files):
        files = [ROOT / "results" / f"{name}.json" for name in PROVISIONAL]
    tetrabench("report", *files, "-o", page)
    return page


@contextmanager
def chromium() -> Iterator[Any]:
    """A browser.

    Raises:
        SystemExit: there is none.
    """
    from playwright.sync_api import sync_playwright

    path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if path is None:
        sys.exit("no Chromium here; on Debian: apt install chromium")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=QUIET)
        yield browser
        browser.close()


def draw_report(page_file: Path) -> None:
    """The pictures of the page, and of its figures."""
    with chromium() as browser:
        for name, (section, screen) in SCREENS.items():
            page = opened(browser, page_file, screen)
            if section:
                page.evaluate("name => document.getElementById(name).scrollIntoView()", section)
                await_chart(page, page.locator(f"#{section} .chart").first)
                page.wait_for_timeout(1000)  # and the others on the screen
            save(page.screenshot(), name)
            page.context.close()
        page = opened(browser, page_file, DESK)
        page.add_style_tag(content=BARE)
        for name, (kind, wanted) in FIGURES.items():
            figures = page.locator(f"figure.{kind}")
            named = figures.filter(has=page.locator(f'[data-figure="{wanted}"]'))
            if figures.count():
                figure = (named if named.count() else figures).first
                await_chart(page, figure.locator(".chart"))
                save(figure.screenshot(), name, is_trimmed=True)


def opened(browser: Any, file: Path, screen: dict[str, Any]) -> Any:
    """The page in a window of its own."""
    page = browser.new_context(device_scale_factor=1, **screen).new_page()
    page.goto(file.as_uri())
    return page


def await_chart(page: Any, chart: Any) -> None:
    """Wait until a chart is drawn live, which it is once it is seen."""
    chart.scroll_into_view_if_needed()
    page.wait_for_function("chart => chart.dataset.drawn", arg=chart.element_handle())


def main() -> None:
    """All of them, or those of the page, of nets, or of objects."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", metavar="report|nets|objects", help="what to make, all unless given")
    wanted = parser.parse_args().what or ["report", "nets", "objects"]
    if strange := ", ".join(one for one in wanted if one not in ("report", "nets", "objects")):
        parser.error(f"no {strange}; there are: report, nets, objects")
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        if "report" in wanted:
            draw_report(make_report(Path(folder)))
        if "nets" in wanted:
            draw_nets(Path(folder))
        if "objects" in wanted:
            draw_objects(Path(folder))


if __name__ == "__main__":
    main()
