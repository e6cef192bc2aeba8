/* A scene as one component: its components and the master that couples them, whose steps follow from its tolerance.

   The master goes on until rows of results lie on both sides of a communication point; values there are interpolated.
   Where inputs and parameters change, it first goes back to the communication point. So results do not depend on the
   communication step size, and small ones cost nothing. */

#define _POSIX_C_SOURCE 200112L
#include "assembly_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "prediction.h"
#include "scheme.h"

#define SAME_EVENT 1e-9 /* s */
#define MOST_STEPS_INSIDE 1e6 /* of a communication step: from seconds to minutes */

/* The outputs, in the order of `Told` in orchestrator/run/as_one/component.py; then latch times, rates at latch-up,
   whether latched, then angles of all lines, and peaks. */
enum { STORED_ENERGY, DISSIPATED_ENERGY, NUMERICAL_ENERGY, SUPPLIED_ENERGY, ENERGY_RESIDUAL, STEPS, REJECTED_STEPS, TOLD };
enum { OF_LINE = 3 }; /* outputs of each */
enum { SWINGS = 2 * SWING_NUMBERS };
static const char unstable[] = "the accelerations of the base swing from step to step and grow, so the host is unstable. Make "
                               "smaller steps, or apply the growth of the interface impulses over the step as mean load, or "
                               "repeat steps with base_meets_rates = true";

/* Place the numbers of a run that a saved state contains from `first` on; returns how many they are. first: NULL to
   compute that alone. */
static size_t arrange_standing(Assembly *a, double *first) {
    Sequence *s = &a->sequence;
    size_t used = coupling_arrange(&s->coupling, first);
#define TAKE(pointer, count) (pointer = first ? (void *)(first + used) : NULL, used += (count))
    TAKE(a->scalars, OWN_SCALARS);
    TAKE(a->in_force, a->parameter_count);
    TAKE(s->latch_time, s->coupling.lines);
    TAKE(s->unlatch_time, s->coupling.lines);
    TAKE(s->latch_rate, s->coupling.lines);
    for (Event *e = s->event; e < s->event + s->events; e++) {
        if (e->crossing) e->pending = first ? s->coupling.pending + (e->crossing - s->coupling.crossing) : NULL;
        else TAKE(e->pending, 1);
    }
#undef TAKE
    return used;
}

/* Copy the numbers of a run that are in no array to (write) or from `scalars`. */
static void exchange_scalars(Assembly *a, int write) {
    Sequence *s = &a->sequence;
    double steps = (double)s->steps, rejected = (double)s->rejected;
    double *own[OWN_SCALARS] = {&a->last_row_time, &s->event_time, &s->is_crossed, &steps, &rejected};
    coupling_exchange_scalars(&s->coupling, write);
    for (size_t i = 0; i < OWN_SCALARS; i++) write ? (void)(a->scalars[i] = *own[i]) : (void)(*own[i] = a->scalars[i]);
    s->steps = (size_t)steps;
    s->rejected = (size_t)rejected;
}

/* The slot of a snapshot, 0 for the newest. */
static size_t slot_of(const Assembly *a, size_t number) { return (a->newest + SNAPSHOTS - number) % SNAPSHOTS; }

static double *snapshot_of(const Assembly *a, size_t number) {
    return a->snapshot + slot_of(a, number) * a->snapshot_size;
}

static double time_of(const Assembly *a, size_t number) { return snapshot_of(a, number)[1]; }

/* Keep the state of the run as a snapshot, in place of the oldest. */
static void keep_snapshot(Assembly *a) {
    a->newest = (a->newest + 1) % SNAPSHOTS;
    double *place = snapshot_of(a, 0);
    exchange_scalars(a, 1);
    *place++ = a->run_serial = ++a->last_run;
    *place++ = a->sequence.coupling.progress.time;
    memcpy(place, a->standing, a->standing_size * sizeof(double));
    place += a->standing_size;
    for (size_t i = 0; i < a->participants; i++) {
        const SavedState *saved = a->saved[i];
        memcpy(place, saved->numbers + saved->known, saved->states * sizeof(double));
        place += saved->states;
        memcpy(place, a->input[i], a->instance[i]->sizes.inputs * sizeof(double));
        place += a->instance[i]->sizes.inputs;
    }
    if (a->snapshots < SNAPSHOTS) a->snapshots++;
}

/* Hand the parameters in force to a participant. */
static void take_parameters(Assembly *a, size_t i) {
    Instance *instance = a->instance[i];
    const double *own = a->in_force + a->first_parameter[i];
    const size_t bytes = instance->sizes.parameters * sizeof(double);
    if (memcmp(instance->values, own, bytes) == 0) return;
    memcpy(instance->values, own, bytes);
    instance->prepared = instance->outputs_known = instance->observations_known = 0;
}

/* Restore the run from a snapshot and forget later ones; 0 if a participant fails. */
static int take_snapshot(Assembly *a, size_t number) {
    Coupling *c = &a->sequence.coupling;
    const double *place = snapshot_of(a, number) + 2;
    memcpy(a->standing, place, a->standing_size * sizeof(double));
    exchange_scalars(a, 0);
    place += a->standing_size;
    for (size_t i = 0; i < a->participants; i++) {
        Instance *instance = a->instance[i];
        take_parameters(a, i);
        memcpy(instance->x, place, instance->states * sizeof(double));
        place += instance->states;
        memcpy(a->input[i], place, instance->sizes.inputs * sizeof(double));
        memcpy(instance->values + instance->ends[0], place, instance->sizes.inputs * sizeof(double));
        place += instance->sizes.inputs;
        instance->time = c->progress.time;
        instance->mode = MODE_STEP;
        instance->has_state = 1;
        instance->stepped = instance->event_due = instance->outputs_known = instance->observations_known = 0;
    }
    a->newest = slot_of(a, number);
    a->snapshots -= number;
    while (a->rows && a->ring[(a->rows - 1) * a->row_size] > a->last_row_time) a->rows--;
    return network_save(&c->network) && coupling_stand(c);
}

/* The value whose largest one is a peak, of a weighted sum of consecutive rows of the ring. */
static double weighted_load(const Assembly *a, const Peak *peak, const double *rows, const double *weights, size_t count) {
    double square = 0.0, sum = 0.0;
    for (size_t k = 0; k < peak->count; k++) {
        double value = 0.0;
        for (size_t i = 0; i < count; i++) value += weights[i] * rows[i * a->row_size + 2 + peak->place[k]];
        square += value * value;
        sum += value;
    }
    return peak->is_sum ? fabs(sum) : sqrt(square);
}

/* The same in one row of the ring. */
static double load_of(const Assembly *a, const Peak *peak, size_t row) {
    static const double whole = 1.0;
    return weighted_load(a, peak, a->ring + row * a->row_size, &whole, 1);
}

/* By how much a cubic, s (slope + s (bend + s third)) from v[1] on, misses a fifth sample, `beside`, over the product
   of the distances of this sample to the other four. */
static double miss_of(const double *t, const double *v, const double *cubic, ptrdiff_t beside) {
    const double s = t[beside] - t[1];
    double distances = 1.0;
    for (ptrdiff_t k = -1; k <= 2; k++) distances *= t[beside] - t[k];
    return fabs((v[1] + s * (cubic[0] + s * (cubic[1] + s * cubic[2])) - v[beside]) / distances);
}

/* Crest of the cubic through four of the last rows, without the very last, if the third of the four is the highest;
   otherwise the value there. A crest counts if it rises by more than the possible error of the cubic, estimated by its
   misses at the rows on either side: rows do not resolve all ringing, and loads have kinks. results/signal.py does the
   same. */
static double crest(const double *times, const double *values, size_t count) {
    const double *t = times + count - 4, *v = values + count - 4;
    if (!(v[1] > v[0] && v[1] >= v[2])) return v[1];
    const double a = t[0] - t[1], b = t[2] - t[1], c = t[-1] - t[1];
    const double first = (v[1] - v[0]) / -a, last = (v[2] - v[1]) / b, before = (v[0] - v[-1]) / (a - c);
    const double second = (last - first) / (b - a), third = (second - (first - before) / -c) / (b - c);
    const double bend = second - third * (a + b), slope = first - second * a + third * a * b;
    const double cubic[3] = {slope, bend, third};
    const double root = bend * bend - 3.0 * third * slope;
    const double s = root < 0.0 ? 0.0 : -slope / (bend - sqrt(root));
    if (!(s >= a && s <= b)) return v[1];
    const double rise = s * (slope + s * (bend + s * third));
    double miss = miss_of(t, v, cubic, 3);
    if (count == RING) miss = fmax(miss, miss_of(t, v, cubic, -2));
    return rise > CREST_SURE * miss * fabs(s * (s - a) * (s - b) * (s - c)) ? v[1] + rise : v[1];
}

/* Update peaks by a row of the ring, and by crests between rows where loads are smooth. */
static void note_peaks(Assembly *a, size_t row) {
    const double *ring = a->ring, segment = ring[row * a->row_size + 1];
    size_t count = 1;
    while (count <= row && ring[(row - count) * a->row_size + 1] == segment) count++;
    for (size_t i = 0; i < a->peak_count; i++) {
        double times[RING], values[RING];
        for (size_t k = 0; k < count; k++) {
            times[k] = ring[(row + 1 + k - count) * a->row_size];
            values[k] = load_of(a, a->peak + i, row + 1 + k - count);
        }
        a->peaks[i] = fmax(a->peaks[i], values[count - 1]);
        if (count >= RING - 1) a->peaks[i] = fmax(a->peaks[i], crest(times, values, count));
    }
    a->peak_time = ring[row * a->row_size];
}

/* Add a row to the ring; peaks are those up to the communication point. */
static void take_row(void *taker, double time, double segment, const double *values) {
    Assembly *a = taker;
    if (a->rows == RING) {
        memmove(a->ring, a->ring + a->row_size, (RING - 1) * a->row_size * sizeof(double));
        a->rows--;
    }
    double *row = a->ring + a->rows++ * a->row_size;
    row[0] = a->last_row_time = time;
    row[1] = segment;
    memcpy(row + 2, values, (a->row_size - 2) * sizeof(double));
    if (time <= a->target) note_peaks(a, a->rows - 1);
}

static int set_parameter(void *taker, size_t participant, size_t place, double value) {
    Assembly *a = taker;
    Instance *instance = a->instance[participant];
    a->in_force[a->first_parameter[participant] + place] = value;
    take_parameters(a, participant);
    if (participant < a->sequence.coupling.network.bodies) forget_all(&a->sequence.coupling.solver);
    return instance_save(instance, a->saved + participant) <= STATUS_WARNING;
}

/* State why the run cannot go on; 0. */
static int refuse_run(Assembly *a, Reason *why) {
    const Coupling *c = &a->sequence.coupling;
    const Progress *p = &c->progress;
    a->stands = 0;
    if (a->is_unstable) return refuse(why, "%s", unstable); /* absurd motions end in any part */
    if (p->failure == OF_STEP)
        return refuse(why, "the step of %.3g s from t = %.6f s does not converge: the wrench of %s still changes by %.3g "
                      "times its tolerance; loosen the tolerance or check that connection's stiffness", p->h, p->time,
                      a->link_name[p->worst_row / c->network.width.wrench], p->correction);
    return refuse(why, "%s", a->said[0] ? a->said : "the run cannot go on");
}

/* Make one turn, and keep a snapshot where the run has gone on. */
static int go_further(Assembly *a) {
    Sequence *s = &a->sequence;
    const size_t steps = s->steps, happened = s->happened, rejected = s->rejected;
    const double event_time = s->event_time;
    tell_size(&a->noted, &s->coupling);
    if (!take_turn(s)) return 0;
    const int meets = s->event_time != event_time;
    if (s->steps != steps && !note_step(&a->noted, &s->coupling, meets, a->said, sizeof a->said)) return 0;
    if (a->noted.mode == REPEATS_STEPS && s->rejected != rejected) return 0;
    if (s->steps != steps || s->happened != happened) keep_snapshot(a);
    return 1;
}

/* Whether the run has gone through an event after the communication point, and up to a time. */
static int met_event(const Assembly *a, double time) {
    const double at = a->sequence.event_time;
    return at > a->time + TIME_ROUNDING && at <= time + TIME_ROUNDING;
}

/* Let all events act that are due at the same instant as another. */
static int end_event(Assembly *a) {
    int fine = 1;
    while (fine && due_event(&a->sequence)) fine = go_further(a);
    return fine;
}

/* Step until a time exactly, or through an event before it (to_event). */
static int run_to(Assembly *a, double until, int to_event) {
    Coupling *c = &a->sequence.coupling;
    int fine = 1;
    c->request.until = until;
    while (fine && c->progress.time < until - TIME_ROUNDING && !(to_event && met_event(a, until))) fine = go_further(a);
    c->request.until = INFINITY;
    return fine;
}

/* Step until results stand on both sides of a time, or through an event before it (to_event). */
static int run_past(Assembly *a, double time, int to_event) {
    int fine = 1;
    if (a->noted.mode == REPEATS_STEPS)
        while (fine && has_left(&a->noted)) fine = go_further(a);
    while (fine && a->last_row_time < time && !(to_event && met_event(a, time))) fine = go_further(a);
    return fine;
}

/* Initialise participants, bodies before what is connected to them. */
static int initialize_participants(Assembly *a) {
    Network *n = &a->sequence.coupling.network;
    for (size_t i = 0; i < n->participants; i++) {
        Instance *instance = a->instance[i];
        const size_t inputs = instance->sizes.inputs;
        instance_reset(instance);
        memcpy(instance->values, a->in_force + a->first_parameter[i], instance->sizes.parameters * sizeof(double));
        memcpy(a->input[i], instance->start + instance->ends[0], inputs * sizeof(double));
        if (instance_enter_initialization(instance) != STATUS_OK) return 0;
    }
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        if (i == n->bodies) network_give_motions(n);
        if (instance_set(p->component, p->input_references, a->instance[i]->sizes.inputs, a->input[i]) > STATUS_WARNING ||
            (i < n->bodies && p->get_real(p->component, p->output_references, p->outputs, p->output) > FMI_WARNING))
            return 0;
    }
    const double *states = a->rest_states, *inputs = a->rest_inputs;
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        Instance *instance = a->instance[i];
        if (instance_exit_initialization(instance) != STATUS_OK) return 0;
        if (states) {
            memcpy(instance->x, states, instance->states * sizeof(double));
            memcpy(a->input[i], inputs, instance->sizes.inputs * sizeof(double));
            states += instance->states;
            inputs += instance->sizes.inputs;
            if (instance_set(instance, p->input_references, instance->sizes.inputs, a->input[i]) > STATUS_WARNING) return 0;
            instance->outputs_known = 0;
        }
        if (p->get_real(p->component, p->output_references, p->outputs, p->output) > FMI_WARNING)
            return 0;
    }
    return 1;
}

static size_t state_size(const Assembly *a) {
    return OUTER + a->parameter_count + a->inputs_count + SWINGS + a->peak_count + RING * a->row_size + SNAPSHOTS * a->snapshot_size;
}

/* Arrays of a component's state, in their order after the numbers that come first and before the snapshots. */
typedef struct {
    double *own;
    size_t count;
} Section;

enum { SECTIONS = 5 };

static void sections_of(Assembly *a, Section *sections) {
    const Section all[SECTIONS] = {{a->applied, a->parameter_count},
                                   {a->inputs, a->inputs_count},
                                   {(double *)a->swing, SWINGS},
                                   {a->peaks, a->peak_count},
                                   {a->ring, RING * a->row_size}};
    memcpy(sections, all, sizeof all);
}

/* Write a state. What the run has reached is there already where only time has gone on: a component has room for two
   states and fills them in turn. */
static void store(Assembly *a, double *x) {
    Section section[SECTIONS];
    const int has_run = x[AT_RUN] == a->run_serial;
    sections_of(a, section);
    a->serial += 1.0;
    const double first[OUTER] = {a->time,
                                 a->serial,
                                 a->run_serial,
                                 (double)a->snapshots,
                                 (double)a->newest,
                                 (double)a->rows,
                                 a->peak_time,
                                 a->driven_step,
                                 a->longest_step,
                                 (double)a->sequence.steps,
                                 (double)a->sequence.rejected,
                                 (double)a->at_event};
    memcpy(x, first, sizeof first);
    x += OUTER;
    for (size_t i = 0; i < SECTIONS; x += section[i++].count)
        if (!has_run || section[i].own == a->peaks) memcpy(x, section[i].own, section[i].count * sizeof(double));
    for (size_t i = 0; i < SNAPSHOTS; i++, x += a->snapshot_size) {
        const double *own = a->snapshot + i * a->snapshot_size;
        if (*x != *own) memcpy(x, own, a->snapshot_size * sizeof(double));
    }
    a->stands = 1;
}

/* Restore a state, unless it is the present one. */
static int stand(Assembly *a, const double *x) {
    Section section[SECTIONS];
    if (a->stands && x[AT_SERIAL] == a->serial) return 1;
    sections_of(a, section);
    const double *place = x + OUTER;
    for (size_t i = 0; i < SECTIONS; place += section[i++].count)
        memcpy(section[i].own, place, section[i].count * sizeof(double));
    memcpy(a->snapshot, place, SNAPSHOTS * a->snapshot_size * sizeof(double));
    a->time = x[AT_TIME];
    a->driven_step = x[AT_DRIVEN];
    a->longest_step = x[AT_LONGEST];
    a->at_event = (int)x[AT_EVENT];
    a->newest = (size_t)x[AT_NEWEST];
    a->run_serial = a->last_run = fmax(a->last_run, x[AT_RUN]) + 1.0; /* a number that no other state has */
    a->snapshots = (size_t)x[AT_SNAPSHOTS];
    a->rows = (size_t)x[AT_ROWS];
    a->peak_time = x[AT_PEAK_TIME];
    return take_snapshot(a, 0);
}

static void destroy(void *self) {
    Assembly *a = self;
    for (size_t i = 0; i < a->participants && a->instance && a->saved; i++) {
        instance_forget(a->saved + i);
        instance_free(a->instance[i]);
    }
}

/* Create all of an assembly; 0 and a sentence where its data are unusable. */
static int furnish(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    Sequence *s = &a->sequence;
    s->taker = a;
    s->row = take_row;
    s->set_parameter = set_parameter;
    if (!assembly_furnish(a, data, sizes, memory, why)) return 0;
    a->parameter_count = a->first_parameter[a->participants];
    a->input_count = a->first_input[a->participants];
    const size_t own = a->driven.is_there ? 2 : 1;
    if (sizes->parameters != a->parameter_count + own || sizes->outputs != TOLD + OF_LINE * s->coupling.lines + a->angles + a->peak_count)
        return refuse(why, "the assembly declares %lu parameters, its components and its master have %lu",
                      (unsigned long)sizes->parameters, (unsigned long)(a->parameter_count + own));
    a->standing_size = arrange_standing(a, NULL);
    a->snapshot_size = 2 + a->standing_size + a->states + a->input_count;
    a->standing = allocate(memory, (a->standing_size + 1) * sizeof(double));
    a->wanted = allocate(memory, (a->parameter_count + 1) * sizeof(double));
    a->applied = allocate(memory, (a->parameter_count + 1) * sizeof(double));
    a->noted.wanted = allocate(memory, (a->parameter_count + 1) * sizeof(double));
    a->inputs = allocate(memory, (a->inputs_count + 1) * sizeof(double));
    a->peaks = allocate(memory, (a->peak_count + 1) * sizeof(double));
    a->ring = allocate(memory, RING * a->row_size * sizeof(double));
    a->noted.step = allocate(memory, MOST_NOTED * sizeof *a->noted.step);
    a->snapshot = allocate(memory, (SNAPSHOTS * a->snapshot_size + 1) * sizeof(double));
    if (!a->standing || !a->wanted || !a->applied || !a->inputs || !a->peaks || !a->ring || !a->snapshot ||
        !a->noted.step || !a->noted.wanted)
        return refuse(why, "no memory for the state of an assembly");
    arrange_standing(a, a->standing);
    return 1;
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Assembly *a = allocate(memory, sizeof *a);
    if (a && furnish(a, data, sizes, memory, why)) {
        *states = state_size(a);
        return a;
    }
    if (a) destroy(a);
    else refuse(why, "no memory for an assembly");
    return NULL;
}

/* Let every component check its own parameters; components receive them when the run reaches them. How a driven base
   follows its rates, and the tolerance, come last. */
static int prepare(void *self, const double *p, Reason *why) {
    Assembly *a = self;
    for (size_t i = 0; i < a->participants; i++) {
        Instance *instance = a->instance[i];
        Reason own = {""};
        instance->prepared = 0;
        if (!instance->kernel->prepare(instance->self, p + a->first_parameter[i], &own))
            return refuse(why, "%.100s: %.380s", instance->name, own.text);
    }
    memcpy(a->wanted, p, a->parameter_count * sizeof(double));
    p += a->parameter_count;
    a->meets_rates = a->driven.is_there && *p++ > 0.5;
    coupling_take_tolerance(&a->sequence.coupling, *p);
    return 1;
}

static int initial(void *self, const double *u, double *x, Reason *why) {
    Assembly *a = self;
    Sequence *s = &a->sequence;
    Network *n = &s->coupling.network;
    int fine;
    for (size_t i = 0; a->driven.is_there && i < BASE_RATES; i++)
        if (u[a->driven.first + i] != 0.0)
            return refuse(why, "the base has a rate of %g at the start; the scene starts at rest, so begin with rates of "
                          "zero and lead them to what they are to be", u[a->driven.first + i]);
    a->said[0] = '\0';
    a->rows = a->snapshots = 0;
    a->time = a->target = 0.0;
    a->peak_time = -1.0;
    memset(a->peaks, 0, a->peak_count * sizeof(double));
    memset(a->ring, 0, RING * a->row_size * sizeof(double));
    memset(a->snapshot, 0, SNAPSHOTS * a->snapshot_size * sizeof(double));
    memset(a->standing, 0, a->standing_size * sizeof(double));
    memcpy(a->applied, a->wanted, a->parameter_count * sizeof(double));
    memcpy(a->in_force, a->wanted, a->parameter_count * sizeof(double));
    memcpy(a->inputs, u, a->inputs_count * sizeof(double));
    memset(a->inputs, 0, a->commands * sizeof(double)); /* commands at the start act at the first communication point */
    a->driven_step = a->longest_step = 0.0;
    memset(a->swing, 0, sizeof a->swing);
    a->is_unstable = a->is_told = 0;
    a->at_event = NO_EVENT;
    a->run_serial = ++a->last_run;
    if (!initialize_participants(a)) return refuse_run(a, why);
    if (a->rest_wrenches) memcpy(n->accepted, a->rest_wrenches, n->size * sizeof(double));
    const Event *met = begin_run(s, &fine);
    if (met) return refuse(why, "the condition of event %s holds from the start", a->event_name[met - s->event]);
    if (!fine) return refuse_run(a, why);
    keep_snapshot(a);
    store(a, x);
    return 1;
}

/* Return to the communication point; at an event the run is there. */
static int go_back(Assembly *a) {
    size_t number = 0;
    if (a->at_event) return 1;
    while (number + 1 < a->snapshots && time_of(a, number) > a->time + TIME_ROUNDING) number++;
    return (number == 0 || take_snapshot(a, number)) && run_to(a, a->time, 0);
}

/* Value of a parameter from the communication point on: that of the host where it has changed since it last acted,
   otherwise the one in force, which an event may have set. In a repeated step it differs from that of the noted step by
   as much as the host's does. */
static double acting(const Assembly *a, size_t at) {
    const double before = a->noted.mode == REPEATS_STEPS ? a->noted.wanted[at] : a->wanted[at];
    return (before != a->applied[at] ? before : a->in_force[at]) + (a->wanted[at] - before);
}

/* Return to the communication point and let changes of the host act there. */
static int change(Assembly *a, const double *u) {
    Sequence *s = &a->sequence;
    Network *n = &s->coupling.network;
    size_t latches = 0;
    if (!go_back(a) || !network_observe(n)) return 0;
    const double before = balance_of(n->energies);
    for (size_t i = 0; i < a->participants; i++)
        for (size_t k = 0; k < a->instance[i]->sizes.parameters; k++) {
            const size_t at = a->first_parameter[i] + k;
            const double value = acting(a, at);
            if (value != a->in_force[at] && !set_parameter(a, i, k, value)) return 0;
        }
    memcpy(a->applied, a->wanted, a->parameter_count * sizeof(double));
    if (!coupling_supply(&s->coupling, before)) return 0;
    for (size_t i = 0; i < a->commands; i++) {
        const Command *c = a->command + i;
        const int is_set = u[i] > 0.5, was_set = a->inputs[i] > 0.5;
        if (is_set == was_set || !(is_set || c->kind == UNLATCHES)) continue;
        if (c->kind == RELEASES) release_one(s, &c->release);
        else if (c->kind == UNLATCHES) unlatch_line(s, c->line, is_set);
        else a->latching[latches++] = c->line;
    }
    memcpy(a->inputs, u, a->commands * sizeof(double));
    if (!go_on(s, a->latching, latches)) return 0;
    keep_snapshot(a);
    return 1;
}

/* Update peaks up to a communication point that rows have passed before. */
static void catch_up_peaks(Assembly *a, double time) {
    a->target = time;
    for (size_t i = 0; i < a->rows; i++) {
        const double *row = a->ring + i * a->row_size;
        if (row[0] > a->peak_time && row[0] <= time) note_peaks(a, i);
    }
}

static int is_driven(const Assembly *a, const double *u) {
    if (!a->driven.is_there || a->driven_step > 0.0 || a->noted.mode) return a->driven.is_there;
    for (size_t i = 0; i < DRIVES; i++)
        if (u[a->driven.first + i] != 0.0) return 1;
    return 0;
}

/* Set how fast a driven base changes its accelerations over a step h (s): to those at its end that the host's present
   and earlier ones extrapolate to, plus a part of the missing rates. This part decays by half in each step as long as
   the longest so far, and no faster over shorter ones, as a large acceleration in a short step would be far too large
   in a long one after it. Without accelerations of the host they follow from its rates. */
static void drive(Assembly *a, const double *u, double h) {
    const DrivenFrame *d = &a->driven;
    const SavedState *saved = a->saved[d->participant];
    const double *state = saved->numbers + saved->known, *rates = u + d->first, *given = rates + BASE_RATES;
    const double *rates_before = a->inputs + d->first, *given_before = rates_before + BASE_RATES;
    double *change = a->input[d->participant] + d->change;
    const double last = a->driven_step > 0.0 ? a->driven_step : h;
    int gives = 0;
    a->longest_step = fmax(a->longest_step, h);
    for (size_t k = 0; k < BASE_RATES; k++) gives |= given[k] != 0.0 || given_before[k] != 0.0;
    if (a->noted.mode == REPEATS_STEPS && a->noted.gives < 0) a->noted.gives = gives;
    if (a->noted.mode == REPEATS_STEPS) gives = a->noted.gives;
    for (size_t k = 0; k < BASE_RATES; k++) {
        const double rate = state[d->rate[k / 3] + k % 3], acceleration = state[d->acceleration[k / 3] + k % 3];
        const double expected = !gives                 ? (rates[k] - rates_before[k]) / last
                                : a->driven_step > 0.0 ? given[k] + (given[k] - given_before[k]) * h / last
                                                       : given[k];
        change[k] = (expected + 0.5 * (rates[k] - rate) / a->longest_step - acceleration) / h;
    }
}

/* Set the constant accelerations of a driven base that lead to the given rates at the end of a step h (s). */
static void drive_to_rates(Assembly *a, const double *u, double h) {
    const DrivenFrame *d = &a->driven;
    SavedState *saved = a->saved[d->participant];
    double *state = saved->numbers + saved->known, *x = a->instance[d->participant]->x;
    for (size_t k = 0; k < BASE_RATES; k++) {
        const size_t at = d->acceleration[k / 3] + k % 3;
        x[at] = state[at] = (u[d->first + k] - state[d->rate[k / 3] + k % 3]) / h;
        a->input[d->participant][d->change + k] = 0.0;
    }
}

/* Follow the accelerations to which the rates of the host belong. */
static void follow_host(Assembly *a, const double *u) {
    const double *rates = u + a->driven.first, *before = a->inputs + a->driven.first;
    double acceleration[BASE_RATES];
    if (!(a->driven_step > 0.0)) return;
    for (size_t k = 0; k < BASE_RATES; k++) acceleration[k] = (rates[k] - before[k]) / a->driven_step;
    for (size_t k = 0; k < 2; k++) a->is_unstable |= swing_grows(a->swing + k, acceleration + SWING_AXES * k);
}

/* Step exactly to the next communication point, or through an event before it, with the base driven to it; rows end
   there. */
static int run_driven(Assembly *a, const double *u, double h, int to_event) {
    Coupling *c = &a->sequence.coupling;
    if (!go_back(a)) return 0;
    follow_host(a, u);
    if (a->meets_rates) {
        drive_to_rates(a, u, h);
        history_clear(&c->network); /* loads jump with the accelerations */
    } else {
        drive(a, u, h);
    }
    coupling_begin_segment(c);
    if (!run_to(a, a->time + h, to_event)) return 0;
    rows_release(&c->rows);
    hand_on_rows(&a->sequence);
    memcpy(a->inputs, u, a->inputs_count * sizeof(double));
    keep_snapshot(a);
    a->driven_step = fmin(h, c->progress.time - a->time);
    return 1;
}

/* Whether the host has changed what acts at the communication point. */
static int has_changed(const Assembly *a, const double *u) {
    for (size_t i = 0; i < a->commands; i++)
        if ((u[i] > 0.5) != (a->inputs[i] > 0.5)) return 1;
    return a->noted.acts || memcmp(a->wanted, a->applied, a->parameter_count * sizeof(double)) != 0;
}

/* Whether a communication step (s) from a state ends soon enough: nothing can interrupt it, and each step inside has to
   advance the time. */
static int is_made_soon(const Assembly *a, const double *x, double h, Reason *why) {
    const StepSizes *sizes = &a->sequence.coupling.sizes;
    const double end = x[AT_TIME] + h;
    if (!(h <= MOST_STEPS_INSIDE * sizes->largest))
        return refuse(why, "a communication step of %g s needs %.2g steps inside, and at most %g are made; make more "
                      "communication steps, of at most %.3g s", h, h / sizes->largest, MOST_STEPS_INSIDE,
                      MOST_STEPS_INSIDE * sizes->largest);
    if (end + sizes->smallest == end)
        return refuse(why, "steps inside of %g s are lost in the rounding of %g s since the start; begin anew",
                      sizes->smallest, end);
    return 1;
}

/* Restore a state, and let changes of the host act there. */
static int begin(Assembly *a, const double *x, const double *u) {
    a->said[0] = '\0';
    a->sequence.coupling.progress.failure = NO_FAILURE;
    if (!stand(a, x)) return 0;
    a->stands = a->is_unstable = 0;
    return !has_changed(a, u) || change(a, u);
}

/* Run from the communication point over a step, or through the first event in it (to_event). */
static int run_on(Assembly *a, const double *u, double h, int to_event) {
    catch_up_peaks(a, a->time + h);
    const int fine = is_driven(a, u) ? run_driven(a, u, h, to_event) : run_past(a, a->time + h, to_event);
    return fine && (!(to_event && met_event(a, a->time + h)) || end_event(a));
}

/* Warn a host that is unstable, once a run. */
static void warn_host(Assembly *a, Reason *why) {
    if (a->is_unstable && !a->is_told) refuse(why, "%s", unstable);
    a->is_told |= a->is_unstable;
}

static int step(void *self, const double *x, const double *u, double h, double *x_next, Reason *why) {
    Assembly *a = self;
    if (!is_made_soon(a, x, h, why)) return 0;
    if (!begin(a, x, u) || !run_on(a, u, h, 0)) return refuse_run(a, why);
    a->at_event = NO_EVENT;
    a->time += h;
    store(a, x_next);
    warn_host(a, why);
    return 1;
}

static int step_to_event(void *self, const double *x, const double *u, double *h, int *due, double *x_next, Reason *why) {
    Assembly *a = self;
    if (!is_made_soon(a, x, *h, why)) return 0;
    if (!begin(a, x, u) || !run_on(a, u, *h, 1)) return refuse_run(a, why);
    *due = met_event(a, a->time + *h);
    const double end = *due ? a->sequence.event_time : a->time + *h;
    *h = *due ? fmin(*h, end - a->time) : *h;
    a->at_event = *due ? BEFORE_EVENT : NO_EVENT;
    a->time = end;
    store(a, x_next);
    warn_host(a, why);
    return 1;
}

/* Make a step that is noted or repeated, which no event may end. */
static int make_alike(Assembly *a, const double *x, const double *u, double h) {
    a->stands = 0;
    if (!begin(a, x, u) || !run_on(a, u, h, 0)) return 0;
    if (!a->sequence.is_crossed || fabs(a->sequence.event_time - a->time - h) > SAME_EVENT) return 1;
    snprintf(a->said, sizeof a->said, "the step ends where something latches or a condition is met, sooner or later with "
             "values a little different; outputs have no derivatives there");
    return 0;
}

static int step_alike(void *self, const double *x, const double *u, double h, int again, int acts, double *x_next,
                      Reason *why) {
    static const Exactness exact = {ALIKE_ITERATED, ALIKE_STALLED, 1};
    Assembly *a = self;
    Coupling *c = &a->sequence.coupling;
    NotedSteps *noted = &a->noted;
    Exactness usual = {0.0, 0.0, 0};
    noted->mode = again ? REPEATS_STEPS : NOTES_STEPS;
    noted->acts = acts;
    noted->at = 0;
    if (!again) {
        noted->count = 0, noted->gives = -1;
        memcpy(noted->wanted, a->wanted, a->parameter_count * sizeof(double));
    }
    if (again) usual = set_exactness(c, exact);
    const int fine = make_alike(a, x, u, h);
    const int strays = again && noted->at != noted->count;
    if (again) set_exactness(c, usual);
    noted->mode = noted->acts = 0;
    c->request.plan = NULL;
    if (fine && !strays) {
        a->at_event = NO_EVENT;
        a->time += h;
        store(a, x_next);
    }
    a->stands = 0;
    if (fine && !strays) return 1;
    if (!a->said[0])
        snprintf(a->said, sizeof a->said, "with values a little different another event comes first or a step is made "
                 "otherwise; outputs have no derivatives there");
    return refuse_run(a, why);
}

/* Values at an event are from now on those after it, and changes of the host act. The next step reports failures. */
static void event(void *self, const double *x, const double *u, int due, double *x_next) {
    Assembly *a = self;
    const int acts = stand(a, x) && (due || has_changed(a, u));
    if (acts && begin(a, x, u)) {
        a->at_event = AFTER_EVENT;
        store(a, x_next);
    } else {
        memcpy(x_next, x, state_size(a) * sizeof(double));
    }
}

/* Where the sections of a state begin. */
static const double *ring_of(const Assembly *a, const double *x) {
    return x + OUTER + a->parameter_count + a->inputs_count + SWINGS + a->peak_count;
}

static const double *newest_of(const Assembly *a, const double *x) {
    return ring_of(a, x) + RING * a->row_size + (size_t)x[AT_NEWEST] * a->snapshot_size;
}

/* Weights of up to four rows at the time of a state: a polynomial through rows of one segment; first: the first of
   them. */
static size_t weigh_rows(const Assembly *a, const double *x, double *weights, const double **first) {
    const double *ring = ring_of(a, x), time = x[AT_TIME];
    const size_t rows = (size_t)x[AT_ROWS];
    size_t last = 0, count = 1;
    if (x[AT_EVENT] == AFTER_EVENT) {
        *first = ring + (rows - 1) * a->row_size;
        weights[0] = 1.0;
        return 1;
    }
    while (last + 1 < rows && ring[last * a->row_size] < time) last++;
    const double *row = ring + last * a->row_size;
    if (last > 0) count++;
    while (count > 1 && count < FITTED && count <= last && row[1] == ring[(last - count + 1) * a->row_size + 1] &&
           row[1] == ring[(last - count) * a->row_size + 1])
        count++;
    *first = ring + (last + 1 - count) * a->row_size;
    for (size_t i = 0; i < count; i++) {
        weights[i] = 1.0;
        for (size_t j = 0; j < count; j++) {
            const double of_i = (*first)[i * a->row_size], of_j = (*first)[j * a->row_size];
            if (j != i) weights[i] *= (time - of_j) / (of_i - of_j);
        }
    }
    return count;
}

/* The last of some rows that is not after the time of a state, or the first. */
static const double *row_before(const Assembly *a, const double *x, const double *first, size_t count) {
    size_t last = count - 1;
    while (last > 0 && first[last * a->row_size] > x[AT_TIME]) last--;
    return first + last * a->row_size;
}

static void observe(void *self, const double *x, const double *u, double *z) {
    const Assembly *a = self;
    const double *first;
    double weights[FITTED];
    const size_t count = weigh_rows(a, x, weights, &first), columns = a->sequence.coupling.rows.columns;
    (void)u;
    memset(z, 0, columns * sizeof(double));
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < columns; k++) z[k] += weights[i] * first[i * a->row_size + 2 + k];
    const double *before = row_before(a, x, first, count);
    for (size_t i = 0; i < a->flags; i++) z[a->flag[i]] = before[2 + a->flag[i]];
    if (a->appendage.frame) appendage_observe(&a->appendage, z, z + columns);
}

/* Whether what happens to a line at a time (s), negative for never, has done so at the communication point. */
static int has_happened(const double *x, double time) {
    if (x[AT_EVENT] == AFTER_EVENT) return time >= 0.0;
    return time >= 0.0 && (time < x[AT_TIME] || (time == x[AT_TIME] && x[AT_EVENT] == NO_EVENT));
}

static void outputs(void *self, const double *x, const double *u, double *y) {
    const Assembly *a = self;
    const Sequence *s = &a->sequence;
    const double *first;
    double weights[FITTED];
    const size_t count = weigh_rows(a, x, weights, &first), channels = 2 + a->sequence.coupling.rows.columns + 2;
    const double *peaks = ring_of(a, x) - a->peak_count, *standing = newest_of(a, x) + 2;
    (void)u;
    memset(y, 0, TOLD * sizeof(double));
    for (size_t i = 0; i < count; i++)
        for (size_t k = STORED_ENERGY; k <= ENERGY_RESIDUAL; k++)
            y[k] += weights[i] * first[i * a->row_size + channels + k];
    y[STEPS] = x[AT_STEPS];
    y[REJECTED_STEPS] = x[AT_REJECTED];
    y += TOLD;
    for (size_t k = 0; k < s->coupling.lines; k++) {
        const double latch_time = standing[s->latch_time + k - a->standing];
        const double unlatch_time = standing[s->unlatch_time + k - a->standing];
        const int has_latched = has_happened(x, latch_time);
        *y++ = has_latched ? latch_time : -1.0;
        *y++ = has_latched ? standing[s->latch_rate + k - a->standing] : 0.0;
        *y++ = has_latched && !(unlatch_time >= latch_time && has_happened(x, unlatch_time));
    }
    for (size_t k = 0; k < a->angles; k++, y++) {
        *y = 0.0;
        for (size_t i = 0; i < count; i++) *y += weights[i] * first[i * a->row_size + 2 + a->angle[k]];
    }
    /* the value at the communication point itself lies between two rows */
    for (size_t i = 0; i < a->peak_count; i++)
        y[i] = fmax(peaks[i], weighted_load(a, a->peak + i, first, weights, count));
}

/* Let what follows depend on the state alone, so that runs that saved it and runs that restore it have the same
   results. */
static void settle(void *self) {
    Assembly *a = self;
    a->stands = 0;
}

const Kernel assembly_kernel = {.kind = "assembly",
                                .create = create,
                                .prepare = prepare,
                                .initial = initial,
                                .step = step,
                                .step_to_event = step_to_event,
                                .step_alike = step_alike,
                                .event = event,
                                .outputs = outputs,
                                .observe = observe,
                                .settle = settle,
                                .destroy = destroy,
                                .checks_itself = 1,
                                .steps_inside = 1};
