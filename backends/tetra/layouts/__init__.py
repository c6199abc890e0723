"""Layouts: where the fields of a tetra live. One file each, all of the same shape."""
