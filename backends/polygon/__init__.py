"""Formats of a mesh of polygons."""
