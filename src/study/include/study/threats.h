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
#ifndef VS_STUDY_THREATS_H
#define VS_STUDY_THREATS_H

#include "run/axis.h"

/* At most: threats; ranges of one; numbers of a case, which has those of `with` besides. */
enum { VS_THREATS_MOST = 64, VS_THREAT_RANGES = 12, VS_THREAT_NUMBERS = 2 * VS_THREAT_RANGES };

/* A key of the scene with its one value: a node of the threats' file, or a text. */
typedef struct vs_threat_setting {
  char key[VS_KEY_SIZE]; /* "events.surge.level" */
  const vs_node *node;   /* NULL: it is `text` */
  char text[VS_NAME_SIZE];
  vs_where where;
} vs_threat_setting;

typedef struct vs_threat {
  char name[VS_EVENT_NAME];
  vs_where where;
  const char *text;                /* what happens, one line */
  const vs_event_kind *kind;       /* NULL: it is `none` */
  const struct vs_threat *with;    /* NULL: it comes alone */
  int criterion;                   /* its number (measure/expect.h) */
  uint64_t n;                      /* cases of it, where a range is continuous */
  vs_axis range[VS_THREAT_RANGES]; /* `field` is the event's, `key` is "events.NAME.KEY" */
  size_t n_ranges;
  vs_threat_setting *setting;
  size_t n_settings;
  const vs_node *live;  /* the devices that are judged; NULL: all */
  const vs_node *start; /* "rest" or "steady"; NULL: as the scene begins */
  double until_s;       /* run.until; NaN: the scene's */
} vs_threat;

typedef struct vs_threats {
  vs_threat *item;
  size_t count; /* `none` counts */
  uint64_t seed;
  char path[VS_PATH_SIZE]; /* of a file of its own; empty: there is none */
  vs_tree file;            /* of that */
  const vs_scene *scene;   /* over which they are laid; borrowed */
} vs_threats;

/* Reads the node `threats` against a scene that is settled, and tries each threat's scene at the
 * ends of its ranges and with each of its names. The node and the scene must outlive the threats.
 * Errors with their place, each of which a check carries on from: an unknown kind, key, criterion
 * or partner; a value that the key does not take; everything that the event's scene is wrong in, as
 * an element that the deck has not; criterion C where no fuse is; a run that ends before the threat
 * has had its effect; a short of a coil without current. vs_threats_free even then. */
vs_status vs_threats_read(const vs_node *node, const vs_scene *scene, vs_threats *threats,
                          vs_error *err);
void vs_threats_free(vs_threats *threats);

/* The threat of that name; NULL: there is none. */
const vs_threat *vs_threats_named(const vs_threats *threats, const char *name);

/* A case's numbers: how many, and which range the k-th belongs to: its own first, then those of
 * `with`. */
size_t vs_threat_numbers(const vs_threat *threat);
const vs_axis *vs_threat_range(const vs_threat *threat, size_t k);

/* How many combinations of listed values the threat has; 1 where it has no list. A continuous range
 * has none. */
uint64_t vs_threat_combinations(const vs_threat *threat);
/* True if the combinations are all there is: no range is continuous. */
bool vs_threat_is_closed(const vs_threat *threat);

/* Writes value[vs_threat_numbers] of a case:
 *   listed  of combination `index`; a continuous range gets its middle
 *   draw    random and independent: a function of seed, the threat's name, its keys and index alone
 *   stratum the index-th of `count` cases that cut each continuous range into `count` pieces and
 * have one in each; the combinations take turns at      at the shares u[] of the ranges, each 0 to
 * 1: of a list each value has as much of it */
void vs_threat_listed(const vs_threat *threat, uint64_t index, double *value);
void vs_threat_draw(const vs_threat *threat, uint64_t seed, uint64_t index, double *value);
void vs_threat_stratum(const vs_threat *threat, uint64_t seed, uint64_t index, uint64_t count,
                       double *value);
void vs_threat_at(const vs_threat *threat, const double *u, double *value);

/* Lays a case over the tree of a scene like the one the threats were read with; keys of another
 * threat that was laid over it before go. The scene is then to be settled, anew or again. */
void vs_threats_put(const vs_threats *threats, const vs_threat *threat, const double *value,
                    vs_tree *tree);

/* Error: of the case that the settled scene has, the threat is not built, as it would begin behind
 * the run's end, or it would not have had its effect by then. Call it for each case: a scene whose
 * run was made shorter would hold without ever having met the threat. */
vs_status vs_threats_check(const vs_threat *threat, const vs_scene *scene, vs_error *err);

/* Writes the case as people say it, "surge: angle 41.2 deg, level 1 kV". */
void vs_threat_write(const vs_threat *threat, const double *value, vs_text *text);

/* Writes the k-th of the keys that all cases of the threat set besides their numbers, as --set of
 * `run` takes it: "events.surge.kind=surge". False: there are no more. */
bool vs_threats_setting(const vs_threats *threats, const vs_threat *threat, size_t k,
                        vs_text *text);

/* Returns the number by which random numbers of something of that name are keyed. */
uint64_t vs_threats_key(const char *name, const char *key);

#endif
