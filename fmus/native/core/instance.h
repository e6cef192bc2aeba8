/* One instance of a component: values, state and mode, whatever version of FMI is spoken outside.

   All values lie in one array in the order of the value references: parameters, inputs, outputs,
   observations, continuous states, their rates. Outputs and observations are computed when they are read, once
   per state; states and rates whenever they are read. */

#ifndef FANFOLD_INSTANCE_H
#define FANFOLD_INSTANCE_H

#include <stdint.h>

#include "data.h"
#include "memory.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Numbered as fmi2Status and fmi3Status are. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

/* Co-simulation has step mode, with FMI 3 event mode too; model exchange has event and continuous-time mode. */
typedef enum {
    MODE_INSTANTIATED,
    MODE_INITIALIZATION,
    MODE_STEP,
    MODE_EVENT,
    MODE_CONTINUOUS,
    MODE_TERMINATED
} Mode;

/* Takes a sentence to the host. */
typedef void (*Logger)(void *host, Status status, const char *sentence);

/* Continuous states, where the component has them: see continuous.h. `places` are their positions in the state;
   `completed` is what an instance that is `used` for model exchange evaluates, if `known`. */
typedef struct {
    int offered, used, known;
    size_t count, indicators, *places;
    const double *nominals;
    double *completed;
    double complex *complex_raw, *complex_rates;
} Continuous;

/* First derivatives of inputs that have slopes: see input_slopes.h. `count` is the number of all inputs, 0 where none
   has a slope; `places` of slopes among the inputs, 0 for none; `rates` are the derivatives, `used` once any was set;
   `inputs` is room for what they make of the inputs. */
typedef struct {
    int used;
    size_t count, *places;
    double *rates, *inputs;
} InputSlopes;

typedef struct {
    Memory memory;
    Data data;
    const Kernel *kernel;
    void *self;
    const char *name;
    char owner[16]; /* end of the token: instances of equal resources take each other's states */
    Logger logger;
    void *host;
    Sizes sizes;
    size_t ends[5], states;
    double *values, *minimum, *maximum;
    unsigned char *tunable; /* of parameters and inputs: changes at events only */
    unsigned char *kinds;   /* of all values, as VariableKind */
    int accepts_numbers;    /* values of every kind may be read and written as real ones */
    double *x, *before;
    double step_size, time, stop_time;
    double complex *complex_inputs, *complex_state, *complex_outputs;
    const double *start;
    double *apart; /* room for differences, see differences.h */
    Mode mode;
    int feedthrough, prepared, has_state, stepped, event_due, outputs_known, observations_known;
    int inputs_finite; /* known to be; those that are set are checked then */
    Continuous continuous;
    InputSlopes slopes;
} Instance;

/* A saved state; `known` counts parameters, inputs and derivatives of inputs. */
typedef struct {
    char owner[16];
    double time;
    int mode, has_state, event_due, exchange, interpolates, inputs_finite;
    size_t known, states;
    double numbers[];
} SavedState;

/* Reads resources and makes an instance in MODE_INSTANTIATED; NULL, with the reason logged, when it cannot.
   `token` is the model description's guid or instantiation token. */
Instance *instance_create(const char *name, const char *resources, const char *token, Logger logger, void *host);
/* The same from the bytes of a component.bin, whatever its token; for components inside of others. */
Instance *instance_create_inside(const char *name, const char *bytes, size_t size, Logger logger, void *host);
void instance_free(Instance *instance);

Status instance_fail(Instance *instance, Status status, const char *format, ...);

/* Tolerance of the experiment, NULL for none, and its times; an infinite stop time is none. */
Status instance_set_experiment(Instance *instance, const double *tolerance, double start_time, double stop_time);
Status instance_enter_initialization(Instance *instance);
Status instance_exit_initialization(Instance *instance);
Status instance_reset(Instance *instance);
Status instance_terminate(Instance *instance);

/* STATUS_OK where there are arrays for so many variables. */
Status instance_refuse_missing(Instance *instance, const void *references, const void *values, size_t count);
/* STATUS_OK where all variables are of a kind, which the host calls `type`, or may be read and written as such. */
Status instance_refuse_other(Instance *instance, VariableKind kind, const char *type, const uint32_t *references,
                             size_t count);
Status instance_set(Instance *instance, const uint32_t *references, size_t count, const double *values);
Status instance_get(Instance *instance, const uint32_t *references, size_t count, double *values);

/* STATUS_ERROR where a time is after the stop time. */
Status instance_check_stop(Instance *instance, double time);
/* One communication step; with state and time as before when it cannot be done: STATUS_ERROR where it was asked for
   wrongly, STATUS_DISCARD where a smaller one may do. */
Status instance_step(Instance *instance, double time, double h);
/* The same, but no further than to an event inside of it, where the component ends steps there: h then is how far it
   came, and event_due is set. */
Status instance_step_to_event(Instance *instance, double time, double *h);

/* Time until the next event from the present state and inputs: 0 when it is due, INFINITY when none is foreseen. */
double instance_next_event(Instance *instance);
Status instance_enter_event_mode(Instance *instance);
Status instance_enter_step_mode(Instance *instance);
/* What happens at the present instant: commands, and the event that was due; in event mode. */
Status instance_update_discrete_states(Instance *instance);
/* The same in step mode, for hosts without event mode. */
Status instance_let_happen(Instance *instance);

/* Derivative of outputs and observations, in model exchange of rates as well, along `seed` of inputs; STATUS_ERROR where
   it is not finite. After a step: of those at its end with respect to
   the inputs of that step, and by tunable parameters where it was made of steps inside. Otherwise, and of rates or by
   states, at the present instant, as the standard means it; during initialization by parameters too. */
Status instance_derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count,
                           const uint32_t *knowns, size_t known_count, const double *seed, double *result);

/* Derivatives of the wrenches of all ports over the step just made by the motions of the ports at its end, as `stiffness`
   of the kernel has them; STATUS_DISCARD where the component has none for this step. */
Status instance_port_stiffness(Instance *instance, size_t ports, double *matrix);

/* Save into *state, which is made where it is NULL and reused otherwise. */
Status instance_save(Instance *instance, SavedState **state);
Status instance_restore(Instance *instance, const SavedState *state);
Status instance_forget(SavedState **state);
Status instance_serialized_size(Instance *instance, const SavedState *state, size_t *size);
Status instance_serialize(Instance *instance, const SavedState *state, unsigned char *bytes, size_t size);
/* *made is NULL where the bytes are no state. */
Status instance_deserialize(Instance *instance, const unsigned char *bytes, size_t size, SavedState **made);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
