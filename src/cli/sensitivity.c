/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/shutdown.h"
#include "base/text.h"
#include "commands.h"
#include "ngspice/self_test.h"
#include "options.h"
#include "orbit/sensitivity.h"
#include "report/tornado.h"
#include "run/version.h"
#include "sensitivity.h"

enum { MOST = 64, DIGITS = 12, ERROR_DIGITS = 2 };

/* ---- the names ---- */

/* Names with commas between them, cut up. */
typedef struct names {
  char *text; /* owned */
  vs_asked item[MOST];
  size_t count;
} names;

static vs_status cut_names(const char *option, const char *what, const char *list, names *out,
                           vs_error *err) {
  const vs_where where = {.file = option};
  if (!list) return vs_fail(err, VS_INPUT, "%s %s,... is wanted", option, what);
  out->text = vs_copy(list);
  for (char *word = out->text, *next; word; word = next) {
    next = strchr(word, ',');
    if (next) *next++ = '\0';
    if (!*word) return vs_fail_at(err, where, "a name is missing in '%s'", list);
    if (out->count == MOST) return vs_fail_at(err, where, "more than %d names", MOST);
    for (size_t k = 0; k < out->count; k++)
      if (!strcmp(out->item[k].name, word))
        return vs_fail_at(err, where, "%s stands there a second time", word);
    out->item[out->count++] = (vs_asked){word, where};
  }
  return VS_OK;
}

/* ---- the table ---- */

/* A derivative to as many digits as are known, and a mark where it is by differences. */
static void print_entry(const vs_sensitivity_entry *e, FILE *out) {
  char text[VS_NUMBER_SIZE];
  double known = e->error > 0 ? floor(log10(fabs(e->value) / e->error)) : DIGITS;
  int digits = (int)fmin(fmax(known, 1), DIGITS - 2);
  if (isnan(e->value))
    snprintf(text, sizeof text, "-");
  else if (e->error > fabs(e->value) && e->error > 1e-6)
    snprintf(text, sizeof text, "0 +- %.1g", e->error);
  else
    snprintf(text, sizeof text, "%.*g", digits, e->value);
  fprintf(out, " %17s%s", text, e->exact || isnan(e->value) ? " " : "~");
}

/* The warning about the library that solved the scene's circuit; empty: there is none. */
static const char *warning_of(const vs_scene *scene) {
  return scene->tier->by_ngspice ? vs_self_test_text() : "";
}

/* What exact derivatives are exact in. */
static const char *exact_in(const vs_scene *scene) {
  return scene->tier->has_circuit ? "exact for the steps of the run" : "exact but for rounding";
}

static void print_derivatives(const vs_sensitivity *s, const vs_scene *scene, FILE *out) {
  const char *warning = warning_of(scene);
  double exact = 0;
  bool some = false, differences = false;
  fprintf(out, "%-30s %12s %-9s", "d ln|measure| / d ln key", "value", "");
  for (size_t m = 0; m < s->n_of; m++) fprintf(out, " %17s ", s->of[m].name);
  for (size_t k = 0; k < s->n_to; k++) {
    fprintf(out, "\n%-30s %12.6g %-9s", s->to[k].name, s->to[k].value, s->to[k].unit);
    for (size_t m = 0; m < s->n_of; m++) {
      const vs_sensitivity_entry *e = vs_sensitivity_at(s, m, k);
      print_entry(e, out);
      some = some || e->exact;
      differences = differences || (!e->exact && !isnan(e->value));
      if (e->exact && e->error > exact) exact = e->error;
    }
  }
  fputs("\n\n", out);
  if (some) fprintf(out, "%s: off by %.1g at most\n", exact_in(scene), exact);
  if (differences) fputs("~ by differences of runs, to the digits that they tell\n", out);
  fputs(s->notes.text, out);
  if (*warning) fprintf(out, "warning: %s\n", warning);
}

/* ---- JSON ---- */

static void add_names(vs_json *json, const char *key, const vs_sensitivity_name *n, size_t count) {
  vs_json_object(json, key, VS_JSON_LINES);
  for (size_t k = 0; k < count; k++) {
    vs_json_object(json, n[k].name, VS_JSON_ROW);
    vs_json_number(json, "value", n[k].value, DIGITS);
    vs_json_text(json, "unit", n[k].unit);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_entry(vs_json *json, const char *key, const vs_sensitivity_entry *e) {
  vs_json_number(json, key, e->value, DIGITS);
}
static void add_error(vs_json *json, const char *key, const vs_sensitivity_entry *e) {
  vs_json_number(json, key, e->error, ERROR_DIGITS);
}
static void add_how(vs_json *json, const char *key, const vs_sensitivity_entry *e) {
  vs_json_text(json, key, e->exact ? "exact" : "differences");
}

static void add_derivatives(vs_json *json, const char *name, const vs_sensitivity *s,
                            void (*add)(vs_json *, const char *, const vs_sensitivity_entry *)) {
  vs_json_object(json, name, VS_JSON_LINES);
  for (size_t m = 0; m < s->n_of; m++) {
    vs_json_object(json, s->of[m].name, VS_JSON_LINES);
    for (size_t k = 0; k < s->n_to; k++) add(json, s->to[k].name, vs_sensitivity_at(s, m, k));
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_notes(vs_json *json, const char *notes) {
  vs_json_array(json, "notes", VS_JSON_LINES);
  for (const char *end; (end = strchr(notes, '\n')); notes = end + 1) {
    vs_text line = {0};
    vs_text_add(&line, "%.*s", (int)(end - notes), notes);
    vs_json_text(json, NULL, line.text);
    vs_text_free(&line);
  }
  vs_json_end(json);
}

static void write_derivatives_json(const vs_sensitivity_options *o, const vs_scene *scene,
                                   const vs_sensitivity *s, vs_text *text) {
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  vs_json_text(&json, "scene", o->scene);
  vs_json_text(&json, "tier", scene->tier->name);
  vs_json_bool(&json, "steady", o->steady);
  add_names(&json, "of", s->of, s->n_of);
  add_names(&json, "to", s->to, s->n_to);
  add_derivatives(&json, "derivatives", s, add_entry);
  add_derivatives(&json, "errors", s, add_error);
  add_derivatives(&json, "how", s, add_how);
  add_notes(&json, s->notes.text);
  vs_json_array(&json, "warnings", VS_JSON_ROW);
  if (*warning_of(scene)) vs_json_text(&json, NULL, warning_of(scene));
  vs_json_end(&json);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}

/* ---- files ---- */

static void write_derivative_rows(const vs_sensitivity *s, const char *warning, FILE *out) {
  vs_text cell = {0};
  vs_csv_cell(&cell, warning);
  fputs("measure,key,derivative,error,how,measure_value,measure_unit,key_value,key_unit,warnings\n",
        out);
  for (size_t m = 0; m < s->n_of; m++)
    for (size_t k = 0; k < s->n_to; k++) {
      const vs_sensitivity_entry *e = vs_sensitivity_at(s, m, k);
      fprintf(out, "%s,%s,", s->of[m].name, s->to[k].name);
      if (isnan(e->value))
        fputs(",,,", out);
      else
        fprintf(out, "%.*g,%.*g,%s,", DIGITS, e->value, ERROR_DIGITS, e->error,
                e->exact ? "exact" : "differences");
      fprintf(out, "%.*g,%s,%.*g,%s,%s\n", DIGITS, s->of[m].value, s->of[m].unit, DIGITS,
              s->to[k].value, s->to[k].unit, cell.text ? cell.text : "");
    }
  vs_text_free(&cell);
}

static vs_status write_derivative_files(const char *folder, const vs_sensitivity *s,
                                        const char *json, const char *warning, vs_error *err) {
  vs_file table = {0}, summary = {0};
  int made;
  vs_status status = vs_file_folder_make(folder, &made, err);
  if (!status) status = vs_file_open(&table, folder, "sensitivity.csv", err);
  if (!status) status = vs_file_open(&summary, folder, "summary.json", err);
  if (!status) {
    write_derivative_rows(s, warning, table.stream);
    fputs(json, summary.stream);
    status = vs_file_commit(&table, err);
  }
  if (!status) status = vs_file_commit(&summary, err);
  vs_file_discard(&table);
  vs_file_discard(&summary);
  if (status) vs_file_folder_unmake(folder, made);
  return status;
}

/* ---- the command ---- */

static vs_status report_derivatives(const vs_sensitivity_options *o, const vs_scene *scene,
                                    const vs_sensitivity *s, vs_error *err) {
  vs_text json = {0};
  write_derivatives_json(o, scene, s, &json);
  vs_status status =
      o->folder ? write_derivative_files(o->folder, s, json.text, warning_of(scene), err) : VS_OK;
  if (!status && o->json)
    fputs(json.text, stdout);
  else if (!status && !o->quiet)
    print_derivatives(s, scene, stdout);
  vs_text_free(&json);
  return status;
}

static vs_status find_derivatives(const vs_sensitivity_options *o,
                                  const vs_sensitivity_order *order, vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_sensitivity s = {0};
  scene->of_period = o->steady;
  vs_status status = vs_scene_read(o->scene, o->sets, o->n_sets, o->tier, scene, err);
  scene->allow_code = o->allow_code;
  if (!status && o->steady) vs_scene_disable_control(scene);
  if (!status) status = vs_control_allow(&scene->control, o->allow_code, err);
  if (!status && !o->quiet) vs_scene_warn(scene);
  scene->order.shows = !o->quiet && isatty(STDERR_FILENO);
  if (!status) status = vs_sensitivity_find(scene, order, &s, err);
  if (!status || (status == VS_BUDGET && s.told)) {
    vs_error other = {0};
    vs_status reported = report_derivatives(o, scene, &s, &other);
    if (reported) *err = other, status = reported;
  }
  vs_sensitivity_free(&s);
  vs_scene_free(scene);
  free(scene);
  return status;
}

vs_status vs_sensitivity_command(const vs_sensitivity_options *o, vs_error *err) {
  names of = {0}, to = {0};
  if (o->period != 1 && !o->steady)
    return vs_fail(err, VS_INPUT, "--period %d: it is of an orbit; write --steady, too", o->period);
  vs_status status = cut_names("--of", "MEASURE", o->of, &of, err);
  if (!status) status = cut_names("--to", "KEY", o->to, &to, err);
  const vs_sensitivity_order order = {
      .of = of.item,
      .to = to.item,
      .n_of = of.count,
      .n_to = to.count,
      .periods = o->steady ? o->period : 0,
      .stop = o->stop,
  };
  if (!status) status = find_derivatives(o, &order, err);
  free(of.text);
  free(to.text);
  return status;
}

/* ---- the command line ---- */

typedef struct sensitivity_line {
  vs_arguments common;
  vs_sensitivity_options o;
} sensitivity_line;

static vs_status sensitivity_command(const void *given, vs_error *err) {
  const sensitivity_line *line = given;
  const vs_arguments *a = &line->common;
  vs_sensitivity_options o = line->o;
  o.scene = vs_command_name(a);
  o.sets = a->sets;
  o.n_sets = a->n_sets;
  o.folder = a->output;
  o.json = a->json;
  o.quiet = a->quiet;
  o.allow_code = a->allow_code;
  o.stop = &vs_shutdown_requested;
  vs_status status = vs_sensitivity_command(&o, err);
  vs_error why = {0};
  if (!status && a->output && vs_tornado_draw(a->output, a->quiet || a->json, &why))
    fprintf(stderr, "vibrospice: warning: there is no picture: %s\n", why.text);
  return status;
}

static const vs_option SENSITIVITY_OPTIONS[] = {
    VS_OPTIONS_WORD(sensitivity_line, o.of, "of", "MEASURE,...", "of which measures"),
    VS_OPTIONS_WORD(sensitivity_line, o.to, "to", "KEY,...",
                    "with respect to which keys of the scene"),
    VS_OPTIONS_FLAG(sensitivity_line, o.steady, "steady",
                    "of a period of the orbit (see steady), instead of the scene's run"),
    VS_OPTIONS_WHOLE(sensitivity_line, o.period, 1, 1000, "period", "N",
                     "with --steady: of N firing periods (default 1)"),
    VS_OPTIONS_SET,
    VS_OPTIONS_TIER(sensitivity_line, o.tier),
    VS_OPTIONS_OUTPUT("DIR", "writes sensitivity.csv, summary.json and the picture tornado there"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_sensitivity_cli = {
    .name = "sensitivity",
    .argument = "SCENE",
    .text = "logarithmic derivatives of measures with respect to keys of the scene, of its run or "
            "of its orbit, each with its error",
    .examples =
        "  vibrospice sensitivity paper --of p_first_peak --to firing.angle,supply.voltage\n"
        "  vibrospice sensitivity paper --steady --set firing.every=1 --of p_min,power_in --to "
        "firing.angle,actuator.gap -o tornado\n",
    .options = SENSITIVITY_OPTIONS,
    .size = sizeof(sensitivity_line),
    .defaults = &(const sensitivity_line){.o.period = 1},
    .run = sensitivity_command};
