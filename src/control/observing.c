/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/observing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "place.h"
#include "engine/channel.h"

#define AT(member) offsetof(vs_observing_values, member)
static const vs_field KEYS[] = {
    {"kind", VS_CHOICE, "", "kalman", .offset = AT(kind),
     .text = "how its gain is found: from noise (kalman), or from poles (luenberger)",
     .choices = VS_GAIN_WORDS},
    {"current", VS_NAME, "", "auto", .offset = AT(current),
     .text = "the instrument that measures the coil's current; auto: the first on channel i"},
    {"force_noise", VS_REAL, "N", "1 N", 0, 1e9, true, AT(gain.force_noise_n),
     .text = "kalman: by how much the computed force is wrong, rms in each period"},
    {"spread", VS_REAL, "", "0.1", 0, 1e6, .offset = AT(gain.spread),
     .text =
         "kalman: what unknown forces do to each coordinate, as a part of what force_noise does "
         "to the gap"},
    {"start", VS_CHOICE, "", "rest", .offset = AT(knows_start),
     .text = "where the estimate begins: at rest, or where the run does", .choices = "rest|run"}};
#undef AT
enum { N_KEYS = sizeof KEYS / sizeof *KEYS };
const vs_section vs_observing_section = {"control.observer", KEYS, N_KEYS};

static const vs_outline NAME = {.takes = VS_OUTLINE_TEXT},
                        POLE = {
                            .takes = VS_OUTLINE_TEXT | VS_OUTLINE_LIST, .of = &NAME, .count = 2};
const vs_outline vs_observing_keys[] = {
    {"sensors", .takes = VS_OUTLINE_TEXT | VS_OUTLINE_LIST, .of = &NAME},
    {"poles", .takes = VS_OUTLINE_LIST, .of = &POLE},
    {.section = &vs_observing_section}};

/* What reading has at hand. */
typedef struct reading {
  const vs_node *map;
  const vs_model *model;
  const vs_instruments *instruments;
  double rate_hz;
  vs_observing *o;
  vs_error *err;
} reading;

/* Where a value stands; of a list, and of the observer where it has no such key, where the key
 * does. */
static vs_where place_of(const reading *r, const char *key) {
  const vs_node *node = vs_tree_child(r->map, key);
  if (!node) return r->map->key_where;
  return node->kind == VS_NODE_TEXT ? node->where : node->key_where;
}

/* ---- instruments ---- */

static const vs_instrument *find(const reading *r, const char *name) {
  for (int k = 0; k < r->instruments->count; k++)
    if (!strcmp(r->instruments->item[k].name, name)) return &r->instruments->item[k];
  return NULL;
}

static vs_status unknown(const reading *r, const char *key, const char *name, vs_where where) {
  const char *names[VS_INSTRUMENT_MOST];
  for (int k = 0; k < r->instruments->count; k++) names[k] = r->instruments->item[k].name;
  const char *nearest = vs_text_nearest(name, names, (size_t)r->instruments->count);
  return vs_fail_at(r->err, where, "control.observer.%s: no instrument '%s'%s%s%s", key, name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "; the scene's section instruments has them");
}

static vs_status find_current(const reading *r) {
  vs_observing *o = r->o;
  bool any = !strcmp(o->v.current, KEYS[1].default_text);
  for (int k = 0; k < r->instruments->count && any && !o->current; k++)
    if (r->instruments->item[k].channel == VS_CH_I) o->current = &r->instruments->item[k];
  if (!any) o->current = find(r, o->v.current);
  if (!any && !o->current) return unknown(r, "current", o->v.current, place_of(r, "current"));
  if (o->current && o->current->channel == VS_CH_I) return VS_OK;
  return vs_fail_at(r->err, place_of(r, "current"),
                    "control.observer: no instrument measures the coil's current, from which the "
                    "force follows; one on channel i is wanted, as instruments: {i: {range: [-5 A, "
                    "5 A]}}");
}

/* The sensors that are found. */
typedef struct found {
  const vs_instrument *item[VS_SENSOR_MOST];
  int count;
} found;

static vs_status add_named(const reading *r, const vs_node *node, found *f) {
  const char *name = node->kind == VS_NODE_TEXT ? node->text : "";
  const vs_instrument *i = find(r, name);
  if (!i) return unknown(r, "sensors", name, node->where);
  for (int k = 0; k < f->count; k++)
    if (f->item[k] == i)
      return vs_fail_at(r->err, node->where,
                        "control.observer.sensors: %s stands twice; once is enough", name);
  if (f->count == VS_SENSOR_MOST)
    return vs_fail_at(r->err, node->where, "control.observer.sensors: at most %d are allowed",
                      VS_SENSOR_MOST);
  if (!vs_sampled_takes(r->model, i))
    return vs_fail_at(r->err, node->where,
                      "control.observer.sensors: %s does not show the motion alone; wanted is an "
                      "instrument of a coordinate, of its rate or acceleration, or of z",
                      name);
  f->item[f->count++] = i;
  return VS_OK;
}

/* Finds the sensors of the list; without one all that can be, as far as there is room. */
static vs_status find_sensors(const reading *r, found *f) {
  const vs_node *list = vs_tree_child(r->map, "sensors");
  vs_status s = VS_OK;
  f->count = 0;
  for (int k = 0; k < r->instruments->count && !list && f->count < VS_SENSOR_MOST; k++)
    if (vs_sampled_takes(r->model, &r->instruments->item[k]))
      f->item[f->count++] = &r->instruments->item[k];
  if (list && list->kind == VS_NODE_TEXT) s = add_named(r, list, f);
  for (const vs_node *n = list ? list->child : NULL; n && !s; n = n->next) s = add_named(r, n, f);
  if (s || f->count) return s;
  return vs_fail_at(r->err, place_of(r, "sensors"),
                    "control.observer.sensors: no instrument shows the motion; wanted is one of a "
                    "coordinate, of its rate or acceleration, or of z");
}

/* ---- what the sensors see ---- */

/* A mode with a share of less than this in what the sensors see is not seen. Rounding leaves
 * 1e-16 to 1e-13 of a mode that has no share. */
static const double UNSEEN = 1e-10;

/* Error: a mode is not seen; sensors depend on each other. */
static vs_status check_sight(const reading *r, const vs_scaled *s) {
  const vs_sampled *p = r->o->system;
  vs_mode modes[VS_MOST_STATES];
  char text[256] = "";
  size_t length = 0;
  int unseen = 0;
  if (vs_place_independence(s->cat) < UNSEEN)
    return vs_fail_at(r->err, place_of(r, "sensors"),
                      "control.observer.sensors: one of them shows nothing that the others do not; "
                      "leave it out");
  if (!vs_mechanics_modes(r->model, modes))
    return vs_fail(r->err, VS_RUN, "control.observer: the machine's modes cannot be found");
  for (int k = 0; k < 2 * p->dof; k++) {
    const vs_pole pole = {modes[k].re_1_s, modes[k].im_rad_s};
    if (pole.im_rad_s < 0 || vs_place_reach(s->at, s->cat, vs_sampled_difference(p, pole)) > UNSEEN)
      continue;
    if (length < sizeof text - 32)
      length += (size_t)snprintf(text + length, sizeof text - length, "%s%.4g Hz",
                                 unseen ? ", " : "", modes[k].frequency_hz);
    unseen++;
  }
  if (!unseen) return VS_OK;
  return vs_fail_at(r->err, place_of(r, "sensors"),
                    "control.observer.sensors: they do not see the mode%s at %s, so that nothing "
                    "corrects %s; add an instrument of a coordinate that moves there",
                    unseen > 1 ? "s" : "", text, unseen > 1 ? "them" : "it");
}

/* ---- what is to be said of it ---- */

/* The first of its instruments whose samples do not fall on those of the control; NULL: all do. */
static const vs_instrument *out_of_step(const vs_observing *o) {
  const vs_sampled *p = o->system;
  for (int k = -1; k < p->sensors; k++) {
    const vs_instrument *i = k < 0 ? o->current : p->sensor[k].instrument;
    double ratio = i->v.rate_hz * p->period_s;
    if (fabs(ratio - round(ratio)) > 1e-9 * ratio) return i;
  }
  return NULL;
}

/* By how much the low-pass of the current's instrument makes slow signals late, s. */
static double delay_s(const vs_instrument *i) {
  vs_lowpass l = vs_lowpass_make(i->v.bandwidth_hz, i->v.order, i->v.damping);
  if (!(l.rate > 0)) return 0;
  return (l.works_on ? 2 * l.damping : 1) / l.rate;
}

/* A current that comes later than this part of the period is told of. */
static const double LATE = 0.1;

const char *vs_observing_note(const vs_observing *o, const vs_setup *setup, char *text,
                              size_t size) {
  const vs_instrument *unsynchronised = out_of_step(o);
  const double period_s = o->system->period_s, late_s = delay_s(o->current);
  char old[160] = "", late[160] = "";
  if (unsynchronised)
    snprintf(old, sizeof old,
             "; samples of %s are up to %.3g ms old when they are read, as its rate is no multiple "
             "of control.rate = %g Hz",
             unsynchronised->name, 1e3 / unsynchronised->v.rate_hz, 1 / period_s);
  if (late_s > LATE * period_s)
    snprintf(late, sizeof late, "; the low-pass of %s makes the current late by %.3g ms",
             o->current->name, 1e3 * late_s);
  int n = snprintf(text, size, "control.observer does not know all of this run%s%s%s%s%s", old,
                   late, setup->model.stops.count ? "; it computes a machine without a stop" : "",
                   setup->model.reloaded ? "; it computes the machine with its first load" : "",
                   vs_setup_jams(setup) < setup->run.until_s ? "; it is not told of the jam" : "");
  return strchr(text, ';') && n > 0 ? text : NULL;
}

/* ---- all ---- */

/* Names the estimates. Error: the machine has an output of such a name. */
static vs_status name_estimates(const reading *r) {
  vs_observing *o = r->o;
  const vs_machine *m = r->model->machine;
  for (int k = 0; k < 2 * m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k % m->dof];
    vs_estimated *e = &o->estimate[k];
    snprintf(e->column, sizeof e->column, "%.31s_est", k < m->dof ? c->name : c->rate);
    e->unit = k < m->dof ? c->unit : c->rate_unit;
    if (vs_machine_has_output(m, e->column))
      return vs_fail_at(r->err, r->map->key_where,
                        "control.observer: its column %s has the name of an output of the machine, "
                        "which wants another name",
                        e->column);
  }
  o->estimates = 2 * m->dof;
  return VS_OK;
}

/* Error: the map has a key of a kind that is not its own. */
static vs_status check_keys(const reading *r, const vs_gain_kind *other) {
  for (int k = 0; k < 2 && other->keys[k]; k++)
    if (vs_tree_child(r->map, other->keys[k]))
      return vs_fail_at(r->err, place_of(r, other->keys[k]),
                        "control.observer.%s is of kind: %s, and this observer is of kind: %s",
                        other->keys[k], other->name, vs_gain_kinds[r->o->v.kind].name);
  return VS_OK;
}

static vs_status read_keys(const reading *r) {
  vs_observing_values *v = &r->o->v;
  vs_status s = vs_field_section_read(&vs_observing_section, NULL, v, r->err);
  if (!s && r->map->kind == VS_NODE_MAP)
    s = vs_field_outline_keys(r->map, vs_observing_section.name, vs_observing_keys, r->err);
  for (int k = 0; k < N_KEYS && !s; k++) {
    const vs_node *node = vs_tree_child(r->map, KEYS[k].key);
    if (node) s = vs_field_read(&vs_observing_section, &KEYS[k], node, v, r->err);
  }
  for (int k = 0; vs_gain_kinds[k].name && !s; k++)
    if (k != v->kind) s = check_keys(r, &vs_gain_kinds[k]);
  return s;
}

/* The part of an error that is left when it has settled. */
static const double LEFT = 0.01;

static vs_status find_gain(const reading *r) {
  vs_observing *o = r->o;
  const vs_sampled *p = o->system;
  gsl_matrix *gain = vs_checked(gsl_matrix_calloc((size_t)p->states, (size_t)p->sensors));
  vs_scaled s = vs_sampled_scale(p);
  const vs_gain_ask ask = {r->map, &o->v.gain, p, &s};
  vs_status status = check_sight(r, &s);
  if (!status) status = vs_gain_kinds[o->v.kind].find(&ask, gain, r->err);
  bool good = !status && vs_sampled_poles(p, &s, gain, o->pole);
  o->settling_s = -log(LEFT) / -o->pole[0].re_1_s;
  if (!status && !(good && o->pole[0].re_1_s < 0))
    status = vs_fail_at(r->err, r->map->key_where,
                        "control.observer: with the gain that is found its error does not decay");
  for (int i = 0; i < p->states; i++)
    for (int k = 0; k < p->sensors; k++)
      o->gain[i][k] = gsl_matrix_get(gain, (size_t)i, (size_t)k) * p->scale[i] / p->y_scale[k];
  vs_sampled_unscale(&s);
  gsl_matrix_free(gain);
  return status;
}

vs_status vs_observing_read(const vs_node *map, const vs_model *model,
                            const vs_instruments *instruments, double rate_hz, vs_observing *o,
                            vs_error *err) {
  found f;
  const reading r = {map, model, instruments, rate_hz, o, err};
  vs_status s;
  vs_observing_free(o);
  if (map->kind == VS_NODE_LIST || (map->kind == VS_NODE_TEXT && *map->text))
    return vs_fail_at(err, map->where,
                      "control.observer: a map is wanted: {kind: kalman, sensors: [NAME, ...]}");
  if ((s = read_keys(&r)) || (s = name_estimates(&r)) || (s = find_current(&r))) return s;
  if ((s = find_sensors(&r, &f))) return s;
  o->system = vs_alloc(1, sizeof *o->system);
  vs_sampled_make(o->system, model, f.item, f.count, 1 / rate_hz);
  o->of_current = (int)(o->current - instruments->item);
  for (int k = 0; k < f.count; k++) o->of_sensor[k] = (int)(f.item[k] - instruments->item);
  return find_gain(&r);
}

void vs_observing_free(vs_observing *o) {
  free(o->system);
  *o = (vs_observing){0};
}
