/* SPDX-License-Identifier: GPL-3.0-or-later
 * The manifest of a study, with rows that are well unless the text has others. */
#include "tables.h"
#include "targets.h"

static void take(const char *text, size_t size) {
  fuzz_tables_take("manifest.json", text, size);
}

const fuzz_target fuzz_manifest = {"manifest", take, NULL, NULL};
