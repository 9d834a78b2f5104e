/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "validate/experiment.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers by name ---- */

void vs_experiment_add(vs_numbers *n, double value, const char *format, ...) {
  if (n->count == n->capacity) {
    n->capacity = 2 * n->capacity + 64;
    n->item = vs_resize(n->item, n->capacity, sizeof *n->item);
  }
  vs_number *number = &n->item[n->count++];
  va_list args;
  va_start(args, format);
  vsnprintf(number->name, sizeof number->name, format, args);
  va_end(args);
  number->value = value;
}

double vs_experiment_get(const vs_numbers *n, const char *name) {
  for (size_t k = 0; k < n->count; k++)
    if (!strcmp(n->item[k].name, name)) return n->item[k].value;
  return NAN;
}

void vs_experiment_numbers_free(vs_numbers *n) {
  free(n->item);
  *n = (vs_numbers){0};
}

/* ---- curves ---- */

void vs_experiment_curve_add(vs_experiment_curve *c, double t_s, double y) {
  if (c->count == c->capacity) {
    c->capacity = 2 * c->capacity + 1024;
    c->t_s = vs_resize(c->t_s, c->capacity, sizeof *c->t_s);
    c->y = vs_resize(c->y, c->capacity, sizeof *c->y);
  }
  c->t_s[c->count] = t_s;
  c->y[c->count++] = y;
}

void vs_experiment_curve_free(vs_experiment_curve *c) {
  free(c->t_s);
  free(c->y);
  *c = (vs_experiment_curve){0};
}

/* Where it first rises above part of its peak, or first falls below that behind the peak. */
static double passes(const vs_experiment_curve *c, size_t peak, double part, bool behind) {
  double level = part * c->y[peak];
  size_t k = behind ? peak : 0;
  while (k + 1 < c->count && (behind ? c->y[k + 1] > level : c->y[k + 1] < level)) k++;
  if (k + 1 >= c->count) return NAN;
  return c->t_s[k] + (level - c->y[k]) / (c->y[k + 1] - c->y[k]) * (c->t_s[k + 1] - c->t_s[k]);
}

void vs_experiment_curve_numbers(const vs_experiment_curve *c, vs_numbers *out) {
  size_t peak = 0, least = 0;
  for (size_t k = 1; k < c->count; k++) {
    if (c->y[k] > c->y[peak]) peak = k;
    if (c->y[k] < c->y[least]) least = k;
  }
  if (!c->count) return;
  double t10 = passes(c, peak, 0.1, false), t30 = passes(c, peak, 0.3, false);
  double t50 = passes(c, peak, 0.5, false), t90 = passes(c, peak, 0.9, false);
  double half = passes(c, peak, 0.5, true);
  vs_experiment_add(out, c->y[peak], "peak");
  vs_experiment_add(out, c->y[least], "least");
  vs_experiment_add(out, t90 - t10, "rise");
  vs_experiment_add(out, half - t50, "width");
  vs_experiment_add(out, 1.67 * (t90 - t30), "front_v");
  vs_experiment_add(out, half - (t30 - (t90 - t30) / 2), "half_v");
  vs_experiment_add(out, 1.25 * (t90 - t10), "front_i");
  vs_experiment_add(out, half - (t10 - (t90 - t10) / 8), "half_i");
}

/* ---- a scene ---- */

/* An empty file is the paper's scene, every key at its default. */
static const char EMPTY_SCENE[] = "/dev/null";

vs_status vs_experiment_scene(const vs_experiment *e, const char *another, vs_scene *scene,
                              vs_error *err) {
  char *sets[VS_EXPERIMENT_SETS + 1];
  size_t n = 0;
  for (; n < VS_EXPERIMENT_SETS && e->sets[n]; n++) sets[n] = (char *)(size_t)e->sets[n];
  if (another) sets[n++] = (char *)(size_t)another;
  return vs_scene_read(e->scene ? e->scene : EMPTY_SCENE, sets, n, e->tier, scene, err);
}

/* Events whose first occurrence is noted. */
enum { CONTACT, RELEASE, EVENTS };
static const struct {
  vs_event event;
  const char *name;
} NOTED[EVENTS] = {{VS_EV_MEETS_STOP, "contact"}, {VS_EV_LEAVES_STOP, "release"}};

/* Who watches the run of an experiment, besides the trial. */
typedef struct watch {
  const vs_experiment *experiment;
  const vs_observer *also;
  double seen[VS_EXPERIMENT_LOOKS][VS_CH_MOST];
  double event_s[EVENTS], at_event[EVENTS][VS_CH_MOST]; /* NaN: there was no such event */
  double charge_as;                                     /* integral of the coil current */
  vs_experiment_curve curve;
  int channel; /* of the curve; -1: not known yet */
} watch;

static void note_curve(watch *w, const vs_step *step) {
  const char *name = w->experiment->curve;
  if (!name) return;
  if (w->channel < 0) {
    w->channel = vs_channel_find(step->frame, name);
    if (w->channel < 0) return;
    vs_experiment_curve_add(&w->curve, step->from->t_s,
                            vs_step_channel(step, step->from->t_s, w->channel));
  }
  vs_experiment_curve_add(&w->curve, step->to->t_s,
                          vs_step_channel(step, step->to->t_s, w->channel));
}

static void note_events(watch *w, const vs_step *step) {
  for (int n = 0; n < EVENTS; n++)
    for (int k = 0; k < 2; k++) {
      if (step->event[k] != NOTED[n].event || !isnan(w->event_s[n])) continue;
      w->event_s[n] = step->event_s[k];
      vs_step_at(step, step->event_s[k], w->at_event[n]);
    }
}

static vs_status note_step_of_experiment(void *ctx, const vs_step *step, vs_error *err) {
  watch *w = ctx;
  double begin = step->from->t_s, end = step->to->t_s, half = (end - begin) / 2;
  for (int k = 0; k < VS_EXPERIMENT_LOOKS; k++) {
    double at = w->experiment->look_s[k];
    if (at > begin && at <= end) vs_step_at(step, at, w->seen[k]);
  }
  for (int k = -1; k <= 1; k++) /* Gauss's rule of three points */
    w->charge_as += half * (k ? 5 : 8) / 9.0 *
                    vs_step_channel(step, begin + half * (1 + k * sqrt(0.6)), VS_CH_I);
  note_events(w, step);
  note_curve(w, step);
  return w->also ? w->also->accept(w->also->ctx, step, err) : VS_OK;
}

vs_status vs_experiment_modes(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                              vs_error *err) {
  (void)also;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_mode modes[VS_MOST_STATES];
  vs_status status = vs_experiment_scene(e, NULL, scene, err);
  if (!status && !vs_mechanics_modes(&scene->setup.model, modes))
    status = vs_fail(err, VS_RUN, "no eigenvalues found");
  for (int k = 0; k < scene->setup.model.dof && !status; k++) { /* pairs */
    vs_experiment_add(out, modes[2 * k].frequency_hz, "f%d", k + 1);
    vs_experiment_add(out, modes[2 * k].time_constant_s, "tau%d", k + 1);
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

static void add_value(vs_numbers *out, const vs_value *v, const char *name, const char *ending) {
  if (!v->known) return;
  vs_experiment_add(out, v->value, "%s%s", name, ending);
  vs_experiment_add(out, v->at_s, "%s%s.at", name, ending);
}

void vs_experiment_add_measures(const vs_model *model, const vs_result *r, vs_numbers *out) {
  vs_measure m;
  for (int k = 0; vs_measure_at(model, k, &m); k++) {
    vs_value v = r->values[m.slot];
    v.value *= m.factor;
    add_value(out, &v, m.name, "");
  }
}

static void add_circuit(const vs_trial *t, vs_numbers *out) {
  const vs_deck *deck = t->scene.frame.deck;
  for (size_t k = 0; deck && k < deck->losses.count; k++)
    vs_experiment_add(out, t->result.watchers.energy.loss_j[k], "loss.%s",
                      deck->losses.item[k].name);
  const vs_measures *measures = t->result.watchers.measures;
  for (int k = measures->of_probes; k < measures->n_extremes; k++) {
    const vs_extreme *x = &measures->extremes[k];
    add_value(out, &x->best, vs_channel_at(&t->scene.frame, x->channel).name,
              x->sense < 0 ? "_min" : "_max");
  }
  for (size_t d = 0; t->result.watchers.devices && d < t->result.watchers.devices->count; d++) {
    const vs_watched *w = &t->result.watchers.devices->item[d];
    for (size_t k = 0; k < w->count; k++)
      vs_experiment_add(out, w->reduced[k].value.value, "%s.%s", w->device->name,
                        w->reduced[k].measure->name);
  }
}

/* What a run warns of: the most that any balance leaves over, at the end or on the way, of the work
 * of the force or of what was drawn, whichever is more. */
static double left_over(const vs_energy *e) {
  double whole = fmax(fabs(e->joule[VS_E_WORK]), fabs(e->joule[VS_E_SOURCE])), most = 0;
  for (int b = 0; b < VS_BALANCES; b++)
    if (e->balanced[b]) most = fmax(most, fabs(e->furthest_j[b]));
  return most / whole;
}

static void add_run_numbers(const vs_trial *t, const watch *w, vs_numbers *out) {
  double until = t->scene.setup.run.until_s;
  vs_experiment_add_measures(&t->scene.setup.model, &t->result, out);
  for (int k = 0; k < VS_ENERGIES; k++)
    vs_experiment_add(out, t->result.watchers.energy.joule[k], "energy.%s", vs_energy_names[k]);
  vs_experiment_add(out, left_over(&t->result.watchers.energy), "books");
  add_circuit(t, out);
  vs_experiment_add(out, w->charge_as / until, "i_mean");
  vs_experiment_add(out,
                    sqrt(t->result.watchers.energy.joule[VS_E_COPPER] /
                         t->scene.setup.model.coil.resistance_ohm / until),
                    "i_rms");
  for (int k = 0; k < VS_EXPERIMENT_LOOKS && w->experiment->look_s[k] > 0; k++)
    for (int c = 0; c < vs_channel_count(&t->scene.frame); c++)
      vs_experiment_add(out, w->seen[k][c], "%s@%g", vs_channel_at(&t->scene.frame, c).name,
                        w->experiment->look_s[k]);
  for (int n = 0; n < EVENTS; n++) {
    if (isnan(w->event_s[n])) continue;
    vs_experiment_add(out, w->event_s[n], "%s", NOTED[n].name);
    for (int c = 0; c < vs_channel_count(&t->scene.frame); c++)
      vs_experiment_add(out, w->at_event[n][c], "%s@%s", vs_channel_at(&t->scene.frame, c).name,
                        NOTED[n].name);
  }
  vs_experiment_curve_numbers(&w->curve, out);
}

vs_status vs_experiment_perform(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                                vs_error *err) {
  watch w = {.experiment = e, .also = also, .channel = -1, .event_s = {NAN, NAN}};
  const vs_observer observer = {&w, note_step_of_experiment};
  const char *sets[VS_EXPERIMENT_SETS + 1] = {NULL};
  memcpy(sets, e->sets, sizeof e->sets);
  vs_trial *t = vs_trial_run(e->scene ? e->scene : EMPTY_SCENE, e->tier, sets, &observer);
  vs_status status = t->status;
  if (status)
    *err = t->err;
  else if (t->result.ladder.rung)
    status =
        vs_fail(err, VS_RUN, "ngspice gave up on the scene as it is: %s", t->result.ladder.failed);
  else
    add_run_numbers(t, &w, out);
  vs_trial_free(t);
  vs_experiment_curve_free(&w.curve);
  return status;
}
