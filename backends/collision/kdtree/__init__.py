"""kdtree: the source's structure, a k-d tree whose leaves hold up to `capacity` objects. Source: chapters 3 and 4."""
