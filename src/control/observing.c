/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/observing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control/place.h"
#include "control/riccati.h"
#include "sim/channel.h"

#define AT(member) offsetof(vs_observing_values, member)
static const vs_field KEYS[] = {
    {"kind", VS_CHOICE, "", "kalman", .offset = AT(kind),
     .text = "how its gain is found: from noise (kalman), or from poles (luenberger)",
     .choices = "kalman|luenberger"},
    {"current", VS_NAME, "", "auto", .offset = AT(current),
     .text = "the instrument that measures the coil's current; auto: the first on channel i"},
    {"force_noise", VS_REAL, "N", "1 N", 0, 1e9, true, AT(force_noise_n),
     .text = "kalman: by how much the computed force is wrong, rms in each period"},
    {"spread", VS_REAL, "", "0.1", 0, 1e6, .offset = AT(spread),
     .text =
         "kalman: what unknown forces do to each coordinate, as a part of what force_noise does "
         "to the gap"},
    {"start", VS_CHOICE, "", "rest", .offset = AT(knows_start),
     .text = "where the estimate begins: at rest, or where the run does", .choices = "rest|run"}};
#undef AT
enum { N_KEYS = sizeof KEYS / sizeof *KEYS };
const vs_section vs_observing_section = {"control.observer", KEYS, N_KEYS};

/* What reading has at hand. */
typedef struct reading {
  const vs_node *map;
  const vs_model *model;
  const vs_instruments *instruments;
  double rate_hz;
  vs_observing *o;
  vs_error *err;
} reading;

static vs_where place_of(const reading *r, const char *key) {
  const vs_node *node = vs_tree_child(r->map, key);
  return node ? node->where : r->map->where;
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

/* Finds the sensors of the list, or all that can be. Returns how many; -1: an error. */
static int find_sensors(const reading *r, const vs_instrument *sensors[VS_SENSOR_MOST]) {
  const vs_node *list = vs_tree_child(r->map, "sensors");
  const vs_node *n = list && list->kind == VS_NODE_LIST ? list->child : list;
  vs_where where = list ? list->where : r->map->where;
  int count = 0;
  for (int k = 0; k < r->instruments->count && !list && count < VS_SENSOR_MOST; k++)
    if (vs_sampled_takes(r->model, &r->instruments->item[k]))
      sensors[count++] = &r->instruments->item[k];
  for (; n; n = list->kind == VS_NODE_LIST ? n->next : NULL) {
    const char *name = n->kind == VS_NODE_TEXT ? n->text : "";
    const vs_instrument *i = find(r, name);
    bool again = false;
    for (int k = 0; k < count; k++) again = again || sensors[k] == i;
    if (!i) return unknown(r, "sensors", name, n->where), -1;
    if (again || count == VS_SENSOR_MOST)
      return vs_fail_at(r->err, n->where, "control.observer.sensors: %s",
                        again ? "each instrument can stand once"
                              : "more than are allowed, which is 8"),
             -1;
    if (!vs_sampled_takes(r->model, i))
      return vs_fail_at(r->err, n->where,
                        "control.observer.sensors: %s does not show the motion alone; wanted is an "
                        "instrument of a coordinate, of its rate or acceleration, or of z",
                        name),
             -1;
    sensors[count++] = i;
  }
  if (!count)
    vs_fail_at(r->err, where,
               "control.observer.sensors: no instrument shows the motion; wanted is one of a "
               "coordinate, of its rate or acceleration, or of z");
  return count ? count : -1;
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

/* ---- poles ---- */

static bool read_number(const vs_node *node, double *value) {
  char *end;
  if (!node || node->kind != VS_NODE_TEXT || !*node->text) return false;
  *value = strtod(node->text, &end);
  while (*end == ' ') end++;
  return isfinite(*value) && (!*end || !strcmp(end, "1/s") || !strcmp(end, "rad/s"));
}

static vs_status read_pole(const reading *r, const vs_node *node, vs_pole *pole) {
  const vs_node *re = node->kind == VS_NODE_LIST ? node->child : node,
                *im = node->kind == VS_NODE_LIST && re ? re->next : NULL;
  *pole = (vs_pole){0};
  if (!read_number(re, &pole->re_1_s) || (im && !read_number(im, &pole->im_rad_s)) ||
      (node->kind == VS_NODE_LIST && (!im || im->next)))
    return vs_fail_at(r->err, node->where,
                      "control.observer.poles: a pole is a number in 1/s, as -200, or a pair "
                      "[-150, 300] of its real part in 1/s and its imaginary part in rad/s");
  if (!(pole->re_1_s < 0))
    return vs_fail_at(r->err, node->where,
                      "control.observer.poles: with %g 1/s an error does not decay; the real part "
                      "must be below 0",
                      pole->re_1_s);
  if (!(fabs(pole->im_rad_s) < M_PI * r->rate_hz))
    return vs_fail_at(r->err, node->where,
                      "control.observer.poles: an imaginary part of %g rad/s is beyond what "
                      "control.rate = %g Hz can tell, which is below %g rad/s",
                      pole->im_rad_s, r->rate_hz, M_PI * r->rate_hz);
  return VS_OK;
}

static bool is_near(const vs_pole *a, const vs_pole *b) {
  double size = hypot(a->re_1_s, a->im_rad_s);
  return hypot(a->re_1_s - b->re_1_s, a->im_rad_s - b->im_rad_s) <= 1e-6 * size;
}

static int how_often(const vs_pole *pole, const vs_pole *of, int count) {
  int often = 0;
  for (int k = 0; k < count; k++) often += is_near(of, &pole[k]);
  return often;
}

/* Puts each pole's conjugate behind it. Error: one has none, or one stands too often. */
static vs_status pair_up(const reading *r, vs_pole *pole, int count) {
  int m = r->o->system->sensors;
  vs_where where = place_of(r, "poles");
  for (int k = 0; k < count; k++) {
    const vs_pole conjugate = {pole[k].re_1_s, -pole[k].im_rad_s};
    int often = how_often(pole, &pole[k], count);
    if (how_often(pole, &conjugate, count) != often)
      return vs_fail_at(r->err, where,
                        "control.observer.poles: not a conjugate set: [%g, %g] stands without "
                        "[%g, %g]",
                        pole[k].re_1_s, pole[k].im_rad_s, conjugate.re_1_s, conjugate.im_rad_s);
    if (often > m)
      return vs_fail_at(r->err, where,
                        "control.observer.poles: [%g, %g] stands %d times; with %d sensor%s a pole "
                        "can stand %d time%s; set them apart",
                        pole[k].re_1_s, pole[k].im_rad_s, often, m, m > 1 ? "s" : "", m,
                        m > 1 ? "s" : "");
  }
  for (int k = 0; k < count; k++) {
    if (pole[k].im_rad_s == 0) continue;
    vs_pole conjugate = {pole[k].re_1_s, -pole[k].im_rad_s};
    int other = k + 1;
    while (!is_near(&conjugate, &pole[other])) other++;
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
static int own_poles(const vs_sampled *p, vs_pole *pole) {
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

/* Reads the list, of a pole for each state; or for each of the motion, and the low-passes keep
 * theirs. */
static vs_status read_poles(const reading *r, vs_pole pole[VS_SAMPLED_MOST]) {
  const vs_sampled *p = r->o->system;
  const vs_node *list = vs_tree_child(r->map, "poles");
  vs_pole own[VS_SAMPLED_MOST];
  int count = 0, n_own = own_poles(p, own);
  for (const vs_node *n = list && list->kind == VS_NODE_LIST ? list->child : NULL; n; n = n->next) {
    vs_pole one;
    vs_status s = read_pole(r, n, &one);
    if (s) return s;
    if (count < VS_SAMPLED_MOST) pole[count] = one;
    count++;
  }
  if (count != p->states && count != 2 * p->dof)
    return vs_fail_at(
        r->err, place_of(r, "poles"),
        "control.observer.poles: %d given; wanted are %d, one for each coordinate and "
        "each of their rates%s",
        count, 2 * p->dof, n_own ? ", or as many more as the sensors' low-passes have states" : "");
  for (int k = 0; count < p->states; k++) pole[count++] = own[k];
  return pair_up(r, pole, count);
}

/* ---- the poles that are reached ---- */

/* Finds how far the poles are from those wanted: the largest distance, relative to its pole's size.
 * Each of them counts once. */
static double missed_by(const vs_observing *o, const vs_pole *wanted) {
  bool taken[VS_SAMPLED_MOST] = {false};
  double worst = 0;
  for (int k = 0; k < o->system->states; k++) {
    double least = INFINITY;
    int nearest = 0;
    for (int j = 0; j < o->system->states; j++) {
      double off =
          hypot(wanted[k].re_1_s - o->pole[j].re_1_s, wanted[k].im_rad_s - o->pole[j].im_rad_s);
      if (taken[j] || !(off < least)) continue;
      least = off;
      nearest = j;
    }
    taken[nearest] = true;
    worst = fmax(worst, least / hypot(wanted[k].re_1_s, wanted[k].im_rad_s));
  }
  return worst;
}

/* ---- gains ---- */

/* By which part of its size a pole may miss the one that is wanted. */
static const double MISSED = 0.005;

static vs_status place(const reading *r, const vs_scaled *s, gsl_matrix *gain) {
  const vs_sampled *p = r->o->system;
  vs_pole pole[VS_SAMPLED_MOST];
  gsl_complex wanted[VS_SAMPLED_MOST];
  vs_status status = read_poles(r, pole);
  if (status) return status;
  for (int k = 0; k < p->states; k++) wanted[k] = vs_sampled_difference(p, pole[k]);
  gsl_matrix *k = gsl_matrix_alloc(gain->size2, gain->size1);
  bool good = vs_place(s->at, s->cat, wanted, k);
  gsl_matrix_transpose_memcpy(gain, k);
  gsl_matrix_scale(gain, s->unit_s);
  gsl_matrix_free(k);
  good = good && vs_sampled_poles(p, s, gain, r->o->pole);
  double off = good ? missed_by(r->o, pole) : INFINITY;
  if (off < MISSED) return VS_OK;
  return vs_fail_at(r->err, place_of(r, "poles"),
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

static vs_status filter(const reading *r, const vs_scaled *s, gsl_matrix *gain) {
  const vs_sampled *p = r->o->system;
  size_t n = (size_t)p->states, m = (size_t)p->sensors;
  gsl_matrix *q = gsl_matrix_alloc(n, n), *v = gsl_matrix_calloc(m, m), *c = gsl_matrix_alloc(n, n);
  double noise = r->o->v.force_noise_n, energy = 0, push[VS_SAMPLED_MOST];
  for (size_t i = 0; i < n; i++) push[i] = noise * (p->b[0][i] + p->b[1][i]) / p->scale[i];
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) gsl_matrix_set(q, i, j, push[i] * push[j]);
  for (int i = p->dof; i < 2 * p->dof; i++) energy += push[i] * push[i];
  for (size_t i = (size_t)p->dof; i < 2 * (size_t)p->dof; i++)
    *gsl_matrix_ptr(q, i, i) += energy * pow(r->o->v.spread, 2);
  for (size_t k = 0; k < m; k++)
    gsl_matrix_set(v, k, k,
                   (variance(&p->sensor[k]) + pow(p->d[k] * noise, 2)) / pow(p->y_scale[k], 2));
  bool good = vs_riccati(s->full, s->c, q, v, c);
  if (good) vs_riccati_gain(c, s->c, v, gain);
  gsl_matrix_free(q);
  gsl_matrix_free(v);
  gsl_matrix_free(c);
  if (good) return VS_OK;
  return vs_fail_at(r->err, r->map->where,
                    "control.observer: no steady gain is found; kind: luenberger takes poles");
}

/* How each kind finds its gain, in scaled states; which keys it alone has. In the order of the
 * key's words. */
typedef struct kind {
  const char *name, *keys[2];
  vs_status (*gain)(const reading *r, const vs_scaled *s, gsl_matrix *gain);
} kind;
static const kind KINDS[] = {{"kalman", {"force_noise", "spread"}, filter},
                             {"luenberger", {"poles"}, place}};
enum { N_KINDS = sizeof KINDS / sizeof *KINDS };

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

const char *vs_observing_note(const vs_observing *o, const vs_model *model, char *text,
                              size_t size) {
  const vs_instrument *late = out_of_step(o);
  size_t n = 0;
  *text = '\0';
  if (late)
    n += (size_t)snprintf(text, size,
                          "control.observer: samples of %s are up to %.3g ms old when they are "
                          "read, which it does not know; let its rate be a multiple of "
                          "control.rate = %g Hz",
                          late->name, 1e3 / late->v.rate_hz, 1 / o->system->period_s);
  if (model->stops.count && n < size)
    n += (size_t)snprintf(text + n, size - n,
                          "%scontrol.observer: it computes a machine without a stop, and is wrong "
                          "while one is touched",
                          n ? "; " : "");
  if (model->reloaded && n < size)
    n += (size_t)snprintf(text + n, size - n,
                          "%scontrol.observer: it computes the machine with its first load, and is "
                          "wrong once that changes",
                          n ? "; " : "");
  return n ? text : NULL;
}

/* ---- all ---- */

static vs_status read_keys(const reading *r) {
  const char *names[N_KEYS + 2] = {"sensors", "poles"};
  vs_observing_values *v = &r->o->v;
  for (int k = 0; k < N_KEYS; k++) names[2 + k] = KEYS[k].key;
  vs_status s = vs_field_section_read(&vs_observing_section, NULL, v, r->err);
  if (!s && r->map->kind == VS_NODE_MAP)
    s = vs_field_known_keys(r->map, "control.observer", names, N_KEYS + 2, r->err);
  for (int k = 0; k < N_KEYS && !s; k++) {
    const vs_node *node = vs_tree_child(r->map, KEYS[k].key);
    if (node) s = vs_field_read(&vs_observing_section, &KEYS[k], node, v, r->err);
  }
  for (int k = 0; k < 2 * N_KINDS && !s; k++) {
    const kind *other = &KINDS[k / 2];
    const char *key = other->keys[k % 2];
    if (k / 2 != v->kind && key && vs_tree_child(r->map, key))
      s = vs_fail_at(r->err, place_of(r, key),
                     "control.observer.%s is of kind: %s, and this observer is of kind: %s", key,
                     other->name, KINDS[v->kind].name);
  }
  return s;
}

/* The part of an error that is left when it has settled. */
static const double LEFT = 0.01;

static vs_status find_gain(const reading *r) {
  vs_observing *o = r->o;
  const vs_sampled *p = o->system;
  gsl_matrix *gain = gsl_matrix_calloc((size_t)p->states, (size_t)p->sensors);
  vs_scaled s = vs_sampled_scale(p);
  vs_status status = check_sight(r, &s);
  if (!status) status = KINDS[o->v.kind].gain(r, &s, gain);
  bool found = !status && vs_sampled_poles(p, &s, gain, o->pole);
  o->settling_s = -log(LEFT) / -o->pole[0].re_1_s;
  if (!status && !(found && o->pole[0].re_1_s < 0))
    status = vs_fail_at(r->err, r->map->where,
                        "control.observer: with the gain that is found its error does not decay");
  for (int i = 0; i < p->states; i++)
    for (int k = 0; k < p->sensors; k++)
      o->gain[i][k] = gsl_matrix_get(gain, (size_t)i, (size_t)k) * p->scale[i] / p->y_scale[k];
  vs_sampled_unscale(&s);
  gsl_matrix_free(gain);
  return status;
}

vs_status vs_observing_read(const vs_node *map, const vs_frame *frame,
                            const vs_instruments *instruments, double rate_hz, vs_observing *o,
                            vs_error *err) {
  const vs_instrument *sensors[VS_SENSOR_MOST];
  const reading r = {map, frame->model, instruments, rate_hz, o, err};
  vs_status s;
  vs_observing_free(o);
  if (map->kind == VS_NODE_LIST || (map->kind == VS_NODE_TEXT && *map->text))
    return vs_fail_at(err, map->where,
                      "control.observer: a map is wanted: {kind: kalman, sensors: [NAME, ...]}");
  if ((s = read_keys(&r)) || (s = find_current(&r))) return s;
  int count = find_sensors(&r, sensors);
  if (count < 0) return VS_INPUT;
  o->system = vs_alloc(1, sizeof *o->system);
  vs_sampled_make(o->system, frame->model, sensors, count, 1 / rate_hz);
  o->of_current = (int)(o->current - instruments->item);
  for (int k = 0; k < count; k++) o->of_sensor[k] = (int)(sensors[k] - instruments->item);
  return find_gain(&r);
}

void vs_observing_free(vs_observing *o) {
  free(o->system);
  *o = (vs_observing){0};
}
