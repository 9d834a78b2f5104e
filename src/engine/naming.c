/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "naming.h"

#include <string.h>

#include "engine/channel.h"
#include "base/units.h"

/* True for the name of a channel that every machine has, and for the one that the measures of the
 * travel begin with: gap_min. */
static bool is_the_programs(const char *name) {
  return vs_channel_is_standard(name) || !strcmp(name, "gap");
}

vs_status vs_naming_machine(const vs_machine *m, vs_error *err) {
  vs_status s = VS_OK;
  for (int k = 0; k < m->dof && !s; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    const char *const names[] = {c->name, c->rate, c->rate2};
    for (int d = 0; d < 3 && !s; d++)
      if (is_the_programs(names[d]))
        s = vs_error_carry_on(err, vs_fail_at(err, c->where,
                                              "coordinate %s: the name %s is the program's",
                                              c->name, names[d]));
  }
  for (int k = 0; k < m->n_probes && !s; k++)
    if (vs_channel_is_standard(m->probes[k].name))
      s = vs_error_carry_on(err,
                            vs_fail_at(err, m->probes[k].where,
                                       "probe %s: that name is the program's", m->probes[k].name));
  return s;
}

/* A probe of the deck must not have the name of a channel that every tier has, nor that of the
 * time. */
static vs_status refuse_taken_names(const vs_model *model, const vs_deck *deck, vs_error *err) {
  vs_status s = VS_OK;
  for (size_t k = 0; k < deck->n_probes && !s; k++) {
    const vs_probe *probe = &deck->probes[k];
    bool machines = vs_machine_has_output(model->machine, probe->name);
    bool taken = machines || !strcmp(probe->name, "t") || !strcmp(probe->name, "gap") ||
                 vs_channel_is_standard(probe->name);
    if (taken)
      s = vs_error_carry_on(err, vs_fail_at(err, probe->where, "probe %s: that name is %s%s",
                                            probe->name,
                                            machines ? "taken by the machine " : "the program's",
                                            machines ? model->machine->path : ""));
  }
  return s;
}

/* True if the shorter name, its unit behind it, makes the longer name's column. */
static bool is_one_column(vs_channel a, vs_channel b) {
  char of_a[32], of_b[32];
  size_t n = strlen(a.name), m = strlen(b.name);
  if (n > m) return is_one_column(b, a);
  if (n == m || strncmp(a.name, b.name, n) != 0) return false; /* names are compared elsewhere */
  vs_units_suffix(a.unit, of_a, sizeof of_a);
  vs_units_suffix(b.unit, of_b, sizeof of_b);
  const char *rest = b.name + n, *want = of_a;
  if (*rest++ != '_' || strncmp(rest, want, m - n - 1) != 0) return false;
  want += m - n - 1;
  return !*of_b ? !*want : *want++ == '_' && !strcmp(want, of_b);
}

static vs_where channel_place(const vs_frame *frame, int number) {
  const vs_model *m = frame->model;
  if (number >= vs_channel_deck(m)) return frame->deck->probes[number - vs_channel_deck(m)].where;
  if (number >= vs_channel_probes(m))
    return m->machine->probes[number - vs_channel_probes(m)].where;
  return m->machine->coordinates[(number - VS_CH_Q) % m->dof].where;
}

/* A column is a name with its unit: x in m, and x_m without a unit, would be one. */
static vs_status refuse_one_column(const vs_model *model, const vs_deck *deck, vs_error *err) {
  const vs_frame frame = {.model = model, .deck = deck};
  vs_status s = VS_OK;
  for (int k = VS_CH_Q, n = vs_channel_count(&frame); k < n && !s; k++) {
    vs_channel c = vs_channel_at(&frame, k);
    int j = 0;
    while (j < k && !is_one_column(c, vs_channel_at(&frame, j))) j++;
    if (j < k)
      s = vs_error_carry_on(
          err, vs_fail_at(err, channel_place(&frame, k),
                          "%s: its column in a run's table is that of %s; give it another name",
                          c.name, vs_channel_at(&frame, j).name));
  }
  return s;
}

vs_status vs_naming_deck(const vs_model *model, const vs_deck *deck, vs_error *err) {
  size_t found = vs_error_count(err);
  vs_status s = refuse_taken_names(model, deck, err);
  return s || vs_error_count(err) > found ? s : refuse_one_column(model, deck, err);
}
