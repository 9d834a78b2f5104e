/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/machine.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

const vs_shelf vs_machine_shelf = {"machine", "machines", ".yaml"};

const vs_field vs_machine_key = {
    .key = "model",
    .kind = VS_NAME,
    .unit = "",
    .default_text = "conveyor",
    .offset = offsetof(vs_machine_values, model),
    .text = "machine: a file, or the name of one that comes with the program"};

const char *const vs_machine_sum_words[] = {[VS_MACHINE_MASS] = "mass",
                                            [VS_MACHINE_DAMPING] = "damping",
                                            [VS_MACHINE_STIFFNESS] = "stiffness",
                                            [VS_MACHINE_FORCES] = "forces"};
const char *const vs_machine_law_words[] = {
    [VS_MACHINE_CURRENT] = "current", [VS_MACHINE_ENERGY] = "energy", [VS_MACHINE_FORCE] = "force"};

bool vs_machine_has_output(const vs_machine *machine, const char *name) {
  for (int k = 0; k < machine->dof; k++) {
    const vs_coordinate *c = &machine->coordinates[k];
    if (!strcmp(name, c->name) || !strcmp(name, c->rate) || !strcmp(name, c->rate2)) return true;
  }
  for (int k = 0; k < machine->n_probes; k++)
    if (!strcmp(name, machine->probes[k].name)) return true;
  return false;
}

/* A machine owns its fields; its sections show them as constant. */
static vs_field *own_fields(const vs_section *section) {
  return (vs_field *)(size_t)section->fields;
}

void vs_machine_add_field(vs_section *section, const vs_field *field) {
  vs_field *fields = vs_alloc_grow(own_fields(section), section->count, sizeof *fields);
  section->fields = fields;
  vs_field *own = &fields[section->count++];
  *own = *field;
  own->key = vs_copy(field->key);
  own->unit = vs_copy(field->unit);
  own->default_text = vs_copy(field->default_text);
  own->text = vs_copy(field->text);
  own->choices = field->choices ? vs_copy(field->choices) : NULL;
}

void vs_machine_begin(vs_machine *machine) {
  machine->section.name = "machine";
  machine->actuator.name = "actuator";
  machine->supply.name = "supply";
  machine->firing.name = "firing";
  machine->start.name = "start";
  machine->load.adds = -1;
  vs_machine_add_field(&machine->section, &vs_machine_key);
}

static void free_section(vs_section *section) {
  for (size_t k = 0; k < section->count; k++) {
    const vs_field *f = &section->fields[k];
    free((char *)(size_t)f->key);
    free((char *)(size_t)f->unit);
    free((char *)(size_t)f->default_text);
    free((char *)(size_t)f->text);
    free((char *)(size_t)f->choices);
  }
  free(own_fields(section));
}

static void free_expressions(vs_expression *e, int count) {
  for (int k = 0; k < count; k++) vs_formula_free(&e[k].of);
}

static void free_plane(vs_machine *m) {
  for (int k = 0; k < m->n_bodies; k++) {
    vs_body *b = &m->bodies[k];
    free_expressions(&b->mass, 1);
    free_expressions(&b->inertia, 1);
    free_expressions(b->at, 2);
    free_expressions(b->moves, 3);
  }
  for (int k = 0; k < m->n_springs; k++) {
    vs_spring *s = &m->springs[k];
    free_expressions(s->point[0], 2);
    free_expressions(s->point[1], 2);
    free_expressions(s->along, 2);
    free_expressions(s->stiffness, 2);
    free_expressions(s->damping, 2);
  }
}

void vs_machine_free(vs_machine *m) {
  free_section(&m->section);
  free_section(&m->actuator);
  free_section(&m->supply);
  free_section(&m->firing);
  free_section(&m->start);
  free_plane(m);
  for (int k = 0; k < VS_MACHINE_LETS; k++) vs_formula_free(&m->lets[k].of);
  for (int k = 0; k < VS_MACHINE_LAWS; k++) vs_formula_free(&m->law[k].of);
  for (int k = 0; k < m->n_probes; k++) vs_formula_free(&m->probes[k].of);
  for (int k = 0; k < VS_MACHINE_WAYS; k++) vs_formula_free(&m->load.way[k].of);
  for (int i = 0; i < m->dof; i++) {
    vs_formula_free(&m->forces[i].of);
    vs_formula_free(&m->along[i].of);
    for (int j = 0; j < m->dof; j++)
      for (int s = 0; s < VS_MACHINE_FORCES; s++) vs_formula_free(&m->sums[s][i][j].of);
  }
  vs_tree_free(&m->tree);
}
