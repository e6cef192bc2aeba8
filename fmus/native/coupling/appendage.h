/* Mass properties of what a base carries: all masses in their present poses, as one rigid body. */

#ifndef FANFOLD_APPENDAGE_H
#define FANFOLD_APPENDAGE_H

#include <stddef.h>

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { FRAME_PLACES = 2, MASS_PLACES = 3, MASS_VALUES = 13, APPENDAGE = 10 };

/* frame (FRAME_PLACES,), NULL without such a base: places of position and quaternion of the base among what is recorded. place (masses, MASS_PLACES): of the
   two positions whose mean is the origin of a mass, and of its quaternion. value (masses, MASS_VALUES): mass, centre of
   mass and inertia (3, 3) about it, in its axes; see components/contract/mass.py. */
typedef struct {
    size_t masses;
    const size_t *frame, *place;
    const double *value;
} Appendage;

/* Mass (kg), centre of mass (3, m) from the origin of the base's frame, and inertia (xx, yy, zz, xy, xz, yz; kg.m2) about
   this origin, in the axes of the frame. */
void appendage_observe(const Appendage *a, const double *recorded, double found[APPENDAGE]);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
