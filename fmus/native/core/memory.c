/* Memory of an instance, and sentences. */

#include "memory.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define ALIGNMENT 64u

struct Block {
    Block *older;
};

void *allocate(Memory *memory, size_t bytes) {
    if (bytes > SIZE_MAX - sizeof(Block) - ALIGNMENT)
        return NULL;
    size_t total = sizeof(Block) + ALIGNMENT + bytes;
    Block *block = calloc(1, total); /* what is never used takes no memory */
    if (!block)
        return NULL;
    block->older = memory->newest;
    memory->newest = block;
    uintptr_t first = (uintptr_t)(block + 1);
    return (void *)((first + ALIGNMENT - 1u) & ~(uintptr_t)(ALIGNMENT - 1u));
}

void release(Memory *memory) {
    while (memory->newest) {
        Block *block = memory->newest;
        memory->newest = block->older;
        free(block);
    }
}

int refuse(Reason *why, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why->text, sizeof why->text, format, arguments);
    va_end(arguments);
    return 0;
}
