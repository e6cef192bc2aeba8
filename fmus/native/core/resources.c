/* From the URI of the resources to a path, and to a file. */

#include "resources.h"

#include <string.h>
#ifdef _WIN32
#include <windows.h>
#endif

static int hexadecimal(char digit) {
    if (digit >= '0' && digit <= '9')
        return digit - '0';
    if (digit >= 'a' && digit <= 'f')
        return digit - 'a' + 10;
    return digit >= 'A' && digit <= 'F' ? digit - 'A' + 10 : -1;
}

static int is_letter(char character) {
    return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
}

int resources_path(const char *location, char *path, size_t size) {
    int encoded = strncmp(location, "file:", 5) == 0;
    if (encoded) {
        location += 5;
        if (strncmp(location, "//localhost/", 12) == 0)
            location += 11;
        else if (strncmp(location, "///", 3) == 0)
            location += 2;
        if (location[0] == '/' && is_letter(location[1]) && location[2] == ':')
            location++;
    }
    size_t length = 0;
    while (*location) {
        if (length + 1 >= size)
            return 0;
        int high = encoded && *location == '%' ? hexadecimal(location[1]) : -1;
        int low = high >= 0 ? hexadecimal(location[2]) : -1;
        if (low >= 0) {
            path[length++] = (char)(16 * high + low);
            location += 3;
        } else {
            path[length++] = *location++;
        }
    }
    path[length] = '\0';
    return length > 0;
}

#ifdef _WIN32
FILE *open_to_read(const char *path) {
    wchar_t wide[FILENAME_MAX];
    /* fopen takes the code page of the user, in which folders may have no name */
    if (!MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, FILENAME_MAX))
        return fopen(path, "rb");
    return _wfopen(wide, L"rb");
}
#else
FILE *open_to_read(const char *path) {
    return fopen(path, "rb");
}
#endif
