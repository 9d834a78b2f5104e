/* SPDX-License-Identifier: GPL-3.0-or-later
 * Machines: the file, and the matrices that its defaults make. */
#include "plant/machine.h"

#include <stdlib.h>
#include <string.h>

#include "plant/build.h"
#include "plant/machine_file.h"
#include "targets.h"

static const char *const FILES[] = {"table.csv", NULL};

static void build(vs_machine *machine, vs_findings *all) {
  const vs_node scene = {.kind = VS_NODE_MAP};
  vs_model *model = vs_alloc(1, sizeof *model);
  vs_error err = {.findings = all};
  fuzz_judge(vs_build_model(&scene, machine, model, &err), &err);
  vs_actuator_end(&model->coil);
  free(model);
}

static vs_status read_once(const char *path, vs_findings *all) {
  static vs_machine of; /* too large to be made anew for each text */
  vs_machine *machine = &of;
  vs_error err = {.findings = all};
  memset(machine, 0, sizeof *machine);
  vs_machine_begin(machine);
  vs_status status = vs_machine_file_read(path, machine, &err);
  fuzz_judge(status, &err);
  if (!status && !machine->lost) build(machine, all);
  vs_machine_free(machine);
  return status;
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "machine.yaml", FILES, path);
  fuzz_read(read_once, path, size);
}

const fuzz_target fuzz_machine = {"machine", take, &fuzz_grammar_yaml, NULL};
