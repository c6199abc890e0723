/* Locate: the queries in the order of a Hilbert curve, each walk from where the last one ended.

   The steps are those of tetrabench/tetra/locate.py, but for the grid that decides where a walk leaves the net. */

#include <math.h>
#include <stdlib.h>

#include "nearest.h"
#include "net.h"

enum { BITS = 10, DIGIT = 1 << 10, LONGEST_WALK = 500 };
#define INSIDE 1e-12
#define NEAR 4.0 /* edges of the tetra where the last walk ended, to walk on from there */

/* ---- the order of the queries ---- */

/* Two zeros behind each of the BITS bits. */
static inline uint32_t spread(uint32_t bits)
{
    bits = (bits | bits << 16) & 0x30000ff;
    bits = (bits | bits << 8) & 0x300f00f;
    bits = (bits | bits << 4) & 0x30c30c3;
    return (bits | bits << 2) & 0x9249249;
}

/* Skilling, Programming the Hilbert curve, 2004. */
static inline uint32_t hilbert_key(uint32_t x, uint32_t y, uint32_t z)
{
    for (uint32_t bit = 1u << (BITS - 1); bit > 1; bit >>= 1) {
        uint32_t below = bit - 1, swap;
        x ^= x & bit ? below : 0;
        swap = y & bit ? 0 : (x ^ y) & below;
        x ^= y & bit ? below : swap;
        y ^= swap;
        swap = z & bit ? 0 : (x ^ z) & below;
        x ^= z & bit ? below : swap;
        z ^= swap;
    }
    y ^= x;
    z ^= y;
    uint32_t flip = z >> 1; /* bit k: whether the bits above it are an odd number of ones */
    flip ^= flip >> 1;
    flip ^= flip >> 2;
    flip ^= flip >> 4;
    flip ^= flip >> 8;
    return spread(x ^ flip) << 2 | spread(y ^ flip) << 1 | spread(z ^ flip);
}

typedef struct { uint32_t key, query; } Item;

/* Radix sort, BITS at a time: BITS * 3 in all. The sorted items are in `other`. */
static void sort(Item *items, Item *other, int64_t count)
{
    for (int digit = 0; digit < 3; digit++) {
        int64_t starts[DIGIT + 1] = {0};
        for (int64_t n = 0; n < count; n++)
            starts[(items[n].key >> BITS * digit & (DIGIT - 1)) + 1]++;
        for (int d = 0; d < DIGIT; d++)
            starts[d + 1] += starts[d];
        for (int64_t n = 0; n < count; n++)
            other[starts[items[n].key >> BITS * digit & (DIGIT - 1)]++] = items[n];
        Item *swap = items;
        items = other, other = swap;
    }
}

static void put_in_order(const double (*queries)[3], int64_t count, Item *items, Item *other)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, longest = 0.0;
    for (int64_t n = 0; n < count; n++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], queries[n][k]);
            high[k] = fmax(high[k], queries[n][k]);
        }
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, high[k] - low[k]);
    double cells = longest > 0.0 ? (DIGIT - 1) / longest : 0.0;
    for (int64_t n = 0; n < count; n++) {
        uint32_t axis[3];
        for (int k = 0; k < 3; k++)
            axis[k] = (uint32_t)((queries[n][k] - low[k]) * cells);
        items[n] = (Item){hilbert_key(axis[0], axis[1], axis[2]), (uint32_t)n};
    }
    sort(items, other, count);
}

/* ---- the walk ---- */

static inline void difference(double d[3], const double a[3], const double b[3])
{
    for (int k = 0; k < 3; k++)
        d[k] = a[k] - b[k];
}

static inline void cross(double c[3], const double a[3], const double b[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* One step towards `at`: t where it is inside, else the tetra behind the side that it is farthest behind. */
static inline Ref follow(const Net *net, Ref t, const double at[3])
{
    const int32_t *v = AT(t, vertex);
    const Ref *behind = AT(t, neighbour); /* read with the vertices, not after them */
    double a[3], b[3], c[3], q[3], bc[3], ca[3], ab[3];
    difference(a, net->xyz[v[1]], net->xyz[v[0]]);
    difference(b, net->xyz[v[2]], net->xyz[v[0]]);
    difference(c, net->xyz[v[3]], net->xyz[v[0]]);
    difference(q, at, net->xyz[v[0]]);
    cross(bc, b, c);
    cross(ca, c, a);
    cross(ab, a, b);
    double whole = dot(a, bc), sign = whole < 0.0 ? -1.0 : 1.0;
    double part[4] = {0.0, dot(q, bc), dot(q, ca), dot(q, ab)};
    part[0] = whole - part[1] - part[2] - part[3];
    double least = -INSIDE * fabs(whole);
    Ref following = t;
    for (int i = 0; i < 4; i++)
        if (sign * part[i] < least)
            following = behind[i], least = sign * part[i];
    return following;
}

/* Walk from *t; true where it holds `at`, false where the walk got lost. *t is where it ended. */
static bool walk(const Net *net, Ref *t, const double at[3])
{
    for (int step = 0; step < LONGEST_WALK; step++) {
        Ref following = follow(net, *t, at);
        if (following == *t || following == NONE)
            return following == *t;
        *t = following;
    }
    return false;
}

static bool is_near(const Net *net, Ref t, const double at[3])
{
    const int32_t *v = AT(t, vertex);
    double edge[3], away[3];
    difference(edge, net->xyz[v[1]], net->xyz[v[0]]);
    difference(away, at, net->xyz[v[0]]);
    return dot(away, away) < NEAR * NEAR * dot(edge, edge);
}

/* The tetra of each query (count, 3) into `refs`, NONE where no walk led to one. How many those are, -1 without memory. */
int64_t locate(const Net *net, const double (*queries)[3], int64_t count, int64_t *refs)
{
    Item *items = malloc(2 * count * sizeof *items), *other = items + count;
    if (!items)
        return -1;
    put_in_order(queries, count, items, other);
    int64_t lost = 0;
    Ref t = NONE;
    for (int64_t n = 0; n < count; n++) {
        int64_t q = other[n].query;
        bool found = t != NONE && is_near(net, t, queries[q]) && walk(net, &t, queries[q]);
        if (!found) {
            double distance;
            int32_t point = nearest_point(net, queries[q], &distance);
            if (point >= 0 && net->heads[point] != END_OF_LIST) {
                t = net->entries[net->heads[point]].ref;
                found = walk(net, &t, queries[q]);
            }
        }
        refs[q] = found ? (int64_t)t : (int64_t)NONE;
        lost += !found;
    }
    free(items);
    return lost;
}
