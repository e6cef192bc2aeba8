/* One source of equations, two number types: double, and complex with an infinitesimal imaginary part.

   Every equations file is compiled twice. With FANFOLD_COMPLEX the imaginary part carries a derivative along
   one direction of the inputs, exact to round-off: it is so small (FANFOLD_INFINITESIMAL) that its square
   vanishes, so each function here is its own first-order expansion. Decisions look at the real part only. */

#ifndef FANFOLD_REAL_H
#define FANFOLD_REAL_H

#include <math.h>

#include <complex.h>
#include <string.h>

#define FANFOLD_INFINITESIMAL 1e-100

/* Into loops that are compiled for several processors, which would call the one for the plainest otherwise. */
#ifdef __GNUC__
#define FANFOLD_INLINED static inline __attribute__((always_inline))
#else
#define FANFOLD_INLINED static inline
#endif

/* A complex number of two parts; C99 has no such macro, and a sum with I times b is slow and not exact. */
static inline double complex complex_of(double a, double b) {
    double parts[2] = {a, b};
    double complex result;
    memcpy(&result, parts, sizeof result);
    return result;
}

#ifdef FANFOLD_COMPLEX

typedef double complex real;
#define NAME(function) function##_complex

static inline double value_of(real a) { return creal(a); }
static inline real real_sqrt(real a) {
    double s = creal(a) > 0.0 ? sqrt(creal(a)) : 0.0; /* squares of infinitesimals make a zero a little negative */
    return complex_of(s, s > 0.0 ? cimag(a) / (2.0 * s) : 0.0);
}
static inline real real_sin(real a) { return complex_of(sin(creal(a)), cimag(a) * cos(creal(a))); }
static inline real real_cos(real a) { return complex_of(cos(creal(a)), -cimag(a) * sin(creal(a))); }
static inline real real_tan(real a) {
    double t = tan(creal(a));
    return complex_of(t, cimag(a) * (1.0 + t * t));
}
static inline real real_exp(real a) {
    double e = exp(creal(a));
    return complex_of(e, cimag(a) * e);
}
static inline real real_asin(real a) {
    double v = creal(a);
    return complex_of(asin(v), cimag(a) / sqrt(1.0 - v * v));
}
static inline real real_atan2(real y, real x) {
    double b = creal(y), a = creal(x), square = a * a + b * b;
    return complex_of(atan2(b, a), square > 0.0 ? (a * cimag(y) - b * cimag(x)) / square : 0.0);
}
static inline real real_abs(real a) { return creal(a) < 0.0 ? -a : a; }

#else

typedef double real;
#define NAME(function) function##_real

static inline double value_of(real a) { return a; }
static inline real real_sqrt(real a) { return sqrt(a); }
static inline real real_sin(real a) { return sin(a); }
static inline real real_cos(real a) { return cos(a); }
static inline real real_tan(real a) { return tan(a); }
static inline real real_exp(real a) { return exp(a); }
static inline real real_asin(real a) { return asin(a); }
static inline real real_atan2(real y, real x) { return atan2(y, x); }
static inline real real_abs(real a) { return fabs(a); }

#endif
#endif
