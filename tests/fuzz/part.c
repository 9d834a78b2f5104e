/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts: the file as `check` reads it and on the test stand, up to the netlist; and the same bytes
 * as a vendor's file in which a subcircuit is looked for. */
#include <stdio.h>
#include <string.h>

#include "cli/wrap.h"
#include "netlist/netlist.h"
#include "run/warnings.h"
#include "bench/stand.h"
#include "targets.h"

static const char *const FILES[] = {"a.inc", "b.lib", NULL};

static void check(const char *path) {
  static vs_deck of; /* too large to be made anew for each text, as the next are */
  static vs_findings all;
  vs_deck *part = &of;
  vs_error err = {.findings = &all};
  vs_warnings warnings = {0};
  memset(part, 0, sizeof *part);
  all.count = 0;
  vs_status status = vs_netlist_read_part(path, part, &err);
  fuzz_judge(status, &err);
  vs_warnings_of_netlist(part, &warnings);
  vs_warnings_of_limits(part, &warnings);
  vs_warnings_free(&warnings);
  vs_deck_free(part);
}

static void take(const char *text, size_t size) {
  static const char *const KINDS[] = {"thyristor", "diode", "varistor", "mosfet", "igbt"};
  char path[VS_PATH_SIZE], output[VS_PATH_SIZE];
  static vs_stand of;
  static vs_wrap of_wrap;
  vs_stand *stand = &of;
  vs_wrap *wrap = &of_wrap;
  vs_error err = {0};
  fuzz_write_all(text, size, "dut.inc", FILES, path);
  check(path);
  memset(stand, 0, sizeof *stand);
  fuzz_judge(vs_stand_open(path, stand, &err), &err);
  vs_stand_close(stand);
  err = (vs_error){0};
  snprintf(output, sizeof output, "%.4000s/part.inc", fuzz_folder());
  vs_status status = vs_wrap_find(path, KINDS[size % 5], NULL, output, wrap, &err);
  if (status) fuzz_judge(status, &err);
}

const fuzz_target fuzz_part = {"part", take, &fuzz_grammar_part, NULL};
