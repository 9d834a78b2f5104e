/* SPDX-License-Identifier: GPL-3.0-or-later
 * The verdict on a run: the deck's ratings held against what its probes did, and the limits of its
 * parts held against what was measured of its devices. */
#ifndef VS_WATCH_VERDICT_H
#define VS_WATCH_VERDICT_H

#include "stress/devices.h"
#include "watch/measures.h"

/* One line of a verdict: a rating of a probe, or a limit of a device's part. Values are in SI.
 * Everything it points to belongs to the deck. */
typedef struct vs_judgement {
  const vs_rating *rating; /* NULL: the line is of a device */
  const vs_probe *probe;   /* of the rating */
  const vs_device *device; /* NULL: the line is of a rating */
  const vs_device_measure *measure;
  const vs_limit *limit;
  const vs_device *ward; /* the device whose limit this is, where that is another one; else NULL */
  vs_value least, largest; /* of the probe in the run */
  double room[2]; /* what is left to the lower and to the upper end, as a part of that end. Beyond
                     an end of 0 it is a part of the range. INFINITY: there is no such end, or it is
                     0 and was not passed */
  double margin;  /* the lesser of the two; below 0 the limit was passed */
  double margin_error; /* numerical error of the margin, in the margin's own scale; INFINITY: it
                          could not be found; NaN: it was not computed */
  vs_value stress;     /* the extreme that is nearer to its limit, or further beyond it */
  bool hangs;          /* on the sequence of the device's firings */
  bool torn;           /* that is another one in a second run: undecided for its sake */
  bool makes_fire;     /* near the limit the device may fire without its gate */
  bool is_rate;        /* the measure is a rate over a short time */
  double doubt;        /* the margin may be wrong by this besides */
  double spread;   /* sensitivity: a relative error e of the run changes the margin by e spread */
  double failed_s; /* instant at which the limit was first passed; NaN: it was not */
} vs_judgement;

/* Not to be copied: it points into itself. */
typedef struct vs_verdict {
  vs_judgement *item; /* the ratings in the deck's order, then device by device; owned */
  size_t count;
  /* The line of the least finite margin, less its error where that is known; NULL: none has one.
   * Of two alike it is the later one, so that a device goes before a probe. */
  const vs_judgement *weakest;
  /* The line that failed first; NULL: none did. A fuse that lets through more than its ward bears
   * is never the first to fail. */
  const vs_judgement *first_to_fail;
} vs_verdict;

/* Judges a run and fills the verdict, which vs_verdict_free frees. devices may be NULL. On a tier
 * without a deck nothing is judged, nor is a device of which nothing was measured. */
void vs_verdict_reach(const vs_measures *measures, const vs_devices *devices, vs_verdict *verdict);
void vs_verdict_free(vs_verdict *verdict);

/* What a line of a verdict comes to. */
typedef enum vs_finding {
  VS_HELD,       /* the margin is above 0 by more than its error */
  VS_VIOLATED,   /* the margin is below 0 by more than its error */
  VS_UNDECIDED,  /* the margin's sign is not certain */
  VS_UNVERIFIED, /* no error was computed */
  VS_WORDS
} vs_finding;
extern const char *const vs_verdict_words[VS_WORDS];
vs_finding vs_verdict_word(const vs_judgement *judgement);
/* Returns the line with the least margin among those that are violated, verified or not; where
 * there is none, among those that are undecided; NULL: there is none of these either. */
const vs_judgement *vs_verdict_breach(const vs_verdict *verdict);

/* Gives each line its margin's error: three times the difference to the verdict of a second run of
 * the same scene at another tolerance, and the resolution besides. That is what every number of
 * this run may be wrong by, as a part of the number or of its limit, whichever is more; `rates` is
 * the same for rates. A line that the second run does not have gets an infinite error, and so is
 * undecided. */
void vs_verdict_compare(vs_verdict *verdict, const vs_verdict *second, double resolution,
                        double rates);

/* The two runs have another sequence of what `device` does from parts_s on: its lines that hang on
 * that become undecided, but for those whose value is of an instant before. Called behind
 * vs_verdict_compare. */
void vs_verdict_tear(vs_verdict *verdict, const vs_device *device, double parts_s);

/* True: a line is so near to its limit that its device may fire without its gate, or may not. */
bool vs_verdict_on_edge(const vs_verdict *verdict);

/* Writes the line's name, "v_ak" or "thyristor.i2t", and returns it. */
enum { VS_JUDGED_NAME = VS_DECK_NAME + 24 };
const char *vs_verdict_name(const vs_judgement *judgement, char name[VS_JUDGED_NAME]);
/* The unit that the line's limit was written in; stress and limits are shown in it. */
const char *vs_verdict_unit(const vs_judgement *judgement);

#endif
