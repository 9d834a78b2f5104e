/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "read_study.h"

#include <stdlib.h>

study *read_study(const char *text) {
  study *s = vs_alloc(1, sizeof *s);
  write_file("study.yaml", text);
  s->status = vs_study_file_read("study.yaml", vs_methods_all, NULL, 0, &s->plan, &s->err);
  return s;
}

study *good_study(const char *text) {
  study *s = read_study(text);
  EXPECT(!s->status, "%s", s->err.text);
  CU_ASSERT_FATAL(!s->status);
  return s;
}

void drop_study(study *s) {
  vs_plan_free(&s->plan);
  free(s);
}
