/* The yardstick: plain tables in C, starts and items in int32, for each of the four queries the list itself.

   Lists around a node begin at its right boundary side, elsewhere with its lowest corner; at a boundary node the left
   side's boundary condition follows the cells. So the two lists of a node are equally long, as are those of a cell. */
#include <stdlib.h>
#include <string.h>

#include "peer.h"

typedef struct {
    int32_t cells, nodes;
    int32_t *cell_starts, *cell_nodes, *cell_neighbours;
    int32_t *node_starts, *node_cells, *node_neighbours;
} Mesh;

static inline int32_t number_of_cells(const Mesh *mesh) { return mesh->cells; }

static inline int32_t number_of_nodes(const Mesh *mesh) { return mesh->nodes; }

static inline int32_t copy_list(const int32_t *starts, const int32_t *items, int32_t e, int32_t *restrict out)
{
    const int32_t start = starts[e], n = starts[e + 1] - start;
    for (int32_t j = 0; j < n; j++)
        out[j] = items[start + j];
    return n;
}

static inline int32_t cell_nodes(const Mesh *mesh, int32_t c, int32_t *out)
{
    return copy_list(mesh->cell_starts, mesh->cell_nodes, c, out);
}

static inline int32_t cell_neighbours(const Mesh *mesh, int32_t c, int32_t *out)
{
    return copy_list(mesh->cell_starts, mesh->cell_neighbours, c, out);
}

static inline int32_t node_cells(const Mesh *mesh, int32_t v, int32_t *out)
{
    return copy_list(mesh->node_starts, mesh->node_cells, v, out);
}

static inline int32_t node_neighbours(const Mesh *mesh, int32_t v, int32_t *out)
{
    return copy_list(mesh->node_starts, mesh->node_neighbours, v, out);
}

PEER

static int32_t *room_for(int64_t n) { return malloc((n ? n : 1) * sizeof(int32_t)); }

/* A corner at a node: its cell, its place in the list of the cell, that of the corner before, and the nodes there. */
typedef struct {
    int32_t cell, place, before, next, previous;
} Corner;

/* The corner at the node whose side leads to `next`; -1 where there is none. */
static int32_t corner_towards(const Corner *corners, int32_t n, int32_t next)
{
    for (int32_t j = 0; j < n; j++)
        if (corners[j].next == next)
            return j;
    return -1;
}

/* Turn around node v, and write its lists and what its cells see beyond the sides that end in it. */
static int32_t turn_around(Mesh *mesh, const Polygons *from, const Corner *corners, int32_t n, int32_t at)
{
    int32_t first = 0;
    for (int32_t j = 0; j < n; j++)
        if (from->conditions[corners[j].place] < 0)
            first = j;
    for (int32_t j = first;;) {
        const Corner here = corners[j];
        mesh->node_neighbours[at] = here.next;
        mesh->node_cells[at++] = here.cell;
        j = corner_towards(corners, n, here.previous);
        mesh->cell_neighbours[here.before] = j < 0 ? from->conditions[here.before] : corners[j].cell;
        if (j < 0) {
            mesh->node_neighbours[at] = here.previous;
            mesh->node_cells[at++] = from->conditions[here.before];
        }
        if (j < 0 || j == first)
            return at;
    }
}

EXPORT void *build(const Polygons *from)
{
    const int32_t cells = from->cells, nodes = from->nodes, corners = from->starts[cells];
    int32_t boundary = 0, most = 0;
    for (int32_t x = 0; x < corners; x++)
        boundary += from->conditions[x] < 0;
    Mesh *mesh = malloc(sizeof *mesh);
    *mesh = (Mesh){cells, nodes, room_for(cells + 1), room_for(corners), room_for(corners),
                   room_for(nodes + 1), room_for(corners + boundary), room_for(corners + boundary)};
    memcpy(mesh->cell_starts, from->starts, (cells + 1) * sizeof(int32_t));
    memcpy(mesh->cell_nodes, from->items, corners * sizeof(int32_t));

    /* the corners by their nodes: counting sort */
    int32_t *ends = calloc(nodes + 2, sizeof(int32_t)), *around = room_for(corners), *cell = room_for(corners);
    for (int32_t x = 0; x < corners; x++)
        ends[from->items[x] + 2]++;
    for (int32_t v = 0; v < nodes; v++) {
        if (ends[v + 2] > most)
            most = ends[v + 2];
        ends[v + 2] += ends[v + 1];
    }
    for (int32_t c = 0; c < cells; c++)
        for (int32_t x = from->starts[c]; x < from->starts[c + 1]; x++) {
            cell[x] = c;
            around[ends[from->items[x] + 1]++] = x;
        }

    Corner *here = malloc((most ? most : 1) * sizeof *here);
    mesh->node_starts[0] = 0;
    for (int32_t v = 0; v < nodes; v++) {
        const int32_t n = ends[v + 1] - ends[v];
        for (int32_t j = 0; j < n; j++) {
            const int32_t x = around[ends[v] + j], c = cell[x];
            const int32_t begin = from->starts[c], end = from->starts[c + 1];
            const int32_t before = x > begin ? x - 1 : end - 1, after = x + 1 < end ? x + 1 : begin;
            here[j] = (Corner){c, x, before, from->items[after], from->items[before]};
        }
        mesh->node_starts[v + 1] = turn_around(mesh, from, here, n, mesh->node_starts[v]);
    }
    free(here), free(cell), free(around), free(ends);
    return mesh;
}

EXPORT void drop(void *built)
{
    Mesh *mesh = built;
    free(mesh->cell_starts), free(mesh->cell_nodes), free(mesh->cell_neighbours);
    free(mesh->node_starts), free(mesh->node_cells), free(mesh->node_neighbours);
    free(mesh);
}
