/* The coupling of participants during a run: its state, the steps that it makes, and what events change.

   The order of events is decided elsewhere: by orchestrator/cosim/master.py and, in one FMU of a scene, by sequence.c.
   Both call the functions here. A function that can fail returns 0 if a participant or a step fails; `progress.failure`
   says which. */

#ifndef FANFOLD_COUPLING_H
#define FANFOLD_COUPLING_H

#include "latch_up.h"
#include "rows.h"
#include "step_control.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* An input, an output or a parameter of a participant, by numbers. */
typedef struct {
    size_t participant, place;
} Place;

/* A distance that falls through zero where a line latches or a condition is met: (value - *place) / scale. before: its
   value after the last accepted step; rate: its decrease per second in that step. */
typedef struct {
    const double *place;
    double value, scale, before, rate;
} Crossing;

/* A hinge line with a latch. hinge (hinges,): numbers of its participants; is_kinematic: whether an impulse latches it.
   Part of a saved state: sensor, the index of the hinge whose angle counts; released (hinges,), whether each hinge was
   released; stiffened, what the latch makes stiff. */
typedef struct {
    size_t hinges, is_kinematic;
    const size_t *hinge;
    double *sensor, *released;
    StiffenedLine *stiffened;
} HingeLine;

/* A stop or contact. participant: its number; place: its penetration among the observations; before: that after the
   last accepted step. Part of a saved state: waits, 1 until something strikes it; struck, this one and all that were
   struck in the same step. */
typedef struct {
    size_t participant;
    const double *place;
    double before, *waits;
    StiffenedLine *struck;
} Strike;

enum { MOST_STRUCK = 8 }; /* stops and contacts struck in one step whose loads are judged */

/* Why a function failed: not at all, because a participant refused a call, or because no step size converges. */
enum { NO_FAILURE, OF_PARTICIPANT, OF_STEP };

/* All of a coupling. crossing (crossings,): the first `lines` of them belong to hinge lines, the others to conditions.
   pending, reached, passed (crossings,): whether one is waited for, fell through zero at the end of the last step, or
   did so in the last impulse. impulse (impulses,): inputs that command an impulse. latch_command,
   unlatch_command, latch_distance (participants,): places of these inputs and this output of hinges. law (laws,): outputs with the time to the next
   break, the first `bolts` of them those of hold-downs. law_time, release_time (s): of the next break, and of the next
   release of a hold-down. steps (rows.room,): sizes (s) of the steps since `coupling_advance` was called. position:
   number of steps in the present segment. stalled: correction over the largest wrench that an iteration may leave.
   repeats: whether steps are accepted without judgement, as they repeat others. untold: whether the row of the present
   instant is still to be written. slopes (2, most_hinges), room (3, most_hinges, most_hinges): work space for as many
   hinges as a line has, or stops that are struck at once. */
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
    const size_t *latch_distance, *latch_command, *unlatch_command;
    Slope *slopes;
    const double **law;
    const double *by_tolerance;
    double *pending, *reached, *passed, *steps, *room, *scalars;
    double start_step, driving_energy, law_time, release_time, segment, stalled;
    size_t lines, crossings, strikes, impulses, laws, bolts, position, repeats, untold, most_hinges;
} Coupling;

/* Set what follows from a tolerance: step sizes, and errors that iterations and steps may leave. */
void coupling_take_tolerance(Coupling *c, double tolerance);

/* Begin at t = 0 with initialised participants whose outputs have been read; `accepted` contains the wrenches there.
   Energies count from what participants observe there. */
int coupling_start(Coupling *c);
/* Write the first row, with loads just after t = 0, and save the state to step from. Call it after all that acts at
   the start. */
int coupling_record_start(Coupling *c);

/* Why `coupling_advance` returns. PAUSED: to report, or because there is no room for more rows. REACHED: an accepted
   step ended where a line or a condition is met. BROKE: it ended at a break of a law. TOO_LONG, UNSOLVED: a planned
   step has to be divided, as it leaves the energy balance open or does not converge. STOPPED_SHORT: no step can be
   made. */
enum { PAUSED, REACHED, BROKE, TOO_LONG, UNSOLVED, STOPPED_SHORT };
/* Make steps until one of these. Steps end exactly where a line or a condition is met. */
int coupling_advance(Coupling *c);
/* Let jumps of the energy balance pass that are as large as the one of the last planned step. */
void coupling_give_in(Coupling *c);

/* Note the distances of lines, conditions and stops, and the times of the next breaks. */
void coupling_watch(Coupling *c);
/* Save the states of all participants; steps return to them. */
int coupling_save(Coupling *c);

/* Before an event: solve a step of `after` (s), in which nothing moves, and note by how much its loads differ from
   those of the steps. `coupling_record_jump` then shows the change by the event alone. */
int coupling_note_roughness(Coupling *c, double after);
/* After an event: write a row with the loads just after it, from a step of `after` (s), in which nothing moves and
   which is then taken back. others: whether more is to act at this instant; the last of it then writes the row.
   `progress.solved` says whether the step could be solved. */
int coupling_record_jump(Coupling *c, double after, int others);
/* Size (s) of a step in which nothing moves, where other steps have a size (s). */
double instant_of(double size);
/* Make a step h (s), INSTANT or AGAIN, in which every joint removes the relative rates that it does not allow. Lines
   that pass their latches in it are marked as `passed`. AGAIN removes the little that INSTANT left; if it does not
   converge, nothing changes. */
int coupling_impulse(Coupling *c, double h);
/* Write a row after the impulses of a lock. */
void coupling_record_impulse(Coupling *c);
/* Latch a line. judged: whether its vibration determines the next step, and its loads count in errors. Returns the size
   (s) of the next step, 0 for a failure. */
double coupling_engage(Coupling *c, size_t line, int judged);
/* Release a participant: lines go on with their other hinges, and its load is no longer judged. A line without hinges
   is no longer pending. */
void coupling_release(Coupling *c, size_t participant);
/* Open the latches of a line, which then let go and stay open, or make them ready again (open: 0). Returns whether the
   line was latched and is not any more. */
int coupling_unlatch(Coupling *c, size_t line, int open);
/* Weight errors of the loads of latched lines and struck stops by the present energies. Every stop may be struck anew,
   as an event has changed something. */
void coupling_judge_loads(Coupling *c);
/* Count the change of the energy balance since `before` (J) as supplied from outside. */
int coupling_supply(Coupling *c, double before);
/* Continue with first steps, or with a size `known` (s) if that is larger. Earlier steps do not predict the next
   ones. */
void coupling_renew(Coupling *c, double known);
/* The same with a size (s), after a latch-up. */
void coupling_restart(Coupling *c, double size);
/* Begin a new segment, if the present one has steps. */
void coupling_begin_segment(Coupling *c);
/* Size (s), at most h, at which a jump of wrenches (size,) causes an error that leaves room to grow; 0 where no
   mobilities are known. */
double coupling_step_after_jump(Coupling *c, double h, const double *change);

/* Copy the numbers of the state that are in no array to (write) or from `scalars`: SCALARS numbers, then OF_WATCHED for
   each watched load. */
enum { SCALARS = 40, OF_WATCHED = 7 };
void coupling_exchange_scalars(Coupling *c, int write);
/* Place all arrays of the state from `first` on; returns how many numbers they have. first: NULL to compute that
   alone. */
size_t coupling_arrange(Coupling *c, double *first);
/* Restore participants and the coupling after the arrays of the state were replaced. */
int coupling_stand(Coupling *c);

/* Note why something failed; returns 0. */
int coupling_fails(Coupling *c, int failure);
/* Whether an iteration has ended well: converged, or within `stalled`. */
int is_solved(const Coupling *c, int status);
/* List the loads of latched lines and struck stops as `watched`, with their weights. */
void coupling_watch_loads(Coupling *c);
/* Remove a connection, and what was struck with it, from the loads of struck stops. */
void coupling_forget_struck(Coupling *c, size_t participant);
/* Let the distances of lines point to the outputs of their present sensors. */
void coupling_aim_sensors(Coupling *c);
static inline double distance_of(const Crossing *c) { return (c->value - *c->place) / c->scale; }

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
