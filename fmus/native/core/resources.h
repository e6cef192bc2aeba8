/* Where an FMU's resources are on disk. */

#ifndef FANFOLD_RESOURCES_H
#define FANFOLD_RESOURCES_H

#include <stddef.h>

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* The path of a file URI (RFC 3986, also without authority), or of what is a path already; 0 if it does not fit. */
int resources_path(const char *location, char *path, size_t size);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
