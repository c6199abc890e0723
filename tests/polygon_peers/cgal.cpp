// CGAL's Surface_mesh: half-edges by index. Circulators of its own, the polygons added one by one.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <memory>
#include <vector>

#include "peer.h"

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

static inline std::int32_t number_of_cells(const Mesh* mesh) { return mesh->number_of_faces(); }

static inline std::int32_t number_of_nodes(const Mesh* mesh) { return mesh->number_of_vertices(); }

// Its circulators turn counter-clockwise around a face, and clockwise around a vertex: there they are stepped back.
static inline std::int32_t cell_nodes(const Mesh* mesh, std::int32_t c, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto v : vertices_around_face(mesh->halfedge(Mesh::Face_index(c)), *mesh)) out[n++] = v;
    return n;
}

static inline std::int32_t cell_neighbours(const Mesh* mesh, std::int32_t c, std::int32_t* out) {
    std::int32_t n = 0;
    for (const auto f : faces_around_face(mesh->halfedge(Mesh::Face_index(c)), *mesh)) out[n++] = f;  // none: -1
    return n;
}

static inline std::int32_t node_cells(const Mesh* mesh, std::int32_t v, std::int32_t* out) {
    const Mesh::Face_around_target_circulator begin(mesh->halfedge(Mesh::Vertex_index(v)), *mesh);
    auto turning = begin;
    std::int32_t n = 0;
    do out[n++] = *turning;
    while (--turning != begin);
    return n;
}

static inline std::int32_t node_neighbours(const Mesh* mesh, std::int32_t v, std::int32_t* out) {
    const Mesh::Vertex_around_target_circulator begin(mesh->halfedge(Mesh::Vertex_index(v)), *mesh);
    auto turning = begin;
    std::int32_t n = 0;
    do out[n++] = *turning;
    while (--turning != begin);
    return n;
}

PEER

EXPORT void* build(const Polygons* from) {
    auto mesh = std::make_unique<Mesh>();
    mesh->reserve(from->nodes, from->edges, from->cells);
    for (std::int32_t v = 0; v < from->nodes; ++v) {
        const double* at = from->points + 3 * std::int64_t(v);
        mesh->add_vertex(Point(at[0], at[1], at[2]));
    }
    std::vector<Mesh::Vertex_index> polygon;
    for (std::int32_t c = 0; c < from->cells; ++c) {
        polygon.clear();
        for (std::int32_t x = from->starts[c]; x < from->starts[c + 1]; ++x) polygon.emplace_back(from->items[x]);
        if (mesh->add_face(polygon) == Mesh::null_face()) return nullptr;
    }
    return mesh.release();
}

EXPORT void drop(void* built) { delete static_cast<Mesh*>(built); }

EXPORT std::int32_t version() { return CGAL_VERSION_NR; }
