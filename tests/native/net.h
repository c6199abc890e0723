/* The seven layouts of a tetrahedral net in C, on the very memory of the contestants.

   A yardstick, built once for each contestant: -DARRAYS, -DRECORDS or -DNODES says where the fields of a tetra live,
   and -DSORTED_LIST, -DFLAGS, -DFLAGS_AND_LIST or -DCHAIN how an iteration finds the live ones. `Net` has the arrays of
   the contestant's NamedTuples in their order (tests/native/yardstick.py fills it). */

#ifndef NET_H
#define NET_H

#include <stdbool.h>
#include <stdint.h>

enum { STATES = 5, END_OF_LIST = -1 };
#define DEAD (-1.0)
#define SAME_POINT 1e-9

#ifdef NODES
typedef struct Tetra Tetra, *Ref;
#define NONE ((Ref)(intptr_t)-1)
#else
typedef int32_t Ref;
#define NONE (-1)
#endif

typedef struct Tetra {
    int32_t vertex[4];
    Ref neighbour[4];
    double volume;
    double centroid[3];
    double side_area[4];
    double side_normal[4][3];
    double state[STATES];
#ifdef NODES
    struct Tetra *next, *previous;
#endif
} Tetra;

typedef struct { int32_t slot, next; } Hole;
typedef struct { Ref ref; int32_t next; } Entry;
typedef struct { double at[3]; int32_t left, right, point; } TreeNode;

/* places in the counters */
enum { LIVE = 0, FIRST = 1, END = 1, HOLES = 2, HEAD = 1, TAIL = 2 }; /* slots */
enum { COUNT = 0, STALE = 1, EDITS = 2, ROOT = 1, DEPTH = 2 };        /* points, tree */
enum { USED = 0, FREE = 1 };                                          /* incidence */

typedef struct {
#if defined(ARRAYS)
    int32_t (*vertex)[4];
    int32_t (*neighbour)[4];
    double *volume;
    double (*centroid)[3];
    double (*side_area)[4];
    double (*side_normal)[4][3];
    double (*state)[STATES];
#elif defined(RECORDS)
    Tetra *records;
#elif defined(NODES)
    int64_t node_bytes;
#endif
#if defined(SORTED_LIST)
    Hole *holes;
#elif defined(FLAGS_AND_LIST)
    int32_t *holes;
#endif
    int64_t *slots;
    double (*xyz)[3];
    int64_t *points;
    double diagonal;
    int32_t *heads;
    Entry *entries;
    int64_t *incidence;
    TreeNode *nodes;
    int64_t *tree;
    int64_t room_for_tetras, room_for_points;
} Net;

/* AT(t, volume), AT(t, state)[k], ...: a field of tetra t of the net called `net` */
#if defined(ARRAYS)
#define AT(t, field) net->field[t]
#elif defined(RECORDS)
#define AT(t, field) net->records[t].field
#elif defined(NODES)
#define AT(t, field) (t)->field
#endif

/* FOR_EACH(t) { ... }: over the live tetras of `net`, in order */
#if defined(SORTED_LIST) /* the last element of the list is the end, not a hole */
#define FOR_EACH(t)                                                                                            \
    for (int32_t t = 0, hole = net->slots[FIRST]; hole != END_OF_LIST; t = net->holes[hole].slot + 1,          \
                 hole = net->holes[hole].next)                                                                 \
        for (; t < net->holes[hole].slot; t++)
#elif defined(FLAGS) || defined(FLAGS_AND_LIST)
#define FOR_EACH(t)                                                                                            \
    for (int32_t t = 0, end = net->slots[END]; t < end; t++)                                                   \
        if (AT(t, volume) >= 0.0)
#elif defined(CHAIN)
#define FOR_EACH(t) for (Ref t = (Ref)net->slots[HEAD]; t != NONE; t = t->next)
#endif

#endif
