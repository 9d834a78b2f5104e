/* SPDX-License-Identifier: MIT
 * A functional mock-up unit (FMI 2.0, co-simulation) over libvibrospice: `vibrospice export SCENE
 * -o x.fmu` packs it with the scene. An instance is a handle, so its engine is the program in a
 * process of its own, and a state is a copy of that.
 *
 * What it needs of the standard's headers stands here, by the standard's text. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vibrospice/vibrospice.h"

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef unsigned fmi2ValueReference;
typedef const char *fmi2String;
typedef struct {
  void (*logger)(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...);
  void *(*allocate)(size_t count, size_t size);
  void (*release)(void *memory);
  void (*finished)(void *environment, fmi2Status status);
  void *environment;
} fmi2CallbackFunctions;

#define FMI2 VIBROSPICE_API

/* References: 0 is the time; from INPUTS on stand the scene's inputs, from OUTPUTS on its columns,
 * in their orders. */
enum { INPUTS = 1, OUTPUTS = 100, MOST_INPUTS = 8 };

typedef struct unit {
  fmi2CallbackFunctions call;
  char name[256], resources[4096];
  vibrospice *run;
  double stop_s, input[MOST_INPUTS];
  size_t inputs; /* of the scene */
  char input_name[MOST_INPUTS][64];
  int begun; /* the initialization is over: inputs go to the run */
} unit;

typedef struct saved {
  vibrospice_state *state;
  double input[MOST_INPUTS];
} saved;

static fmi2Status say(const unit *u, fmi2Status status, const char *text) {
  if (u->call.logger)
    u->call.logger(u->call.environment, u->name, status,
                   status == fmi2Fatal ? "logStatusFatal" : "logStatusError", "%s", text);
  return status;
}

/* The master is told why a call failed. */
static fmi2Status result(const unit *u, vibrospice_status status) {
  if (!status) return fmi2OK;
  return say(u, status == VIBROSPICE_ENGINE ? fmi2Fatal : fmi2Error, vibrospice_error());
}

/* ---- the scene ---- */

static int hex(char c) {
  return c >= '0' && c <= '9'                   ? c - '0'
         : ((c | 32) >= 'a' && (c | 32) <= 'f') ? (c | 32) - 'a' + 10
                                                : -1;
}

/* The path of a URI: file:///a%20b. */
static void path_of_uri(const char *uri, char *path, size_t size) {
  if (!strncmp(uri, "file://", 7)) {
    uri += 7;
    if (*uri != '/') uri += strcspn(uri, "/"); /* the host */
  } else if (!strncmp(uri, "file:", 5))
    uri += 5;
  size_t n = 0;
  while (*uri && n + 1 < size) {
    const int coded = *uri == '%' && hex(uri[1]) >= 0 && hex(uri[2]) >= 0;
    path[n++] = coded ? (char)(16 * hex(uri[1]) + hex(uri[2])) : *uri;
    uri += coded ? 3 : 1;
  }
  path[n] = '\0';
}

/* Sets the keys that the unit was exported with: lines KEY=VALUE. */
static vibrospice_status set_keys(unit *u) {
  char path[4200], row[4096];
  vibrospice_status status = VIBROSPICE_OK;
  snprintf(path, sizeof path, "%s/sets.txt", u->resources);
  FILE *f = fopen(path, "r");
  while (f && !status && fgets(row, sizeof row, f)) {
    row[strcspn(row, "\n")] = '\0';
    char *value = strchr(row, '=');
    if (!value) continue;
    *value++ = '\0';
    status = vibrospice_set(u->run, row, value);
  }
  if (f) fclose(f);
  return status;
}

/* Opens the scene that lies in the unit's resources. */
static vibrospice_status open_scene(unit *u) {
  char path[4200];
  const vibrospice_input *in;
  size_t count;
  snprintf(path, sizeof path, "%s/scene.yaml", u->resources);
  vibrospice_status status = vibrospice_open(path, 0, &u->run);
  if (!status) status = set_keys(u);
  if (!status) status = vibrospice_inputs(u->run, &in, &count);
  if (status) return status;
  u->inputs = count < MOST_INPUTS ? count : MOST_INPUTS;
  for (size_t k = 0; k < u->inputs; k++) {
    u->input[k] = in[k].value;
    snprintf(u->input_name[k], sizeof u->input_name[k], "%s", in[k].name);
  }
  return VIBROSPICE_OK;
}

/* ---- the standard's functions ---- */

FMI2 const char *fmi2GetTypesPlatform(void) {
  return "default";
}

FMI2 const char *fmi2GetVersion(void) {
  return "2.0";
}

FMI2 fmi2Status fmi2SetDebugLogging(void *c, int on, size_t n, const fmi2String category[]) {
  (void)c, (void)on, (void)n, (void)category;
  return fmi2OK;
}

FMI2 void fmi2FreeInstance(void *c) {
  unit *u = c;
  if (!u) return;
  vibrospice_free(u->run);
  free(u);
}

FMI2 void *fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                           const fmi2CallbackFunctions *call, int visible, int logs) {
  unit *u = calloc(1, sizeof *u);
  (void)guid, (void)visible, (void)logs;
  if (!u || !call) {
    free(u);
    return NULL;
  }
  u->call = *call;
  snprintf(u->name, sizeof u->name, "%s", name ? name : "");
  path_of_uri(resources ? resources : "", u->resources, sizeof u->resources);
  fmi2Status status = type == 1 ? result(u, open_scene(u))
                                : say(u, fmi2Error, "this unit is for co-simulation alone");
  if (!status) return u;
  fmi2FreeInstance(u);
  return NULL;
}

FMI2 fmi2Status fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start_s,
                                    int has_stop, double stop_s) {
  unit *u = c;
  (void)has_tolerance, (void)tolerance; /* run.tolerance stands in the scene */
  if (start_s != 0) return say(u, fmi2Error, "the run begins at 0 s: startTime = 0");
  if (has_stop) u->stop_s = stop_s;
  return fmi2OK;
}

FMI2 fmi2Status fmi2EnterInitializationMode(void *c) {
  (void)c;
  return fmi2OK;
}

/* An input takes part where its value was set before: then all of them may be set on the way. */
FMI2 fmi2Status fmi2ExitInitializationMode(void *c) {
  unit *u = c;
  char text[64];
  vibrospice_status status = VIBROSPICE_OK;
  snprintf(text, sizeof text, "%.17g s", u->stop_s);
  if (u->stop_s > 0) status = vibrospice_set(u->run, "run.until", text);
  for (size_t k = 0; k < u->inputs && !status; k++)
    status = vibrospice_set_input(u->run, u->input_name[k], u->input[k]);
  u->begun = 1;
  return result(u, status);
}

FMI2 fmi2Status fmi2DoStep(void *c, double at_s, double step_s, int no_going_back) {
  unit *u = c;
  double t_s, until_s, to_s = at_s + step_s;
  (void)no_going_back;
  vibrospice_status status = vibrospice_time(u->run, &t_s, &until_s);
  if (status) return result(u, status);
  if (fabs(at_s - t_s) > 1e-9 * fmax(t_s, step_s))
    return say(u, fmi2Error,
               "the master steps from another instant than the run's; a state goes back");
  if (to_s > until_s && to_s < until_s + 1e-6 * step_s) to_s = until_s; /* rounding */
  return result(u, vibrospice_run_to(u->run, to_s, NULL, NULL));
}

FMI2 fmi2Status fmi2CancelStep(void *c) {
  return say(c, fmi2Error, "a step is done when the call returns");
}

FMI2 fmi2Status fmi2Terminate(void *c) {
  (void)c;
  return fmi2OK;
}

FMI2 fmi2Status fmi2Reset(void *c) {
  unit *u = c;
  vibrospice_free(u->run);
  u->run = NULL;
  u->begun = 0;
  u->stop_s = 0;
  return result(u, open_scene(u));
}

FMI2 fmi2Status fmi2GetReal(void *c, const fmi2ValueReference r[], size_t n, double value[]) {
  unit *u = c;
  const double *column;
  size_t count;
  double t_s;
  vibrospice_status status = vibrospice_values(u->run, &column, &count);
  if (!status) status = vibrospice_time(u->run, &t_s, NULL);
  if (status) return result(u, status);
  for (size_t k = 0; k < n; k++)
    if (r[k] == 0)
      value[k] = t_s;
    else if (r[k] >= OUTPUTS && r[k] - OUTPUTS < count)
      value[k] = column[r[k] - OUTPUTS];
    else if (r[k] >= INPUTS && r[k] - INPUTS < u->inputs)
      value[k] = u->input[r[k] - INPUTS];
    else
      return say(u, fmi2Error, "no variable has this value reference");
  return fmi2OK;
}

FMI2 fmi2Status fmi2SetReal(void *c, const fmi2ValueReference r[], size_t n, const double value[]) {
  unit *u = c;
  vibrospice_status status = VIBROSPICE_OK;
  for (size_t k = 0; k < n && !status; k++) {
    const size_t i = r[k] - INPUTS;
    if (r[k] < INPUTS || i >= u->inputs) return say(u, fmi2Error, "this is no input");
    if (u->input[i] == value[k]) continue;
    if (u->begun) status = vibrospice_set_input(u->run, u->input_name[i], value[k]);
    if (!status) u->input[i] = value[k];
  }
  return result(u, status);
}

/* ---- states ---- */

FMI2 fmi2Status fmi2FreeFMUstate(void *c, void **state) {
  saved *s = state ? *state : NULL;
  (void)c;
  if (!s) return fmi2OK;
  vibrospice_free_state(s->state);
  free(s);
  *state = NULL;
  return fmi2OK;
}

FMI2 fmi2Status fmi2GetFMUstate(void *c, void **state) {
  unit *u = c;
  saved *s = calloc(1, sizeof *s);
  if (!s) return say(u, fmi2Error, "there is no memory");
  vibrospice_status status = vibrospice_save(u->run, &s->state);
  if (status) {
    free(s);
    return result(u, status);
  }
  memcpy(s->input, u->input, sizeof s->input);
  fmi2FreeFMUstate(c, state); /* the one that it takes the place of */
  *state = s;
  return fmi2OK;
}

FMI2 fmi2Status fmi2SetFMUstate(void *c, void *state) {
  unit *u = c;
  const saved *s = state;
  vibrospice_status status = vibrospice_restore(u->run, s->state);
  if (!status) memcpy(u->input, s->input, sizeof u->input);
  return result(u, status);
}

/* ---- what the description does not offer ----
 *
 * A master looks for all of the standard's functions. */

static fmi2Status refuse(const unit *u, size_t asked) {
  return asked ? say(u, fmi2Error, "this unit has no such thing") : fmi2OK;
}

FMI2 fmi2Status fmi2GetInteger(void *c, const fmi2ValueReference r[], size_t n, int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetInteger(void *c, const fmi2ValueReference r[], size_t n, const int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetBoolean(void *c, const fmi2ValueReference r[], size_t n, int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetBoolean(void *c, const fmi2ValueReference r[], size_t n, const int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetString(void *c, const fmi2ValueReference r[], size_t n, fmi2String value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetString(void *c, const fmi2ValueReference r[], size_t n,
                              const fmi2String value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
  (void)state, (void)size;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size) {
  (void)state, (void)bytes, (void)size;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state) {
  (void)bytes, (void)size, (void)state;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2GetDirectionalDerivative(void *c, const fmi2ValueReference z[], size_t n_z,
                                             const fmi2ValueReference v[], size_t n_v,
                                             const double dv[], double dz[]) {
  (void)z, (void)v, (void)n_v, (void)dv, (void)dz;
  return refuse(c, n_z);
}

FMI2 fmi2Status fmi2SetRealInputDerivatives(void *c, const fmi2ValueReference r[], size_t n,
                                            const int order[], const double value[]) {
  (void)r, (void)order, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetRealOutputDerivatives(void *c, const fmi2ValueReference r[], size_t n,
                                             const int order[], double value[]) {
  (void)r, (void)order, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetStatus(void *c, int kind, fmi2Status *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2 fmi2Status fmi2GetIntegerStatus(void *c, int kind, int *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2 fmi2Status fmi2GetBooleanStatus(void *c, int kind, int *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2 fmi2Status fmi2GetStringStatus(void *c, int kind, fmi2String *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

/* Kind 2 is the last successful time. */
FMI2 fmi2Status fmi2GetRealStatus(void *c, int kind, double *value) {
  unit *u = c;
  if (kind != 2) return fmi2Discard;
  return result(u, vibrospice_time(u->run, value, NULL));
}
