/* The memory that two processes share, and how they wait for each other: one asks for FMI calls, the other makes them.

   A request is a sequence of records, an answer is one status and the numbers of the last call that gives any. */

#ifndef FANFOLD_CHANNEL_H
#define FANFOLD_CHANNEL_H

#include <errno.h>
#include <stddef.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

enum { OK, WARNING, DISCARD, ERROR, FATAL };
enum { MESSAGE = 2048 };

/* Calls, in the order of NAMES. */
enum {
    START,
    LOAD,
    INSTANTIATE,
    SETUP_EXPERIMENT,
    ENTER_INITIALIZATION,
    EXIT_INITIALIZATION,
    RESET,
    SET_REAL,
    GET_REAL,
    DO_STEP,
    GET_STATE,
    SET_STATE,
    FREE_STATE,
    STATE_SIZE,
    SERIALIZE,
    DESERIALIZE,
    DERIVATIVE,
    PORT_STIFFNESS,
    FREE_INSTANCE,
    CALLS
};

static const char *const NAMES[CALLS] = {
    "the start of the process",
    "the loading of its binary",
    "fmi2Instantiate",
    "fmi2SetupExperiment",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2Reset",
    "fmi2SetReal",
    "fmi2GetReal",
    "fmi2DoStep",
    "fmi2GetFMUstate",
    "fmi2SetFMUstate",
    "fmi2FreeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SerializeFMUstate",
    "fmi2DeSerializeFMUstate",
    "fmi2GetDirectionalDerivative",
    "fanfoldGetPortStiffness",
    "fmi2FreeInstance",
};

/* One call; `length` bytes of its arrays follow, each array from a multiple of 8 bytes on. */
typedef struct {
    int call, flag;
    size_t count[3];
    double number[2];
    void *state; /* a pointer of the process that has the FMU, which means nothing here */
    size_t length;
} Record;

/* The beginning of the shared memory; then `room` bytes for requests, and as many for answers. */
typedef struct {
    int call, status;      /* the call under way or made last, and its FMI status */
    int processor;         /* that the caller runs on; -1 where that is not known */
    size_t room, length;   /* length: bytes of the request */
    char message[MESSAGE]; /* what the FMU logged last */
} Channel;

static char *requests(Channel *channel) { return (char *)(channel + 1); }
static char *answers(Channel *channel) { return requests(channel) + channel->room; }
static size_t padded(size_t bytes) { return (bytes + 7) / 8 * 8; }

enum { COME, ENDED };

/* One byte of a pipe tells that the memory has a request, or an answer. The kernel then hands the processor over from
   one process to the other; spinning instead costs more wherever both were put on one processor. */
static void tell(int pipe) {
    while (write(pipe, "", 1) < 0 && errno == EINTR) {
    }
}

/* COME with such a byte, ENDED where the other process has. */
static int await(int pipe) {
    char byte;
    ssize_t count;
    do count = read(pipe, &byte, 1);
    while (count < 0 && errno == EINTR);
    return count == 1 ? COME : ENDED;
}

#endif
