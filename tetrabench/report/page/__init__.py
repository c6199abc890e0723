"""Runs as one self-contained page that a browser opens from anywhere: charts, the numbers beside them, nothing fetched."""

from tetrabench.report.page.page import make_page

__all__ = ["make_page"]
