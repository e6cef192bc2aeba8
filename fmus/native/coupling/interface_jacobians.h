/* The interface Jacobian of a coupled step: the derivatives of motions by wrenches, and of wrenches by motions.

   A body's mobility is d(motion at the end of the step) / d(wrench); a connection's stiffness is d(wrench) / d(motion
   at the end of the step). For a given step size both are nearly constant in axes that turn with the first port. A
   matrix is turned with these axes until the iteration contracts too slowly. Matrices are kept by step size. */

#ifndef FANFOLD_INTERFACE_JACOBIANS_H
#define FANFOLD_INTERFACE_JACOBIANS_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* The matrices of a step size h (s), which is 0 where there are none; last_use: the count of `uses` at the last use. */
typedef struct {
    double h;
    size_t last_use;
    int has_mobilities, has_stiffnesses, bodies_outdated;
    JacobianBlock *mobility, *stiffness;
    double *numbers; /* of all blocks, matrix before axes, bodies first */
} SizedJacobian;

/* sizes (kept,): many, as events are located by steps of sizes of their own. constant (bodies,): whether a body's
   mobility is the same in any motion. slope: room for the outputs and inputs of any participant. first (participants +
   1,): where the block of each participant begins among the numbers of a step size. once: the mobilities as they were
   evaluated first, for a step size once_h (s), 0 where there are none. */
typedef struct {
    SizedJacobian *sizes;
    const unsigned char *constant;
    double *slope, *once, once_h;
    size_t *first, kept, uses;
} Jacobians;

/* Evaluate the stiffnesses of connections anew at the next use, as their laws changed. */
void jacobians_outdate(Jacobians *j);
/* Evaluate all matrices anew at the next use. */
void jacobians_forget(Jacobians *j);
size_t block_size(const Network *n, size_t participant);
/* The matrices of a step size; a new size replaces the one that was not used for longest. */
SizedJacobian *jacobian_of(const Network *n, Jacobians *j, double h);
/* The mobilities of the known step size nearest to h, for quantities that are proportional to a power of it; NULL
   without any. */
const SizedJacobian *nearest_mobilities(const Jacobians *j, double h);
/* Compute one block about the step just made, with its axes behind it; the participant then stands at the end of the
   step. 0 if it fails. */
int fill_block(Network *n, const Jacobians *j, size_t participant, double *numbers);
/* Use the matrices of a size; missing ones are computed about the step just made. 0 if a participant fails. */
int use_jacobian(Network *n, Jacobians *j, SizedJacobian *one);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
