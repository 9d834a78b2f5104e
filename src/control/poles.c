/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "poles.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What reading has at hand. where: the place of the list's key, or of the map's without one. */
typedef struct asking {
  const vs_node *list;
  vs_where where;
  const vs_sampled *system;
  vs_error *err;
} asking;

static bool read_number(const vs_node *node, double *value) {
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
  if (!read_number(re, &pole->re_1_s) || (im && !read_number(im, &pole->im_rad_s)) ||
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

vs_status vs_poles_read(const vs_node *map, const vs_sampled *p, vs_pole pole[VS_SAMPLED_MOST],
                        vs_error *err) {
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

double vs_poles_missed(const vs_pole *wanted, const vs_pole *reached, int count) {
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
