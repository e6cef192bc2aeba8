/* An assembly of components with its master as one component: its structures, from data that orchestrator/run/as_one
   writes. Nothing in them is trusted where it is an index. */

#ifndef FANFOLD_ASSEMBLY_MODEL_H
#define FANFOLD_ASSEMBLY_MODEL_H

#include "alike.h"
#include "instance.h"
#include "tables.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { FITTED = 4, RING = 6, SNAPSHOTS = 3, OWN_SCALARS = 5 };

/* An input of the assembly: releases a participant (is_release), or latches a line. */
typedef struct {
    size_t is_release, line;
    Place release;
} Command;

/* Rates and accelerations of a driven base: its participant, the place of the rates of its accelerations among the inputs
   of that and of the others in the state, and of the DRIVES numbers among the assembly's inputs. */
typedef struct {
    size_t is_there, participant, change, rate[2], acceleration[2], first;
} DrivenFrame;

enum { BASE_RATES = 6, DRIVES = 12 };

/* Of a load's peak: where its numbers stand among what is recorded, and whether they add up or are components. */
typedef struct {
    size_t is_sum, count;
    const size_t *place;
} Peak;

/* first_parameter, first_input: by participant, among those of all. Numbers of a run that a saved state holds lie in one
   array `standing`, but for the states and inputs of participants. Parameters: those that the host has set last
   (wanted), those of them that the run knows of (applied), and those that participants have (in_force). A run starts from the states, inputs and wrenches at rest, where the scene has a
   preload; otherwise these are NULL.

   A component's state: OUTER numbers, see below, applied parameters, inputs, peaks, rows of the ring (time, segment,
   recorded, channels), and snapshots in slots: serial, time, standing, states, inputs. `stands` tells whether all
   this is that of the state numbered `serial`; run_serial numbers what the run itself has come to. driven_step,
   longest_step (s): the last one that the base was driven over, and the longest, 0 before. meets_rates: whether the base
   has the rates given to it at a step's end. */
typedef struct {
    Sequence sequence;
    Instance **instance;
    SavedState **saved;
    double **input;
    size_t *first_parameter, *first_input, *latching; /* room for lines that commands latch */
    Command *command;
    Peak *peak;
    const size_t *flag; /* (flags,) places of observations that are 0 or 1 */
    DrivenFrame driven;
    NotedSteps noted;
    double *standing, *scalars, *in_force, *wanted, *applied, *inputs, *peaks, *ring, *snapshot;
    const double *rest_states, *rest_inputs, *rest_wrenches;
    size_t participants, flags, commands, inputs_count, peak_count, row_size, standing_size, snapshot_size,
        parameter_count, input_count;
    size_t rows, snapshots, newest, states;
    double time, serial, run_serial, last_run, peak_time, last_row_time, target, driven_step, longest_step;
    int stands, at_event, meets_rates;
    const char **link_name, **event_name;
    char said[512];
} Assembly;

/* Numbers that come first in a state. */
enum { AT_TIME, AT_SERIAL, AT_RUN, AT_SNAPSHOTS, AT_NEWEST, AT_ROWS, AT_PEAK_TIME, AT_DRIVEN, AT_LONGEST, AT_STEPS, AT_REJECTED, AT_EVENT, OUTER };
/* Whether a communication point is an event, which the run has gone through without going on; what is read there is what
   was before the event or what came out of it. */
enum { NO_EVENT, BEFORE_EVENT, AFTER_EVENT };


/* All that follows from the data; 0 and a sentence where they are unusable. */
int assembly_furnish(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
