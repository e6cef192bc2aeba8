/* What bases read of their ports. */

#ifndef FANFOLD_BASE_PORTS_H
#define FANFOLD_BASE_PORTS_H

#include "laws.h"
#include "port_sizes.h"

#ifndef FANFOLD_COMPLEX

#define MOST_BASE_PORTS 1024

/* Number of ports, copies of their arms from the reference point (3 a port) and orientations (4 a port). */
static inline int read_base_ports(const Data *data, Memory *memory, size_t *ports, const double **arms,
                                  const double **orientations, Reason *why) {
    size_t count = 0;
    if (!data_any(data, "base_arms", &count, why)) return 0;
    if (count % 3 != 0 || count / 3 > MOST_BASE_PORTS)
        return refuse(why, "the base's data have %lu numbers for arms; it takes 3 a port, %d ports at most",
                      (unsigned long)count, MOST_BASE_PORTS);
    *ports = count / 3;
    *arms = read_table_part(data, memory, "base", "arms", count, why);
    *orientations = *arms ? read_table_part(data, memory, "base", "orientations", 4 * *ports, why) : NULL;
    return *orientations != NULL;
}

#endif
#endif
