/* Whether a host that drives the base is unstable. */

#include "host_stability.h"

#include <stddef.h>

enum { WINDOW = 8, GROWN_WINDOWS = 3 };
#define GROWTH 2.0 /* of the power of swings from one window to the next */

int swing_grows(Swing *s, const double *acceleration) {
    for (size_t k = 0; k < SWING_AXES; k++) {
        const double change = acceleration[k] - s->acceleration[k], bend = change - s->change[k];
        s->changes += change * change;
        s->bends += bend * bend;
        s->acceleration[k] = acceleration[k];
        s->change[k] = change;
    }
    if (++s->steps == WINDOW) {
        const int grows = s->last > 0.0 && s->bends > s->changes && s->changes > GROWTH * s->last;
        s->grown = grows ? s->grown + 1.0 : 0.0;
        s->last = s->changes;
        s->steps = s->changes = s->bends = 0.0;
    }
    return s->grown >= GROWN_WINDOWS;
}
