/* An assembly of components with its master as one component, from its data. */

#include "assembly_model.h"

#include <stdio.h>
#include <string.h>

/* Keep the sentence of the participant that failed last. */
static void note_sentence(void *host, Status status, const char *sentence) {
    Assembly *a = host;
    if (status > STATUS_WARNING) snprintf(a->said, sizeof a->said, "%s", sentence);
}

static int set_real_of(void *c, const unsigned *references, size_t count, const double *values) {
    return instance_set(c, references, count, values);
}
static int get_real_of(void *c, const unsigned *references, size_t count, double *values) {
    return instance_get(c, references, count, values);
}
static int do_step_of(void *c, double time, double h, int keep) {
    (void)keep;
    return instance_step(c, time, h);
}
static int get_state_of(void *c, void **state) { return instance_save(c, (SavedState **)state); }
static int set_state_of(void *c, void *state) { return instance_restore(c, state); }
static int free_state_of(void *c, void **state) {
    (void)c;
    return instance_forget((SavedState **)state);
}
static int derivative_of(void *c, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns, size_t count,
                         const double *seed, double *result) {
    return instance_derivative(c, unknowns, unknown_count, knowns, count, seed, result);
}
static int port_stiffness_of(void *c, size_t ports, double *matrix) {
    return instance_port_stiffness(c, ports, matrix);
}

static const unsigned *references_from(size_t first, size_t count, Memory *memory) {
    unsigned *found = allocate(memory, (count + 1) * sizeof(unsigned));
    for (size_t i = 0; found && i < count; i++) found[i] = (unsigned)(first + i);
    return found;
}

/* Create one participant: its instance, and its functions. */
static int create_instance(Assembly *a, const Data *data, size_t i, Participant *p, Memory *memory, Reason *why) {
    char entry[40];
    size_t size = 0;
    snprintf(entry, sizeof entry, "part:%lu", (unsigned long)i);
    const char *bytes = data_bytes(data, entry, &size);
    snprintf(entry, sizeof entry, "name:%lu", (unsigned long)i);
    const char *name = data_text(data, entry);
    if (!bytes || !name) return refuse(why, "the assembly's participant %lu is missing", (unsigned long)i + 1);
    Instance *instance = a->instance[i] = instance_create_inside(name, bytes, size, note_sentence, a);
    if (!instance) return refuse(why, "%s", a->said);
    const Sizes *sizes = &instance->sizes;
    *p = (Participant){.component = instance,
                       .set_real = set_real_of,
                       .get_real = get_real_of,
                       .do_step = do_step_of,
                       .get_state = get_state_of,
                       .set_state = set_state_of,
                       .free_state = free_state_of,
                       .derivative = derivative_of,
                       .port_stiffness = port_stiffness_of,
                       .input_references = references_from(instance->ends[0], sizes->inputs, memory),
                       .output_references = references_from(instance->ends[1], sizes->outputs, memory),
                       .observation_references = references_from(instance->ends[2], sizes->observations, memory),
                       .inputs = sizes->inputs,
                       .outputs = sizes->outputs,
                       .observations = sizes->observations,
                       .overwrites_state = 1,
                       .saved = (void **)(a->saved + i)};
    a->input[i] = p->input = allocate(memory, (sizes->inputs + 1) * sizeof(double));
    p->output = allocate(memory, (sizes->outputs + 1) * sizeof(double));
    if (!p->input_references || !p->output_references || !p->observation_references || !p->input || !p->output)
        return refuse(why, "no memory for %s", name);
    memcpy(p->input, instance->start + instance->ends[0], sizes->inputs * sizeof(double));
    return 1;
}

/* Create all participants and their coupling. */
static int create_participants(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    const double *sizes = data_array(data, "network", 4, why);
    if (!sizes || !(sizes[0] >= 0.0 && sizes[0] < 1e6)) return refuse(why, "the tables of the network are damaged");
    const size_t count = (size_t)sizes[0];
    Participant *participants = allocate(memory, (count + 1) * sizeof *participants);
    a->instance = allocate(memory, (count + 1) * sizeof *a->instance);
    a->saved = allocate(memory, (count + 1) * sizeof *a->saved);
    a->input = allocate(memory, (count + 1) * sizeof *a->input);
    a->first_parameter = allocate(memory, (count + 1) * sizeof(size_t));
    a->first_input = allocate(memory, (count + 1) * sizeof(size_t));
    if (!participants || !a->instance || !a->saved || !a->input || !a->first_parameter || !a->first_input)
        return refuse(why, "no memory for %lu participants", (unsigned long)count);
    a->participants = count;
    for (size_t i = 0; i < count; i++) {
        if (!create_instance(a, data, i, participants + i, memory, why)) return 0;
        const Instance *instance = a->instance[i];
        a->first_parameter[i + 1] = a->first_parameter[i] + instance->sizes.parameters;
        a->first_input[i + 1] = a->first_input[i] + instance->sizes.inputs;
        a->states += instance->states;
    }
    enum { ROOM = 4 }; /* rows of a step, with its event */
    return coupling_create(&a->sequence.coupling, data, participants, count, ROOM, memory, why);
}

/* Create events: number of the condition or 0, how many releases, latches, unlatches, settings; then these. Times and values are
   in a table of their own. */
static int create_events(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Sequence *s = &a->sequence;
    Coupling *c = &s->coupling;
    Reader r = {NULL, 0};
    size_t values = 0;
    r.numbers = whole_numbers(data, "events", &r.left, memory, why);
    const double *value = data_any(data, "event_values", &values, why);
    s->angular_rate = counted_numbers(data, "angular_rate", c->network.participants, memory, why);
    if (!r.numbers || !value || !s->angular_rate) return 0;
    for (size_t k = 0; k < c->lines; k++)
        for (size_t i = 0; i < c->line[k].hinges; i++)
            if (s->angular_rate[c->line[k].hinge[i]] >= c->rows.observations)
                return refuse(why, "a hinge line has no rate");
    s->events = next_number(&r);
    s->event = s->events <= r.left ? allocate(memory, (s->events + 1) * sizeof *s->event) : NULL;
    if (!s->event) return refuse(why, "the assembly's events are damaged");
    const double *end = value + values;
    for (Event *e = s->event; e < s->event + s->events; e++) {
        const size_t condition = next_number(&r);
        e->releases = next_number(&r);
        e->latches = next_number(&r);
        e->unlatches = next_number(&r);
        e->settings = next_number(&r);
        e->release = (const Place *)next_numbers(&r, 2 * e->releases);
        e->latch = next_numbers(&r, e->latches);
        e->unlatch = next_numbers(&r, 2 * e->unlatches);
        const size_t *set = next_numbers(&r, 2 * e->settings);
        Setting *setting = set ? allocate(memory, (e->settings + 1) * sizeof *setting) : NULL;
        if (!e->release || !e->latch || !e->unlatch || !setting || condition > c->crossings - c->lines ||
            (size_t)(end - value) < 1 + e->settings)
            return refuse(why, "the assembly's events are damaged");
        e->time = *value++;
        e->crossing = condition ? c->crossing + c->lines + condition - 1 : NULL;
        for (size_t i = 0; i < e->releases; i++)
            if (!is_input(&c->network, e->release[i])) return refuse(why, "an event of the assembly releases nothing");
        if (!are_below(e->latch, e->latches, 1, c->lines) || !are_below(e->unlatch, e->unlatches, 2, c->lines))
            return refuse(why, "an event latches no line");
        for (size_t i = 0; i < e->settings; i++) {
            setting[i] = (Setting){set[2 * i], set[2 * i + 1], *value++};
            if (setting[i].participant >= a->participants ||
                setting[i].place >= a->instance[setting[i].participant]->sizes.parameters)
                return refuse(why, "an event of the assembly sets nothing");
        }
        e->setting = setting;
    }
    return 1;
}

/* Whether a driven base has all its places; its inputs follow the commands. */
static int drives(const Assembly *a, const Sizes *sizes) {
    const DrivenFrame *d = &a->driven;
    if (d->participant >= a->participants || sizes->inputs < DRIVES || d->first != sizes->inputs - DRIVES) return 0;
    const Instance *instance = a->instance[d->participant];
    int fit = d->change + 6 <= instance->sizes.inputs;
    for (size_t i = 0; i < 2; i++)
        fit &= d->rate[i] + 3 <= instance->states && d->acceleration[i] + 3 <= instance->states;
    return fit;
}

/* Create commands of the host, in the order of the inputs: kind, participant and place, or line. */
static int create_commands(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    const size_t *driven = counted_numbers(data, "driven", 8, memory, why);
    if (!driven) return 0;
    a->driven = (DrivenFrame){driven[0], driven[1], driven[2], {driven[3], driven[4]}, {driven[5], driven[6]}, driven[7]};
    if (a->driven.is_there && !drives(a, sizes)) return refuse(why, "the assembly drives what it has not");
    const size_t drives = a->driven.is_there ? DRIVES : 0;
    const size_t *table = counted_numbers(data, "commands", 3 * (sizes->inputs - drives), memory, why);
    a->inputs_count = sizes->inputs;
    a->commands = sizes->inputs - drives;
    a->command = allocate(memory, (a->commands + 1) * sizeof *a->command);
    a->latching = allocate(memory, (a->commands + 1) * sizeof *a->latching);
    if (!table || !a->command || !a->latching) return 0;
    for (size_t i = 0; i < a->commands; i++, table += 3) {
        const int releases = table[0] == RELEASES;
        a->command[i] = (Command){table[0], releases ? 0 : table[1], {table[1], table[2]}};
        if (releases ? !is_input(&a->sequence.coupling.network, a->command[i].release) : table[1] >= a->sequence.coupling.lines)
            return refuse(why, "the assembly's input %lu commands nothing", (unsigned long)i + 1);
    }
    return 1;
}

/* Create peaks: how many; of each whether it is a sum, how many numbers, and their places. */
static int create_peaks(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    Reader r = {NULL, 0};
    r.numbers = whole_numbers(data, "peaks", &r.left, memory, why);
    if (!r.numbers) return 0;
    a->peak_count = next_number(&r);
    a->peak = a->peak_count <= sizes->outputs ? allocate(memory, (a->peak_count + 1) * sizeof *a->peak) : NULL;
    if (!a->peak) return refuse(why, "the assembly's peaks are damaged");
    for (Peak *peak = a->peak; peak < a->peak + a->peak_count; peak++) {
        peak->is_sum = next_number(&r);
        peak->count = next_number(&r);
        peak->place = next_numbers(&r, peak->count);
        if (!peak->place || !are_below(peak->place, peak->count, 1, sizes->observations))
            return refuse(why, "the assembly's peaks are damaged");
    }
    return 1;
}

/* Read which recorded values are flags, which are angles of lines, and the size of a row. */
static int create_rows(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    const Rows *r = &a->sequence.coupling.rows;
    a->flag = whole_numbers(data, "flags", &a->flags, memory, why);
    a->angle = a->flag ? whole_numbers(data, "angles", &a->angles, memory, why) : NULL;
    if (!a->angle) return 0;
    if (r->columns + (a->appendage.frame ? APPENDAGE : 0) != sizes->observations || r->signals || !are_below(a->flag, a->flags, 1, r->columns) ||
        !are_below(a->angle, a->angles, 1, r->columns))
        return refuse(why, "the assembly records what it has not");
    a->row_size = 2 + r->columns + CHANNELS;
    return 1;
}

/* Read what a driven base carries: places of its frame, then of masses; no numbers without such a base. */
static int read_appendage(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Appendage *m = &a->appendage;
    const size_t columns = a->sequence.coupling.rows.columns;
    size_t count = 0;
    const size_t *place = whole_numbers(data, "masses", &count, memory, why);
    if (!place || count == 0) return place != NULL;
    m->masses = count > FRAME_PLACES ? (count - FRAME_PLACES) / MASS_PLACES : 0;
    m->value = data_array(data, "mass_values", MASS_VALUES * m->masses, why);
    m->frame = place;
    m->place = place + FRAME_PLACES;
    if (!m->value) return 0;
    if (count != FRAME_PLACES + MASS_PLACES * m->masses || columns < 4 || !are_below(place, count, 1, columns - 3))
        return refuse(why, "the assembly's masses are damaged");
    return 1;
}

/* Texts `group:0`, `group:1` and so on. */
static const char **texts_of(const Data *data, const char *group, size_t count, Memory *memory, Reason *why) {
    char entry[40];
    const char **found = allocate(memory, (count + 1) * sizeof *found);
    for (size_t i = 0; found && i < count; i++) {
        snprintf(entry, sizeof entry, "%s:%lu", group, (unsigned long)i);
        found[i] = data_text(data, entry);
        if (!found[i]) {
            refuse(why, "the assembly's %s %lu has no name", group, (unsigned long)i + 1);
            return NULL;
        }
    }
    return found;
}

/* Read the state from which a scene with preload starts. */
static int read_rest(Assembly *a, const Data *data, Reason *why) {
    Reason absent;
    size_t count = 0;
    if (!data_any(data, "rest_states", &count, &absent)) return 1;
    a->rest_states = data_array(data, "rest_states", a->states, why);
    a->rest_inputs = a->rest_states ? data_array(data, "rest_inputs", a->first_input[a->participants], why) : NULL;
    a->rest_wrenches = a->rest_inputs ? data_array(data, "rest_wrenches", a->sequence.coupling.network.size, why) : NULL;
    return a->rest_wrenches != NULL;
}

static int read_names(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    a->link_name = texts_of(data, "link", a->sequence.coupling.network.links, memory, why);
    a->event_name = a->link_name ? texts_of(data, "event", a->sequence.events, memory, why) : NULL;
    return a->event_name != NULL;
}

int assembly_furnish(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    return create_participants(a, data, memory, why) && create_events(a, data, memory, why) &&
           create_commands(a, data, sizes, memory, why) && create_peaks(a, data, sizes, memory, why) &&
           read_appendage(a, data, memory, why) && create_rows(a, data, sizes, memory, why) && read_names(a, data, memory, why) && read_rest(a, data, why);
}
