/* FMI 2.0 functions that have another process make the call; a component is a `Caller`. Nothing here allocates but
   `isolated_open`.

   A step costs one exchange: what is posted goes with the next request, and a step comes back with the outputs that
   were asked for after the step before. The FMU sees the calls in the order in which they were made. */

#define _GNU_SOURCE

#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include "channel.h"
#include "processor.h"

enum { SLICE = 50, CLEARED = 1000 }; /* ms */
enum { PORT_WRENCH = 12, PORT_MOTION = 18 };

/* Functions of the interpreter, for signals that come while the FMU keeps us waiting. */
typedef struct {
    int (*ensure)(void);
    void (*release)(int);
    int (*signals)(void);
    void (*clear)(void);
} Interpreter;

typedef struct {
    Channel *channel;
    Interpreter interpreter;
    int to, from, process;
    double limit;      /* s, of one exchange */
    size_t size;       /* bytes of the memory */
    size_t posted;     /* bytes of records that wait for the next request */
    size_t ahead;      /* outputs that a step brings along, by their references */
    unsigned *ahead_references;
    int ahead_status;
    int brought, after_step; /* whether they are there, and whether nothing was asked for since the step */
    int broken, interrupted;
    char why[MESSAGE];
} Caller;

/* Over a file that becomes the memory, with so many bytes for a request; NULL where there is not so much. */
EXPORT Caller *isolated_open(int memory, size_t room, const Interpreter *interpreter, int to, int from, double limit) {
    const size_t size = sizeof(Channel) + 2 * padded(room);
    Caller *c = ftruncate(memory, (off_t)size) ? NULL : calloc(1, sizeof *c + room);
    if (!c) return NULL;
    *c = (Caller){.interpreter = *interpreter, .to = to, .from = from, .limit = limit, .size = size};
    c->ahead_references = (unsigned *)(c + 1);
    c->channel = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
    if (c->channel == MAP_FAILED) {
        free(c);
        return NULL;
    }
    c->channel->room = padded(room);
    return c;
}

EXPORT void isolated_close(Caller *c) {
    munmap(c->channel, c->size);
    free(c);
}

EXPORT void isolated_set_process(Caller *c, int process) { c->process = process; }

/* Why the last call failed: what the FMU said, or what became of its process; empty where nothing is known. */
EXPORT const char *isolated_reason(const Caller *c) { return c->broken ? c->why : c->channel->message; }
EXPORT int isolated_is_sound(const Caller *c) { return !c->broken; }
EXPORT int isolated_interrupted(const Caller *c) { return c->interrupted; }

static int broken(Caller *c, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(c->why, sizeof c->why, format, arguments);
    va_end(arguments);
    const char *said = c->channel->message;
    if (said[0] && length >= 0 && (size_t)length < sizeof c->why)
        snprintf(c->why + length, sizeof c->why - (size_t)length, "; the last that it said is: %.1500s", said);
    c->broken = 1;
    return FATAL;
}

/* How the process ended; without si_pid where it has not. Whoever started it is told of it later as well. */
static siginfo_t end_of(const Caller *c) {
    siginfo_t end = {0};
    waitid(P_PID, (id_t)c->process, &end, WEXITED | WNOHANG | WNOWAIT);
    return end;
}

/* The end of the process, which may be a moment away. */
static int ended(Caller *c) {
    const char *call = NAMES[c->channel->call];
    siginfo_t end = end_of(c);
    for (int i = 0; i < CLEARED && !end.si_pid; i++) {
        poll(NULL, 0, 1);
        end = end_of(c);
    }
    if (end.si_pid && end.si_code == CLD_EXITED)
        return broken(c, "it ended its process with exit code %d during %s", end.si_status, call);
    if (end.si_pid)
        return broken(c, "it crashed during %s, with signal %d (%s)", call, end.si_status, strsignal(end.si_status));
    return broken(c, "its process ended during %s", call);
}

/* Whether a signal, such as that of Ctrl-C, asks for the end. */
static int is_interrupted(Caller *c) {
    const int state = c->interpreter.ensure();
    if (c->interpreter.signals()) {
        c->interpreter.clear();
        c->interrupted = 1;
    }
    c->interpreter.release(state);
    return c->interrupted;
}

/* Whether the answer comes within a slice of time. */
static int answers_soon(const Caller *c) {
    struct pollfd polled = {c->from, POLLIN, 0};
    return poll(&polled, 1, SLICE) > 0;
}

/* Have all that is posted done; the FMI status, of the call that `channel->call` names if it is a failure. */
static int exchange(Caller *c) {
    Channel *channel = c->channel;
    if (c->broken) return FATAL;
    channel->length = c->posted;
    channel->processor = processor_here();
    c->posted = 0;
    c->brought = c->after_step = 0;
    tell(c->to);
    if (!answers_soon(c)) {
        const double end = seconds_now() + c->limit;
        do {
            if (is_interrupted(c)) return broken(c, "interrupted during %s", NAMES[channel->call]);
            if (end_of(c).si_pid) return ended(c);
            if (seconds_now() > end)
                return broken(c, "it hangs, %s has not come to its end in %g s", NAMES[channel->call], c->limit);
        } while (!answers_soon(c));
    }
    return await(c->from) == COME ? channel->status : ended(c);
}

/* Room for a record with so many bytes after it, among those that are posted; NULL where there is none. */
static Record *post(Caller *c, int call, size_t bytes) {
    const size_t length = sizeof(Record) + bytes;
    if (c->broken) return NULL;
    if (length > c->channel->room) {
        snprintf(c->channel->message, MESSAGE, "%s has %zu bytes of numbers, more than the memory that is shared with it",
                 NAMES[call], bytes);
        return NULL;
    }
    if (c->posted + length > c->channel->room && exchange(c) > WARNING) return NULL;
    Record *record = (Record *)(requests(c->channel) + c->posted);
    *record = (Record){.call = call, .length = bytes};
    c->posted += length;
    return record;
}

static char *put(char *at, const void *content, size_t bytes) {
    memcpy(at, content, bytes);
    return at + padded(bytes);
}

static int ask(Caller *c, int call) { return post(c, call, 0) ? exchange(c) : FATAL; }

static int ask_for_state(Caller *c, int call, void *state) {
    Record *r = post(c, call, 0);
    if (!r) return FATAL;
    r->state = state;
    return exchange(c);
}

/* Texts, one after the other with their zeros. */
static int ask_with_texts(Caller *c, int call, int flag, size_t count, const char *const *texts) {
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++) bytes += padded(strlen(texts[i]) + 1);
    Record *r = post(c, call, bytes);
    if (!r) return FATAL;
    r->flag = flag;
    char *at = (char *)(r + 1);
    for (size_t i = 0; i < count; i++) at = put(at, texts[i], strlen(texts[i]) + 1);
    return exchange(c);
}

/* offered: 1 for fmi2GetDirectionalDerivative, 2 for fanfoldGetPortStiffness. */
EXPORT int isolated_load(Caller *c, const char *binary, int *offered) {
    const int status = ask_with_texts(c, LOAD, 0, 1, &binary);
    if (status <= WARNING) memcpy(offered, answers(c->channel), sizeof *offered);
    return status;
}

/* formatted: whether messages have the form of printf, as the standard says, with arguments. */
EXPORT int isolated_instantiate(Caller *c, const char *name, const char *guid, const char *resources, int formatted) {
    const char *texts[] = {name, guid, resources};
    return ask_with_texts(c, INSTANTIATE, formatted, 3, texts);
}

EXPORT int isolated_SetupExperiment(Caller *c, int with_tolerance, double tolerance, double start, int with_stop,
                                    double stop) {
    Record *r = post(c, SETUP_EXPERIMENT, 3 * sizeof(double));
    if (!r) return FATAL;
    const double numbers[] = {tolerance, start, stop};
    r->flag = (with_tolerance ? 1 : 0) + (with_stop ? 2 : 0);
    memcpy(r + 1, numbers, sizeof numbers);
    return exchange(c);
}

EXPORT int isolated_EnterInitializationMode(Caller *c) { return ask(c, ENTER_INITIALIZATION); }
EXPORT int isolated_ExitInitializationMode(Caller *c) { return ask(c, EXIT_INITIALIZATION); }
EXPORT int isolated_Reset(Caller *c) { return ask(c, RESET); }
EXPORT void isolated_FreeInstance(Caller *c) { ask(c, FREE_INSTANCE); }

/* fmi2SetReal with the next request. */
EXPORT int isolated_post_SetReal(Caller *c, const unsigned *references, size_t count, const double *values) {
    Record *r = post(c, SET_REAL, padded(count * sizeof *references) + count * sizeof *values);
    if (!r) return FATAL;
    r->count[0] = count;
    put(put((char *)(r + 1), references, count * sizeof *references), values, count * sizeof *values);
    c->brought = c->after_step = 0;
    return OK;
}

EXPORT int isolated_SetReal(Caller *c, const unsigned *references, size_t count, const double *values) {
    const int status = isolated_post_SetReal(c, references, count, values);
    return status > WARNING ? status : exchange(c);
}

/* fmi2SetFMUstate with the next request. */
EXPORT int isolated_post_SetFMUstate(Caller *c, void *state) {
    Record *r = post(c, SET_STATE, 0);
    if (!r) return FATAL;
    r->state = state;
    c->brought = c->after_step = 0;
    return OK;
}

static int post_get(Caller *c, const unsigned *references, size_t count) {
    const size_t bytes = count * sizeof *references;
    Record *r = count * sizeof(double) > c->channel->room ? NULL : post(c, GET_REAL, padded(bytes));
    if (!r) return 0;
    r->count[0] = count;
    memcpy(r + 1, references, bytes);
    return 1;
}

EXPORT int isolated_GetReal(Caller *c, const unsigned *references, size_t count, double *values) {
    const size_t bytes = count * sizeof *references;
    const int same = count == c->ahead && !memcmp(references, c->ahead_references, bytes);
    int status = c->ahead_status;
    if (!(same && c->brought)) {
        if (c->after_step && bytes <= c->channel->room) {
            c->ahead = count;
            memcpy(c->ahead_references, references, bytes);
        }
        if (!post_get(c, references, count)) return FATAL;
        status = exchange(c);
    }
    if (status <= WARNING) memcpy(values, answers(c->channel), count * sizeof *values);
    return status;
}

EXPORT int isolated_DoStep(Caller *c, double time, double h, int no_return) {
    Record *r = post(c, DO_STEP, 0);
    if (!r) return FATAL;
    r->number[0] = time;
    r->number[1] = h;
    r->flag = no_return;
    const int brings = c->ahead && post_get(c, c->ahead_references, c->ahead);
    const int status = exchange(c);
    c->after_step = !c->broken;
    if (!brings || c->broken || (status > WARNING && c->channel->call != GET_REAL)) return status;
    c->brought = 1;
    c->ahead_status = status;
    return status > WARNING ? OK : status;
}

EXPORT int isolated_GetFMUstate(Caller *c, void **state) {
    const int status = ask_for_state(c, GET_STATE, *state);
    if (status <= WARNING) memcpy(state, answers(c->channel), sizeof *state);
    return status;
}

EXPORT int isolated_SetFMUstate(Caller *c, void *state) { return ask_for_state(c, SET_STATE, state); }

EXPORT int isolated_FreeFMUstate(Caller *c, void **state) {
    const int status = ask_for_state(c, FREE_STATE, *state);
    if (status <= WARNING) *state = NULL;
    return status;
}

EXPORT int isolated_SerializedFMUstateSize(Caller *c, void *state, size_t *size) {
    const int status = ask_for_state(c, STATE_SIZE, state);
    if (status <= WARNING) memcpy(size, answers(c->channel), sizeof *size);
    return status;
}

/* Piece by piece, of which the first makes the FMU serialise. */
EXPORT int isolated_SerializeFMUstate(Caller *c, void *state, char *bytes, size_t size) {
    for (size_t first = 0, piece; first == 0 || first < size; first += piece) {
        piece = size - first < c->channel->room ? size - first : c->channel->room;
        Record *r = post(c, SERIALIZE, 0);
        if (!r) return FATAL;
        r->state = state;
        r->count[0] = size;
        r->count[1] = first;
        r->count[2] = piece;
        const int status = exchange(c);
        if (status > WARNING || piece == 0) return status;
        memcpy(bytes + first, answers(c->channel), piece);
    }
    return OK;
}

/* Piece by piece, of which the last makes the FMU read them all. */
EXPORT int isolated_DeSerializeFMUstate(Caller *c, const char *bytes, size_t size, void **state) {
    const size_t most = c->channel->room - sizeof(Record);
    for (size_t first = 0, piece; first == 0 || first < size; first += piece) {
        piece = size - first < most ? size - first : most / 8 * 8;
        Record *r = post(c, DESERIALIZE, padded(piece));
        if (!r) return FATAL;
        r->state = *state;
        r->count[0] = size;
        r->count[1] = first;
        r->count[2] = piece;
        memcpy(r + 1, bytes + first, piece);
        const int status = exchange(c);
        if (status > WARNING) return status;
        if (piece == 0) break;
    }
    memcpy(state, answers(c->channel), sizeof *state);
    return OK;
}

EXPORT int isolated_GetDirectionalDerivative(Caller *c, const unsigned *of, size_t of_count, const unsigned *by,
                                             size_t by_count, const double *seed, double *result) {
    const size_t of_bytes = of_count * sizeof *of, by_bytes = by_count * sizeof *by;
    const size_t bytes = padded(of_bytes) + padded(by_bytes) + by_count * sizeof *seed;
    Record *r = of_count * sizeof *result > c->channel->room ? NULL : post(c, DERIVATIVE, bytes);
    if (!r) return FATAL;
    r->count[0] = of_count;
    r->count[1] = by_count;
    put(put(put((char *)(r + 1), of, of_bytes), by, by_bytes), seed, by_count * sizeof *seed);
    const int status = exchange(c);
    if (status <= WARNING) memcpy(result, answers(c->channel), of_count * sizeof *result);
    return status;
}

EXPORT int isolated_GetPortStiffness(Caller *c, size_t ports, double *matrix) {
    const size_t bytes = PORT_WRENCH * PORT_MOTION * ports * ports * sizeof *matrix;
    Record *r = bytes > c->channel->room ? NULL : post(c, PORT_STIFFNESS, 0);
    if (!r) return ERROR;
    r->count[0] = ports;
    const int status = exchange(c);
    if (status <= WARNING) memcpy(matrix, answers(c->channel), bytes);
    return status;
}
