/* Strains, stresses and loads of the elements of a beam, with their derivatives: the equations of
   components/beam_parts/elements.py, where the theory is told. Part of beam.c. */

#ifndef FANFOLD_BEAM_ELEMENTS_H
#define FANFOLD_BEAM_ELEMENTS_H

#include "beam_model.h"

#define SMALLEST_TRACE 2.0
#define LARGEST_SQUARE 0.75
#define NEGLIGIBLE 1e-18

enum { COORDINATES = 9 }; /* of an element: its span, rotations of its first and its second node */

static inline double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void cross3(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* c = a^T b of matrices row by row. */
static inline void transposed_product(const double a[9], const double b[9], double c[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) c[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

/* The value of d(y) at the start of [start, end], its divided difference over it, and the derivative of this by the end:
   the power series. */
static inline double divided(double start, double end, double *difference, double *by_end) {
    double coefficient = 1.0 / 6.0, value = coefficient, power = 1.0, sums = 1.0, sums_by_end = 0.0, size = 1.0;
    const double largest = fmax(start, end);
    *difference = *by_end = 0.0;
    for (double n = 1.0; coefficient * n * n * size > NEGLIGIBLE; n += 1.0) {
        coefficient *= (2.0 * n + 1.0) * (2.0 * n + 1.0) / ((2.0 * n + 2.0) * (2.0 * n + 3.0));
        *difference += coefficient * sums;
        *by_end += coefficient * sums_by_end;
        power *= start;
        value += coefficient * power;
        sums_by_end = sums + end * sums_by_end;
        sums = end * sums + power;
        size *= largest;
    }
    return value;
}

/* Strains of element m of a shape whose directors and spans are known; 0 where it turns beyond its range. */
static inline int strain(const Beam *beam, const Shape *shape, size_t m) {
    const double *a = shape->directors + 9 * m, *b = a + 9, *span = shape->spans + 3 * m, *rest = beam->rest + 6 * m;
    const double length = beam->lengths[m], half = 0.5 / length;
    Strains *z = shape->strains + m;
    double relative[9], unused, by_end;
    transposed_product(a, b, relative);
    for (int i = 0; i < 3; i++)
        z->s[i] = half * ((a[i] + b[i]) * span[0] + (a[3 + i] + b[3 + i]) * span[1] + (a[6 + i] + b[6 + i]) * span[2]);
    z->k[0] = half * (relative[7] - relative[5]);
    z->k[1] = half * (relative[2] - relative[6]);
    z->k[2] = half * (relative[3] - relative[1]);
    z->y = length * length * dot3(z->k, z->k);
    if (!(relative[0] + relative[4] + relative[8] >= SMALLEST_TRACE && z->y <= LARGEST_SQUARE)) return 0;
    z->d = divided(z->y, z->y, &unused, &by_end);
    z->c = 1.0 + z->y * z->d;
    z->g = dot3(z->k, z->s);
    const double bent = length * length * z->d * z->g;
    for (int i = 0; i < 3; i++) {
        z->e[i] = z->c * z->s[i] - bent * z->k[i] - rest[i];
        z->e[3 + i] = z->c * z->k[i] - rest[3 + i];
    }
    return 1;
}

static inline Differences differences_of(const Strains *start, const Strains *end) {
    Differences f;
    (void)divided(start->y, end->y, &f.d, &f.d_by_end);
    f.c = start->d + end->y * f.d;
    f.c_by_end = f.d + end->y * f.d_by_end;
    f.slope_d = f.d + (end->y - start->y) * f.d_by_end;
    f.slope_c = end->d + end->y * f.slope_d;
    return f;
}

/* Means over a step of an element. force, moment: resultants, with those of viscosity. */
typedef struct {
    double square, s[3], k[3], c, d, g, w, force[3], moment[3], along, work;
} Means;

/* damping: of the stiffness, over the size of the step; change: of the strains over it, read where there is damping. */
static inline Means means_of(const Beam *beam, size_t m, const Strains *start, const Strains *end, double damping,
                             const double change[6]) {
    Means a;
    a.square = beam->lengths[m] * beam->lengths[m];
    for (int i = 0; i < 3; i++) {
        a.s[i] = 0.5 * (start->s[i] + end->s[i]);
        a.k[i] = 0.5 * (start->k[i] + end->k[i]);
        a.force[i] = 0.5 * beam->stiffness[i] * (start->e[i] + end->e[i]);
        a.moment[i] = 0.5 * beam->stiffness[3 + i] * (start->e[3 + i] + end->e[3 + i]);
        if (damping > 0.0) {
            a.force[i] += damping * beam->stiffness[i] * change[i];
            a.moment[i] += damping * beam->stiffness[3 + i] * change[3 + i];
        }
    }
    a.c = 0.5 * (start->c + end->c);
    a.d = 0.5 * (start->d + end->d);
    a.g = 0.5 * (start->g + end->g);
    a.w = 0.5 * (start->d * start->g + end->d * end->g);
    a.along = dot3(a.k, a.force);
    a.work = dot3(a.s, a.force) + dot3(a.k, a.moment);
    return a;
}

/* Change of the strains over a step by those z of (s, k), without cancellation. */
static inline void strain_change(const Beam *beam, size_t m, const Strains *start, const Strains *end, const double z[6],
                                 double change[6]) {
    double difference, by_end;
    (void)divided(start->y, end->y, &difference, &by_end);
    const Means a = means_of(beam, m, start, end, 0.0, NULL);
    const double q = a.square, bent = dot3(a.k, z + 3), turned = 2.0 * q * (start->d + end->y * difference) * bent;
    const double along = q * a.d * (dot3(a.k, z) + dot3(a.s, z + 3)) + 2.0 * q * q * a.g * difference * bent;
    for (int i = 0; i < 3; i++) {
        change[i] = a.c * z[i] + turned * a.s[i] - q * a.w * z[3 + i] - along * a.k[i];
        change[3 + i] = a.c * z[3 + i] + turned * a.k[i];
    }
}

/* Mean over a step of what does the work of elasticity and viscosity on (s, k). */
static inline void stress_of(const Beam *beam, size_t m, const Strains *start, const Strains *end, double damping,
                             const double change[6], double stress[6]) {
    double difference, by_end;
    (void)divided(start->y, end->y, &difference, &by_end);
    const Means a = means_of(beam, m, start, end, damping, change);
    const double q = a.square;
    const double bent = 2.0 * q * ((start->d + end->y * difference) * a.work - q * a.g * difference * a.along);
    for (int i = 0; i < 3; i++) {
        stress[i] = a.c * a.force[i] - q * a.d * a.along * a.k[i];
        stress[3 + i] = a.c * a.moment[i] + bent * a.k[i] - q * (a.w * a.force[i] + a.d * a.along * a.s[i]);
    }
}

/* r = skew(turn) mean: change of the directors of a node. */
static inline void turned_directors(const double turn[3], const double mean[9], double r[9]) {
    for (int j = 0; j < 3; j++) {
        r[j] = turn[1] * mean[6 + j] - turn[2] * mean[3 + j];
        r[3 + j] = turn[2] * mean[j] - turn[0] * mean[6 + j];
        r[6 + j] = turn[0] * mean[3 + j] - turn[1] * mean[j];
    }
}

/* Changes of (s, k) by travel and turn of the first node and of the second behind it, without cancellation: a, b, span
   are means over the step. */
static inline void change_of(const double a[9], const double b[9], const double span[3], const double *travel,
                             const double *turn, double length, double change[6]) {
    const double half = 0.5 / length;
    const double apart[3] = {travel[3] - travel[0], travel[4] - travel[1], travel[5] - travel[2]};
    double first[9], second[9], left[9], right[9];
    turned_directors(turn, a, first);
    turned_directors(turn + 3, b, second);
    transposed_product(first, b, left);
    transposed_product(a, second, right);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        double sum = 0.0;
        for (int t = 0; t < 3; t++)
            sum += (a[3 * t + i] + b[3 * t + i]) * apart[t] + (first[3 * t + i] + second[3 * t + i]) * span[t];
        change[i] = half * sum;
        change[3 + i] = half * (left[3 * k + j] - left[3 * j + k] + right[3 * k + j] - right[3 * j + k]);
    }
}

/* Derivatives (6, 6) of the same by (s, k) at the end of the step: all six columns at once by the rule of products. */
FANFOLD_INLINED void stiffness_of(const Beam *beam, size_t m, const Strains *start, const Strains *end, double damping,
                                const double change[6], double matrix[36]) {
    const Differences f = differences_of(start, end);
    const Means a = means_of(beam, m, start, end, damping, change);
    const double q = a.square, *C = beam->stiffness, *s = end->s, *k = end->k;
    /* derivatives of y, g = k.s, d g, of means of c and d; of resultants, and of their products with means */
    const double y[6] = {0.0, 0.0, 0.0, 2.0 * q * k[0], 2.0 * q * k[1], 2.0 * q * k[2]};
    const double g[6] = {k[0], k[1], k[2], s[0], s[1], s[2]};
    double w[6], c[6], d[6], force[3][6], moment[3][6], along[6], work[6], bends[6];
    for (int j = 0; j < 6; j++) {
        w[j] = end->d * g[j] + end->g * f.slope_d * y[j];
        c[j] = 0.5 * f.slope_c * y[j];
        d[j] = 0.5 * f.slope_d * y[j];
    }
    for (int i = 0; i < 3; i++) {
        const double stretch = (0.5 + damping) * C[i], bend = (0.5 + damping) * C[3 + i];
        for (int j = 0; j < 6; j++) {
            force[i][j] = stretch * (s[i] * f.slope_c * y[j] - q * k[i] * w[j]);
            moment[i][j] = bend * k[i] * f.slope_c * y[j];
        }
        force[i][i] += stretch * end->c;
        force[i][3 + i] -= stretch * q * end->d * end->g;
        moment[i][3 + i] += bend * end->c;
    }
    for (int j = 0; j < 6; j++) {
        along[j] = a.k[0] * force[0][j] + a.k[1] * force[1][j] + a.k[2] * force[2][j];
        work[j] = a.s[0] * force[0][j] + a.s[1] * force[1][j] + a.s[2] * force[2][j] + a.k[0] * moment[0][j] +
                  a.k[1] * moment[1][j] + a.k[2] * moment[2][j];
    }
    for (int i = 0; i < 3; i++) {
        along[3 + i] += 0.5 * a.force[i];
        work[i] += 0.5 * a.force[i];
        work[3 + i] += 0.5 * a.moment[i];
    }
    const double bent = 2.0 * q * (f.c * a.work - q * a.g * f.d * a.along);
    for (int j = 0; j < 6; j++)
        bends[j] = 2.0 * q * (f.c_by_end * y[j] * a.work + f.c * work[j] -
                              q * ((0.5 * g[j] * f.d + a.g * f.d_by_end * y[j]) * a.along + a.g * f.d * along[j]));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 6; j++) {
            const double turned = d[j] * a.along + a.d * along[j];
            matrix[6 * i + j] = c[j] * a.force[i] + a.c * force[i][j] - q * turned * a.k[i];
            matrix[6 * (3 + i) + j] = c[j] * a.moment[i] + a.c * moment[i][j] + bends[j] * a.k[i] -
                                      q * (0.5 * w[j] * a.force[i] + a.w * force[i][j] + turned * a.s[i]);
        }
        matrix[6 * i + 3 + i] -= 0.5 * q * a.d * a.along;
        matrix[6 * (3 + i) + 3 + i] += 0.5 * bent;
        matrix[6 * (3 + i) + i] -= 0.5 * q * a.d * a.along;
    }
}

/* m = r skew(v) t^T. */
static inline void turned_skew(const double r[9], const double v[3], const double t[9], double m[9]) {
    const double skew[9] = {0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0};
    double half[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            half[3 * i + j] = skew[3 * i] * t[3 * j] + skew[3 * i + 1] * t[3 * j + 1] + skew[3 * i + 2] * t[3 * j + 2];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[3 * i + j] = r[3 * i] * half[j] + r[3 * i + 1] * half[3 + j] + r[3 * i + 2] * half[6 + j];
}

/* v = half a rotation times a force in its axes. */
static inline void half_turned(const double r[9], const double force[3], double v[3]) {
    for (int i = 0; i < 3; i++) v[i] = 0.5 * (r[3 * i] * force[0] + r[3 * i + 1] * force[1] + r[3 * i + 2] * force[2]);
}

/* Adds the loads that stress has on the mean of two shapes: a, b, span are means. Six numbers a node. */
static inline void add_loads(const double a[9], const double b[9], const double span[3], const double stress[6],
                             double *load) {
    double first[3], second[3], arm[3], matrix[9];
    half_turned(a, stress, first);
    half_turned(b, stress, second);
    turned_skew(a, stress + 3, b, matrix);
    const double moment[3] = {0.5 * (matrix[5] - matrix[7]), 0.5 * (matrix[6] - matrix[2]),
                              0.5 * (matrix[1] - matrix[3])};
    for (int i = 0; i < 3; i++) {
        load[i] += first[i] + second[i];
        load[NODE + i] -= first[i] + second[i];
    }
    cross3(span, first, arm);
    for (int i = 0; i < 3; i++) load[3 + i] += arm[i] - moment[i];
    cross3(span, second, arm);
    for (int i = 0; i < 3; i++) load[NODE + 3 + i] += arm[i] + moment[i];
}

/* Rates of (s, k) by the coordinates of an element, (6, COORDINATES). */
FANFOLD_INLINED void motions_of(const double a[9], const double b[9], const double span[3], double length,
                              double motion[6 * COORDINATES]) {
    const double half = 0.5 / length;
    double first[3][3], second[3][3];
    memset(motion, 0, 6 * COORDINATES * sizeof(double));
    for (int i = 0; i < 3; i++)
        for (int r = 0; r < 3; r++) {
            first[i][r] = a[3 * r + i];
            second[i][r] = b[3 * r + i];
        }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        double *row = motion + COORDINATES * i, *turn = motion + COORDINATES * (3 + i), p[3], r[3];
        for (int t = 0; t < 3; t++) row[t] = half * (first[i][t] + second[i][t]);
        cross3(first[i], span, row + 3);
        cross3(second[i], span, row + 6);
        cross3(first[k], second[j], p);
        cross3(first[j], second[k], r);
        for (int t = 0; t < 3; t++) {
            row[3 + t] *= half;
            row[6 + t] *= half;
            turn[3 + t] = half * (p[t] - r[t]);
            turn[6 + t] = -turn[3 + t];
        }
    }
}

/* k(row.., column..) += factor skew(v). */
static inline void add_skew(double *k, int row, int column, double factor, const double v[3]) {
    double *p = k + COORDINATES * row + column;
    p[1] -= factor * v[2];
    p[2] += factor * v[1];
    p[COORDINATES] += factor * v[2];
    p[COORDINATES + 2] -= factor * v[0];
    p[2 * COORDINATES] -= factor * v[1];
    p[2 * COORDINATES + 1] += factor * v[0];
}

/* k(row.., column..) += factor (m or its transpose, less its trace). */
static inline void add_turned(double *k, int row, int column, double factor, const double m[9], int transposed) {
    const double trace = m[0] + m[4] + m[8];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            k[COORDINATES * (row + i) + column + j] +=
                factor * ((transposed ? m[3 * j + i] : m[3 * i + j]) - (i == j ? trace : 0.0));
}

/* Adds, to minus the derivative (9, 9) of the loads by the coordinates at the end, the part of fixed stress. */
FANFOLD_INLINED void add_geometric(const double a[9], const double b[9], const double span[3], const double a_end[9],
                                 const double b_end[9], const double stress[6], double *k) {
    const double *now[2] = {a, b}, *later[2] = {a_end, b_end};
    double v[3], w[3], m[9];
    for (int node = 0; node < 2; node++) {
        const int own = 3 + 3 * node;
        half_turned(now[node], stress, v);
        half_turned(later[node], stress, w);
        add_skew(k, 0, own, -0.5, w);
        add_skew(k, own, 0, 0.5, v);
        /* half skew(span) skew(w) = half (w span^T - span.w) */
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                k[COORDINATES * (own + i) + own + j] += 0.5 * (w[i] * span[j] - (i == j ? dot3(span, w) : 0.0));
    }
    turned_skew(a_end, stress + 3, b, m);
    add_turned(k, 3, 3, 0.25, m, 0);
    add_turned(k, 6, 3, -0.25, m, 0);
    turned_skew(a, stress + 3, b_end, m);
    add_turned(k, 3, 6, -0.25, m, 1);
    add_turned(k, 6, 6, 0.25, m, 1);
}

/* k = factor b^T g e + k of the rates b, e (6, 9) and derivatives g (6, 6). k of an element does not change with its
   span, and with rotations of both nodes by their difference alone: these rows have three numbers, then their negatives. */
FANFOLD_INLINED void add_material(const double *b, const double *g, const double *e, double factor, double *k) {
    double ge[6 * COORDINATES];
    for (int i = 0; i < 6; i++) {
        double *row = ge + COORDINATES * i;
        const double *by = g + 6 * i;
        for (int j = 0; j < COORDINATES; j++)
            row[j] = factor * (by[0] * e[j] + by[1] * e[COORDINATES + j] + by[2] * e[2 * COORDINATES + j]);
        for (int j = 3; j < 6; j++) {
            const double turned = factor * (by[3] * e[3 * COORDINATES + j] + by[4] * e[4 * COORDINATES + j] +
                                            by[5] * e[5 * COORDINATES + j]);
            row[j] += turned;
            row[3 + j] -= turned;
        }
    }
    for (int r = 0; r < COORDINATES; r++)
        for (int j = 0; j < COORDINATES; j++)
            k[COORDINATES * r + j] += b[r] * ge[j] + b[COORDINATES + r] * ge[COORDINATES + j] +
                                      b[2 * COORDINATES + r] * ge[2 * COORDINATES + j];
    for (int r = 3; r < 6; r++)
        for (int j = 0; j < COORDINATES; j++) {
            const double turned = b[3 * COORDINATES + r] * ge[3 * COORDINATES + j] +
                                  b[4 * COORDINATES + r] * ge[4 * COORDINATES + j] +
                                  b[5 * COORDINATES + r] * ge[5 * COORDINATES + j];
            k[COORDINATES * r + j] += turned;
            k[COORDINATES * (3 + r) + j] -= turned;
        }
}

/* Adds k (9, 9) to the blocks of the element's nodes: a span is the second place less the first. */
static inline void add_to_blocks(const double *k, double *aa, double *ab, double *ba, double *bb) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int x = COORDINATES * i + j, f = COORDINATES * (3 + i) + j, s = COORDINATES * (6 + i) + j;
            const int u = NODE * i + j, l = NODE * (3 + i) + j;
            aa[u] += k[x];
            ab[u] -= k[x];
            ba[u] -= k[x];
            bb[u] += k[x];
            aa[u + 3] -= k[x + 3];
            ab[u + 3] -= k[x + 6];
            ba[u + 3] += k[x + 3];
            bb[u + 3] += k[x + 6];
            aa[l] -= k[f];
            ab[l] += k[f];
            ba[l] -= k[s];
            bb[l] += k[s];
            aa[l + 3] += k[f + 3];
            ab[l + 3] += k[f + 6];
            ba[l + 3] += k[s + 3];
            bb[l + 3] += k[s + 6];
        }
}

#endif
