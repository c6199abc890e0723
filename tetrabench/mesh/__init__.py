"""Input data: a mesh as arrays, its models (generators) and numberings."""

from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

__all__ = ["MeshReport", "TetraMesh"]
