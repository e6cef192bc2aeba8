/* Memory of an instance: blocks that are released all at once. */

#ifndef FANFOLD_MEMORY_H
#define FANFOLD_MEMORY_H

#include "kernel.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

typedef struct Block Block;

struct Memory {
    Block *newest;
};

void release(Memory *memory);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
