/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions to the largest rise of a temperature, by the transient thermal impedance of the
 * device's part (its lines zth): that of a junction, under the device's power; that of a
 * capacitor's core, under ESR i^2. Without such lines, or without a limit esr, no value is known.
 *
 * And to temperatures: that of the case, by the mean power and the heat sink, and the largest one
 * of the junction, which is the case's and the rise. */
#include "devices/reductions.h"

#include <math.h>
#include <string.h>

#include "devices/means.h"
#include "netlist/devices.h"
#include "netlist/parts.h"

/* ---- the rise ---- */

/* On an orbit the rise at the period's beginning is that at its end. A run that is repeated (the
 * keys times and every of an event) begins with what the runs before it have left. Both are known
 * at the run's end. So the power over the run is kept: each step's mean and its end. Where there
 * are more steps than that, each two neighbours become one. */
enum { KEPT = 32768 };
typedef struct heating {
  double end_s, power_w;
} heating;

/* The Foster network of the device's part, and the rise of each of its terms. */
typedef struct network {
  double tau_s[VS_PART_ZTH];
  double gain[VS_PART_ZTH]; /* rise in the long run, K over the unit of the course */
  double rise_k[VS_PART_ZTH];
  size_t count;
  double begun_s;
  double orbit_ends_s; /* of a run that begins on an orbit, while its first period is followed: the
                          end of that; else 0 */
  double orbit_j;      /* what that period brings */
  double orbit_w;      /* its mean power, once it is over; NaN: there was none */
  size_t n_kept;
  heating kept[]; /* [KEPT] where the run comes again or begins on an orbit, else [0] */
} network;

/* Takes the part's lines zth. The course is this many W to its unit. */
static void take_network(const vs_watched *w, vs_reduced *r, double scale_w) {
  const vs_deck *deck = w->deck;
  network *n = r->state;
  const char *file = w->device->part < 0 ? "" : deck->parts[w->device->part].file;
  for (size_t k = 0; k < deck->n_zth; k++) {
    if (strcmp(deck->zth[k].where.file, file)) continue;
    n->tau_s[n->count] = deck->zth[k].tau_s;
    n->gain[n->count++] = scale_w * deck->zth[k].k_per_w;
    r->unsure |= deck->zth[k].unsure;
  }
}

static void prepare_junction(vs_watched *w, vs_reduced *r) {
  take_network(w, r, 1);
}

/* What a capacitor stores and gives back is no heat; ESR i^2 is, by the part's limit esr. */
static void prepare_core(vs_watched *w, vs_reduced *r) {
  const char *file = w->device->part < 0 ? NULL : w->deck->parts[w->device->part].file;
  const vs_limit *esr = file ? vs_parts_find_limit(w->deck, file, "esr") : NULL;
  if (!esr || !isfinite(esr->value)) return;
  r->unsure = esr->unsure;
  take_network(w, r, esr->value);
}

static bool has_zth_network(const vs_watched *w, const vs_reduced *r) {
  const network *n = r->state;
  (void)w;
  return n->count;
}

/* The end of the orbit's first period, of a run that begins on one; 0: it does not, or an event
 * comes before. */
static double orbit_ends_s(const vs_watched *w, double t_s) {
  const vs_timeline *line = w->timeline;
  const double cycles = line->firing.no_valve ? 1 : line->firing.every;
  const double ends_s = t_s + cycles * line->period_s;
  if (!w->from_work || w->again) return 0;
  for (size_t k = 0; k < line->events.count; k++)
    if (line->events.item[k].start_s < ends_s) return 0;
  return ends_s;
}

static void begin_junction(const vs_watched *w, vs_reduced *r, double t_s) {
  network *n = r->state;
  n->begun_s = t_s;
  n->orbit_ends_s = orbit_ends_s(w, t_s);
  n->orbit_w = NAN;
  vs_reducer_begin_at_zero(w, r, t_s);
}

static double rise_of(const network *n) {
  double rise_k = 0;
  for (size_t k = 0; k < n->count; k++) rise_k += n->rise_k[k];
  return rise_k;
}

/* Each term moves on its own, under a power that is constant for h_s. Returns the rise of all. */
static double heat_up(network *n, double power_w, double h_s) {
  for (size_t k = 0; k < n->count; k++) {
    double less = -expm1(-h_s / n->tau_s[k]);
    n->rise_k[k] += less * (n->gain[k] * power_w - n->rise_k[k]);
  }
  return rise_of(n);
}

static void halve_kept(network *n) {
  double from_s = n->begun_s;
  for (size_t k = 0; k < KEPT / 2; k++) {
    const heating *a = &n->kept[2 * k], *b = a + 1;
    double joule = a->power_w * (a->end_s - from_s) + b->power_w * (b->end_s - a->end_s);
    const heating both = {b->end_s, joule / (b->end_s - from_s)};
    from_s = b->end_s;
    n->kept[k] = both;
  }
  n->n_kept = KEPT / 2;
}

static void keep_power(network *n, double end_s, double power_w) {
  if (n->n_kept == KEPT) halve_kept(n);
  n->kept[n->n_kept++] = (heating){end_s, power_w};
}

/* From 0 a term comes to b in the period T, and from s to s e^(-T/tau) + b. On an orbit that is s
 * again: s = b/(1 - e^(-T/tau)). */
static double of_orbit(double period_s, double tau_s) {
  return 1 / -expm1(-period_s / tau_s);
}

/* Goes through the kept stretch once more, from what the terms are now. */
static void go_again(vs_reduced *r) {
  network *n = r->state;
  vs_course_step c = {.t1_s = n->begun_s};
  r->value = (vs_value){true, rise_of(n), n->begun_s};
  for (size_t k = 0; k < n->n_kept; k++) {
    double before = rise_of(n);
    c.t0_s = c.t1_s;
    c.t1_s = n->kept[k].end_s;
    c.h_s = c.t1_s - c.t0_s;
    vs_reducer_take_largest(r, &c, before, heat_up(n, n->kept[k].power_w, c.h_s));
  }
}

/* The first period of an orbit, from cold. At its end the terms are made those of the orbit, with
 * which it is gone through once more. Returns how much of the step lies behind it, s. */
static double follow_orbit(vs_reduced *r, const vs_course_step *c, double power_w) {
  network *n = r->state;
  const double behind_s = fmax(c->t1_s - n->orbit_ends_s, 0), h_s = c->h_s - behind_s;
  const double length_s = n->orbit_ends_s - n->begun_s;
  heat_up(n, power_w, h_s);
  n->orbit_j += power_w * h_s;
  keep_power(n, c->t0_s + h_s, power_w);
  if (n->orbit_ends_s - c->t1_s > 1e-9 * length_s) return 0;
  for (size_t k = 0; k < n->count; k++) n->rise_k[k] *= of_orbit(length_s, n->tau_s[k]);
  go_again(r);
  n->orbit_w = n->orbit_j / length_s;
  n->orbit_ends_s = 0;
  return behind_s;
}

static void follow_junction(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  network *n = r->state;
  double power_w = c->more[r->measure->of] / c->h_s, h_s = c->h_s;
  if (n->orbit_ends_s > 0) h_s = follow_orbit(r, c, power_w);
  double before = rise_of(n);
  if (n->orbit_ends_s > 0 || !(h_s > 0)) return;
  double after = heat_up(n, power_w, h_s);
  if (w->again)
    keep_power(n, c->t1_s, power_w);
  else
    vs_reducer_take_largest(r, c, before, after);
}

/* What b at the end of a run becomes until the run that comes n-th begins, T behind the one before
 * it, with that of all runs before it: b e^(-(T-D)/tau) (1 - q^(n-1))/(1 - q), q = e^(-T/tau); D is
 * how long the run is. */
static double of_times(const vs_scene_event *e, double length_s, double tau_s) {
  double q_to_n = (e->v.times - 1) * e->v.every_s / tau_s;
  return exp(-(e->v.every_s - length_s) / tau_s) * expm1(-q_to_n) / expm1(-e->v.every_s / tau_s);
}

/* From what the run begins with it is gone through once more. */
static void repeat_rise(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  network *n = r->state;
  const vs_scene_event *e = vs_scene_event_repeated(&w->timeline->events);
  const double length_s = end->now_s - n->begun_s;
  for (size_t k = 0; k < n->count; k++)
    n->rise_k[k] *=
        w->at_work ? of_orbit(length_s, n->tau_s[k]) : of_times(e, length_s, n->tau_s[k]);
  go_again(r);
}

/* Of a run that began cold and ended at end_s: what its terms lack of where that mean power would
 * take them in the long run, K. */
static double rise_lacks_k(const vs_reduced *rise, double end_s, double power_w) {
  const network *n = rise->state;
  double lacks_k = 0;
  for (size_t k = 0; k < n->count; k++)
    lacks_k += fmax(power_w, 0) * n->gain[k] * exp(-(end_s - n->begun_s) / n->tau_s[k]);
  return lacks_k;
}

/* What a settled rise may still lack, as a part of its limit. It counts as the value's error. */
static const double NEXT_TO_NOTHING = 0.01;
static const char SETTLING[] = "not judged: it has not settled; vibrospice steady SCENE judges it",
                  LONGER[] = "not judged: it has not settled; a longer run judges it",
                  AT_START[] =
                      "not judged: an event comes before the orbit's first period is over, "
                      "by which it is warm; a later event has it judged";

/* A rise that begins cold lacks what went before the run, unless that is all that there is. Where
 * the mean heat is known so is what it lacks. */
static void hold_rise(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double level;
  const bool too_hot = r->limit && r->value.known && r->value.value > r->limit->value;
  if (w->at_work || !r->value.known) return;
  if (!w->from_work && (w->again || vs_means_is_over(w))) return;
  const char *why = vs_means_of(w, r->measure->of, end, &level);
  const double lacks_k = why ? INFINITY : rise_lacks_k(r, end->now_s, level);
  if (w->from_work && why && !w->again && !too_hot) r->value.known = false;
  if (!r->limit || too_hot) return;
  r->doubt = lacks_k;
  if (lacks_k <= NEXT_TO_NOTHING * r->limit->value) return;
  r->doubt = 0;
  r->limit = NULL;
  r->unjudged = w->from_work                  ? AT_START
                : why                         ? why
                : !w->timeline->supply.direct ? SETTLING
                                              : LONGER;
}

/* A run that is shorter than the period of the orbit that it begins on tells nothing. */
static void finish_junction(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  network *n = r->state;
  if (n->orbit_ends_s > 0) r->value.known = false;
  if (w->again && n->count) repeat_rise(w, r, end);
  if (n->count && !isfinite(n->orbit_w)) hold_rise(w, r, end);
}

/* Of a run that begins on an orbit the first period stands for all that was before it, unless an
 * event comes within it: the rise begins as it is on the orbit. Returns the mean power of that
 * period, W, of a measure by vs_junction_of_power; NaN: there was none, or the part has no lines
 * zth. */
static double orbit_mean_w(const vs_reduced *rise) {
  const network *n = rise->state;
  return n->count && rise->value.known ? n->orbit_w : NAN;
}

const vs_reducer vs_junction_of_power = {.continuous = true,
                                         .state_size = sizeof(network),
                                         .again_size = KEPT * sizeof(heating),
                                         .prepare = prepare_junction,
                                         .is_busy = has_zth_network,
                                         .begin = begin_junction,
                                         .follow = follow_junction,
                                         .finish = finish_junction},
                 vs_junction_of_current = {.continuous = true,
                                           .state_size = sizeof(network),
                                           .again_size = KEPT * sizeof(heating),
                                           .prepare = prepare_core,
                                           .is_busy = has_zth_network,
                                           .begin = begin_junction,
                                           .follow = follow_junction,
                                           .finish = finish_junction};

/* ---- temperatures ----
 * A heat sink takes minutes to warm, a junction milliseconds. So the case is as warm as the mean
 * power makes it in the long run where that mean is judged, or a run is repeated or begins on an
 * orbit; else it stays as it begins, at the ambient. The junction's largest rise over it is the
 * measure of its own. */

static const char NO_SINK[] = "not judged: no heat sink is stated, nor r_th_ja",
                  NO_ZTH[] = "not judged: the part has no lines zth",
                  ON_MEAN[] = "not judged: the mean alone is known, as the part has no lines zth",
                  WARM[] = "not judged: the case is warm at the start; 'steady' judges it";

/* The mean power of what goes on for ever: of a run that is repeated, as in power_repeated; where a
 * mean of the run is judged, that; else that of the orbit on which the run begins. Returns why none
 * is known, as "not judged: one shot"; NULL: one is. */
static const char *long_run_w(const vs_watched *w, const vs_run_end *end, double *power_w) {
  const vs_scene_event *e = vs_scene_event_repeated(&w->timeline->events);
  *power_w = e ? w->sum[VS_OF_POWER] / e->v.every_s : NAN;
  if (!w->at_work && e) return NULL;
  const char *unjudged = vs_means_of(w, VS_OF_POWER, end, power_w);
  if (!unjudged) return NULL;
  *power_w = orbit_mean_w(vs_reducer_of(w, VS_R_JUNCTION));
  return isfinite(*power_w) ? NULL : unjudged;
}

static void finish_case(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double power_w;
  const char *cold = long_run_w(w, end, &power_w);
  const double to_ambient = vs_cooling_to_ambient(w->cooling, w->deck, w->device, &r->unsure);
  if (!w->cooling->stated && isnan(to_ambient)) return;
  if (cold ? w->from_work : isnan(to_ambient)) return;
  r->note = cold ? cold + strlen("not judged: ") : NULL;
  r->value = (vs_value){true, w->cooling->ambient_degc, NAN};
  if (!cold) r->value.value += to_ambient * power_w;
}

/* The limit is left, for this reason. */
static void leave_limit(vs_reduced *r, const char *why) {
  if (r->limit) r->unjudged = why;
  r->limit = NULL;
}

/* Without lines zth the mean temperature is known, if that. It may break the limit, and cannot hold
 * it. */
static void finish_mean_junction(const vs_watched *w, vs_reduced *r, double case_degc,
                                 const vs_run_end *end) {
  unsigned unsure = 0;
  double power_w, r_jc = vs_devices_r_th(w->deck, w->device, "r_th_jc", &unsure);
  if (long_run_w(w, end, &power_w)) {
    leave_limit(r, NO_ZTH);
    return;
  }
  r->unsure |= unsure;
  r->mean = true;
  r->value = (vs_value){true, case_degc + (isfinite(r_jc) ? r_jc * power_w : 0), NAN};
  if (r->limit && r->value.value > r->limit->value)
    r->failed_s = end->to_s;
  else
    leave_limit(r, ON_MEAN);
}

/* What the largest rise of a run that begins cold lacks, K, where its mean power goes on. */
static double cold_rise_lacks_k(const vs_watched *w, const vs_reduced *rise,
                                const vs_run_end *end) {
  double power_w;
  const bool from_cold =
      !w->at_work && !w->from_work && !vs_scene_event_repeated(&w->timeline->events);
  if (!from_cold || long_run_w(w, end, &power_w)) return 0;
  return rise_lacks_k(rise, end->now_s, power_w);
}

static void finish_hottest(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_reduced *of_case = vs_reducer_of(w, VS_R_CASE), *rise = vs_reducer_of(w, VS_R_JUNCTION);
  if (!of_case->value.known) {
    double power_w;
    const bool warm = long_run_w(w, end, &power_w) && w->from_work;
    leave_limit(r, warm && vs_cooling_has(w->cooling, w->deck, w->device) ? WARM : NO_SINK);
    return;
  }
  r->unsure = of_case->unsure | rise->unsure;
  if (!rise->value.known) {
    finish_mean_junction(w, r, of_case->value.value, end);
    return;
  }
  const double rise_k = rise->value.value + cold_rise_lacks_k(w, rise, end);
  r->value = (vs_value){true, of_case->value.value + rise_k, rise->value.at_s};
  if (r->limit && r->value.value > r->limit->value)
    r->failed_s = rise->value.at_s;
  else if (of_case->note &&
           !vs_means_is_over(w)) { /* the case will be warmer: that may only break it */
    double power_w;
    leave_limit(r, long_run_w(w, end, &power_w));
  }
}

const vs_reducer vs_junction_case = {.continuous = true, .finish = finish_case},
                 vs_junction_hottest = {.finish = finish_hottest};
