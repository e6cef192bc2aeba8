/* Steps an FMU of FMI 2.0 through given inputs, and writes its outputs, all in binary, so that no platform rounds.

   usage: host LIBRARY RESOURCES_URI GUID TASK RESULT
   TASK:   int32 inputs, outputs, steps; uint32 references of inputs, then of outputs; double h; doubles by step
   RESULT: doubles by step */

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) LoadLibraryA(path)
#define FIND(library, name) ((void *)GetProcAddress(library, name))
typedef HMODULE Library;
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
typedef void *Library;
#endif

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

typedef void *Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int);
typedef int Setup(void *, int, double, double, int, double);
typedef int Plain(void *);
typedef int Set(void *, const uint32_t *, size_t, const double *);
typedef int Get(void *, const uint32_t *, size_t, double *);
typedef int Step(void *, double, double, int);
typedef void Release(void *);

static void told(void *environment, const char *name, int status, const char *category, const char *text, ...) {
    (void)environment, (void)category;
    fprintf(stderr, "%s: status %d: %s\n", name, status, text);
}

static void require(int holds, const char *what) {
    if (!holds) {
        fprintf(stderr, "%s failed\n", what);
        exit(1);
    }
}

static void *whole(FILE *file, size_t size, size_t count) {
    void *found = malloc(size * count + 1);
    require(found && fread(found, size, count, file) == count, "reading the task");
    return found;
}

int main(int count, char **words) {
    require(count == 6, "usage: host LIBRARY RESOURCES_URI GUID TASK RESULT");
    Library library = OPEN(words[1]);
    require(library != NULL, words[1]);
    FILE *task = fopen(words[4], "rb"), *result = fopen(words[5], "wb");
    require(task && result, "opening the files");
    int32_t *sizes = whole(task, sizeof(int32_t), 3);
    size_t inputs = (size_t)sizes[0], outputs = (size_t)sizes[1];
    uint32_t *in = whole(task, sizeof(uint32_t), inputs), *out = whole(task, sizeof(uint32_t), outputs);
    double h = *(double *)whole(task, sizeof(double), 1);
    double *values = malloc(sizeof(double) * (inputs + 1)), *found = malloc(sizeof(double) * (outputs + 1));

    Callbacks callbacks = {told, calloc, free, NULL, NULL};
    Set *set = (Set *)FIND(library, "fmi2SetReal");
    Get *get = (Get *)FIND(library, "fmi2GetReal");
    Step *step = (Step *)FIND(library, "fmi2DoStep");
    void *fmu = ((Instantiate *)FIND(library, "fmi2Instantiate"))("one", 1, words[3], words[2], &callbacks, 0, 0);
    require(fmu != NULL, "fmi2Instantiate");
    require(!((Plain *)FIND(library, "fanfoldAcceptNumbers"))(fmu), "fanfoldAcceptNumbers");
    require(!((Setup *)FIND(library, "fmi2SetupExperiment"))(fmu, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
    require(!((Plain *)FIND(library, "fmi2EnterInitializationMode"))(fmu), "fmi2EnterInitializationMode");
    require(!((Plain *)FIND(library, "fmi2ExitInitializationMode"))(fmu), "fmi2ExitInitializationMode");
    for (int32_t k = 0; k < sizes[2]; k++) {
        require(fread(values, sizeof(double), inputs, task) == inputs, "reading the task");
        require(!set(fmu, in, inputs, values), "fmi2SetReal");
        require(!step(fmu, k * h, h, 1), "fmi2DoStep");
        require(!get(fmu, out, outputs, found), "fmi2GetReal");
        require(fwrite(found, sizeof(double), outputs, result) == outputs, "writing the result");
    }
    ((Release *)FIND(library, "fmi2FreeInstance"))(fmu);
    require(!fclose(result), "writing the result");
    return 0;
}
