/* Delete, explode and replace: slots, incidence lists, geometry, insertion and deletion of points and tetras.

   The steps are those of tetrabench/tetra/edit.py, with the same checks; what raises there returns false or NONE here. */

#include <math.h>
#include <stdlib.h>

#include "nearest.h"
#include "net.h"

/* ---- slots ---- */

#if defined(FLAGS_AND_LIST)

static Ref last_tetra(const Net *net)
{
    return net->slots[END] - 1;
}

static Ref take_slot(Net *net)
{
    int32_t end = net->slots[END], t = end;
    while (t == end && net->slots[HOLES] > 0) {
        int32_t hole = net->holes[--net->slots[HOLES]];
        if (hole < end) /* else the end has fallen over it since */
            t = hole;
    }
    if (t == end)
        net->slots[END]++;
    net->slots[LIVE]++;
    return t;
}

static void drop_slot(Net *net, Ref t)
{
    AT(t, volume) = DEAD;
    net->slots[LIVE]--;
    if (t == net->slots[END] - 1) {
        int32_t end = t;
        while (end > 0 && AT(end - 1, volume) < 0.0)
            end--;
        net->slots[END] = end;
    } else {
        net->holes[net->slots[HOLES]++] = t;
    }
}

#elif defined(CHAIN)

static Ref last_tetra(const Net *net)
{
    return (Ref)net->slots[TAIL];
}

static Ref take_slot(Net *net)
{
    Ref t = malloc(sizeof *t), tail = last_tetra(net);
    if (!t)
        return NONE;
    t->next = NONE;
    t->previous = tail;
    if (tail == NONE)
        net->slots[HEAD] = (intptr_t)t;
    else
        tail->next = t;
    net->slots[TAIL] = (intptr_t)t;
    net->slots[LIVE]++;
    return t;
}

static void drop_slot(Net *net, Ref t)
{
    if (t->previous == NONE)
        net->slots[HEAD] = (intptr_t)t->next;
    else
        t->previous->next = t->next;
    if (t->next == NONE)
        net->slots[TAIL] = (intptr_t)t->previous;
    else
        t->next->previous = t->previous;
    free(t);
    net->slots[LIVE]--;
}

#endif

/* ---- incidence ---- */

static void add_incidence(Net *net, int32_t point, Ref t)
{
    int32_t place = net->incidence[FREE];
    if (place != END_OF_LIST)
        net->incidence[FREE] = net->entries[place].next;
    else
        place = net->incidence[USED]++;
    net->entries[place].ref = t;
    net->entries[place].next = net->heads[point];
    net->heads[point] = place;
}

static bool remove_incidence(Net *net, int32_t point, Ref t)
{
    int32_t *link = &net->heads[point];
    while (*link != END_OF_LIST && net->entries[*link].ref != t)
        link = &net->entries[*link].next;
    int32_t place = *link;
    if (place == END_OF_LIST)
        return false;
    *link = net->entries[place].next;
    net->entries[place].next = net->incidence[FREE];
    net->incidence[FREE] = place;
    return true;
}

/* ---- geometry ---- */

static double signed_volume(const double p0[3], const double p1[3], const double p2[3], const double p3[3])
{
    double ax = p1[0] - p0[0], ay = p1[1] - p0[1], az = p1[2] - p0[2];
    double bx = p2[0] - p0[0], by = p2[1] - p0[1], bz = p2[2] - p0[2];
    double cx = p3[0] - p0[0], cy = p3[1] - p0[1], cz = p3[2] - p0[2];
    return (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0;
}

static void set_side(Net *net, Ref t, int i, const double a[3], const double b[3], const double c[3],
                     const double opposite[3])
{
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double wx = opposite[0] - a[0], wy = opposite[1] - a[1], wz = opposite[2] - a[2];
    double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    double length = sqrt(nx * nx + ny * ny + nz * nz);
    double factor = length > 0.0 ? 1.0 / length : 0.0;
    if (nx * wx + ny * wy + nz * wz > 0.0)
        factor = -factor;
    AT(t, side_area)[i] = length / 2.0;
    AT(t, side_normal)[i][0] = factor * nx;
    AT(t, side_normal)[i][1] = factor * ny;
    AT(t, side_normal)[i][2] = factor * nz;
}

static void set_geometry(Net *net, Ref t)
{
    const int32_t *v = AT(t, vertex);
    const double *p0 = net->xyz[v[0]], *p1 = net->xyz[v[1]], *p2 = net->xyz[v[2]], *p3 = net->xyz[v[3]];
    AT(t, volume) = fabs(signed_volume(p0, p1, p2, p3));
    for (int k = 0; k < 3; k++)
        AT(t, centroid)[k] = (p0[k] + p1[k] + p2[k] + p3[k]) / 4.0;
    set_side(net, t, 0, p1, p2, p3, p0);
    set_side(net, t, 1, p2, p3, p0, p1);
    set_side(net, t, 2, p3, p0, p1, p2);
    set_side(net, t, 3, p0, p1, p2, p3);
}

/* ---- points and tetras ---- */

/* A point becomes a leaf of the k-d tree. False where the tree would have to be rebuilt first, which is no part of this yardstick. */
static bool insert_node(Net *net, int32_t point)
{
    const double *xyz = net->xyz[point];
    int32_t place = net->tree[COUNT]++;
    net->nodes[place] = (TreeNode){{xyz[0], xyz[1], xyz[2]}, -1, -1, point};
    int64_t depth = 1;
    int axis = 0;
    int32_t parent = net->tree[ROOT];
    if (parent < 0)
        net->tree[ROOT] = place;
    while (parent >= 0) {
        TreeNode *node = &net->nodes[parent];
        int32_t *child = xyz[axis] < node->at[axis] ? &node->left : &node->right;
        parent = *child;
        if (parent < 0)
            *child = place;
        axis = axis < 2 ? axis + 1 : 0;
        depth++;
    }
    if (depth > net->tree[DEPTH]) {
        net->tree[DEPTH] = depth;
        return depth <= 2.5 * log2(place + 1.0) + 4.0;
    }
    return true;
}

/* The ref of the point there: of an existing one, of a new one, or -1 where there is no room for it. */
static int32_t insert_point(Net *net, const double at[3])
{
    double distance, same = SAME_POINT * net->diagonal;
    int32_t found = nearest_point(net, at, &distance);
    if (distance < same * same)
        return found;
    if (net->points[STALE] || net->points[COUNT] >= net->room_for_points)
        return -1;
    int32_t point = net->points[COUNT]++;
    for (int k = 0; k < 3; k++)
        net->xyz[point][k] = at[k];
    return insert_node(net, point) ? point : -1;
}

typedef struct { Ref tetra; int side; } Side;

static bool is_free(const Net *net, Side side, Side found)
{
    return found.tetra == NONE && AT(side.tetra, neighbour)[side.side] == NONE;
}

static void join(Net *net, Ref t, int i, Side other)
{
    AT(t, neighbour)[i] = other.tetra;
    if (other.tetra != NONE)
        AT(other.tetra, neighbour)[other.side] = t;
}

/* The new tetra, NONE where there cannot be such a one. */
static Ref insert_tetra(Net *net, int32_t a, int32_t b, int32_t c, int32_t d)
{
    if (net->points[STALE] || a == b || a == c || a == d || b == c || b == d || c == d)
        return NONE;
    int64_t points = net->points[COUNT];
    if (a < 0 || b < 0 || c < 0 || d < 0 || a >= points || b >= points || c >= points || d >= points)
        return NONE;
    if (net->slots[LIVE] >= net->room_for_tetras)
        return NONE;
    Side other[4] = {{NONE, 0}, {NONE, 0}, {NONE, 0}, {NONE, 0}};
    /* sides 1, 2, 3 hold point a: their other tetras are around a */
    for (int32_t place = net->heads[a]; place != END_OF_LIST; place = net->entries[place].next) {
        Side side = {net->entries[place].ref, 0};
        int shared = 0;
        for (int j = 0; j < 4; j++) {
            int32_t v = AT(side.tetra, vertex)[j];
            int match = (v == b) | (v == c) << 1 | (v == d) << 2;
            shared |= match;
            side.side += j * (!match & (v != a));
        }
        if (shared == 7)
            return NONE;
        int i = shared == 6 ? 1 : shared == 5 ? 2 : shared == 3 ? 3 : 0;
        if (i) {
            if (!is_free(net, side, other[i]))
                return NONE;
            other[i] = side;
        }
    }
    /* side 0 is (b, c, d): its other tetra is around b, without a */
    for (int32_t place = net->heads[b]; place != END_OF_LIST; place = net->entries[place].next) {
        Side side = {net->entries[place].ref, 0};
        int shared = 0;
        for (int j = 0; j < 4; j++) {
            int32_t v = AT(side.tetra, vertex)[j];
            int match = (v == c) | (v == d) << 1;
            shared |= match;
            side.side += j * (!match & (v != b));
        }
        if (shared == 3) {
            if (!is_free(net, side, other[0]))
                return NONE;
            other[0] = side;
        }
    }
    Ref t = take_slot(net);
    if (t == NONE)
        return NONE;
    int32_t vertex[4] = {a, b, c, d};
    for (int i = 0; i < 4; i++) {
        AT(t, vertex)[i] = vertex[i];
        join(net, t, i, other[i]);
    }
    for (int k = 0; k < STATES; k++)
        AT(t, state)[k] = 0.0;
    set_geometry(net, t);
    for (int i = 0; i < 4; i++)
        add_incidence(net, vertex[i], t);
    net->points[EDITS]++;
    return t;
}

static bool delete_tetra(Net *net, Ref t)
{
    if (net->points[STALE])
        return false;
    for (int i = 0; i < 4; i++)
        if (!remove_incidence(net, AT(t, vertex)[i], t))
            return false;
    for (int i = 0; i < 4; i++) {
        Ref u = AT(t, neighbour)[i];
        if (u == NONE)
            continue;
        for (int j = 0; j < 4; j++)
            if (AT(u, neighbour)[j] == t)
                AT(u, neighbour)[j] = NONE;
    }
    drop_slot(net, t);
    net->points[EDITS]++;
    return true;
}

/* ---- the scenarios ---- */

/* Delete `count` tetras from the end: the last one, then a neighbour of it, and so on. How many were deleted. */
int64_t delete_from_end(Net *net, int64_t count)
{
    Ref t = NONE;
    for (int64_t n = 0; n < count; n++) {
        if (t == NONE)
            t = last_tetra(net);
        if (t == NONE)
            return n;
        Ref following = NONE;
        for (int i = 0; i < 4 && following == NONE; i++)
            following = AT(t, neighbour)[i];
        if (!delete_tetra(net, t))
            return n;
        t = following;
    }
    return count;
}

/* Split each tetra of `refs` into four around its centroid. How many were skipped, -1 where one could not be split. */
int64_t explode(Net *net, const int64_t *refs, int64_t count)
{
    int64_t skipped = 0;
    for (int64_t n = 0; n < count; n++) {
        Ref t = (Ref)refs[n];
        int64_t points = net->points[COUNT];
        int32_t centre = insert_point(net, AT(t, centroid));
        if (centre < 0)
            return -1;
        if (centre < points) {
            skipped++;
            continue;
        }
        int32_t corner[4];
        for (int i = 0; i < 4; i++)
            corner[i] = AT(t, vertex)[i];
        double state[STATES];
        for (int k = 0; k < STATES; k++)
            state[k] = AT(t, state)[k];
        if (!delete_tetra(net, t))
            return -1;
        for (int i = 0; i < 4; i++) {
            int32_t v[4] = {corner[0], corner[1], corner[2], corner[3]};
            v[i] = centre;
            Ref child = insert_tetra(net, v[0], v[1], v[2], v[3]);
            if (child == NONE)
                return -1;
            for (int k = 0; k < STATES; k++)
                AT(child, state)[k] = state[k];
        }
    }
    return skipped;
}

/* Delete each tetra of `refs` and insert it again, between the same points. How many could be. */
int64_t replace(Net *net, const int64_t *refs, int64_t count)
{
    for (int64_t n = 0; n < count; n++) {
        Ref t = (Ref)refs[n];
        int32_t v[4];
        for (int i = 0; i < 4; i++)
            v[i] = AT(t, vertex)[i];
        if (!delete_tetra(net, t) || insert_tetra(net, v[0], v[1], v[2], v[3]) == NONE)
            return n;
    }
    return count;
}
