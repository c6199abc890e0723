"""Our half-face kernel beside CGAL and beside plain C++, in one run: `make bench-cgal`."""
