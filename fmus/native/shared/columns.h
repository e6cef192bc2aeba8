/* 3-vectors that are linear in a few numbers: their derivatives, a column for each of these. Plain numbers; what is
   fixed (vectors of 3, matrices of 9 row by row) comes first. */

#ifndef FANFOLD_COLUMNS_H
#define FANFOLD_COLUMNS_H

enum { COLUMNS = 18 };

typedef struct Columns {
    double row[3][COLUMNS];
} Columns;

/* The identity in three columns, zero in the others. */
static inline Columns columns_of_unit(int first) {
    Columns found = {{{0.0}}};
    for (int i = 0; i < 3; i++) found.row[i][first + i] = 1.0;
    return found;
}

/* to += factor x added. */
static inline void columns_add(Columns *to, double factor, const Columns *added) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < COLUMNS; j++) to->row[i][j] += factor * added->row[i][j];
}

/* to += factor x matrix v. */
static inline void columns_add_product(Columns *to, double factor, const double matrix[9], const Columns *v) {
    for (int i = 0; i < 3; i++) {
        const double a = factor * matrix[3 * i], b = factor * matrix[3 * i + 1], c = factor * matrix[3 * i + 2];
        for (int j = 0; j < COLUMNS; j++) to->row[i][j] += a * v->row[0][j] + b * v->row[1][j] + c * v->row[2][j];
    }
}

/* to += factor x (fixed cross v). */
static inline void columns_add_cross(Columns *to, double factor, const double fixed[3], const Columns *v) {
    const double x = factor * fixed[0], y = factor * fixed[1], z = factor * fixed[2];
    columns_add_product(to, 1.0, (const double[9]){0.0, -z, y, z, 0.0, -x, -y, x, 0.0}, v);
}

#endif
