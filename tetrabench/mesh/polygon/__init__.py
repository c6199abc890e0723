"""Meshes of polygons: what they hold, how they hang together, what is refused, models."""

from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh

__all__ = ["PolygonMesh"]
