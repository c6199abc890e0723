// CGAL's triangulations behind C functions: filled by hand and by CGAL's own call, walked, edited, weighed.
//
// tets (n, 4) int32, positively oriented; xyz (vertices, 3) double. What a function ending in _build returns is given
// back by the one ending in _free. Nothing here is fast or slow by our choice: where CGAL has a call, it is called; what it has
// none for (cells from a table) is done with the cheapest means its structure offers.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_data_structure_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/version.h>

#include <array>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <unordered_map>
#include <vector>

#include "sides.h"

#if __has_include(<CGAL/Mesh_3/tet_soup_to_c3t3.h>)  // elsewhere, and another function, from 5.6 on
#define HAS_CALL
#include <CGAL/Mesh_3/tet_soup_to_c3t3.h>
#include <CGAL/Tetrahedral_remeshing/Remeshing_triangulation_3.h>
#endif

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Tds = CGAL::Triangulation_data_structure_3<>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel>;
using NumberedVertex = CGAL::Triangulation_vertex_base_with_info_3<std::int32_t, Kernel>;
using NumberedCell = CGAL::Triangulation_cell_base_with_info_3<std::int32_t, Kernel>;
using Numbered = CGAL::Triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<NumberedVertex, NumberedCell>>;

// A structure's bare combinatorics, and cells chosen to be replaced.
struct Bare {
    Tds tds;
    std::vector<Tds::Cell_handle> chosen;
};

// The other border side at an edge of border side i of tetra t, the edge of it without vertex j; turns around the edge
// through tetras. Returns 4 * tetra + number of the side; `apart` becomes the vertex of that side that is not on the edge.
std::int32_t across_edge(const std::int32_t* tets, const std::int32_t* opposite, std::int32_t t, int i, int j, int& apart) {
    int entered = i, leave = j;
    for (;;) {
        const std::int32_t behind = opposite[4 * std::int64_t(t) + leave];
        if (behind < 0) break;
        const std::int32_t apex = tets[4 * std::int64_t(t) + entered];  // is in the next tetra, but not at its next side
        t = behind >> 2, entered = behind & 3;
        leave = 0;
        while (tets[4 * std::int64_t(t) + leave] != apex) ++leave;
    }
    apart = entered;
    return 4 * t + leave;
}

// Fill an empty structure: finite cells in order, infinite cells for border sides, adjacency. Returns the infinite vertex.
template <class Structure>
typename Structure::Vertex_handle fill(Structure& tds, const std::int32_t* tets, std::int64_t n, std::int64_t vertices,
                                       std::vector<typename Structure::Vertex_handle>& vertex,
                                       std::vector<typename Structure::Cell_handle>& cell) {
    std::vector<std::int32_t> opposite(4 * n);
    match_sides(tets, n, vertices, opposite.data());
    const auto infinite = tds.create_vertex();
    vertex.resize(vertices);
    for (auto& v : vertex) v = tds.create_vertex();
    cell.resize(n);
    for (std::int64_t t = 0; t < n; ++t) {
        const std::int32_t* tet = tets + 4 * t;
        cell[t] = tds.create_cell(vertex[tet[0]], vertex[tet[1]], vertex[tet[2]], vertex[tet[3]]);
        for (int i = 0; i < 4; ++i) vertex[tet[i]]->set_cell(cell[t]);
    }
    std::vector<std::int32_t> border;
    for (std::int32_t side = 0; side < 4 * n; ++side) {
        const std::int32_t behind = opposite[side];
        if (behind < 0) border.push_back(side);
        if (side < behind) tds.set_adjacency(cell[side >> 2], side & 3, cell[behind >> 2], behind & 3);
    }
    std::vector<typename Structure::Cell_handle> outside(border.size());
    std::unordered_map<std::int32_t, std::size_t> place(2 * border.size());
    for (std::size_t k = 0; k < border.size(); ++k) {
        const auto inside = cell[border[k] >> 2];
        const int i = border[k] & 3;
        typename Structure::Vertex_handle v[4];
        for (int j = 0; j < 4; ++j) v[j] = inside->vertex(j);
        v[i] = infinite;
        std::swap(v[(i + 1) & 3], v[(i + 2) & 3]);  // seen from the other side
        outside[k] = tds.create_cell(v[0], v[1], v[2], v[3]);
        tds.set_adjacency(inside, i, outside[k], i);
        place[border[k]] = k;
    }
    for (std::size_t k = 0; k < border.size(); ++k) {
        const std::int32_t t = border[k] >> 2;
        const int i = border[k] & 3;
        for (int j = 0; j < 4; ++j) {
            if (j == i) continue;
            int apart;
            const std::int32_t other = across_edge(tets, opposite.data(), t, i, j, apart);
            const auto beside = outside[place[other]];
            tds.set_adjacency(outside[k], outside[k]->index(vertex[tets[4 * std::int64_t(t) + j]]), beside,
                              beside->index(vertex[tets[4 * std::int64_t(other >> 2) + apart]]));
        }
    }
    if (!outside.empty()) infinite->set_cell(outside.front());
    tds.set_dimension(3);
    return infinite;
}

// The tetra behind each side, -1 where that is infinite; the cells in the order in which they were made.
template <class Structure>
void list_neighbours(Structure& tds, std::int64_t n, std::int32_t* neighbours) {
    std::unordered_map<const void*, std::int32_t> number;
    std::vector<typename Structure::Cell_handle> cells;
    for (auto c = tds.cells_begin(); c != tds.cells_end() && std::int64_t(cells.size()) < n; ++c) {
        number[&*c] = std::int32_t(cells.size());
        cells.push_back(c);
    }
    for (const auto& c : cells)
        for (int i = 0; i < 4; ++i) {
            const auto found = number.find(&*c->neighbor(i));
            *neighbours++ = found == number.end() ? -1 : found->second;
        }
}

std::vector<Point> as_points(const double* xyz, std::int64_t vertices) {
    std::vector<Point> points;
    points.reserve(vertices);
    for (std::int64_t v = 0; v < vertices; ++v) points.emplace_back(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]);
    return points;
}

}  // namespace

extern "C" {

std::int64_t cgal_version() { return CGAL_VERSION_NR; }

// ---- the bare structure, without coordinates

Bare* bare_build(const std::int32_t* tets, std::int64_t n, std::int64_t vertices) {
    Bare* bare = new Bare;
    std::vector<Tds::Vertex_handle> vertex;
    std::vector<Tds::Cell_handle> cell;
    fill(bare->tds, tets, n, vertices, vertex, cell);
    return bare;
}

void bare_free(Bare* bare) { delete bare; }

bool bare_valid(Bare* bare) { return bare->tds.is_valid(); }

void bare_neighbours(Bare* bare, std::int64_t n, std::int32_t* neighbours) { list_neighbours(bare->tds, n, neighbours); }

// counts (4,): cells, vertices, bytes of a cell, bytes of a vertex.
void bare_counts(Bare* bare, std::int64_t* counts) {
    counts[0] = bare->tds.cells().size(), counts[1] = bare->tds.vertices().size();
    counts[2] = sizeof(Tds::Cell), counts[3] = sizeof(Tds::Vertex);
}

// Choose `rows` (count,) of the cells, numbered in the order in which they were made.
void bare_choose(Bare* bare, const std::int64_t* rows, std::int64_t count) {
    std::vector<Tds::Cell_handle> cells;
    for (auto c = bare->tds.cells_begin(); c != bare->tds.cells_end(); ++c) cells.push_back(c);
    bare->chosen.clear();
    for (std::int64_t k = 0; k < count; ++k) bare->chosen.push_back(cells[rows[k]]);
}

// Delete each chosen cell and create it again, with all that names it: the structure is then as valid as it was.
std::int64_t bare_replace(Bare* bare) {
    for (auto& cell : bare->chosen) {
        Tds::Vertex_handle v[4];
        Tds::Cell_handle behind[4];
        int side[4];
        for (int i = 0; i < 4; ++i) {
            v[i] = cell->vertex(i), behind[i] = cell->neighbor(i);
            side[i] = behind[i]->index(cell);
        }
        bare->tds.delete_cell(cell);
        cell = bare->tds.create_cell(v[0], v[1], v[2], v[3]);
        for (int i = 0; i < 4; ++i) {
            bare->tds.set_adjacency(cell, i, behind[i], side[i]);
            v[i]->set_cell(cell);
        }
    }
    return std::int64_t(bare->chosen.size());
}

// ---- a triangulation whose vertices and cells know their numbers

Numbered* numbered_build(const std::int32_t* tets, std::int64_t n, const double* xyz, std::int64_t vertices) {
    Numbered* numbered = new Numbered;
    std::vector<Numbered::Vertex_handle> vertex;
    std::vector<Numbered::Cell_handle> cell;
    numbered->tds().clear();
    numbered->set_infinite_vertex(fill(numbered->tds(), tets, n, vertices, vertex, cell));
    for (std::int64_t v = 0; v < vertices; ++v) {
        vertex[v]->set_point(Point(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]));
        vertex[v]->info() = std::int32_t(v);
    }
    for (std::int64_t t = 0; t < n; ++t) cell[t]->info() = std::int32_t(t);
    return numbered;
}

void numbered_free(Numbered* numbered) { delete numbered; }

bool numbered_valid(Numbered* numbered) { return numbered->is_valid(); }

std::int64_t numbered_cell_bytes() { return sizeof(Numbered::Cell); }

double numbered_centroid(Numbered* numbered) {
    double whole = 0, x = 0, y = 0, z = 0;
    for (auto c = numbered->finite_cells_begin(); c != numbered->finite_cells_end(); ++c) {
        const Point &p = c->vertex(0)->point(), &q = c->vertex(1)->point();
        const Point &r = c->vertex(2)->point(), &s = c->vertex(3)->point();
        const double volume = std::fabs(CGAL::volume(p, q, r, s));
        whole += volume;
        x += volume * ((p.x() + q.x() + r.x() + s.x()) / 4);
        y += volume * ((p.y() + q.y() + r.y() + s.y()) / 4);
        z += volume * ((p.z() + q.z() + r.z() + s.z()) / 4);
    }
    x /= whole, y /= whole, z /= whole;
    double least = std::numeric_limits<double>::infinity(), found = 0;
    for (auto c = numbered->finite_cells_begin(); c != numbered->finite_cells_end(); ++c) {
        const Point &p = c->vertex(0)->point(), &q = c->vertex(1)->point();
        const Point &r = c->vertex(2)->point(), &s = c->vertex(3)->point();
        const double dx = (p.x() + q.x() + r.x() + s.x()) / 4 - x;
        const double dy = (p.y() + q.y() + r.y() + s.y()) / 4 - y;
        const double dz = (p.z() + q.z() + r.z() + s.z()) / 4 - z;
        const double distance = dx * dx + dy * dy + dz * dz;
        if (distance < least) least = distance, found = std::fabs(CGAL::volume(p, q, r, s));
    }
    return found;
}

// Sum of the numbers of the cells around all vertices, and how many there are.
std::uint64_t numbered_walk(Numbered* numbered, std::int64_t* visits) {
    std::uint64_t sum = 0;
    std::vector<Numbered::Cell_handle> around;
    for (auto v = numbered->finite_vertices_begin(); v != numbered->finite_vertices_end(); ++v) {
        around.clear();
        numbered->finite_incident_cells(v, std::back_inserter(around));
        for (const auto& c : around) sum += c->info();
        *visits += around.size();
    }
    return sum;
}

// The same, of the smallest vertices of the cells.
std::uint64_t numbered_touch(Numbered* numbered, std::int64_t* visits) {
    std::uint64_t sum = 0;
    std::vector<Numbered::Cell_handle> around;
    for (auto v = numbered->finite_vertices_begin(); v != numbered->finite_vertices_end(); ++v) {
        around.clear();
        numbered->finite_incident_cells(v, std::back_inserter(around));
        for (const auto& c : around)
            sum += std::min(std::min(c->vertex(0)->info(), c->vertex(1)->info()),
                            std::min(c->vertex(2)->info(), c->vertex(3)->info()));
        *visits += around.size();
    }
    return sum;
}

// ---- the Delaunay triangulation of points

Delaunay* delaunay_build(const double* xyz, std::int64_t vertices) {
    const std::vector<Point> points = as_points(xyz, vertices);
    Delaunay* delaunay = new Delaunay;
    delaunay->insert(points.begin(), points.end());
    return delaunay;
}

void delaunay_free(Delaunay* delaunay) { delete delaunay; }

bool delaunay_valid(Delaunay* delaunay) { return delaunay->is_valid(); }

std::int64_t delaunay_vertices(Delaunay* delaunay) { return delaunay->number_of_vertices(); }

double delaunay_volume(Delaunay* delaunay) {
    double volume = 0;
    for (auto c = delaunay->finite_cells_begin(); c != delaunay->finite_cells_end(); ++c)
        volume += CGAL::volume(c->vertex(0)->point(), c->vertex(1)->point(), c->vertex(2)->point(), c->vertex(3)->point());
    return volume;
}

// ---- CGAL's own way from tetras to a triangulation

#ifdef HAS_CALL

using Remeshing = CGAL::Tetrahedral_remeshing::Remeshing_triangulation_3<Kernel>;

bool call_there() { return true; }

void* call_build(const std::int32_t* tets, std::int64_t n, const double* xyz, std::int64_t vertices) {
    const std::vector<Point> points = as_points(xyz, vertices);
    std::vector<std::array<int, 5>> cells(n);
    for (std::int64_t t = 0; t < n; ++t) cells[t] = {tets[4 * t], tets[4 * t + 1], tets[4 * t + 2], tets[4 * t + 3], 1};
    const std::map<std::array<int, 3>, Remeshing::Cell::Surface_patch_index> border;
    std::vector<Remeshing::Vertex_handle> vertex;
    Remeshing* called = new Remeshing;
    CGAL::build_triangulation<Remeshing, true>(*called, points, cells, border, vertex);  // true: without its check
    return called;
}

void call_free(void* called) { delete static_cast<Remeshing*>(called); }

bool call_valid(void* called) { return static_cast<Remeshing*>(called)->tds().is_valid(); }

void call_neighbours(void* called, std::int64_t n, std::int32_t* neighbours) {
    list_neighbours(static_cast<Remeshing*>(called)->tds(), n, neighbours);
}

#else

bool call_there() { return false; }

void* call_build(const std::int32_t*, std::int64_t, const double*, std::int64_t) { return nullptr; }

void call_free(void*) {}

bool call_valid(void*) { return false; }

void call_neighbours(void*, std::int64_t, std::int32_t*) {}

#endif

}  // extern "C"
