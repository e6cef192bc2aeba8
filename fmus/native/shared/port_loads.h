/* Loads that the ports of a base carry, each and in sum: the twin of components/numerics/port_loads.py, which tells what
   they are. A record: sizes of the last two steps, means and slopes of all wrenches over the last, then over the one
   before. */

#ifndef FANFOLD_PORT_LOADS_H
#define FANFOLD_PORT_LOADS_H

#include <string.h>

#include "frames.h"
#include "matrices.h"
#include "mid_step.h"
#include "port_sizes.h"

enum { STEP_SIZES = 2 };

static inline size_t port_loads_record(size_t ports) { return STEP_SIZES + 4 * WRENCH_SIZE * ports; }

/* Sum and ports, now and one step earlier. */
static inline size_t port_loads_told(size_t ports) { return 2 * WRENCH_SIZE * (1 + ports); }

/* Starts a record anew from the wrenches that were there before an impulse, which is no load that lasts. */
static inline void store_port_loads_before(size_t n, const double *old, real *record) {
    const double *last = old + STEP_SIZES, *previous = last + 2 * n;
    record[0] = STOPPED;
    record[1] = 0.0;
    for (size_t i = 0; i < 4 * n; i++)
        record[STEP_SIZES + i] = i >= n ? 0.0
                                        : extrapolated((StepMean){last[i], last[n + i], old[0]},
                                                       (StepMean){previous[i], previous[n + i], old[1]});
}

/* The record after a step. */
static inline void store_port_loads(size_t ports, const double *old, const real *wrenches, const real *slopes, double h,
                                    int impulse, real *record) {
    const size_t n = WRENCH_SIZE * ports;
    if (impulse) {
        store_port_loads_before(n, old, record);
        return;
    }
    record[0] = h;
    record[1] = old[0];
    record += STEP_SIZES;
    for (size_t i = 0; i < n; i++) {
        record[i] = wrenches[i];
        record[n + i] = slopes[i];
    }
    for (size_t i = 0; i < 2 * n; i++) record[2 * n + i] = old[STEP_SIZES + i];
}

#ifndef FANFOLD_COMPLEX

/* Whether there are two steps, so that loads one step earlier are known. */
static inline int tells_earlier(const double *record) { return record[0] > 0.0 && record[1] > 0.0; }

/* Where loads one step earlier stand behind those of now. */
static inline double *earlier_loads(size_t ports, double *z) { return z + WRENCH_SIZE * (1 + ports); }

/* Load 0 is the sum of all ports about the point that the arms start from, load k that of port k - 1; axes of the base. */
static inline void load_in_axes(size_t ports, const double *arms, const double *wrenches, size_t number,
                                const double axes[9], double load[WRENCH_SIZE]) {
    Vector3 force = {0.0, 0.0, 0.0}, torque = {0.0, 0.0, 0.0};
    for (size_t k = number ? number - 1 : 0; k < (number ? number : ports); k++) {
        const Vector3 pull = transposed_times(axes, vector_of(wrenches + WRENCH_SIZE * k));
        force = vector_add(force, pull);
        torque = vector_add(torque, transposed_times(axes, vector_of(wrenches + WRENCH_SIZE * k + 3)));
        if (!number) torque = vector_add(torque, vector_cross(vector_of(arms + 3 * k), pull));
    }
    vector_store(force, load);
    vector_store(torque, load + 3);
}

/* Means and slopes of a load over both steps, those of the last first. */
typedef struct {
    double mean[WRENCH_SIZE], slope[WRENCH_SIZE], mean_before[WRENCH_SIZE], slope_before[WRENCH_SIZE];
} LoadRecord;

static inline LoadRecord load_record(size_t ports, const double *arms, const double *record, size_t number,
                                     const double axes[9]) {
    const size_t n = WRENCH_SIZE * ports;
    LoadRecord found;
    load_in_axes(ports, arms, record + STEP_SIZES, number, axes, found.mean);
    load_in_axes(ports, arms, record + STEP_SIZES + n, number, axes, found.slope);
    load_in_axes(ports, arms, record + STEP_SIZES + 2 * n, number, axes, found.mean_before);
    load_in_axes(ports, arms, record + STEP_SIZES + 3 * n, number, axes, found.slope_before);
    return found;
}

/* Loads at the communication point, extrapolated from the last two steps; without a step before those of the present
   wrenches. Then those one step earlier, zero without two steps. axes: of the base, now and one step earlier. */
static inline void observe_port_loads(size_t ports, const double *arms, const double *record, const double *wrenches,
                                      const double axes[9], const double axes_before[9], double *z) {
    const double h = record[0], h_before = record[1];
    double *earlier = earlier_loads(ports, z);
    for (size_t k = 0; k <= ports; k++, z += WRENCH_SIZE, earlier += WRENCH_SIZE) {
        const LoadRecord now = load_record(ports, arms, record, k, axes);
        const LoadRecord before = load_record(ports, arms, record, k, axes_before);
        load_in_axes(ports, arms, wrenches, k, axes, z);
        for (size_t i = 0; i < WRENCH_SIZE; i++) {
            if (h != 0.0)
                z[i] = extrapolated((StepMean){now.mean[i], now.slope[i], h},
                                    (StepMean){now.mean_before[i], now.slope_before[i], h_before});
            earlier[i] = 0.0;
            if (tells_earlier(record))
                earlier[i] = between((StepMean){before.mean_before[i], before.slope_before[i], h_before},
                                     (StepMean){before.mean[i], before.slope[i], h});
        }
    }
}

/* Takes off both sums what acts on the base itself from outside, at ports whose flag is set. */
static inline void leave_outside(size_t ports, const double *outside, const double *arms, double *z) {
    for (size_t k = 0; k < 2 * ports; k++) {
        if (outside[k % ports] == 0.0) continue;
        double *sum = k < ports ? z : earlier_loads(ports, z);
        const double *own = sum + WRENCH_SIZE * (1 + k % ports);
        double lever[3];
        vector_store(vector_cross(vector_of(arms + 3 * (k % ports)), vector_of(own)), lever);
        for (size_t i = 0; i < 3; i++) {
            sum[i] -= own[i];
            sum[3 + i] -= own[3 + i] + lever[i];
        }
    }
}

#endif

#endif
