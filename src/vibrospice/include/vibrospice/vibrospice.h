/* SPDX-License-Identifier: MIT
 * VibroSpice from a program of your own. A handle is one run of one scene:
 *
 *   vibrospice *run;
 *   if (vibrospice_open("paper", 0, &run)) return puts(vibrospice_error());
 *   vibrospice_set(run, "run.until", "0.2 s");
 *   vibrospice_finish(run);
 *   ... vibrospice_measures(run, &measure, &count) ...
 *   vibrospice_free(run);
 *
 * How it works. Each handle has an engine: the program `vibrospice`, which the library starts as a
 * process of its own and talks to over a socket. So there may be any number of handles, on every
 * tier; a crash or a lack of memory in an engine is an error of its handle; and a state is saved by
 * a copy of the process. Nothing here ends or aborts the calling process, prints, or handles a
 * signal. The program is looked for in the environment's VIBROSPICE_PROGRAM, beside the library,
 * in ../bin from there, then by PATH; it must have the library's version.
 *
 * Order of a run. Open; then keys, inputs and the folder; then run to instants, or to the end;
 * then finish; then ask for the result. A call at another time returns VIBROSPICE_ORDER.
 *
 * Threads. Handles are independent of each other. Two threads may not be in one handle at a time:
 * the second gets VIBROSPICE_BUSY, and the first goes on. A handle belongs to the process that
 * opened it, and a fork of that process has none.
 *
 * Memory. What a function sets a pointer to belongs to the handle and lasts until vibrospice_set,
 * vibrospice_set_input, vibrospice_folder, vibrospice_finish, vibrospice_restore or vibrospice_free
 * is called with it; values last until the run goes on.
 * After an error such a pointer is NULL, and its count 0.
 *
 * Each description has its unit as text ("m", "deg"); the values of columns, inputs, measures and
 * verdicts are in these units. Times are in s from the beginning of the run. Texts are UTF-8.
 *
 * Licence. This header and the library are under the MIT licence, and link nothing but the C
 * library. The program `vibrospice` is under the GPL, as is the GSL that it links; it runs as a
 * process of its own, and is never linked to a program that links this library. What the program
 * writes belongs to you. */
#ifndef VIBROSPICE_VIBROSPICE_H
#define VIBROSPICE_VIBROSPICE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Semantic version of this interface: programs built with MAJOR.MINOR run with any later MINOR; as
 * long as MAJOR is 0, with the same MINOR only. */
#define VIBROSPICE_MAJOR 0
#define VIBROSPICE_MINOR 2
#define VIBROSPICE_PATCH 0

#if defined __GNUC__
#define VIBROSPICE_API __attribute__((visibility("default")))
#else
#define VIBROSPICE_API
#endif

/* A run, and a saved state of one. Neither is ever a pointer to follow. */
typedef struct vibrospice vibrospice;
typedef struct vibrospice_state vibrospice_state;

/* ---- errors ---- */

/* What every function but vibrospice_version and vibrospice_error returns. */
typedef enum vibrospice_status {
  VIBROSPICE_OK = 0,
  VIBROSPICE_FAILED = 1,  /* the run has failed: it is over, but for a saved state */
  VIBROSPICE_INPUT = 2,   /* a scene, key, value, input, folder or argument is wrong; nothing has
                             changed */
  VIBROSPICE_HANDLE = 10, /* no such handle: it was freed, never was one, or belongs to
                             another process */
  VIBROSPICE_BUSY = 11,   /* another thread or a callback is using this handle */
  VIBROSPICE_ORDER = 12,  /* this call is not allowed at this time of a run */
  VIBROSPICE_TIME = 13,   /* an instant that is not after the run's time, or is after its end */
  VIBROSPICE_ENGINE = 14, /* the program cannot be started, has another version, or has died */
  VIBROSPICE_MEMORY = 15, /* there is no memory, file descriptor or process left */
  VIBROSPICE_STOPPED = 16 /* the callback has stopped the run, which can go on from there */
} vibrospice_status;

/* Says why the last failed call of this thread failed, in one line without a line end; "" before
 * any failure. The text lasts until this thread's next failed call. */
VIBROSPICE_API const char *vibrospice_error(void);

/* The version of the linked library, "0.2.0". The text is constant. */
VIBROSPICE_API const char *vibrospice_version(void);

/* ---- a scene ---- */

/* Flags of vibrospice_open. */
enum {
  VIBROSPICE_TEXT = 1,      /* `scene` is the scene itself, as YAML; relative paths in it start from
                               the working directory */
  VIBROSPICE_ALLOW_CODE = 2 /* the scene's own law of control may run, as with --allow-code */
};

/* Opens a scene, given as the name of a shipped scene, the path of a file, or its text. *run
 * becomes the handle, or NULL after an error. */
VIBROSPICE_API vibrospice_status vibrospice_open(const char *scene, unsigned flags,
                                                 vibrospice **run);

/* Ends a run, wherever it is, and its engine. The handle is invalid afterwards. NULL is allowed.
 * Saved states stay. */
VIBROSPICE_API vibrospice_status vibrospice_free(vibrospice *run);

/* Before the run begins: sets a key of the scene, as --set KEY=VALUE does: "circuit.r1", "220 ohm".
 * The scene is read with it at once; an error leaves the scene as it was. */
VIBROSPICE_API vibrospice_status vibrospice_set(vibrospice *run, const char *key,
                                                const char *value);

/* Before the run begins: names the folder to which vibrospice_finish writes run.csv, peaks.csv,
 * events.csv and summary.json, the bytes of `vibrospice run SCENE --reproducible -o FOLDER`. */
VIBROSPICE_API vibrospice_status vibrospice_folder(vibrospice *run, const char *folder);

/* ---- columns and inputs ---- */

/* A column of the run, as run.csv has it. The first is the time. */
typedef struct vibrospice_column {
  const char *name;     /* including the unit: "p_m" */
  const char *quantity; /* without the unit: "p" */
  const char *unit;     /* "m"; "" for a pure number */
  const char *role;     /* time, coordinate, rate, acceleration, probe, instrument, estimate,
                           set_point, measure */
  const char *of;       /* the coordinate, channel or sensor that it belongs to; "": none */
} vibrospice_column;

/* *column becomes column[*count]. */
VIBROSPICE_API vibrospice_status vibrospice_columns(vibrospice *run,
                                                    const vibrospice_column **column,
                                                    size_t *count);

/* A quantity that may be set while the run goes on. */
typedef struct vibrospice_input {
  const char *name;      /* "firing.angle" */
  const char *unit;      /* of the next three numbers */
  double least, largest; /* the allowed range */
  double value;          /* at the beginning of the run, unless it is set before */
  const char *text;      /* what it does, and when */
} vibrospice_input;

/* *input becomes input[*count]. Which there are depends on the scene. */
VIBROSPICE_API vibrospice_status vibrospice_inputs(vibrospice *run, const vibrospice_input **input,
                                                   size_t *count);

/* Sets an input from the run's time on. An input that is to be set during the run has to be set
 * once before the run begins, to its initial value. A run in which no input is set is that of the
 * scene, to the bit. firing.angle is read at the rising zero crossing of the mains at which the
 * cycle of a firing begins, and holds for that firing; NaN leaves the firing out. supply.frequency
 * cannot change during the run, as its firings are counted in cycles of one length. The others act
 * at once. A key that would change what was set as an input is refused. */
VIBROSPICE_API vibrospice_status vibrospice_set_input(vibrospice *run, const char *name,
                                                      double value);

/* ---- time ---- */

/* Is called with a row, value[count] of the columns, which lasts as long as the call. If it returns
 * anything but 0 the run stops at this row, with VIBROSPICE_STOPPED. It must not use the run's own
 * handle. */
typedef int (*vibrospice_step)(void *context, const double *value, size_t count);

/* Runs on to t_s, which is after the run's time and at most run.until. step is called with each row
 * on the way; rows are run.sample apart, so t_s itself has one only if it is such an instant. step
 * may be NULL. Any t_s is allowed; no bit of the result depends on it, unless an input was set.
 * If the solver gives up, a run that was stopped at an instant or has shown rows has failed; a run
 * that vibrospice_finish alone takes to its end tries the rungs of the ladder, as `vibrospice run`
 * does. */
VIBROSPICE_API vibrospice_status vibrospice_run_to(vibrospice *run, double t_s,
                                                   vibrospice_step step, void *context);
/* The same to run.until. */
VIBROSPICE_API vibrospice_status vibrospice_run_on(vibrospice *run, vibrospice_step step,
                                                   void *context);

/* The run's time, s, and its end, run.until. Each pointer may be NULL. */
VIBROSPICE_API vibrospice_status vibrospice_time(vibrospice *run, double *t_s, double *until_s);

/* The columns at the run's time: *value becomes value[*count]. Before the run begins instruments
 * and what a circuit computes are NaN, or at rest. */
VIBROSPICE_API vibrospice_status vibrospice_values(vibrospice *run, const double **value,
                                                   size_t *count);

/* ---- the result ---- */

/* Runs on to the end if the run is not there yet, makes the second run from which the margins get
 * their errors, and writes the folder. Afterwards the functions below answer. A violated verdict is
 * not an error. */
VIBROSPICE_API vibrospice_status vibrospice_finish(vibrospice *run);

/* A number of the run. limit, margin, error and word are those of the line of the verdict that has
 * its name; NaN and "": there is none. */
typedef struct vibrospice_measure {
  const char *name; /* "p_first_peak" */
  const char *unit;
  double value, at_s; /* at_s, NaN: it belongs to no instant */
  double limit;       /* that it is compared with, in its unit; NaN: none */
  double margin;      /* distance to the limit as a fraction of it; negative: beyond the limit */
  double error;       /* of the margin, as the same fraction; NaN: not computed */
  const char *word;   /* held, violated, undecided, unverified, waived; "": not judged */
} vibrospice_measure;

/* *measure becomes measure[*count]. */
VIBROSPICE_API vibrospice_status vibrospice_measures(vibrospice *run,
                                                     const vibrospice_measure **measure,
                                                     size_t *count);

/* A line of the verdict. */
typedef struct vibrospice_line {
  const char *name;     /* "thyristor.i2t", "v_ak" */
  const char *unit;     /* of value, least, most */
  double value;         /* the extreme that is nearest to its limit, or furthest beyond it */
  double at_s;          /* when; NaN: it belongs to no instant, or is not known */
  double least, most;   /* the allowed range; -INFINITY, INFINITY: no limit on that side */
  double margin, error; /* as in vibrospice_measure */
  double failed_at_s;   /* when the limit was first passed; NaN: it was not */
  const char *word;     /* as in vibrospice_measure */
  const char *why;      /* why it is undecided; "": it is decided, or the error is the reason */
} vibrospice_line;

/* *line becomes line[*count]. *held (may be NULL) becomes 1 if no line is violated or undecided,
 * else 0, and *breach (may be NULL) then says in one sentence which line is the worst. */
VIBROSPICE_API vibrospice_status vibrospice_verdict(vibrospice *run, const vibrospice_line **line,
                                                    size_t *count, int *held, const char **breach);

/* Something that happened to a device, or that the scene expects and that did not happen. */
typedef struct vibrospice_happening {
  const char *what;   /* unintended_firing, misfire, fuse_opens, ... */
  const char *device; /* of the deck */
  const char *cause;  /* one sentence; "": it did not happen */
  const char *word;   /* as in vibrospice_measure */
  double at_s;        /* the first time; NaN: it did not happen */
  long times;         /* 0: it did not happen */
  int expected;       /* 1: the scene expects it */
} vibrospice_happening;

/* *happening becomes happening[*count]. */
VIBROSPICE_API vibrospice_status vibrospice_happened(vibrospice *run,
                                                     const vibrospice_happening **happening,
                                                     size_t *count);

/* What the verdict does not judge: *name becomes name[*count], "r1.power". */
VIBROSPICE_API vibrospice_status vibrospice_not_judged(vibrospice *run, const char *const **name,
                                                       size_t *count);

/* summary.json, whole, as one text. */
VIBROSPICE_API vibrospice_status vibrospice_summary(vibrospice *run, const char **json);

/* ---- states ---- */

/* Saves the state of a run that is not finished, with its inputs and what its folder has so far, as
 * a waiting process. *state becomes its handle, or NULL after an error. A scene that runs code of
 * its own cannot be saved, since the memory of that code cannot be copied. */
VIBROSPICE_API vibrospice_status vibrospice_save(vibrospice *run, vibrospice_state **state);

/* Takes a run, even one that has failed or is finished, to a state that was saved of any run. What
 * follows is, to the bit, what followed before. The state stays, and may be restored into any
 * number of runs. */
VIBROSPICE_API vibrospice_status vibrospice_restore(vibrospice *run, vibrospice_state *state);

/* Ends a state. NULL is allowed. */
VIBROSPICE_API vibrospice_status vibrospice_free_state(vibrospice_state *state);

#ifdef __cplusplus
}
#endif

#endif
