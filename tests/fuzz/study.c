/* SPDX-License-Identifier: GPL-3.0-or-later
 * Studies: the file, the scene of its first case, the points of some cases, the head of its
 * journal. */
#include <stdlib.h>

#include "study/manifest.h"
#include "study/methods.h"
#include "study/study_file.h"
#include "study/workers/row_shape.h"
#include "targets.h"

static const char *const FILES[] = {"scene.yaml", "points.csv", NULL};

static void use(const vs_plan *plan) {
  double point[VS_PLAN_AXES];
  char method[256];
  vs_journal_head head = {0};
  vs_plan_method(plan, method, sizeof method);
  for (uint64_t k = 0; k < 3 && !plan->adaptive; k++)
    if (k < plan->count) vs_plan_point(plan, k, point);
  if (!plan->adaptive && plan->count) vs_plan_point(plan, plan->count - 1, point);
  vs_manifest_head(plan, "study", &head);
  vs_row_shape_free(vs_row_shape_new(head.columns, head.failures, head.manifest_end));
  vs_journal_head_free(&head);
}

static vs_status read_once(const char *path, vs_findings *all) {
  vs_plan *plan = vs_alloc(1, sizeof *plan);
  vs_error err = {.findings = all};
  vs_status status = vs_study_file_read(path, vs_methods_all, NULL, 0, plan, &err);
  fuzz_judge(status, &err);
  if (!status && !vs_error_count(&err)) use(plan);
  vs_plan_free(plan);
  free(plan);
  return status;
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "study.yaml", FILES, path);
  fuzz_read(read_once, path, size);
}

const fuzz_target fuzz_study = {"study", take, &fuzz_grammar_yaml, NULL};
