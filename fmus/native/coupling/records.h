/* Records that Python shares: fmus/native/records.py, written by python -m fmus.native. */

/* A participant: its functions, its arrays, the cell of its saved state, and its ports. derivative: NULL where it gives
   no derivatives of the step just made; port_stiffness: of a connection that has all columns at once, or NULL. inputs,
   outputs: how many are exchanged. slopes, moments: where slopes of wrenches and moments of rates begin beside the
   rest, 0 for none; links: of its ports. turned: a body's mobility (coordinates, wrenches), a connection's stiffness
   (wrenches, coordinates), of all ports; NULL for a body that never moves. rigid: of a rigid body, whose ports move as
   one, NULL for others: what a wrench at its first port moves (coordinates, wrench), then the negative of what all
   wrenches are there (wrenches, wrench). response: a connection's wrenches on bodies that are rigid or never move, by
   the unknowns of the bodies at its ports, the negative: for each port that moves and each such port (unknowns,
   wrench). */
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

/* How far to go (s): to the end of a run, to the next event that has a time, and after which step to pause. fixed_step
   (s): 0 for none; plan (planned,): sizes to make, NULL where they are chosen. */
typedef struct {
    double until;
    double event_time;
    double pause_time;
    double fixed_step;
    const double *plan;
    size_t planned;
} Request;

/* What steps have come to. time (s) of the participants, size h (s) of the last attempt at a step, and as it was tried
   before anything crossed in it; made, rejected: steps of the last call; crossed: what ended the last step, as a
   number, negative for nothing; lets_go: whether a hold-down does at its end; solved: whether an instant could be
   solved; failure: why something could not be done, and then the participant, its call and its status, or the row of
   the wrench that changes most, by so many tolerances, after so many iterations. */
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
