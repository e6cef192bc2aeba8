/* Where an FMU's resources are on disk, and opening them. */

#ifndef FANFOLD_RESOURCES_H
#define FANFOLD_RESOURCES_H

#include <stddef.h>
#include <stdio.h>

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* The path of a file URI (RFC 3986, also without authority), or of what is a path already; 0 if it does not fit. */
int resources_path(const char *location, char *path, size_t size);

/* A file of a path in UTF-8, as FMI has all texts, to be read; NULL where there is none. */
FILE *open_to_read(const char *path);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
