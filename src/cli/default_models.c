/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "default_models.h"

#include <stdlib.h>

#include "netlist/netlist.h"
#include "plant/machine_file.h"

vs_status vs_default_models_read(const char *deck, const char *machine, vs_default_models *g,
                                 vs_error *err) {
  const vs_where nowhere = {0};
  char path[VS_PATH_SIZE];
  *g = (vs_default_models){vs_alloc(1, sizeof *g->deck), vs_alloc(1, sizeof *g->machine)};
  vs_machine_begin(g->machine);
  vs_status status =
      vs_path_find(&vs_deck_shelf, deck ? deck : vs_deck_key.default_text, nowhere, path, err);
  if (!status) status = vs_netlist_read(path, g->deck, err);
  if (!status) status = vs_netlist_read_parts(g->deck, NULL, err);
  if (!status)
    status = vs_path_find(&vs_machine_shelf, machine ? machine : vs_machine_key.default_text,
                          nowhere, path, err);
  return status ? status : vs_machine_file_read(path, g->machine, err);
}

void vs_default_models_free(vs_default_models *g) {
  vs_deck_free(g->deck);
  vs_machine_free(g->machine);
  free(g->deck);
  free(g->machine);
}
