/* SPDX-License-Identifier: GPL-3.0-or-later
 * The deck's ratings held against what its probes did in a run, and the limits of its parts against
 * what was measured of its devices. */
#ifndef VS_WATCH_VERDICT_H
#define VS_WATCH_VERDICT_H

#include "watch/devices.h"
#include "watch/measures.h"

typedef struct vs_judgement {
  const vs_rating *rating; /* with its probe; NULL: it is of a device */
  const vs_probe *probe;
  const vs_device *device; /* with its measure and limit; NULL: it is of a rating */
  const vs_device_measure *measure;
  const vs_limit *limit;
  const vs_device *ward;   /* whose limit it is, where that is another device's; else NULL */
  vs_value least, largest; /* of the probe in the run */
  double room[2]; /* what is left to the lower and to the upper end, as parts of them; INFINITY: no
                     such end, or it is 0 and not passed; of a passed 0 a part of the range */
  double margin;  /* the lesser of the two; < 0: beyond */
  double margin_error; /* numerical error of the margin, a part as it is; NAN: not computed */
  vs_value stress;     /* the extreme that is nearer to its limit, or further beyond; SI */
  double spread;       /* times a relative error of the run is an error of the margin besides */
  double failed_s;     /* when the limit was first passed; NaN: it was not */
} vs_judgement;

enum { VS_MOST_JUDGEMENTS = VS_DECK_MOST + VS_DECK_DEVICES * VS_KIND_LIMITS };
typedef struct vs_verdict {
  vs_judgement item[VS_MOST_JUDGEMENTS]; /* the ratings, then device by device */
  size_t count;
  const vs_judgement
      *weakest; /* of the least finite margin, less its error where that is known; NULL: none */
  const vs_judgement *first_to_fail; /* NULL: none failed; never what another lets through */
} vs_verdict; /* of two alike the later one, so that a device goes before a probe */

/* Judges a run; devices may be NULL. Nothing is judged on a tier without a deck, of which neither
 * has any. A device of which nothing was measured is not judged. */
void vs_verdict_reach(const vs_measures *measures, const vs_devices *devices, vs_verdict *verdict);

/* What a line of a verdict comes to. */
typedef enum vs_word {
  VS_HELD,      /* the margin is above 0 by more than its error */
  VS_VIOLATED,  /* below 0 by more than its error */
  VS_UNDECIDED, /* its sign is not certain */
  VS_UNVERIFIED /* no error was computed */
} vs_word;
extern const char *const vs_words[]; /* by vs_word */
vs_word vs_judgement_word(const vs_judgement *judgement);
/* Is there a line that is violated, verified or not, or undecided? The one with the least margin
 * among the violated, else among the undecided; NULL: none. */
const vs_judgement *vs_verdict_breach(const vs_verdict *verdict);

/* Gives each line its margin's error: twice what the verdict of a second run of the same scene at
 * another tolerance differs by, and what every number of this run may be wrong by besides, as a
 * part of itself or of its limit (resolution). A line that the second run has not gets an infinite
 * error, and is undecided. */
void vs_verdict_compare(vs_verdict *verdict, const vs_verdict *second, double resolution);

/* "v_ak", "thyristor.i2t" */
enum { VS_JUDGED_NAME = VS_DECK_NAME + 24 };
const char *vs_judgement_name(const vs_judgement *judgement, char name[VS_JUDGED_NAME]);
/* The unit that stress and limits are shown in: as they were written. */
const char *vs_judgement_unit(const vs_judgement *judgement);

#endif
