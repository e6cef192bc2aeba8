/* Linear equations of a chain of nodes with six unknowns each, of which only neighbours know each other: part of beam.c. */

#ifndef FANFOLD_BEAM_CHAIN_H
#define FANFOLD_BEAM_CHAIN_H

#include "beam_model.h"
#include "body_products.h"
#include "dense.h"

/* own -= back eliminated, blocks. */
FANFOLD_INLINED void eliminate_block(double *restrict own, const double *restrict back, const double *restrict eliminated) {
    for (int i = 0; i < NODE; i++) {
        double row[NODE];
        for (int k = 0; k < NODE; k++) row[k] = own[NODE * i + k];
        for (int j = 0; j < NODE; j++)
            for (int k = 0; k < NODE; k++) row[k] -= back[NODE * i + j] * eliminated[NODE * j + k];
        for (int k = 0; k < NODE; k++) own[NODE * i + k] = row[k];
    }
}

/* Factorises in place; `next` becomes what eliminates the next node from each. */
FANFOLD_VECTORISED static void factorise_chain(Factors *f, size_t nodes) {
    for (size_t n = 0; n < nodes; n++) {
        double *own = f->nodes + BLOCK * n;
        if (n > 0) eliminate_block(own, f->back + BLOCK * (n - 1), f->next + BLOCK * (n - 1));
        factorise_dense(own, NODE, f->pivots + NODE * n);
        if (n + 1 < nodes) solve_dense(own, NODE, f->pivots + NODE * n, f->next + BLOCK * n, NODE);
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
        solve_dense(f->nodes + BLOCK * n, NODE, f->pivots + NODE * n, b, 1);
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
