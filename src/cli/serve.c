/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `serve`: the engine of a handle of libvibrospice (vibrospice/vibrospice.h). It
 * answers the questions of vibrospice/protocol.h on the socket that is its standard input, and ends
 * with it.
 *
 * A tier owns the loop over time, and the questions come in between: at an instant that was asked
 * for, the run waits within the step that holds it until it is told how far to go on. A copy of the
 * process waits there just so. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/shutdown.h"
#include "base/text.h"
#include "base/units.h"
#include "commands.h"
#include "measure/unjudged.h"
#include "plant/build.h"
#include "run.h"
#include "run/listed_measure.h"
#include "run/session.h"
#include "serve.h"
#include "vibrospice/protocol.h"
#include "vibrospice/vibrospice.h"

/* ---- inputs ---- */

enum { ANGLE, VOLTAGE, FRACTION, VOLUME, FREQUENCY, INPUTS };

static const struct input {
  const char *name, *unit, *text;
} INPUT[INPUTS] = {
    {"firing.angle", "deg",
     "angle of the next firing, taken as its cycle of the mains begins; NaN: no firing"},
    {"supply.voltage", "V", "of the mains, rms, or direct as the scene has them; at once"},
    {"load.fraction", "", "share of the conveyed material that rides; at once"},
    {"load.volume", "cm3", "of the conveyed material; at once"},
    {"supply.frequency", "Hz",
     "of the mains; before the run only, as the cycles of its firings are counted by it"}};

/* How far the mains may be set above the scene's, as by the event swell; and how often a load. */
static const double HIGHEST = 3, LOWEST_HZ = 0.1, HIGHEST_HZ = 1e4;
enum { MOST_LOADS = 4096 };

/* What has been set from outside. All of it is kept, so that the second run gets the same. */
static struct given {
  bool set[INPUTS];     /* before the run began: such an input may be set during it */
  double value[INPUTS]; /* in the input's unit */
  double most_v;        /* of VOLTAGE, by the scene as it was before that was set */
  double *decided;      /* angles of all firings up to now, rad; owned */
  long n_decided;
  struct {
    double at_s, volt;
  } * mains; /* from at_s on; owned, in order of time */
  size_t n_mains;
  vs_loads *loads; /* of the run's setup: the changes, and behind them a place for the next, at the
                      next instant at which one may be set */
  bool loaded;     /* that place is taken */
  double next_s;   /* that instant; INFINITY: there is none any more */
} given;           /* a process has one engine, and the plugs below have no context of their own */

static vs_status decide_as_given(void *self, const vs_control_input *sight, double *angle_rad,
                                 vs_error *err) {
  (void)self, (void)err;
  if (sight->firing == given.n_decided) {
    given.decided = vs_resize(given.decided, (uint64_t)given.n_decided + 1, sizeof(double));
    given.decided[given.n_decided++] = given.value[ANGLE] * vs_units_factor("deg");
  }
  *angle_rad = given.decided[sight->firing];
  return VS_OK;
}

static const vs_regulator given_angle = {
    .name = "none", .text = "fires at what is set from outside", .decide = decide_as_given};

static double given_mains(const vs_scene_event *e, double t_s, double angle_rad) {
  (void)angle_rad;
  size_t k = given.n_mains;
  while (k > 0 && given.mains[k - 1].at_s + vs_scene_event_rounding(t_s) >= t_s) k--;
  return k ? given.mains[k - 1].volt / e->v.level_v : 1;
}

static double next_setting(const vs_scene_event *e, double t_s) {
  (void)e;
  double next_s = given.next_s > t_s ? given.next_s : INFINITY;
  for (size_t k = given.n_mains; k-- > 0 && given.mains[k].at_s > t_s;)
    next_s = fmin(next_s, given.mains[k].at_s);
  for (size_t k = given.loads ? given.loads->count : 0; k-- > 0;)
    if (given.loads->item[k].at_s > t_s) next_s = fmin(next_s, given.loads->item[k].at_s);
  return next_s;
}

/* The mains and the load, as an event of the run's: each instant at which something may be set, or
 * was, is the end of a step. */
static const vs_event_kind given_kind = {.name = "input",
                                         .text = "the mains or the load are set from outside",
                                         .ideal = true,
                                         .mains = given_mains,
                                         .stage = VS_MAINS_FACTOR,
                                         .edge = next_setting};

static bool is_loaded(int k) {
  return k == FRACTION || k == VOLUME;
}

/* Why that could not be an input of the scene, whose run has not begun; NULL: it could. */
static const char *why_unfit(const vs_scene *s, int k) {
  const vs_setup *setup = &s->setup;
  const vs_regulator *law = s->control.regulator;
  if (k == FREQUENCY) return setup->timeline.supply.direct ? "the mains are direct" : NULL;
  if (k != ANGLE && setup->timeline.events.count == VS_EVENTS_MOST)
    return "the scene already has as many events as are allowed";
  if (k == ANGLE && law && strcmp(law->name, given_angle.name) != 0)
    return "the scene's control decides it";
  if (k == ANGLE && (setup->timeline.firing.no_valve || !setup->timeline.firing.every))
    return "no thyristor is fired cycle by cycle (firing.every)";
  if (k == ANGLE && setup->timeline.firing.angle.count > 1)
    return "it is a list of angles over time; set the key firing.angle to one of them first";
  if (is_loaded(k) && setup->machine->load.adds < 0) return "the machine has no load";
  if (is_loaded(k) && setup->loads.count) return "events change the load";
  if (k == FRACTION && isnan(setup->model.load.fraction)) return "it is computed from the orbit";
  return NULL;
}

/* Why that is no input of the scene; NULL: it is one. */
static const char *why_no_input(const vs_scene *s, int k) {
  return given.set[k] ? NULL : why_unfit(s, k);
}

static double value_in_scene(const vs_setup *setup, int k) {
  const double si[INPUTS] = {setup->timeline.firing.angle.first, setup->timeline.supply.voltage_v,
                             setup->model.load.fraction, setup->model.load.volume_m3,
                             setup->timeline.supply.frequency_hz};
  return si[k] / vs_units_factor(INPUT[k].unit);
}

/* An angle lies within control.angle, if there is such a control. */
typedef struct range {
  double least, most;
} range;
static range range_of_input(const vs_scene *s, int k) {
  const double *angle = s->control.regulator ? s->control.v.angle_rad : (double[]){0, M_PI};
  const double deg = vs_units_factor("deg"), own_v = HIGHEST * s->setup.timeline.supply.voltage_v;
  const range all[INPUTS] = {{angle[0] / deg, angle[1] / deg},
                             {0, given.set[VOLTAGE] ? given.most_v : own_v},
                             {0, 1},
                             {0, 1e9},
                             {LOWEST_HZ, HIGHEST_HZ}};
  return all[k];
}

/* In a scene that was read anew, what was set as an input still is one, with its value. */
static vs_status check_given(const vs_scene *s, vs_error *err) {
  for (int k = 0; k < INPUTS; k++) {
    const double value = given.value[k];
    if (!given.set[k]) continue;
    const char *why = why_unfit(s, k);
    if (why)
      return vs_fail(err, VS_INPUT, "%s was set as an input, and would be none: %s", INPUT[k].name,
                     why);
    if (fabs(value_in_scene(&s->setup, k) - value) > 1e-9 * value)
      return vs_fail(err, VS_INPUT, "%s was set as an input, to %g %s; set it so again",
                     INPUT[k].name, value, INPUT[k].unit);
  }
  return VS_OK;
}

/* What the load is up to the place for the next change. */
static const vs_model *model_before(const vs_setup *setup) {
  const vs_loads *all = given.loads;
  return all->count > 1 ? &all->item[all->count - 2].model : &setup->model;
}

/* Offers a place at an instant behind the run's last step. Whoever tries the setup beforehand
 * (engine/pace.h) may take it: nothing changes there then. */
static void offer_load_place(const vs_setup *setup, double at_s) {
  vs_loads *all = given.loads;
  if (!all) return;
  if (given.loaded) all->count++; /* what was set there stays */
  given.loaded = false;
  if (all->count <= MOST_LOADS) all->item[all->count - 1] = (vs_loaded){at_s, *model_before(setup)};
}

/* The load becomes what was set, from at_s on. */
static vs_status change_load(vs_scene *s, double at_s, vs_error *err) {
  vs_loads *all = given.loads;
  if (all->count > MOST_LOADS)
    return vs_fail(err, VS_INPUT, "the load can be set %d times, and was", MOST_LOADS);
  vs_loaded *to = &all->item[all->count - 1];
  const vs_model *from = model_before(&s->setup);
  vs_load_values load = from->load;
  if (given.set[FRACTION]) load.fraction = given.value[FRACTION];
  if (given.set[VOLUME]) load.volume_m3 = given.value[VOLUME] * vs_units_factor("cm3");
  to->at_s = at_s;
  given.loaded = true;
  return vs_build_loaded(s->setup.machine, from, &load,
                         given.set[FRACTION] ? load.fraction : from->riding, &to->model, err);
}

/* ---- the engine ---- */

typedef struct engine {
  vs_run_options options;
  unsigned flags;
  char *source; /* the scene's name, path or text; owned. NULL: nothing is open */
  char **sets;  /* owned, as what they point to */
  vs_scene *scene;
  int ladder;       /* the run.ladder of the scene */
  bool begun;       /* the run is under way */
  bool finishing;   /* its result is asked for */
  double t_s;       /* up to where it was asked for */
  double target_s;  /* up to where it goes on */
  double from_s;    /* where it was told last before that */
  double row_s;     /* of the last row */
  bool rows;        /* are wanted on the way */
  bool events;      /* it stops at one */
  double seen_s[2]; /* from where to where the step goes whose events were looked at */
  int seen;         /* how many of them */
  unsigned steps;
  vs_text question; /* what follows the head of the one that is under way */
  vs_text result;
} engine;

enum { SOCKET = STDIN_FILENO };

/* The other end is gone: so is this one, with the files it has begun. */
static _Noreturn void leave(void) {
  vs_shutdown_now(0, 0, "", 0);
}

static void say(const void *data, size_t size) {
  const char *at = data;
  while (size > 0) {
    ssize_t n = send(SOCKET, at, size, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR) leave();
    if (n > 0) at += n, size -= (size_t)n;
  }
}

static void answer(uint32_t kind, const void *data, size_t size) {
  char small[1024];
  const vibrospice_head head = {kind, (uint32_t)size};
  if (size > sizeof small - sizeof head) {
    say(&head, sizeof head);
    say(data, size);
    return;
  }
  memcpy(small, &head, sizeof head);
  if (size) memcpy(small + sizeof head, data, size);
  say(small, sizeof head + size);
}

static void answer_text(uint32_t kind, const char *text) {
  answer(kind, text, strlen(text));
}

static void answer_status(vs_status status, const vs_error *err) {
  answer_text(status == VS_INPUT ? VIBROSPICE_INPUT : VIBROSPICE_FAILED, err->text);
}

/* Takes so many bytes, and the descriptor that may come beside them. */
static void hear(void *data, size_t size, int *beside) {
  char *at = data;
  while (size > 0) {
    union {
      struct cmsghdr head;
      char room[CMSG_SPACE(sizeof(int))];
    } control;
    struct iovec part = {at, size};
    struct msghdr message = {.msg_iov = &part,
                             .msg_iovlen = 1,
                             .msg_control = control.room,
                             .msg_controllen = sizeof control.room};
    ssize_t n = recvmsg(SOCKET, &message, MSG_CMSG_CLOEXEC);
    if (n == 0 || (n < 0 && errno != EINTR)) leave();
    const struct cmsghdr *c = n > 0 ? CMSG_FIRSTHDR(&message) : NULL;
    if (c && c->cmsg_type == SCM_RIGHTS && beside) memcpy(beside, CMSG_DATA(c), sizeof *beside);
    if (n > 0) at += n, size -= (size_t)n;
  }
}

/* Waits for a question, and returns its kind. */
static uint32_t wait_for_question(engine *e, int *beside) {
  vibrospice_head head;
  hear(&head, sizeof head, beside);
  e->question.length = 0;
  vs_text_add(&e->question, "%*s", (int)head.size, ""); /* room, and an end */
  if (head.size) hear(e->question.text, head.size, NULL);
  return head.kind;
}

/* ---- texts ---- */

/* Adds a cell: a text without what ends cells. */
static void add_cell(vs_text *t, const char *text) {
  vs_text_put(t, "\t", 1);
  for (; *text; text++) vs_text_put(t, *text == '\t' || *text == '\n' ? " " : text, 1);
}

static void add_number(vs_text *t, double value) {
  vs_text_add(t, "\t%.17g", value);
}

/* The columns as the run begins. What has not read anything yet shows nothing. */
static void describe_start(const vs_scene *s, const vs_table *table, vs_text *t) {
  const vs_knot knot = vs_sim_start(&s->setup, &s->frame);
  const vs_step step = {.frame = &s->frame, .from = &knot, .to = &knot};
  double y[VS_CH_MOST];
  vs_column c;
  vs_step_at(&step, 0, y);
  vs_text_add(t, "0\t0");
  for (int k = 1; vs_table_column_at(table, k, &c); k++)
    add_number(t, k <= table->count ? y[table->channels[k - 1]] : NAN);
  vs_text_add(t, "\n");
}

void vs_serve_describe(const vs_scene *s, vs_text *t) {
  const vs_table table = vs_table_of(s);
  vs_column c;
  for (int k = 0; vs_table_column_at(&table, k, &c); k++)
    vs_text_add(t, "c\t%s\t%s\t%s\t%s\t%s\n", c.name, c.quantity, c.unit, c.role, c.of);
  for (int k = 0; k < INPUTS; k++) {
    if (why_no_input(s, k)) continue;
    vs_text_add(t, "i\t%s\t%s", INPUT[k].name, INPUT[k].unit);
    add_number(t, range_of_input(s, k).least);
    add_number(t, range_of_input(s, k).most);
    add_number(t, given.set[k] ? given.value[k] : value_in_scene(&s->setup, k));
    add_cell(t, INPUT[k].text);
    vs_text_add(t, k == FREQUENCY ? "\tfixed\n" : "\n");
  }
  vs_text_add(t, "u\t%.17g\n", s->setup.run.until_s);
  describe_start(s, &table, t);
}

static void answer_description(const engine *e) {
  vs_text t = {0};
  vs_serve_describe(e->scene, &t);
  answer(VIBROSPICE_OK, t.text, t.length);
  vs_text_free(&t);
}

static void add_measures(const vs_result *r, vs_text *t) {
  vs_listed_measure m;
  for (int k = 0; vs_listed_measure_at(&r->scene->frame, r, k, &m); k++) {
    if (!m.value.known) continue;
    vs_text_add(t, "m\t%s\t%s", m.name, m.unit);
    add_number(t, m.value.value);
    add_number(t, m.value.at_s);
    add_number(t, m.limit);
    vs_text_add(t, "\n");
  }
}

/* What is allowed, least and most. */
static void add_allowed(const vs_judgement *j, double unit, vs_text *t) {
  const bool lower = j->device && j->measure->held == VS_AT_LEAST;
  double limit = j->device && j->limit ? j->limit->value : NAN;
  double least = j->rating ? j->rating->min : lower ? limit : -INFINITY;
  double most = j->rating ? j->rating->max : lower ? INFINITY : limit;
  add_number(t, least / unit);
  add_number(t, isnan(most) ? INFINITY : most / unit);
}

static void add_lines(const vs_verdict *v, vs_text *t) {
  char name[VS_JUDGED_NAME], why[2 * VS_DECK_NAME + 16];
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    const char *unit = vs_verdict_unit(j), *unknown = vs_verdict_unknown(j, why, sizeof why);
    const double factor = vs_units_factor(unit);
    vs_text_add(t, "v\t%s\t%s", vs_verdict_name(j, name), unit);
    add_number(t, j->stress.value / factor);
    add_number(t, j->stress.at_s);
    add_allowed(j, factor, t);
    add_number(t, j->margin);
    add_number(t, j->margin_error);
    add_number(t, j->failed_s);
    vs_text_add(t, "\t%s", vs_verdict_words[vs_verdict_word(j)]);
    add_cell(t, unknown   ? unknown
                : j->torn ? "the sequence of firings depends on the tolerance"
                          : "");
    vs_text_add(t, "\n");
  }
}

static void add_happenings(const vs_verdict *v, vs_text *t) {
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!vs_verdict_is_happening(j)) continue;
    const bool happened = j->stress.value > 0;
    vs_text_add(t, "h\t%s\t%s", vs_kinds_happening(j->measure)->what, j->device->name);
    add_cell(t, happened ? j->cause : "");
    vs_text_add(t, "\t%s", vs_verdict_words[vs_verdict_word(j)]);
    add_number(t, happened ? j->stress.at_s : NAN);
    vs_text_add(t, "\t%.0f\t%d\n", happened ? j->stress.value : 0.0, j->expected);
  }
}

/* The run is whole: keeps what it came to. */
static void keep_result(void *ctx, const vs_result *r) {
  engine *e = ctx;
  vs_text *t = &e->result, json = {0};
  vs_unjudged entry;
  vs_error breach = {0};
  const vs_status held = vs_session_judge(r, &breach);
  e->scene->setup.run.ladder = e->ladder;
  t->length = 0;
  add_measures(r, t);
  add_lines(&r->verdict, t);
  add_happenings(&r->verdict, t);
  for (size_t k = 0; vs_unjudged_at(r->watchers.devices, &r->verdict, k, &entry); k++)
    vs_text_add(t, "n\t%s\n", entry.name);
  vs_text_add(t, "b\t%d", held == VS_OK);
  add_cell(t, breach.text);
  vs_summary_json(r, false, NULL, &json);
  vs_text_add(t, "\nj\n");
  vs_text_put(t, json.text, json.length);
  vs_text_free(&json);
}

/* ---- questions at any time ---- */

/* Makes a copy of the process, which answers on the socket `beside`. Its parent is a process that
 * ends at once, so that nobody need wait for its end. */
static void copy_process(engine *e, int beside) {
  const vs_regulator *law = e->scene ? e->scene->control.regulator : NULL;
  vs_error err = {0};
  int how;
  if (law && law->code) {
    answer_text(VIBROSPICE_INPUT, "the scene's law of control runs code of its own, whose memory "
                                  "cannot be copied");
    close(beside);
    return;
  }
  vs_run_flush();
  const pid_t first = fork(), second = first ? 0 : fork();
  if (first == 0 && second != 0) _exit(second < 0);
  if (first == 0) {
    dup2(beside, SOCKET);
    close(beside);
    vs_status status = vs_run_part(&err);
    if (status)
      answer_status(status, &err);
    else
      answer(VIBROSPICE_OK, NULL, 0);
    if (status) leave();
    return;
  }
  close(beside);
  if (first > 0)
    while (waitpid(first, &how, 0) < 0 && errno == EINTR) {
    }
  if (first < 0 || how)
    answer_text(VIBROSPICE_MEMORY, "no process for a copy");
  else
    answer(VIBROSPICE_OK, NULL, 0);
}

/* ---- before the run ---- */

static vs_status read_scene(engine *e, vs_error *err) {
  vs_scene *s = e->scene;
  vs_status status = VS_OK;
  vs_scene_free(s);
  if (e->flags & VIBROSPICE_TEXT) {
    *s = (vs_scene){.opened = true};
    status = vs_tree_parse(e->source, "the scene's text", &s->tree, err);
  } else
    status = vs_scene_open(e->source, (vs_where){0}, s, err);
  for (size_t k = 0; k < e->options.n_sets && !status; k++)
    status = vs_tree_set(&s->tree, e->sets[k], err);
  if (!status) status = vs_scene_read_sections(s, NULL, err);
  s->allow_code = e->options.allow_code;
  if (!status) status = vs_control_allow(&s->control, s->allow_code, err);
  if (!status) status = check_given(s, err);
  return status;
}

/* Sets a key over those before it. After an error the scene is as before. */
static vs_status add_set(engine *e, const char *assignment, vs_error *err) {
  size_t *n = &e->options.n_sets;
  vs_error none = {0};
  e->sets = vs_alloc_grow(e->sets, *n, sizeof *e->sets);
  e->sets[(*n)++] = vs_copy(assignment);
  vs_status status = read_scene(e, err);
  if (!status) return VS_OK;
  free(e->sets[--*n]);
  read_scene(e, &none);
  return status;
}

static void open_scene(engine *e) {
  char *rest;
  vs_error err = {0};
  e->flags = (unsigned)strtoul(e->question.text, &rest, 10);
  e->source = vs_copy(rest + 1);
  e->options.allow_code = e->flags & VIBROSPICE_ALLOW_CODE;
  vs_status status = read_scene(e, &err);
  if (!status)
    answer_description(e);
  else
    answer_status(status, &err);
}

static void set_key(engine *e) {
  vs_error err = {0};
  vs_status status = add_set(e, e->question.text, &err);
  if (!status)
    answer_description(e);
  else
    answer_status(status, &err);
}

static void set_folder(engine *e) {
  vs_error err = {0};
  int made;
  vs_status status = vs_file_folder_make(e->question.text, &made, &err);
  if (status) {
    answer_status(status, &err);
    return;
  }
  vs_file_folder_unmake(e->question.text, made);
  free((char *)(uintptr_t)e->options.folder);
  e->options.folder = vs_copy(e->question.text);
  answer(VIBROSPICE_OK, NULL, 0);
}

/* ---- setting an input ---- */

/* Before the run: what it begins with is a key of the scene. */
static vs_status set_first(engine *e, int k, double value, vs_error *err) {
  char text[128];
  vs_status status = VS_OK;
  const double before = given.value[k], most_v = range_of_input(e->scene, VOLTAGE).most;
  snprintf(text, sizeof text, "%s=%.17g %s", INPUT[k].name, value, INPUT[k].unit);
  if (k == ANGLE && !e->scene->control.regulator) {
    status = add_set(e, "control.law=none", err);
    if (!status) status = add_set(e, "control.angle=[0 deg, 180 deg]", err);
  }
  given.value[k] = value;
  if (!status && !isnan(value)) status = add_set(e, text, err);
  if (status) return given.value[k] = before, status;
  given.set[k] = true;
  if (k == VOLTAGE) given.most_v = most_v;
  return VS_OK;
}

static vs_status set_during_run(engine *e, int k, double value, vs_error *err) {
  if (!given.set[k])
    return vs_fail(err, VS_INPUT, "%s was not set before the run began, and follows the scene",
                   INPUT[k].name);
  const double before = given.value[k];
  if (k == FREQUENCY && value != before)
    return vs_fail(err, VS_INPUT,
                   "%s cannot change during the run, as the cycles of its firings "
                   "are counted by it",
                   INPUT[k].name);
  given.value[k] = value;
  if (k == VOLTAGE) {
    given.mains = vs_alloc_grow(given.mains, given.n_mains, sizeof *given.mains);
    given.mains[given.n_mains].at_s = e->t_s;
    given.mains[given.n_mains++].volt = value;
  }
  vs_status status = is_loaded(k) ? change_load(e->scene, e->t_s, err) : VS_OK;
  if (status) given.value[k] = before;
  return status;
}

static vs_status set_value(engine *e, const char *name, double value, vs_error *err) {
  const char *names[INPUTS];
  int k = 0, n = 0;
  for (int i = 0; i < INPUTS; i++)
    if (!why_no_input(e->scene, i)) names[n++] = INPUT[i].name;
  while (k < INPUTS && strcmp(name, INPUT[k].name) != 0) k++;
  if (k == INPUTS)
    return vs_fail(err, VS_INPUT, "no input '%s'%s", name,
                   vs_text_hint(name, names, (size_t)n, "").text);
  const char *why = why_no_input(e->scene, k),
             *open = k == ANGLE ? ", without 0 and 180, or NaN" : "";
  const range r = range_of_input(e->scene, k);
  if (why) return vs_fail(err, VS_INPUT, "%s is no input of this scene: %s", name, why);
  const bool inside = value >= r.least && value <= r.most;
  if (k == ANGLE ? !isnan(value) && !(inside && value > 0 && value < 180) : !inside)
    return vs_fail(err, VS_INPUT, "%s: %g %s; allowed: %g to %g%s", name, value, INPUT[k].unit,
                   r.least, r.most, open);
  return e->begun ? set_during_run(e, k, value, err) : set_first(e, k, value, err);
}

static void set_input(engine *e) {
  double value;
  vs_error err = {0};
  memcpy(&value, e->question.text, sizeof value);
  vs_status status = set_value(e, e->question.text + sizeof value, value, &err);
  if (status)
    answer_status(status, &err);
  else if (e->begun)
    answer(VIBROSPICE_OK, NULL, 0);
  else
    answer_description(e);
}

/* ---- the run ---- */

static void go_on_to(engine *e, uint32_t kind) {
  vibrospice_ask_run ask = {INFINITY, 0, 0};
  if (kind == VIBROSPICE_ASK_RUN) memcpy(&ask, e->question.text, sizeof ask);
  e->finishing = kind == VIBROSPICE_ASK_FINISH;
  e->from_s = e->target_s;
  e->target_s = fmin(ask.t_s, e->scene->setup.run.until_s);
  e->rows = ask.rows;
  e->events = ask.events;
  given.next_s = e->finishing ? INFINITY : e->target_s;
  offer_load_place(&e->scene->setup, given.next_s);
}

/* Something was told of the run: it is not run anew on another rung of the ladder. */
static void keep_to_rung(engine *e) {
  e->scene->setup.run.ladder = VS_LADDER_STAY;
}

/* Serves at an instant of the run, until it is to go on. */
static void stay(engine *e) {
  int beside = -1;
  keep_to_rung(e);
  for (;;) {
    const uint32_t kind = wait_for_question(e, &beside);
    if (kind == VIBROSPICE_ASK_INPUT)
      set_input(e);
    else if (kind == VIBROSPICE_ASK_COPY)
      copy_process(e, beside);
    else if (kind == VIBROSPICE_ASK_RUN || kind == VIBROSPICE_ASK_FINISH) {
      go_on_to(e, kind);
      return;
    } else
      answer_text(VIBROSPICE_ORDER, "the run has begun");
  }
}

/* Looks now and then whether the other end is still there. */
static void look_at_socket(engine *e) {
  struct pollfd socket = {SOCKET, 0, 0};
  if (++e->steps % 256 == 0 && poll(&socket, 1, 0) == 1 && socket.revents & (POLLHUP | POLLERR))
    leave();
}

/* Where it is to stop at an event, the next one that the step tells of becomes where it goes on to.
 * At one where it was told last the client stands anyway. A circuit may tell of one late, at an
 * instant that is over: then it stops half way to where it was to go. */
static void stop_at_event(engine *e, const vs_step *step) {
  const double from_s = step->from->t_s, to_s = step->to->t_s;
  if (!e->events) return;
  if (e->seen_s[0] != from_s || e->seen_s[1] != to_s) e->seen = 0;
  e->seen_s[0] = from_s, e->seen_s[1] = to_s;
  for (; e->seen < 2; e->seen++) {
    const vs_event event = step->event[e->seen];
    const double at_s = step->event_s[e->seen];
    const bool told = event == VS_EV_FIRES || event == VS_EV_EXTINCT || event == VS_EV_MEETS_STOP ||
                      event == VS_EV_LEAVES_STOP;
    if (!told || fabs(at_s - e->from_s) <= vs_scene_event_rounding(at_s)) continue;
    if (at_s <= e->target_s) {
      e->target_s = at_s > e->from_s ? at_s : (e->from_s + e->target_s) / 2;
      e->seen++;
    }
    return;
  }
}

static vs_status reach_instant(void *ctx, const vs_table *table, const vs_step *step, double t_s,
                               vs_error *err) {
  engine *e = ctx;
  double cells[VS_CH_MOST + VS_INSTRUMENT_MOST + VS_MOST_STATES + VS_REGULATOR_OUTPUTS + 2];
  vs_column column;
  (void)err;
  look_at_socket(e);
  /* The last step's end and run.until may differ by rounding. */
  const double ends_s = table->until_s - 1e-9 * table->sample_s;
  const bool ends = t_s >= step->to->t_s && t_s >= ends_s;
  stop_at_event(e, step);
  while (!e->finishing && (e->target_s <= t_s || (ends && e->target_s >= ends_s))) {
    int n = 0;
    while (vs_table_column_at(table, n, &column)) n++;
    vs_table_peek(table, step, fmin(fmax(e->target_s, e->row_s), t_s), cells);
    cells[0] = e->target_s;
    e->t_s = fmax(e->target_s, step->to->t_s); /* what is set from now on acts behind the step */
    answer(VIBROSPICE_OK, cells, (size_t)n * sizeof *cells);
    stay(e);
    stop_at_event(e, step);
  }
  return VS_OK;
}

static vs_status show_row(void *ctx, const double *cell, int width, vs_error *err) {
  engine *e = ctx;
  (void)err;
  e->row_s = cell[0];
  if (!e->rows) return VS_OK;
  keep_to_rung(e);
  answer(VIBROSPICE_ROW, cell, (size_t)width * sizeof *cell);
  if (wait_for_question(e, NULL) == VIBROSPICE_HALT) {
    e->rows = false;
    e->target_s = cell[0];
  }
  return VS_OK;
}

/* An attempt begins, whose scene may be that of another rung. */
static void begin_attempt(void *ctx, vs_scene *scene) {
  const engine *e = ctx;
  vs_setup *setup = &scene->setup;
  vs_events *events = &setup->timeline.events;
  if (given.set[ANGLE]) scene->control.regulator = &given_angle;
  if (!given.set[VOLTAGE] && !given.set[FRACTION] && !given.set[VOLUME]) return;
  scene->order.stand_in = NULL; /* nobody knows what is set next */
  events->item[events->count++] = (vs_scene_event){.name = "input",
                                                   .kind = &given_kind,
                                                   .v.level_v = setup->timeline.supply.voltage_v,
                                                   .end_s = INFINITY,
                                                   .gate_rad = NAN,
                                                   .period_s = setup->timeline.period_s};
  if (!given.set[FRACTION] && !given.set[VOLUME]) return;
  setup->loads.item = vs_alloc(MOST_LOADS + 1, sizeof *setup->loads.item);
  setup->loads.count = 1;
  setup->model.reloaded = true;
  given.loads = &setup->loads;
  offer_load_place(setup, e->target_s);
}

/* Runs the scene, with the question under way as the first, and answers the last one. Afterwards
 * there is nothing left to do but to be copied. */
static void run_scene(engine *e, uint32_t kind) {
  const vs_table_reader reader = {e, reach_instant, show_row};
  const vs_run_more more = {
      .ctx = e, .begin = begin_attempt, .finish = keep_result, .reader = &reader};
  vs_error err = {0};
  int beside = -1;
  e->begun = true;
  e->ladder = e->scene->setup.run.ladder;
  go_on_to(e, kind);
  vs_status status = vs_run_scene(&e->options, &more, e->scene, &err);
  if (status == VS_OK || status == VS_RATING)
    answer(VIBROSPICE_OK, e->result.text, e->result.length);
  else
    answer_text(VIBROSPICE_FAILED, err.text);
  for (;;)
    if (wait_for_question(e, &beside) == VIBROSPICE_ASK_COPY)
      copy_process(e, beside);
    else
      answer_text(VIBROSPICE_ORDER, "the run is over");
}

static vs_status serve_command(const void *given_line, vs_error *err) {
  static const char HELLO[] = VIBROSPICE_PROTOCOL;
  static engine e = {.options = {.quiet = true, .reproducible = true, .digits = 9}};
  int type, beside = -1;
  socklen_t size = sizeof type;
  (void)given_line;
  if (getsockopt(SOCKET, SOL_SOCKET, SO_TYPE, &type, &size))
    return vs_fail(err, VS_INPUT,
                   "serve talks to another program over its standard input, which has to be a "
                   "socket and is not; see vibrospice/vibrospice.h");
  /* What else the host has open is not this process's, whose copies may outlive a pipe's use. */
  syscall(SYS_close_range, STDERR_FILENO + 1U, ~0U, 0U);
  e.scene = vs_alloc(1, sizeof *e.scene);
  answer_text(VIBROSPICE_OK, HELLO);
  for (;;) {
    const uint32_t kind = wait_for_question(&e, &beside);
    if (kind == VIBROSPICE_ASK_OPEN && !e.source)
      open_scene(&e);
    else if (kind == VIBROSPICE_ASK_COPY)
      copy_process(&e, beside);
    else if (kind == VIBROSPICE_ASK_SET)
      set_key(&e);
    else if (kind == VIBROSPICE_ASK_FOLDER)
      set_folder(&e);
    else if (kind == VIBROSPICE_ASK_INPUT)
      set_input(&e);
    else
      run_scene(&e, kind);
  }
}

static const vs_option SERVE_OPTIONS[] = {VS_OPTIONS_END};

const vs_command vs_serve_cli = {
    .name = "serve",
    .text = "runs a scene step by step for another program, over libvibrospice",
    .examples =
        "  vibrospice serve      by itself it does nothing: see <vibrospice/vibrospice.h>\n",
    .may_be_alone = true,
    .argument = "",
    .options = SERVE_OPTIONS,
    .size = sizeof(vs_arguments),
    .run = serve_command};
