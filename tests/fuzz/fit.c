/* SPDX-License-Identifier: GPL-3.0-or-later
 * Fits, with the recording that they name. */
#include <string.h>

#include "fit/fit_problem.h"
#include "targets.h"

static const char *const FILES[] = {"data.csv", "scene.yaml", NULL};

static vs_status read_once(const char *path, vs_findings *all) {
  static vs_fit_problem of; /* too large to be made anew for each text */
  vs_fit_problem *inquiry = &of;
  vs_error err = {.findings = all};
  memset(inquiry, 0, sizeof *inquiry);
  vs_status status = vs_fit_problem_read(path, NULL, 0, NULL, inquiry, &err);
  fuzz_judge(status, &err);
  vs_fit_problem_free(inquiry);
  return status;
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "fit.yaml", FILES, path);
  fuzz_read(read_once, path, size);
}

const fuzz_target fuzz_fit = {"fit", take, &fuzz_grammar_yaml, NULL};
