/* SPDX-License-Identifier: MIT
 * libvibrospice: the handles. A handle is a number, so that one that was freed is told from all
 * others, whoever has its place now. */
#include "vibrospice/vibrospice.h"

#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "process.h"
#include "vibrospice/protocol.h"

const char *vibrospice_version(void) {
  return VIBROSPICE_VERSION;
}

/* ---- handles ---- */

typedef enum phase { BEFORE, UNDER_WAY, FINISHED, OVER } phase;

/* A list that a text was taken apart into: items of one size, which point into the text. */
typedef struct list {
  char *item;
  size_t count, room;
} list;

/* What is behind a handle. */
typedef struct engine {
  uint32_t number; /* of the handle, above 0 */
  int busy;        /* a thread is in it */
  int is_state;
  pid_t owner; /* the process that opened it */
  vibrospice_process process;
  phase phase;
  double t_s, until_s, *value;
  char *start;                /* the columns as the run begins, as text */
  char *described;            /* the description, whole */
  char *description, *result; /* texts that the lists point into */
  list column, input, measure, line, happening, name;
  int held;
  const char *breach, *summary;
} engine;

/* The table of all engines of the process, and its lock. No number is used again. It goes with its
 * last engine, as a unit's library may be unloaded. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static engine **table;
static size_t places;
static uint32_t last_number;

static void *handle_of(const engine *e) {
  return (void *)(uintptr_t)e->number;
}

/* Enters the engine of a handle, which leave() ends. */
static vibrospice_status enter(const void *handle, int is_state, engine **entered) {
  vibrospice_status status = VIBROSPICE_HANDLE;
  engine *found = NULL;
  pthread_mutex_lock(&lock);
  for (size_t k = 0; k < places && !found && handle; k++)
    if (handle_of(table[k]) == handle && table[k]->is_state == is_state &&
        table[k]->owner == getpid())
      found = table[k];
  if (found) status = found->busy ? VIBROSPICE_BUSY : VIBROSPICE_OK;
  if (!status) found->busy = 1;
  pthread_mutex_unlock(&lock);
  *entered = found;
  if (status == VIBROSPICE_BUSY)
    return vibrospice_fail(status, "another thread or a callback is using this %s",
                           is_state ? "state" : "run");
  if (status)
    return vibrospice_fail(status,
                           "no such %s: the handle was freed, never was one, or belongs to "
                           "another process",
                           is_state ? "state" : "run");
  return VIBROSPICE_OK;
}

static vibrospice_status leave(engine *e, vibrospice_status status) {
  if (e->process.socket < 0 && e->phase < FINISHED) e->phase = OVER;
  pthread_mutex_lock(&lock);
  e->busy = 0;
  pthread_mutex_unlock(&lock);
  return status;
}

/* A place with a new number; it is entered. NULL: no memory. */
static engine *take_place(int is_state) {
  engine *e = NULL;
  pthread_mutex_lock(&lock);
  engine **more = realloc(table, (places + 1) * sizeof *table);
  if (more) table = more;
  if (more) e = calloc(1, sizeof *e);
  if (e) {
    table[places++] = e;
    *e = (engine){.is_state = is_state, .busy = 1, .owner = getpid(), .process.socket = -1};
    while (!++last_number) {
    }
    e->number = last_number;
  }
  pthread_mutex_unlock(&lock);
  return e;
}

static void free_texts(engine *e) {
  list *all[] = {&e->column, &e->input, &e->measure, &e->line, &e->happening, &e->name};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    free(all[k]->item);
    *all[k] = (list){0};
  }
  free(e->described);
  free(e->description);
  free(e->result);
  free(e->value);
  e->described = e->description = e->result = NULL;
  e->value = NULL;
}

static void free_place(engine *e) {
  vibrospice_process_end(&e->process);
  free_texts(e);
  pthread_mutex_lock(&lock);
  size_t k = 0;
  while (table[k] != e) k++;
  table[k] = table[--places];
  if (!places) {
    free(table);
    table = NULL;
  }
  pthread_mutex_unlock(&lock);
  free(e);
}

/* ---- taking texts apart ---- */

enum { MOST_CELLS = 16 };

/* Cuts a line into cells, and returns the next line. Cells that are missing are "". */
static char *cut_line(char *at, const char *cell[MOST_CELLS]) {
  size_t length = strcspn(at, "\n");
  char *next = at[length] ? at + length + 1 : at + length, *rest = at;
  at[length] = '\0';
  for (int k = 0; k < MOST_CELLS; k++) {
    char *word = strsep(&rest, "\t");
    cell[k] = word ? word : "";
  }
  return next;
}

/* Room for one more item, zeroed; NULL: no memory. */
static void *add(list *l, size_t size) {
  if (l->count == l->room) {
    size_t room = l->room ? 2 * l->room : 16;
    char *more = realloc(l->item, room * size);
    if (!more) return NULL;
    l->item = more;
    l->room = room;
  }
  return memset(l->item + size * l->count++, 0, size);
}

/* The engine writes decimal points, and the host's locale may have commas. */
static locale_t points(void) {
  return newlocale(LC_ALL_MASK, "C", NULL); /* a constant, which is not to be freed */
}

static double number(const char *text) {
  return strtod_l(text, NULL, points());
}

static int take_column(engine *e, const char *const *c) {
  vibrospice_column *to = add(&e->column, sizeof *to);
  if (to) *to = (vibrospice_column){c[1], c[2], c[3], c[4], c[5]};
  return !!to;
}

static int take_input(engine *e, const char *const *c) {
  vibrospice_input *to = add(&e->input, sizeof *to);
  if (to) *to = (vibrospice_input){c[1], c[2], number(c[3]), number(c[4]), number(c[5]), c[6]};
  return !!to;
}

static int take_measure(engine *e, const char *const *c) {
  vibrospice_measure *to = add(&e->measure, sizeof *to);
  if (to)
    *to = (vibrospice_measure){.name = c[1],
                               .unit = c[2],
                               .value = number(c[3]),
                               .at_s = number(c[4]),
                               .limit = number(c[5]),
                               .margin = NAN,
                               .error = NAN,
                               .word = ""};
  return !!to;
}

static int take_verdict_line(engine *e, const char *const *c) {
  vibrospice_line *to = add(&e->line, sizeof *to);
  if (to)
    *to = (vibrospice_line){.name = c[1],
                            .unit = c[2],
                            .value = number(c[3]),
                            .at_s = number(c[4]),
                            .least = number(c[5]),
                            .most = number(c[6]),
                            .margin = number(c[7]),
                            .error = number(c[8]),
                            .failed_at_s = number(c[9]),
                            .word = c[10],
                            .why = c[11]};
  return !!to;
}

static int take_happening(engine *e, const char *const *c) {
  vibrospice_happening *to = add(&e->happening, sizeof *to);
  if (to)
    *to = (vibrospice_happening){
        c[1], c[2], c[3], c[4], number(c[5]), strtol(c[6], NULL, 10), *c[7] == '1'};
  return !!to;
}

static int take_name(engine *e, const char *const *c) {
  const char **to = add(&e->name, sizeof *to);
  if (to) *to = c[1];
  return !!to;
}

static int take_rest(engine *e, const char *const *c) {
  if (*c[0] == 'u') e->until_s = number(c[1]);
  if (*c[0] == 'b') e->held = *c[1] == '1', e->breach = c[2];
  return 1;
}

/* Takes all lines of a text apart. 0: no memory. */
static int take_lines(engine *e, char *text) {
  static const struct {
    char first;
    int (*take)(engine *e, const char *const *cell);
  } KINDS[] = {{'c', take_column},       {'i', take_input},     {'m', take_measure},
               {'v', take_verdict_line}, {'h', take_happening}, {'n', take_name},
               {'\0', take_rest}};
  const char *cell[MOST_CELLS];
  while (*text) {
    size_t k = 0;
    if (*text == '0') {
      e->start = text + 1;
      return 1;
    }
    text = cut_line(text, cell);
    if (*cell[0] == 'j') {
      e->summary = text;
      return 1;
    }
    while (KINDS[k].first && KINDS[k].first != *cell[0]) k++;
    if (!KINDS[k].take(e, cell)) return 0;
  }
  return 1;
}

/* The description takes the place of the one before. Without memory the run is over. */
static vibrospice_status take_description(engine *e, char *text) {
  free_texts(e);
  e->start = NULL;
  e->described = strdup(text);
  e->description = text;
  e->t_s = 0;
  int good = e->described && take_lines(e, text);
  e->value = good ? malloc((e->column.count + 1) * sizeof *e->value) : NULL;
  for (size_t k = 0; e->value && k < e->column.count; k++)
    e->value[k] = e->start ? strtod_l(e->start, &e->start, points()) : NAN;
  if (e->value) return VIBROSPICE_OK;
  free_texts(e);
  e->phase = OVER;
  return vibrospice_no_memory();
}

/* Each measure gets what the line of its name has. */
static void join_lines(engine *e) {
  vibrospice_measure *m = (vibrospice_measure *)(void *)e->measure.item;
  const vibrospice_line *line = (const vibrospice_line *)(void *)e->line.item;
  for (size_t k = 0; k < e->measure.count; k++)
    for (size_t n = 0; n < e->line.count; n++)
      if (!strcmp(m[k].name, line[n].name))
        m[k].margin = line[n].margin, m[k].error = line[n].error, m[k].word = line[n].word;
}

/* ---- a scene ---- */

vibrospice_status vibrospice_open(const char *scene, unsigned flags, vibrospice **run) {
  return vibrospice_open_by(NULL, scene, flags, run);
}

vibrospice_status vibrospice_open_by(const char *program, const char *scene, unsigned flags,
                                     vibrospice **run) {
  char mark[16], *text = NULL;
  if (!run) return vibrospice_fail(VIBROSPICE_INPUT, "run is NULL");
  *run = NULL;
  if (!scene) return vibrospice_fail(VIBROSPICE_INPUT, "scene is NULL");
  if (flags & ~(unsigned)(VIBROSPICE_TEXT | VIBROSPICE_ALLOW_CODE))
    return vibrospice_fail(
        VIBROSPICE_INPUT, "flags = %u: VIBROSPICE_TEXT and VIBROSPICE_ALLOW_CODE are all there are",
        flags);
  engine *e = take_place(0);
  if (!e) return vibrospice_no_memory();
  vibrospice_status status = vibrospice_process_start(&e->process, program);
  const int length = snprintf(mark, sizeof mark, "%u ", flags);
  if (!status)
    status = vibrospice_process_ask_for(&e->process, VIBROSPICE_ASK_OPEN, mark, (size_t)length,
                                        scene, &text);
  if (!status) status = take_description(e, text);
  if (status) {
    free_place(e);
    return status;
  }
  *run = handle_of(e);
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_free(vibrospice *run) {
  engine *e;
  if (!run) return VIBROSPICE_OK;
  vibrospice_status status = enter(run, 0, &e);
  if (!status) free_place(e);
  return status;
}

vibrospice_status vibrospice_free_state(vibrospice_state *state) {
  engine *e;
  if (!state) return VIBROSPICE_OK;
  vibrospice_status status = enter(state, 1, &e);
  if (!status) free_place(e);
  return status;
}

/* Enters a run that has not begun. */
static vibrospice_status enter_before(vibrospice *run, engine **e) {
  vibrospice_status status = enter(run, 0, e);
  if (!status && (*e)->phase != BEFORE)
    status = leave(*e, vibrospice_fail(VIBROSPICE_ORDER, "the run has begun"));
  return status;
}

vibrospice_status vibrospice_set(vibrospice *run, const char *key, const char *value) {
  engine *e;
  char *text;
  if (!key || !value) return vibrospice_fail(VIBROSPICE_INPUT, "key or value is NULL");
  if (strchr(key, '=')) return vibrospice_fail(VIBROSPICE_INPUT, "key '%s' contains '='", key);
  vibrospice_status status = enter_before(run, &e);
  if (status) return status;
  const size_t room = strlen(key) + strlen(value) + 2;
  char *assignment = malloc(room);
  if (!assignment) return leave(e, vibrospice_no_memory());
  snprintf(assignment, room, "%s=%s", key, value);
  status = vibrospice_process_ask_for(&e->process, VIBROSPICE_ASK_SET, NULL, 0, assignment, &text);
  free(assignment);
  if (!status) status = take_description(e, text);
  return leave(e, status);
}

vibrospice_status vibrospice_folder(vibrospice *run, const char *folder) {
  engine *e;
  if (!folder || !*folder) return vibrospice_fail(VIBROSPICE_INPUT, "folder is NULL or empty");
  vibrospice_status status = enter_before(run, &e);
  return status ? status
                : leave(e, vibrospice_process_ask_for(&e->process, VIBROSPICE_ASK_FOLDER, NULL, 0,
                                                      folder, NULL));
}

vibrospice_status vibrospice_set_input(vibrospice *run, const char *name, double value) {
  engine *e;
  char *text = NULL;
  if (!name) return vibrospice_fail(VIBROSPICE_INPUT, "name is NULL");
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY) return leave(e, vibrospice_fail(VIBROSPICE_ORDER, "the run is over"));
  status = vibrospice_process_ask_for(&e->process, VIBROSPICE_ASK_INPUT, &value, sizeof value, name,
                                      &text);
  if (!status && e->phase == BEFORE)
    status = take_description(e, text);
  else
    free(text);
  return leave(e, status);
}

/* ---- lists ---- */

/* Enters a run that is finished. */
static vibrospice_status enter_finished(vibrospice *run, engine **e) {
  vibrospice_status status = enter(run, 0, e);
  if (!status && (*e)->phase != FINISHED)
    status = leave(*e, vibrospice_fail(VIBROSPICE_ORDER,
                                       "the run is not finished: call vibrospice_finish first"));
  return status;
}

/* Sets the pointers to a list of the handle's. */
static vibrospice_status give(vibrospice *run, size_t list_at, int of_result, const void **item,
                              size_t *count) {
  engine *e;
  if (!item || !count) return vibrospice_fail(VIBROSPICE_INPUT, "a pointer for the result is NULL");
  *item = NULL;
  *count = 0;
  vibrospice_status status = of_result ? enter_finished(run, &e) : enter(run, 0, &e);
  if (status) return status;
  const list *l = (const list *)(const void *)((const char *)e + list_at);
  *item = l->item;
  *count = l->count;
  return leave(e, VIBROSPICE_OK);
}

#define GIVE(run, member, of_result, item, count)                                                  \
  give(run, offsetof(engine, member), of_result, (const void **)(void *)(item), count)

vibrospice_status vibrospice_columns(vibrospice *run, const vibrospice_column **column,
                                     size_t *count) {
  return GIVE(run, column, 0, column, count);
}

vibrospice_status vibrospice_inputs(vibrospice *run, const vibrospice_input **input,
                                    size_t *count) {
  return GIVE(run, input, 0, input, count);
}

vibrospice_status vibrospice_measures(vibrospice *run, const vibrospice_measure **measure,
                                      size_t *count) {
  return GIVE(run, measure, 1, measure, count);
}

vibrospice_status vibrospice_happened(vibrospice *run, const vibrospice_happening **happening,
                                      size_t *count) {
  return GIVE(run, happening, 1, happening, count);
}

vibrospice_status vibrospice_not_judged(vibrospice *run, const char *const **name, size_t *count) {
  return GIVE(run, name, 1, name, count);
}

vibrospice_status vibrospice_verdict(vibrospice *run, const vibrospice_line **line, size_t *count,
                                     int *held, const char **breach) {
  engine *e;
  if (breach) *breach = NULL;
  vibrospice_status status = GIVE(run, line, 1, line, count);
  if (!status) status = enter(run, 0, &e);
  if (status) return status;
  if (held) *held = e->held;
  if (breach) *breach = e->breach;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_summary(vibrospice *run, const char **json) {
  engine *e;
  if (!json) return vibrospice_fail(VIBROSPICE_INPUT, "json is NULL");
  *json = NULL;
  vibrospice_status status = enter_finished(run, &e);
  if (status) return status;
  *json = e->summary;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_time(vibrospice *run, double *t_s, double *until_s) {
  engine *e;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (t_s) *t_s = e->t_s;
  if (until_s) *until_s = e->until_s;
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_values(vibrospice *run, const double **value, size_t *count) {
  engine *e;
  if (!value || !count)
    return vibrospice_fail(VIBROSPICE_INPUT, "a pointer for the result is NULL");
  *value = NULL;
  *count = 0;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  *value = e->value;
  *count = e->column.count;
  return leave(e, VIBROSPICE_OK);
}

/* ---- time ---- */

/* Takes rows until the answer comes. */
static vibrospice_status take_rows(engine *e, vibrospice_step step, void *context, int *halted) {
  vibrospice_status status;
  for (;;) {
    uint32_t kind;
    size_t size;
    char *data;
    status = vibrospice_process_answer(&e->process, &kind, &data, &size);
    if (status) return status;
    const double *row = (const double *)(void *)data;
    const size_t count = size / sizeof *row;
    if (kind == VIBROSPICE_ROW) *halted = step(context, row, count) != 0;
    if (kind == VIBROSPICE_OK && count == e->column.count) {
      memcpy(e->value, row, size);
      e->t_s = row[0];
    }
    free(data);
    if (kind == VIBROSPICE_OK) return VIBROSPICE_OK;
    if (!vibrospice_process_ask(e->process.socket, *halted ? VIBROSPICE_HALT : VIBROSPICE_GO, NULL,
                                0, NULL, -1))
      return vibrospice_process_died(&e->process);
  }
}

/* After a failure there is no run any more, but the engine may still be there. */
static vibrospice_status end_of_call(engine *e, vibrospice_status status) {
  if (status && status != VIBROSPICE_STOPPED) e->phase = OVER;
  return leave(e, status);
}

static vibrospice_status run_to(vibrospice *run, double t_s, int to_end, int events,
                                vibrospice_step step, void *context) {
  engine *e;
  int halted = 0;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY) return leave(e, vibrospice_fail(VIBROSPICE_ORDER, "the run is over"));
  if (to_end) t_s = e->until_s;
  if (!(t_s > e->t_s))
    return leave(e, vibrospice_fail(VIBROSPICE_TIME, "%.9g s is not after the run's time, %.9g s%s",
                                    t_s, e->t_s,
                                    t_s < e->t_s ? "; only a saved state goes back" : ""));
  if (t_s > e->until_s)
    return leave(e, vibrospice_fail(VIBROSPICE_TIME,
                                    "%.9g s is after the run's end, run.until = %.9g s", t_s,
                                    e->until_s));
  if (e->process.socket < 0)
    return leave(e, vibrospice_fail(VIBROSPICE_ENGINE, "the engine has ended"));
  const vibrospice_ask_run question = {t_s, step != NULL, events != 0};
  e->phase = UNDER_WAY;
  if (!vibrospice_process_ask(e->process.socket, VIBROSPICE_ASK_RUN, &question, sizeof question,
                              NULL, -1))
    return leave(e, vibrospice_process_died(&e->process));
  status = take_rows(e, step, context, &halted);
  if (!status && halted)
    status = vibrospice_fail(VIBROSPICE_STOPPED, "t = %.9g s: stopped by the callback", e->t_s);
  return end_of_call(e, status);
}

vibrospice_status vibrospice_run_to(vibrospice *run, double t_s, vibrospice_step step,
                                    void *context) {
  return run_to(run, t_s, 0, 0, step, context);
}

vibrospice_status vibrospice_run_on(vibrospice *run, vibrospice_step step, void *context) {
  return run_to(run, 0, 1, 0, step, context);
}

vibrospice_status vibrospice_run_to_event(vibrospice *run, double t_s, int events) {
  return run_to(run, t_s, 0, events, NULL, NULL);
}

vibrospice_status vibrospice_finish(vibrospice *run) {
  engine *e;
  char *text;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY)
    return leave(e, vibrospice_fail(VIBROSPICE_ORDER,
                                    e->phase == OVER ? "the run is over" : "the run is finished"));
  status = vibrospice_process_ask_for(&e->process, VIBROSPICE_ASK_FINISH, NULL, 0, NULL, &text);
  if (status) return end_of_call(e, status);
  e->result = text;
  if (!take_lines(e, text)) return end_of_call(e, vibrospice_no_memory());
  join_lines(e);
  e->phase = FINISHED;
  e->t_s = e->until_s;
  return leave(e, VIBROSPICE_OK);
}

/* ---- states ---- */

/* Makes `to`, which begins as zeros, a copy of `of`: the process, and what is known of it. */
static vibrospice_status copy_all(engine *of, engine *to) {
  to->process.socket = -1;
  char *text = strdup(of->described);
  vibrospice_status status = text ? take_description(to, text) : vibrospice_no_memory();
  if (!status) status = vibrospice_process_copy(&of->process, &to->process);
  if (status) {
    vibrospice_process_end(&to->process);
    free_texts(to);
    return status;
  }
  memcpy(to->value, of->value, of->column.count * sizeof *of->value);
  to->t_s = of->t_s;
  to->phase = of->phase;
  return VIBROSPICE_OK;
}

/* Puts `from` in the place of what is behind the handle of `e`. */
static void become(engine *e, engine *from) {
  vibrospice_process_end(&e->process);
  free_texts(e);
  from->number = e->number;
  from->busy = 1;
  from->is_state = e->is_state;
  from->owner = e->owner;
  pthread_mutex_lock(&lock); /* enter() looks at all handles */
  *e = *from;
  pthread_mutex_unlock(&lock);
}

vibrospice_status vibrospice_save(vibrospice *run, vibrospice_state **state) {
  engine *e, copy = {0};
  if (!state) return vibrospice_fail(VIBROSPICE_INPUT, "state is NULL");
  *state = NULL;
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  if (e->phase > UNDER_WAY)
    return leave(
        e, vibrospice_fail(VIBROSPICE_ORDER, "the run is over, and there is nothing to save"));
  engine *saved = take_place(1);
  if (!saved) return leave(e, vibrospice_no_memory());
  status = copy_all(e, &copy);
  if (status) {
    free_place(saved);
    return leave(e, status);
  }
  become(saved, &copy);
  *state = handle_of(saved);
  leave(saved, VIBROSPICE_OK);
  return leave(e, VIBROSPICE_OK);
}

vibrospice_status vibrospice_restore(vibrospice *run, vibrospice_state *state) {
  engine *e, *saved, copy = {0};
  vibrospice_status status = enter(run, 0, &e);
  if (status) return status;
  status = enter(state, 1, &saved);
  if (status) return leave(e, status);
  status = copy_all(saved, &copy);
  if (!status) become(e, &copy);
  leave(saved, VIBROSPICE_OK);
  return leave(e, status);
}
