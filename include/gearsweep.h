/* gearsweep for C and C++.
 *
 * Every call returns a code and leaves a message, which is empty where the code is 0.
 *
 *   text, text_length   the case, as the program reads it: text_length bytes, or up to the first NUL.
 *   folder              where files that the case names lie; NULL: the current folder. Calls without it
 *                       read them from the current folder, or need none of them where work is given.
 *   nwork, work         the pair stiffness from gsc_prepare, for cases with the same gears, material,
 *                       section and load; 0 and NULL: each call finds it itself.
 *   threads             of the sweep; 0: all. The answer is the same for any number.
 *   message, message_size  where the message goes, with its NUL; cut where it is too long.
 *                       NULL and 0: no message is wanted.
 *
 * A call runs one task, which the case must name among its tasks. The caller owns all arrays; they may
 * be larger than gsc_sizes says, and what lies beyond is not touched. The first index runs fastest, as
 * in Fortran: x(i, j) with sizes (n, m) is x[i + n*j], counted from 0. Units are those of the case.
 *
 * Nothing prints, exits or keeps state. Any number of threads may call at once. While a call computes,
 * OpenBLAS is kept to one thread; the number before comes back when the last call ends.
 */
#ifndef GEARSWEEP_H
#define GEARSWEEP_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The codes, the same for the program (its exit code), Fortran, C and Python. Unless the code is
   GSC_OK or GSC_PARTIAL, the results are as they were. */
enum {
  GSC_OK = 0,
  GSC_INPUT = 1,     /* the case or an argument is not usable; an array too small: the message has the size */
  GSC_USAGE = 2,     /* the command line is not usable (program only) */
  GSC_FILE = 3,      /* a file or folder cannot be read or written */
  GSC_PARTIAL = 4,   /* some operating points have no answer (NaN); the others were computed */
  GSC_NUMERICAL = 5, /* a numerical method did not deliver, although the input is valid */
  GSC_MEMORY = 6,    /* the work does not fit into the memory */
  GSC_INTERRUPTED = 130 /* the caller ended the run; what was done by then is there */
};

/* What status of gsc_sweep says. From GSC_UNSTABLE on there is no dynamic factor. */
enum {
  GSC_STABLE = 0,      /* stable and periodic with the mesh */
  GSC_MARGINAL = 1,    /* periodic, but transients never die */
  GSC_SUBHARMONIC = 2, /* periodic with several mesh periods */
  GSC_INEXACT = 3,     /* the error estimate stays above the tolerance */
  GSC_UNSTABLE = 4,    /* the periodic motion repels; no steady motion was reached */
  GSC_APERIODIC = 5,   /* no periodic motion was found */
  GSC_UNRESOLVED = 6,  /* the speed is too low for the steps given or allowed */
  GSC_CHATTER = 7,     /* contact changes without end */
  GSC_CHAOTIC = 8,     /* no periodic motion was found, and disturbances keep growing */
  GSC_STOPPED = 9      /* the caller ended the run before */
};

/* What contact of gsc_sweep says: all pairs touch, one was apart for a while, all were, the coast
   sides touched. */
enum { GSC_CONTACT_FULL = 0, GSC_CONTACT_PARTIAL = 1, GSC_CONTACT_LOST = 2, GSC_CONTACT_COAST = 3 };

/* Version of the library, as "0.1.0". */
int gsc_version(char *version, size_t version_size, char *message, size_t message_size);

/* Sizes of the results, 0 for tasks that the case does not name. No finite elements run.
   rows: of gsc_mesh; tried: of gsc_optimum; positions: of gsc_root; modes: of gsc_modes;
   nodes, elements: of the section's grid; harmonics: of gsc_harmonics; nwork: of gsc_prepare. */
int gsc_sizes(const char *text, size_t text_length, const char *folder, int *speeds, int *reliefs,
              int *rows, int *tried, int *positions, int *modes, int *nodes, int *elements,
              int *harmonics, int *nwork, char *message, size_t message_size);

/* The pair stiffness, by finite elements where the case says so: the costly part of a mesh, for the
   calls below. It holds for cases that differ in reliefs, speeds, masses, damping, friction,
   backlash or tasks; another case is refused. */
int gsc_prepare(const char *text, size_t text_length, const char *folder, int nwork, double *work,
                char *message, size_t message_size);

/* All tasks: the answer as the program prints it. length: without its NUL; also where answer_size is
   too small (then GSC_INPUT). */
int gsc_report(const char *text, size_t text_length, const char *folder, int nwork, const double *work,
               int threads, char *answer, size_t answer_size, size_t *length, char *message,
               size_t message_size);

/* What the program does with a case: the answer, and its tables and grids as files name.sweep.csv and
   so on in the folder out, which is made if missing (empty: no files, no answer). name: without a folder
   and control characters, or GSC_INPUT. stages: which ran and which were left out; files: that were
   written, all or, where one cannot be (GSC_FILE), none, and those of before stay; a line each. The texts
   may be NULL with size 0 and are cut where they are too long; length is that of the whole answer. They
   are filled also where a file cannot be written. */
int gsc_files(const char *text, size_t text_length, const char *folder, int nwork, const double *work,
              int threads, const char *out, const char *name, char *answer, size_t answer_size,
              size_t *length, char *stages, size_t stages_size, char *files, size_t files_size,
              char *message, size_t message_size);

/* As gsc_files, and the caller may watch the run, end it, and go on from there.
   watch[3]: watch[0] is 0; whoever sets it to another number while the call computes, a signal's handler or another
   thread, ends the run soon (GSC_INTERRUPTED; the files of what is done are written). watch[1]: operating points done
   so far, never fewer than before, watch[2]: of how many. NULL: the run is not watched
   resume: file that an interrupted run left: what was done by then is taken over, to the same bits; one of another
   version, or of a case that differs, is refused. NULL or empty: begins anew
   keep: file that is written where the run is interrupted, and removed where it is not; may be that of resume;
   NULL or empty: none */
int gsc_all(const char *text, size_t text_length, const char *folder, int nwork, const double *work,
            int threads, const char *out, const char *name, int *watch, const char *resume,
            const char *keep, char *answer, size_t answer_size, size_t *length, char *stages,
            size_t stages_size, char *files, size_t files_size, char *message, size_t message_size);

/* The case with every key that it leaves to its default written out. It gives the same answer.
   length: as for gsc_report. */
int gsc_complete(const char *text, size_t text_length, char *complete, size_t complete_size,
                 size_t *length, char *message, size_t message_size);

/* The keys that a case gives but does not use, mostly for tasks that it does not name: they are read and
   checked, but change nothing; the answer names them, too. A line for each use that they would have, as
   modal: &modal modes, and with more keys, load, sweep or optimum: &pair backlash_um; &dynamics friction.
   length: as for gsc_report. */
int gsc_unused(const char *text, size_t text_length, char *unused, size_t unused_size, size_t *length,
               char *message, size_t message_size);

/* Sets one key of a case, and leaves the rest of the text as it is, with its remarks.
   group, key: without &; a group that is missing is added; value: as it stands in a case, such as
   "0, 5, 10" or "'fe'"; NULL or empty: the key is taken out; length: as for gsc_report.
   A key that no case has is an error, which names the closest one, unless it is taken out of a text that has
   it. Whether this case allows key and value is told by the call that reads it. */
int gsc_change(const char *text, size_t text_length, const char *group, const char *key,
               const char *value, char *changed, size_t changed_size, size_t *length, char *message,
               size_t message_size);

/* Geometry of the pair. Last index of arrays: pinion, gear.
   radius_mm[6*2]: tip, reference, drive base, coast base, root, start of the drive involute
   point[5]: A, B, P, D, E along the path of contact, base pitches
   point_radius_mm[5*2]: radius at which each member touches there
   working_angle_deg[2]: drive, coast flanks; backlash_um: along the line of action */
int gsc_geometry(const char *text, size_t text_length, double *radius_mm, double *point,
                 double *point_radius_mm, double *distance_mm, double *working_angle_deg,
                 double *contact_ratio, double *base_pitch_mm, double *backlash_um, char *message,
                 size_t message_size);

/* Static load on the line of action, effective masses[2] on it, mean mesh stiffness over the whole
   width, natural frequency. turn_um: what whole gears turn about their bores under the load, not in the
   motion; shared_um: what neighbouring teeth share beyond that; model 'fe', else 0. */
int gsc_motion(const char *text, size_t text_length, int nwork, const double *work, double *load_n,
               double *mass_kg, double *stiffness_n_um, double *frequency_hz, double *turn_um,
               double *shared_um, char *message, size_t message_size);

/* Task mesh: one pair along the path of contact, static; arrays of rows, reliefs after each other.
   s: base pitches from A; pair_n_um, mesh_n_um: stiffness of this pair, of all that carry and whole gears' discs;
   error_um: profile error; share: of the static load; ste_um: static transmission error */
int gsc_mesh(const char *text, size_t text_length, int nwork, const double *work, int rows,
             double *relief_um, double *s, double *pair_n_um, double *mesh_n_um, double *error_um,
             double *share, double *ste_um, char *message, size_t message_size);

/* Task mesh: static transmission error over one mesh period, for each relief. Over the phase tau, 0 where
   a pair enters at A, it is mean + sum of amplitude[k] cos(2 pi k tau + phase[k]), k from 1.
   amplitude_um, phase_deg: [harmonics*reliefs], harmonic first; the others: [reliefs]
   rms_um: of the deviation from the mean; estimate_um: error of mean and amplitudes */
int gsc_harmonics(const char *text, size_t text_length, int nwork, const double *work, int harmonics,
                  int reliefs, double *relief_um, double *mean_um, double *rms_um,
                  double *peak_to_peak_um, double *amplitude_um, double *phase_deg,
                  double *estimate_um, char *message, size_t message_size);

/* Task load: dynamic load of one pair along its path at the speeds load_rpm; arrays of room. Where the case
   names the task sweep too, the motions are those of its sweep, which is run for them.
   rows: that there are; also where room is too small (then GSC_INPUT).
   s: base pitches from A; dte_um: dynamic transmission error
   status: of the operating point, as from gsc_sweep; one without an answer has a single row of NaN
   periods: mesh periods until the motion repeats, so many pairs differ; pair: which, from 1 (0: no answer) */
int gsc_load(const char *text, size_t text_length, int nwork, const double *work, int room, int *rows,
             double *relief_um, double *rpm, double *s, double *pair_load_n, double *dte_um, int *status,
             int *periods, int *pair, char *message, size_t message_size);

/* Task sweep. rpm[speeds]: of the pinion, ascending; relief_um[reliefs];
   the others: [speeds*reliefs], speed first
   estimate: of the error of dynamic_factor; floquet_modulus: what is left of a disturbance;
   residual: by how much the motion fails to repeat, in static deflections; steps: in a mesh period;
   periods: mesh periods until the motion repeats */
int gsc_sweep(const char *text, size_t text_length, int nwork, const double *work, int threads,
              int speeds, int reliefs, double *rpm, double *relief_um, double *dynamic_factor,
              double *estimate, int *status, int *contact, double *floquet_modulus, double *residual,
              int *steps, int *periods, char *message, size_t message_size);

/* Resonances of one curve of gsc_sweep; runs nothing. peak_rpm[5], peak_factor[5], of which `found`
   are filled. */
int gsc_resonances(int speeds, const double *rpm, const double *dynamic_factor, int *found,
                   double *peak_rpm, double *peak_factor, char *message, size_t message_size);

/* Task optimum: the relief with the least worst dynamic factor over the speeds. The curve has
   `tried` reliefs, ascending; relief_um, worst_factor, rpm, failed: [room], room as gsc_sizes says.
   best_...: its least; NaN where no relief has an answer; it lies within within_um of the true one. */
int gsc_optimum(const char *text, size_t text_length, int nwork, const double *work, int threads,
                int room, int *tried, double *relief_um, double *worst_factor, double *rpm,
                int *failed, double *best_um, double *best_factor, double *best_rpm,
                double *within_um, char *message, size_t message_size);

/* Outline of one gear (member 1 pinion, 2 gear) about its own centre, its first tooth's axis along y,
   clockwise; the last point joins the first. Of a gear with more than 500 teeth, one tooth.
   x_mm, y_mm: [room]; points: that there are; also where room is too small (then GSC_INPUT) */
int gsc_outline(const char *text, size_t text_length, int member, int room, int *points, double *x_mm,
                double *y_mm, char *message, size_t message_size);

/* Task section: grid of the section; the same as that of gsc_modes.
   x_mm, y_mm: [nodes] the loaded tooth's axis along y, the gear's centre at 0; of an even number of teeth,
   the middle of the space between the loaded tooth and the next one along y
   element[8*elements]: its nodes, counted from 1: corners, then the middles of the sides, anticlockwise
   tooth[elements]: 0 for the body, 1 for the first tooth from the left */
int gsc_section(const char *text, size_t text_length, int nodes, int elements, double *x_mm,
                double *y_mm, int *element, int *tooth, char *message, size_t message_size);

/* Task modal: natural frequencies of the section; arrays of modes.
   estimate: relative error; residual: of the eigenvalue problem; rim_share: of the kinetic energy
   shape[2*nodes*modes]: displacements in x and y at the grid's nodes for a modal mass of 1 kg, in
   m/sqrt(kg); 0 and NULL for nodes and shape: they are not wanted */
int gsc_modes(const char *text, size_t text_length, int modes, int nodes, double *frequency_hz,
              double *estimate, double *residual, double *rim_share, double *shape, char *message,
              size_t message_size);

/* Task static: root stress while the load moves over the path with its real share.
   s, radius_mm: [positions] where the load acts; share[positions*reliefs]: of the static load
   sigma_mpa[2*positions*reliefs]: along the surface at the fillet tangent; drive, coast side
   parts_mpa[3*2*positions*reliefs]: its components across and along the tooth axis, and shear
   tension_mpa, tension_deg, compression_mpa, compression_deg: [reliefs] largest over fillets and
   path, and the tangent to the tooth axis there; estimate[reliefs]: relative error of the larger
   iso_mpa, lewis_mpa: ISO 6336-3 sigma_F0 and Lewis, whole load at the outer point of single contact */
int gsc_root(const char *text, size_t text_length, int nwork, const double *work, int positions,
             int reliefs, double *relief_um, double *s, double *radius_mm, double *share,
             double *sigma_mpa, double *parts_mpa, double *tension_mpa, double *tension_deg,
             double *compression_mpa, double *compression_deg, double *estimate, double *iso_mpa,
             double *lewis_mpa, char *message, size_t message_size);

/* Task static: stress all over the section for one position of the load and one relief, counted from 1
   as in gsc_root; at the nodes of gsc_section. relief_um, s, radius_mm, share: what gsc_root has there;
   sigma_mpa[3*nodes]: in x, in y, and shear */
int gsc_stress(const char *text, size_t text_length, int nwork, const double *work, int position,
               int relief, int nodes, double *relief_um, double *s, double *radius_mm, double *share,
               double *sigma_mpa, char *message, size_t message_size);

/* Stability of the motion with all pairs in contact, whatever the load and relief; the case must name a task
   that needs the mesh, as for the next two calls. None of them uses the case's speeds.
   rpm[speeds]: ascending; damping_ratio[dampings]; modulus[speeds*dampings]: largest of the Floquet
   multipliers, NaN where the speed is too low; sense[speeds*dampings]: its sign where it is real, 0 for a
   complex pair
   Tongues of instability, from the highest speed on (tongues: how many, or 0): closing_ratio[tongues]:
   damping ratio that closes it, NaN: above 1; closing_rpm[tongues]: where its last point is;
   edge_rpm[2*dampings*tongues]: lower and upper speed, NaN where it is closed */
int gsc_stability(const char *text, size_t text_length, int nwork, const double *work, int speeds,
                  const double *rpm, int dampings, const double *damping_ratio, int tongues,
                  double *modulus, int *sense, double *closing_ratio, double *closing_rpm,
                  double *edge_rpm, char *message, size_t message_size);

/* The steady motions that a slow run through the speeds meets, and where they change, for one relief,
   counted from 1. rpm[speeds]: in the direction of travel; jump: a dynamic factor that changes by more at
   once has jumped (0.02); closeness: of the speeds before and after a change, relative (1e-6)
   changes: that there are; also where room is too small (then GSC_INPUT)
   change_rpm, change_factor, change_status, change_periods: [2*room] before and after each
   dynamic_factor, estimate, status, contact, floquet_modulus, periods: [speeds] as from gsc_sweep
   x_um, v_mm_s: [speeds] dynamic transmission error and its rate as a new pair enters */
int gsc_follow(const char *text, size_t text_length, int nwork, const double *work, int relief,
               int speeds, const double *rpm, double jump, double closeness, int room, int *changes,
               double *change_rpm, double *change_factor, int *change_status, int *change_periods,
               double *dynamic_factor, double *estimate, int *status, int *contact,
               double *floquet_modulus, int *periods, double *x_um, double *v_mm_s, char *message,
               size_t message_size);

/* The motion seen once a mesh period, as a new pair enters, for one relief, counted from 1; at each further
   speed it starts where it was at the one before.
   rpm[speeds]; start_um, start_mm_s: where it starts, as from gsc_follow, NaN: at rest
   settle, keep: mesh periods passed over at each speed, and kept after them; x_um, v_mm_s: [keep*speeds]
   exponent[speeds]: largest Lyapunov exponent, of a mesh period: above 0 where the motion is chaotic
   status[speeds]: ok, subharmonic, chaotic; aperiodic: neither repeats nor is surely chaotic within what was
   kept; periods[speeds]: mesh periods until the motion repeats, 0: it does not */
int gsc_strobe(const char *text, size_t text_length, int nwork, const double *work, int relief,
               int speeds, const double *rpm, double start_um, double start_mm_s, int settle, int keep,
               double *x_um, double *v_mm_s, double *exponent, int *status, int *periods, char *message,
               size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
