/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/build.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <math.h>
#include <string.h>

#include "assemble.h"
#include "base/memo.h"
#include "plant/mechanics.h"

/* M^-1 B, M^-1 K, -M^-1 c and M^-1 f0 by Cholesky, which works, as M is positive definite. */
static void solve_mass(vs_model *model) {
  double m[VS_MOST_DOF * VS_MOST_DOF], column[VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) m[i * model->dof + j] = model->mass[i][j];
  gsl_matrix_view mv = gsl_matrix_view_array(m, n, n);
  gsl_vector_view cv = gsl_vector_view_array(column, n);
  gsl_linalg_cholesky_decomp1(&mv.matrix);
  for (int j = 0; j < 2 * model->dof + 2; j++) {
    int of_k = j - model->dof, other = j - 2 * model->dof;
    double *into = other == 1   ? model->m0
                   : other == 0 ? model->mf
                   : of_k >= 0  ? model->mk_column[of_k]
                                : model->mb_column[j];
    for (int i = 0; i < model->dof; i++)
      column[i] = other == 1   ? model->constant[i]
                  : other == 0 ? -model->along[i]
                  : of_k >= 0  ? model->stiffness[i][of_k]
                               : model->damping[i][j];
    gsl_linalg_cholesky_svx(&mv.matrix, &cv.vector);
    memcpy(into, column, n * sizeof *column);
  }
}

/* c.K^-1 c; INFINITY where a coordinate has no spring, and K no inverse. */
static double compliance(const vs_model *model) {
  double k[VS_MOST_DOF * VS_MOST_DOF], x[VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  memcpy(x, model->along, sizeof x);
  for (int i = 0; i < model->dof; i++)
    if (model->stiffness[i][i] == 0) return INFINITY;
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) k[i * model->dof + j] = model->stiffness[i][j];
  gsl_matrix_view kv = gsl_matrix_view_array(k, n, n);
  gsl_vector_view xv = gsl_vector_view_array(x, n);
  gsl_linalg_cholesky_decomp1(&kv.matrix);
  gsl_linalg_cholesky_svx(&kv.matrix, &xv.vector);
  return vs_mechanics_travel(model, x);
}

/* Of the fastest mode's |s|: a mode that grows more slowly has no damping but for rounding. */
static const double GROWS = 1e-9;

/* What follows from the modes, for step lengths and warnings. */
static vs_status find_speeds(vs_model *model, vs_error *err) {
  vs_mode *modes = model->mode;
  if (!vs_mechanics_modes(model, modes))
    return vs_fail_at(
        err, (vs_where){model->machine->path, 1, 1},
        "the eigenvalues of the mechanics cannot be found; masses or springs are too unlike");
  double drive = 0;
  model->fastest_rad_s = model->working_rad_s = model->growth_1_s = 0;
  for (int m = 0; m < 2 * model->dof; m++) {
    double size = hypot(modes[m].re_1_s, modes[m].im_rad_s);
    if (size > model->fastest_rad_s) model->fastest_rad_s = size;
    if (modes[m].drive > drive) {
      drive = modes[m].drive;
      model->working_rad_s = size;
    }
  }
  for (int m = 0; m < 2 * model->dof; m++)
    if (modes[m].re_1_s > GROWS * model->fastest_rad_s)
      model->growth_1_s = fmax(model->growth_1_s, modes[m].re_1_s);
  model->contact_rad_s = model->fastest_rad_s;
  for (int k = 0; k < model->stops.count; k++) {
    const vs_stop *stop = &model->stops.item[k];
    double per_newton = fabs(model->per_newton_m_s2);
    double rad_s = model->fastest_rad_s + sqrt(stop->kind->steepest(stop) * per_newton) +
                   stop->damping_ns_m * per_newton;
    model->contact_rad_s = fmax(model->contact_rad_s, rad_s);
  }
  return VS_OK;
}

/* What follows from the matrices. */
static vs_status derive_from_matrices(vs_model *model, vs_error *err) {
  solve_mass(model);
  model->compliance_m_n = compliance(model);
  model->per_newton_m_s2 = 0;
  for (int i = 0; i < model->dof; i++) model->per_newton_m_s2 += model->along[i] * model->mf[i];
  return find_speeds(model, err);
}

/* ---- the section actuator ---- */

/* Nodes of the scene's section actuator over those of the machine's. */
typedef struct merged {
  vs_node node[96];
  size_t count;
} merged;

static vs_node *add_node(merged *all, const vs_node *from) {
  if (all->count >= sizeof all->node / sizeof *all->node) return NULL;
  vs_node *node = &all->node[all->count++];
  *node = *from;
  node->next = NULL;
  return node;
}

/* The map `over` with the keys of `under` that it lacks, down to the last map. What has no room is
 * left out. */
static vs_node *merge_maps(merged *all, const vs_node *under, const vs_node *over) {
  vs_node *map = add_node(all, over);
  if (!map) return NULL;
  vs_node **tail = &map->child;
  *tail = NULL;
  for (const vs_node *n = over->child; n; n = n->next) {
    const vs_node *low = vs_tree_child(under, n->key);
    bool maps = low && low->kind == VS_NODE_MAP && n->kind == VS_NODE_MAP;
    *tail = maps ? merge_maps(all, low, n) : add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  for (const vs_node *n = under->child; n; n = n->next) {
    if (vs_tree_child(over, n->key)) continue;
    *tail = add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  return map;
}

/* The machine's map without the formulas of its law, which are no keys of the scene. */
static const vs_node *without_law(merged *all, const vs_node *own) {
  if (!own) return NULL;
  vs_node *map = add_node(all, own), **tail = &map->child;
  *tail = NULL;
  for (const vs_node *n = own->child; n; n = n->next) {
    bool law = false;
    for (int k = 0; k < VS_MACHINE_LAWS; k++) law = law || !strcmp(n->key, vs_machine_law_words[k]);
    if (!law) *tail = add_node(all, n);
    if (*tail) tail = &(*tail)->next;
  }
  return map;
}

/* True where the scene takes another law than the machine's own: the machine's keys, which may be
 * of its law alone, then say nothing. */
static bool names_other_law(const vs_node *scene, const vs_node *own) {
  const vs_node *law = vs_tree_child(vs_tree_child(scene, "actuator"), "law"),
                *standard = vs_tree_child(own, "law");
  if (!law || law->kind != VS_NODE_TEXT) return false;
  return !standard || standard->kind != VS_NODE_TEXT || strcmp(law->text, standard->text) != 0;
}

static vs_status build_actuator(const vs_node *map, vs_model *model, vs_error *err) {
  const vs_expression *law = model->machine->law;
  const vs_formula *of[VS_MACHINE_LAWS];
  vs_law_formulas formulas = {0};
  for (int k = 0; k < VS_MACHINE_LAWS; k++) {
    of[k] = law[k].text ? &law[k].of : NULL;
    formulas.where[k] = law[k].where;
  }
  formulas.current = of[VS_MACHINE_CURRENT];
  formulas.energy = of[VS_MACHINE_ENERGY];
  formulas.force = of[VS_MACHINE_FORCE];
  return vs_actuator_build(&model->actuator, map, &formulas, &model->coil, &model->stops, err);
}

/* ---- the sections ---- */

/* Error: the scene has a load, and the machine has no place for it. */
static vs_status check_load(const vs_machine *machine, const vs_node *load, vs_error *err) {
  if (machine->load.adds >= 0 || !load || !load->child) return VS_OK;
  return vs_fail_at(err, load->child->key_where,
                    "load.%s: machine %s has no load (its file has no key load); leave it out",
                    load->child->key, machine->path);
}

/* Error: load.fraction is auto, and the machine does not say which of its motions throws. */
static vs_status check_auto(const vs_machine *machine, const vs_load_values *load,
                            const vs_node *scene, vs_error *err) {
  const vs_node *node = vs_tree_child(vs_tree_child(scene, "load"), "fraction");
  if (machine->load.adds < 0 || !isnan(load->fraction) || !node ||
      machine->load.way[VS_MACHINE_ALONG].text)
    return VS_OK;
  return vs_fail_at(err, node->where,
                    "load.fraction: auto wants to know which motion throws, and machine %s does "
                    "not say (its file has no load.along); write a number",
                    machine->path);
}

/* Reads the sections of the scene; actuator is the scene's over the machine's. */
static vs_status read_sections(const vs_node *scene, const vs_node *actuator, vs_model *model,
                               vs_error *err) {
  const vs_machine *machine = model->machine;
  const vs_node *load = vs_tree_child(scene, "load");
  const vs_section *section = &machine->section;
  vs_status s = vs_error_carry_on(err, check_load(machine, load, err));
  if (!s)
    s = vs_field_section_read(section, vs_tree_child(scene, section->name), &model->parameters,
                              err);
  if (!s) s = vs_field_section_read(&machine->actuator, actuator, &model->actuator, err);
  return s ? s : vs_field_section_read(&vs_model_load_section, load, &model->load, err);
}

vs_status vs_build_model(const vs_node *scene, vs_machine *machine, vs_model *model,
                         vs_error *err) {
  *model = (vs_model){.machine = machine, .dof = machine->dof};
  size_t found = vs_error_count(err);
  if (machine->lost) return VS_OK; /* a check carries on; what else it would find may be an echo */
  merged all = {.count = 0};
  const vs_node *map = vs_tree_child(scene, "actuator"),
                *own = without_law(&all, machine->own_actuator);
  bool both = own && map && map->kind == VS_NODE_MAP;
  if (both)
    map = merge_maps(&all, own, map);
  else if (own && (!map || (map->kind == VS_NODE_TEXT && !*map->text)))
    map = own;
  vs_status s = read_sections(scene, map, model, err);
  if (!s) s = vs_error_carry_on(err, check_auto(machine, &model->load, scene, err));
  if (s || vs_error_count(err) > found) return s;
  model->riding = isnan(model->load.fraction) ? vs_model_load_range.least : model->load.fraction;
  s = vs_assemble_model(machine, model, err);
  if (!s && vs_error_count(err) == found)
    s = build_actuator(names_other_law(scene, own) ? vs_tree_child(scene, "actuator") : map, model,
                       err);
  if (s || vs_error_count(err) > found) return s;
  const vs_stop *first = model->stops.item;
  model->plain =
      model->coil.square &&
      (!model->stops.count || (model->stops.count == 1 && first->kind->linear && first->side > 0));
  return derive_from_matrices(model, err);
}

vs_status vs_build_again(const vs_node *scene, vs_machine *machine, vs_model *model,
                         vs_text *written, vs_error *err) {
  const char *const sections[] = {machine->section.name, "actuator", "load"};
  vs_text now = {0};
  for (size_t k = 0; k < sizeof sections / sizeof *sections; k++)
    vs_memo_write(vs_tree_child(scene, sections[k]), &now);
  bool same = written->length == now.length && !memcmp(written->text, now.text, now.length);
  vs_text_free(written);
  if (same && model->machine == machine && !isnan(model->load.fraction)) {
    *written = now;
    return VS_OK;
  }
  vs_actuator_end(&model->coil);
  size_t found = vs_error_count(err);
  vs_status s = vs_build_model(scene, machine, model, err);
  if (s || vs_error_count(err) > found)
    vs_text_free(&now);
  else
    *written = now;
  return s;
}

vs_status vs_build_loaded(vs_machine *machine, const vs_model *from, const vs_load_values *load,
                          double riding, vs_model *out, vs_error *err) {
  if (out != from) *out = *from;
  out->load = *load;
  out->riding = riding;
  vs_status s = vs_assemble_model(machine, out, err);
  return s ? s : derive_from_matrices(out, err);
}
