/* The k-d tree: nearest point with incremental distances to the cells (Arya and Mount, 1993). */

#ifndef NEAREST_H
#define NEAREST_H

#include <math.h>

#include "net.h"

enum { DEEPEST = 192 };

static int32_t nearest_point(const Net *net, const double query[3], double *distance)
{
    struct { double distance, away[3]; int32_t node, axis; } stack[DEEPEST];
    int32_t best = -1;
    double best_distance = INFINITY;
    int height = 0;
    if (net->tree[ROOT] >= 0) {
        stack[0].distance = stack[0].away[0] = stack[0].away[1] = stack[0].away[2] = 0.0;
        stack[0].node = net->tree[ROOT], stack[0].axis = 0;
        height = 1;
    }
    while (height > 0) {
        height--;
        double cell_distance = stack[height].distance;
        if (cell_distance >= best_distance)
            continue;
        double away[3] = {stack[height].away[0], stack[height].away[1], stack[height].away[2]};
        int32_t place = stack[height].node, axis = stack[height].axis;
        while (place >= 0) {
            const TreeNode *node = &net->nodes[place];
            double dx = query[0] - node->at[0], dy = query[1] - node->at[1], dz = query[2] - node->at[2];
            double here = dx * dx + dy * dy + dz * dz;
            if (here < best_distance)
                best = node->point, best_distance = here;
            double beyond = query[axis] - node->at[axis];
            int32_t near = beyond >= 0.0 ? node->right : node->left;
            int32_t far = beyond >= 0.0 ? node->left : node->right;
            int32_t following = axis < 2 ? axis + 1 : 0;
            double far_distance = cell_distance - away[axis] * away[axis] + beyond * beyond;
            if (far >= 0 && far_distance < best_distance) {
                stack[height].distance = far_distance;
                for (int k = 0; k < 3; k++)
                    stack[height].away[k] = away[k];
                stack[height].away[axis] = beyond;
                stack[height].node = far, stack[height].axis = following;
                height++;
            }
            place = near, axis = following;
        }
    }
    *distance = best_distance;
    return best;
}

#endif
