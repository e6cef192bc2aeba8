/* Numbers of the scheme: components/numerics/scheme.py, written by python -m fmus.native. */

#ifndef FANFOLD_SCHEME_H
#define FANFOLD_SCHEME_H

#define OF_INCREMENTS 0.2
#define OF_RATES 0.05
#define NUMERICAL_DAMPING 0.1
#define ROUGHNESS_SHARE 0.25
#define LEAST_RATE 1e-30
#define ROUGH 0.01
#define LEAST_CHANGE 1e-05
#define LEAST_SPAN 1e-09
#define INSTANT 1e-07
#define INSTANT_SHARE 0.001
#define AGAIN 5e-08
#define AGAIN_ITERATED 1e-08
#define IMPULSE_ITERATED 1e-10
#define IMPULSE_RESIDUAL 1.0
#define CREST_SURE 4.0
#define NEVER 1e+300
#define STOPPED -1.0
#define FAR_APART 1000000000.0

#endif
