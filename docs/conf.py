"""The documentation as a site: `make docs`. The source folder is the whole repository, so that a link from page to page, or
to a file of the code, is the same relative path here, on a code host and in a clone: a file becomes a download."""

import os
from pathlib import Path
from typing import Any

os.environ["NUMBA_DISABLE_JIT"] = "1"  # kernels are then plain functions, with signature and docstring

import docutils.nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from tetrabench import __version__, registry

ROOT = Path(__file__).parents[1]

project = "tetrabench"
author = "The tetrabench developers"
copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_click", "sphinx_copybutton"]
root_doc = "docs/index"
include_patterns = ["docs/**.md", "results/*.md", "*.md"]
exclude_patterns = [
    ".*",
    "build",
    "dist",
    "out",
    "tests",
    "notebooks",
    "tetrabench",
    "backends",
    "scenarios",
    "docs/_build",
]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
suppress_warnings = [
    "myst.header",  # pages that are included begin with a heading of their own
    "misc.highlighting_failure",  # pages show what a terminal does, too
]

default_role = "code"  # docstrings are written like Markdown
napoleon_numpy_docstring = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True}
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
nitpicky = True
nitpick_ignore_regex = [
    ("py:.*", ".*")
]  # types of numpy and of our inner modules; Markdown's links are all looked after

html_theme = "furo"
html_title = f"tetrabench {release}"
html_show_sphinx = False
smartquotes = False  # options begin with two hyphens
html_copy_source = False
copybutton_prompt_text = "$ "


class Catalogue(SphinxDirective):
    """`{catalogue} contestants tetra`: a table of what the registry holds, so that it is never behind the code."""

    required_arguments = 2

    def run(self) -> list[docutils.nodes.Node]:
        """The table, from Markdown."""
        what, family = self.arguments
        return self.parse_text_to_nodes("\n".join(getattr(self, what)(family)))

    def contestants(self, family: str) -> list[str]:
        """A row for each contestant."""
        rows = ["| name | what it is | trade-off |", "|---|---|---|"]
        for one in registry.contestants(family):
            options = [f"`{one.name}.{name}={option.value}`: {option.title}" for name, option in one.options.items()]
            rows.append(f"| `{one.name}` | {'; '.join([one.title, *options])} | {one.trade_off} |")
        return rows

    def scenarios(self, family: str) -> list[str]:
        """A row for each scenario."""
        rows = ["| name | what it does | counts |", "|---|---|---|"]
        for one in registry.scenarios(family):
            counts = ", ".join(f"`{one.name}.{name}={value:,}`" for name, value in one.options.items())
            rows.append(f"| `{one.name}` | {one.title} | {counts} |")
        return rows

    def models(self, family: str) -> list[str]:
        """A row for each model that can be generated."""
        models = registry.family(family).models
        return ["| name | what it is |", "|---|---|", *(f"| `{name}` | {title} |" for name, title in models.items())]

    def workloads(self, family: str) -> list[str]:
        """A row for each usual mix of work."""
        rows = ["| name | what it is |", "|---|---|"]
        return [*rows, *(f"| `{one.name}` | {one.title} |" for one in registry.workloads(family).values())]


def show_tables(app: Sphinx, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    """Tables of docstrings are Markdown's: shown as they stand."""
    shown: list[str] = []
    for line in lines:
        if line.lstrip().startswith(("| ", "|--")):
            if not (shown and shown[-1].lstrip().startswith("|")):
                shown += ["", "::", ""]
            shown.append("   " + line)
        else:
            shown.append(line)
    lines[:] = shown


def unlink_folders(app: Sphinx, tree: docutils.nodes.document) -> None:
    """A link to a folder leads somewhere on a code host and in a clone; here its words remain."""
    for link in list(tree.findall(pending_xref)):
        if (Path(tree["source"]).parent / str(link.get("reftarget"))).is_dir():
            link.replace_self(link.children)


def lead_to_index(app: Sphinx, error: Exception | None) -> None:
    """Whoever opens the site opens its first page."""
    if error is None and app.builder.name == "html":
        leading = (
            '<!doctype html><title>tetrabench</title><meta http-equiv="refresh" content="0; url=docs/index.html">\n'
        )
        (Path(app.outdir) / "index.html").write_text(leading)


def setup(app: Sphinx) -> None:
    """Add what this site needs beside its extensions."""
    app.add_directive("catalogue", Catalogue)
    app.connect("autodoc-process-docstring", show_tables)
    app.connect("doctree-read", unlink_folders)
    app.connect("build-finished", lead_to_index)
