/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/run.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/leave.h"
#include "base/units.h"
#include "study/ladder.h"
#include "study/scene.h"
#include "study/summary.h"
#include "watch/table.h"

/* Names the rating or limit that is violated furthest; VS_OK: none is. */
static vs_status judge(const vs_result *r, vs_error *err) {
  const vs_judgement *worst = r->verdict.weakest;
  if (!worst || !(worst->margin < 0)) return VS_OK;
  const char *unit_name = vs_judgement_unit(worst);
  char name[VS_JUDGED_NAME], allowed[64];
  double unit = vs_unit_factor(unit_name);
  if (worst->rating)
    snprintf(allowed, sizeof allowed, "%g..%g", worst->rating->min / unit,
             worst->rating->max / unit);
  else
    snprintf(allowed, sizeof allowed, "%s %g",
             worst->measure->held == VS_AT_LEAST ? "at least" : "at most",
             worst->limit->value / unit);
  return vs_fail(err, VS_RATING, "a rating is violated: %s = %.6g %s at %.6g s, allowed %s %s",
                 vs_judgement_name(worst, name), worst->stress.value / unit, unit_name,
                 worst->stress.at_s, allowed, unit_name);
}

/* Everyone who watches one run. */
typedef struct audience {
  const vs_run_options *options;
  const vs_scene *scene;
  vs_file csv, events, raw; /* closed when there is no folder; raw: when it is not asked for */
  int made;                 /* folders, for the output */
  vs_table table;
  vs_measures *measures;
  vs_devices *devices;
  vs_result result;
  char books[512];         /* what the energy audit says */
  double began_s, shown_s; /* wall clock: of the run, of the last progress line */
  bool show_progress;
} audience;

static double wall_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void progress(audience *a, double t_s) {
  if (!a->show_progress || a->result.steps % 256) return;
  double now = wall_clock(), spent = now - a->began_s, until = a->scene->setup.run.until_s;
  if (spent < 1 || now - a->shown_s < 0.25) return;
  a->shown_s = now;
  fprintf(stderr, "\r%5.1f %%  t = %.4g s of %.4g s, %.0f s left \033[K", 100 * t_s / until, t_s,
          until, spent * (until - t_s) / t_s);
}

static vs_status accept(void *ctx, const vs_step *step, vs_error *err) {
  static const char *const WHAT[] = {[VS_EV_FIRES] = "thyristor fires",
                                     [VS_EV_EXTINCT] = "thyristor extinct",
                                     [VS_EV_MEETS_STOP] = "armature meets the stop",
                                     [VS_EV_LEAVES_STOP] = "armature leaves the stop",
                                     [VS_EV_JAMS] = "armature jams",
                                     [VS_EV_QUIET] = "the circuit is quiet: ngspice is left",
                                     [VS_EV_BACK] = "back in ngspice"};
  audience *a = ctx;
  vs_status status = VS_OK;
  a->result.steps++;
  vs_absence_accept(&a->result.absence, step);
  if (a->table.stream) status = vs_table_accept(&a->table, step, err);
  for (int k = 0; a->events.stream && k < 2; k++)
    if (step->event[k] != VS_EV_NONE)
      fprintf(a->events.stream, "%.*g,%s\n", a->options->digits, step->event_s[k],
              WHAT[step->event[k]]);
  const vs_events *events = &a->scene->setup.timeline.events;
  for (size_t k = 0; a->events.stream && k < events->count; k++)
    if (events->item[k].start_s >= step->from->t_s && events->item[k].start_s < step->to->t_s)
      fprintf(a->events.stream, "%.*g,%s begins (%s)\n", a->options->digits,
              events->item[k].start_s, events->item[k].name, events->item[k].kind->name);
  vs_measures_accept(a->measures, step);
  vs_devices_accept(a->devices, step);
  for (size_t k = 0; a->events.stream && a->devices && k < a->devices->n_incidents; k++) {
    const vs_incident *i = &a->devices->incidents[k];
    fprintf(a->events.stream, "%.*g,%s %s\n", a->options->digits, i->at_s, i->device, i->what);
  }
  vs_energy_accept(&a->result.energy, step);
  progress(a, step->to->t_s);
  if (!status && *a->options->stop)
    return vs_fail(err, VS_SIGNAL, "t = %.9g s: stopped by a signal", step->to->t_s);
  return status;
}

static vs_status open_files(audience *a, vs_error *err) {
  const vs_scene *s = a->scene;
  const char *folder = a->options->folder;
  vs_status status = vs_folder_make(folder, &a->made, err);
  if (!status) status = vs_file_open(&a->csv, folder, "run.csv", err);
  if (!status) status = vs_file_open(&a->events, folder, "events.csv", err);
  if (!status && a->options->raw) status = vs_file_open(&a->raw, folder, "run.raw", err);
  if (status) return status;
  a->table = (vs_table){.stream = a->csv.stream,
                        .frame = &s->frame,
                        .count = s->n_record,
                        .digits = a->options->digits,
                        .sample_s = s->setup.run.sample_s,
                        .until_s = s->setup.run.until_s};
  memcpy(a->table.channels, s->record, sizeof s->record);
  vs_table_begin(&a->table);
  fputs("t_s,what\n", a->events.stream);
  return VS_OK;
}

/* An older result in the folder that this run's files would contradict. */
static void remove_stale(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  unlink(path);
}

/* Which files of an older run in the folder give way to this one's; empty: none. free() it. */
static char *name_replaced(const char *folder) {
  static const char *const FILES[] = {"run.csv", "events.csv",      "summary.json",
                                      "run.raw", "run.partial.csv", "run.partial.raw"};
  char path[VS_PATH_SIZE];
  vs_text names = {0};
  vs_text_add(&names, "%s", "");
  for (size_t k = 0; k < sizeof FILES / sizeof *FILES; k++) {
    snprintf(path, sizeof path, "%s/%s", folder, FILES[k]);
    if (!access(path, F_OK)) vs_text_add(&names, "%s%s", names.length ? ", " : "", FILES[k]);
  }
  return names.text;
}

/* Of a run that failed: what was computed, under a name that says so. */
static void keep_partial(audience *a, vs_error *err) {
  static const char *const STALE[] = {"run.csv", "events.csv", "summary.json", "run.raw",
                                      "run.partial.raw"};
  const char *folder = a->options->folder;
  vs_error second = {0};
  char *replaced = name_replaced(folder);
  for (size_t k = 0; k < sizeof STALE / sizeof *STALE; k++) remove_stale(folder, STALE[k]);
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
  vs_file_discard(&a->raw);
  vs_file_discard(&a->events);
  vs_file_discard(&a->csv);
}

/* ran: how the run ended; again: there will be another. */
static vs_status close_files(audience *a, vs_status ran, bool again, const char *json,
                             vs_error *err) {
  const char *folder = a->options->folder;
  vs_file summary = {0};
  bool partial = ran && ran != VS_INPUT && !again && a->csv.stream;
  if (partial) keep_partial(a, err);
  if (ran) discard_files(a);
  if (ran) vs_folder_unmake(folder, a->made); /* which a part that could be kept forbids */
  if (ran) return ran;
  char *replaced = name_replaced(folder);
  vs_status status = vs_file_open(&summary, folder, "summary.json", err);
  if (!status) fputs(json, summary.stream);
  if (!status && a->raw.stream) status = vs_file_commit(&a->raw, err);
  if (!status) status = vs_file_commit(&a->csv, err);
  if (!status) status = vs_file_commit(&a->events, err);
  if (!status) status = vs_file_commit(&summary, err);
  vs_file_discard(&summary);
  discard_files(a);
  if (!status && *replaced && !a->options->quiet)
    fprintf(stderr, "vibrospice: note: replaced in %s, of an older run: %s\n", folder, replaced);
  free(replaced);
  if (status) vs_folder_unmake(folder, a->made);
  if (status) return status;
  if (!a->options->raw) remove_stale(folder, "run.raw");
  remove_stale(folder, "run.partial.csv");
  remove_stale(folder, "run.partial.raw");
  return VS_OK;
}

static void take_values(audience *a) {
  vs_result_finish(&a->result, a->devices);
  a->result.open_books =
      vs_energy_open(&a->result.energy, a->scene->setup.run.tolerance, a->books, sizeof a->books);
}

/* On one rung of the ladder; more: where ngspice gives up another will be tried, and nothing is
 * kept. */
static vs_status run_scene(const vs_run_options *o, vs_scene *s, const vs_ladder *ladder, bool more,
                           vs_error *err) {
  audience a = {.options = o,
                .scene = s,
                .measures = vs_measures_new(&s->frame),
                .devices = vs_devices_new(&s->frame),
                .show_progress = !o->quiet && isatty(STDERR_FILENO)};
  a.result.measures = a.measures;
  a.result.devices = a.devices;
  a.result.energy.frame = &s->frame;
  a.result.ladder = ladder;
  vs_observer observer = {&a, accept};
  vs_text json = {0};
  vs_status status = o->folder ? open_files(&a, err) : VS_OK;
  s->setup.raw = a.raw.stream;
  vs_heed before = vs_heed_set(VS_HEED_SOON);
  if (!status) {
    a.began_s = wall_clock();
    status = vs_sim_run(s->tier, &s->setup, &observer, err);
    a.result.wall_s = wall_clock() - a.began_s;
    vs_heed_set(VS_HEED_KEEP);
    vs_absence_finish(&a.result.absence, s->setup.run.until_s);
    if (a.shown_s > 0) fputs("\r\033[K", stderr);
  }
  if (!status) {
    take_values(&a);
    vs_summary_json(s, &a.result, !o->reproducible, &json);
  }
  if (o->folder) status = close_files(&a, status, status && err->gave_up && more, json.text, err);
  vs_heed_set(before);
  if (!status && o->json)
    fputs(json.text, stdout);
  else if (!status && !o->quiet) {
    vs_summary_table(s, &a.result, stdout);
    if (o->folder)
      printf("written: run.csv, events.csv, summary.json%s in %s\n", o->raw ? ", run.raw" : "",
             o->folder);
  }
  if (!status && a.result.open_books && !o->quiet)
    fprintf(stderr, "vibrospice: warning: %s\n", a.result.open_books);
  if (!status) status = judge(&a.result, err);
  vs_text_free(&json);
  vs_measures_free(a.measures);
  vs_devices_free(a.devices);
  return status;
}

static vs_status read_scene(const vs_run_options *o, const vs_ladder *ladder, vs_scene *scene,
                            vs_error *err) {
  char **sets = vs_alloc(o->n_sets + VS_LADDER_KEYS, sizeof *sets);
  size_t n = 0;
  for (; n < o->n_sets; n++) sets[n] = o->sets[n];
  for (size_t k = 0; k < ladder->n_keys; k++) sets[n++] = (char *)(size_t)ladder->keys[k];
  vs_status status = vs_scene_read(o->scene, sets, n, o->tier, scene, err);
  free(sets);
  return status || !o->raw ? status : vs_scene_take_circuit(scene, o->tier, "--raw", err);
}

/* No rung helped. */
static vs_status add_rung(const vs_ladder *ladder, vs_error *err) {
  const vs_error last = *err;
  return vs_fail(err, VS_RUN, "%s (%s; before, the scene as it is: %s)", last.text,
                 vs_ladder_text(ladder->rung), ladder->failed);
}

/* Goes to the next rung whose scene can be read; false: there is none. An ideal thyristor is none
 * for a scene that sets what only its own one has. */
static bool next_rung(const vs_run_options *o, const vs_scene *scene, vs_ladder *ladder) {
  if (scene->setup.run.stay || !vs_ladder_climb(ladder, scene)) return false;
  if (!vs_ladder_is_ideal(ladder->rung)) return true;
  vs_scene *other = vs_alloc(1, sizeof *other);
  vs_error err = {0};
  bool good = !read_scene(o, ladder, other, &err);
  vs_scene_free(other);
  free(other);
  return good;
}

/* Runs the scene; when ngspice gives up, again from the beginning with the settings of the ladder's
 * next rung. */
static vs_status climb(const vs_run_options *o, vs_scene *scene, vs_error *err) {
  vs_ladder ladder = {0};
  vs_kept_limits *kept = vs_ladder_keep_limits(&scene->setup.deck);
  vs_status status = VS_OK;
  for (bool again = true; again;) {
    vs_ladder next = ladder;
    bool more = next_rung(o, scene, &next);
    status = run_scene(o, scene, &ladder, more, err);
    again = status == VS_RUN && err->gave_up && more;
    if (status == VS_RUN && err->gave_up && !more && ladder.rung) status = add_rung(&ladder, err);
    if (!again) break;
    if (!ladder.rung) memcpy(next.failed, err->text, sizeof next.failed);
    if (!o->quiet)
      fprintf(stderr, "vibrospice: warning: %s; trying %s\n", err->text, vs_ladder_text(next.rung));
    vs_scene_free(scene);
    ladder = next;
    status = read_scene(o, &ladder, scene, err);
    again = !status;
    if (again && vs_ladder_is_ideal(ladder.rung)) vs_ladder_give_limits(kept, &scene->setup.deck);
  }
  free(kept);
  return status;
}

vs_status vs_run_command(const vs_run_options *o, vs_error *err) {
  if (o->raw && !o->folder)
    return vs_fail(err, VS_INPUT, "--raw: run.raw goes into a folder; name one with -o DIR");
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  const vs_ladder ground = {0};
  vs_status status = read_scene(o, &ground, scene, err);
  if (!status && !o->quiet) vs_scene_warn(scene);
  if (!status) status = climb(o, scene, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
