/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/ladder.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/pace.h"
#include "netlist/devices.h"

/* Why each rung may help:
 * - In a first step of picoseconds, behind the source's inductance alone, rounding errors may be
 *   larger than what Newton's iteration has to reach. So on all rungs the first step is longer.
 * - Where voltages of 600 V and steps of picoseconds meet, rounding errors may grow beyond what
 *   Newton's iteration has to reach. With another order of elimination they may not, and nothing
 *   else changes.
 * - Gear's rule damps what rings behind a junction.
 * - In a shorter step Newton's iteration may still find an end.
 * - With a larger trtol ngspice accepts steps whose truncation error it cannot get down by
 *   shortening them. Their length is then given by the largest step, which is why that is a
 *   quarter.
 * - Newton's iteration may have to end within what rounding leaves: behind an inductance alone, a
 *   step of picoseconds makes volts of the last digit of its current. So the tolerance goes back to
 *   where the solver's own is the coarsest (engine/coupled/pace.c). The steps stay as short as they
 * were. What may be wrong is then told for that tolerance.
 * - Where the model of the thyristor has no solution, an ideal thyristor has one.
 * - What tier compiled gives up, ngspice may solve: the only rung of that tier. */
typedef struct rung {
  const char *text;
  bool other_order, gear, quarter, loose, coarse, ideal, ngspice;
} rung;
static const rung RUNGS[] = {
    {.text = "the scene as it is"},
    {.text = "another order of elimination (pivrel 0.001)", .other_order = true},
    {.text = "method gear", .gear = true},
    {.text = "method gear, a quarter of the step", .gear = true, .quarter = true},
    {.text = "method gear, a quarter of the step, trtol 100",
     .gear = true,
     .quarter = true,
     .loose = true},
    {.text = "tolerance 1e-4 with the same steps", .coarse = true},
    {.text = "an ideal thyristor (latch), method gear", .gear = true, .ideal = true},
    {.text = "tier circuit, in ngspice", .ngspice = true},
};
static const double OTHER_PIVREL = 1e-3;     /* ngspice's default */
static const double COARSE_TOLERANCE = 1e-4; /* as the rung's text says */
enum { N_RUNGS = sizeof RUNGS / sizeof *RUNGS };

const char *vs_ladder_text(int number) {
  return RUNGS[number].text;
}

/* The deck's parameter for its thyristor, if that is not ideal already. */
static bool can_be_ideal(const vs_setup *s) {
  for (size_t k = 0; k < s->deck.n_parts; k++)
    if (!strcmp(s->deck.parts[k].name, "thyristor"))
      return strcmp(s->deck.parts[k].subcircuit, "latch") != 0;
  return false;
}

bool vs_ladder_stopped_short(const vs_scene *scene) {
  return scene->tier->by_ngspice && scene->setup.run.ladder == VS_LADDER_CLIMB &&
         can_be_ideal(&scene->setup);
}

static void add_rung_key(vs_ladder *l, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void add_rung_key(vs_ladder *l, const char *format, ...) {
  va_list values;
  va_start(values, format);
  vsnprintf(l->keys[l->n_keys++], sizeof l->keys[0], format, values);
  va_end(values);
}

bool vs_ladder_climb(vs_ladder *l, const vs_scene *scene) {
  const vs_setup *s = &scene->setup;
  const bool compiled = !scene->tier->by_ngspice;
  if (!scene->tier->has_circuit || s->run.ladder == VS_LADDER_STAY) return false;
  if (l->rung == 0) {
    l->gear = s->run.gear;
    l->own_step_s = vs_pace_largest_step(s);
    l->step_s = l->own_step_s / (s->run.gear || s->run.max_step_s > 0 ? 1 : 2);
    l->tolerance = s->run.tolerance;
    l->trtol = s->run.trtol;
    l->pivrel = s->run.pivrel;
  }
  const double first_step = VS_SETUP_LONGER_FIRST_STEP;
  bool jumps = !compiled && vs_timeline_voltage(&s->timeline, 0) != 0;
  for (l->rung++; l->rung < N_RUNGS; l->rung++) {
    const rung *r = &RUNGS[l->rung];
    bool other = (r->other_order && l->pivrel != OTHER_PIVREL) || (r->gear && !l->gear) ||
                 r->quarter || (r->coarse && l->tolerance < COARSE_TOLERANCE) || r->ideal ||
                 r->ngspice;
    if (!other || r->ngspice != compiled ||
        (r->ideal && (s->run.ladder != VS_LADDER_IDEAL || !can_be_ideal(s))))
      continue;
    l->n_keys = 0;
    if (r->gear) add_rung_key(l, "run.method=gear");
    if (r->other_order) add_rung_key(l, "run.pivrel=%.9g", OTHER_PIVREL);
    if (r->quarter) add_rung_key(l, "run.max_step=%.9gus", 1e6 * l->step_s / 4);
    if (r->loose) add_rung_key(l, "run.trtol=%.9g", fmax(100, l->trtol));
    if (r->coarse) {
      add_rung_key(l, "run.tolerance=%.9g", COARSE_TOLERANCE);
      add_rung_key(l, "run.max_step=%.9gus", 1e6 * l->own_step_s);
    }
    if (r->ideal) add_rung_key(l, "circuit.thyristor=latch");
    if (r->ngspice) add_rung_key(l, "run.tier=%s", vs_tiers_circuit());
    if (jumps && s->run.first_step < first_step) add_rung_key(l, "run.first_step=%.9g", first_step);
    return true;
  }
  return false;
}

/* ---- limits ---- */

/* The file of the part that the ladder replaces; NULL: there is none. */
static const char *thyristor_file(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_parts; k++)
    if (!strcmp(deck->parts[k].name, "thyristor")) return deck->parts[k].file;
  return NULL;
}

static bool is_limit_of_file(const vs_limit *limit, const char *file) {
  return file && !strcmp(limit->where.file, file);
}

/* Gives the deck with the ideal thyristor the ratings of the scene's own deck, and the limits of
 * the part it stands for: an ideal thyristor has none to be held against. */
static void give_limits(const vs_deck *from, vs_deck *to) {
  const char *own = thyristor_file(from), *ideal = thyristor_file(to);
  size_t n = 0;
  to->n_ratings = from->n_ratings;
  memcpy(to->ratings, from->ratings, sizeof to->ratings);
  for (size_t k = 0; k < to->n_limits; k++)
    if (!is_limit_of_file(&to->limits[k], ideal)) to->limits[n++] = to->limits[k];
  for (size_t k = 0; k < from->n_limits && n < VS_DECK_LIMITS; k++) {
    if (!is_limit_of_file(&from->limits[k], own)) continue;
    to->limits[n] = from->limits[k];
    to->limits[n++].where = (vs_where){.file = ideal};
  }
  to->n_limits = n;
  vs_devices_hold(to);
}

vs_status vs_ladder_scene(const vs_ladder *l, const vs_scene *scene, vs_scene *other,
                          vs_error *err) {
  const char *keys[VS_LADDER_KEYS];
  for (size_t k = 0; k < l->n_keys; k++) keys[k] = l->keys[k];
  vs_status status = vs_scene_with(scene, keys, l->n_keys, other, err);
  if (RUNGS[l->rung].ngspice)
    snprintf(other->why, sizeof other->why, "rung %d of the ladder", l->rung);
  if (!status && RUNGS[l->rung].ideal) give_limits(&scene->setup.deck, &other->setup.deck);
  return status;
}
