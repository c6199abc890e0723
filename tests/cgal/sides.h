// Which side lies behind each side of a tetra: in buckets by the smallest vertex, matched there with those still open.
//
// The same algorithm serves as a yardstick for our construct, and to fill CGAL's structure by hand.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

struct Side {
    std::int32_t middle, largest;  // of its vertices; the smallest one is that of the bucket
    std::int32_t number;           // 4 * tetra + which of its sides: the one opposite that vertex
};

// tets (n, 4) of `vertices` vertices, opposite (n, 4): 4 * tetra + number of the side behind, -1 where there is none.
inline void match_sides(const std::int32_t* tets, std::int64_t n, std::int64_t vertices, std::int32_t* opposite) {
    std::vector<std::int32_t> starts(vertices + 2, 0);
    std::vector<Side> sides(4 * n);
    for (std::int64_t t = 0; t < n; ++t) {
        std::int32_t v[4];
        std::copy(tets + 4 * t, tets + 4 * t + 4, v);
        const std::int32_t least = std::min(std::min(v[0], v[1]), std::min(v[2], v[3]));
        for (int i = 0; i < 4; ++i) {  // a side has the smallest vertex of the tetra, unless it is opposite that
            const std::int32_t other = std::min(std::min(v[(i + 1) & 3], v[(i + 2) & 3]), v[(i + 3) & 3]);
            ++starts[(v[i] == least ? other : least) + 2];
        }
    }
    for (std::int64_t v = 2; v < vertices + 2; ++v) starts[v] += starts[v - 1];
    for (std::int64_t t = 0; t < n; ++t)
        for (int i = 0; i < 4; ++i) {
            std::int32_t a = tets[4 * t + ((i + 1) & 3)], b = tets[4 * t + ((i + 2) & 3)], c = tets[4 * t + ((i + 3) & 3)];
            if (a > b) std::swap(a, b);
            if (b > c) std::swap(b, c);
            if (a > b) std::swap(a, b);
            sides[starts[a + 1]++] = {b, c, static_cast<std::int32_t>(4 * t + i)};
        }
    std::vector<Side> open;
    for (std::int64_t v = 0; v < vertices; ++v) {
        open.clear();
        for (std::int32_t place = starts[v]; place < starts[v + 1]; ++place) {
            const Side side = sides[place];
            std::size_t k = 0;
            while (k < open.size() && (open[k].middle != side.middle || open[k].largest != side.largest)) ++k;
            if (k == open.size()) {
                open.push_back(side);
            } else {
                opposite[side.number] = open[k].number;
                opposite[open[k].number] = side.number;
                open[k] = open.back();
                open.pop_back();
            }
        }
        for (const Side& side : open) opposite[side.number] = -1;
    }
}
