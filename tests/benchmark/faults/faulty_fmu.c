/* An FMU that breaks on purpose: it hands every call on to another binary, resources/sound.so, but for the fault that
   resources/fault names and the time (s) from which on it has it. What it does wrong is what binaries do wrong. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void Log(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Log *logger;
    void *functions[3], *environment;
} Callbacks;

static void *sound;
static const Callbacks *host;
static char kind[64];
static double from;
static int due, after_step, slow_steps;

static int is(const char *name) { return !strcmp(kind, name); }
static void say(const char *message) { host->logger(host->environment, "faulty", 3, "logAll", message); }
static void crash(void) { *(volatile int *)8 = 1; }
static int overflow(volatile int *deeper) {
    volatile int here[1024] = {0};
    return deeper == here ? 0 : overflow(here) + here[0];
}
static void *crash_in_thread(void *unused) {
    crash();
    return unused;
}

#define SOUND(type, name) ((type)dlsym(sound, name))

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const Callbacks *callbacks,
                      int visible, int logging) {
    typedef void *Make(const char *, int, const char *, const char *, const Callbacks *, int, int);
    char path[4096];
    host = callbacks;
    snprintf(path, sizeof path, "%s/fault", resources + strlen("file://"));
    FILE *file = fopen(path, "r");
    if (!file || fscanf(file, "%63s %lf", kind, &from) != 2) return NULL;
    fclose(file);
    snprintf(path, sizeof path, "%s/sound.so", resources + strlen("file://"));
    sound = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (is("exit_at_instantiation")) exit(0);
    if (is("crash_at_instantiation")) crash();
    if (is("hang_at_instantiation"))
        for (;;) pause();
    if (is("no_instance")) say("the licence server does not answer");
    if (is("no_instance") || is("no_instance_no_word")) return NULL;
    return SOUND(Make *, "fmi2Instantiate")(name, type, guid, resources, callbacks, visible, logging);
}

#define HAND_ON(name, parameters, arguments)                                                                          \
    int name parameters {                                                                                             \
        if (is("crash_in_" #name)) crash();                                                                           \
        if (is("error_in_" #name)) {                                                                                  \
            say("refused by " #name);                                                                                 \
            return 3;                                                                                                 \
        }                                                                                                             \
        return SOUND(int(*) parameters, #name) arguments;                                                             \
    }

HAND_ON(fmi2SetupExperiment, (void *c, int a, double b, double d, int e, double f), (c, a, b, d, e, f))
HAND_ON(fmi2EnterInitializationMode, (void *c), (c))
HAND_ON(fmi2ExitInitializationMode, (void *c), (c))
HAND_ON(fmi2Reset, (void *c), (c))
HAND_ON(fmi2GetFMUstate, (void *c, void **s), (c, s))
HAND_ON(fmi2SetFMUstate, (void *c, void *s), (c, s))
HAND_ON(fmi2FreeFMUstate, (void *c, void **s), (c, s))
HAND_ON(fmi2SerializedFMUstateSize, (void *c, void *s, size_t *n), (c, s, n))
HAND_ON(fmi2SerializeFMUstate, (void *c, void *s, char *b, size_t n), (c, s, b, n))
HAND_ON(fmi2DeSerializeFMUstate, (void *c, const char *b, size_t n, void **s), (c, b, n, s))
HAND_ON(fmi2GetDirectionalDerivative,
        (void *c, const unsigned *of, size_t n, const unsigned *by, size_t m, const double *d, double *y),
        (c, of, n, by, m, d, y))
HAND_ON(fanfoldGetPortStiffness, (void *c, size_t n, double *y), (c, n, y))

HAND_ON(fanfoldAcceptNumbers, (void *c), (c))

void fmi2FreeInstance(void *c) {
    if (is("crash_in_fmi2FreeInstance")) crash();
    SOUND(void (*)(void *), "fmi2FreeInstance")(c);
}

int fmi2SetReal(void *c, const unsigned *references, size_t count, const double *values) {
    after_step = 0;
    if (due && is("error_in_fmi2SetReal")) {
        say("refused by fmi2SetReal");
        return 3;
    }
    return SOUND(int (*)(void *, const unsigned *, size_t, const double *), "fmi2SetReal")(c, references, count, values);
}

int fmi2GetReal(void *c, const unsigned *references, size_t count, double *values) {
    if (due && is("crash_in_fmi2GetReal")) crash();
    const int status =
        SOUND(int (*)(void *, const unsigned *, size_t, double *), "fmi2GetReal")(c, references, count, values);
    if (due && after_step && is("nan_in_outputs")) values[count / 2] = NAN;
    if (due && after_step && is("infinite_outputs")) values[count / 2] = -INFINITY;
    if (due && !after_step && is("nan_in_observations")) values[count / 2] = NAN;
    return status;
}

static void talk(void) {
    for (int i = 0; i < 2000; i++)
        host->logger(host->environment, "faulty", 0, "logAll", "%d %s", i, "words and words and words and words and words");
}

/* What goes wrong in a step that is due; 0 where it can be made after that. */
static int fail(void) {
    pthread_t thread;
    if (is("crash")) crash();
    if (is("abort")) abort();
    if (is("division")) raise(SIGFPE);
    if (is("illegal")) raise(SIGILL);
    if (is("stack")) return overflow(NULL);
    if (is("heap")) {
        char *volatile block = malloc(24);
        memset(block - 16, 0x55, 64);
        free(block);
    }
    if (is("thread") && !pthread_create(&thread, NULL, crash_in_thread, NULL)) pause();
    if (is("exit")) exit(0);
    if (is("exit_at_once")) _exit(3);
    if (is("fork_and_exit") && fork()) _exit(0);
    if (is("fork_and_exit")) sleep(20), _exit(0);
    if (is("killed")) raise(SIGKILL);
    if (is("hang"))
        for (volatile int i = 0;; i++) {
        }
    if (is("sleep"))
        for (;;) pause();
    if (is("stopped")) raise(SIGSTOP);
    if (is("closed_files"))
        for (int file = 3; file < 64; file++) close(file);
    if (is("error")) say("the magnet has come off at %5 or 100 %%");
    if (is("error") || is("error_no_word")) return 3;
    if (is("discard")) return 2;
    if (is("fatal")) return 4;
    if (is("pending")) return 5;
    if (is("odd_status")) return -77;
    return 0;
}

int fmi2DoStep(void *c, double time, double h, int no_return) {
    after_step = 1;
    due = time + h > from;
    if (is("much_talk")) talk();
    if (is("odd_talk")) say("\xff\xfe \033[31m");
    if (is("printing") && time == 0.0) printf("a word on standard output\n"), fflush(stdout);
    if (due && is("slow") && slow_steps++ < 3) usleep(120000);
    const int failed = due ? fail() : 0;
    return failed ? failed : SOUND(int (*)(void *, double, double, int), "fmi2DoStep")(c, time, h, no_return);
}
