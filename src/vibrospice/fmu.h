/* SPDX-License-Identifier: MIT
 * An instance of a functional mock-up unit, whatever the version of the standard: `vibrospice
 * export SCENE -o x.fmu` packs the shim with the scene. An instance is a handle of libvibrospice,
 * so its engine is the program in a process of its own, and a state is a copy of that. */
#ifndef VIBROSPICE_FMU_H
#define VIBROSPICE_FMU_H

#include <stddef.h>
#include <stdint.h>

#include "vibrospice/vibrospice.h"

/* As FMI 2.0 and 3.0 number them. */
enum { FMU_OK = 0, FMU_DISCARD = 2, FMU_ERROR = 3, FMU_FATAL = 4 };

enum { FMU_MOST_INPUTS = 8 };

typedef struct fmu_deed fmu_deed;

typedef struct fmu {
  void (*log)(const struct fmu *u, int status, const char *text); /* tells the master */
  void *environment, *call; /* the master's; a function of the standard's for the former */
  int early;                /* a step may end at an event (vibrospice_run_to_event) */
  char token[128];          /* by which the master knows the unit; a state holds for no other */
  uint32_t number;          /* of the instance's handle */
  char name[256], resources[4096];
  vibrospice *run;
  double stop_s; /* 0: the scene's own */
  double input[FMU_MOST_INPUTS];
  size_t inputs; /* of the scene */
  char input_name[FMU_MOST_INPUTS][64];
  int begun;      /* the initialization is over: inputs go to the run */
  fmu_deed *deed; /* deed[deeds]: what was asked of the run, from which it can be made anew */
  size_t deeds, room;
} fmu;

/* An instance's handle is a number, as that of a run is, so that one that was freed is told from
 * all others. Each function below returns FMU_ERROR for such a handle, and nobody can be told why.
 */

/* Says the text to the master and returns the status. */
int fmu_say(void *handle, int status, const char *text);
/* Makes an instance of a unit whose resources lie in that folder, or under that URI, and returns
 * its handle. token: the master's, which has to be the unit's. NULL: it cannot be, and log has been
 * told. */
void *fmu_new(const char *name, const char *token, const char *resources, const fmu *like);
void fmu_free(void *handle);
int fmu_reset(void *handle);
/* A run begins at 0 s; has_stop: and ends at stop_s instead of run.until. */
int fmu_set_up(void *handle, double start_s, int has_stop, double stop_s);
/* The initialization is over. Only an input that was set before the run may be set during it, so
 * all of them are set. */
int fmu_begin(void *handle);
/* *last_s (may be NULL) becomes the time that was reached, *early whether an event has ended the
 * step before its end. */
int fmu_step(void *handle, double at_s, double step_s, double *last_s, int *early);
int fmu_get(void *handle, const unsigned *reference, size_t count, double *value);
int fmu_set(void *handle, const unsigned *reference, size_t count, const double *value);

/* A state is a copy of the engine. *state: NULL, or an older state, which is freed. */
int fmu_save(void *handle, void **state);
int fmu_restore(void *handle, void *state);
int fmu_forget(void **state);
/* As bytes it is what was asked of the run: who restores it runs to its instant anew, to the bit.
 * So it holds for other instances of the same unit with the same program, at any time. */
int fmu_size_of_state(void *handle, void *state, size_t *size);
int fmu_write_state(void *handle, void *state, void *bytes, size_t size);
int fmu_read_state(void *handle, const void *bytes, size_t size, void **state);

#endif
