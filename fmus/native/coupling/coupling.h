/* Participants under way: where they stand, what may happen to them within a step, and what events make of them.

   What happens when is decided elsewhere, by orchestrator/cosim/master.py and, inside of one FMU of a scene, by sequence.c.
   Both call the functions here. Those that can fail return 0 where a participant or a step does; `failure` tells which. */

#ifndef FANFOLD_COUPLING_H
#define FANFOLD_COUPLING_H

#include "latch_up.h"
#include "rows.h"
#include "step_control.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* An input or parameter of a participant. */
typedef struct {
    size_t participant, place;
} Place;

/* A distance that falls through zero where a line latches or a condition holds: (value - *place) / scale. before: what was
   left of it after the last accepted step; rate: at which it fell over that. */
typedef struct {
    const double *place;
    double value, scale, before, rate;
} Crossing;

/* hinge: its participants; is_kinematic: latched by an impulse. Numbers that are part of a saved state: sensor (which of the
   hinges), released (hinges,), stiffened. */
typedef struct {
    size_t hinges, is_kinematic;
    const size_t *hinge;
    double *sensor, *released;
    StiffenedLine *stiffened;
} HingeLine;

/* A stop or contact: its participant, where its penetration is observed, and that after the last accepted step. Numbers that
   are part of a saved state: waits (whether nothing has struck it), struck (with all that was struck with it). */
typedef struct {
    size_t participant;
    const double *place;
    double before, *waits;
    StiffenedLine *struck;
} Strike;

enum { MOST_STRUCK = 8 }; /* stops and contacts that are judged together */

/* Why something could not be done: nothing, what a participant said, or that no step size converges. */
enum { NO_FAILURE, OF_PARTICIPANT, OF_STEP };

/* crossing (crossings,): one a line, `lines` of them, then one a condition; pending (crossings,): whether it is waited for;
   reached, passed (crossings,): what fell through zero at the end of the last step, or in the last impulse. command places:
   impulse (impulses,), latch_command and latch_distance by participant, where it has them. law (laws,): times to breaks, the
   first of them, bolts, of hold-downs; law_time, release_time (s): of the next break and of the next that is a release.
   steps (room of rows,): sizes made since the last `coupling_advance`. position: steps of the segment. stalled: correction, over the largest wrench, that may be left;
   repeats: whether steps stand that are made as others were. untold: whether the row of an instant is still to come. slopes
   (2, most_hinges), room (3, most_hinges, most_hinges): to work in, as there may be hinges on a line or stops struck at once. */
typedef struct {
    Network network;
    Solver solver;
    StepSizes sizes;
    ErrorLimit limit;
    EnergyGuard guard;
    SubdividedStep divided;
    Rows rows;
    Request request;
    Progress progress;
    HingeLine *line;
    Crossing *crossing;
    Strike *strike;
    Watched *watched;
    const Place *impulse;
    const size_t *latch_distance, *latch_command;
    Slope *slopes;
    const double **law;
    const double *by_tolerance;
    double *pending, *reached, *passed, *steps, *room, *scalars;
    double start_step, driving_energy, law_time, release_time, segment, stalled;
    size_t lines, crossings, strikes, impulses, laws, bolts, position, repeats, untold, most_hinges;
} Coupling;

/* What follows from a tolerance: of steps, of iterations, and of errors. */
void coupling_take_tolerance(Coupling *c, double tolerance);

/* Stand at t = 0 with participants that are initialised and hold their first outputs; `accepted` are the wrenches there.
   What they observe there is where energies count from. */
int coupling_start(Coupling *c);
/* After what else acts at t = 0: the row there, with loads just after it, and a state to step from. */
int coupling_record_start(Coupling *c);

/* Why `coupling_advance` came back: to report, or as there is no room for more rows; an accepted step ended where something
   is `reached`, or at a break of a law; a planned step has to be divided, for its error or to converge; or it failed. */
enum { PAUSED, REACHED, BROKE, TOO_LONG, UNSOLVED, STOPPED_SHORT };
/* Steps until one of these; lines and conditions are met exactly. */
int coupling_advance(Coupling *c);
/* Let pass what a planned step leaves open of the balance of energy. */
void coupling_give_in(Coupling *c);

/* Note how far all is from what may happen, and when the next break is. */
void coupling_watch(Coupling *c);
/* The present states are those to return to. */
int coupling_save(Coupling *c);

/* Before an event acts, an instant on: what loads of an instant are off those that steps tell, so that `coupling_record_jump`
   tells what the event makes of them, and no more. after (s): the instant. */
int coupling_note_roughness(Coupling *c, double after);
/* A row with what an event makes of loads, from a step too short for motion, which is then taken back; others: whether others
   are to act at this instant, to the last of which the row is left: what is between them lasts no time. Matrices of bodies are
   kept where `keeps_bodies`. solved in `progress` tells whether the step could be solved. */
int coupling_record_jump(Coupling *c, double after, int others, int keeps_bodies);
/* A step (s) too short for motion, beside steps of a size (s). */
double instant_of(double size);
/* A vanishing step h (s), INSTANT or AGAIN, in which every joint takes away the rates that it does not allow; lines that pass
   their latches in it, of which no step tells, are `passed`. The second one takes what little the first one left, and gives
   in sooner: all is as before it then. */
int coupling_impulse(Coupling *c, double h);
/* A row after the impulses of a lock. */
void coupling_record_impulse(Coupling *c);
/* Latch a line, judged: by how it vibrates from then on; the step (s) to go on with, 0 for a failure. */
double coupling_engage(Coupling *c, size_t line, int judged);
/* Let go of a participant: lines go on with those of their hinges that are left, and load is judged no more. 0 in `pending`
   for those without any. */
void coupling_release(Coupling *c, size_t participant);
/* Judge loads of latched lines and struck stops by the energies of now; what an event changed may strike stops anew. */
void coupling_judge_loads(Coupling *c);
/* What was set since a balance (J) was observed changes energies from outside. */
int coupling_supply(Coupling *c, double before);
/* Continue with first steps, or a known step (s) where that is longer; steps before do not predict those to come. */
void coupling_renew(Coupling *c, double known);
/* The same with steps of a size (s) after a latch-up. */
void coupling_restart(Coupling *c, double size);
/* Count steps anew, where any were made since the last event. */
void coupling_begin_segment(Coupling *c);
/* A step (s), up to h, that bends no more by a jump of wrenches (size,); 0 where mobilities are not known. */
double coupling_step_after_jump(Coupling *c, double h, const double *change);

/* Numbers of the state that are in no array, to or from `scalars`; their count is SCALARS and watched loads after them. */
enum { SCALARS = 40, OF_WATCHED = 7 };
void coupling_exchange_scalars(Coupling *c, int write);
/* Place all arrays of the state from `first` on; how many numbers they are. first: NULL to learn that. */
size_t coupling_arrange(Coupling *c, double *first);
/* After the state was put back: have participants stand there. */
int coupling_stand(Coupling *c);

/* Take note of why no step could be made; 0. */
int coupling_fails(Coupling *c, int failure);
/* Whether an iteration has ended well: converged, or at what it is allowed to leave. */
int is_solved(const Coupling *c, int status);
/* Weight errors of steps by loads of latched lines and struck stops. */
void coupling_watch_loads(Coupling *c);
/* Judge a connection's load no more, as one that was struck. */
void coupling_forget_struck(Coupling *c, size_t participant);
/* Have distances of lines tell what their present sensors do. */
void coupling_aim_sensors(Coupling *c);
static inline double distance_of(const Crossing *c) { return (c->value - *c->place) / c->scale; }

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
