/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `run`: runs one scene, writes its files and prints its table. */
#include "run.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/file.h"
#include "base/shutdown.h"
#include "commands.h"
#include "engine/budget.h"
#include "ngspice/crash_guard.h"
#include "orbit/steady.h"
#include "report/plot.h"
#include "run/causes.h"
#include "run/show.h"
#include "run/table.h"

/* ---- corners ----
 * Runs at all ends of what the scene's key `spread` says is not known exactly, and the worst line
 * of each one's verdict. */

/* The line that breaks the verdict; else the weakest. NULL: nothing is rated. */
static void keep_worst(const vs_result *r, vs_corner *corner) {
  const vs_verdict *v = &r->verdict;
  const vs_judgement *breach = vs_verdict_breach(v), *j = breach ? breach : v->weakest;
  *corner = (vs_corner){.margin = NAN, .error = NAN, .breaks = breach};
  snprintf(corner->note, sizeof corner->note, "%s", r->no_pull_in);
  if (!j) return;
  vs_verdict_name(j, corner->line);
  corner->margin = j->margin;
  corner->error = j->margin_error;
  corner->word = vs_verdict_word(j);
}

/* True where a is worse than b: violated before undecided before held before what has no line; then
 * by the margin, of which one that is not known is the worst. */
static bool is_worse(const vs_corner *a, const vs_corner *b) {
  const vs_corner *both[] = {a, b};
  int rank[2];
  for (int k = 0; k < 2; k++)
    rank[k] = !*both[k]->line ? 0 : !both[k]->breaks ? 1 : both[k]->word == VS_UNDECIDED ? 2 : 3;
  if (rank[0] != rank[1]) return rank[0] > rank[1];
  return rank[0] && (a->margin < b->margin || (isnan(a->margin) && !isnan(b->margin)));
}

static vs_status read_corner(const vs_run_options *o, const char *tier, const vs_spreads *spread,
                             size_t k, vs_scene *scene, vs_error *err) {
  char text[VS_KEY_SIZE + 64];
  vs_status status = vs_scene_open(o->scene, (vs_where){0}, scene, err);
  for (size_t n = 0; n < o->n_sets && !status; n++)
    status = vs_tree_set(&scene->tree, o->sets[n], err);
  for (size_t n = 0; n < spread->count && !status; n++) {
    snprintf(text, sizeof text, "%s=%.12g %s", spread->item[n].key, vs_key_spread_at(spread, n, k),
             spread->item[n].unit);
    status = vs_tree_set(&scene->tree, text, err);
  }
  if (!status) status = vs_scene_read_sections(scene, tier, err);
  scene->allow_code = o->allow_code;
  return status ? status : vs_control_allow(&scene->control, o->allow_code, err);
}

/* Refuses corners that cannot be read, before any is run: input that is wrong at one end only. */
static vs_status read_all_corners(const vs_run_options *o, const char *tier, const vs_corners *c,
                                  vs_error *err) {
  char at[1024];
  vs_status status = VS_OK;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  for (size_t k = 0; k < c->count && !status; k++) {
    vs_error why = {0};
    status = read_corner(o, tier, &c->spread, k, scene, &why);
    vs_scene_free(scene);
    if (status)
      vs_fail(err, status, "%.*sthe corner %s: %s", why.place_size, why.text,
              vs_result_corner(c, k, at, sizeof at), why.text + why.place_size);
  }
  free(scene);
  return status;
}

/* Runs a corner. Error: VS_SIGNAL. A run that fails is noted, and the others go on. */
static vs_status run_corner(const vs_run_options *o, const char *tier, vs_corners *c, size_t k,
                            vs_error *err) {
  const vs_session session = {.verify = true, .stop = o->stop};
  vs_corner *corner = &c->item[k];
  vs_error why = {0};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_status status = read_corner(o, tier, &c->spread, k, scene, &why);
  if (!status) status = vs_steady_run(&session, scene, result, &why);
  if (!status && result->second.stopped) status = vs_fail(&why, VS_SIGNAL, "stopped by a signal");
  if (!status) keep_worst(result, corner);
  vs_result_free(result);
  free(result);
  vs_scene_free(scene);
  free(scene);
  if (status == VS_SIGNAL) return vs_fail(err, status, "%s", why.text);
  if (!status) return VS_OK;
  *corner = (vs_corner){.margin = NAN, .error = NAN};
  snprintf(corner->failed, sizeof corner->failed, "%.*s", (int)sizeof corner->failed - 1, why.text);
  c->failed++;
  return VS_OK;
}

/* Reads all of them, then runs them, one behind the other, each with a second run for the errors of
 * its margins. One that fails is noted, and the others go on. Nothing is written or printed but
 * progress. Errors: those of the key spread, and of a scene that cannot be read at a corner, which
 * name the corner, with nothing run; VS_SIGNAL. */
static vs_status run_corners(const vs_run_options *o, const vs_scene *nominal, vs_corners *c,
                             vs_error *err) {
  vs_status status = vs_key_spreads(nominal, &c->spread, err);
  const bool shows = !o->quiet && isatty(STDERR_FILENO);
  const char *tier = nominal->tier->name;
  c->count = status ? 0 : (size_t)1 << c->spread.spreads;
  c->held = c->failed = 0;
  c->worst = c->count;
  if (!status) status = read_all_corners(o, tier, c, err);
  for (size_t k = 0; k < c->count && !status; k++) {
    vs_corner *corner = &c->item[k];
    if (shows) dprintf(STDERR_FILENO, "\rcorner %zu of %zu \033[K", k + 1, c->count);
    status = run_corner(o, tier, c, k, err);
    if (status || !*corner->line) continue;
    if (!corner->breaks) c->held++;
    if (c->worst == c->count || is_worse(corner, &c->item[c->worst])) c->worst = k;
  }
  if (shows) dprintf(STDERR_FILENO, "\r\033[K");
  return status;
}

/* ---- the files of a run, and its progress ---- */

/* A row of events.csv. */
typedef struct event_row {
  double at_s;
  char *what; /* owned */
} event_row;

/* What the command adds to a run: its files and its progress line. */
typedef struct audience {
  const vs_run_options *options;
  const vs_run_more *more; /* what another command adds; NULL: nothing */
  const vs_scene *scene;
  vs_file csv, peaks, events, summary,
      raw;         /* closed where there is no folder; raw also where it is not asked for */
  int made;        /* how many folders were made for the output */
  event_row *rows; /* [n_rows], in the order of time: some are told later than others; owned */
  size_t n_rows;
  vs_table table;
  vs_table_peaks found;    /* what became of peaks.csv, once the files are closed */
  double began_s, shown_s; /* wall clock: of the run, of the last progress line */
  bool show_progress;
} audience;

static void print_progress(audience *a, double t_s, long steps) {
  if (!a->show_progress || steps % 256) return;
  double now = vs_budget_clock_s(), spent = now - a->began_s, until = a->scene->setup.run.until_s;
  if (spent < 1 || now - a->shown_s < 0.25) return;
  a->shown_s = now;
  dprintf(STDERR_FILENO, "\r%5.1f %%  t = %.4g s of %.4g s, %.0f s left \033[K", 100 * t_s / until,
          t_s, until, spent * (until - t_s) / t_s);
}

/* True for the firings of a run whose devices tell their own. */
static bool is_told_by_devices(const vs_devices *devices, vs_event event) {
  return devices && devices->tells && (event == VS_EV_FIRES || event == VS_EV_EXTINCT);
}

/* Takes a row of events.csv, behind those of the same instant. */
static void add_event(audience *a, double at_s, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void add_event(audience *a, double at_s, const char *format, ...) {
  char what[256];
  va_list args;
  va_start(args, format);
  vsnprintf(what, sizeof what, format, args);
  va_end(args);
  a->rows = vs_alloc_grow(a->rows, a->n_rows, sizeof *a->rows);
  size_t k = a->n_rows++;
  for (; k && a->rows[k - 1].at_s > at_s; k--) a->rows[k] = a->rows[k - 1];
  a->rows[k] = (event_row){at_s, vs_copy(what)};
}

/* Frees the rows; `out`: writes them before, unless it is NULL. */
static void end_events(audience *a, FILE *out) {
  for (size_t k = 0; k < a->n_rows; k++) {
    if (out) fprintf(out, "%.*g,%s\n", a->options->digits, a->rows[k].at_s, a->rows[k].what);
    free(a->rows[k].what);
  }
  free(a->rows);
  a->rows = NULL;
  a->n_rows = 0;
}

/* Takes what happened to the devices in the steps that the watchers have looked at: in those
 * before the last one, or in that. They look where the step has an event of its own. */
static void take_incidents(audience *a, const vs_watchers *w, bool last) {
  const vs_devices *d = w->devices;
  if (!a->events.stream || !d) return;
  for (size_t k = 0; k < d->n_incidents; k++) {
    const vs_incident *i = &d->incidents[k];
    if ((i->step >= d->here) != last) continue;
    add_event(a, i->at_s, "%s %s", i->device, i->what);
  }
}

/* The stop that the armature meets or leaves: the one that is nearest then. NULL: it is no event of
 * a stop. */
static const vs_stop *stop_of_event(const vs_step *step, int k) {
  const vs_model *m = step->frame->model;
  const double *x = step->event_s[k] < step->to->t_s ? step->from->x : step->to->x;
  const double g_m = vs_mechanics_travel(m, x);
  const vs_stop *nearest = &m->stops.item[0];
  if (step->event[k] != VS_EV_MEETS_STOP && step->event[k] != VS_EV_LEAVES_STOP) return NULL;
  for (int n = 1; n < m->stops.count; n++)
    if (fabs(vs_stop_depth(&m->stops.item[n], g_m)) < fabs(vs_stop_depth(nearest, g_m)))
      nearest = &m->stops.item[n];
  return nearest;
}

/* An armature that lies on a stop as the run begins does not meet it. */
static bool begins_on_stop(const vs_step *step, int k) {
  const vs_stop *stop = stop_of_event(step, k);
  return stop && step->event[k] == VS_EV_MEETS_STOP && step->from->t_s == 0 &&
         vs_stop_depth(stop, vs_mechanics_travel(step->frame->model, step->from->x)) >= 0;
}

static const char *name_stop(const vs_step *step, int k) {
  const vs_stop *stop = stop_of_event(step, k);
  if (!stop || step->frame->model->stops.count < 2) return "";
  return stop->side > 0 ? " on the pole's side" : " on the far side";
}

/* What is switched on and off once, without a carrier. */
static void tell_switching(audience *a, const vs_step *step) {
  const vs_setup *s = &a->scene->setup;
  const vs_pwm_values *p = &s->timeline.pwm;
  const double at_s[] = {p->on_s, p->off_s > 0 ? p->off_s : INFINITY};
  if (!a->events.stream || !vs_pwm_is_single(p) ||
      !vs_deck_has_port(&s->deck, vs_port_is_modulated))
    return;
  for (int k = 0; k < 2; k++)
    if (at_s[k] >= step->from->t_s && at_s[k] < step->to->t_s)
      add_event(a, at_s[k], "switched %s", k ? "off" : "on");
}

static vs_status accept_step_for_files(void *ctx, const vs_step *step, const vs_result *result,
                                       vs_error *err) {
  static const char *const WHAT[] = {[VS_EV_FIRES] = "thyristor fires",
                                     [VS_EV_EXTINCT] = "thyristor extinct",
                                     [VS_EV_MEETS_STOP] = "armature meets the stop",
                                     [VS_EV_LEAVES_STOP] = "armature leaves the stop",
                                     [VS_EV_JAMS] = "armature jams",
                                     [VS_EV_LOADS] = "load changes",
                                     [VS_EV_QUIET] = "the circuit is quiet: ngspice is left",
                                     [VS_EV_BACK] = "back in ngspice"};
  _Static_assert(sizeof WHAT / sizeof *WHAT == VS_EV_BACK + 1, "every event has its words");
  audience *a = ctx;
  vs_status status = VS_OK;
  if (a->more && a->more->accept) a->more->accept(a->more->ctx, step);
  a->table.meters = result->meters;
  a->table.loop = result->loop;
  a->table.measures = result->watchers.measures;
  if (a->table.between) status = vs_table_accept(&a->table, step, err);
  const vs_devices *devices = result->watchers.devices;
  take_incidents(a, &result->watchers, false);
  tell_switching(a, step);
  for (int k = 0; a->events.stream && k < 2; k++)
    if (step->event[k] != VS_EV_NONE && !is_told_by_devices(devices, step->event[k]) &&
        !begins_on_stop(step, k))
      add_event(a, step->event_s[k], "%s%s", WHAT[step->event[k]], name_stop(step, k));
  const vs_events *events = &a->scene->setup.timeline.events;
  for (size_t k = 0; a->events.stream && k < events->count; k++)
    if (events->item[k].start_s >= step->from->t_s && events->item[k].start_s < step->to->t_s)
      add_event(a, events->item[k].start_s, "%s begins (%s)", events->item[k].name,
                events->item[k].kind->name);
  take_incidents(a, &result->watchers, true);
  print_progress(a, step->to->t_s, result->steps);
  return status;
}

static vs_status open_files(audience *a, vs_error *err) {
  const vs_scene *s = a->scene;
  const char *folder = a->options->folder;
  a->table.peaks_most = s->setup.limits.csv_bytes;
  a->table.digits = a->options->digits;
  vs_status status = vs_table_check(&a->table, s->tree.root, s->setup.limits.csv_bytes, err);
  if (!status) status = vs_file_folder_make(folder, &a->made, err);
  if (!status && a->made == 1) vs_shutdown_remove(folder);
  if (!status) status = vs_file_open(&a->csv, folder, "run.csv", err);
  if (!status) status = vs_file_open(&a->peaks, folder, VS_TABLE_PEAKS_FILE, err);
  if (!status) status = vs_file_open(&a->events, folder, "events.csv", err);
  if (!status) status = vs_file_open(&a->summary, folder, "summary.json", err);
  if (!status && a->options->raw) status = vs_file_open(&a->raw, folder, "run.raw", err);
  if (status) return status;
  a->table.stream = a->csv.stream;
  a->table.peaks = a->peaks.stream;
  vs_table_begin(&a->table);
  end_events(a, NULL);
  fputs("t_s,what\n", a->events.stream);
  return VS_OK;
}

/* Removes a file of an older run in the folder, which this run's files would contradict. */
static void remove_stale_file(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  unlink(path);
}

/* Is called with each file that gives way. */
typedef void (*file_visit)(const char *folder, const char *name, vs_text *names);

/* A link is left alone: the program made none. */
static void visit_file(const char *folder, const char *name, file_visit each, vs_text *names) {
  char path[VS_PATH_SIZE];
  struct stat s;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  if (!lstat(path, &s) && S_ISREG(s.st_mode)) each(folder, name, names);
}

/* Calls each(folder, name, names) for every picture in the folder, for the numbers of a spectrum,
 * and for the page, unless it is a study's. */
static void each_picture(const char *folder, file_visit each, vs_text *names) {
  static const char *const ENDINGS[] = {"png", "svg"};
  char path[VS_PATH_SIZE], name[64];
  for (const char *const *k = vs_plot_pictures; *k; k++)
    for (size_t e = 0; e < sizeof ENDINGS / sizeof *ENDINGS; e++) {
      snprintf(name, sizeof name, "%s.%s", *k, ENDINGS[e]);
      visit_file(folder, name, each, names);
    }
  visit_file(folder, "spectrum.csv", each, names);
  snprintf(path, sizeof path, "%s/manifest.json", folder);
  if (access(path, F_OK)) visit_file(folder, "report.html", each, names);
}

static void add_file_name(const char *folder, const char *name, vs_text *names) {
  (void)folder;
  vs_text_add(names, ", %s", name);
}

static void remove_picture(const char *folder, const char *name, vs_text *names) {
  (void)names;
  remove_stale_file(folder, name);
}

/* The names of an older run's files in the folder, which give way to this run's; empty: none. To be
 * freed by the caller. */
static char *name_replaced(const char *folder) {
  static const char *const FILES[] = {"run.csv",        VS_TABLE_PEAKS_FILE, "events.csv",
                                      "summary.json",   "run.raw",           "run.partial.csv",
                                      "run.partial.raw"};
  char path[VS_PATH_SIZE];
  vs_text names = {0};
  vs_text_add(&names, "%s", "");
  for (size_t k = 0; k < sizeof FILES / sizeof *FILES; k++) {
    snprintf(path, sizeof path, "%s/%s", folder, FILES[k]);
    if (!access(path, F_OK)) vs_text_add(&names, "%s%s", names.length ? ", " : "", FILES[k]);
  }
  if (names.length) each_picture(folder, add_file_name, &names);
  return names.text;
}

/* Removes the older run's pictures; `replaced` names its files, empty where there was none. */
static void remove_pictures(const char *folder, const char *replaced) {
  if (*replaced) each_picture(folder, remove_picture, NULL);
}

/* Keeps what a failed run has computed, under names that say so, and adds to err where it is. */
static void keep_partial(audience *a, vs_error *err) {
  static const char *const STALE[] = {"run.csv",      VS_TABLE_PEAKS_FILE, "events.csv",
                                      "summary.json", "run.raw",           "run.partial.raw"};
  const char *folder = a->options->folder;
  vs_error second = {0};
  char *replaced = name_replaced(folder);
  for (size_t k = 0; k < sizeof STALE / sizeof *STALE; k++) remove_stale_file(folder, STALE[k]);
  remove_pictures(folder, replaced);
  bool csv = !vs_file_commit_as(&a->csv, folder, "run.partial.csv", &second);
  bool raw = a->raw.stream && !vs_file_commit_as(&a->raw, folder, "run.partial.raw", &second);
  size_t n = strlen(err->text);
  if (csv || raw)
    snprintf(err->text + n, sizeof err->text - n, "; what was computed is in %s/%s%s", folder,
             csv ? "run.partial.csv" : "run.partial.raw", csv && raw ? " and run.partial.raw" : "");
  n = strlen(err->text);
  if (*replaced)
    snprintf(err->text + n, sizeof err->text - n, ", in the place of %s of an older run", replaced);
  free(replaced);
}

static void discard_files(audience *a) {
  end_events(a, NULL);
  vs_file_discard(&a->summary);
  vs_file_discard(&a->raw);
  vs_file_discard(&a->events);
  vs_file_discard(&a->peaks);
  vs_file_discard(&a->csv);
  vs_table_end(&a->table);
}

/* Puts peaks.csv in its place, if run.csv needs it beside, and removes an older run's. */
static vs_status close_peaks(audience *a, vs_error *err) {
  a->found = vs_table_found(&a->table);
  if (a->found == VS_TABLE_SOME) return vs_file_commit(&a->peaks, err);
  remove_stale_file(a->options->folder, VS_TABLE_PEAKS_FILE);
  if (a->found == VS_TABLE_BEYOND && !a->options->quiet)
    fprintf(stderr,
            "vibrospice: warning: " VS_TABLE_PEAKS_FILE " is left out, as it would have more than "
            "limits.csv = %.9g bytes: run.csv alone does not show every peak; record fewer "
            "probes, or raise it\n",
            a->table.peaks_most);
  return VS_OK;
}

/* Keeps or discards the files, as the run ended (`ran`), and writes summary.json. */
static vs_status close_files(audience *a, vs_status ran, const char *json, vs_error *err) {
  const char *folder = a->options->folder;
  bool partial = ran && ran != VS_INPUT && a->csv.stream;
  if (partial) keep_partial(a, err);
  if (ran) discard_files(a);
  if (ran) vs_file_folder_unmake(folder, a->made); /* which a part that could be kept forbids */
  if (ran) return ran;
  char *replaced = name_replaced(folder);
  vs_status status = VS_OK;
  fputs(json, a->summary.stream);
  if (a->raw.stream) status = vs_file_commit(&a->raw, err);
  if (!status) status = vs_file_commit(&a->csv, err);
  if (!status) status = close_peaks(a, err);
  if (!status) end_events(a, a->events.stream);
  if (!status) status = vs_file_commit(&a->events, err);
  if (!status) status = vs_file_commit(&a->summary, err);
  discard_files(a);
  if (!status) remove_pictures(folder, replaced);
  if (!status && *replaced && !a->options->quiet)
    fprintf(stderr, "vibrospice: note: replaced in %s, of an older run: %s\n", folder, replaced);
  free(replaced);
  if (status) vs_file_folder_unmake(folder, a->made);
  if (status) return status;
  if (!a->options->raw) remove_stale_file(folder, "run.raw");
  remove_stale_file(folder, "run.partial.csv");
  remove_stale_file(folder, "run.partial.raw");
  return VS_OK;
}

/* ---- as the session's guest ---- */

/* True if a second process would find all that this one has found: the scene comes from no pipe,
 * one folder at most was made, which is noted to go with the process, and no other program takes
 * part. */
static bool can_begin_anew(const audience *a) {
  struct stat s;
  if (a->table.reader) return false;
  bool file = stat(a->options->scene, &s) || S_ISREG(s.st_mode);
  return file && a->made <= 1 && !a->scene->control.regulator;
}

static vs_status begin_files(void *ctx, vs_scene *scene, vs_error *err) {
  audience *a = ctx;
  a->scene = scene;
  if (a->more && a->more->begin) a->more->begin(a->more->ctx, scene);
  a->table = vs_table_of(scene);
  a->table.reader = a->more ? a->more->reader : NULL;
  vs_status status = a->options->folder ? open_files(a, err) : VS_OK;
  if (!status && a->table.reader && !a->options->folder) vs_table_begin(&a->table);
  const vs_node *until = vs_tree_child(vs_tree_child(scene->tree.root, "run"), "until");
  scene->order.raw = a->raw.stream;
  scene->order.raw_where = until ? until->where : (vs_where){0};
  scene->order.unbegun = can_begin_anew(a);
  a->began_s = vs_budget_clock_s();
  a->shown_s = 0;
  return status;
}

/* The run's files, for a copy of the process. */
static audience *under_way;

static vs_file *const *files_of(audience *a) {
  static vs_file *files[5];
  files[0] = &a->csv, files[1] = &a->peaks, files[2] = &a->events, files[3] = &a->summary;
  files[4] = &a->raw;
  return files;
}

void vs_run_flush(void) {
  for (int k = 0; under_way && k < 5; k++)
    if (files_of(under_way)[k]->stream) fflush(files_of(under_way)[k]->stream);
}

vs_status vs_run_part(vs_error *err) {
  vs_status status = VS_OK;
  for (int k = 0; under_way && k < 5 && !status; k++)
    status = vs_file_part(files_of(under_way)[k], err);
  if (under_way && under_way->csv.stream) {
    under_way->table.stream = under_way->csv.stream;
    under_way->table.peaks = under_way->peaks.stream;
  }
  return status;
}

static void end_progress(const audience *a) {
  if (a->shown_s > 0) dprintf(STDERR_FILENO, "\r\033[K");
}

/* Nothing is kept of an attempt that another one follows. Of one that had no first step nothing is
 * said: either another has one, and the result tells of it, or the error is the same in the end. */
static void drop_attempt(void *ctx, const char *failed, int next) {
  audience *a = ctx;
  end_progress(a);
  vs_table_end(&a->table);
  if (a->options->folder) {
    vs_shutdown_forget(a->options->folder);
    discard_files(a);
    vs_file_folder_unmake(a->options->folder, a->made);
  }
  if (*failed && !a->options->quiet)
    fprintf(stderr, "vibrospice: warning: %s; trying %s\n", failed, vs_ladder_text(next));
}

/* ---- the command ---- */

/* True if a --set changes what is computed, and not only how: what the scene says was measured is
 * then of another experiment. */
static bool changes_machine(const vs_run_options *o) {
  static const char *const HOW[] = {"run.",    "record",   "measure", "instruments",
                                    "quality", "limits.",  "expect",  "ratings",
                                    "ambient", "heatsink", "waive",   "spread"};
  for (size_t k = 0; k < o->n_sets; k++) {
    bool how = false;
    for (size_t n = 0; n < sizeof HOW / sizeof *HOW; n++)
      how = how || !strncmp(o->sets[k], HOW[n], strlen(HOW[n]));
    if (!how) return true;
  }
  return false;
}

static void print_result(const audience *a, const vs_run_more *more, const vs_result *r,
                         const char *json) {
  const vs_run_options *o = a->options;
  if (o->json)
    fputs(json, stdout);
  else if (!o->quiet) {
    const vs_show_options groups = {.most = INT_MAX, .measured = !changes_machine(o)};
    const vs_show_more shown = {more ? more->show : NULL, more ? more->ctx : NULL};
    if (o->all)
      vs_show_all(r, &groups, &shown, stdout);
    else
      vs_show_brief(r, &groups, &shown, stdout);
    if (o->folder)
      printf("written: run.csv, %sevents.csv, summary.json%s in %s\n",
             a->found == VS_TABLE_SOME ? VS_TABLE_PEAKS_FILE " with the peaks between its rows, "
                                       : "",
             o->raw ? ", run.raw" : "", o->folder);
  }
  if (!o->quiet) vs_result_warn(r);
  char text[512];
  if (!o->quiet && vs_result_steps_are_short(r, text, sizeof text))
    fprintf(stderr, "vibrospice: hint: %s\n", text);
}

/* Error, VS_RUN: a corner failed. */
static vs_status look_for_failed(const vs_corners *c, vs_error *err) {
  char at[1024];
  size_t k = 0;
  if (!c->failed) return VS_OK;
  while (!*c->item[k].failed) k++;
  return vs_fail(err, VS_RUN, "%zu of %zu corners failed; the first is %s: %s", c->failed, c->count,
                 vs_result_corner(c, k, at, sizeof at), c->item[k].failed);
}

/* Error, VS_RATING: a corner breaks. */
static vs_status judge_corners(const vs_corners *c, vs_error *err) {
  char at[1024], margin[48] = "";
  size_t broken = 0;
  for (size_t k = 0; k < c->count; k++) broken += c->item[k].breaks;
  if (!broken) return VS_OK;
  const vs_corner *worst = &c->item[c->worst];
  if (!isnan(worst->margin))
    snprintf(margin, sizeof margin, ", margin %.3g %%", 100 * worst->margin);
  return vs_fail(err, VS_RATING, "%zu of %zu corners do not hold; the worst is %s: %s %s%s", broken,
                 c->count, vs_result_corner(c, c->worst, at, sizeof at), worst->line,
                 vs_verdict_words[worst->word], margin);
}

vs_status vs_run_scene(const vs_run_options *o, const vs_run_more *more, vs_scene *scene,
                       vs_error *err) {
  audience a = {.options = o, .more = more, .show_progress = !o->quiet && isatty(STDERR_FILENO)};
  const vs_session_listener guest = {&a, begin_files, accept_step_for_files, drop_attempt, true};
  const vs_session session = {.guest = &guest, .verify = true, .stop = o->stop};
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_text json = {0};
  vs_shutdown_mode before = vs_shutdown_mode_set(VS_SHUTDOWN_WITH_TIMEOUT);
  scene->order.shows = a.show_progress;
  under_way = &a;
  vs_status status = vs_steady_run(&session, scene, result, err);
  vs_shutdown_mode_set(VS_SHUTDOWN_WHEN_KEPT);
  end_progress(&a);
  for (int last = 0; last < 2 && !status; last++) take_incidents(&a, &result->watchers, last);
  result->corners = o->judged;
  vs_causes *causes = NULL;
  if (!status && o->why && result->verdict.count)
    status = vs_causes_find(result, vs_steady_run, o->stop, &causes, err);
  result->causes = causes;
  if (!status && more && more->finish) more->finish(more->ctx, result);
  if (!status && (o->json || o->folder))
    vs_summary_json(result, !o->reproducible, more ? &more->summary : NULL, &json);
  if (o->folder) status = close_files(&a, status, json.text, err);
  if (o->folder) vs_shutdown_forget(o->folder);
  vs_table_end(&a.table);
  under_way = NULL;
  vs_shutdown_mode_set(before);
  if (!status) print_result(&a, more, result, json.text);
  if (!status && o->judged && !result->second.stopped) status = look_for_failed(o->judged, err);
  if (!status) status = vs_session_judge(result, err);
  if (!status && o->judged) status = judge_corners(o->judged, err);
  vs_text_free(&json);
  vs_causes_free(causes);
  vs_result_free(result);
  free(result);
  return status;
}

static vs_status run_named_scene(const vs_run_options *o, vs_error *err) {
  if (o->raw && !o->folder)
    return vs_fail(err, VS_INPUT, "--raw: run.raw goes into a folder; name one with -o DIR");
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_scene_read(o->scene, o->sets, o->n_sets, o->tier, scene, err);
  scene->allow_code = o->allow_code;
  if (!status) status = vs_control_allow(&scene->control, o->allow_code, err);
  if (!status && o->raw) status = vs_scene_take_circuit(scene, "--raw", err);
  if (!status && !o->quiet && !vs_crash_guard_again()) vs_scene_warn(scene);
  vs_run_options own = *o;
  vs_corners *corners = o->corners ? vs_alloc(1, sizeof *corners) : NULL;
  vs_spreads spreads;
  if (!status) status = vs_key_spreads(scene, &spreads, err);
  if (!status && corners) status = run_corners(o, scene, corners, err);
  own.judged = corners;
  if (!status) status = vs_run_scene(&own, NULL, scene, err);
  free(corners);
  vs_scene_free(scene);
  free(scene);
  return status;
}

/* ---- the command line ---- */

typedef struct run_line {
  vs_arguments common;
  vs_run_options run;
} run_line;

static vs_status run_command(const void *given, vs_error *err) {
  const run_line *line = given;
  const vs_run_options o = vs_options_of_run(&line->run, &line->common);
  return run_named_scene(&o, err);
}

static const vs_option RUN_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_UNTIL,
    VS_OPTIONS_TOLERANCE,
    VS_OPTIONS_ANGLE,
    VS_OPTIONS_TIER(run_line, run.tier),
    VS_OPTIONS_OUTPUT(
        "DIR", "writes run.csv, events.csv and summary.json there, and peaks.csv, which is run.csv "
               "with further rows, where peaks lie between the rows of run.csv"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_ALL(run_line, run.all),
    VS_OPTIONS_REPRODUCIBLE(run_line, run.reproducible),
    VS_OPTIONS_DIGITS(run_line, run.digits),
    VS_OPTIONS_FLAG(run_line, run.corners, "corners",
                    "runs the scene at all ends of its key spread besides, without one of the "
                    "mains +- 10 % and of each varistor's tolerance and ageing; a corner that "
                    "breaks breaks the verdict"),
    VS_OPTIONS_FLAG(run_line, run.why, "why",
                    "explains each violated line of the verdict, or else the weakest: which "
                    "branches its current comes from or what its voltage is made of, the event "
                    "before it, and the assumed figures that it depends on; runs the scene once "
                    "more, up to that instant"),
    VS_OPTIONS_FLAG(run_line, run.raw, "raw",
                    "tier circuit, with -o: writes run.raw too, every voltage and current of the "
                    "circuit at every step, for ngspice's 'load'; a run that fails leaves "
                    "run.partial.raw"),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_run_cli = {
    .name = "run",
    .argument = "SCENE",
    .text = "runs one scene; SCENE is a file, or the name of one that comes with the program",
    .examples = "  vibrospice run paper --tier circuit -o out\n"
                "  vibrospice run paper --angle 95deg --until 0.5s --set circuit.r1=220ohm\n"
                "  vibrospice run my.yaml --json --quiet > result.json\n",
    .options = RUN_OPTIONS,
    .size = sizeof(run_line),
    .defaults = &(const run_line){.run.digits = 9},
    .run = run_command};
