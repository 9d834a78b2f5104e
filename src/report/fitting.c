/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/fitting.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/leave.h"
#include "fitted.h"
#include "found.h"
#include "portrait.h"

/* ---- files ---- */

typedef void (*csv_writer)(const vs_outcome *outcome, int digits, FILE *out);

static void write_json(const vs_outcome *o, int digits, FILE *out) {
  vs_text json = {0};
  (void)digits;
  vs_found_json(o, &json);
  fputs(json.text, out);
  vs_text_free(&json);
}

static vs_status write_file(const vs_fitting_options *options, const vs_outcome *o,
                            const char *name, csv_writer write, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, options->folder, name, err);
  if (status) return status;
  write(o, options->digits, file.stream);
  return vs_file_commit(&file, err);
}

/* An older fit's file that this one does not write. */
static void remove_stale(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  unlink(path);
}

/* Without gnuplot there is no picture, which is said, and all the rest. */
static vs_status write_pictures(const vs_fitting_options *options, const vs_outcome *o) {
  static const char *const NAMES[] = {"fit.png", "fit.svg"};
  vs_error err = {0};
  vs_status status = VS_OK;
  for (size_t k = 0; k < 2 && !status; k++) {
    remove_stale(options->folder, NAMES[k]);
    status = vs_portrait_draw(o, options->folder, NAMES[k], &err);
  }
  if (status && !options->quiet) fprintf(stderr, "vibrospice: warning: no picture: %s\n", err.text);
  return status;
}

static vs_status write_files(const vs_fitting_options *options, const vs_outcome *o,
                             vs_error *err) {
  vs_status status = write_file(options, o, "fit.json", write_json, err);
  if (!status) status = write_file(options, o, "residuals.csv", vs_found_residuals, err);
  if (!status && o->n_profiles)
    status = write_file(options, o, "profile.csv", vs_found_profiles, err);
  else if (!status)
    remove_stale(options->folder, "profile.csv");
  if (status) return status;
  bool drawn = !write_pictures(options, o);
  if (!options->quiet && !options->json)
    printf("written: fit.json, residuals.csv%s%s in %s\n", o->n_profiles ? ", profile.csv" : "",
           drawn ? ", fit.png, fit.svg" : "", options->folder);
  return VS_OK;
}

/* ---- the command ---- */

static void print_warning(void *ctx, const char *text) {
  (void)ctx;
  fprintf(stderr, "vibrospice: warning: %s\n", text);
}

static void say(const vs_fitting_options *options, const vs_outcome *o) {
  vs_text json = {0};
  if (options->json) {
    vs_found_json(o, &json);
    fputs(json.text, stdout);
    vs_text_free(&json);
  } else if (!options->quiet)
    vs_fitted_show(o, stdout);
  if (!options->quiet) vs_fitted_warnings(o, print_warning, NULL);
}

static vs_status fit(const vs_fitting_options *options, const vs_inquiry *q, vs_error *err) {
  int made = 0;
  vs_outcome *o = vs_alloc(1, sizeof *o);
  vs_status status = options->folder ? vs_file_folder_make(options->folder, &made, err) : VS_OK;
  bool folder = options->folder && !status;
  if (made) vs_leave_remove(options->folder); /* a signal leaves no empty folder */
  if (!status) status = vs_outcome_of(q, o, err);
  if (made) vs_leave_forget(options->folder);
  if (o->told) say(options, o);
  if (o->told && folder) {
    vs_error other = {0};
    vs_status written = write_files(options, o, &other);
    if (written) *err = other, status = written;
    folder = written;
  }
  if (status && folder) vs_file_folder_unmake(options->folder, made);
  if (!status) status = vs_fitted_judge(o, err);
  vs_outcome_free(o);
  free(o);
  return status;
}

vs_status vs_fitting_command(const vs_fitting_options *options, vs_error *err) {
  vs_inquiry *q = vs_alloc(1, sizeof *q);
  vs_status status =
      vs_inquiry_read(options->name, options->sets, options->n_sets, options->profile, q, err);
  for (size_t r = 0; r < q->n_runs && !status && !options->quiet; r++)
    vs_scene_warn(q->runs[r].scene);
  for (size_t r = 0; r < q->n_runs && !status; r++) {
    q->runs[r].scene->order.shows = !options->quiet && isatty(STDERR_FILENO);
    q->runs[r].scene->allow_code = options->allow_code;
    status = vs_control_allow(&q->runs[r].scene->control, options->allow_code, err);
  }
  if (!status) status = fit(options, q, err);
  vs_inquiry_free(q);
  free(q);
  return status;
}

/* ---- for check ---- */

/* It ends at the first mistake. */
vs_status vs_fitting_check(const vs_check_options *options, vs_text *good, vs_error *err) {
  vs_inquiry *q = vs_alloc(1, sizeof *q);
  vs_error first = {
      0}; /* without findings: what follows a mistake would be read from a half-made scene */
  vs_status status =
      vs_inquiry_read(options->name, options->sets, options->n_sets, NULL, q, &first);
  if (status) {
    first.findings = err->findings;
    *err = first;
  } else
    vs_text_add(good, "a good fit: %zu unknowns from %zu numbers and %zu priors, of %zu run%s",
                q->n_unknowns, q->n_data, q->n_priors, q->n_runs, q->n_runs > 1 ? "s" : "");
  vs_inquiry_free(q);
  free(q);
  return status;
}
