/* What a peer is to the bench: a mesh behind a pointer, four queries, and the same loops around them for everybody.

   A peer's file declares `Mesh`, `number_of_cells`, `number_of_nodes` and the four queries: each fills `out` with the
   complete list of an element, counter-clockwise, and returns its length. It ends with PEER, which exports the loops. */
#ifndef PEER_H
#define PEER_H

#include <stdint.h>

#ifdef __cplusplus
#define EXPORT extern "C"
#else
#define EXPORT
#endif

/* Sum of what is in the buffer, without boundary conditions, which are negative. */
static inline int64_t sum_of(const int32_t *out, int32_t n)
{
    int64_t sum = 0;
    for (int32_t j = 0; j < n; j++)
        if (out[j] >= 0)
            sum += out[j];
    return sum;
}

/* All elements in order; elements picked at random; and the lists of all, one after the other, as starts and items. */
#define LOOPS(query, number)                                                                             \
    EXPORT int64_t sweep_##query(const Mesh *mesh, int32_t *out)                                         \
    {                                                                                                    \
        int64_t sum = 0;                                                                                 \
        const int32_t n = number(mesh);                                                                  \
        for (int32_t e = 0; e < n; e++)                                                                  \
            sum += sum_of(out, query(mesh, e, out));                                                     \
        return sum;                                                                                      \
    }                                                                                                    \
    EXPORT int64_t sample_##query(const Mesh *mesh, const int32_t *picks, int64_t n, int32_t *out)       \
    {                                                                                                    \
        int64_t sum = 0;                                                                                 \
        for (int64_t k = 0; k < n; k++)                                                                  \
            sum += sum_of(out, query(mesh, picks[k], out));                                              \
        return sum;                                                                                      \
    }                                                                                                    \
    EXPORT void list_##query(const Mesh *mesh, int32_t *starts, int32_t *items)                          \
    {                                                                                                    \
        const int32_t n = number(mesh);                                                                  \
        starts[0] = 0;                                                                                   \
        for (int32_t e = 0; e < n; e++)                                                                  \
            starts[e + 1] = starts[e] + query(mesh, e, items + starts[e]);                               \
    }

#define PEER                                                                                             \
    LOOPS(cell_nodes, number_of_cells)                                                                   \
    LOOPS(cell_neighbours, number_of_cells)                                                              \
    LOOPS(node_cells, number_of_nodes)                                                                   \
    LOOPS(node_neighbours, number_of_nodes)

/* The polygons that a mesh is built from: those of a PolygonMesh, and coordinates (nodes, 3). */
typedef struct {
    int32_t cells, nodes, edges;
    const int32_t *starts, *items, *conditions;
    const double *points;
} Polygons;

#endif
