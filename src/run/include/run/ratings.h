/* SPDX-License-Identifier: GPL-3.0-or-later
 * The user's own limits: ranges that a scene allows for measures and probes. Each is a line of the
 * verdict, beside those of the deck and of its parts.
 *
 *   ratings: {stroke: 0.5 mm .. 1.5 mm, r1.power: .. 2 W, v_ak: -900 .. 900 V, p_min: -5 mm ..}
 *
 * A measure is one that the run shows (run/listed_measure.h), or a harmonic of a current whose
 * quality it tells. A probe is any channel that can be recorded; its least and its largest value
 * count. */
#pragma once

#include "base/json.h"
#include "measure/quality.h"
#include "measure/verdict.h"
#include "measure/watchers.h"

enum { VS_RATINGS_MOST = 32 };

/* What is rated, and where its value is found. */
typedef enum vs_rated_kind {
  VS_RATED_MEASURE, /* of every run: which = its slot */
  VS_RATED_EXTREME, /* of a deck's probe: which = the probe's number, part = 0 least, 1 largest */
  VS_RATED_DEVICE,  /* which = the device's number, part = the measure's among its kind's */
  VS_RATED_QUALITY, /* which = the current's number, part = the measure's (vs_quality_at) */
  VS_RATED_PROBE    /* found by its name */
} vs_rated_kind;

typedef struct vs_own_rating {
  char name[VS_JUDGED_NAME];
  vs_rating rating; /* its unit is the one it was written in; it names no probe of the deck */
  vs_rated_kind kind;
  int which, part;
  double factor; /* a value times this is the measure in SI */
} vs_own_rating;

typedef struct vs_ratings {
  vs_own_rating item[VS_RATINGS_MOST];
  int count;
} vs_ratings;

/* The word for no rating. */
extern const char vs_ratings_none[];

/* Reads the scene's key; node NULL: it has none. Errors, from each of which a check carries on: no
 * measure or probe of that name, no range, a unit of another kind, ends the wrong way round, a name
 * that stands there twice. */
vs_status vs_ratings_read(const vs_node *node, const vs_setup *setup,
                          const vs_quality_list *quality, vs_ratings *ratings, vs_error *err);

/* True if one is of the quality of a current, which the run then has to tell. */
bool vs_ratings_want_quality(const vs_ratings *ratings);

/* Before a run's first step: has its probes followed. */
void vs_ratings_follow(const vs_ratings *ratings, vs_measures *measures);

/* What a run has come to, borrowed. */
typedef struct vs_ratings_seen {
  const vs_value *values; /* vs_watchers_finish */
  const vs_watchers *watchers;
  const vs_quality *quality; /* of the scene's currents; NULL: it was not told */
  int n_quality;
  const char *no_pull_in, *lets_go; /* vs_result has them */
  double until_s;                   /* its end */
} vs_ratings_seen;

/* Adds the lines of all ratings to a verdict that was reached. The ratings must outlive it. */
void vs_ratings_judge(const vs_ratings *ratings, const vs_ratings_seen *seen, vs_verdict *verdict);

/* Adds the member "ratings" to a summary: each with its ends as they are written. */
void vs_ratings_json(const vs_ratings *ratings, vs_json *json);
/* Adds what the ratings say to a text that a run is known by. */
void vs_ratings_identify(const vs_ratings *ratings, vs_text *text);
