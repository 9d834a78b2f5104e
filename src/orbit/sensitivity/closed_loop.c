/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/closed_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "orbit/linear.h"

enum { N = VS_LINEAR_STATES };

enum { DIGITS = 12 };

/* ---- multipliers ---- */

/* Closes the loop of a model with one output. The input of what comes of it is the set point; its
 * output is the amplitude. An integral part adds the sum to the states. */
static void close_with(const vs_linear *l, double p, double i, vs_linear *loop) {
  static const double SUM_RAD = 0.01; /* a size of the sum */
  const int m = l->n, s = l->n + 1;
  loop->n = i != 0 ? s + 1 : s;
  loop->outputs = 1;
  loop->period_s = l->period_s;
  memcpy(loop->scale, l->scale, sizeof loop->scale);
  loop->scale[m] = vs_linear_signal_amplitude(&l->output[0].seen);
  loop->scale[s] = SUM_RAD;
  memset(loop->a, 0, sizeof loop->a);
  for (int row = 0; row <= m; row++) {
    const double *x = row < m ? l->a[row] : l->c[0];
    double b = row < m ? l->b[row] : l->d[0];
    memcpy(loop->a[row], x, (size_t)m * sizeof *x);
    loop->a[row][m] = b * (p + i);
    loop->a[row][s] = b;
    loop->b[row] = -b * (p + i);
  }
  loop->a[s][m] = i;
  loop->a[s][s] = 1;
  loop->b[s] = -i;
  memcpy(loop->c[0], loop->a[m], sizeof loop->c[0]);
  loop->d[0] = loop->b[m];
}

/* Finds the multipliers of a map. Returns the largest size; NaN where there are none. */
static double find_multipliers(const vs_linear *l, vs_multiplier *out) {
  double map[N * N];
  for (int i = 0; i < l->n; i++)
    for (int j = 0; j < l->n; j++) map[i * l->n + j] = l->a[i][j] * l->scale[j] / l->scale[i];
  return vs_multipliers_of(l->n, map, out) ? hypot(out[0].re, out[0].im) : NAN;
}

/* ---- the limit ---- */

static double size_at(const vs_linear *l, const vs_regulator_pi *pi, double times, bool both) {
  vs_multiplier unused[N];
  vs_linear *loop = vs_alloc(1, sizeof *loop);
  close_with(l, times * pi->proportional, (both ? times : 1) * pi->integral, loop);
  double size = find_multipliers(loop, unused);
  free(loop);
  return size;
}

/* The factor nearest to 1, above it where the loop is stable and below it where it is not, at which
 * the largest multiplier passes 1: by steps of the factor, then by bisection. */
static double limit_of(const vs_linear *l, const vs_regulator_pi *pi, bool stable, bool both) {
  enum { STEPS = 600, HALVINGS = 50 };
  double way = pow(1e3, (stable ? 1.0 : -1.0) / STEPS), lo = 1, hi = 1;
  for (int k = 0; k < STEPS; k++) {
    lo = hi;
    hi *= way;
    if ((size_at(l, pi, hi, both) < 1) == stable) continue;
    for (int n = 0; n < HALVINGS; n++) {
      double mid = sqrt(lo * hi);
      if ((size_at(l, pi, mid, both) < 1) == stable)
        lo = mid;
      else
        hi = mid;
    }
    return hi;
  }
  return NAN;
}

/* ---- where it comes to rest ---- */

typedef struct search {
  vs_scene *scene; /* at the angle that is tried */
  vs_orbit orbit;
  vs_linear linear;
  vs_linear_signal_order sensor;
  double unit; /* of the sensor's channel */
} search;

/* Finds orbit and linear model at an angle. */
static vs_status try_angle(search *s, double angle_rad, vs_error *err) {
  double from[VS_ORBIT_STATES];
  vs_error why = {0};
  memcpy(from, s->orbit.x, sizeof from);
  const vs_shooting how = {.periods = 1, .from = from, .quietly = true};
  s->scene->setup.timeline.firing.angle = (vs_field_profile){.first = angle_rad};
  vs_status status = vs_shooting_seek(s->scene, &how, &s->orbit, &why);
  if (status) status = vs_shooting_find(s->scene, 1, &s->orbit, err);
  return status ? status : vs_linear_find(s->scene, &s->orbit, &s->sensor, 1, &s->linear, err);
}

/* Newton's iteration for the angle. With an integral part the amplitude is the one wanted; without,
 * angle = start + P (m - wanted). */
static vs_status find_rest_of_loop(search *s, const double limits[2], vs_closed_loop *c,
                                   vs_error *err) {
  enum { ITERATIONS = 40 };
  static const double CLOSED = 1e-9; /* of the angle, rad */
  const vs_regulator_pi *pi = &c->pi;
  double gain[VS_LINEAR_OUTPUTS];
  double angle = fmin(fmax(pi->start_rad, limits[0]), limits[1]);
  for (int k = 0; k < ITERATIONS; k++) {
    vs_status status = try_angle(s, angle, err);
    if (!status) status = vs_linear_gain(&s->linear, gain, err);
    if (status) return status;
    c->gain = gain[0] * s->unit;
    c->amplitude = s->unit * vs_linear_signal_amplitude(&s->linear.output[0].seen);
    double off = c->amplitude - pi->wanted;
    double step = pi->integral != 0 ? -off / c->gain
                                    : (pi->start_rad + pi->proportional * off - angle) /
                                          (1 - pi->proportional * c->gain);
    double next = fmin(fmax(angle + step, limits[0]), limits[1]);
    c->angle_rad = angle;
    if (fabs(step) <= CLOSED) return VS_OK;
    if (next == angle) break;
    angle = next;
  }
  return vs_fail(err, VS_RUN,
                 "no angle from %.6g to %.6g deg keeps the set point: at %.6g deg the sensor shows "
                 "%.6g %s, and %.6g are wanted",
                 limits[0] / vs_units_factor("deg"), limits[1] / vs_units_factor("deg"),
                 c->angle_rad / vs_units_factor("deg"), c->amplitude / s->unit, c->unit,
                 pi->wanted / s->unit);
}

/* ---- a step of the set point ---- */

/* Follows the amplitude for as long as a minute, or until all modes that count have decayed. */
static void find_step(vs_closed_loop *c) {
  static const double NEAR = 0.01, LONGEST_S = 60;
  double end = c->modes.gain[0], largest = 0;
  int settled = 0, longest = (int)(LONGEST_S / c->period_s);
  for (int k = 0; k < longest; k++) {
    double part = vs_averaged_step(&c->modes, 0, k) / end;
    largest = fmax(largest, part - 1);
    if (fabs(part - 1) > NEAR) settled = k + 1;
  }
  c->overshoot = largest;
  c->settles_s = settled < longest ? settled * c->period_s : NAN;
}

static vs_status close_loop(search *s, const double limits[2], vs_closed_loop *c, vs_error *err) {
  vs_status status = find_rest_of_loop(s, limits, c, err);
  if (status) return status;
  /* the control's P and I are per SI, the model's output is in the channel's unit */
  const vs_regulator_pi own = {.proportional = c->pi.proportional * s->unit,
                               .integral = c->pi.integral * s->unit};
  vs_linear *loop = vs_alloc(1, sizeof *loop);
  vs_error why = {0};
  close_with(&s->linear, own.proportional, own.integral, loop);
  c->n = loop->n;
  c->period_s = loop->period_s;
  double largest = find_multipliers(loop, c->multiplier);
  c->stable = largest < 1;
  c->answers = c->stable && (own.proportional != 0 || own.integral != 0) &&
               !vs_averaged_find(loop, &c->modes, &why);
  free(loop);
  if (isnan(largest)) return vs_fail(err, VS_RUN, "the closed loop's multipliers cannot be found");
  if (c->answers) find_step(c);
  c->both_times = limit_of(&s->linear, &own, c->stable, true);
  c->proportional_times =
      own.proportional != 0 ? limit_of(&s->linear, &own, c->stable, false) : NAN;
  return VS_OK;
}

vs_status vs_closed_loop_find(const vs_scene *scene, const vs_regulator *regulator,
                              const vs_orbit *orbit, vs_closed_loop *c, vs_error *err) {
  if (scene->control.sensor >= scene->instruments.count)
    return vs_fail(err, VS_RUN, "its sensor is an observer's estimate");
  const vs_instrument *i = &scene->instruments.item[scene->control.sensor];
  const vs_control_input sight = {.v = &scene->control.v,
                                  .setup = &scene->setup,
                                  .instruments = &scene->instruments,
                                  .sensor = scene->control.sensor};
  search *s = vs_alloc(1, sizeof *s);
  *c = (vs_closed_loop){
      .unit = i->unit, .pi = regulator->pi(&sight), .settles_s = NAN, .overshoot = NAN};
  snprintf(c->sensor, sizeof c->sensor, "%s", i->name);
  s->scene = vs_alloc(1, sizeof *s->scene);
  *s->scene = *scene;
  s->scene->control.regulator = NULL; /* orbits of one angle each */
  s->scene->frame = vs_sim_frame(scene->tier, &s->scene->setup);
  s->orbit = *orbit;
  s->unit = vs_units_factor(i->unit);
  s->sensor = (vs_linear_signal_order){.channel = i->channel,
                                       .bandwidth_hz = i->v.bandwidth_hz,
                                       .order = i->v.order,
                                       .damping = i->v.damping};
  snprintf(s->sensor.name, sizeof s->sensor.name, "%s", i->name);
  vs_status status = close_loop(s, scene->control.v.angle_rad, c, err);
  free(s->scene);
  free(s);
  return status;
}

/* ---- what is shown of it ---- */

static void print_limit(double times, const char *what, FILE *out) {
  if (isnan(times))
    fprintf(out, "; with %s from 0.001 to 1000 times as large that stays so", what);
  else
    fprintf(out, "; with %s %.5g times as large it is 1", what, times);
}

void vs_closed_loop_print(const vs_closed_loop *c, FILE *out) {
  double degree = vs_units_factor("deg"), unit = vs_units_factor(c->unit);
  double largest = hypot(c->multiplier[0].re, c->multiplier[0].im);
  fprintf(
      out,
      "control  the sensor %s comes to rest where it shows %.6g %s, fired at %.6g deg; a degree "
      "makes %.4g %s of it\n",
      c->sensor, c->amplitude / unit, c->unit, c->angle_rad / degree, c->gain * degree / unit,
      c->unit);
  fprintf(out, "closed loop  %s: the size of the largest multiplier is %.6g",
          c->stable ? "stable" : "unstable", largest);
  if (c->stable) fprintf(out, ", which decays in %.4g s", -c->period_s / log(largest));
  print_limit(c->both_times, "both gains", out);
  if (c->pi.proportional != 0 && c->pi.integral != 0)
    print_limit(c->proportional_times, "the proportional one alone", out);
  if (c->answers)
    fprintf(out, "\nset point  a small step of it overshoots by %.3g %%", 100 * c->overshoot);
  if (c->answers && !isnan(c->settles_s))
    fprintf(out, " and settles to 1 %% in %.3g s", c->settles_s);
  else if (c->answers)
    fputs(" and does not settle to 1 % within a minute", out);
  fprintf(out, "\n%-10s %15s %15s %15s%s\n", "multiplier", "re", "im", "size",
          c->answers ? "   share in that step" : "");
  for (int k = 0; k < c->n; k++) {
    fprintf(out, "%-10d %15.9g %15.9g %15.9g", k + 1, c->multiplier[k].re, c->multiplier[k].im,
            hypot(c->multiplier[k].re, c->multiplier[k].im));
    if (c->answers) fprintf(out, "   %.4g", cabs(c->modes.share[0][k] / c->modes.gain[0]));
    fputc('\n', out);
  }
  fputs("small deviations alone; the times of samples, noise and the A/D are left out\n\n", out);
}

void vs_closed_loop_json(const vs_closed_loop *c, vs_json *json) {
  vs_json_object(json, "closed_loop", VS_JSON_LINES);
  vs_json_text(json, "sensor", c->sensor);
  vs_json_number(json, "angle_deg", c->angle_rad / vs_units_factor("deg"), DIGITS);
  vs_json_number(json, "amplitude", c->amplitude, DIGITS);
  vs_json_number(json, "gain_per_deg", c->gain * vs_units_factor("deg"), DIGITS);
  vs_json_bool(json, "stable", c->stable);
  vs_json_number(json, "limit_both_times", c->both_times, DIGITS);
  vs_json_number(json, "limit_proportional_times", c->proportional_times, DIGITS);
  vs_json_number(json, "overshoot", c->overshoot, 6);
  vs_json_number(json, "settles_s", c->settles_s, 6);
  vs_json_array(json, "multipliers", VS_JSON_LINES);
  for (int k = 0; k < c->n; k++) {
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_number(json, "re", c->multiplier[k].re, DIGITS);
    vs_json_number(json, "im", c->multiplier[k].im, DIGITS);
    double share = c->answers ? cabs(c->modes.share[0][k] / c->modes.gain[0]) : NAN;
    vs_json_number(json, "share", share, 6);
    vs_json_end(json);
  }
  vs_json_end(json);
  vs_json_end(json);
}
