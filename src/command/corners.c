/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "command/corners.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "scene/session.h"
#include "steady/steady.h"

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

/* True where a is worse than b: violated before undecided before held, then by the margin. */
static bool is_worse(const vs_corner *a, const vs_corner *b) {
  const bool a_violated = a->breaks && a->word != VS_UNDECIDED,
             b_violated = b->breaks && b->word != VS_UNDECIDED;
  if (a_violated != b_violated) return a_violated;
  if (a->breaks != b->breaks) return a->breaks;
  return a->margin < b->margin;
}

static vs_status read_corner(const vs_corners_order *o, const char *tier, const vs_spreads *spread,
                             size_t k, vs_scene *scene, vs_error *err) {
  char text[VS_KEY_SIZE + 64];
  vs_status status = vs_scene_open(o->scene, (vs_where){0}, scene, err);
  for (size_t n = 0; n < o->n_sets && !status; n++)
    status = vs_tree_set(&scene->tree, o->sets[n], err);
  for (size_t n = 0; n < spread->count && !status; n++) {
    snprintf(text, sizeof text, "%s=%.12g %s", spread->item[n].key,
             spread->item[n].value[k >> n & 1], spread->item[n].unit);
    status = vs_tree_set(&scene->tree, text, err);
  }
  if (!status) status = vs_scene_settle(scene, tier, err);
  scene->allow_code = o->allow_code;
  return status ? status : vs_control_allow(&scene->control, o->allow_code, err);
}

static vs_status run_corner(const vs_corners_order *o, const char *tier, const vs_spreads *spread,
                            size_t k, vs_corner *corner, vs_error *err) {
  const vs_session session = {.verify = true, .steady = vs_steady_start, .stop = o->stop};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_status status = read_corner(o, tier, spread, k, scene, err);
  if (!status) status = vs_session_run(&session, scene, result, err);
  if (!status && result->second.stopped) status = vs_fail(err, VS_SIGNAL, "stopped by a signal");
  if (!status) keep_worst(&result->verdict, corner);
  vs_result_free(result);
  free(result);
  vs_scene_free(scene);
  free(scene);
  return status;
}

vs_status vs_corners_run(const vs_corners_order *o, const vs_scene *nominal, vs_corners *c,
                         vs_error *err) {
  char at[1024];
  vs_status status = vs_key_spreads(nominal, &c->spread, err);
  const bool shows = !o->quiet && isatty(STDERR_FILENO);
  c->count = status ? 0 : (size_t)1 << c->spread.count;
  c->held = c->worst = 0;
  for (size_t k = 0; k < c->count && !status; k++) {
    vs_error why = {0};
    if (shows) dprintf(STDERR_FILENO, "\rcorner %zu of %zu \033[K", k + 1, c->count);
    status = run_corner(o, nominal->tier->name, &c->spread, k, &c->item[k], &why);
    if (status)
      status = vs_fail(err, status, "the corner %s: %s", vs_result_corner(c, k, at, sizeof at),
                       why.text);
    else if (!c->item[k].breaks)
      c->held++;
    if (!status && is_worse(&c->item[k], &c->item[c->worst])) c->worst = k;
  }
  if (shows) dprintf(STDERR_FILENO, "\r\033[K");
  return status;
}
