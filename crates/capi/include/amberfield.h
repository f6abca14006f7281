/* The C library of amberfield. Written by cbindgen from crates/capi: `cargo xtask header`. */

#ifndef AMBERFIELD_H
#define AMBERFIELD_H

#include <stddef.h>
#include <stdint.h>

// Outcome of a call.
typedef enum AmberfieldStatus {
  // Done.
  AmberfieldStatus_Ok = 0,
  // The run is over: close and leave.
  AmberfieldStatus_Over = 1,
  // Failure: amberfield_field_error or amberfield_host_error says why.
  AmberfieldStatus_Failed = 2,
  // Failure of this rank alone, of those that share a field: others may wait for it. End the program.
  AmberfieldStatus_Broken = 3,
} AmberfieldStatus;

// Kind of question of the DEM process.
typedef enum AmberfieldQuestion {
  // The far field: call density, boundary, guess, then reply.
  AmberfieldQuestion_Field = 0,
  // The flow at the end of an interval: call grains, then reply_flow.
  AmberfieldQuestion_Flow = 1,
  // The state of the flow: call reply_state.
  AmberfieldQuestion_State = 2,
  // A state of the flow to take in: call state, then reply_state with no number.
  AmberfieldQuestion_Restore = 3,
  // The potentials of patches that change, at some times: call times, then reply_potentials.
  AmberfieldQuestion_Potentials = 4,
} AmberfieldQuestion;

// Condition on a face of the box.
typedef enum AmberfieldBoundary {
  // A conductor at V = 0.
  AmberfieldBoundary_Grounded = 0,
  // A conductor at the potential `value` [V].
  AmberfieldBoundary_Potential = 1,
  // A surface with the outward normal field `value` [V/m]; 0 is an insulator.
  AmberfieldBoundary_NormalField = 2,
  // Joined to the opposite face.
  AmberfieldBoundary_Periodic = 3,
  // Free space beyond.
  AmberfieldBoundary_Open = 4,
} AmberfieldBoundary;

// One rank of a field process.
typedef struct AmberfieldField AmberfieldField;

// The field of a host program's particles.
//
// A code that runs under MPI opens it with amberfield_host_open_over_ranks; each rank then gives its own
// particles, and gets their field. One handle for the whole run keeps parameters, memory and a solver's warm
// start. Call it every so many steps and keep E in between.
typedef struct AmberfieldHost AmberfieldHost;

// Stands in the run's memory for a rank on another machine.
typedef struct AmberfieldProxy AmberfieldProxy;

// Box and periodic axes of the mesh of all ranks, and where the cells of one rank are among them.
typedef struct AmberfieldMeshOutline {
  // Lower corner of the cells of all ranks [m].
  double low_m[3];
  // Upper corner of the cells of all ranks [m].
  double high_m[3];
  // 1 for every axis that cyclic patches join.
  uint64_t periodic[3];
  // Number of cells of lower ranks, which is the number of this rank's first cell.
  uint64_t first_cell;
  // Number of cells of all ranks.
  uint64_t all_cells;
} AmberfieldMeshOutline;

// Face on the boundary of one rank's cells, and the condition there.
typedef struct AmberfieldBoundaryFace {
  // Centre [m].
  double centre_m[3];
  // Unit normal out of the mesh.
  double normal[3];
  // Area [m^2].
  double area_m2;
  // Cell of this rank that the face belongs to.
  uint64_t cell;
  // Patch that the face belongs to, by its place among all patches.
  uint64_t patch;
  // 1: the potential is prescribed; 0: its outward slope is.
  uint64_t is_conductor;
  // Prescribed potential [V] or outward slope [V/m].
  double prescribed;
  // Mean over the corners of (x - x of the centre)^2 [m^2].
  double spread_xx_m2;
  // Mean over the corners of (x - x of the centre)(y - y of the centre) [m^2].
  double spread_xy_m2;
  // Mean over the corners of (x - x of the centre)(z - z of the centre) [m^2].
  double spread_xz_m2;
  // Mean over the corners of (y - y of the centre)^2 [m^2].
  double spread_yy_m2;
  // Mean over the corners of (y - y of the centre)(z - z of the centre) [m^2].
  double spread_yz_m2;
  // Mean over the corners of (z - z of the centre)^2 [m^2].
  double spread_zz_m2;
} AmberfieldBoundaryFace;

// Mesh of one rank of a field process. Vectors are three doubles each; lengths in m.
typedef struct AmberfieldMesh {
  // Box of all ranks' cells, periodic axes, and where this rank's cells are among all.
  struct AmberfieldMeshOutline outline;
  // Boundary faces of lower ranks.
  uint64_t first_boundary;
  // Cells of this rank.
  uint64_t cells;
  // Entries of the arrays by face: every inner face once for each of its cells.
  uint64_t faces;
  // Boundary faces of this rank.
  uint64_t boundary;
  // Corners of this rank's boundary faces; one that faces share counts once for each.
  uint64_t corners;
  // Cell centres.
  const double *centres;
  // Cell volumes.
  const double *volumes;
  // Place of each cell's first face in the arrays by face, and at last the number of their entries.
  const uint64_t *first_face;
  // Unit normals out of the cell.
  const double *face_normals;
  // Scalar products of normals and face centres.
  const double *face_offsets;
  // Neighbours beyond the faces: cell c of all ranks as c, boundary face b of this rank as -1 - b.
  const int64_t *face_neighbours;
  // Vectors to add to the neighbours' coordinates; 0 unless the face is cyclic.
  const double *face_shifts;
  // Boundary faces of this rank, with the conditions there.
  const struct AmberfieldBoundaryFace *boundary_faces;
  // Place of each boundary face's first corner, and at last the number of corners.
  const uint64_t *first_corner;
  // Corners of the boundary faces, in order around each, right-handed about its normal.
  const double *corner_points;
  // Patches of the mesh: lines of a name, a blank and a type; the same for all ranks.
  const char *patches;
  // Patches whose potential changes with time, by their lines among the patches; the same for all ranks.
  // The conditions of their faces say 0 V.
  const uint64_t *changing_patches;
  // Number of these patches.
  uint64_t changing_count;
  // Corners of this rank's faces, each once; NULL unless a gas flows between grains.
  const double *points;
  // Number of these points, or 0.
  uint64_t point_count;
  // Place of the first corner of each entry of the arrays by face, and at last the number of corners; NULL
  // without points.
  const uint64_t *first_face_corner;
  // Corners of the faces in order around each, either way, as places among the points; NULL without any.
  const uint32_t *face_corners;
} AmberfieldMesh;

// Cloud of charge that stands for a grain in the far part of the field.
//
// A Kaiser-Bessel cloud of a radius and a shape, or, with the radius 0, the grain's charge spread over the
// cell that the grain is in.
typedef struct AmberfieldSourceCloud {
  // Radius at which the cloud ends [m]; 0: the charge is spread over its cell.
  double radius_m;
  // Shape of the Kaiser-Bessel cloud, a number; 0 where the radius is 0.
  double shape;
} AmberfieldSourceCloud;

// Scalars of the question for the far part of a field.
//
// The question is for the solution of div(grad(potential)) = -density/permittivity, where the density is
// that of the clouds. Charges, their positions and the values on the boundary are arrays beside it.
typedef struct AmberfieldFarQuestion {
  // Cloud that every charge is.
  struct AmberfieldSourceCloud cloud;
  // Absolute permittivity of the medium [F/m].
  double permittivity_f_m;
  // 1: the mean density is taken off where no face prescribes the potential; 0: it is not.
  uint64_t neutralising_background;
  // Time at which the charges are where they are [s].
  double time_s;
  // Relative tolerance of the linear solver; 0: the solver's own.
  double tolerance;
  // 1: E at the cells' centres is wanted; 0: the potential alone.
  uint64_t wants_e;
} AmberfieldFarQuestion;

// Scalars of the question for the flow of a gas at the end of an interval.
typedef struct AmberfieldFlowQuestion {
  // Length of the interval [s]; 0: the flow as it is, nothing moves.
  double interval_s;
  // Time at which the interval begins [s].
  double time_s;
  // Density of the gas [kg/m^3].
  double density_kg_m3;
  // Viscosity of the gas [Pa s].
  double viscosity_pa_s;
  // 1: the pressure acts on the gas alone (model B); 0: on gas and grains (model A).
  uint64_t model_b;
  // 1: the divergence of the viscous stress is wanted.
  uint64_t viscous_force;
  // 1: the vorticity is wanted.
  uint64_t vorticity;
} AmberfieldFlowQuestion;

// Question of the DEM process, with the scalars that belong to it.
typedef struct AmberfieldRequest {
  // Kind of question.
  enum AmberfieldQuestion question;
  // Number of the solve.
  uint64_t solve;
  // Number of times of the question for potentials that change; 0 for other questions.
  uint64_t times;
  // The question for the far field; all 0 unless that is what is asked.
  struct AmberfieldFarQuestion far;
  // The question for the flow; all 0 unless that is what is asked.
  struct AmberfieldFlowQuestion flow;
} AmberfieldRequest;

// The far field at this rank's cell centres, and how it was found.
typedef struct AmberfieldFar {
  // Number of this rank's cells.
  uint64_t cells;
  // Potential [V].
  const double *potential;
  // Electric field [V/m], three doubles each.
  const double *e;
  // Iterations of the linear solver.
  uint64_t iterations;
  // Final residual of the linear solver, relative.
  double residual;
  // Time that the linear solver took [s].
  double seconds;
} AmberfieldFar;

// Numbers that a rank answers beside the flow at its cells.
typedef struct AmberfieldFlowAnswer {
  // Iterations of the linear solver for the pressure.
  uint64_t iterations;
  // Error of continuity: RMS over the cells of d(void fraction)/dt + div(void fraction * velocity),
  // times the interval.
  double residual;
  // Time that the solver took [s].
  double seconds;
  // Steps of the flow in the interval.
  uint64_t steps;
  // Largest Courant number of a step.
  double courant;
} AmberfieldFlowAnswer;

// The flow at this rank's cell centres. Vectors are three doubles each.
typedef struct AmberfieldFlow {
  // Number of this rank's cells.
  uint64_t cells;
  // Velocity of the gas [m/s].
  const double *velocity;
  // Gradient of the pressure without the gas's own weight [Pa/m].
  const double *pressure_gradient;
  // Divergence of the viscous stress [N/m^3], or NULL where it is not wanted.
  const double *viscous_force;
  // Vorticity [1/s], or NULL where it is not wanted.
  const double *vorticity;
  // Iterations, residual, time, steps and Courant number of the solver.
  struct AmberfieldFlowAnswer answer;
  // Advice about the case for its mesh, to be shown to the user; NULL for nothing.
  const char *advice;
} AmberfieldFlow;

// Message as bytes, which are valid until the next call on the handle that they come from.
typedef struct AmberfieldLetter {
  // The bytes.
  const uint8_t *bytes;
  // Number of bytes; 0: no message.
  uint64_t count;
} AmberfieldLetter;

// Face of the box, with the condition there.
typedef struct AmberfieldFace {
  // Condition, a value of AmberfieldBoundary.
  uint64_t boundary;
  // Potential [V] or outward normal field [V/m]; 0 for other conditions.
  double value;
} AmberfieldFace;

// Settings of a host program; the method is p3m, units are SI. Set all to zero, then what differs.
typedef struct AmberfieldHostSettings {
  // Lower corner of the box [m].
  double low[3];
  // Upper corner [m].
  double high[3];
  // Faces in the order x low, x high, y low, ...; with an OpenFOAM case its box and its patches count
  // instead.
  struct AmberfieldFace faces[6];
  // Relative RMS error of E; 0: 1e-2.
  double tolerance;
  // Relative permittivity; 0: 1.
  double relative_permittivity;
  // 1: a net charge that no face takes is balanced by a uniform background.
  uint64_t neutralising_background;
  // 1: parameters by the cost model, the same on every machine; 0: by timing candidates once.
  uint64_t model_tuning;
  // Folder of an OpenFOAM case, whose mesh and conditions count, or NULL: the internal grid.
  const char *openfoam_case;
  // 1: wait for a solver that somebody else starts (electricFieldFoam without -run finds it); 0: start it.
  uint64_t wait_for_solver;
  // Processes of the solver; 0: 1.
  uint64_t ranks;
  // Time that an answer of the solver may take [s]; 0: 30.
  double timeout;
  // Threads that the library uses; 0: one for each core that this process may use.
  uint64_t threads;
} AmberfieldHostSettings;

// Sends `sent_counts[k]` numbers to every rank k and receives `received_counts[k]` from it; both lie side by
// side in the order of the ranks. MPI_Alltoallv does this. Returns 0, or anything else on failure.
typedef int32_t (*AmberfieldExchange)(void *context,
                                      const double *sent,
                                      const uint64_t *sent_counts,
                                      double *received,
                                      const uint64_t *received_counts);

// Replaces `count` numbers by their sums over the ranks, to the same bits on all of them. MPI_Allreduce does
// this. Returns 0, or anything else on failure.
typedef int32_t (*AmberfieldSum)(void *context, double *values, uint64_t count);

// Functions of a host program by which its ranks exchange numbers. Every rank opens the field with its own
// table, and calls the same functions of the library in the same order. The functions are called in the
// thread that calls the library.
typedef struct AmberfieldRanks {
  // Number of this rank, from 0.
  uint64_t rank;
  // Number of ranks.
  uint64_t count;
  // First argument of the functions.
  void *context;
  // Exchange of numbers.
  AmberfieldExchange exchange;
  // Sums of numbers.
  AmberfieldSum sum;
} AmberfieldRanks;

// Contact whose area grows, of two grains or of a grain with a wall.
typedef struct AmberfieldContact {
  // Charges of the grains [C]; of a wall none is read.
  double charge[2];
  // Radii of the grains [m]; of a wall none is read.
  double radius[2];
  // Work functions [eV].
  double work_function_ev[2];
  // Cut-off distance of the transfer [m].
  double cutoff;
  // Relative permittivity of the medium.
  double relative_permittivity;
  // Field at the contact of everything but the two bodies, and at a wall but the grain's image, along the
  // normal from the first to the second [V/m].
  double normal_field;
  // Growth of the contact's area [m^2].
  double growth;
  // Field at which the medium breaks down [V/m]; 0: it never does.
  double breakdown;
} AmberfieldContact;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Opens a run by its name, for one rank of so many; an empty name is the one run of this user that waits for
// a solver. The result is never NULL; amberfield_field_error is empty when it worked.
//
// # Safety
// `run` is a C string.
struct AmberfieldField *amberfield_field_open(const char *run, uint32_t rank, uint32_t ranks);

// Returns the reason why the last call on a handle failed; empty if it did not. The text is valid until the
// next call.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed.
const char *amberfield_field_error(const struct AmberfieldField *field);

// Sends this rank's part of the mesh, once, before anything is waited for.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; the mesh's arrays have the lengths that it
// says, and its patches are a C string.
enum AmberfieldStatus amberfield_field_send_mesh(struct AmberfieldField *field,
                                                 const struct AmberfieldMesh *mesh);

// Waits for the next question; AmberfieldStatus_Over when there will be none.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `request` may be written.
enum AmberfieldStatus amberfield_field_wait(struct AmberfieldField *field, struct AmberfieldRequest *request);

// Writes the charge density [C/m^3] at this rank's cell centres. Of charges that are spread over their cells
// it takes the cells down too, which the reply then names.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `density` has room for `cells` numbers, this
// rank's cells.
enum AmberfieldStatus amberfield_field_density(struct AmberfieldField *field,
                                               double *density,
                                               uint64_t cells);

// Copies the boundary data of this rank's faces: potentials [V] or outward slopes [V/m], by the face's kind.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `values` has room for `faces` numbers.
enum AmberfieldStatus amberfield_field_boundary(struct AmberfieldField *field,
                                                double *values,
                                                uint64_t faces);

// Copies the potential [V] to start from to this rank's cells. Where the question has none, which is the
// usual case, the array stays as it is.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `potential` has room for `cells` numbers, this
// rank's cells.
enum AmberfieldStatus amberfield_field_guess(struct AmberfieldField *field,
                                             double *potential,
                                             uint64_t cells);

// Answers the question for the far field.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; the arrays of `far` have as many entries as it
// has cells.
enum AmberfieldStatus amberfield_field_reply(struct AmberfieldField *field, const struct AmberfieldFar *far);

// Tells the DEM process why this one cannot go on.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `reason` is a C string.
void amberfield_field_fail(struct AmberfieldField *field, const char *reason);

// Tells the DEM process what is wrong with the case or the scene: its run ends as with any bad input.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `reason` is a C string.
void amberfield_field_refuse(struct AmberfieldField *field, const char *reason);

// Closes a handle of the field side. NULL is allowed.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; the handle is gone afterwards.
void amberfield_field_close(struct AmberfieldField *field);

// Copies what the grains do to the gas in this rank's cells: void fraction, drag [kg/(m^3 s)] and source
// [N/m^3] (three doubles each). The gas feels source - drag * velocity.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; the arrays have room for `cells` entries, this
// rank's cells.
enum AmberfieldStatus amberfield_field_grains(struct AmberfieldField *field,
                                              double *void_fraction,
                                              double *drag,
                                              double *source,
                                              uint64_t cells);

// Answers the question for the flow at the end of an interval.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; the flow's arrays have the lengths that it
// says, and its advice is a C string or NULL.
enum AmberfieldStatus amberfield_field_reply_flow(struct AmberfieldField *field,
                                                  const struct AmberfieldFlow *flow);

// Answers the question for the state of this rank's part of the flow with `count` numbers, whose meaning is
// the solver's own. After a state was taken in the answer has no number.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `state` has `count` numbers.
enum AmberfieldStatus amberfield_field_reply_state(struct AmberfieldField *field,
                                                   const double *state,
                                                   uint64_t count);

// Copies the state that this rank is to take in: as many numbers as it once answered with.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `state` has room for `count` numbers.
enum AmberfieldStatus amberfield_field_state(struct AmberfieldField *field, double *state, uint64_t count);

// Returns 1 if this machine has the memory of a run of this name, else 0.
//
// # Safety
// `run` is a C string.
uint32_t amberfield_run_is_here(const char *run);

// Returns the name of the run that a handle has open; empty if none is, or the machine is another than the
// run's. The text is valid as long as the handle.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed.
const char *amberfield_field_run(const struct AmberfieldField *field);

// Opens one rank of so many on a machine that has not the memory of the run. All calls are as on any other
// rank, but for two: what amberfield_field_letter gives after a call goes to the rank's proxy, and what the
// proxy gives is delivered before amberfield_field_wait, which then does not wait. The result is never NULL;
// amberfield_field_error is empty when it worked.
//
// # Safety
// `run` is a C string.
struct AmberfieldField *amberfield_field_open_distant(const char *run, uint32_t rank, uint32_t ranks);

// Gives the letter that the last call has left for the rank's proxy; none on a rank that needs no proxy.
//
// # Safety
// `field` comes from amberfield_field_open_distant and is not closed; `letter` may be written.
enum AmberfieldStatus amberfield_field_letter(struct AmberfieldField *field, struct AmberfieldLetter *letter);

// Takes in a letter of the rank's proxy, before amberfield_field_wait.
//
// # Safety
// `field` comes from amberfield_field_open_distant and is not closed; `bytes` has `count` of them.
enum AmberfieldStatus amberfield_field_deliver(struct AmberfieldField *field,
                                               const uint8_t *bytes,
                                               uint64_t count);

// Opens the proxy of a rank on another machine, on one that has the run's memory. The result is never NULL;
// amberfield_proxy_error is empty when it worked.
//
// # Safety
// `run` is a C string.
struct AmberfieldProxy *amberfield_proxy_open(const char *run, uint32_t rank, uint32_t ranks);

// Returns the reason why the last call on a proxy failed; empty if it did not. The text is valid until the
// next call.
//
// # Safety
// `proxy` comes from amberfield_proxy_open and is not closed.
const char *amberfield_proxy_error(const struct AmberfieldProxy *proxy);

// Sends a letter of the rank's to the DEM process.
//
// # Safety
// `proxy` comes from amberfield_proxy_open and is not closed; `bytes` has `count` of them.
enum AmberfieldStatus amberfield_proxy_send(struct AmberfieldProxy *proxy,
                                            const uint8_t *bytes,
                                            uint64_t count);

// Waits for the next question of the DEM process and gives the rank's share of it, for
// amberfield_field_deliver there; AmberfieldStatus_Over when there will be none.
//
// # Safety
// `proxy` comes from amberfield_proxy_open and is not closed; `letter` may be written.
enum AmberfieldStatus amberfield_proxy_wait(struct AmberfieldProxy *proxy, struct AmberfieldLetter *letter);

// Closes a proxy. NULL is allowed.
//
// # Safety
// `proxy` comes from amberfield_proxy_open and is not closed; the handle is gone afterwards.
void amberfield_proxy_close(struct AmberfieldProxy *proxy);

// Copies the times [s] at which the potentials of the patches that change are asked for: as many as the
// request says.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `times` has room for `count` numbers.
enum AmberfieldStatus amberfield_field_times(struct AmberfieldField *field, double *times, uint64_t count);

// Answers the question for the potentials [V] of the patches that change with `count` numbers: patch by
// patch in the order in which the mesh names them, all times of each. One that is not known is no number.
//
// # Safety
// `field` comes from amberfield_field_open and is not closed; `potentials` has `count` numbers.
enum AmberfieldStatus amberfield_field_reply_potentials(struct AmberfieldField *field,
                                                        const double *potentials,
                                                        uint64_t count);

// Opens a field. The result is never NULL; amberfield_host_error is empty when it worked.
//
// # Safety
// `settings` may be read; its case is a C string or NULL.
struct AmberfieldHost *amberfield_host_open(const struct AmberfieldHostSettings *settings);

// Opens a field that ranks share: every rank of the host program opens it with the same settings and its own
// table, gives its own particles to the calls that follow, and gets their field. All ranks make the same
// calls in the same order, also those without particles; what fails on one rank fails on all, with the same
// text. AmberfieldStatus_Broken is a failure of one rank alone, and so is a handle that was not opened well:
// then end the program. A rank should have the particles of a compact piece of the box. `threads` 0 stands
// for all cores that this rank may use.
//
// With an OpenFOAM case rank 0 starts the solver and gets the particles of all ranks.
//
// # Safety
// As for amberfield_host_open; `ranks` may be read, and its functions may be called until the handle is
// closed.
struct AmberfieldHost *amberfield_host_open_over_ranks(const struct AmberfieldHostSettings *settings,
                                                       const struct AmberfieldRanks *ranks);

// Returns the reason why the last call on a handle failed; empty if it did not. The text is valid until the
// next call.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed.
const char *amberfield_host_error(const struct AmberfieldHost *host);

// Computes E [V/m] at every particle, three doubles each, and the potential [V] of all but the particle
// itself, unless `potential` is NULL, for all ranks or none. The particles are at `positions` [m], three
// doubles each, with `charges` [C], at the time `time` [s]. The first call chooses parameters and starts the
// solver, if there is one.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed; the arrays have room for `count` particles.
enum AmberfieldStatus amberfield_host_field(struct AmberfieldHost *host,
                                            double time,
                                            uint64_t count,
                                            const double *positions,
                                            const double *charges,
                                            double *e,
                                            double *potential);

// Computes the energy of the charges [J], whose change with their places gives the forces qE: that of the
// charges among themselves, their images among them, ½ Σ q V, and that of the charges in the field of the
// faces' potentials and normal fields, Σ q V. With an OpenFOAM case the second is in the first, once instead
// of twice a half. Particles are as in amberfield_host_field; ranks that share a field get the energy of the
// particles of all.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed; the arrays have `count` particles; both energies
// may be written.
enum AmberfieldStatus amberfield_host_energy(struct AmberfieldHost *host,
                                             double time,
                                             uint64_t count,
                                             const double *positions,
                                             const double *charges,
                                             double *of_charges,
                                             double *of_faces);

// Chooses parameters anew at the next call, for particles that are no longer what they were.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed.
void amberfield_host_retune(struct AmberfieldHost *host);

// Ends the solver, if there is one, and closes a handle of the host side. NULL is allowed.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed; the handle is gone afterwards.
void amberfield_host_close(struct AmberfieldHost *host);

// Returns the relative RMS error of E that was measured last, when parameters were chosen or by
// amberfield_host_recheck; 0 where the sum is exact, and below 0 where none was measured, as with parameters
// from a restart file or without any charge.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed.
double amberfield_host_measured_error(const struct AmberfieldHost *host);

// Measures the error of E on a sample of particles, which have moved since parameters were chosen. Where it
// has left the tolerance, the next call chooses parameters anew. Those of an OpenFOAM case stay. Particles
// are as in amberfield_host_field.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed; the arrays have `count` particles.
enum AmberfieldStatus amberfield_host_recheck(struct AmberfieldHost *host,
                                              uint64_t count,
                                              const double *positions,
                                              const double *charges);

// Returns the parameters in force as text, for amberfield_host_use_parameters of a later run; empty before
// the first field, and with an OpenFOAM case on all ranks but 0. The text is valid until the next call.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed.
const char *amberfield_host_parameters(struct AmberfieldHost *host);

// Takes the parameters of an earlier run, instead of choosing some at the next call.
//
// # Safety
// `host` comes from amberfield_host_open and is not closed; `parameters` is a C string.
enum AmberfieldStatus amberfield_host_use_parameters(struct AmberfieldHost *host, const char *parameters);

// Returns the charge [C] that moves from the first grain to the second.
//
// # Safety
// `contact` may be read.
double amberfield_charge_between_grains(const struct AmberfieldContact *contact);

// Returns the charge [C] that moves from a grain, the first body, to a grounded wall.
//
// # Safety
// `contact` may be read.
double amberfield_charge_to_grounded_wall(const struct AmberfieldContact *contact);

// Returns the charge [C] that moves from a grain, the first body, to an insulating wall, which keeps it.
//
// `kept_field` is the field at the contact of the charge that the wall keeps around it, positive from the
// wall to the grain [V/m]; `per_charge` the growth of epsilon times that field per charge that this contact
// leaves [1/m^2], which is 1/(4 pi r^2) where the radius is r. Both are sums over
// `amberfield_kept_charge_field`.
//
// # Safety
// `contact` may be read.
double amberfield_charge_to_insulating_wall(const struct AmberfieldContact *contact,
                                            double kept_field,
                                            double per_charge);

// Writes the field of a charge that an insulator keeps around a place, over Coulomb's constant times the
// charge [1/m^2], at an offset from the place.
//
// `scale` is the larger of the radii of the grains that left the charge and of the one that feels it [m],
// `normal` the surface's unit normal on the side of the charge, and the sign of `side` that of the height
// before the surface, where the height itself is round-off.
//
// # Safety
// `normal` and `offset` have three numbers, and `e` takes three.
void amberfield_kept_charge_field(double scale,
                                  const double *normal,
                                  const double *offset,
                                  double side,
                                  double *e);

// Returns the area of a Hertz contact [m^2], for an effective radius and an overlap [m].
double amberfield_contact_area(double effective_radius, double overlap);

// Returns the factor of the area of two bodies whose moduli are softer in the computation than in truth:
// Young's moduli [Pa] of both bodies as computed, the real ones, and Poisson's ratios.
//
// # Safety
// Each array has two numbers.
double amberfield_area_correction(const double *soft, const double *real, const double *poisson);

// Returns the radius-weighted rate at which a contact of grains relaxes, 1/(4 pi) (1/r_i^2 + 1/r_j^2) times
// the growth of its area: what share of a difference of charge moves, where it is small. At a grounded wall
// the second radius is that of the first.
//
// # Safety
// `contact` may be read.
double amberfield_relaxation(const struct AmberfieldContact *contact);

// Returns Coulomb's constant in the medium, 1/(4 pi epsilon) [m/F], for a relative permittivity.
double amberfield_coulomb(double relative_permittivity);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* AMBERFIELD_H */
