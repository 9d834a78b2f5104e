/* SPDX-License-Identifier: GPL-3.0-or-later
 * Threats: what a scene has to withstand, as a list. Each is one event of the scene by its name,
 * with ranges in the place of values, and a criterion of acceptance:
 *
 *   threats:                       a map, or the name of a file that is one
 *     n: 32                        cases of a threat with a continuous range; may stand in one, too
 *     seed: 7                      what their random numbers are keyed on
 *     surge: {kind: surge, angle: any, polarity: any, level: [1 kV, 2 kV], criterion: B}
 *     dip:   {kind: sag, angle: any, duration: 5 ms .. 100 ms, level: [0 %, 40 %, 70 %]}
 *     lost:  {kind: open, element: R1, from: start, criterion: B}
 *     both:  {kind: open, element: R1, from: start, with: surge}
 *
 * A case of a threat is a number for each of its ranges. It is laid over a scene as keys of that
 * scene (events.NAME, expect, and where the threat says so waive, start, run.until), so that `run`
 * with the same keys is the same case, with the same id. One threat comes at a time; `with` names
 * the one other that comes along. The scene as it is, without any, is the threat `none`, the last
 * of the list. */
#pragma once

#include "threat.h"

enum { VS_THREATS_MOST = 64 };

typedef struct vs_threats {
  vs_threat *item;
  size_t count;            /* `none` counts */
  uint64_t n, seed;        /* cases of a threat that does not say how many; see above */
  char path[VS_PATH_SIZE]; /* of a file of its own; empty: there is none */
  vs_tree file;            /* of that */
  const vs_scene *scene;   /* over which they are laid; borrowed */
} vs_threats;

/* Reads the node `threats` against a scene that is settled, and tries each threat's scene at the
 * ends of its ranges and with each of its names. The node and the scene must outlive the threats.
 * Errors with their place, each of which a check carries on from: an unknown kind, key, criterion
 * or partner; a value that the key does not take; whatever is wrong in the scene with the event,
 * such as an element that the deck does not have; criterion C in a deck without a fuse; a run that
 * ends before the threat has had its effect; a fault of the coil or the machine after the only
 * shot; a tier that judges nothing. Call vs_threats_free even then. */
vs_status vs_threats_read(const vs_node *node, const vs_scene *scene, vs_threats *threats,
                          vs_error *err);
void vs_threats_free(vs_threats *threats);

/* Lays a case over the tree of a scene like the one the threats were read with; keys of another
 * threat that was laid over it before go. The scene is then to be settled, anew or again. */
void vs_threats_put(const vs_threats *threats, const vs_threat *threat, const double *value,
                    vs_tree *tree);

/* Error: in a case's settled scene the threat begins after the run's end, or the run ends before
 * the threat has had its effect. Call it for each case: a scene whose run was made shorter would
 * hold without ever having met the threat. */
vs_status vs_threats_check(const vs_threat *threat, const vs_scene *scene, vs_error *err);

/* Writes the k-th of the keys that all cases of the threat set besides their numbers, as --set of
 * `run` takes it: "events.surge.kind=surge". False: there are no more. */
bool vs_threats_setting(const vs_threats *threats, const vs_threat *threat, size_t k,
                        vs_text *text);
