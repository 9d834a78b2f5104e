/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/state_observer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "control/sampled_system.h"
#include "pole_placement.h"
#include "riccati.h"

/* ---- the poles that are wanted ----
 * A scene says in the observer's key `poles` which ones its error is to have.
 *
 *   poles: [-200, [-150, 300], [-150, -300], ...]
 *
 * A real pole is a number in 1/s; a complex one a pair of its real part in 1/s and its imaginary
 * part in rad/s, and its conjugate stands in the list, too. */

/* What reading has at hand. where: the place of the list's key, or of the map's without one. */
typedef struct asking {
  const vs_node *list;
  vs_where where;
  const vs_sampled_system *system;
  vs_error *err;
} asking;

static bool read_pole_number(const vs_node *node, double *value) {
  char *end;
  if (!node || node->kind != VS_NODE_TEXT || !*node->text) return false;
  *value = vs_text_to_number(node->text, &end);
  while (*end == ' ') end++;
  return isfinite(*value) && (!*end || !strcmp(end, "1/s") || !strcmp(end, "rad/s"));
}

static vs_status read_pole(const asking *q, const vs_node *node, vs_pole *pole) {
  const double rate_hz = 1 / q->system->period_s;
  const vs_node *re = node->kind == VS_NODE_LIST ? node->child : node,
                *im = node->kind == VS_NODE_LIST && re ? re->next : NULL;
  *pole = (vs_pole){0};
  if (!read_pole_number(re, &pole->re_1_s) || (im && !read_pole_number(im, &pole->im_rad_s)) ||
      (node->kind == VS_NODE_LIST && (!im || im->next)))
    return vs_fail_at(q->err, node->where,
                      "control.observer.poles: a pole is a number in 1/s, as -200, or a pair "
                      "[-150, 300] of its real part in 1/s and its imaginary part in rad/s");
  if (!(pole->re_1_s < 0))
    return vs_fail_at(q->err, node->where,
                      "control.observer.poles: with %g 1/s an error does not decay; the real part "
                      "must be below 0",
                      pole->re_1_s);
  if (!(fabs(pole->im_rad_s) < M_PI * rate_hz))
    return vs_fail_at(q->err, node->where,
                      "control.observer.poles: an imaginary part of %g rad/s is beyond what "
                      "control.rate = %g Hz can tell, which is below %g rad/s",
                      pole->im_rad_s, rate_hz, M_PI * rate_hz);
  return VS_OK;
}

static bool is_pole_near(const vs_pole *a, const vs_pole *b) {
  double size = hypot(a->re_1_s, a->im_rad_s);
  return hypot(a->re_1_s - b->re_1_s, a->im_rad_s - b->im_rad_s) <= 1e-6 * size;
}

static int how_often(const vs_pole *pole, const vs_pole *of, int count) {
  int often = 0;
  for (int k = 0; k < count; k++) often += is_pole_near(of, &pole[k]);
  return often;
}

/* Puts each pole's conjugate behind it. Error: one has none, or one stands too often. */
static vs_status pair_up(const asking *q, vs_pole *pole, int count) {
  int m = q->system->sensors;
  vs_where where = q->where;
  for (int k = 0; k < count; k++) {
    const vs_pole conjugate = {pole[k].re_1_s, -pole[k].im_rad_s};
    int often = how_often(pole, &pole[k], count);
    if (how_often(pole, &conjugate, count) != often)
      return vs_fail_at(q->err, where,
                        "control.observer.poles: not a conjugate set: [%g, %g] stands without "
                        "[%g, %g]",
                        pole[k].re_1_s, pole[k].im_rad_s, conjugate.re_1_s, conjugate.im_rad_s);
    if (often > m)
      return vs_fail_at(q->err, where,
                        "control.observer.poles: [%g, %g] stands %d times; with %d sensor%s a pole "
                        "can stand %d time%s; set them apart",
                        pole[k].re_1_s, pole[k].im_rad_s, often, m, m > 1 ? "s" : "", m,
                        m > 1 ? "s" : "");
  }
  for (int k = 0; k < count; k++) {
    if (pole[k].im_rad_s == 0) continue;
    vs_pole conjugate = {pole[k].re_1_s, -pole[k].im_rad_s};
    int other = k + 1;
    while (!is_pole_near(&conjugate, &pole[other])) other++;
    vs_pole moved = pole[k + 1];
    if (pole[k].im_rad_s < 0) {
      vs_pole first = conjugate;
      conjugate = pole[k];
      pole[k] = first;
    }
    pole[other] = moved;
    pole[++k] = conjugate;
  }
  return VS_OK;
}

/* The low-passes' own poles. Where two of them are one, they are set apart by a hundredth. Returns
 * how many there are. */
static int own_poles(const vs_sampled_system *p, vs_pole *pole) {
  int n = 0;
  for (int k = 0; k < p->sensors; k++) {
    const vs_lowpass *l = &p->sensor[k].lowpass;
    double zeta = fmin(l->damping, 1 - 5e-5), im = l->rate * sqrt(1 - zeta * zeta);
    if (p->sensor[k].states == 1) pole[n++] = (vs_pole){-l->rate, 0};
    if (p->sensor[k].states < 2) continue;
    pole[n++] = (vs_pole){-zeta * l->rate, im};
    pole[n++] = (vs_pole){-zeta * l->rate, -im};
  }
  return n;
}

/* Fills `pole` with one for each state of the system, each pair one after the other, that with the
 * positive imaginary part first. The list in the observer's map may have as many; or one for each
 * coordinate and each rate, and the sensors' low-passes keep their own poles. Errors: no list, or
 * one of another length; a pole that is none, does not decay, or is faster than half the rate of
 * samples; a set that is not its own conjugate; a pole that stands more often than there are
 * sensors. */
static vs_status read_poles(const vs_node *map, const vs_sampled_system *p,
                            vs_pole pole[VS_SAMPLED_MOST], vs_error *err) {
  const vs_node *list = vs_tree_child(map, "poles");
  const asking q = {list, list ? list->key_where : map->key_where, p, err};
  vs_pole own[VS_SAMPLED_MOST];
  int count = 0, n_own = own_poles(p, own);
  for (const vs_node *n = list && list->kind == VS_NODE_LIST ? list->child : NULL; n; n = n->next) {
    vs_pole one;
    vs_status s = read_pole(&q, n, &one);
    if (s) return s;
    if (count < VS_SAMPLED_MOST) pole[count] = one;
    count++;
  }
  if (count != p->states && count != 2 * p->dof)
    return vs_fail_at(
        err, q.where,
        "control.observer.poles: %d given; wanted are %d, one for each coordinate and "
        "each of their rates%s",
        count, 2 * p->dof, n_own ? ", or as many more as the sensors' low-passes have states" : "");
  for (int k = 0; count < p->states; k++) pole[count++] = own[k];
  return pair_up(&q, pole, count);
}

/* How far the poles that are reached are from those wanted: the largest distance, relative to its
 * pole's size. */
static double poles_missed(const vs_pole *wanted, const vs_pole *reached, int count) {
  bool taken[VS_SAMPLED_MOST] = {false};
  double worst = 0;
  for (int k = 0; k < count; k++) {
    double least = INFINITY;
    int nearest = 0;
    for (int j = 0; j < count; j++) {
      double off =
          hypot(wanted[k].re_1_s - reached[j].re_1_s, wanted[k].im_rad_s - reached[j].im_rad_s);
      if (taken[j] || !(off < least)) continue;
      least = off;
      nearest = j;
    }
    taken[nearest] = true;
    worst = fmax(worst, least / hypot(wanted[k].re_1_s, wanted[k].im_rad_s));
  }
  return worst;
}

/* ---- the gain ----
 * One plug for each kind of observer. A new one is a function here, a row of GAIN_KINDS, and its
 * word in VS_GAIN_WORDS. */

/* What a gain is found for. */
typedef struct gain_ask {
  const vs_node *map; /* the observer's */
  const vs_gain_values *v;
  const vs_sampled_system *system;
  const vs_scaled *scaled; /* the same system */
} gain_ask;

typedef struct gain_kind {
  const char *name;
  const char *keys[2]; /* that it alone has; NULL behind the last */
  /* Fills the gain L in scaled states and sensors, states x sensors. Errors: what its keys can be
   * wrong in; there is no such gain. */
  vs_status (*find)(const gain_ask *ask, gsl_matrix *gain, vs_error *err);
} gain_kind;

/* By which part of its size a pole may miss the one that is wanted. */
static const double MISSED = 0.005;

static vs_status gain_by_placement(const gain_ask *q, gsl_matrix *gain, vs_error *err) {
  const vs_sampled_system *p = q->system;
  const vs_scaled *s = q->scaled;
  vs_pole pole[VS_SAMPLED_MOST], reached[VS_SAMPLED_MOST];
  gsl_complex wanted[VS_SAMPLED_MOST];
  vs_status status = read_poles(q->map, p, pole, err);
  if (status) return status;
  for (int k = 0; k < p->states; k++) wanted[k] = vs_sampled_system_difference(p, pole[k]);
  gsl_matrix *k = vs_checked(gsl_matrix_alloc(gain->size2, gain->size1));
  bool good = vs_pole_placement(s->at, s->cat, wanted, k);
  gsl_matrix_transpose_memcpy(gain, k);
  gsl_matrix_scale(gain, s->unit_s);
  gsl_matrix_free(k);
  good = good && vs_sampled_system_poles(p, s, gain, reached);
  double off = good ? poles_missed(pole, reached, p->states) : INFINITY;
  if (off < MISSED) return VS_OK;
  return vs_fail_at(err, vs_tree_child(q->map, "poles")->key_where,
                    "control.observer.poles: rounding moves them by %.2g %% with the gain that is "
                    "found; set them further apart, nearer to the machine's own, or add a sensor",
                    100 * off);
}

/* What is not known of a sample, SI of the channel, squared: the noise, and a step of the A/D,
 * whose error is spread evenly over it. An instrument with neither is taken to be right to a
 * millionth of its range, as no instrument is free of errors. */
static double variance(const vs_sensor *s) {
  const vs_instrument_values *v = &s->instrument->v;
  double span = s->range[1] - s->range[0], unit = span / (v->range[1] - v->range[0]);
  double step = v->bits ? ldexp(span, -v->bits) : 0, noise = v->noise * unit;
  return fmax(noise * noise + step * step / 12, pow(1e-6 * span, 2));
}

static vs_status gain_by_kalman(const gain_ask *q, gsl_matrix *gain, vs_error *err) {
  const vs_sampled_system *p = q->system;
  const vs_scaled *s = q->scaled;
  size_t n = (size_t)p->states, m = (size_t)p->sensors;
  gsl_matrix *w = vs_checked(gsl_matrix_alloc(n, n)), *v = vs_checked(gsl_matrix_calloc(m, m)),
             *c = vs_checked(gsl_matrix_alloc(n, n));
  double noise = q->v->force_noise_n, energy = 0, push[VS_SAMPLED_MOST];
  for (size_t i = 0; i < n; i++) push[i] = noise * (p->b[0][i] + p->b[1][i]) / p->scale[i];
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) gsl_matrix_set(w, i, j, push[i] * push[j]);
  for (int i = p->dof; i < 2 * p->dof; i++) energy += push[i] * push[i];
  for (size_t i = (size_t)p->dof; i < 2 * (size_t)p->dof; i++)
    *gsl_matrix_ptr(w, i, i) += energy * pow(q->v->spread, 2);
  for (size_t k = 0; k < m; k++)
    gsl_matrix_set(v, k, k,
                   (variance(&p->sensor[k]) + pow(p->d[k] * noise, 2)) / pow(p->y_scale[k], 2));
  bool good = vs_riccati(s->full, s->c, w, v, c);
  if (good) vs_riccati_gain(c, s->c, v, gain);
  gsl_matrix_free(w);
  gsl_matrix_free(v);
  gsl_matrix_free(c);
  if (good) return VS_OK;
  return vs_fail_at(err, q->map->key_where,
                    "control.observer: no steady gain is found; kind: luenberger takes poles");
}

/* To add a kind: a function that fills the gain of a sampled system, in scaled states and sensors,
 * a row here with the keys that it alone has, and its word in VS_GAIN_WORDS in the same order. A
 * gain with which errors do not decay is refused. test_estimator tries it. */
static const gain_kind GAIN_KINDS[] = {{"kalman", {"force_noise", "spread"}, gain_by_kalman},
                                       {"luenberger", {"poles"}, gain_by_placement},
                                       {NULL, {NULL}, NULL}};

/* ---- the keys ---- */

#define AT(member) offsetof(vs_state_observer_values, member)
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
const vs_section vs_state_observer_section = {"control.observer", KEYS, N_KEYS};

static const vs_field NAME = {.kind = VS_TEXT};
static const vs_inside NAMES = {.rows = &NAME}, TWO = {.rows = &NAME, .count = 2},
                       POLES = {.rows = VS_ROWS({.kind = VS_TEXT | VS_LIST, .inside = &TWO})},
                       ALL = {.rows = VS_ROWS({"sensors", VS_TEXT | VS_LIST, .inside = &NAMES},
                                              {"poles", VS_LIST, .inside = &POLES}),
                              .besides = &vs_state_observer_section};
const vs_field vs_state_observer_key = {"observer", VS_NOTHING | VS_MAP, .inside = &ALL};

/* What reading has at hand. */
typedef struct reading {
  const vs_node *map;
  const vs_model *model;
  const vs_instruments *instruments;
  double rate_hz;
  vs_state_observer *o;
  vs_error *err;
} reading;

/* Where a value stands; of a list, and of the observer where it has no such key, where the key
 * does. */
static vs_where place_of_key(const reading *r, const char *key) {
  const vs_node *node = vs_tree_child(r->map, key);
  if (!node) return r->map->key_where;
  return node->kind == VS_NODE_TEXT ? node->where : node->key_where;
}

/* ---- instruments ---- */

static const vs_instrument *find_instrument(const reading *r, const char *name) {
  for (int k = 0; k < r->instruments->count; k++)
    if (!strcmp(r->instruments->item[k].name, name)) return &r->instruments->item[k];
  return NULL;
}

static vs_status refuse_observer_instrument(const reading *r, const char *key, const char *name,
                                            vs_where where) {
  const char *names[VS_INSTRUMENT_MOST];
  for (int k = 0; k < r->instruments->count; k++) names[k] = r->instruments->item[k].name;
  return vs_fail_at(r->err, where, "control.observer.%s: no instrument '%s'%s", key, name,
                    vs_text_hint(name, names, (size_t)r->instruments->count,
                                 "; the scene's section instruments has them")
                        .text);
}

static vs_status find_current(const reading *r) {
  vs_state_observer *o = r->o;
  bool any = !strcmp(o->v.current, KEYS[1].default_text);
  for (int k = 0; k < r->instruments->count && any && !o->current; k++)
    if (r->instruments->item[k].channel == VS_CH_I) o->current = &r->instruments->item[k];
  if (!any) o->current = find_instrument(r, o->v.current);
  if (!any && !o->current)
    return refuse_observer_instrument(r, "current", o->v.current, place_of_key(r, "current"));
  if (o->current && o->current->channel == VS_CH_I) return VS_OK;
  return vs_fail_at(r->err, place_of_key(r, "current"),
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
  const vs_instrument *i = find_instrument(r, name);
  if (!i) return refuse_observer_instrument(r, "sensors", name, node->where);
  for (int k = 0; k < f->count; k++)
    if (f->item[k] == i)
      return vs_fail_at(r->err, node->where,
                        "control.observer.sensors: %s stands twice; once is enough", name);
  if (f->count == VS_SENSOR_MOST)
    return vs_fail_at(r->err, node->where, "control.observer.sensors: at most %d are allowed",
                      VS_SENSOR_MOST);
  if (!vs_sampled_system_takes(r->model, i))
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
    if (vs_sampled_system_takes(r->model, &r->instruments->item[k]))
      f->item[f->count++] = &r->instruments->item[k];
  if (list && list->kind == VS_NODE_TEXT) s = add_named(r, list, f);
  for (const vs_node *n = list ? list->child : NULL; n && !s; n = n->next) s = add_named(r, n, f);
  if (s || f->count) return s;
  return vs_fail_at(r->err, place_of_key(r, "sensors"),
                    "control.observer.sensors: no instrument shows the motion; wanted is one of a "
                    "coordinate, of its rate or acceleration, or of z");
}

/* ---- what the sensors see ---- */

/* A mode with a share of less than this in what the sensors see is not seen. Rounding leaves
 * 1e-16 to 1e-13 of a mode that has no share. */
static const double UNSEEN = 1e-10;

/* Error: a mode is not seen; sensors depend on each other. */
static vs_status check_sight(const reading *r, const vs_scaled *s) {
  const vs_sampled_system *p = r->o->system;
  vs_mode modes[VS_MOST_STATES];
  char text[256] = "";
  size_t length = 0;
  int unseen = 0;
  if (vs_pole_placement_independence(s->cat) < UNSEEN)
    return vs_fail_at(r->err, place_of_key(r, "sensors"),
                      "control.observer.sensors: one of them shows nothing that the others do not; "
                      "leave it out");
  if (!vs_mechanics_modes(r->model, modes))
    return vs_fail(r->err, VS_RUN, "control.observer: the machine's modes cannot be found");
  for (int k = 0; k < 2 * p->dof; k++) {
    const vs_pole pole = {modes[k].re_1_s, modes[k].im_rad_s};
    if (pole.im_rad_s < 0 ||
        vs_pole_placement_reach(s->at, s->cat, vs_sampled_system_difference(p, pole)) > UNSEEN)
      continue;
    if (length < sizeof text - 32)
      length += (size_t)snprintf(text + length, sizeof text - length, "%s%.4g Hz",
                                 unseen ? ", " : "", modes[k].frequency_hz);
    unseen++;
  }
  if (!unseen) return VS_OK;
  return vs_fail_at(r->err, place_of_key(r, "sensors"),
                    "control.observer.sensors: they do not see the mode%s at %s, so that nothing "
                    "corrects %s; add an instrument of a coordinate that moves there",
                    unseen > 1 ? "s" : "", text, unseen > 1 ? "them" : "it");
}

/* ---- what is to be said of it ---- */

/* The first of its instruments whose samples do not fall on those of the control; NULL: all do. */
static const vs_instrument *out_of_step(const vs_state_observer *o) {
  const vs_sampled_system *p = o->system;
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

const char *vs_state_observer_note(const vs_state_observer *o, const vs_setup *setup, char *text,
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
  int n =
      snprintf(text, size, "control.observer does not know all of this run%s%s%s%s%s%s", old, late,
               setup->model.coil.eddies ? "; it computes a coil without eddy currents" : "",
               setup->model.stops.count ? "; it computes a machine without a stop" : "",
               setup->model.reloaded ? "; it computes the machine with its first load" : "",
               vs_setup_jams(setup) < setup->run.until_s ? "; it is not told of the jam" : "");
  return strchr(text, ';') && n > 0 ? text : NULL;
}

/* ---- all ---- */

/* Names the estimates. Error: the machine has an output of such a name. */
static vs_status name_estimates(const reading *r) {
  vs_state_observer *o = r->o;
  const vs_machine *m = r->model->machine;
  for (int k = 0; k < 2 * m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k % m->dof];
    vs_estimated *e = &o->estimate[k];
    snprintf(e->column, sizeof e->column, "%.31s_est", k < m->dof ? c->name : c->rate);
    e->unit = k < m->dof ? c->unit : c->rate_unit;
    e->of = k < m->dof ? c->name : c->rate;
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
static vs_status refuse_keys_of(const reading *r, const gain_kind *other) {
  for (int k = 0; k < 2 && other->keys[k]; k++)
    if (vs_tree_child(r->map, other->keys[k]))
      return vs_fail_at(r->err, place_of_key(r, other->keys[k]),
                        "control.observer.%s is of kind: %s, and this observer is of kind: %s",
                        other->keys[k], other->name, GAIN_KINDS[r->o->v.kind].name);
  return VS_OK;
}

static vs_status read_observer_keys(const reading *r) {
  vs_state_observer_values *v = &r->o->v;
  vs_status s = vs_field_section_read(&vs_state_observer_section, NULL, v, r->err);
  if (!s && r->map->kind == VS_NODE_MAP)
    s = vs_field_map_keys(r->map, vs_state_observer_section.name, &ALL, r->err);
  for (int k = 0; k < N_KEYS && !s; k++) {
    const vs_node *node = vs_tree_child(r->map, KEYS[k].key);
    if (node) s = vs_field_read(&vs_state_observer_section, &KEYS[k], node, v, r->err);
  }
  for (int k = 0; GAIN_KINDS[k].name && !s; k++)
    if (k != v->kind) s = refuse_keys_of(r, &GAIN_KINDS[k]);
  return s;
}

/* The part of an error that is left when it has settled. */
static const double LEFT = 0.01;

static vs_status find_observer_gain(const reading *r) {
  vs_state_observer *o = r->o;
  const vs_sampled_system *p = o->system;
  gsl_matrix *gain = vs_checked(gsl_matrix_calloc((size_t)p->states, (size_t)p->sensors));
  vs_scaled s = vs_sampled_system_scale(p);
  const gain_ask ask = {r->map, &o->v.gain, p, &s};
  vs_status status = check_sight(r, &s);
  if (!status) status = GAIN_KINDS[o->v.kind].find(&ask, gain, r->err);
  bool good = !status && vs_sampled_system_poles(p, &s, gain, o->pole);
  o->settling_s = -log(LEFT) / -o->pole[0].re_1_s;
  if (!status && !(good && o->pole[0].re_1_s < 0))
    status = vs_fail_at(r->err, r->map->key_where,
                        "control.observer: with the gain that is found its error does not decay");
  for (int i = 0; i < p->states; i++)
    for (int k = 0; k < p->sensors; k++)
      o->gain[i][k] = gsl_matrix_get(gain, (size_t)i, (size_t)k) * p->scale[i] / p->y_scale[k];
  vs_sampled_system_unscale(&s);
  gsl_matrix_free(gain);
  return status;
}

vs_status vs_state_observer_read(const vs_node *map, const vs_model *model,
                                 const vs_instruments *instruments, double rate_hz,
                                 vs_state_observer *o, vs_error *err) {
  found f;
  const reading r = {map, model, instruments, rate_hz, o, err};
  vs_status s;
  vs_state_observer_free(o);
  if (map->kind == VS_NODE_LIST || (map->kind == VS_NODE_TEXT && *map->text))
    return vs_fail_at(err, map->where,
                      "control.observer: a map is wanted: {kind: kalman, sensors: [NAME, ...]}");
  if ((s = read_observer_keys(&r)) || (s = name_estimates(&r)) || (s = find_current(&r))) return s;
  if ((s = find_sensors(&r, &f))) return s;
  o->system = vs_alloc(1, sizeof *o->system);
  vs_sampled_system_make(o->system, model, f.item, f.count, 1 / rate_hz);
  o->of_current = (int)(o->current - instruments->item);
  for (int k = 0; k < f.count; k++) o->of_sensor[k] = (int)(f.item[k] - instruments->item);
  return find_observer_gain(&r);
}

void vs_state_observer_free(vs_state_observer *o) {
  free(o->system);
  *o = (vs_state_observer){0};
}
