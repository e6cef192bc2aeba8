/* How the wrenches of a hinge over a step of order 4 follow from the motion of its ports at the step's end: the chain
   rule through coordinates, moments and loads of the step. Belongs to hinge.c, of the number type with derivatives.

   Wrenches depend on gap and frames of both ports, on the moment of the velocity of B against A, and on the moments of
   both angular velocities: three columns each. */

#ifndef FANFOLD_HINGE_STIFFNESS_H
#define FANFOLD_HINGE_STIFFNESS_H

#ifdef FANFOLD_COMPLEX

#include "columns.h"
#include "hinge_step.h"

enum { BY_GAP = 0, BY_TURN_A = 3, BY_TURN_B = 6, BY_APART = 9, BY_SPIN_A = 12, BY_SPIN_B = 15 };

/* Force, torque and their slopes: LOADS numbers, the first HELD of them means. Rows and columns of a port. */
enum { LOADS = 12, HELD = 6, PORT_COORDINATES = 18, PORT_ROWS = 12 };

int hinge_stiffness(void *self, const double *x, const double *u, double h, size_t ports, double *matrix);

static inline void values_of(Vector3 v, double *values) {
    values[0] = creal(v.x), values[1] = creal(v.y), values[2] = creal(v.z);
}

static inline void slopes_of(Vector3 v, double *slopes, size_t distance) {
    const real parts[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++) slopes[i * distance] = cimag(parts[i]) / FANFOLD_INFINITESIMAL;
}

static inline real seeded_number(real value) { return complex_of(creal(value), FANFOLD_INFINITESIMAL); }

/* A step of the coordinates, and in plain numbers its frames and gaps. frame: from hinge to world axes at its start, at
   its end, the mean; back: their transposes. turn: as turn_between has it. */
typedef struct Stretch {
    Motion end;
    StepMotion motions[COORDINATE_COUNT];
    double frame[3][9], back[3][9], gap[3], gap_mean[3], gap_slope[3], turn[3];
} Stretch;

static inline void frame_of(Quaternion q, double *frame, double *back) {
    real found[9];
    rotation_matrix(q, found);
    for (int i = 0; i < 9; i++) frame[i] = back[i % 3 * 3 + i / 3] = creal(found[i]);
}

static inline void place_frames(const Passage *passage, Stretch *course) {
    frame_of(passage->frame0, course->frame[0], course->back[0]);
    frame_of(passage->frame1, course->frame[1], course->back[1]);
    for (int i = 0; i < 9; i++) {
        course->frame[2][i] = 0.5 * (course->frame[0][i] + course->frame[1][i]);
        course->back[2][i] = 0.5 * (course->back[0][i] + course->back[1][i]);
    }
    values_of(passage->gap1, course->gap);
    values_of(vector_mean(passage->gap0, passage->gap1), course->gap_mean);
    values_of(gap_slope(passage), course->gap_slope);
    values_of(turn_between(passage->frame0, passage->frame1), course->turn);
}

/* How the load of a coordinate follows from the coordinate at the end of the step and from its moment. */
typedef struct Slopes {
    double force[2], slope[2];
} Slopes;

static inline void add_slopes(Slopes *slopes, int k, MeanLoad load) {
    slopes->force[k] += cimag(load.force) / FANFOLD_INFINITESIMAL;
    slopes->slope[k] += cimag(load.slope) / FANFOLD_INFINITESIMAL;
}

/* Beyond clearances, by each of the coordinates that share one: of a load by its own in `bushing`, by the other's in
   `coupled`. */
static inline void differentiate_clearances(const Hinge *hinge, const StepMotion *motions,
                                            Slopes bushing[COORDINATE_COUNT], Slopes coupled[COORDINATE_COUNT]) {
    for (int k = 0; k < hinge->loose; k++) {
        const Clearance *one = hinge->clearances + k;
        for (int n = 0; n < 2 * one->count; n++) {
            const int moved = one->members[n / 2], by_moment = n % 2;
            StepMotion seeded[COORDINATE_COUNT];
            MeanLoad loads[COORDINATE_COUNT];
            memcpy(seeded, motions, sizeof seeded);
            if (by_moment)
                seeded[moved].moment = seeded_number(seeded[moved].moment);
            else
                seeded[moved].end = seeded_number(seeded[moved].end);
            loose_loads(hinge, one, seeded, loads);
            for (int i = 0; i < one->count; i++)
                add_slopes((one->members[i] == moved ? bushing : coupled) + one->members[i], by_moment, loads[one->members[i]]);
        }
    }
}

/* Of the bushing, and about the hinge line of motor, harness, latch and hold. */
static inline void differentiate_loads(const Hinge *hinge, const Grip *grip, const StepMotion *motions,
                                       Slopes bushing[COORDINATE_COUNT], Slopes *drives) {
    for (int i = 0; i < 2 * COORDINATE_COUNT; i++) {
        const int coordinate = i / 2, by_moment = i % 2;
        StepMotion motion = motions[coordinate];
        if (by_moment)
            motion.moment = seeded_number(motion.moment);
        else
            motion.end = seeded_number(motion.end);
        if (coordinate == HINGE_ANGLE) {
            add_slopes(drives, by_moment, drive_load(hinge, &hinge->motor, &motion));
            add_slopes(drives, by_moment, drive_load(hinge, &hinge->harness, &motion));
            if (latch_acts(hinge, grip)) add_slopes(drives, by_moment, mean_latch_load(hinge, grip, motion));
            motion = shifted_motion(motion, hinge->base.p[P_ALIGNED_ANGLE]);
        }
        add_slopes(bushing + coordinate, by_moment, stiff_load(hinge, coordinate, &motion));
    }
    if (grip->holding != 0.0) drives->force[0] -= hinge->base.p[P_HOLD_STIFFNESS];
}

/* Adds what friction changes in the torque about the hinge line and in its slope, as one of the numbers that it follows
   from moves, which has been seeded. */
static inline void add_friction_by(const Hinge *hinge, const Grip *grip, const StiffLoads *stiff, const StepMotion *turn,
                                   const double *moved, double *twist, double *twist_slope) {
    const Presliding friction = step_friction(hinge, grip, stiff, turn);
    const double mean = cimag(friction.force) / FANFOLD_INFINITESIMAL;
    const double slope = cimag(friction.slope) / FANFOLD_INFINITESIMAL;
    for (int j = 0; j < COLUMNS && (mean != 0.0 || slope != 0.0); j++) {
        twist[j] += mean * moved[j];
        twist_slope[j] += slope * moved[j];
    }
}

/* The same as loads of the bushing, `mean` and their slopes `sloped`, and the angle with its moment move. */
static inline void add_friction(const Hinge *hinge, const Grip *grip, const StiffLoads *stiff, const StepMotion *turn,
                                const double *const mean[COORDINATE_COUNT], const double *const sloped[COORDINATE_COUNT],
                                const double *angle, const double *moment, double *twist, double *twist_slope) {
    StepMotion by_end = *turn, by_moment = *turn;
    by_end.end = seeded_number(turn->end);
    by_moment.moment = seeded_number(turn->moment);
    add_friction_by(hinge, grip, stiff, &by_end, angle, twist, twist_slope);
    add_friction_by(hinge, grip, stiff, &by_moment, moment, twist, twist_slope);
    if (hinge->base.p[P_FRICTION_COEFFICIENT] == 0.0) return;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        if (i == HINGE_ANGLE) continue; /* the load about the hinge line itself does not press */
        StiffLoads by_force = *stiff, by_slope = *stiff;
        by_force.bushing[i].force = seeded_number(stiff->bushing[i].force);
        by_slope.bushing[i].slope = seeded_number(stiff->bushing[i].slope);
        add_friction_by(hinge, grip, &by_force, turn, mean[i], twist, twist_slope);
        add_friction_by(hinge, grip, &by_slope, turn, sloped[i], twist, twist_slope);
    }
}

/* Torque by the loads of twist and swing (9), at a swing, and by the swing itself for given loads (9, without twist). */
static inline void differentiate_torque(Transverse swing, const real load[3], double *by_load, double *by_swing) {
    for (int k = 0; k < 3; k++) {
        Vector3 torque = conjugate_torque(k == 0, (Transverse){k == 1, k == 2}, swing);
        double values[3];
        values_of(torque, values);
        for (int i = 0; i < 3; i++) by_load[3 * i + k] = values[i];
    }
    for (int k = 1; k < 3; k++) {
        const Transverse seeds = {k == 1 ? seeded_number(swing.y) : swing.y, k == 2 ? seeded_number(swing.z) : swing.z};
        slopes_of(conjugate_torque(load[0], (Transverse){load[1], load[2]}, seeds), by_swing + k, 3);
    }
}

/* By how much forces and torques, and their slopes, change as coordinates and moments move: offset and rotation of each. */
static inline void move_loads(const Hinge *hinge, const Grip *grip, const StepMotion *motions, const StiffLoads *stiff,
                              Transverse swing, const real about_line[2], const Columns moved[4], Columns change[4]) {
    Slopes bushing[COORDINATE_COUNT] = {{{0.0}, {0.0}}}, coupled[COORDINATE_COUNT] = {{{0.0}, {0.0}}};
    Slopes drives = {{0.0}, {0.0}};
    Columns rotations[2] = {{{{0.0}}}};
    const double *mean[COORDINATE_COUNT], *sloped[COORDINATE_COUNT];
    differentiate_loads(hinge, grip, motions, bushing, &drives);
    differentiate_clearances(hinge, motions, bushing, coupled);
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        const double *by_end = moved[i / 3].row[i % 3], *by_moment = moved[2 + i / 3].row[i % 3];
        double *force = (i < 3 ? change : rotations)->row[i % 3], *slope = (i < 3 ? change + 2 : rotations + 1)->row[i % 3];
        for (int j = 0; j < COLUMNS; j++) {
            force[j] = bushing[i].force[0] * by_end[j] + bushing[i].force[1] * by_moment[j];
            slope[j] = bushing[i].slope[0] * by_end[j] + bushing[i].slope[1] * by_moment[j];
        }
        mean[i] = force;
        sloped[i] = slope;
    }
    for (int k = 0; k < hinge->loose; k++) {
        const int *members = hinge->clearances[k].members;
        for (int n = 0; hinge->clearances[k].count > 1 && n < 2; n++) {
            const int i = members[n], other = members[1 - n];
            const double *by_end = moved[other / 3].row[other % 3], *by_moment = moved[2 + other / 3].row[other % 3];
            double *force = (i < 3 ? change : rotations)->row[i % 3], *slope = (i < 3 ? change + 2 : rotations + 1)->row[i % 3];
            for (int j = 0; j < COLUMNS; j++) {
                force[j] += coupled[i].force[0] * by_end[j] + coupled[i].force[1] * by_moment[j];
                slope[j] += coupled[i].slope[0] * by_end[j] + coupled[i].slope[1] * by_moment[j];
            }
        }
    }
    const double *angle = moved[1].row[0], *moment = moved[3].row[0];
    double twist[COLUMNS], twist_slope[COLUMNS];
    memcpy(twist, rotations[0].row[0], sizeof twist);
    memcpy(twist_slope, rotations[1].row[0], sizeof twist_slope);
    add_friction(hinge, grip, stiff, motions + HINGE_ANGLE, mean, sloped, angle, moment, twist, twist_slope);
    for (int j = 0; j < COLUMNS; j++) {
        rotations[0].row[0][j] = twist[j] + drives.force[0] * angle[j] + drives.force[1] * moment[j];
        rotations[1].row[0][j] = twist_slope[j] + drives.slope[0] * angle[j] + drives.slope[1] * moment[j];
    }
    for (int k = 0; k < 2; k++) {
        const MeanLoad *y = stiff->bushing + 4, *z = stiff->bushing + 5;
        const real load[3] = {about_line[k], k ? y->slope : y->force, k ? z->slope : z->force};
        double by_load[9], by_swing[9] = {0.0};
        differentiate_torque(swing, load, by_load, by_swing);
        columns_add_product(change + 2 * k + 1, 1.0, by_load, rotations + k);
        columns_add_product(change + 2 * k + 1, 0.5, by_swing, moved + 1);
    }
}

/* Rates of twist and swing by angular velocities in hinge axes (9), at a swing. */
static inline void differentiate_rates(Transverse swing, double *by_spin) {
    const Vector3 none = {0.0, 0.0, 0.0}, units[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int k = 0; k < 3; k++) {
        Rates rates = rates_of(none, units[k], swing);
        const real parts[3] = {rates.twist, rates.swing.y, rates.swing.z};
        for (int i = 0; i < 3; i++) by_spin[3 * i + k] = creal(parts[i]);
    }
}

/* By how much coordinates move; those at the end, where only the pose counts. */
static inline void move_coordinates(const Stretch *course, const Columns *turn_a, Columns *offset, Columns *twist) {
    double by_spin[9];
    Columns apart = columns_of_unit(BY_GAP), spin = columns_of_unit(BY_TURN_B), turned = {{{0.0}}};
    const Transverse swing = {course->end.coordinates[4], course->end.coordinates[5]};
    differentiate_rates(swing, by_spin);
    columns_add_cross(&apart, 1.0, course->gap, turn_a);
    columns_add(&spin, -1.0, turn_a);
    columns_add_product(offset, 1.0, course->back[1], &apart);
    columns_add_product(&turned, 1.0, course->back[1], &spin);
    columns_add_product(twist, 1.0, by_spin, &turned);
}

/* A vector held in world axes seen from the mean axes of the step, as these turn on with A. */
static inline void turn_back(Columns *to, const Stretch *course, const double v[3], const Columns *turn_a) {
    Columns turned = {{{0.0}}};
    columns_add_cross(&turned, 0.5, v, turn_a);
    columns_add_product(to, 1.0, course->back[1], &turned);
}

/* By how much what carries B along with A over the step changes its moment of velocity. */
static inline void move_carried(const Stretch *course, const double spin_a[3], const Columns *turn_a, Columns *carried) {
    const Columns gap = columns_of_unit(BY_GAP), by_spin = columns_of_unit(BY_SPIN_A);
    double half[3], dyad[9];
    Columns turning = *turn_a;
    for (int i = 0; i < 3; i++) half[i] = 0.5 * course->turn[i];
    for (int i = 0; i < 9; i++) dyad[i] = half[i / 3] * half[i % 3];
    columns_add_cross(&turning, -1.0, half, turn_a);
    columns_add_product(&turning, 1.0, dyad, turn_a);
    columns_add_cross(carried, -1.0, course->gap_mean, &by_spin);
    columns_add_cross(carried, 0.5, spin_a, &gap);
    columns_add_cross(carried, -1.0, course->gap_slope, &turning);
    columns_add_cross(carried, 1.0 / 6.0, course->turn, &gap);
}

/* By how much moments of the coordinates move; `moments` are those of both ports, `twist` how the coordinates do. */
static inline void move_moments(const Stretch *course, const Passage *passage, const double *moments, Transverse swing,
                                const Columns *turn_a, const Columns *twist, Columns *offset, Columns *spin) {
    const double apart[3] = {moments[6] - moments[0], moments[7] - moments[1], moments[8] - moments[2]};
    const double relative[3] = {moments[9] - moments[3], moments[10] - moments[4], moments[11] - moments[5]};
    const double *spin_a = moments + 3;
    double left[3], by_spin[9], by_swing[9] = {0.0};
    Columns by_apart = columns_of_unit(BY_APART), by_turns = columns_of_unit(BY_SPIN_B), seen = {{{0.0}}};
    const Columns by_spin_a = columns_of_unit(BY_SPIN_A);
    real given[12];
    Vector3 velocity, turning;
    for (int i = 0; i < 12; i++) given[i] = moments[i];
    relative_moments(passage, given, &velocity, &turning);
    for (int i = 0; i < 3; i++) {
        const int a = (i + 1) % 3, b = (i + 2) % 3;
        left[i] = apart[i] - (spin_a[a] * course->gap_mean[b] - spin_a[b] * course->gap_mean[a]) -
                  (course->turn[a] * course->gap_slope[b] - course->turn[b] * course->gap_slope[a]);
    }
    Columns carried = {{{0.0}}};
    move_carried(course, spin_a, turn_a, &carried);
    columns_add(&by_apart, -1.0, &carried);
    turn_back(offset, course, left, turn_a);
    columns_add_product(offset, 1.0, course->back[2], &by_apart);
    columns_add(&by_turns, -1.0, &by_spin_a);
    turn_back(&seen, course, relative, turn_a);
    columns_add_product(&seen, 1.0, course->back[2], &by_turns);
    differentiate_rates(swing, by_spin);
    columns_add_product(spin, 1.0, by_spin, &seen);
    for (int k = 1; k < 3; k++) { /* the swing is the one of mid-step */
        const Transverse seeds = {k == 1 ? seeded_number(swing.y) : swing.y, k == 2 ? seeded_number(swing.z) : swing.z};
        Rates rates = rates_of(velocity, turning, seeds);
        slopes_of((Vector3){rates.twist, rates.swing.y, rates.swing.z}, by_swing + k, 3);
    }
    columns_add_product(spin, 0.5, by_swing, twist);
}

/* Loads (hinge axes) as their mean in world axes. */
static inline Columns in_world(const Stretch *course, const double load[3], const Columns *change,
                               const Columns *turn_a) {
    Columns found = {{{0.0}}};
    double turned[3];
    columns_add_product(&found, 1.0, course->frame[2], change);
    for (int i = 0; i < 3; i++) {
        const double *row = course->frame[1] + 3 * i;
        turned[i] = row[0] * load[0] + row[1] * load[1] + row[2] * load[2];
    }
    columns_add_cross(&found, -0.5, turned, turn_a);
    return found;
}

static inline void mean_in_world(const Stretch *course, const double load[3], double world[3]) {
    for (int i = 0; i < 3; i++) {
        const double *row = course->frame[2] + 3 * i;
        world[i] = row[0] * load[0] + row[1] * load[1] + row[2] * load[2];
    }
}

/* Writes three rows of a port's wrench, times a factor, in the columns of both ports' coordinates. */
static inline void write_rows(const Columns *c, double factor, double *rows) {
    for (int i = 0; i < 3; i++, rows += 2 * PORT_COORDINATES) {
        const double *from = c->row[i];
        for (int j = 0; j < 3; j++) {
            rows[j] = -factor * from[BY_GAP + j];
            rows[3 + j] = factor * from[BY_TURN_A + j];
            rows[6 + j] = -factor * from[BY_APART + j];
            rows[9 + j] = factor * from[BY_SPIN_A + j];
            rows[18 + j] = factor * from[BY_GAP + j];
            rows[21 + j] = factor * from[BY_TURN_B + j];
            rows[24 + j] = factor * from[BY_APART + j];
            rows[27 + j] = factor * from[BY_SPIN_B + j];
            rows[12 + j] = rows[15 + j] = rows[30 + j] = rows[33 + j] = 0.0;
        }
    }
}

/* From loads in hinge axes, as they change, to the wrenches of both ports. */
static inline void write_wrenches(const Stretch *course, const double *loads, const Columns change[4],
                                  const Columns *turn_a, double *matrix) {
    const Columns gap = columns_of_unit(BY_GAP);
    const size_t three = 3 * 2 * PORT_COORDINATES;
    double *a = matrix, *b = matrix + PORT_ROWS * 2 * PORT_COORDINATES, force[2][3];
    Columns world[4];
    for (int i = 0; i < 4; i++) world[i] = in_world(course, loads + 3 * i, change + i, turn_a);
    for (int i = 0; i < 2; i++) mean_in_world(course, loads + HELD * i, force[i]);
    for (int i = 0; i < 2; i++) { /* means, then slopes */
        Columns moment = world[2 * i + 1];
        columns_add_cross(&moment, 1.0, course->gap_mean, world + 2 * i);
        columns_add_cross(&moment, -0.5, force[i], &gap);
        if (i == 0) {
            columns_add_cross(&moment, 1.0, course->gap_slope, world + 2);
            columns_add_cross(&moment, -1.0 / 6.0, force[1], &gap);
        }
        write_rows(world + 2 * i, -1.0, a + 2 * three * i);
        write_rows(&moment, -1.0, a + 2 * three * i + three);
        write_rows(world + 2 * i, 1.0, b + 2 * three * i);
        write_rows(world + 2 * i + 1, 1.0, b + 2 * three * i + three);
    }
}

int hinge_stiffness(void *self, const double *x, const double *u, double h, size_t ports, double *matrix) {
    const Hinge *hinge = self;
    const double *q = x + X_FRAME, *gap = x + X_GAP;
    real given[INPUTS + MOMENTS];
    for (int i = 0; i < INPUTS + MOMENTS; i++) given[i] = u[i];
    if (ports != 2 || !hinge->base.paired || commanded(given, U_IMPULSE)) return 0;
    Grip grip = commanded_grip(hinge, x, given);
    if (grip.failed) {
        memset(matrix, 0, 2 * PORT_ROWS * 2 * PORT_COORDINATES * sizeof *matrix);
        return 1;
    }
    Stretch course = {.end = hinge_motion(hinge, given, x[X_COORDINATES + HINGE_ANGLE])};
    Passage passage = {{q[0], q[1], q[2], q[3]}, course.end.frame, {gap[0], gap[1], gap[2]}, course.end.gap};
    step_motions(hinge, x, given, &course.end, &passage, h, course.motions);
    place_frames(&passage, &course);
    const StiffLoads stiff = stiff_loads(hinge, &grip, course.motions);
    const Loads loads = mean_loads(hinge, x, &grip, &course.end, course.motions, &stiff);
    const Transverse swing = mean_swing(x, &course.end);
    const Columns turn_a = columns_of_unit(BY_TURN_A);
    Columns moved[4] = {{{{0.0}}}}, change[4] = {{{{0.0}}}};
    move_coordinates(&course, &turn_a, moved, moved + 1);
    move_moments(&course, &passage, u + INPUTS, swing, &turn_a, moved + 1, moved + 2, moved + 3);
    move_loads(hinge, &grip, course.motions, &stiff, swing, loads.about_line, moved, change);
    const Vector3 parts[4] = {loads.force, loads.torque, loads.force_slope, loads.torque_slope};
    double values[LOADS];
    for (int i = 0; i < 4; i++) values_of(parts[i], values + 3 * i);
    write_wrenches(&course, values, change, &turn_a, matrix);
    return 1;
}

#endif
#endif
