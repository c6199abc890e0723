// What plain loops over flat arrays take: adjacency, the tetra nearest to the centroid, the tetras around all vertices.
//
// tets (n, 4) int32, xyz (vertices, 3) double, all in C order. Volumes are absolute.
#include <cmath>
#include <cstdint>
#include <limits>

#include "sides.h"

namespace {

struct Place {
    double x, y, z;
};

double volume_of(const std::int32_t* tet, const double* xyz) {
    const double *p = xyz + 3 * std::int64_t(tet[0]), *q = xyz + 3 * std::int64_t(tet[1]);
    const double *r = xyz + 3 * std::int64_t(tet[2]), *s = xyz + 3 * std::int64_t(tet[3]);
    const double ax = q[0] - p[0], ay = q[1] - p[1], az = q[2] - p[2];
    const double bx = r[0] - p[0], by = r[1] - p[1], bz = r[2] - p[2];
    const double cx = s[0] - p[0], cy = s[1] - p[1], cz = s[2] - p[2];
    return std::fabs(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6;
}

Place centroid_of(const std::int32_t* tet, const double* xyz) {
    const double *p = xyz + 3 * std::int64_t(tet[0]), *q = xyz + 3 * std::int64_t(tet[1]);
    const double *r = xyz + 3 * std::int64_t(tet[2]), *s = xyz + 3 * std::int64_t(tet[3]);
    return {(p[0] + q[0] + r[0] + s[0]) / 4, (p[1] + q[1] + r[1] + s[1]) / 4, (p[2] + q[2] + r[2] + s[2]) / 4};
}

}  // namespace

extern "C" {

void plain_sides(const std::int32_t* tets, std::int64_t n, std::int64_t vertices, std::int32_t* opposite) {
    match_sides(tets, n, vertices, opposite);
}

// Volume of the tetra whose centroid is nearest to that of the mesh, in which tetras weigh by their volume.
double plain_centroid(const std::int32_t* tets, std::int64_t n, const double* xyz) {
    double whole = 0, x = 0, y = 0, z = 0;
    for (std::int64_t t = 0; t < n; ++t) {
        const double volume = volume_of(tets + 4 * t, xyz);
        const Place at = centroid_of(tets + 4 * t, xyz);
        whole += volume;
        x += volume * at.x, y += volume * at.y, z += volume * at.z;
    }
    x /= whole, y /= whole, z /= whole;
    double least = std::numeric_limits<double>::infinity(), found = 0;
    for (std::int64_t t = 0; t < n; ++t) {
        const Place at = centroid_of(tets + 4 * t, xyz);
        const double dx = at.x - x, dy = at.y - y, dz = at.z - z, distance = dx * dx + dy * dy + dz * dz;
        if (distance < least) least = distance, found = volume_of(tets + 4 * t, xyz);
    }
    return found;
}

// The tetras around vertex v are rows[starts[v]], ..., rows[starts[v + 1] - 1]: starts (vertices + 1,), rows (4 n,).
void plain_table(const std::int32_t* tets, std::int64_t n, std::int64_t vertices, std::int32_t* starts, std::int32_t* rows) {
    std::vector<std::int32_t> ends(vertices + 2, 0);
    for (std::int64_t k = 0; k < 4 * n; ++k) ++ends[tets[k] + 2];
    for (std::int64_t v = 2; v < vertices + 2; ++v) ends[v] += ends[v - 1];
    for (std::int64_t k = 0; k < 4 * n; ++k) rows[ends[tets[k] + 1]++] = static_cast<std::int32_t>(k >> 2);
    std::copy(ends.begin(), ends.end() - 1, starts);
}

// Sum of the numbers of the tetras around all vertices, and how many there are.
std::uint64_t plain_walk(const std::int32_t* starts, const std::int32_t* rows, std::int64_t vertices, std::int64_t* visits) {
    std::uint64_t sum = 0;
    for (std::int64_t v = 0; v < vertices; ++v) {
        for (std::int32_t k = starts[v]; k < starts[v + 1]; ++k) sum += rows[k];
        *visits += starts[v + 1] - starts[v];
    }
    return sum;
}

// The same with a look at each tetra: sum of the smallest vertices. `ascending` (n, 4): those of each tetra in order.
std::uint64_t plain_touch(const std::int32_t* starts, const std::int32_t* rows, std::int64_t vertices,
                          const std::int32_t* ascending, std::int64_t* visits) {
    std::uint64_t sum = 0;
    for (std::int64_t v = 0; v < vertices; ++v) {
        for (std::int32_t k = starts[v]; k < starts[v + 1]; ++k) sum += ascending[4 * std::int64_t(rows[k])];
        *visits += starts[v + 1] - starts[v];
    }
    return sum;
}

// The same around some vertices, `queries` (count,).
std::uint64_t plain_ask(const std::int32_t* starts, const std::int32_t* rows, const std::int32_t* ascending,
                        const std::int64_t* queries, std::int64_t count) {
    std::uint64_t sum = 0;
    for (std::int64_t k = 0; k < count; ++k)
        for (std::int32_t place = starts[queries[k]]; place < starts[queries[k] + 1]; ++place)
            sum += ascending[4 * std::int64_t(rows[place])];
    return sum;
}

// A cube of side^3 subcubes with six tetras each: tets (6 side^3, 4), all of positive volume, xyz ((side + 1)^3, 3) in the
// unit cube. Each tetra goes from the lowest corner of its subcube to the highest one, along the axes in one of 6 orders.
void plain_cube(std::int64_t side, std::int32_t* tets, double* xyz) {
    const std::int64_t line = side + 1, step[3] = {1, line, line * line};
    const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    for (std::int64_t z = 0; z < line; ++z)
        for (std::int64_t y = 0; y < line; ++y)
            for (std::int64_t x = 0; x < line; ++x) {
                *xyz++ = double(x) / side, *xyz++ = double(y) / side, *xyz++ = double(z) / side;
            }
    for (std::int64_t z = 0; z < side; ++z)
        for (std::int64_t y = 0; y < side; ++y)
            for (std::int64_t x = 0; x < side; ++x)
                for (int k = 0; k < 6; ++k) {
                    const std::int64_t a = x + y * step[1] + z * step[2], b = a + step[order[k][0]];
                    const std::int64_t c = b + step[order[k][1]], d = c + step[order[k][2]];
                    *tets++ = a, *tets++ = b, *tets++ = k < 3 ? c : d, *tets++ = k < 3 ? d : c;
                }
}

}  // extern "C"
