/* Memory of an instance: blocks that are released all at once. */

#ifndef FANFOLD_MEMORY_H
#define FANFOLD_MEMORY_H

#include "kernel.h"

typedef struct Block Block;

struct Memory {
    Block *newest;
};

void release(Memory *memory);

#endif
