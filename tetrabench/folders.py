"""Where tetrabench keeps what it can make again: kernels, generated models, installed revisions."""

import os
from pathlib import Path

from platformdirs import user_cache_path


def cache_root() -> Path:
    """The folder of all caches of the user: TETRABENCH_CACHE, or in the user's cache directory."""
    return Path(os.environ.get("TETRABENCH_CACHE") or user_cache_path("tetrabench"))
