/* Reading resources/component.bin: nothing in the file is trusted. */

#include "data.h"

#include "memory.h"
#include "resources.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define MAGIC "FANFOLD\2"
#define LARGEST_FILE (1u << 30)

static uint64_t number_at(const unsigned char *bytes, int count) {
    uint64_t value = 0;
    for (int i = count - 1; i >= 0; i--)
        value = value << 8 | bytes[i];
    return value;
}

static double double_at(const unsigned char *bytes) {
    uint64_t bits = number_at(bytes, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* One entry from the bytes at *position on; 0 where they do not make one. */
static int read_entry(const unsigned char *bytes, size_t size, size_t *position, Entry *entry, Memory *memory) {
    if (size - *position < 13)
        return 0;
    unsigned char type = bytes[*position];
    size_t name_length = (size_t)number_at(bytes + *position + 1, 4);
    uint64_t count = number_at(bytes + *position + 5, 8);
    *position += 13;
    size_t width = type == 'd' ? 8 : 1;
    if ((type != 'd' && type != 's') || name_length > size - *position)
        return 0;
    if (count > (size - *position - name_length) / width)
        return 0;
    char *name = allocate(memory, name_length + 1);
    unsigned char *content = allocate(memory, (size_t)count * width + 1);
    if (!name || !content)
        return 0;
    memcpy(name, bytes + *position, name_length);
    *position += name_length;
    entry->name = name;
    entry->count = (size_t)count;
    entry->numbers = NULL;
    entry->text = NULL;
    if (type == 's') {
        memcpy(content, bytes + *position, (size_t)count);
        entry->text = (const char *)content;
    } else {
        double *numbers = (double *)(void *)content;
        for (size_t i = 0; i < count; i++)
            numbers[i] = double_at(bytes + *position + 8 * i);
        entry->numbers = numbers;
    }
    *position += (size_t)count * width;
    return 1;
}

static unsigned char *whole_file(const char *path, size_t *size, Memory *memory, Reason *why) {
    FILE *file = open_to_read(path);
    if (!file) {
        refuse(why, "%s cannot be read; the FMU is incomplete", path);
        return NULL;
    }
    unsigned char *bytes = NULL;
    long length = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (length < 0 || (unsigned long)length > LARGEST_FILE || fseek(file, 0, SEEK_SET) != 0)
        refuse(why, "%s has no size that makes sense", path);
    else if (!(bytes = allocate(memory, (size_t)length + 1)))
        refuse(why, "no memory for the %ld bytes of %s", length, path);
    else if (fread(bytes, 1, (size_t)length, file) != (size_t)length) {
        refuse(why, "%s cannot be read to its end", path);
        bytes = NULL;
    }
    fclose(file);
    *size = bytes ? (size_t)length : 0;
    return bytes;
}

int data_read(Data *data, const char *path, Memory *memory, Reason *why) {
    size_t size = 0;
    const unsigned char *bytes = whole_file(path, &size, memory, why);
    return bytes && data_parse(data, path, bytes, size, memory, why);
}

int data_parse(Data *data, const char *source, const unsigned char *bytes, size_t size, Memory *memory, Reason *why) {
    size_t start = strlen(MAGIC);
    if (size < start || memcmp(bytes, MAGIC, start) != 0)
        return refuse(why, "%s is not the data of a Fanfold component of this version", source);
    Memory trial = {NULL};
    size_t count = 0;
    Entry entry;
    for (size_t position = start; position < size; count++) {
        if (!read_entry(bytes, size, &position, &entry, &trial)) {
            release(&trial);
            return refuse(why, "%s is damaged after its entry %lu", source, (unsigned long)count);
        }
    }
    release(&trial);
    data->entries = allocate(memory, (count + 1) * sizeof(Entry));
    if (!data->entries)
        return refuse(why, "no memory for the entries of %s", source);
    data->count = count;
    size_t position = start;
    for (size_t i = 0; i < count; i++)
        if (!read_entry(bytes, size, &position, &data->entries[i], memory))
            return refuse(why, "no memory for the content of %s", source);
    return 1;
}

static const Entry *find(const Data *data, const char *name) {
    for (size_t i = 0; i < data->count; i++)
        if (strcmp(data->entries[i].name, name) == 0)
            return &data->entries[i];
    return NULL;
}

const char *data_text(const Data *data, const char *name) {
    const Entry *entry = find(data, name);
    return entry ? entry->text : NULL;
}

const char *data_bytes(const Data *data, const char *name, size_t *count) {
    const Entry *entry = find(data, name);
    if (entry)
        *count = entry->count;
    return entry ? entry->text : NULL;
}

const double *data_any(const Data *data, const char *name, size_t *count, Reason *why) {
    const Entry *entry = find(data, name);
    if (!entry || !entry->numbers) {
        refuse(why, "the component's data have no numbers named %s", name);
        return NULL;
    }
    *count = entry->count;
    return entry->numbers;
}

const double *data_array(const Data *data, const char *name, size_t count, Reason *why) {
    size_t found = 0;
    const double *numbers = data_any(data, name, &found, why);
    if (numbers && found != count) {
        refuse(why, "the component's data have %lu numbers for %s; it takes %lu", (unsigned long)found, name,
               (unsigned long)count);
        return NULL;
    }
    return numbers;
}

static int whole(double value) { return value >= 0.0 && value < 1e9 && floor(value) == value; }

int data_variable(const Data *data, size_t index, const char *group, Variable *variable) {
    const Entry *entry = &data->entries[index];
    size_t length = strlen(group);
    if (strncmp(entry->name, group, length) != 0 || entry->name[length] != ':')
        return 0;
    if (!entry->numbers || entry->count != 6 || !whole(entry->numbers[0]) || !whole(entry->numbers[1]) ||
        !whole(entry->numbers[5]) || entry->numbers[5] > KIND_INTEGER)
        return 0;
    variable->name = entry->name + length + 1;
    variable->offset = (size_t)entry->numbers[0];
    variable->size = (size_t)entry->numbers[1];
    variable->minimum = entry->numbers[2];
    variable->maximum = entry->numbers[3];
    variable->tunable = entry->numbers[4] != 0.0;
    variable->kind = (VariableKind)entry->numbers[5];
    return 1;
}

long data_offset(const Data *data, const char *group, const char *name, size_t size, Reason *why) {
    Variable variable;
    for (size_t i = 0; i < data->count; i++) {
        if (!data_variable(data, i, group, &variable) || strcmp(variable.name, name) != 0)
            continue;
        if (variable.size == size)
            return (long)variable.offset;
        refuse(why, "%s %s has %lu scalars; its kernel takes %lu", group, name, (unsigned long)variable.size,
               (unsigned long)size);
        return -1;
    }
    refuse(why, "the component's data declare no %s %s", group, name);
    return -1;
}
