/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `steady`: finds the periodic orbit of a scene, or follows a branch of orbits, and
 * reports it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "commands.h"
#include "measure/harmonic_classes.h"
#include "ngspice/crash_guard.h"
#include "options.h"
#include "orbit/branch.h"
#include "orbit/closed_loop.h"
#include "orbit/linear_report.h"
#include "orbit/marks.h"
#include "orbit/steady.h"
#include "run.h"
#include "run/engineering.h"
#include "run/show.h"

enum { DIGITS = 12, SHOWN = 10 /* the last harmonic in the table; JSON has all */ };

static const char STANDARD[] = "IEC 61000-3-2:2018, table 1";

/* ---- the limits of harmonics ---- */

/* How much of its limit the harmonic takes; NaN: it has none. */
static double part_of_limit(const vs_steady *s, int n) {
  return vs_spectrum_judged(&s->spectrum, n) / vs_spectrum_limit(n);
}

/* The harmonic that takes most of its limit. */
static int worst_harmonic(const vs_steady *s) {
  int worst = 2;
  for (int n = worst; n < VS_SPECTRUM_LINES; n++)
    if (part_of_limit(s, n) > part_of_limit(s, worst)) worst = n;
  return worst;
}

/* ---- the material ---- */

static const char *of_material(const vs_steady *s) {
  vs_value down = vs_throw_down(&s->thrown);
  if (!down.known) return NULL;
  if (!(down.value > 1))
    return "is not thrown; whether it slides is not computed, nor is a conveying speed";
  if (down.value > vs_throw_most)
    return "is thrown, for longer than a swing (throw_down above 3.297): conveying_speed is "
           "outside "
           "of its formula's range, and is that of a flight as long as a swing";
  return "is thrown, once in each swing; conveying_speed holds for a trough that swings like a "
         "sine along a straight line, without sliding, and grainy material comes close to it";
}

static void add_material(const vs_steady *s, vs_json *json) {
  vs_value down = vs_throw_down(&s->thrown);
  if (!down.known) return;
  vs_json_object(json, "material", VS_JSON_ROW);
  vs_json_bool(json, "thrown", down.value > 1);
  vs_json_bool(json, "speed_in_range", down.value > 1 && down.value <= vs_throw_most);
  vs_json_text(json, "speed_source", "VDI 2333");
  vs_json_text(json, "says", of_material(s));
  vs_json_end(json);
}

/* ---- what was found ---- */

static double multiplier_size(const vs_steady *s, int k) {
  return hypot(s->orbit.multiplier[k].re, s->orbit.multiplier[k].im);
}

/* On tier circuit multipliers are known to some error only, in which small ones are lost. */
static bool is_resolved(const vs_steady *s, int k) {
  return !s->picard || multiplier_size(s, k) > s->picard->known_to;
}

/* ---- JSON ---- */

static void add_orbit_measures(const void *ctx, vs_json *json) {
  vs_steady_measure m;
  for (int k = 0; vs_steady_at(ctx, k, &m); k++) {
    if (m.value.known) vs_summary_measure(json, m.name, m.value, m.unit);
  }
}

static void add_multipliers(const vs_steady *s, vs_json *json) {
  const vs_orbit *orbit = &s->orbit;
  vs_json_array(json, "multipliers", VS_JSON_LINES);
  for (int k = 0; k < vs_steady_multipliers(s); k++) {
    bool known = is_resolved(s, k);
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_number(json, "re", known ? orbit->multiplier[k].re : NAN, DIGITS);
    vs_json_number(json, "im", known ? orbit->multiplier[k].im : NAN, DIGITS);
    if (!known) vs_json_number(json, "below", s->picard->known_to, 3);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_harmonics(const vs_steady *s, vs_json *json) {
  int worst = worst_harmonic(s);
  vs_json_array(json, "harmonics", VS_JSON_ROW);
  for (int n = 0; n < VS_SPECTRUM_LINES; n++)
    vs_json_number(json, NULL, vs_spectrum_harmonic(&s->spectrum, n), DIGITS);
  vs_json_end(json);
  vs_summary_groups(json, "harmonic_groups", &s->spectrum);
  vs_json_object(json, "harmonic_limits", VS_JSON_LINES);
  vs_json_text(json, "standard", STANDARD);
  vs_json_text(json, "class", "A");
  vs_summary_limit(json, worst, part_of_limit(s, worst));
  vs_json_array(json, "limits_A", VS_JSON_ROW);
  for (int n = 0; n < VS_SPECTRUM_LINES; n++)
    vs_json_number(json, NULL, vs_spectrum_limit(n), DIGITS);
  vs_json_end(json);
  vs_json_end(json);
}

static vs_drawn_current drawn_of(const vs_steady *s) {
  return (vs_drawn_current){&s->spectrum, s->power_in_w, s->power_factor};
}

static void add_classes(const vs_steady *s, vs_json *json) {
  const vs_drawn_current drawn = drawn_of(s);
  vs_json_array(json, "harmonic_classes", VS_JSON_LINES);
  for (const vs_harmonic_class *c = vs_harmonic_classes_all; c->name; c++) {
    double part;
    int worst = vs_harmonic_classes_worst(c, &drawn, &part);
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "class", c->name);
    vs_json_text(json, "text", c->text);
    vs_summary_limit(json, worst, part);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_orbit_members(const void *ctx, vs_json *json) {
  const vs_steady *s = ctx;
  vs_json_whole(json, "period", s->orbit.n);
  vs_json_number(json, "period_s", s->orbit.period_s, DIGITS);
  if (s->picard)
    vs_json_whole(json, "cycles", s->picard->cycles);
  else
    vs_json_whole(json, "iterations", s->orbit.iterations);
  vs_json_number(json, "correction", s->orbit.residual, 3);
  if (vs_steady_is_judged(s))
    vs_json_bool(json, "stable", s->orbit.stable);
  else
    vs_json_number(json, "stable", NAN, DIGITS); /* null */
  if (s->picard && s->picard->multipliers)
    vs_json_number(json, "multipliers_error", s->picard->known_to, 3);
  add_multipliers(s, json);
  add_harmonics(s, json);
  add_classes(s, json);
  add_material(s, json);
}

/* ---- the table ---- */

/* Of a multiplier: how long it takes until what it tells of has decayed to 1/e. */
static void print_multiplier(const vs_steady *s, int k, FILE *out) {
  const vs_orbit *orbit = &s->orbit;
  const vs_multiplier *m = &orbit->multiplier[k];
  if (!is_resolved(s, k)) {
    fprintf(out, "%-10d not resolved: below %.1g\n", k + 1, s->picard->known_to);
    return;
  }
  double size = hypot(m->re, m->im), tau_s = -orbit->period_s / log(size);
  fprintf(out, "%-10d %15.9g %15.9g %15.9g ", k + 1, m->re, m->im, size);
  if (size < 1)
    fprintf(out, "%12.4g s\n", tau_s);
  else
    fprintf(out, "%14s\n", "-");
}

static void print_stability(const vs_steady *s, FILE *out) {
  const bool stable = s->orbit.stable;
  if (vs_steady_is_judged(s))
    fprintf(out, "%s: the largest multiplier is %s\n", stable ? "stable" : "unstable",
            stable ? "below 1" : "1 or more, so that the machine does not stay on this orbit");
}

static void print_multipliers(const vs_steady *s, FILE *out) {
  if (!vs_steady_multipliers(s)) {
    fprintf(out, "multipliers  not resolved: %s\n", s->picard->missing);
    return;
  }
  fprintf(out, "%-10s %15s %15s %15s %14s\n", "multiplier", "re", "im", "size", "decays in");
  for (int k = 0; k < vs_steady_multipliers(s); k++) print_multiplier(s, k, out);
  if (s->picard)
    fprintf(out, "known to about %.1g, from the differences of cycles%s\n", s->picard->known_to,
            vs_steady_is_judged(s) ? "" : ": not enough to tell whether the orbit is stable");
  print_stability(s, out);
}

static void print_limits(const vs_steady *s, FILE *out) {
  int worst = worst_harmonic(s);
  fprintf(out,
          "limits: %s, class A; %s held up to harmonic %d: harmonic %d takes %.3g %% of its own\n",
          STANDARD, part_of_limit(s, worst) <= 1 ? "all are" : "not all are", VS_SPECTRUM_LAST,
          worst, 100 * part_of_limit(s, worst));
}

static void print_harmonics(const vs_steady *s, FILE *out) {
  const bool groups = s->spectrum.grouping.told;
  fprintf(out, "\n%-10s %15s", "harmonic", "A rms");
  if (groups) fprintf(out, " %15s", "group A rms");
  fprintf(out, " %15s %15s\n", "limit A rms", "part of limit");
  for (int n = 0; n <= SHOWN; n++) {
    fprintf(out, "%-10d %15.9g", n, vs_spectrum_harmonic(&s->spectrum, n));
    if (groups && n) fprintf(out, " %15.9g", vs_spectrum_judged(&s->spectrum, n));
    if (!isnan(vs_spectrum_limit(n)))
      fprintf(out, " %15.4g %13.2f %%", vs_spectrum_limit(n), 100 * part_of_limit(s, n));
    fputc('\n', out);
  }
  print_limits(s, out);
  vs_show_windows(&s->spectrum, out);
}

static void print_orbit(const vs_steady *s, FILE *out) {
  const vs_orbit *orbit = &s->orbit;
  fprintf(out, "orbit  of %.9g s, period %d, in %d %s; the last corrected it by %.1g\n",
          orbit->period_s, orbit->n, s->picard ? s->picard->cycles : orbit->iterations,
          s->picard ? "cycles" : "iterations", orbit->residual);
}

/* What a short table tells of an orbit, where it is known. */
static void show_orbit_briefly(const vs_steady *s, FILE *out) {
  static const char *const FEW[] = {"power_in",        "i_rms", "power_factor", "thd", "throw_down",
                                    "conveying_speed", NULL};
  char text[VS_ENGINEERING_SIZE];
  vs_steady_measure m;
  print_orbit(s, out);
  print_stability(s, out);
  print_limits(s, out);
  for (int k = 0; vs_steady_at(s, k, &m); k++)
    for (const char *const *name = FEW; *name; name++)
      if (m.value.known && !strcmp(m.name, *name))
        fprintf(out, "%-16s %13s   %s\n", m.name, vs_engineering_text(m.value.value, m.unit, text),
                m.text);
  const char *material = of_material(s);
  if (material) fprintf(out, "material: %s\n", material);
}

static void show_orbit(const vs_steady *s, FILE *out) {
  const vs_drawn_current drawn = drawn_of(s);
  vs_steady_measure m;
  print_orbit(s, out);
  fputc('\n', out);
  print_multipliers(s, out);
  print_harmonics(s, out);
  fputc('\n', out);
  vs_show_classes(&drawn, out);
  fprintf(out, "\n%-18s %16s\n", "over a period", "computed");
  for (int k = 0; vs_steady_at(s, k, &m); k++)
    if (m.value.known)
      fprintf(out, "%-18s %16.9g %-5s %s\n", m.name, m.value.value, m.unit, m.text);
  const char *material = of_material(s);
  if (material) fprintf(out, "material: %s\n", material);
  fputc('\n', out);
}

/* ---- the command ---- */

/* Reports on the run of one period. The functions above get it as ctx, which points to its first
 * member, too. */
typedef struct reporter {
  vs_steady steady;
  vs_linear_report *matrices; /* NULL: no linear model is wanted */
  vs_closed_loop *closed; /* the closed loop of the scene's control; NULL: it has none to tell */
  vs_error unclosed;      /* why there is none of a control that should have one */
  vs_scene *scene;
  bool quiet, all;
} reporter;

static void begin_period(void *ctx, vs_scene *scene) {
  reporter *r = ctx;
  r->scene = scene;
  vs_steady_again(&r->steady, scene);
}

static void accept_step_of_period(void *ctx, const vs_step *step) {
  vs_steady_accept(ctx, step);
}

static void finish_period(void *ctx, const vs_result *result) {
  reporter *r = ctx;
  const vs_warnings *w = &r->scene->warnings;
  size_t said = w->count;
  vs_steady_finish(&r->steady, result);
  for (size_t k = said; k < w->count && !r->quiet; k++)
    fprintf(stderr, "vibrospice: warning: %s\n", vs_warnings_text(&w->item[k]));
}

/* The least and the largest mains, V rms, that STANDARD is for: 220 V to neutral and 415 V between
 * lines (clause 6.1), within 10 %. */
static const double MAINS_V[2] = {0.9 * 220, 1.1 * 415};

/* The standard is for other mains. */
static void print_foreign_mains(const vs_supply_values *supply, FILE *out) {
  if (supply->direct || (supply->voltage_v >= MAINS_V[0] && supply->voltage_v <= MAINS_V[1]))
    return;
  fprintf(out, "the limits of %s are for mains of 220 V to 415 V; supply.voltage is %.4g V\n",
          STANDARD, supply->voltage_v);
}

static void show_period(const void *ctx, FILE *out) {
  const reporter *r = ctx;
  if (r->all) {
    vs_show_machine_and_supply(&r->scene->setup, out);
    show_orbit(ctx, out);
    print_foreign_mains(&r->scene->setup.timeline.supply, out);
  } else
    show_orbit_briefly(ctx, out);
  if (r->matrices) vs_linear_report_print(r->matrices, out);
  if (r->closed && !*r->unclosed.text) vs_closed_loop_print(r->closed, out);
  if (r->closed && *r->unclosed.text)
    fprintf(out, "control  its closed loop is not known: %s\n\n", r->unclosed.text);
}

static void add_period_members(const void *ctx, vs_json *json) {
  const reporter *r = ctx;
  add_orbit_members(ctx, json);
  if (r->matrices) vs_linear_report_json(r->matrices, json);
  if (r->closed && !*r->unclosed.text) vs_closed_loop_json(r->closed, json);
  if (r->closed && *r->unclosed.text) vs_json_text(json, "closed_loop_missing", r->unclosed.text);
}

/* The linear model's files lie beside those of the run, which has just been written. */
static vs_status write_linear(const vs_run_options *o, const vs_linear_report *matrices,
                              vs_error *err) {
  if (!o->folder) return VS_OK;
  if (!matrices) {
    vs_linear_report_remove(o->folder);
    return VS_OK;
  }
  vs_status status = vs_linear_report_write(matrices, o->folder, err);
  if (!status && !o->quiet && !o->json)
    printf("written: %s in %s\n", vs_linear_report_files(), o->folder);
  return status;
}

/* Finds the closed loop of the scene's control about the orbit. The control itself is off while the
 * orbit is sought. Where there is no loop, or it is not found, the command goes on without it. */
static void find_closed_loop(reporter *r, const vs_regulator *regulator, const vs_scene *scene) {
  if (!regulator || !regulator->pi || scene->tier->has_circuit || r->steady.orbit.n > 1) return;
  r->closed = vs_alloc(1, sizeof *r->closed);
  if (vs_closed_loop_find(scene, regulator, &r->steady.orbit, r->closed, &r->unclosed) &&
      !*r->unclosed.text)
    vs_fail(&r->unclosed, VS_RUN, "it was not found");
}

/* What is to be told besides the orbit. */
typedef struct extras {
  bool linear;
  const vs_regulator *regulator; /* the scene's; NULL: it has none */
} extras;

static vs_status run_period(const vs_run_options *o, int periods, extras more_of, vs_scene *scene,
                            vs_error *err) {
  bool linear = more_of.linear;
  reporter *r = vs_alloc(1, sizeof *r);
  vs_steady *s = &r->steady;
  const vs_run_more more = {r,
                            begin_period,
                            accept_step_of_period,
                            finish_period,
                            show_period,
                            {r, add_orbit_measures, add_period_members},
                            NULL};
  scene->order.stop = o->stop;
  vs_status status = linear ? vs_linear_check(scene, periods, err) : VS_OK;
  if (!status) status = vs_steady_begin(s, scene, periods, err);
  r->scene = scene;
  r->quiet = o->quiet;
  r->all = o->all;
  if (!status && linear) {
    r->matrices = vs_alloc(1, sizeof *r->matrices);
    status = vs_linear_report_find(r->matrices, scene, &s->orbit, err);
  }
  if (!status) find_closed_loop(r, more_of.regulator, scene);
  if (!status) status = vs_run_scene(o, &more, scene, err);
  if (!status || status == VS_RATING) {
    vs_status written = write_linear(o, r->matrices, err);
    status = written ? written : status;
  }
  vs_steady_end(s);
  if (r->matrices) vs_linear_report_free(r->matrices);
  free(r->matrices);
  free(r->closed);
  free(r);
  return status;
}

/* ---- the command line ---- */

typedef struct steady_line {
  vs_arguments common;
  vs_run_options run;
  vs_branch_parameter_words words;
  int period;
  bool linear;
} steady_line;

/* Where no orbit or no model is found nothing is written. */
static vs_status report_orbits(const vs_run_options *o, const steady_line *line, vs_error *err) {
  const vs_branch_options branch = {line->words, line->period, o->digits, o->folder,
                                    o->json,     o->quiet,     o->stop};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  scene->of_period = true;
  vs_status status = vs_scene_read(o->scene, o->sets, o->n_sets, o->tier, scene, err);
  const extras more = {line->linear, scene->control.regulator};
  if (!status) vs_scene_disable_control(scene);
  if (!status && !o->quiet && !vs_crash_guard_again()) vs_scene_warn(scene);
  scene->order.shows = !o->quiet && isatty(STDERR_FILENO);
  if (!status)
    status = line->words.range ? vs_branch_command(&branch, scene, err)
                               : run_period(o, line->period, more, scene, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}

static vs_status steady_command(const void *given, vs_error *err) {
  const steady_line *line = given;
  const vs_branch_parameter_words *w = &line->words;
  const vs_run_options o = vs_options_of_run(&line->run, &line->common);
  if ((w->step || w->at) && !w->range)
    return vs_fail(err, VS_INPUT, "--%s: it goes with --along; see vibrospice steady --help",
                   w->step ? "step" : "at");
  if (line->linear && w->range)
    return vs_fail(err, VS_INPUT, "--linear: it is about one orbit, and does not go with --along");
  return report_orbits(&o, line, err);
}

static void explain_steady(vs_text *help) {
  vs_text_add(help, "\nOver one period it reports, besides the measures of every run:\n");
  vs_steady_measure m;
  const vs_steady none = {0};
  for (int k = 0; vs_steady_at(&none, k, &m); k++)
    vs_text_add(help, "  %-17s %-2s %s\n", m.name, m.unit, m.text);
  vs_text_add(help, "  %-17s    %s\n  %-17s    %s\n", "reaction_NAME",
              "largest size of what springs and dampers do along the coordinate NAME",
              "reaction_NAME_rms", "its root mean square");
  vs_text_add(help, "With --along it reports, besides points of the branch:\n");
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++)
    vs_text_add(help, "  %-17s    %s\n", (*kind)->name, (*kind)->text);
  vs_text_add(
      help,
      "Branches are followed on tier %s, or with the circuit on tier %s; a scene that would "
      "take another one wants --tier.\n",
      vs_tiers_automatic(false)->name, vs_compiled_tier.name);
}

static const vs_option STEADY_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_TOLERANCE,
    VS_OPTIONS_ANGLE,
    VS_OPTIONS_TIER(steady_line, run.tier),
    VS_OPTIONS_WHOLE(steady_line, period, 1, 1000, "period", "N",
                     "the orbit repeats after N firing periods, of firing.every cycles of the "
                     "mains each (default 1)"),
    VS_OPTIONS_WORD(steady_line, words.range, "along", "KEY=FROM..TO",
                    "follows the orbit over a scene key, around folds: where it grazes a stop, "
                    "turns, loses its stability"),
    VS_OPTIONS_WORD(steady_line, words.at, "at", "VALUE",
                    "with --along: reports every orbit of the branch at that value of the key"),
    VS_OPTIONS_WORD(steady_line, words.step, "step", "S",
                    "the key's largest change from point to point (default a 50th of the range)"),
    VS_OPTIONS_FLAG(steady_line, linear, "linear",
                    "linear models about the orbit, from the firing angle to the state at the next "
                    "firing and to the amplitude; with -o linear.json and linear_*.csv, too"),
    VS_OPTIONS_OUTPUT(
        "DIR", "writes run.csv of one period, events.csv and summary.json there, and peaks.csv "
               "where peaks lie between the rows of run.csv; with "
               "--along branch.csv, branch.json and branch.png"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_ALL(steady_line, run.all),
    VS_OPTIONS_REPRODUCIBLE(steady_line, run.reproducible),
    VS_OPTIONS_DIGITS(steady_line, run.digits),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_steady_cli = {
    .name = "steady",
    .argument = "SCENE",
    .text = "finds the periodic motion of a machine that is fired in every cycle: stability, "
            "power, harmonics, measures of one period",
    .examples = "  vibrospice steady paper --set firing.every=1\n"
                "  vibrospice steady two_mass --set firing.every=1 --set firing.angle=130deg -o "
                "work\n"
                "  vibrospice steady paper --set firing.every=1 --linear -o model\n"
                "  vibrospice steady paper --set firing.every=1 --along "
                "firing.angle=130deg..70deg -o branch\n",
    .options = STEADY_OPTIONS,
    .size = sizeof(steady_line),
    .defaults = &(const steady_line){.run.digits = 9, .period = 1},
    .run = steady_command,
    .explain = explain_steady};
