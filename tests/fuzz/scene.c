/* SPDX-License-Identifier: GPL-3.0-or-later
 * Scenes, as `run` reads them, which ends at the first mistake, and as `check` does, which goes on.
 * A first line "#--set KEY=VALUE" is a --set over the scene. */
#include "run/scene.h"

#include <stdlib.h>
#include <string.h>

#include "targets.h"

static const char *const FILES[] = {"table.csv", "machine.yaml", "deck.cir", NULL};

static char *set; /* of the text; NULL: none */

static vs_status read_once(const char *path, vs_findings *all) {
  static vs_scene of; /* too large to be made anew for each text */
  vs_scene *scene = &of;
  vs_error err = {.findings = all};
  memset(scene, 0, sizeof *scene);
  vs_status status = vs_scene_read(path, &set, set ? 1 : 0, NULL, scene, &err);
  fuzz_judge(status, &err);
  if (!status && scene->control.regulator) vs_scene_disable_control(scene);
  vs_scene_free(scene);
  return status;
}

static void take(const char *text, size_t size) {
  static const char SET[] = "#--set ";
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "scene.yaml", FILES, path);
  if (!strncmp(text, SET, sizeof SET - 1)) {
    text += sizeof SET - 1;
    set = strndup(text, strcspn(text, "\n"));
  }
  fuzz_read(read_once, path, size);
  free(set);
  set = NULL;
}

const fuzz_target fuzz_scene = {"scene", take, &fuzz_grammar_yaml, NULL};
