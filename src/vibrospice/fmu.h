/* SPDX-License-Identifier: MIT
 * An instance of a functional mock-up unit, whatever the version of the standard: `vibrospice
 * export SCENE -o x.fmu` packs the shim with the scene. An instance is a handle of libvibrospice,
 * so its engine is the program in a process of its own, and a state is a copy of that. */
#ifndef VIBROSPICE_FMU_H
#define VIBROSPICE_FMU_H

#include <stddef.h>

#include "vibrospice/vibrospice.h"

/* As FMI 2.0 and 3.0 number them. */
enum { FMU_OK = 0, FMU_DISCARD = 2, FMU_ERROR = 3, FMU_FATAL = 4 };

enum { FMU_MOST_INPUTS = 8 };

typedef struct fmu {
  void (*log)(const struct fmu *u, int status, const char *text); /* tells the master */
  void *environment, *call; /* the master's; a function of the standard's for the former */
  char name[256], resources[4096];
  vibrospice *run;
  double stop_s; /* 0: the scene's own */
  double input[FMU_MOST_INPUTS];
  size_t inputs; /* of the scene */
  char input_name[FMU_MOST_INPUTS][64];
  int begun; /* the initialization is over: inputs go to the run */
} fmu;

/* Says the text to the master and returns the status. */
int fmu_say(const fmu *u, int status, const char *text);
/* Makes an instance of a unit whose resources lie in that folder, or under that URI. NULL: it
 * cannot be, and log has been told. */
fmu *fmu_new(const char *name, const char *resources, const fmu *like);
void fmu_free(fmu *u);
int fmu_reset(fmu *u);
/* A run begins at 0 s; has_stop: and ends at stop_s instead of run.until. */
int fmu_set_up(fmu *u, double start_s, int has_stop, double stop_s);
/* The initialization is over. Only an input that was set before the run may be set during it, so
 * all of them are set. */
int fmu_begin(fmu *u);
int fmu_step(fmu *u, double at_s, double step_s);
int fmu_get(fmu *u, const unsigned *reference, size_t count, double *value);
int fmu_set(fmu *u, const unsigned *reference, size_t count, const double *value);
/* *state: NULL, or an older state, which is freed. */
int fmu_save(fmu *u, void **state);
int fmu_restore(fmu *u, void *state);
int fmu_forget(void **state);

#endif
