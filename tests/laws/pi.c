/* SPDX-License-Identifier: MIT
 * A controller as a functional mock-up unit for co-simulation, of FMI 2.0 or, compiled with FMI3,
 * of FMI 3.0. It is the law of spice/control/trim.c: as long as the swing, half of highest -
 * lowest, is less than the set point it fires a little earlier in each cycle, else a little later.
 *
 *   1 lowest, 2 highest   inputs, m         3 setpoint  parameter, m
 *   4 angle               output, deg       5 trouble   parameter, whole: what it does wrong
 *   6 enabled             input, true or false: without it the angle stays */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#define UNIT __attribute__((visibility("default")))
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the standard says which there are */

enum { LOWEST = 1, HIGHEST, SETPOINT, ANGLE, TROUBLE, ENABLED };

/* What it does wrong. */
enum { NOTHING, NO_STEP, CRASH, HANG };

typedef struct pi {
  double real[ANGLE + 1], t_s;
  int trouble, enabled;
  void *environment;
  void (*log2)(void *, const char *, int, const char *, const char *, ...);
  void (*log3)(void *, int, const char *, const char *);
} pi;

static pi *new_unit(void) {
  pi *u = calloc(1, sizeof *u);
  u->real[SETPOINT] = 1e-3;
  u->real[ANGLE] = 150;
  u->enabled = 1;
  return u;
}

/* 3: an error, as both versions of the standard have it. */
static int step(pi *u, double at_s, double step_s) {
  static const char *const LOST = "lost %d";
  if (u->trouble == CRASH) abort();
  if (u->trouble == HANG) sleep(60);
  if (u->trouble == NO_STEP || at_s != u->t_s) {
    if (u->log2) u->log2(u->environment, "pi", 3, "error", LOST, 7);
    if (u->log3) u->log3(u->environment, 3, "error", "lost 7");
    return 3;
  }
  u->t_s = at_s + step_s;
  if (!u->enabled) return 0;
  const double angle =
      u->real[ANGLE] - 2000 * (u->real[SETPOINT] - (u->real[HIGHEST] - u->real[LOWEST]) / 2);
  u->real[ANGLE] = angle < 90 ? 90 : angle > 170 ? 170 : angle;
  return 0;
}

static int get_real(const pi *u, const unsigned r[], size_t n, double value[]) {
  for (size_t k = 0; k < n; k++) value[k] = u->real[r[k]];
  return 0;
}

static int set_real(pi *u, const unsigned r[], size_t n, const double value[]) {
  for (size_t k = 0; k < n; k++) u->real[r[k]] = value[k];
  return 0;
}

#ifndef FMI3

typedef struct callbacks {
  void (*logger)(void *, const char *, int, const char *, const char *, ...);
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, int);
  void *environment;
} callbacks;

UNIT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                           const callbacks *call, int visible, int logs) {
  pi *u = new_unit();
  u->log2 = call->logger;
  u->environment = call->environment;
  return u;
}
UNIT int fmi2SetupExperiment(pi *u, int has_tolerance, double tolerance, double start_s,
                             int has_stop, double stop_s) {
  u->t_s = start_s;
  return 0;
}
UNIT int fmi2EnterInitializationMode(pi *u) {
  return 0;
}
UNIT int fmi2ExitInitializationMode(pi *u) {
  return 0;
}
UNIT int fmi2DoStep(pi *u, double at_s, double step_s, int no_going_back) {
  return step(u, at_s, step_s);
}
UNIT int fmi2GetReal(const pi *u, const unsigned r[], size_t n, double value[]) {
  return get_real(u, r, n, value);
}
UNIT int fmi2SetReal(pi *u, const unsigned r[], size_t n, const double value[]) {
  return set_real(u, r, n, value);
}
UNIT int fmi2SetInteger(pi *u, const unsigned r[], size_t n, const int value[]) {
  u->trouble = value[0];
  return 0;
}
UNIT int fmi2SetBoolean(pi *u, const unsigned r[], size_t n, const int value[]) {
  u->enabled = value[0];
  return 0;
}
UNIT int fmi2Terminate(pi *u) {
  return 0;
}
UNIT void fmi2FreeInstance(pi *u) {
  free(u);
}

#else

UNIT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                       bool visible, bool logs, bool events, bool early,
                                       const unsigned wanted[], size_t n_wanted, void *environment,
                                       void (*logger)(void *, int, const char *, const char *),
                                       void *update) {
  pi *u = new_unit();
  u->log3 = logger;
  u->environment = environment;
  return u;
}
UNIT int fmi3EnterInitializationMode(pi *u, bool has_tolerance, double tolerance, double start_s,
                                     bool has_stop, double stop_s) {
  u->t_s = start_s;
  return 0;
}
UNIT int fmi3ExitInitializationMode(pi *u) {
  return 0;
}
UNIT int fmi3DoStep(pi *u, double at_s, double step_s, bool no_going_back, bool *events, bool *ends,
                    bool *early, double *last_s) {
  *events = *ends = *early = false;
  *last_s = at_s + step_s;
  return step(u, at_s, step_s);
}
UNIT int fmi3GetFloat64(const pi *u, const unsigned r[], size_t n, double value[], size_t values) {
  return get_real(u, r, n, value);
}
UNIT int fmi3SetFloat64(pi *u, const unsigned r[], size_t n, const double value[], size_t values) {
  return set_real(u, r, n, value);
}
UNIT int fmi3SetInt16(pi *u, const unsigned r[], size_t n, const int16_t value[], size_t values) {
  u->trouble = value[0];
  return 0;
}
UNIT int fmi3SetBoolean(pi *u, const unsigned r[], size_t n, const bool value[], size_t values) {
  u->enabled = value[0];
  return 0;
}
UNIT int fmi3Terminate(pi *u) {
  return 0;
}
UNIT void fmi3FreeInstance(pi *u) {
  free(u);
}

#endif
