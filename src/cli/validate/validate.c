/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "validate/validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/json.h"
#include "base/shutdown.h"
#include "base/text.h"
#include "commands.h"
#include "engine/budget.h"
#include "ngspice/circuit.h"
#include "options.h"
#include "run/version.h"

/* An experiment that some of the chosen comparisons need. It is done when the first of them asks.
 */
typedef struct outcome {
  const vs_experiment *experiment;
  bool done;
  vs_numbers numbers;
  vs_status status;
  vs_error err;
} outcome;

typedef struct session {
  const vs_validate_options *options;
  const vs_comparison **chosen;
  size_t n_chosen, failed;
  outcome *outcomes;
  size_t n_outcomes;
  const vs_comparison *now;
  const vs_experiment *present;
  double began_s, shown_s, stage_s; /* wall clock; stage: of the present experiment */
  double planned_s, passed_s;       /* sums of wall_s: of all; of those that are done */
  bool show_progress;
  unsigned long steps;
  vs_text text; /* of --json */
  vs_json json;
} session;

/* ---- choosing ---- */

static outcome *outcome_of(session *s, const vs_experiment *e) {
  for (size_t k = 0; k < s->n_outcomes; k++)
    if (s->outcomes[k].experiment == e) return &s->outcomes[k];
  return NULL;
}

static void plan_experiment(session *s, const vs_experiment *e) {
  if (!e || outcome_of(s, e)) return;
  s->outcomes[s->n_outcomes++].experiment = e;
  s->planned_s += e->wall_s;
}

static vs_status choose_comparisons(session *s, const vs_comparisons *const *lists, size_t n_lists,
                                    vs_error *err) {
  const char *word = s->options->word;
  size_t most = 0;
  for (size_t l = 0; l < n_lists; l++) most += lists[l]->count;
  s->chosen = vs_alloc(most + 1, sizeof *s->chosen);
  s->outcomes = vs_alloc(2 * most + 1, sizeof *s->outcomes);
  for (size_t l = 0; l < n_lists; l++)
    for (size_t k = 0; k < lists[l]->count; k++) {
      const vs_comparison *c = &lists[l]->item[k];
      if (word && !strcasestr(c->name, word)) continue;
      s->chosen[s->n_chosen++] = c;
      plan_experiment(s, c->experiment);
      plan_experiment(s, c->other);
    }
  if (s->n_chosen) return VS_OK;
  return vs_fail(err, VS_INPUT,
                 "validate: no check's name has '%s' in it; see vibrospice validate --list", word);
}

/* ---- doing ---- */

static void hide_progress(session *s) {
  if (s->shown_s > 0) dprintf(STDERR_FILENO, "\r\033[K");
  s->shown_s = 0;
}

/* The planned time is scaled by what the experiments so far have taken; the present one counts with
 * the time it has taken, but at most with its plan. */
static void show_progress(session *s) {
  double now = vs_budget_clock_s(), spent = now - s->began_s;
  if (!s->show_progress || spent < 1 || now - s->shown_s < 0.25) return;
  double part = (s->passed_s + fmin(now - s->stage_s, s->present->wall_s)) / s->planned_s;
  s->shown_s = now;
  dprintf(STDERR_FILENO, "\r%3.0f %%, %.0f s left: %s \033[K", 100 * part,
          spent * (1 - part) / part, s->now->name);
}

static vs_status watch_validation(void *ctx, const vs_step *step, vs_error *err) {
  session *s = ctx;
  (void)step;
  if (s->steps++ % 256 == 0) show_progress(s);
  return *s->options->stop ? vs_fail(err, VS_SIGNAL, "validate: stopped by a signal") : VS_OK;
}

static outcome *perform_experiment(session *s, const vs_experiment *e) {
  outcome *o = outcome_of(s, e);
  if (o->done) return o;
  const vs_observer observer = {s, watch_validation};
  s->stage_s = vs_budget_clock_s();
  s->present = e;
  show_progress(s);
  o->status = e->perform(e, &observer, &o->numbers, &o->err);
  o->done = true;
  s->passed_s += e->wall_s;
  if (o->status && o->status != VS_SIGNAL) {
    hide_progress(s);
    fprintf(stderr, "vibrospice: validate: %s: %s\n", s->now->name, o->err.text);
  }
  return o;
}

typedef struct verdict {
  double expected, got, error; /* error: as a part of the comparison's scale */
  bool good;
  const char *failure; /* of a run, one line; NULL: none */
} verdict;

static verdict judge_comparison(session *s, const vs_comparison *c, vs_status *status) {
  verdict v = {.expected = c->expected, .got = NAN};
  const outcome *o = perform_experiment(s, c->experiment),
                *other = c->other ? perform_experiment(s, c->other) : NULL;
  if (o->status) v.failure = o->err.text;
  if (other && other->status) v.failure = other->err.text;
  if (o->status == VS_SIGNAL || (other && other->status == VS_SIGNAL)) *status = VS_SIGNAL;
  if (!o->status) v.got = vs_experiment_get(&o->numbers, c->what);
  if (other) v.expected = other->status ? NAN : vs_experiment_get(&other->numbers, c->what);
  v.error = fabs(v.got - v.expected) / fabs(c->scale != 0 ? c->scale : v.expected);
  v.good = v.error <= c->tolerance; /* never of a number that is none */
  return v;
}

/* ---- showing ---- */

static int name_width(const session *s) {
  size_t width = 0;
  for (size_t k = 0; k < s->n_chosen; k++)
    if (strlen(s->chosen[k]->name) > width) width = strlen(s->chosen[k]->name);
  return (int)width;
}

static void print_comparison(const session *s, const vs_comparison *c, const verdict *v) {
  printf("%-3s %-*s %15.10g %15.10g %-6s %8.1e %8.1e  %s; %s\n", v->good ? "ok" : "OFF",
         name_width(s), c->name, v->expected, v->got, c->unit, v->error, c->tolerance, c->source,
         c->why);
}

static void add_comparison_json(session *s, const vs_comparison *c, const verdict *v) {
  enum { DIGITS = 17 }; /* a double's, exactly */
  vs_json *json = &s->json;
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "name", c->name);
  vs_json_text(json, "unit", c->unit);
  vs_json_number(json, "expected", v->expected, DIGITS);
  vs_json_number(json, "got", v->got, DIGITS);
  vs_json_number(json, "error", v->error, DIGITS);
  vs_json_number(json, "tolerance", c->tolerance, DIGITS);
  vs_json_number(json, "scale", c->scale != 0 ? fabs(c->scale) : fabs(v->expected), DIGITS);
  vs_json_text(json, "source", c->source);
  vs_json_text(json, "tolerance_why", c->why);
  if (v->failure) vs_json_text(json, "failure", v->failure);
  vs_json_bool(json, "ok", v->good);
  vs_json_end(json);
}

static void begin_json(session *s) {
  s->json = vs_json_new(&s->text);
  vs_json_object(&s->json, NULL, VS_JSON_LINES);
  vs_version_json(&s->json);
  vs_json_array(&s->json, "checks", VS_JSON_LINES);
}

static void print_comparisons_json(session *s) {
  vs_json_end(&s->json);
  vs_json_whole(&s->json, "count", (int64_t)s->n_chosen);
  vs_json_same_row(&s->json);
  vs_json_whole(&s->json, "off", (int64_t)s->failed);
  vs_json_same_row(&s->json);
  vs_json_bool(&s->json, "ok", !s->failed);
  vs_json_end(&s->json);
  puts(s->text.text);
}

static void show_comparison(session *s, const vs_comparison *c, const verdict *v) {
  hide_progress(s);
  if (!v->good && s->options->quiet)
    fprintf(stderr,
            "vibrospice: validate: %s: expected %.10g, got %.10g %s: off by %.2g, allowed %.2g\n",
            c->name, v->expected, v->got, c->unit, v->error, c->tolerance);
  if (s->options->json)
    add_comparison_json(s, c, v);
  else if (!s->options->quiet) {
    print_comparison(s, c, v);
    fflush(stdout);
  }
}

static vs_status make_comparisons(session *s, vs_error *err) {
  vs_status status = VS_OK;
  begin_json(s);
  if (!s->options->json && !s->options->quiet)
    printf("%-3s %-*s %15s %15s %-6s %8s %8s  %s\n", "", name_width(s), "check", "expected", "got",
           "", "error", "allowed", "source; tolerance");
  for (size_t k = 0; k < s->n_chosen; k++) {
    s->now = s->chosen[k];
    const verdict v = judge_comparison(s, s->now, &status);
    if (status || *s->options->stop) break;
    s->failed += !v.good;
    show_comparison(s, s->now, &v);
  }
  hide_progress(s);
  if (status || *s->options->stop) return vs_fail(err, VS_SIGNAL, "validate: stopped by a signal");
  if (s->options->json) print_comparisons_json(s);
  if (!s->options->json && !s->options->quiet)
    printf("%zu check%s, %zu off, in %.1f s\n", s->n_chosen, s->n_chosen > 1 ? "s" : "", s->failed,
           vs_budget_clock_s() - s->began_s);
  return s->failed ? vs_fail(err, VS_RUN, "validate: %zu of %zu off", s->failed, s->n_chosen)
                   : VS_OK;
}

vs_status vs_validate(const vs_comparisons *const *lists, size_t n_lists,
                      const vs_validate_options *options, vs_error *err) {
  session s = {.options = options, .began_s = vs_budget_clock_s()};
  s.show_progress = !options->quiet && isatty(STDERR_FILENO);
  vs_status status = choose_comparisons(&s, lists, n_lists, err);
  for (size_t k = 0; k < s.n_chosen && options->list; k++) puts(s.chosen[k]->name);
  if (!status && !options->list) status = make_comparisons(&s, err);
  for (size_t k = 0; k < s.n_outcomes; k++) vs_experiment_numbers_free(&s.outcomes[k].numbers);
  vs_text_free(&s.text);
  free(s.outcomes);
  free(s.chosen);
  return status;
}

/* The program's own comparisons. */
static const vs_comparisons *const LISTS[] = {
    &vs_single_shot_comparisons, &vs_phase_control_comparisons, &vs_continuous_comparisons,
    &vs_tiers_comparisons,       &vs_snubber_comparisons,       &vs_surge_comparisons,
    &vs_machines_comparisons};

/* ---- the command line ---- */

typedef struct validate_line {
  vs_arguments common;
  bool list;
} validate_line;

static vs_status validate_command(const void *given, vs_error *err) {
  const validate_line *line = given;
  const vs_validate_options o = {.word = vs_command_name(&line->common),
                                 .json = line->common.json,
                                 .quiet = line->common.quiet,
                                 .list = line->list,
                                 .stop = &vs_shutdown_requested};
  return vs_validate(LISTS, sizeof LISTS / sizeof *LISTS, &o, err);
}

static const vs_option VALIDATE_OPTIONS[] = {
    VS_OPTIONS_FLAG(validate_line, list, "list", "names the checks and does none"), VS_OPTIONS_JSON,
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "says only what is off"), VS_OPTIONS_END};

const vs_command vs_validate_cli = {
    .name = "validate",
    .argument = "[WORD]",
    .text = "compares with closed forms and reference solutions, and tier with tier, each with "
            "its error; "
            "WORD: only checks whose names have it",
    .examples =
        "  vibrospice validate\n  vibrospice validate snubber\n  vibrospice validate --json\n",
    .may_be_alone = true,
    .options = VALIDATE_OPTIONS,
    .size = sizeof(validate_line),
    .run = validate_command};
