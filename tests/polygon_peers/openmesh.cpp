// OpenMesh's PolyMesh: half-edges by index. Ranges of its own, the polygons added one by one.
#include <OpenMesh/Core/Mesh/DefaultPolyMesh.hh>
#include <OpenMesh/Core/System/config.h>

#include <memory>
#include <vector>

#include "peer.h"

using Mesh = OpenMesh::PolyMesh;  // as it comes: coordinates in double, no status, no normals

static inline std::int32_t number_of_cells(const Mesh* mesh) { return mesh->n_faces(); }

static inline std::int32_t number_of_nodes(const Mesh* mesh) { return mesh->n_vertices(); }

static inline std::int32_t cell_nodes(const Mesh* mesh, std::int32_t c, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto v : mesh->fv_ccw_range(OpenMesh::FaceHandle(c))) out[n++] = v.idx();
    return n;
}

// What is not there is left out, here and around a node.
static inline std::int32_t cell_neighbours(const Mesh* mesh, std::int32_t c, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto f : mesh->ff_ccw_range(OpenMesh::FaceHandle(c))) out[n++] = f.idx();
    return n;
}

static inline std::int32_t node_cells(const Mesh* mesh, std::int32_t v, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto f : mesh->vf_ccw_range(OpenMesh::VertexHandle(v))) out[n++] = f.idx();
    return n;
}

static inline std::int32_t node_neighbours(const Mesh* mesh, std::int32_t v, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto w : mesh->vv_ccw_range(OpenMesh::VertexHandle(v))) out[n++] = w.idx();
    return n;
}

PEER

EXPORT void* build(const Polygons* from) {
    auto mesh = std::make_unique<Mesh>();
    mesh->reserve(from->nodes, from->edges, from->cells);
    for (std::int32_t v = 0; v < from->nodes; ++v) {
        const double* at = from->points + 3 * std::int64_t(v);
        mesh->add_vertex(Mesh::Point(at[0], at[1], at[2]));
    }
    std::vector<OpenMesh::VertexHandle> polygon;
    for (std::int32_t c = 0; c < from->cells; ++c) {
        polygon.clear();
        for (std::int32_t x = from->starts[c]; x < from->starts[c + 1]; ++x) polygon.emplace_back(from->items[x]);
        if (!mesh->add_face(polygon.data(), polygon.size()).is_valid()) return nullptr;
    }
    return mesh.release();
}

EXPORT void drop(void* built) { delete static_cast<Mesh*>(built); }

EXPORT std::int32_t version() { return OM_VERSION; }
