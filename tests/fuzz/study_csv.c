/* SPDX-License-Identifier: GPL-3.0-or-later
 * The rows of a study, with a manifest that is well. */
#include "tables.h"
#include "targets.h"

static void take(const char *text, size_t size) {
  fuzz_tables_take("study.csv", text, size);
}

const fuzz_target fuzz_study_csv = {"study_csv", take, NULL, NULL};
