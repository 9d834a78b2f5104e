/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "corners.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "run/session.h"

/* The line that breaks the verdict; else the weakest. NULL: nothing is rated. */
static void keep_worst(const vs_verdict *v, vs_corner *corner) {
  const vs_judgement *breach = vs_verdict_breach(v), *j = breach ? breach : v->weakest;
  *corner = (vs_corner){.margin = NAN, .error = NAN, .breaks = breach};
  if (!j) return;
  vs_verdict_name(j, corner->line);
  corner->margin = j->margin;
  corner->error = j->margin_error;
  corner->word = vs_verdict_word(j);
}

/* True where a is worse than b: violated before undecided before held before what has no line; then
 * by the margin, of which one that is not known is the worst. */
static bool is_worse(const vs_corner *a, const vs_corner *b) {
  const vs_corner *both[] = {a, b};
  int rank[2];
  for (int k = 0; k < 2; k++)
    rank[k] = !*both[k]->line ? 0 : !both[k]->breaks ? 1 : both[k]->word == VS_UNDECIDED ? 2 : 3;
  if (rank[0] != rank[1]) return rank[0] > rank[1];
  return rank[0] && (a->margin < b->margin || (isnan(a->margin) && !isnan(b->margin)));
}

static vs_status read_corner(const vs_corners_order *o, const char *tier, const vs_spreads *spread,
                             size_t k, vs_scene *scene, vs_error *err) {
  char text[VS_KEY_SIZE + 64];
  vs_status status = vs_scene_open(o->scene, (vs_where){0}, scene, err);
  for (size_t n = 0; n < o->n_sets && !status; n++)
    status = vs_tree_set(&scene->tree, o->sets[n], err);
  for (size_t n = 0; n < spread->count && !status; n++) {
    snprintf(text, sizeof text, "%s=%.12g %s", spread->item[n].key, vs_key_spread_at(spread, n, k),
             spread->item[n].unit);
    status = vs_tree_set(&scene->tree, text, err);
  }
  if (!status) status = vs_scene_settle(scene, tier, err);
  scene->allow_code = o->allow_code;
  return status ? status : vs_control_allow(&scene->control, o->allow_code, err);
}

/* Refuses corners that cannot be read, before any is run: input that is wrong at one end only. */
static vs_status read_all(const vs_corners_order *o, const char *tier, const vs_corners *c,
                          vs_error *err) {
  char at[1024];
  vs_status status = VS_OK;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  for (size_t k = 0; k < c->count && !status; k++) {
    vs_error why = {0};
    status = read_corner(o, tier, &c->spread, k, scene, &why);
    vs_scene_free(scene);
    if (status)
      vs_fail(err, status, "%.*sthe corner %s: %s", why.place_size, why.text,
              vs_result_corner(c, k, at, sizeof at), why.text + why.place_size);
  }
  free(scene);
  return status;
}

/* Runs a corner. Error: VS_SIGNAL. A run that fails is noted, and the others go on. */
static vs_status run_corner(const vs_corners_order *o, const char *tier, vs_corners *c, size_t k,
                            vs_error *err) {
  const vs_session session = {.verify = true, .steady = o->steady, .stop = o->stop};
  vs_corner *corner = &c->item[k];
  vs_error why = {0};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_status status = read_corner(o, tier, &c->spread, k, scene, &why);
  if (!status) status = vs_session_run(&session, scene, result, &why);
  if (!status && result->second.stopped) status = vs_fail(&why, VS_SIGNAL, "stopped by a signal");
  if (!status) keep_worst(&result->verdict, corner);
  vs_result_free(result);
  free(result);
  vs_scene_free(scene);
  free(scene);
  if (status == VS_SIGNAL) return vs_fail(err, status, "%s", why.text);
  if (!status) return VS_OK;
  *corner = (vs_corner){.margin = NAN, .error = NAN};
  snprintf(corner->failed, sizeof corner->failed, "%.*s", (int)sizeof corner->failed - 1, why.text);
  c->failed++;
  return VS_OK;
}

vs_status vs_corners_run(const vs_corners_order *o, const vs_scene *nominal, vs_corners *c,
                         vs_error *err) {
  vs_status status = vs_key_spreads(nominal, &c->spread, err);
  const bool shows = !o->quiet && isatty(STDERR_FILENO);
  const char *tier = nominal->tier->name;
  c->count = status ? 0 : (size_t)1 << c->spread.spreads;
  c->held = c->failed = 0;
  c->worst = c->count;
  if (!status) status = read_all(o, tier, c, err);
  for (size_t k = 0; k < c->count && !status; k++) {
    vs_corner *corner = &c->item[k];
    if (shows) dprintf(STDERR_FILENO, "\rcorner %zu of %zu \033[K", k + 1, c->count);
    status = run_corner(o, tier, c, k, err);
    if (status || !*corner->line) continue;
    if (!corner->breaks) c->held++;
    if (c->worst == c->count || is_worse(corner, &c->item[c->worst])) c->worst = k;
  }
  if (shows) dprintf(STDERR_FILENO, "\r\033[K");
  return status;
}
