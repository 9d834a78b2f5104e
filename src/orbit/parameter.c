/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/parameter.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "engine/gate.h"

enum { NEAR = VS_PARAMETER_NEAR, ALL = 1 + NEAR };

/* ---- the other scenes ---- */

/* The usual step. A difference of sixth order over it leaves out some 1e-18 of a smooth
 * coefficient, and rounding makes 1e-13 of it. */
static const double STEP = 1e-3;

/* Where the scenes lie, in steps, and the weights of differences to the scene as it is: of sixth
 * order, and of fourth, which uses the nearer four. */
typedef struct stencil {
  double at[NEAR], weight[NEAR], coarse[NEAR];
} stencil;
static const stencil STENCILS[] = {
    {{1, -1, 2, -2, 3, -3},
     {0.75, -0.75, -0.15, 0.15, 1.0 / 60, -1.0 / 60},
     {2.0 / 3, -2.0 / 3, -1.0 / 12, 1.0 / 12, 0, 0}},
    {{1, 2, 3, 4, 5, 6}, {6, -7.5, 20.0 / 3, -3.75, 1.2, -1.0 / 6}, {4, -3, 4.0 / 3, -0.25, 0, 0}},
    {{-1, -2, -3, -4, -5, -6},
     {-6, 7.5, -20.0 / 3, 3.75, -1.2, 1.0 / 6},
     {-4, 3, -4.0 / 3, 0.25, 0, 0}}};
enum { N_STENCILS = sizeof STENCILS / sizeof *STENCILS };

enum { TEXT = VS_KEY_SIZE + 96 };

/* The value as a scene reads it. */
static void print_value(const vs_parameter *p, double value, char text[TEXT]) {
  const char *unit = p->key.field->unit;
  snprintf(text, TEXT, "%.17g%s%s", value / vs_units_factor(unit), *unit ? " " : "", unit);
}

/* Fills `other`, which is zeroed. */
static vs_status read_with(const vs_parameter *p, double value, vs_scene *other, vs_error *err) {
  const vs_scene *s = p->scene[0];
  char number[TEXT], text[VS_KEY_SIZE + TEXT];
  print_value(p, value, number);
  snprintf(text, sizeof text, "%s=%s", p->key.name, number);
  memcpy(other->path, s->path, sizeof other->path);
  vs_tree_copy(&s->tree, &other->tree);
  other->allow_code = s->allow_code;
  other->held = s->held;
  other->of_period = s->of_period;
  vs_status status = vs_tree_set(&other->tree, text, err);
  return status ? status : vs_scene_read_sections(other, s->tier->name, err);
}

static void free_near(vs_parameter *p) {
  for (int k = 1; k < ALL; k++) {
    if (p->scene[k]) vs_scene_free(p->scene[k]);
    free(p->scene[k]);
    p->scene[k] = NULL;
  }
}

/* Is another cycle of the mains the first? Its number, from which firings are counted, jumps where
 * supply.phase passes 0. */
static bool does_cycle_jump(const vs_scene *scene, const vs_scene *other) {
  const vs_timeline *a = &scene->setup.timeline, *b = &other->setup.timeline;
  return fabs(a->first_zero_s / a->period_s - b->first_zero_s / b->period_s) > 0.5;
}

/* The key of the k-th scene. */
static double key_of_scene(const vs_parameter *p, int k) {
  return p->value != 0 ? p->value * (1 + p->at[k]) : p->size * p->at[k];
}

static vs_status read_near(vs_parameter *p, const stencil *where, vs_error *err) {
  vs_status status = VS_OK;
  for (int k = 1; k < ALL && !status; k++) {
    p->at[k] = p->step * where->at[k - 1];
    p->weight[k] = where->weight[k - 1] / p->step;
    p->coarse[k] = where->coarse[k - 1] / p->step;
    p->scene[k] = vs_alloc(1, sizeof **p->scene);
    status = read_with(p, key_of_scene(p, k), p->scene[k], err);
    if (!status && does_cycle_jump(p->scene[0], p->scene[k]))
      status = vs_fail(err, VS_INPUT, "the first cycle begins elsewhere");
  }
  if (status) free_near(p);
  return status;
}

static bool near(double a, double b) {
  return fabs(a - b) <= 1e-12 * fabs(b);
}

/* Do two setups have the same numbers, but for the rounding of how a key is written? */
static bool are_same_setups(const vs_setup *a, const vs_setup *b) {
  const vs_model *m = &a->model, *n = &b->model;
  const vs_timeline *t = &a->timeline, *u = &b->timeline;
  bool same = m->stops.count == n->stops.count && near(m->coil.gap_rest_m, n->coil.gap_rest_m) &&
              near(m->coil.rest_h, n->coil.rest_h) && near(t->peak_v, u->peak_v) &&
              near(m->coil.resistance_ohm, n->coil.resistance_ohm) &&
              near(t->period_s, u->period_s) && near(t->first_zero_s, u->first_zero_s) &&
              near(t->firing.angle.first, u->firing.angle.first);
  for (int k = 0; k < m->stops.count && same; k++) {
    const vs_stop *p = &m->stops.item[k], *q = &n->stops.item[k];
    same = p->kind == q->kind && p->side == q->side && near(p->at_m, q->at_m) &&
           near(p->stiffness, q->stiffness) && near(p->damping_ns_m, q->damping_ns_m);
  }
  for (int i = 0; i < m->dof && same; i++) {
    same = near(m->constant[i], n->constant[i]) && near(m->along[i], n->along[i]);
    for (int j = 0; j < m->dof && same; j++)
      same = near(m->mass[i][j], n->mass[i][j]) && near(m->damping[i][j], n->damping[i][j]) &&
             near(m->stiffness[i][j], n->stiffness[i][j]);
  }
  return same;
}

/* Writes the key into the scene with the value that it has, to see what the scene says to that. A
 * key that the tier ignores, or for which the scene has no use, is refused by its name, and enters
 * no equation. Error, at `where`: it makes another scene, as other keys' defaults hang on it. */
static vs_status try_key(vs_parameter *p, vs_where where, vs_error *err) {
  vs_scene *same = vs_alloc(1, sizeof *same);
  vs_error why = {0};
  vs_status status = read_with(p, p->value, same, &why);
  const char *text = why.text + why.place_size;
  p->idle = status == VS_INPUT && !strncmp(text, p->key.name, strlen(p->key.name));
  snprintf(p->why, sizeof p->why, "%.255s", p->idle ? text : "");
  bool other = !status && !are_same_setups(&same->setup, &p->scene[0]->setup);
  vs_scene_free(same);
  free(same);
  if (other)
    return vs_fail_at(err, where,
                      "%s: writing it into the scene, with the value that it has, changes others; "
                      "write these into the scene, too",
                      p->key.name);
  return status && !p->idle ? vs_fail_at(err, where, "%s", text) : VS_OK;
}

/* ---- its coefficients ---- */

double vs_parameter_slope(const vs_parameter *p, const double v[ALL]) {
  double sum = 0;
  for (int k = 1; k < ALL; k++) sum += p->weight[k] * (v[k] - v[0]);
  return sum;
}

/* Of a double of the model, which stands at this offset. */
static double model_slope(const vs_parameter *p, size_t offset) {
  double v[ALL];
  for (int k = 0; k < ALL; k++) memcpy(&v[k], (const char *)&p->setup[k].model + offset, sizeof *v);
  return vs_parameter_slope(p, v);
}

static void find_slopes(vs_parameter *p) {
  const vs_model *m = &p->setup->model;
  vs_parameter_slopes *s = &p->slopes;
  double clock[ALL];
  *s = (vs_parameter_slopes){0};
#define OF(member) model_slope(p, offsetof(vs_model, member))
#define OF_ONE(member, i) model_slope(p, offsetof(vs_model, member) + (size_t)(i) * sizeof(double))
  for (int i = 0; i < m->dof; i++) {
    for (int j = 0; j < m->dof; j++) {
      s->mk_column[j][i] = OF_ONE(mk_column, j * VS_MOST_DOF + i);
      s->mb_column[j][i] = OF_ONE(mb_column, j * VS_MOST_DOF + i);
    }
    s->mf[i] = OF_ONE(mf, i);
    s->m0[i] = OF_ONE(m0, i);
    s->along[i] = OF_ONE(along, i);
  }
  s->gap_rest_m = OF(coil.gap_rest_m);
  s->resistance_ohm = OF(coil.resistance_ohm);
  for (int n = 0; n < m->stops.count; n++) {
    size_t stop = offsetof(vs_model, stops.item) + (size_t)n * sizeof(vs_stop);
    s->at_m[n] = model_slope(p, stop + offsetof(vs_stop, at_m));
    s->stop_stiffness[n] = model_slope(p, stop + offsetof(vs_stop, stiffness));
    s->stop_damping[n] = model_slope(p, stop + offsetof(vs_stop, damping_ns_m));
  }
#undef OF
#undef OF_ONE
  for (int k = 0; k < ALL; k++)
    clock[k] = p->setup[k].timeline.period_s / p->setup->timeline.period_s;
  s->clock = vs_parameter_slope(p, clock);
}

void vs_parameter_take(vs_parameter *p, vs_setup (*make)(const vs_scene *scene, void *ctx),
                       void *ctx) {
  for (int k = 0; k < ALL; k++) p->setup[k] = make(p->scene[p->idle ? 0 : k], ctx);
  find_slopes(p);
}

/* ---- beginning ---- */

static vs_status refuse_key_of_parameter(const vs_parameter *p, vs_where where, vs_error *err) {
  const vs_field *f = p->key.field;
  if (f->kind == VS_COUNT)
    return vs_fail_at(err, where, "%s is a whole number, and has no derivative", p->key.name);
  if (f->kind == VS_OPTION)
    return vs_fail_at(err, where, "%s has keys of its own, such as %s.%s: name one of those",
                      p->key.name, p->key.name, f->inside->keys.fields[0].key);
  if (!vs_field_is_real(f))
    return vs_fail_at(err, where, "%s is %s; a key with one number is wanted", p->key.name,
                      f->kind == VS_PAIR ? "a pair [x, y]" : "a word");
  if (f->kind == VS_PROFILE && ((const vs_field_profile *)p->key.value)->count)
    return vs_fail_at(err, where, "%s is a table over time; a key with one number is wanted",
                      p->key.name);
  if (isnan(p->value))
    return vs_fail_at(err, where, "%s is no number in this scene; give it one to vary it",
                      p->key.name);
  return VS_OK;
}

vs_status vs_parameter_look(vs_parameter *p, const vs_scene *scene, const char *key, vs_where where,
                            vs_error *err) {
  *p = (vs_parameter){0};
  p->scene[0] = (vs_scene *)(size_t)scene; /* never written to */
  vs_status status = vs_key_find(scene, key, where, &p->key, err);
  if (status) return status;
  p->value = vs_key_number(&p->key);
  status = refuse_key_of_parameter(p, where, err);
  if (status) return status;
  p->size = p->value != 0 ? p->value : vs_units_factor(p->key.field->unit);
  return try_key(p, where, err);
}

vs_status vs_parameter_begin(vs_parameter *p, const vs_scene *scene, const char *key,
                             vs_where where, double step, const vs_parameter *known,
                             vs_error *err) {
  vs_error why = {0}, last = {0};
  vs_status status = VS_OK;
  if (known) {
    *p = (vs_parameter){.key = known->key,
                        .value = known->value,
                        .size = known->size,
                        .scene = {known->scene[0]},
                        .idle = known->idle};
    memcpy(p->why, known->why, sizeof p->why);
  } else
    status = vs_parameter_look(p, scene, key, where, err);
  if (status) return status;
  p->step = step > 0 ? step : STEP;
  status = p->idle ? VS_OK : VS_INPUT;
  for (int n = 0; n < N_STENCILS && status; n++) {
    last = (vs_error){0};
    status = read_near(p, &STENCILS[n], &last);
    if (!n) why = last;
  }
  if (status)
    return vs_fail_at(err, where, "%s has no room on either side of its value: %s", p->key.name,
                      why.text + why.place_size);
  p->setup = vs_alloc(ALL, sizeof *p->setup);
  return VS_OK;
}

vs_status vs_parameter_again(vs_parameter *p, vs_error *err) {
  char text[TEXT];
  vs_status status = vs_key_find(p->scene[0], p->key.name, (vs_where){0}, &p->key, err);
  double value = status ? NAN : vs_key_number(&p->key);
  if (status || p->idle) return status;
  if (isnan(value) || value == 0 || p->value == 0)
    return vs_fail(err, VS_INPUT, "%s: its scenes have to be made anew", p->key.name);
  p->value = p->size = value;
  for (int k = 1; k < ALL && !status; k++) {
    print_value(p, key_of_scene(p, k), text);
    vs_tree_put(&p->scene[k]->tree, p->key.name, text, (vs_where){0});
    status = vs_scene_reread(p->scene[k], err);
  }
  return status;
}

void vs_parameter_end(vs_parameter *p) {
  free_near(p);
  free(p->setup);
  p->setup = NULL;
}

void vs_parameter_start(const vs_parameter *p, const vs_tier *tier, double *y) {
  int states = 2 * p->setup->model.dof;
  double v[VS_MOST_STATES + 1][ALL];
  for (int k = 0; k < ALL; k++) {
    const vs_frame frame = vs_sim_frame(tier, &p->setup[k]);
    const vs_knot knot = vs_sim_start(&p->setup[k], &frame);
    for (int i = 0; i < states; i++) v[i][k] = knot.x[i];
    v[states][k] = knot.flux_wb;
  }
  for (int i = 0; i <= states; i++) y[i] = vs_parameter_slope(p, v[i]);
}

/* ---- the instants ---- */

/* How much longer the period of the k-th scene is. */
static double period_ratio(const vs_parameter *p, int k) {
  return p->setup[k].timeline.period_s / p->setup->timeline.period_s;
}

double vs_parameter_time(const vs_parameter *p, int k, double t_s) {
  return t_s * period_ratio(p, k);
}

/* Two scenes' instants that are further apart than this part of a period are not the same one. */
static const double APART = 0.05;

/* Where differences of two orders give slopes of the waves' first voltage that are further apart
 * than this part of the peak, an event of the mains lies before the instant in some of the scenes
 * and behind it in others. */
static const double UNLIKE = 1e-8;

static bool begin_alike(const vs_parameter *p) {
  double v[ALL], u[3], coarse = 0;
  for (int k = 0; k < ALL; k++) {
    vs_wave_at(&p->mains[k], 0, u);
    v[k] = u[0];
    coarse += p->coarse[k] * (v[k] - v[0]);
  }
  return fabs(vs_parameter_slope(p, v) - coarse) <= UNLIKE * p->setup->timeline.peak_v;
}

/* The waves begin at these instants, each in its own scene's time. Returns by how much p moves
 * them, in the scene's own time; NaN: they do not belong together. */
static double begin_waves(vs_parameter *p, const double at_s[ALL]) {
  double common_s[ALL], most = APART * p->setup->timeline.period_s;
  for (int k = 0; k < ALL; k++)
    if (!(fabs(at_s[k] / period_ratio(p, k) - at_s[0]) < most)) return NAN;
  for (int k = 0; k < ALL; k++) {
    p->origin_s[k] = at_s[k];
    vs_wave_of(&p->setup[k].timeline, at_s[k], &p->mains[k]);
    common_s[k] = at_s[k] / period_ratio(p, k);
  }
  return begin_alike(p) ? vs_parameter_slope(p, common_s) : NAN;
}

double vs_parameter_fires(vs_parameter *p, double off_s, double t_s) {
  double at_s[ALL];
  double until_s = t_s + p->setup->timeline.period_s;
  for (int k = 0; k < ALL; k++) {
    const vs_timeline *line = &p->setup[k].timeline;
    double since = off_s * period_ratio(p, k);
    at_s[k] = line->events.count ? vs_wave_conduction(line, since, until_s * period_ratio(p, k))
                                 : vs_gate_next_conduction(line, since);
  }
  return begin_waves(p, at_s);
}

double vs_parameter_edge(vs_parameter *p, double before_s, double t_s) {
  double at_s[ALL];
  for (int k = 0; k < ALL; k++)
    at_s[k] = k ? vs_wave_edge(&p->setup[k].timeline, before_s * period_ratio(p, k)) : t_s;
  return begin_waves(p, at_s);
}

void vs_parameter_connects(vs_parameter *p, double t_s) {
  double at_s[ALL];
  for (int k = 0; k < ALL; k++) at_s[k] = t_s * period_ratio(p, k);
  begin_waves(p, at_s);
}
