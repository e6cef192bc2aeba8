/* A scene as one component: its structures, from data that orchestrator/run/as_one writes. Every index in them is
   checked. */

#ifndef FANFOLD_ASSEMBLY_MODEL_H
#define FANFOLD_ASSEMBLY_MODEL_H

#include "alike.h"
#include "appendage.h"
#include "host_stability.h"
#include "instance.h"
#include "tables.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { FITTED = 4, RING = 6, SNAPSHOTS = 3, OWN_SCALARS = 5 };

/* An input of the assembly: latches a line, releases a participant, or opens the latches of a line while it is 1. */
enum { LATCHES, RELEASES, UNLATCHES };
typedef struct {
    size_t kind, line;
    Place release;
} Command;

/* A driven base: its participant; place of the rates of its accelerations among that participant's inputs (change);
   places of its rates and accelerations in that participant's state; first of the DRIVES numbers among the assembly's
   inputs. */
typedef struct {
    size_t is_there, participant, change, rate[2], acceleration[2], first;
} DrivenFrame;

enum { BASE_RATES = 6, DRIVES = 12 };

/* The peak of a load: places of its numbers among what is recorded, and whether they are summands or components. */
typedef struct {
    size_t is_sum, count;
    const size_t *place;
} Peak;

/* first_parameter, first_input: by participant, among those of all. standing: all numbers of a run that a saved state
   contains, except states and inputs of participants. Parameters: those that the host has set last (wanted), those of
   them that the run has accepted (applied), and those of the participants (in_force). A scene with preload starts from
   the states, inputs and wrenches at rest; without, these are NULL.

   A component's state: OUTER numbers, see below, applied parameters, inputs, swings of a driven base, peaks, rows of the
   ring (time, segment, recorded, channels), and snapshots in slots: serial, time, standing, states, inputs. stands: whether all this is that
   of the state numbered `serial`; run_serial: number of what the run itself has reached. driven_step, longest_step (s):
   the last step that the base was driven over, and the longest, 0 before. meets_rates: whether the base has the given
   rates at the end of a step. swing: of translation and rotation; is_unstable: whether one of them grows; is_told:
   whether the host has heard so. */
typedef struct {
    Sequence sequence;
    Instance **instance;
    SavedState **saved;
    double **input;
    size_t *first_parameter, *first_input, *latching; /* room for lines that commands latch */
    Command *command;
    Peak *peak;
    const size_t *flag, *angle; /* (flags,) places of observations that are 0 or 1, (angles,) that are angles of lines */
    DrivenFrame driven;
    Appendage appendage;
    NotedSteps noted;
    double *standing, *scalars, *in_force, *wanted, *applied, *inputs, *peaks, *ring, *snapshot;
    const double *rest_states, *rest_inputs, *rest_wrenches;
    size_t participants, flags, angles, commands, inputs_count, peak_count, row_size, standing_size, snapshot_size,
        parameter_count, input_count;
    size_t rows, snapshots, newest, states;
    double time, serial, run_serial, last_run, peak_time, last_row_time, target, driven_step, longest_step;
    int stands, at_event, meets_rates, is_unstable, is_told;
    Swing swing[2];
    const char **link_name, **event_name;
    char said[512];
} Assembly;

/* Numbers that come first in a state. */
enum {
    AT_TIME, AT_SERIAL, AT_RUN, AT_SNAPSHOTS, AT_NEWEST, AT_ROWS, AT_PEAK_TIME, AT_DRIVEN, AT_LONGEST, AT_STEPS,
    AT_REJECTED, AT_EVENT, OUTER
};
/* Whether a communication point is an event that the run has gone through without going on. Values there are those
   before the event or those after it. */
enum { NO_EVENT, BEFORE_EVENT, AFTER_EVENT };


/* Create all that follows from the data; 0 and a sentence where they are unusable. */
int assembly_furnish(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
