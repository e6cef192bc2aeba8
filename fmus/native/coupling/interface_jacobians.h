/* The interface Jacobian of a coupled step: how motions follow from wrenches, and wrenches from motions.

   A body's mobility is d(motion at the end of the step) / d(wrench); a connection's stiffness is d(wrench) / d(motion at the
   end of the step). Both are nearly constant in axes that turn with the first port, for a given step size: a matrix is turned
   along until the iteration stops contracting. They are kept by step size as long as they hold. */

#ifndef FANFOLD_INTERFACE_JACOBIANS_H
#define FANFOLD_INTERFACE_JACOBIANS_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* The matrices of one step size h (s), 0 where there are none; last_use: when they were asked for, as counted. */
typedef struct {
    double h;
    size_t last_use;
    int has_mobilities, has_stiffnesses, bodies_outdated;
    JacobianBlock *mobility, *stiffness;
    double *numbers; /* of all blocks, matrix before axes, bodies first */
} SizedJacobian;

/* sizes (kept,): many, as events are searched for by steps of sizes of their own; constant: by body, whether its mobility
   holds wherever it is; slope: room for the outputs and inputs of any participant; first: where the block of each
   participant begins among the numbers of a step size. */
typedef struct {
    SizedJacobian *sizes;
    const unsigned char *constant;
    double *slope;
    size_t *first, kept, uses;
} Jacobians;

/* Evaluate connections anew when they are next used: laws changed. */
void jacobians_outdate(Jacobians *j);
/* Evaluate everything anew. */
void jacobians_forget(Jacobians *j);
size_t block_size(const Network *n, size_t participant);
/* Those of a step size, in place of those used least where it is new. */
SizedJacobian *jacobian_of(const Network *n, Jacobians *j, double h);
/* The known mobilities of the step size next to one, for what goes with a power of it; NULL without any. */
const SizedJacobian *nearest_mobilities(const Jacobians *j, double h);
/* One block about the step just made, the axes behind it; the participant ends stepped. 0 where it cannot. */
int fill_block(Network *n, const Jacobians *j, size_t participant, double *numbers);
/* Have the matrices of a size, those missing made about the step just made; 0 where a participant cannot tell. */
int use_jacobian(Network *n, Jacobians *j, SizedJacobian *one);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
