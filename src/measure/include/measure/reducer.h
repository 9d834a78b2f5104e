/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a reduction is: how the courses of a device (its voltage, its current, ...) become one
 * number. A reduction sees its device step by step and keeps what it must remember in a state of
 * its own. The table of all reductions is in measure/devices/reductions.h. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "measure/switching.h"

/* ---- what a device did ---- */

/* The sequence of what a device did in a run: its firings and the ends of its conductions, in their
 * order and with their instants, and what went against its gate; of a fuse, when it melts, clears
 * and arcs again. Two runs of a scene that differ in how finely they are solved must have the same
 * sequence; where they do not, what hangs on it is not known from either of them.
 *
 * A single run, too, may show that its sequence is on edge: that something happened which a small
 * error may undo, or that was near to happening. */

/* What is counted. */
typedef enum vs_deed {
  VS_DEED_FIRES,
  VS_DEED_GOES_OUT,
  VS_DEED_MISFIRES,
  VS_DEED_UNINTENDED,
  VS_DEED_FAILS, /* to commutate */
  VS_DEED_MELTS,
  VS_DEED_CLEARS,
  VS_DEED_ARCS_AGAIN,
  VS_DEEDS
} vs_deed;

/* Start from {0}. */
enum { VS_SEQUENCE_KEPT = 512 };
typedef struct vs_sequence {
  long count[VS_DEEDS];
  size_t kept; /* how many deeds are kept with their instants: the first ones of the run */
  struct {
    double at_s;
    vs_deed deed;
  } item[VS_SEQUENCE_KEPT];
  bool edge;   /* a sign was seen that the sequence is on edge */
  bool bursts; /* the device's gate pulses are filled with sub-pulses */
} vs_sequence;

/* Adds a deed at its instant. */
void vs_reducer_add_deed(vs_sequence *sequence, vs_deed deed, double at_s);

/* What two sequences have differently: "fires 3 times" and "once", or "fires at 0.1 s" and "at 0.2
 * s". */
enum { VS_SEQUENCE_SAYS = 64 };
typedef struct vs_sequence_difference {
  char one[VS_SEQUENCE_SAYS], other[VS_SEQUENCE_SAYS];
  double parts_s; /* instant of the first deed that is not the same in both */
} vs_sequence_difference;

/* Returns true where the two sequences are the same: as many deeds of each kind, in the same order,
 * and each within `window_s` of the other's; but for pauses that one of them has alone, of a device
 * whose gate bursts: it goes out, and within window_s its gate fires it again. Else *difference
 * tells the first that differs. */
bool vs_reducer_sequences_agree(const vs_sequence *one, const vs_sequence *other, double window_s,
                                vs_sequence_difference *difference);

typedef struct vs_reducer vs_reducer;
typedef struct vs_losses vs_losses;             /* devices/losses.h */
typedef struct vs_melting_news vs_melting_news; /* devices/melting.h */

/* The stretch that means are over, in equal parts of whole firing cycles that end where it ends.
 * Kept where a limit of a mean or rms value is to be judged on a run that is no orbit. */
typedef struct vs_parts {
  double meant_s;        /* where that stretch begins */
  double from_s, part_s; /* where the first part begins, and how long each is */
  size_t count;
  double (*sum)[VS_COURSES]; /* [count]: the integrals over each; owned */
} vs_parts;

/* One measure of one device in one run. */
typedef struct vs_reduced {
  const vs_device_measure *measure;
  const vs_reducer *by;  /* the plug of measure->how */
  const vs_limit *limit; /* of the device's part; NULL: the measure is held against none */
  vs_value value;        /* in SI units; a mean is known once the run is over */
  vs_value judged; /* of a mean or rms value that is judged over less than the stretch that means
                      are over: what is judged, at that stretch's end; else not known */
  double judged_from_s; /* where that stretch begins */
  double doubt;         /* the value may be wrong by this besides */
  double spread;   /* sensitivity: a relative error e of the run changes the value by e spread */
  double over_v;   /* of a rate of rise: how far the stretch rises that the value is the mean rate
                      of, or would be where there is no value; 0: of any other measure */
  double failed_s; /* instant at which the value first passed the limit; NaN: it has not */
  vs_limit own;    /* the limit where it is none of a file's, as one that was derated */
  double scatter;  /* one part differs from the next by this */
  double most;     /* the value is no more than this, whatever the device's firings make of what
                      flows in the run; 0: no such bound is known */
  bool idle;       /* the run has nothing that the measure would be judged of, or another one is
                      judged in its place */
  const char *unjudged; /* why the value is not held against the limit that the part has, as
                           "not judged: one shot"; NULL: it is, or the part has none */
  const char *note;     /* of t_case: why it stays at the ambient, as "over less than 1 s"; NULL: it
                           does not, or the value is of anything else */
  bool mean;            /* of t_j: it is the mean, as the part has no lines zth */
  unsigned unsure;      /* of the part's figures that the value is made of */
  void *state;          /* the reduction's own, of by->state_size bytes; owned */
} vs_reduced;

/* What must not happen to a device, as it happened: the state of a measure with VS_NEVER. */
enum { VS_CAUSE_SIZE = 96 };
typedef struct vs_happening {
  int times;   /* how often; an unintended firing that is a commutation failure is counted there */
  double at_s; /* the first time */
  double
      rate_v_s; /* of an unintended firing: the dv/dt that its cause tells; 0: it tells another */
  char cause[VS_CAUSE_SIZE]; /* of the first: "dv/dt of 370 V/us over 120 V, up to 400 V" */
} vs_happening;

/* A device under watch: what its reductions share. */
typedef struct vs_watched {
  const vs_device *device;
  const vs_deck *deck;
  const vs_timeline *timeline;
  vs_switch *states;       /* of a device that conducts or blocks; NULL: of any other */
  vs_losses *losses;       /* where a measure asks what the loss is made of; else NULL; owned */
  vs_sequence sequence;    /* what it did */
  double last[VS_COURSES]; /* its courses at the last knot */
  double sum[VS_COURSES];  /* integrals over the run so far; that of V.s stays 0 */
  double sum_meant[VS_COURSES]; /* the same integrals over the stretch that means are over */
  double given_j; /* energy of the steps in which it gave energy (vs_devices_sign_is_wrong) */
  double back_c;  /* charge of the steps in which its current was below zero */
  const vs_cooling *cooling; /* what cools the deck's devices */
  vs_parts parts;            /* of that stretch; none where nothing is judged by them */
  bool at_work;              /* the run is whole periods of an orbit */
  bool from_work;            /* the run begins on an orbit, and is no whole periods of it */
  bool on_orbit;             /* it begins on one */
  double ambient_degc;       /* the scene's */
  bool again;                /* it is, or an event repeats it: what heats comes more than once */
  int starts;                /* how many shots began in that stretch (devices.c) */
  bool rests;                /* the device did not conduct in all of that stretch */
  vs_reduced *reduced;       /* one for each measure of its kind, in the kind's order; owned */
  size_t count;
} vs_watched;

/* The times at which a run ended, s. */
typedef struct vs_run_end {
  double now_s;        /* end of the last step */
  double from_s, to_s; /* the stretch that means are over, as far as the run covers it */
} vs_run_end;

/* A reduction. Each function may be NULL: the reduction then has nothing to do there. */
struct vs_reducer {
  size_t state_size; /* bytes; the state begins as zeros */
  size_t again_size; /* bytes that the state has besides where the run comes more than once */
  /* The reduction counts what the device did against its gate. Its value is 0 from the start where
   * that gate is known, and not known otherwise. */
  bool counts;
  /* A conduction that goes on across the end of an orbit's period counts whole. */
  bool across;
  /* The value is a rate, which a few steps decide: its margin is known less well (verdict.c). */
  bool is_rate;
  /* The value is a mean or rms value, whose limit holds for ever (vs_watched.parts). */
  bool continuous;
  /* The value hangs on the sequence of the device's firings: where two runs of a scene differ in
   * that, the value of neither is known. */
  bool hangs_on_sequence;
  /* A fuse that opens has to pass the limit. It is not judged where the scene expects that. */
  bool until_opens;
  /* By a value near its limit, or beyond it, the device may fire or go on without its gate. */
  bool makes_fire;
  /* The limit is found in the run: of a table, what the value that comes nearest to it may be.
   * Where is_busy says no, there is none. */
  bool finds_limit;
  /* `follow` asks for no more of a step than its times, and for the course that the measure is of:
   * its values at both ends, and its integral. */
  bool own_course;
  /* Prepares the state, before the run. limit and states are there. */
  void (*prepare)(vs_watched *w, vs_reduced *r);
  /* False: this measure needs no `begin` and `follow`. NULL: it needs them. */
  bool (*is_busy)(const vs_watched *w, const vs_reduced *r);
  /* Called at the run's first knot, at t_s. w->last holds the courses there. */
  void (*begin)(const vs_watched *w, vs_reduced *r, double t_s);
  /* Called with each step of some length, once w->sum holds its integrals. */
  void (*follow)(const vs_watched *w, vs_reduced *r, const vs_course_step *c);
  /* True if none of these steps changes the measure, so that `follow` need not be called with them.
   * NULL: any step may. w->last holds the courses where the first of them begins. */
  bool (*rests)(const vs_watched *w, const vs_reduced *r, const vs_courses *c);
  /* Called with each step that brought news of a device that conducts or blocks. */
  void (*take_news)(const vs_watched *w, vs_reduced *r, const vs_switch_news *news);
  /* Called with each step that brought news of a fuse. */
  void (*take_melting)(vs_reduced *r, const vs_melting_news *news);
  /* Called once, when the run is over and had a step. */
  void (*finish)(const vs_watched *w, vs_reduced *r, const vs_run_end *end);
  /* Called once all measures of the device have finished. */
  void (*settle)(const vs_watched *w, vs_reduced *r);
};

/* ---- what reductions share ---- */

/* The integral of a course over the last WIDTH. The window over it is made of parts, each of which
 * holds its share of the steps that reach into it. The oldest one goes out of the window as an even
 * course does that has its centre and its width: evenly where it is even, at once where it is a
 * pulse. Going out evenly over 250 us, a pulse 9.9 ms before another counted by a part that hung on
 * where steps ended. */
enum { VS_WINDOW_PARTS = 40 };
typedef struct vs_window_part {
  double sum, first, second; /* and its moments about the part's beginning, in its length */
} vs_window_part;
typedef struct vs_window {
  vs_window_part part[VS_WINDOW_PARTS + 1];
  double whole;    /* sum of all parts but the present and the oldest one */
  size_t now;      /* index of the present part */
  double part_s;   /* how long a part is */
  double starts_s; /* when the present part began */
  double from, to; /* where the oldest part goes out, as parts of its length */
  double sum;      /* the window's integral at the end of the last step */
  double most;     /* within that step, its ends included */
} vs_window;
void vs_reducer_window_begin(vs_window *w, double width_s, double t_s);
/* Returns the window's integral behind a step that adds `more`, evenly over its length. */
double vs_reducer_window_add(vs_window *w, const vs_course_step *c, double more);

/* Notes when the limit was passed by a value that was `before` at the step's beginning and is
 * `after` at its end. */
void vs_reducer_watch(vs_reduced *r, const vs_course_step *c, double before, double after);
/* The same, and keeps `after` where it is the largest so far. */
void vs_reducer_take_largest(vs_reduced *r, const vs_course_step *c, double before, double after);
/* Takes a value of something that happens now and then: keeps the largest of all, or the least. */
void vs_reducer_offer(vs_reduced *r, vs_value v, bool least);
/* True where the limit is the least that is allowed. */
bool vs_reducer_is_held_from_below(const vs_reduced *r);
/* Adds 1 to the value, which belongs to the first instant. */
void vs_reducer_count(vs_reduced *r, double at_s);
/* What must not happen has happened: counts it, and returns where its cause is to be written, of
 * VS_CAUSE_SIZE bytes; NULL: it is not the first. */
char *vs_reducer_happens(vs_reduced *r, double at_s);
/* What has happened, of a measure with VS_NEVER; NULL: it is no such measure. */
const vs_happening *vs_reducer_happening(const vs_reduced *r);
/* The device's measure of that reduction; NULL: its kind has none. */
const vs_reduced *vs_reducer_of(const vs_watched *w, vs_reduction how);
/* A `begin` of a value that is 0 as the run begins. */
void vs_reducer_begin_at_zero(const vs_watched *w, vs_reduced *r, double t_s);
/* An `is_busy` of a measure that is followed only where it has a limit. */
bool vs_reducer_has_limit(const vs_watched *w, const vs_reduced *r);
