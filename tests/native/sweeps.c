/* The two sweeps over the net: state 0 -> state 1 -> copied back. */

#include "net.h"

static void copy_back(const Net *net)
{
    FOR_EACH(t) AT(t, state)[0] = AT(t, state)[1];
}

/* Weighted mean: half a tetra's own state, half the mean of its neighbours' (its own where there is none). */
void alfa(const Net *net, int64_t sweeps)
{
    for (int64_t sweep = 0; sweep < sweeps; sweep++) {
        FOR_EACH(t) {
            double own = AT(t, state)[0], sum = 0.0;
            for (int i = 0; i < 4; i++) {
                Ref u = AT(t, neighbour)[i];
                sum += u == NONE ? own : AT(u, state)[0];
            }
            AT(t, state)[1] = 0.5 * own + 0.5 * (sum * 0.25);
        }
        copy_back(net);
    }
}

/* Diffusion: through side i flows -k (own - other) S^2 / (V + V_other), here with k = 1. */
void flow(const Net *net, int64_t sweeps, double step)
{
    for (int64_t sweep = 0; sweep < sweeps; sweep++) {
        FOR_EACH(t) {
            double own = AT(t, state)[0], sum = 0.0;
            for (int i = 0; i < 4; i++) {
                Ref u = AT(t, neighbour)[i];
                if (u != NONE) {
                    double both = AT(t, volume) + AT(u, volume), area = AT(t, side_area)[i];
                    if (both > 0.0)
                        sum += -(own - AT(u, state)[0]) * (area * area) / both;
                }
            }
            AT(t, state)[1] = own + step * sum;
        }
        copy_back(net);
    }
}
