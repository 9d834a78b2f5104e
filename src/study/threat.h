/* SPDX-License-Identifier: GPL-3.0-or-later
 * One threat of a list (study/threats.h), and its cases as numbers. */
#pragma once

#include "run/axis.h"

/* At most: ranges of a threat; numbers of a case, which has those of `with` besides. */
enum { VS_THREAT_RANGES = 12, VS_THREAT_NUMBERS = 2 * VS_THREAT_RANGES };

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
  const char *text;             /* what happens, one line */
  const vs_event_kind *kind;    /* NULL: it is `none` */
  const struct vs_threat *with; /* NULL: it comes alone */
  int criterion;                /* its number (measure/expect.h) */
  vs_where criterion_where;
  uint64_t n;                      /* cases of it, where a range is continuous */
  vs_axis range[VS_THREAT_RANGES]; /* `field` is the event's, `key` is "events.NAME.KEY" */
  size_t n_ranges;
  vs_threat_setting *setting;
  size_t n_settings;
  const vs_node *live;  /* the devices that are judged; NULL: all */
  const vs_node *start; /* "rest" or "steady"; NULL: as the scene begins */
  double until_s;       /* run.until; NaN: the scene's */
  int first_cycle;      /* in which it comes, as that of the first firing; 0: it says when */
} vs_threat;

/* A case's numbers: how many, and which range the k-th belongs to: its own first, then those of
 * `with`. */
size_t vs_threat_numbers(const vs_threat *threat);
const vs_axis *vs_threat_range(const vs_threat *threat, size_t k);

/* The value of a range at the share u of it, 0 to 1. The values of a list have equal shares. */
double vs_threat_value(const vs_axis *range, double u);

/* How many combinations of listed values the threat has; 1 where it has no list. A continuous range
 * has none. */
uint64_t vs_threat_combinations(const vs_threat *threat);
/* True if the combinations are all there is: no range is continuous. */
bool vs_threat_is_closed(const vs_threat *threat);

/* All three write value[vs_threat_numbers], the numbers of a case. This one is of combination
 * `index`; a continuous range gets its middle. */
void vs_threat_listed(const vs_threat *threat, uint64_t index, double *value);
/* A random and independent case: a function of seed, the threat's name, its keys and index alone.
 */
void vs_threat_draw(const vs_threat *threat, uint64_t seed, uint64_t index, double *value);
/* The index-th of `count` cases that cut each continuous range into `count` pieces and have one in
 * each. The combinations take turns. */
void vs_threat_stratum(const vs_threat *threat, uint64_t seed, uint64_t index, uint64_t count,
                       double *value);

/* Returns the number by which random numbers of something of that name are keyed. */
uint64_t vs_threat_key(const char *name, const char *key);
