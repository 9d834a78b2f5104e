/* SPDX-License-Identifier: GPL-3.0-or-later
 * The verdict on a run: the deck's ratings held against what its probes did, the scene's ratings
 * against what they name, the limits of parts against what was measured of devices, and what
 * happened to devices that must not, unless the scene expects it. */
#pragma once

#include "measure/devices.h"
#include "measure/expect.h"
#include "measure/measures.h"
#include "netlist/parts.h"

/* A rating of the scene, and what the run has of what it rates: a measure, or a probe. In SI. */
typedef struct vs_rated {
  const char *name;        /* of the measure or the probe, borrowed */
  const vs_rating *rating; /* borrowed; it names no probe of the deck */
  vs_value least, largest; /* of a measure both are its value */
  const char *unknown;     /* why there is no value, borrowed; NULL: there is one */
  double passed_s; /* when a value left the range; looked at where the range does not hold it */
  bool is_rate;    /* this and the next two as vs_judgement has them, but not in parts of a limit */
  double doubt, spread;
  const vs_device *hangs; /* the device on whose sequence of firings it hangs; NULL: on none's */
} vs_rated;

/* One line of a verdict: a rating of the deck or of the scene, a limit of a device's part, or what
 * happened to a device. Values are in SI. Everything it points to belongs to the deck or to the
 * scene, or is constant.
 *
 * What happened has the measure that counts it (VS_NEVER). Its margin is -1 where the scene does
 * not expect it, and where it is expected and did not happen; else INFINITY. */
typedef struct vs_judgement {
  const vs_rating *rating; /* NULL: the line is of a device */
  const vs_probe *probe;   /* of a rating of the deck; NULL: it is none */
  const char *name; /* what a rating of the scene rates, or a part with limits that no device of the
                       deck goes with; NULL: it is neither */
  const char *unknown; /* why the run has no value or no limit to judge: the line is undecided, and
                          its margin is NaN; NULL: it has both */
  const char *lacks;   /* of a device: its part, which does not state a limit that decides. The line
                          has no limit then; NULL: it has one */
  bool waived;         /* the scene leaves the limit out: the line breaks nothing */
  const vs_device *device; /* NULL: the line is of a rating */
  const vs_device_measure *measure;
  const vs_limit *limit;
  const vs_device *ward; /* the device whose limit this is, where that is another one; else NULL */
  vs_value least, largest; /* of the probe in the run */
  double room[2]; /* what is left to the lower and to the upper end, as a part of that end. Beyond
                     an end of 0 it is a part of the range. INFINITY: there is no such end, or it is
                     0 and was not passed */
  double margin;  /* the lesser of the two; below 0 the limit was passed */
  double margin_error;    /* numerical error of the margin, in the margin's own scale; INFINITY: it
                             could not be found; NaN: it was not computed */
  vs_value stress;        /* the extreme that is nearer to its limit, or further beyond it */
  const vs_device *hangs; /* the device on whose sequence of firings it hangs; NULL: on none's */
  bool torn;              /* that is another one in a second run: undecided for its sake */
  bool makes_fire;        /* near the limit the device may fire without its gate */
  bool is_rate;           /* the measure is a rate over a short time */
  unsigned unsure;        /* of the limit, and of figures that the stress is made of */
  double over_v;      /* of a rate of rise: how far the stretch rises that the stress is the mean
                         rate of; 0: of any other */
  double over_from_s; /* of a mean or rms value: the stress is over the stretch from here to the end
                         of what means are over; NaN: over all of that, or of another measure */
  double doubt;       /* the margin may be wrong by this besides */
  double spread;  /* sensitivity: a relative error e of the run changes the margin by e spread */
  double scatter; /* the margin of one part and of the next differ by this */
  double most; /* whatever the device's firings, the stress takes no more of the limit than this, of
                  the two runs the larger one; 0: no such bound is known */
  double failed_s; /* instant at which the limit was first passed; NaN: it was not */
  vs_model_beside model[VS_MODELS_BESIDE]; /* how far the models that the line hangs on are from
                                              their data sheets, where their parts say so */
  size_t n_models;
  bool expected;             /* of what happened: the scene expects or allows it */
  bool allowed;              /* of what happened: it may, and does not have to */
  char cause[VS_CAUSE_SIZE]; /* of what happened, the first time; empty: it is another line, or did
                                not happen */
} vs_judgement;

/* Not to be copied: it points into itself. */
typedef struct vs_verdict {
  vs_judgement *item; /* the deck's ratings in its order, then the scene's, then device by device,
                         of each device first its limits; owned */
  size_t count;
  const vs_expects *expects; /* that it was reached with, borrowed; NULL: none */
  /* The line of the least finite margin among those that are violated for certain; where there is
   * none, the line of the least finite margin less its error, where that is known; NULL: none has
   * one. Of two alike it is the later one, so that a device goes before a probe. */
  const vs_judgement *weakest;
  /* The line that failed first; NULL: none did. A fuse that lets through more than its ward bears
   * is never the first to fail. */
  const vs_judgement *first_to_fail;
} vs_verdict;

/* Judges a run and fills the verdict, which vs_verdict_free frees. devices may be NULL. On a tier
 * without a deck nothing is judged, nor is a device of which nothing was measured. */
void vs_verdict_make(const vs_measures *measures, const vs_devices *devices,
                     const vs_expects *expects, vs_verdict *verdict);
/* Adds the ratings of a scene to a verdict that was reached. tolerance: the run's. */
void vs_verdict_rate(vs_verdict *verdict, const vs_rated *rated, size_t count, double tolerance);
void vs_verdict_free(vs_verdict *verdict);

/* What a line of a verdict comes to. */
typedef enum vs_finding {
  VS_HELD,       /* the margin is above 0 by more than its error */
  VS_VIOLATED,   /* the margin is below 0 by more than its error */
  VS_UNDECIDED,  /* the margin's sign is not certain */
  VS_UNVERIFIED, /* no error was computed */
  VS_WAIVED,     /* the scene leaves the limit out */
  VS_WORDS
} vs_finding;
extern const char *const vs_verdict_words[VS_WORDS];
vs_finding vs_verdict_word(const vs_judgement *judgement);
/* Why the line has nothing to judge, in one sentence without its end; NULL: it has. The text is
 * written where it is not constant. */
const char *vs_verdict_unknown(const vs_judgement *judgement, char *text, size_t size);
/* True where the first line is weaker. A line that is violated for certain is weaker than any that
 * is not, however large the error of the latter's margin is; else the margin less its error
 * decides.
 */
bool vs_verdict_is_weaker(const vs_judgement *line, const vs_judgement *other);
/* True for a rating of a probe whose instant and stress are those of a device's line among them, as
 * v_ak's are those of thyristor.v_reverse, and which leaves no less than that line. */
bool vs_verdict_is_doubled(const vs_judgement *const *line, size_t count, const vs_judgement *j);
/* Returns the line with the least margin among those that are violated, verified or not; where
 * there is none, among those that are undecided; NULL: there is none of these either. */
const vs_judgement *vs_verdict_breach(const vs_verdict *verdict);

/* Gives each line its margin's error: three times the difference to the verdict of a second run of
 * the same scene at another tolerance, and the resolution besides. That is what every number of
 * this run may be wrong by, as a part of the number or of its limit, whichever is more; `rates` is
 * the same for rates. A line that the second run does not have gets an infinite error, and so is
 * undecided; what happened in the second run alone becomes such a line. deck: of this run, NULL
 * where it has none; `second` may be freed afterwards. */
void vs_verdict_compare(vs_verdict *verdict, const vs_verdict *second, const vs_deck *deck,
                        double resolution, double rates);

/* The two runs have another sequence of what `device` does from parts_s on: its lines that hang on
 * that become undecided, but for those whose value is of an instant before, and for those that a
 * bound on the stress holds below the limit. Called behind vs_verdict_compare. */
void vs_verdict_undecide_sequence(vs_verdict *verdict, const vs_device *device, double parts_s);

/* True: a line is so near to its limit that its device may fire without its gate, or may not. */
bool vs_verdict_on_edge(const vs_verdict *verdict);

/* Writes the line's name, "v_ak" or "thyristor.i2t", and returns it. */
enum { VS_JUDGED_NAME = VS_DECK_NAME + 32 };
const char *vs_verdict_name(const vs_judgement *judgement, char name[VS_JUDGED_NAME]);
/* The unit that the line's limit was written in; stress and limits are shown in it. */
const char *vs_verdict_unit(const vs_judgement *judgement);
/* Writes how far the models that the line hangs on are from their sheets, "model
 * varistor_1.v_clamp -6 % of sheet"; nothing where no part says so. */
void vs_verdict_models(const vs_judgement *judgement, vs_text *text);
/* Writes the name of one of them, "v_clamp" or "varistor_1.v_clamp", and returns it. */
const char *vs_verdict_model_name(const vs_model_beside *model, char name[2 * VS_DECK_NAME]);
/* True for a line of what happened, or did not though the scene expects it. */
bool vs_verdict_is_happening(const vs_judgement *judgement);
