/* Two processes that wait for each other are fastest on one processor, where no other has to be woken. Includers define
   _GNU_SOURCE before anything else. */

#ifndef FANFOLD_PROCESSOR_H
#define FANFOLD_PROCESSOR_H

#include <stddef.h>
#include <time.h>
#ifdef __linux__
#include <sched.h>
#endif

enum { BEFORE = 100 };
static const double BRIEF = 2e-4; /* s */

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#ifdef __linux__

/* Where a process may run, which processor it keeps to (-1: none), and how many calls in a row were brief. */
typedef struct {
    cpu_set_t allowed;
    int kept;
    size_t brief;
} Place;

static inline int processor_here(void) { return sched_getcpu(); }

static inline Place place_here(void) {
    Place place = {.kept = -1};
    sched_getaffinity(0, sizeof place.allowed, &place.allowed);
    return place;
}

/* Go where the other process is, after some calls that all took few seconds; an FMU whose calls last may have threads,
   which need all processors. */
static inline void follow(Place *place, int processor, double seconds) {
    place->brief = seconds < BRIEF ? place->brief + 1 : 0;
    const int wanted = place->brief > BEFORE ? processor : -1;
    if (wanted == place->kept) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    if (wanted >= 0) CPU_SET(wanted, &one);
    sched_setaffinity(0, sizeof one, wanted < 0 ? &place->allowed : &one);
    place->kept = wanted;
}

#else

typedef int Place;
static inline int processor_here(void) { return -1; }
static inline Place place_here(void) { return 0; }
static inline void follow(Place *place, int processor, double seconds) { (void)place, (void)processor, (void)seconds; }

#endif
#endif
