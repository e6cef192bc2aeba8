/* Linear equations of a chain of nodes with six unknowns each, of which only neighbours know each other: part of beam.c. */

#ifndef FANFOLD_BEAM_CHAIN_H
#define FANFOLD_BEAM_CHAIN_H

#include "beam_model.h"
#include "body_products.h"

/* Factorises a block in place, rows exchanged as the pivots say. A pivot of zero leaves numbers that are not finite. */
static inline void factorise_block(double a[BLOCK], unsigned char pivots[NODE]) {
    for (int j = 0; j < NODE; j++) {
        int best = j;
        for (int i = j + 1; i < NODE; i++)
            if (fabs(a[NODE * i + j]) > fabs(a[NODE * best + j])) best = i;
        pivots[j] = (unsigned char)best;
        if (best != j)
            for (int k = 0; k < NODE; k++) {
                double kept = a[NODE * j + k];
                a[NODE * j + k] = a[NODE * best + k];
                a[NODE * best + k] = kept;
            }
        const double scale = 1.0 / a[NODE * j + j];
        for (int i = j + 1; i < NODE; i++) {
            const double factor = a[NODE * i + j] *= scale;
            for (int k = j + 1; k < NODE; k++) a[NODE * i + k] -= factor * a[NODE * j + k];
        }
    }
}

/* Solves with such factors for `count` right sides, the columns of b. */
static inline void solve_block(const double a[BLOCK], const unsigned char pivots[NODE], double *b, int count) {
    for (int j = 0; j < NODE; j++)
        if (pivots[j] != j)
            for (int k = 0; k < count; k++) {
                double kept = b[count * j + k];
                b[count * j + k] = b[count * pivots[j] + k];
                b[count * pivots[j] + k] = kept;
            }
    for (int i = 1; i < NODE; i++)
        for (int j = 0; j < i; j++)
            for (int k = 0; k < count; k++) b[count * i + k] -= a[NODE * i + j] * b[count * j + k];
    for (int i = NODE - 1; i >= 0; i--) {
        for (int j = i + 1; j < NODE; j++)
            for (int k = 0; k < count; k++) b[count * i + k] -= a[NODE * i + j] * b[count * j + k];
        const double scale = 1.0 / a[NODE * i + i];
        for (int k = 0; k < count; k++) b[count * i + k] *= scale;
    }
}

/* Factorises in place; `next` becomes what eliminates the next node from each. */
FANFOLD_VECTORISED static void factorise_chain(Factors *f, size_t nodes) {
    for (size_t n = 0; n < nodes; n++) {
        double *own = f->nodes + BLOCK * n;
        if (n > 0) {
            const double *back = f->back + BLOCK * (n - 1), *eliminated = f->next + BLOCK * (n - 1);
            for (int i = 0; i < NODE; i++)
                for (int j = 0; j < NODE; j++) {
                    const double factor = back[NODE * i + j];
                    for (int k = 0; k < NODE; k++) own[NODE * i + k] -= factor * eliminated[NODE * j + k];
                }
        }
        factorise_block(own, f->pivots + NODE * n);
        if (n + 1 < nodes) solve_block(own, f->pivots + NODE * n, f->next + BLOCK * n, NODE);
    }
}

/* Solves in place for one right side, six numbers a node. */
FANFOLD_VECTORISED static void solve_chain(const Factors *f, size_t nodes, double *b) {
    for (size_t n = 0; n < nodes; n++, b += NODE) {
        if (n > 0) {
            const double *back = f->back + BLOCK * (n - 1);
            for (int i = 0; i < NODE; i++)
                for (int j = 0; j < NODE; j++) b[i] -= back[NODE * i + j] * b[j - NODE];
        }
        solve_block(f->nodes + BLOCK * n, f->pivots + NODE * n, b, 1);
    }
    for (size_t n = nodes - 1; n-- > 0;) {
        double *own = b - NODE * (nodes - n);
        const double *eliminated = f->next + BLOCK * n;
        for (int i = 0; i < NODE; i++)
            for (int j = 0; j < NODE; j++) own[i] -= eliminated[NODE * i + j] * own[NODE + j];
    }
}

/* Velocities that momenta of the nodes belong to, in place: consistent mass, three numbers a node. */
static void divide_by_mass(const Beam *beam, double *v) {
    size_t nodes = beam->nodes;
    for (size_t n = 1; n < nodes; n++)
        for (int i = 0; i < 3; i++) v[3 * n + i] -= beam->ratios[n - 1] * v[3 * (n - 1) + i];
    for (int i = 0; i < 3; i++) v[3 * (nodes - 1) + i] /= beam->pivots[nodes - 1];
    for (size_t n = nodes - 1; n-- > 0;)
        for (int i = 0; i < 3; i++)
            v[3 * n + i] = v[3 * n + i] / beam->pivots[n] - beam->ratios[n] * v[3 * (n + 1) + i];
}

#endif
