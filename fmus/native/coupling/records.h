/* Records that Python shares: fmus/native/records.py, written by python -m fmus.native. */

/* A participant: its functions, its arrays, the cell of its saved state, and its ports. derivative: NULL without
   derivatives of the step just made; port_stiffness: returns a connection's stiffness in one call, or NULL. inputs,
   outputs: how many are exchanged. overwrites_state: whether a state may be saved into the cell of another. slopes,
   moments: places of the first slope of a wrench and the first moment of a rate, 0 without; links: those of its ports.
   turned: a body's mobility (coordinates, wrenches), a connection's stiffness (wrenches, coordinates), of all ports, at
   the present orientations; NULL for a body that never moves. rigid: NULL except for a rigid body, whose ports move as
   one: motions by a wrench at its first port (coordinates, wrench), then the negative of the wrench there that each
   wrench amounts to (wrenches, wrench). response: of a connection with rigid bodies or bodies that never move, negative
   derivatives of the wrenches on these by the unknowns of the bodies at its ports: for each port that moves and each
   such port (unknowns, wrench). */
typedef struct {
    void *component;
    SetReal *set_real;
    GetReal *get_real;
    DoStep *do_step;
    GetState *get_state;
    SetState *set_state;
    FreeState *free_state;
    Derivative *derivative;
    PortStiffness *port_stiffness;
    const unsigned *input_references;
    const unsigned *output_references;
    const unsigned *observation_references;
    size_t inputs;
    size_t outputs;
    size_t observations;
    size_t overwrites_state;
    double *input;
    double *output;
    double *observation;
    void **saved;
    size_t ports;
    size_t slopes;
    size_t moments;
    const size_t *links;
    double *turned;
    double *rigid;
    double *response;
} Participant;

/* How far to go (s): to the end of a run, to the next event that has a time, and to the time after which to pause.
   fixed_step (s): 0 without one; plan (planned,): sizes (s) of the next steps, NULL where they are chosen. */
typedef struct {
    double until;
    double event_time;
    double pause_time;
    double fixed_step;
    const double *plan;
    size_t planned;
} Request;

/* What steps have reached. time (s): of the participants; h (s): size of the last attempt at a step; tried (s): the
   same before an event shortened it; made, rejected: steps of the last call; crossed: number of what ended the last
   step, negative for nothing; lets_go: whether a hold-down does at its end; solved: whether an instant could be solved;
   failure: why something failed, then the participant, its call and its status, or the row of the wrench that changes
   most, by so many tolerances, after so many iterations. */
typedef struct {
    double time;
    double h;
    double tried;
    double correction;
    ptrdiff_t crossed;
    size_t made;
    size_t rejected;
    size_t lets_go;
    size_t solved;
    size_t failure;
    size_t participant;
    size_t call;
    size_t worst_row;
    size_t iterations;
    int status;
} Progress;
