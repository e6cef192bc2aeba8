/* The process that has an FMU: it makes the calls that another process asks for, until that one is gone. */

#define _GNU_SOURCE

#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "channel.h"
#include "processor.h"

enum { LOOK = 1000 }; /* ms between two looks at who the parent is */

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

typedef struct {
    Channel *channel;
    void *functions[CALLS];
    Callbacks callbacks;
    int formatted;
    void *component;
    char *bytes; /* of a state that comes or goes piece by piece */
} Server;

typedef struct {
    int from;
    pid_t parent;
} Watch;

/* End this process and those that the FMU started with the process that asks, even where a call hangs. */
static void *watch(void *argument) {
    const Watch *w = argument;
    for (;;) {
        struct pollfd polled = {w->from, 0, 0};
        if (poll(&polled, 1, LOOK) > 0 || getppid() != w->parent) kill(0, SIGKILL);
    }
    return NULL;
}

static void keep(Channel *channel, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(channel->message, MESSAGE, format, arguments);
    va_end(arguments);
}

static void keep_log(void *environment, const char *name, int status, const char *category, const char *message, ...) {
    Server *server = environment;
    va_list arguments;
    (void)name, (void)status;
    if (!category || !message) return;
    if (!server->formatted) {
        keep(server->channel, "%s", message);
        return;
    }
    va_start(arguments, message);
    vsnprintf(server->channel->message, MESSAGE, message, arguments);
    va_end(arguments);
}

static int load(Server *server, const char *binary, void *answer) {
    void *library = dlopen(binary, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        keep(server->channel, "%s", dlerror());
        return ERROR;
    }
    for (int call = INSTANTIATE; call < CALLS; call++) {
        server->functions[call] = dlsym(library, NAMES[call]);
        if (!server->functions[call] && call <= DO_STEP) {
            keep(server->channel, "its binary has no function %s", NAMES[call]);
            return ERROR;
        }
    }
    const int offered = (server->functions[DERIVATIVE] ? 1 : 0) + (server->functions[PORT_STIFFNESS] ? 2 : 0);
    memcpy(answer, &offered, sizeof offered);
    return OK;
}

typedef void *Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int);
typedef int Plain(void *);
typedef void Free(void *);
typedef int Setup(void *, int, double, double, int, double);
typedef int SetReal(void *, const unsigned *, size_t, const double *);
typedef int GetReal(void *, const unsigned *, size_t, double *);
typedef int DoStep(void *, double, double, int);
typedef int State(void *, void *);
typedef int StateCell(void *, void **);
typedef int StateSize(void *, void *, size_t *);
typedef int Serialize(void *, void *, char *, size_t);
typedef int Deserialize(void *, const char *, size_t, void **);
typedef int Derivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, double *);
typedef int PortStiffness(void *, size_t, double *);

static int instantiate(Server *server, Instantiate *function, const Record *r) {
    enum { COSIMULATION = 1 };
    const char *name = (const char *)(r + 1), *guid = name + padded(strlen(name) + 1);
    const char *resources = guid + padded(strlen(guid) + 1);
    server->formatted = r->flag;
    server->callbacks = (Callbacks){keep_log, calloc, free, NULL, server};
    server->component = function(name, COSIMULATION, guid, resources, &server->callbacks, 0, 1);
    if (!server->component && !server->channel->message[0]) keep(server->channel, "fmi2Instantiate gives no instance");
    return server->component ? OK : ERROR;
}

static int serialize(Server *server, Serialize *function, const Record *r, void *answer) {
    const size_t size = r->count[0], first = r->count[1], piece = r->count[2];
    int status = OK;
    if (first == 0) {
        free(server->bytes);
        server->bytes = malloc(size + 1);
        if (!server->bytes) return ERROR;
        status = function(server->component, r->state, server->bytes, size);
    }
    memcpy(answer, server->bytes + first, piece);
    return status;
}

static int deserialize(Server *server, Deserialize *function, const Record *r, void *answer) {
    const size_t size = r->count[0], first = r->count[1], piece = r->count[2];
    if (first == 0) {
        free(server->bytes);
        server->bytes = malloc(size + 1);
    }
    if (!server->bytes) return ERROR;
    memcpy(server->bytes + first, r + 1, piece);
    if (first + piece < size) return OK;
    void *state = r->state;
    const int status = function(server->component, server->bytes, size, &state);
    memcpy(answer, &state, sizeof state);
    return status;
}

/* One call; its numbers into the answer. */
static int perform(Server *server, const Record *r, void *answer) {
    void *c = server->component, *function = server->functions[r->call], *state = r->state;
    const unsigned *references = (const unsigned *)(r + 1);
    const char *after = (const char *)references + padded(r->count[0] * sizeof *references);
    const double *numbers = (const double *)references;
    int status;
    if (r->call == LOAD) return load(server, (const char *)references, answer);
    if (!function) {
        keep(server->channel, "its binary has no function %s", NAMES[r->call]);
        return ERROR;
    }
    switch (r->call) {
    case INSTANTIATE: return instantiate(server, (Instantiate *)function, r);
    case FREE_INSTANCE: ((Free *)function)(c); return OK;
    case SETUP_EXPERIMENT:
        return ((Setup *)function)(c, r->flag & 1, numbers[0], numbers[1], r->flag >> 1, numbers[2]);
    case SET_REAL: return ((SetReal *)function)(c, references, r->count[0], (const double *)after);
    case GET_REAL: return ((GetReal *)function)(c, references, r->count[0], answer);
    case DO_STEP: return ((DoStep *)function)(c, r->number[0], r->number[1], r->flag);
    case SET_STATE: return ((State *)function)(c, state);
    case GET_STATE:
    case FREE_STATE:
        status = ((StateCell *)function)(c, &state);
        memcpy(answer, &state, sizeof state);
        return status;
    case STATE_SIZE: return ((StateSize *)function)(c, state, answer);
    case SERIALIZE: return serialize(server, (Serialize *)function, r, answer);
    case DESERIALIZE: return deserialize(server, (Deserialize *)function, r, answer);
    case DERIVATIVE: {
        const unsigned *by = (const unsigned *)after;
        const double *seed = (const double *)(after + padded(r->count[1] * sizeof *by));
        return ((Derivative *)function)(c, references, r->count[0], by, r->count[1], seed, answer);
    }
    case PORT_STIFFNESS: return ((PortStiffness *)function)(c, r->count[0], answer);
    default: return ((Plain *)function)(c);
    }
}

/* All calls of a request, up to one that fails; whether there will be more. */
static int perform_all(Server *server) {
    Channel *channel = server->channel;
    int status = OK;
    for (size_t at = 0; at < channel->length && status <= WARNING;) {
        const Record *r = (const Record *)(requests(channel) + at);
        channel->call = r->call;
        const int found = perform(server, r, answers(channel));
        if (found > status || found < OK) status = found < OK ? ERROR : found;
        at += sizeof *r + r->length;
    }
    channel->status = status;
    return channel->call != FREE_INSTANCE;
}

/* Serve the process that has the other ends of two pipes and this memory; the exit code. */
EXPORT int isolated_serve(int memory, int from, int to, int parent) {
    struct stat file;
    static Watch watched;
    pthread_t thread;
    Server server = {0};
    watched = (Watch){from, (pid_t)parent};
    if (fstat(memory, &file)) return 1;
    server.channel = mmap(NULL, (size_t)file.st_size, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
    if (server.channel == MAP_FAILED || pthread_create(&thread, NULL, watch, &watched)) return 1;
    Place place = place_here();
    for (int goes_on = 1; goes_on && await(from) == COME;) {
        const double begin = seconds_now();
        goes_on = perform_all(&server);
        follow(&place, server.channel->processor, seconds_now() - begin);
        tell(to);
    }
    return 0;
}
