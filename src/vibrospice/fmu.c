/* SPDX-License-Identifier: MIT */
#include "fmu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process.h"
#include "vibrospice/protocol.h"

typedef struct saved {
  vibrospice_state *state;
  double input[FMU_MOST_INPUTS], stop_s;
  int begun;
} saved;

int fmu_say(const fmu *u, int status, const char *text) {
  if (u->log) u->log(u, status, text);
  return status;
}

/* The master is told why a call failed. */
static int result(const fmu *u, vibrospice_status status) {
  if (!status) return FMU_OK;
  return fmu_say(u, status == VIBROSPICE_ENGINE ? FMU_FATAL : FMU_ERROR, vibrospice_error());
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
static vibrospice_status set_keys(fmu *u) {
  char path[4200], *row = NULL;
  size_t room = 0;
  vibrospice_status status = VIBROSPICE_OK;
  snprintf(path, sizeof path, "%s/sets.txt", u->resources);
  FILE *f = fopen(path, "r");
  if (!f) return vibrospice_fail(VIBROSPICE_INPUT, "%s cannot be read", path);
  while (!status && getline(&row, &room, f) > 0) {
    row[strcspn(row, "\n")] = '\0';
    char *value = strchr(row, '=');
    if (!value) continue;
    *value++ = '\0';
    status = vibrospice_set(u->run, row, value);
  }
  free(row);
  fclose(f);
  return status;
}

/* Opens the scene that lies in the unit's resources. */
static vibrospice_status open_scene(fmu *u) {
  char path[4200];
  const vibrospice_input *in;
  size_t count;
  snprintf(path, sizeof path, "%s/scene.yaml", u->resources);
  vibrospice_status status = vibrospice_open(path, 0, &u->run);
  if (!status) status = set_keys(u);
  if (!status) status = vibrospice_inputs(u->run, &in, &count);
  if (status) return status;
  u->inputs = count < FMU_MOST_INPUTS ? count : FMU_MOST_INPUTS;
  for (size_t k = 0; k < u->inputs; k++) {
    u->input[k] = in[k].value;
    snprintf(u->input_name[k], sizeof u->input_name[k], "%s", in[k].name);
  }
  return VIBROSPICE_OK;
}

/* ---- an instance ---- */

void fmu_free(fmu *u) {
  if (!u) return;
  vibrospice_free(u->run);
  free(u);
}

fmu *fmu_new(const char *name, const char *resources, const fmu *like) {
  fmu *u = calloc(1, sizeof *u);
  if (!u) return NULL;
  *u = *like;
  snprintf(u->name, sizeof u->name, "%s", name ? name : "");
  path_of_uri(resources ? resources : "", u->resources, sizeof u->resources);
  if (!result(u, open_scene(u))) return u;
  fmu_free(u);
  return NULL;
}

int fmu_reset(fmu *u) {
  vibrospice_free(u->run);
  u->run = NULL;
  u->begun = 0;
  u->stop_s = 0;
  return result(u, open_scene(u));
}

int fmu_set_up(fmu *u, double start_s, int has_stop, double stop_s) {
  if (start_s != 0) return fmu_say(u, FMU_ERROR, "the run begins at 0 s: startTime = 0");
  if (has_stop) u->stop_s = stop_s;
  return FMU_OK;
}

int fmu_begin(fmu *u) {
  char text[64];
  vibrospice_status status = VIBROSPICE_OK;
  snprintf(text, sizeof text, "%.17g s", u->stop_s);
  if (u->stop_s > 0) status = vibrospice_set(u->run, "run.until", text);
  for (size_t k = 0; k < u->inputs && !status; k++)
    status = vibrospice_set_input(u->run, u->input_name[k], u->input[k]);
  u->begun = 1;
  return result(u, status);
}

int fmu_step(fmu *u, double at_s, double step_s) {
  double t_s, until_s, to_s = at_s + step_s;
  vibrospice_status status = vibrospice_time(u->run, &t_s, &until_s);
  if (status) return result(u, status);
  if (fabs(at_s - t_s) > 1e-9 * fmax(t_s, step_s))
    return fmu_say(u, FMU_ERROR,
                   "the step does not begin at the run's time; only a saved state goes back");
  if (to_s > until_s && to_s < until_s + 1e-6 * step_s) to_s = until_s; /* rounding */
  return result(u, vibrospice_run_to(u->run, to_s, NULL, NULL));
}

int fmu_get(fmu *u, const unsigned *r, size_t n, double *value) {
  const double *column;
  size_t count;
  double t_s;
  vibrospice_status status = vibrospice_values(u->run, &column, &count);
  if (!status) status = vibrospice_time(u->run, &t_s, NULL);
  if (status) return result(u, status);
  for (size_t k = 0; k < n; k++)
    if (r[k] == 0)
      value[k] = t_s;
    else if (r[k] >= VIBROSPICE_UNIT_COLUMNS && r[k] - VIBROSPICE_UNIT_COLUMNS < count)
      value[k] = column[r[k] - VIBROSPICE_UNIT_COLUMNS];
    else if (r[k] >= VIBROSPICE_UNIT_INPUTS && r[k] - VIBROSPICE_UNIT_INPUTS < u->inputs)
      value[k] = u->input[r[k] - VIBROSPICE_UNIT_INPUTS];
    else
      return fmu_say(u, FMU_ERROR, "no variable has this value reference");
  return FMU_OK;
}

int fmu_set(fmu *u, const unsigned *r, size_t n, const double *value) {
  vibrospice_status status = VIBROSPICE_OK;
  for (size_t k = 0; k < n && !status; k++) {
    const size_t i = r[k] - VIBROSPICE_UNIT_INPUTS;
    if (r[k] < VIBROSPICE_UNIT_INPUTS || i >= u->inputs)
      return fmu_say(u, FMU_ERROR, "a variable that is not an input cannot be set");
    if (u->input[i] == value[k]) continue;
    if (u->begun) status = vibrospice_set_input(u->run, u->input_name[i], value[k]);
    if (!status) u->input[i] = value[k];
  }
  return result(u, status);
}

/* ---- states ---- */

int fmu_forget(void **state) {
  saved *s = state ? *state : NULL;
  if (!s) return FMU_OK;
  vibrospice_free_state(s->state);
  free(s);
  *state = NULL;
  return FMU_OK;
}

int fmu_save(fmu *u, void **state) {
  saved *s = calloc(1, sizeof *s);
  if (!s) return fmu_say(u, FMU_ERROR, "there is no memory");
  vibrospice_status status = vibrospice_save(u->run, &s->state);
  if (status) {
    free(s);
    return result(u, status);
  }
  memcpy(s->input, u->input, sizeof s->input);
  s->stop_s = u->stop_s;
  s->begun = u->begun;
  fmu_forget(state);
  *state = s;
  return FMU_OK;
}

int fmu_restore(fmu *u, void *state) {
  const saved *s = state;
  vibrospice_status status = vibrospice_restore(u->run, s->state);
  if (status) return result(u, status);
  memcpy(u->input, s->input, sizeof u->input);
  u->stop_s = s->stop_s;
  u->begun = s->begun;
  return FMU_OK;
}
