/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a device that conducts or blocks is seen to do: when it fires and goes out, how fast its
 * voltage rises while it blocks, how long its circuit lets it rest, and whether it obeyed its gate.
 *
 * engine/conduction.h defines when a device fires and goes out. This file defines:
 *   misfire                a gate pulse under forward voltage (10 V or more) has ended and the
 *                          device did not conduct; or the device did not latch: it went out within
 *                          ten t_q of the end of its pulse, and without a reverse voltage
 *                          in between fell back to half of the forward voltage it had fired from;
 *                          or, of a triac, the pulse began and ended under the current of the half
 *                          cycle before, and the device then blocked
 *   unintended firing      the device's current begins outside any gate pulse
 *   time offered           from the zero of the current to the return of forward voltage, which
 *                          then goes on to 10 V or fires the device; where
 *                          the device had latched and comes back to half of the forward voltage
 *                          it had fired from without having been reversed, as it may when it lets
 *                          go at its holding current, to the first 10 V
 *   rise                   of forward voltage, up to where it has come down by a tenth of it. One
 *                          that has its gate pulse from its foot on, and ends as the device fires,
 *                          does not count: the device was meant to conduct, and data sheets give
 *                          dv/dt for an open gate
 *   dv/dt                  the steepest mean rate over any stretch that rises by over_v: the
 *                          shortest time from any instant to one at which the forward voltage is
 *                          that much more. The voltage may come down in between, as it does in a
 *                          ring. Reverse voltage counts as none. A rise that ends in an unintended
 *                          firing and is lower than over_v, but 10 V or more, is told by its
 *                          steepest stretch of four fifths of its height
 *   commutation failure    an unintended firing on the first forward voltage after a conduction,
 *                          where the time offered was below the part's t_q; where that is not
 *                          known, below 1.5 ms, ten t_q of a slow thyristor: by then no charge of
 *                          the conduction is left
 *
 * A triac conducts both ways, and is followed in one half cycle after the other. A half cycle is
 * positive where the device's voltage, by its formula in the deck, is positive, or its current was
 * as it began to conduct. All of the above is told by voltage and current with the signs of the
 * present half cycle. A new half cycle begins where the voltage of the blocking device changes its
 * sign. So behind a conduction the new half cycle's voltage is the forward voltage that returns, at
 * once; and a triac that then conducts without a gate pulse has failed to commutate. Of a triac
 * there is also:
 *   (di/dt)c  mean rate at which the current falls from a tenth of its peak to zero, or over the
 *             last 50 us (assumed) if it falls more steeply then; where forward voltage comes back
 *             within ten t_q (1.5 ms where that is not known), or the device fires by itself
 *   (dv/dt)c  the same as dv/dt, of each rise up to ten t_q behind a conduction (1.5 ms where t_q
 *             is not known). A rise that is less than over_v, but 10 V or more and higher than
 *             those before it, is told by four fifths of it
 *
 * A current of the new half cycle that is there as the voltage turns is what the conduction has
 * stored, and no firing, for as long as engine/conduction.h says. */
#pragma once

#include "engine/batch.h"
#include "engine/conduction.h"
#include "measure/extremes.h"
#include "measure/slope.h"
#include "netlist/devices.h"

/* The courses of a device over one step (VS_OF_V, ...): at its beginning, half way, at its end. */
typedef struct vs_course_step {
  double t0_s, t1_s, h_s; /* h_s > 0 */
  double from[VS_COURSES], mid[VS_COURSES], to[VS_COURSES];
  double more[VS_COURSES]; /* integrals over the step; that of V.s is 0 */
  bool was_on, on;         /* the device conducts at the beginning; at the end */
} vs_course_step;

/* The courses of a device over the steps of a batch, half way and at the end of each, and their
 * integrals over each step. */
typedef struct vs_courses {
  size_t count;
  vs_pair of[VS_COURSES][VS_BATCH_STEPS];  /* V.s: of a device that has it */
  double more[VS_COURSES][VS_BATCH_STEPS]; /* from VS_OF_V on */
} vs_courses;

/* The gate pulses of a device. Their edges are ends of steps. */
typedef struct vs_gate_watch {
  const vs_timeline *timeline;
  vs_gates gates; /* whose pulses they are; none: nothing is known of its gate, which then counts
                     as always on */
  bool on;        /* there is a pulse in the step last followed */
  bool begins, ended; /* a pulse began, or ended, at that step's beginning */
  bool bursts;        /* its pulses are filled with sub-pulses, by the deck's port burst */
  double edge_s;      /* instant of the next edge */
  double off_since_s; /* end of the last pulse; -INFINITY: there was none */
} vs_gate_watch;
/* gates: as in the struct, which copies them. */
void vs_switching_gate_begin(vs_gate_watch *gate, const vs_timeline *timeline,
                             const vs_gates *gates);
/* Takes the next step. */
void vs_switching_gate_follow(vs_gate_watch *gate, const vs_course_step *c);

/* A stretch of a rise, over which a mean rate is told. */
typedef struct vs_rise_stretch {
  double from_s, took_s; /* took_s: INFINITY where there is no such stretch */
  double over_v;         /* how far it rises */
  double bent_s;         /* how far straight lines are from the cubics in the steps of its ends */
} vs_rise_stretch;

/* An instant at which a course is at some value. bent_s: by no more than this the straight line
 * from knot to knot is elsewhere, anywhere in that step. */
typedef struct vs_instant {
  double t_s, bent_s;
} vs_instant;

/* A step in which the voltage rises. */
typedef struct vs_rising {
  double t0_s, t1_s, v0, v1;
  double slope_v_s; /* at its beginning; NaN: that of the step itself */
} vs_rising;

/* The course over a step in which the voltage rises: straight, or on a cubic that has the slopes
 * given at its ends. */
typedef struct vs_climbed {
  double zero_s, low_v, s_per_v; /* the straight line: its part above 0 V */
  double t0_s, h_s, v0, v1;      /* the whole step */
  double k0, k1;                 /* the slopes at its ends, in V over the step */
  double
      bow_s; /* how far the cubic is from the straight line, at its farthest; 0: it is straight */
} vs_climbed;

/* Levels that the voltage last rose through in one step. */
typedef struct vs_passed {
  double first, last; /* their numbers, from 0 for 0 V on */
  vs_climbed course;
} vs_passed;

/* A rise of forward voltage, from its foot to its top so far. Levels lie an 800th of over_v apart,
 * and of as many as the highest 1.28 times over_v has it is kept in which step the voltage last
 * rose through each. Between two knots the voltage runs on a cubic, whose slope at each knot is
 * that of the parabola through it and its neighbours; where these say different things, as at a
 * jump, the step's own slope is taken, and a step between two such knots is straight. So stretches
 * that begin on a level are told as that course has them, and so are those that begin at the foot
 * or at the last knee. Others are missed: the rate told is never above the steepest of over_v, and
 * it is at least that of a stretch that is an 800th higher, less an 800th.
 *
 * An entry more than VS_RISE_ABOVE levels above the last step is dropped: no stretch begins there
 * until the voltage is back, and one that has come down by less than a tenth of its rise, of which
 * four fifths are told, is not so far below its top. An entry more than VS_RISE_LEVELS below is
 * dropped once they are full: a stretch from there was longer than the one told as it passed. */
enum {
  VS_RISE_PARTS = 800,
  VS_RISE_LEVELS = 1024,
  VS_RISE_ABOVE = 128,
  VS_RISE_ENTRIES = VS_RISE_LEVELS + 2 * VS_RISE_ABOVE
};
typedef struct vs_rise {
  double over_v; /* how far a stretch rises over which dv/dt is told; 0: no rise is followed */
  bool begun;    /* a rise is followed */
  bool gated;    /* its gate pulse was there since its foot */
  vs_instant foot, knee; /* knee: where it last became twice as steep from one step to the next */
  double foot_v, top_v, knee_v;
  double s_per_v;       /* of the step before; INFINITY: it did not rise */
  double rate_v_s, h_s; /* of the last step, rising or not; 0: there was none */
  bool waits;       /* the last step rose, and is taken once the next one tells its end's slope */
  vs_rising rising; /* that step */
  vs_rise_stretch best; /* its steepest stretch of over_v */
  double told_s;        /* took_s of the last one of its stretches that was told */
  int n_passed;
  vs_passed passed[VS_RISE_ENTRIES]; /* the lowest first; no level is in two */
} vs_rise;

/* A rate of rise, V/s: the mean of a stretch that rises by over_v. error: what it may be wrong by
 * for how the voltage runs between its knots. */
typedef struct vs_rise_rate {
  vs_value rate;
  double over_v, error;
} vs_rise_rate;

/* What a step brought. Values that are not known were not brought. */
typedef struct vs_switch_news {
  bool any;                 /* one of the values is known */
  double way;               /* the half cycle that the step belongs to, as in vs_switch */
  vs_value fires, extinct;  /* only their instants mean anything */
  vs_rise_rate rise;        /* of a stretch of a rise, above all before of this rise */
  vs_value off_rate;        /* a rate of blocked forward voltage, V/s, above all before */
  vs_value on_rate;         /* a rate of the current as it turns on, A/s */
  vs_value fall;            /* (di/dt)c, A/s */
  vs_rise_rate return_rise; /* (dv/dt)c */
  vs_value offered;         /* the time offered, s, where no gate pulse was there at its end */
  double doubt_s; /* error of the time offered: how long the current crept before its zero */
  double
      spread_s; /* sensitivity: a relative error e of the current changes the time by e spread_s */
  vs_value misfire, unintended; /* only their instants mean anything */
  bool commutation_failure;     /* the unintended firing is one */
  bool unlatched;               /* the misfire: a current flowed, and did not latch */
  bool lost; /* the misfire: the pulse ended before the current of the half cycle before did */
  /* Of the firing that the step told, if it did: the steepest rate of the rise that ended in it, or
   * of one that ended no longer before than the part's t_q (150 us where that is not known) if it
   * was steeper, V/s, over fired_over_v; 0 where the voltage did not rise. And the forward voltage
   * from which the device fired. */
  double fired_rate, fired_over_v, fired_v;
} vs_switch_news;

typedef struct vs_switch {
  vs_gate_watch gate;
  bool both_ways; /* it conducts either way */
  double way;     /* +1 in a positive half cycle, -1 in a negative one */
  double t_q_s;   /* of the part; INFINITY, as at the beginning: not known */
  vs_conduction conduction;
  bool by_gate;    /* the present or last conduction began with a gate pulse */
  bool turning_on; /* the current has not come to its first maximum, or fired 1 us ago or less */
  double fired_s;  /* when it last fired; NaN: it has not fired yet */
  double fired_v;  /* the forward voltage it fired from */
  double leaked_v; /* the highest one since it leaks more than 1 mA, as it does at its breakover */
  double rose_s;   /* when it had 10 V forward since zero_s, not reversed yet; NaN: not so far */
  double tenth_s;  /* since when the current is below a tenth of its peak; NaN: it is not */
  vs_fall fall;    /* of a device that conducts both ways */
  vs_value fell;   /* how the last conduction ended, as long as it is not told: (di/dt)c */
  bool fell_last;  /* of that the rate over vs_slope_fall_s */
  bool commutates; /* it blocks, and a conduction's charge may still be there */
  double returned_v;  /* how high the highest rise since then was that was told */
  bool latched;       /* the last conduction went on without its gate */
  double pulse_end_a; /* its current as its last gate pulse ended */
  double zero_s;      /* when its current last went to zero */
  int rest;           /* what its voltage did since then: REST_... of switching.c */
  double offered_s;   /* the time that its circuit offered it to rest */
  bool offers;        /* forward voltage has returned, but has not come to 10 V yet, nor fired it */
  vs_switch_news offer; /* what is then told of that time */
  bool forward;         /* in the present gate pulse it had forward voltage */
  bool conducted;       /* in the present gate pulse it conducted */
  double unanswered_s;  /* end of a gate pulse that may have failed; NaN: there is none */
  double
      lost_s; /* beginning of one under the current of the half cycle before; NaN: there is none */
  vs_rise_stretch stored; /* steepest stretch of a rise that ended before, while it blocked */
  double stored_at_s; /* when that rise ended; -INFINITY: there was none since the last firing */
  vs_slope off, on;   /* rates of its forward voltage and of its current, followed all the time */
  double off_rate;    /* the largest of its forward voltage while it blocked, V/s */
  vs_rise rise;       /* the last member */
} vs_switch;
/* gates: as in vs_gate_watch; deck, device: whose switch it is. */
void vs_switching_begin(vs_switch *s, const vs_timeline *timeline, const vs_gates *gates,
                        const vs_deck *deck, const vs_device *device);
/* Tells the current and the voltage at the first knot, before the first step. A device that
 * conducts there, as on an orbit, was fired by its gate before. */
void vs_switching_resume(vs_switch *s, double i_a, double v_v);

/* Takes the next step and fills `news`. */
void vs_switching_follow(vs_switch *s, const vs_course_step *c, vs_switch_news *news);
/* Fills `news` with what the last step told of a rise, which no further step follows; the same at
 * each call. */
void vs_switching_finish(vs_switch *s, vs_switch_news *news);
/* True where the run ends so soon behind the return of forward voltage that a commutation failure
 * would not be seen: within t_q (150 us where that is not known), before which the device had less
 * than its turn-off time to rest. */
bool vs_switching_may_fail(const vs_switch *s, double now_s);
