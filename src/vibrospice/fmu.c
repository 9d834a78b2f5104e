/* SPDX-License-Identifier: MIT */
#include "fmu.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "process.h"
#include "vibrospice/protocol.h"

/* What was asked: an input's number, with its value, or one of these, with where it goes to. */
enum { TO = -1, TO_EVENT = -2 };
struct fmu_deed {
  double what, value;
};

/* What a state has besides the engine; it is the head of its bytes, too. */
typedef struct head {
  char mark[16], token[128];
  uint64_t inputs, deeds, columns;
  double input[FMU_MOST_INPUTS], stop_s;
  int64_t begun;
} head;
static const char MARK[16] = "vibrospice state";

typedef struct saved {
  vibrospice_state *state;
  head head;
  fmu_deed *deed;
  double *column; /* as they are at its instant */
} saved;

/* ---- handles ---- */

/* All instances of the process. It goes with the last one, as the library may be unloaded. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static fmu **table;
static size_t places;
static uint32_t last_number;

/* NULL: there is none of that handle. */
static fmu *find(const void *handle) {
  fmu *found = NULL;
  pthread_mutex_lock(&lock);
  for (size_t k = 0; k < places && !found && handle; k++)
    if ((const void *)(uintptr_t)table[k]->number == handle) found = table[k];
  pthread_mutex_unlock(&lock);
  return found;
}

static int enlist(fmu *u) {
  pthread_mutex_lock(&lock);
  fmu **more = realloc(table, (places + 1) * sizeof *table);
  if (more) {
    table = more;
    table[places++] = u;
    u->number = ++last_number;
  }
  pthread_mutex_unlock(&lock);
  return more != NULL;
}

static void strike(const fmu *u) {
  size_t k = 0;
  pthread_mutex_lock(&lock);
  while (table[k] != u) k++;
  table[k] = table[--places];
  if (!places) {
    free(table);
    table = NULL;
  }
  pthread_mutex_unlock(&lock);
}

/* ---- errors ---- */

static int say(const fmu *u, int status, const char *text) {
  if (u->log) u->log(u, status, text);
  return status;
}

int fmu_say(void *handle, int status, const char *text) {
  const fmu *u = find(handle);
  return u ? say(u, status, text) : FMU_ERROR;
}

/* The master is told why a call failed. */
static int result(const fmu *u, vibrospice_status status) {
  if (!status) return FMU_OK;
  return say(u, status == VIBROSPICE_ENGINE ? FMU_FATAL : FMU_ERROR, vibrospice_error());
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

/* The master's token has to be the unit's, which lies in its resources; no token: any unit's. */
static vibrospice_status check_token(const fmu *u) {
  char path[4200], own[sizeof u->token] = "";
  snprintf(path, sizeof path, "%s/token.txt", u->resources);
  FILE *f = fopen(path, "r");
  if (!f || !fgets(own, sizeof own, f)) *own = '\0';
  if (f) fclose(f);
  own[strcspn(own, "\n")] = '\0';
  if (!*own) return vibrospice_fail(VIBROSPICE_INPUT, "%s cannot be read", path);
  return strcmp(own, u->token) == 0
             ? VIBROSPICE_OK
             : vibrospice_fail(
                   VIBROSPICE_INPUT,
                   "the token '%s' is of another unit: the one of these resources is '%s'",
                   u->token, own);
}

/* The program that the unit brings along; false: it brings none. Who unpacks a unit may leave out
 * that the file is a program. */
static int find_packed(const fmu *u, char path[4200]) {
  struct stat s;
  snprintf(path, 4200, "%s/program/bin/vibrospice", u->resources);
  if (stat(path, &s) || !S_ISREG(s.st_mode)) return 0;
  if (access(path, X_OK)) (void)!chmod(path, 0755);
  return 1;
}

/* Opens the scene that lies in the unit's resources. */
static vibrospice_status open_scene(fmu *u) {
  char path[4200], program[4200];
  const vibrospice_input *in;
  size_t count;
  snprintf(path, sizeof path, "%s/scene.yaml", u->resources);
  vibrospice_status status =
      vibrospice_open_by(find_packed(u, program) ? program : NULL, path, 0, &u->run);
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

/* Ends its run, and forgets what was asked of it. */
static void end_run(fmu *u) {
  vibrospice_free(u->run);
  free(u->deed);
  u->run = NULL;
  u->deed = NULL;
  u->deeds = u->room = 0;
  u->begun = 0;
  u->stop_s = 0;
}

void fmu_free(void *handle) {
  fmu *u = find(handle);
  if (!u) return;
  strike(u);
  end_run(u);
  free(u);
}

void *fmu_new(const char *name, const char *token, const char *resources, const fmu *like) {
  fmu *u = calloc(1, sizeof *u);
  if (!u) return NULL;
  *u = *like;
  snprintf(u->name, sizeof u->name, "%s", name ? name : "");
  snprintf(u->token, sizeof u->token, "%s", token ? token : "");
  path_of_uri(resources ? resources : "", u->resources, sizeof u->resources);
  vibrospice_status status = check_token(u);
  if (!status) status = open_scene(u);
  if (!result(u, status) && enlist(u)) return (void *)(uintptr_t)u->number;
  end_run(u);
  free(u);
  return NULL;
}

int fmu_reset(void *handle) {
  fmu *u = find(handle);
  if (!u) return FMU_ERROR;
  end_run(u);
  return result(u, open_scene(u));
}

int fmu_set_up(void *handle, double start_s, int has_stop, double stop_s) {
  fmu *u = find(handle);
  if (!u) return FMU_ERROR;
  if (start_s != 0) return say(u, FMU_ERROR, "the run begins at 0 s: startTime = 0");
  if (has_stop) u->stop_s = stop_s;
  return FMU_OK;
}

/* Does what is asked of the run, and notes it. */
static vibrospice_status act(fmu *u, double what, double value) {
  if (u->deeds == u->room) {
    const size_t room = u->room ? 2 * u->room : 64;
    fmu_deed *more = realloc(u->deed, room * sizeof *more);
    if (!more) return vibrospice_no_memory();
    u->deed = more;
    u->room = room;
  }
  vibrospice_status status = what >= 0
                                 ? vibrospice_set_input(u->run, u->input_name[(size_t)what], value)
                                 : vibrospice_run_to_event(u->run, value, what == TO_EVENT);
  if (!status) u->deed[u->deeds++] = (fmu_deed){what, value};
  return status;
}

static vibrospice_status set_stop(const fmu *u) {
  char text[64];
  snprintf(text, sizeof text, "%.17g s", u->stop_s);
  return u->stop_s > 0 ? vibrospice_set(u->run, "run.until", text) : VIBROSPICE_OK;
}

int fmu_begin(void *handle) {
  fmu *u = find(handle);
  if (!u) return FMU_ERROR;
  vibrospice_status status = set_stop(u);
  for (size_t k = 0; k < u->inputs && !status; k++) status = act(u, (double)k, u->input[k]);
  u->begun = 1;
  return result(u, status);
}

int fmu_step(void *handle, double at_s, double step_s, double *last_s, int *early) {
  fmu *u = find(handle);
  double t_s, until_s, to_s = at_s + step_s;
  if (!u) return FMU_ERROR;
  vibrospice_status status = vibrospice_time(u->run, &t_s, &until_s);
  if (last_s) *last_s = t_s;
  if (status) return result(u, status);
  if (!u->begun) return say(u, FMU_ERROR, "the initialization is not over");
  if (!(fabs(at_s - t_s) <= 1e-9 * fmax(t_s, step_s)))
    return say(u, FMU_ERROR,
               "the step does not begin at the run's time; only a saved state goes back");
  if (to_s > until_s && to_s < until_s + 1e-6 * step_s) to_s = until_s; /* rounding */
  status = act(u, u->early ? TO_EVENT : TO, to_s);
  if (!status) status = vibrospice_time(u->run, &t_s, NULL);
  if (last_s) *last_s = t_s;
  if (early) *early = !status && t_s < to_s;
  return result(u, status);
}

int fmu_get(void *handle, const unsigned *r, size_t n, double *value) {
  const fmu *u = find(handle);
  const double *column;
  size_t count;
  double t_s;
  if (!u) return FMU_ERROR;
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
      return say(u, FMU_ERROR, "no variable has this value reference");
  return FMU_OK;
}

int fmu_set(void *handle, const unsigned *r, size_t n, const double *value) {
  fmu *u = find(handle);
  if (!u) return FMU_ERROR;
  vibrospice_status status = VIBROSPICE_OK;
  for (size_t k = 0; k < n && !status; k++) {
    const size_t i = r[k] - VIBROSPICE_UNIT_INPUTS;
    if (r[k] < VIBROSPICE_UNIT_INPUTS || i >= u->inputs)
      return say(u, FMU_ERROR, "a variable that is not an input cannot be set");
    if (u->input[i] == value[k]) continue;
    if (u->begun) status = act(u, (double)i, value[k]);
    if (!status) u->input[i] = value[k];
  }
  return result(u, status);
}

/* ---- states ---- */

int fmu_forget(void **state) {
  saved *s = state ? *state : NULL;
  if (!s) return FMU_OK;
  vibrospice_free_state(s->state);
  free(s->deed);
  free(s->column);
  free(s);
  *state = NULL;
  return FMU_OK;
}

/* A copy, to be freed; NULL: no memory. */
static void *copy_of(const void *from, size_t size) {
  void *to = malloc(size + 1);
  if (to && size) memcpy(to, from, size);
  return to;
}

static vibrospice_status save(const fmu *u, saved *s) {
  const double *column;
  size_t count;
  vibrospice_status status = vibrospice_values(u->run, &column, &count);
  if (status) return status;
  s->head = (head){.inputs = u->inputs,
                   .deeds = u->deeds,
                   .columns = count,
                   .stop_s = u->stop_s,
                   .begun = u->begun};
  memcpy(s->head.mark, MARK, sizeof MARK);
  memcpy(s->head.token, u->token, sizeof u->token);
  memcpy(s->head.input, u->input, sizeof u->input);
  s->deed = copy_of(u->deed, u->deeds * sizeof *u->deed);
  s->column = copy_of(column, count * sizeof *column);
  return s->deed && s->column ? vibrospice_save(u->run, &s->state) : vibrospice_no_memory();
}

int fmu_save(void *handle, void **state) {
  const fmu *u = find(handle);
  if (!u) return FMU_ERROR;
  void *s = calloc(1, sizeof(saved));
  if (!s) return say(u, FMU_ERROR, "there is no memory");
  vibrospice_status status = save(u, s);
  if (status) {
    fmu_forget(&s);
    return result(u, status);
  }
  fmu_forget(state);
  *state = s;
  return FMU_OK;
}

int fmu_restore(void *handle, void *state) {
  fmu *u = find(handle);
  const saved *s = state;
  if (!u) return FMU_ERROR;
  if (!s) return say(u, FMU_ERROR, "there is no such state");
  if (strcmp(s->head.token, u->token) != 0) return say(u, FMU_ERROR, "the state is another unit's");
  fmu_deed *deed = copy_of(s->deed, s->head.deeds * sizeof *deed);
  vibrospice_status status = deed ? vibrospice_restore(u->run, s->state) : vibrospice_no_memory();
  if (status) {
    free(deed);
    return result(u, status);
  }
  free(u->deed);
  u->deed = deed;
  u->deeds = u->room = s->head.deeds;
  memcpy(u->input, s->head.input, sizeof u->input);
  u->stop_s = s->head.stop_s;
  u->begun = (int)s->head.begun;
  return FMU_OK;
}

/* ---- states as bytes: the head, the deeds, the columns ---- */

static size_t size_of(const head *h) {
  return sizeof *h + h->deeds * sizeof(fmu_deed) + h->columns * sizeof(double);
}

int fmu_size_of_state(void *handle, void *state, size_t *size) {
  if (!find(handle)) return FMU_ERROR;
  if (!state) return fmu_say(handle, FMU_ERROR, "there is no such state");
  *size = size_of(&((const saved *)state)->head);
  return FMU_OK;
}

int fmu_write_state(void *handle, void *state, void *bytes, size_t size) {
  const saved *s = state;
  char *to = bytes;
  if (!find(handle)) return FMU_ERROR;
  if (!s || !bytes || size < size_of(&s->head))
    return fmu_say(handle, FMU_ERROR, "there is no such state, or no room for it");
  memcpy(to, &s->head, sizeof s->head);
  to += sizeof s->head;
  memcpy(to, s->deed, s->head.deeds * sizeof *s->deed);
  memcpy(to + s->head.deeds * sizeof *s->deed, s->column, s->head.columns * sizeof *s->column);
  return FMU_OK;
}

/* What is wrong with the bytes; NULL: nothing. */
static const char *check_bytes(const fmu *u, const head *h, const char *deed, size_t size) {
  fmu_deed d;
  if (memcmp(h->mark, MARK, sizeof MARK) != 0) return "these bytes are no state of a unit's";
  if (strncmp(h->token, u->token, sizeof h->token) != 0) return "the state is another unit's";
  if (h->deeds > size || h->columns > size || size_of(h) != size || h->inputs != u->inputs)
    return "the state is not whole";
  for (uint64_t k = 0; k < h->deeds; k++) {
    memcpy(&d, deed + k * sizeof d, sizeof d);
    if (d.what != TO && d.what != TO_EVENT && !(d.what >= 0 && d.what < (double)u->inputs))
      return "the state is damaged";
  }
  return NULL;
}

/* Runs another instance to the state's instant, where it must have the same columns. */
static vibrospice_status run_anew(fmu *u, const head *h, const char *deed) {
  const double *column;
  size_t count;
  fmu_deed d;
  vibrospice_status status = open_scene(u);
  u->stop_s = h->stop_s;
  u->begun = (int)h->begun;
  if (!status && u->begun) status = set_stop(u);
  for (uint64_t k = 0; k < h->deeds && !status; k++) {
    memcpy(&d, deed + k * sizeof d, sizeof d);
    status = act(u, d.what, d.value);
  }
  memcpy(u->input, h->input, sizeof u->input);
  if (!status) status = vibrospice_values(u->run, &column, &count);
  if (!status && (count != h->columns ||
                  memcmp(column, deed + h->deeds * sizeof d, count * sizeof *column) != 0))
    status = vibrospice_fail(VIBROSPICE_INPUT, "run anew, the state comes to other values: another "
                                               "program or another unit has written it");
  return status;
}

int fmu_read_state(void *handle, const void *bytes, size_t size, void **state) {
  const fmu *u = find(handle);
  const char *deed = (const char *)bytes + sizeof(head);
  head h;
  if (!u) return FMU_ERROR;
  if (!bytes || size < sizeof h) return say(u, FMU_ERROR, "these bytes are no state of a unit's");
  memcpy(&h, bytes, sizeof h);
  const char *wrong = check_bytes(u, &h, deed, size);
  if (wrong) return say(u, FMU_ERROR, wrong);
  fmu other = *u;
  other.run = NULL;
  other.deed = NULL;
  other.deeds = other.room = 0;
  void *s = calloc(1, sizeof(saved));
  vibrospice_status status = s ? run_anew(&other, &h, deed) : vibrospice_no_memory();
  if (!status) status = save(&other, s);
  const int told = result(u, status);
  end_run(&other);
  if (status) {
    fmu_forget(&s);
    return told;
  }
  fmu_forget(state);
  *state = s;
  return FMU_OK;
}
