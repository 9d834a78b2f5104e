/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a device that conducts or blocks is seen to do: when it fires and stops, how fast its
 * voltage rises while it blocks, how long its circuit lets it rest, and whether it obeyed its gate.
 *
 * When it fires and goes out, sim/conduction.h says. What is said of it:
 *   misfires               a gate pulse under forward voltage (10 V or more) has ended and it did
 *                          not conduct; or it did not latch: it fell back, without a reverse
 *                          voltage between, to half of the forward voltage it fired from
 *   unintended firing      its current begins outside any gate pulse
 *   commutation failure    an unintended firing on the first forward voltage after a conduction,
 *                          when the time offered was below its part's t_q, or that is not known */
#ifndef VS_WATCH_SWITCHING_H
#define VS_WATCH_SWITCHING_H

#include "circuit/devices.h"
#include "sim/conduction.h"
#include "watch/measures.h"
#include "watch/slope.h"

/* A device's courses over one step: at its beginning, half way, at its end. */
typedef struct vs_course_step {
  double t0_s, t1_s, h_s; /* h_s > 0 */
  double from[VS_COURSES], mid[VS_COURSES], to[VS_COURSES];
  bool was_on, on; /* in a conduction, before and behind it */
} vs_course_step;

/* The gate pulses of a device; their edges are ends of steps. Start with edge_s = -INFINITY. */
typedef struct vs_gate_watch {
  const vs_timeline *timeline;
  double delay_rad;   /* NaN: nothing is known of its gate, which then counts as always on */
  bool on;            /* in the step last followed */
  bool begins, ended; /* with its beginning */
  double edge_s;      /* next one */
  double off_since_s;
} vs_gate_watch;
void vs_gate_follow(vs_gate_watch *gate, const vs_course_step *c);

/* A rise of forward voltage, from its foot to its top so far. */
enum { VS_RISE_POINTS = 256 };
typedef struct vs_rise {
  size_t count; /* 0: none is followed */
  double t_s[VS_RISE_POINTS], v[VS_RISE_POINTS];
} vs_rise;

typedef struct vs_switch {
  vs_gate_watch gate;
  double t_q_s; /* infinite: not known */
  vs_conduction conduction;
  bool by_gate, turning_on;
  double fired_s, fired_v,
      zero_s; /* fired_s: NaN until it first fires; zero_s: of the current, when it last stopped */
  int rest;   /* since then; REST_... of switching.c */
  double offered_s;
  bool forward, conducted; /* in the present gate pulse */
  double unanswered_s;     /* end of a gate pulse that may have failed; NaN: none */
  vs_rise rise;
  vs_slope off, on; /* of its forward voltage and its current, all the time */
  double off_rate;  /* the largest so far, V/s */
} vs_switch;
void vs_switch_begin(vs_switch *s, const vs_timeline *timeline, double gate_rad, double t_q_s);

/* What a step brought. */
typedef struct vs_switch_news {
  bool any;                                  /* of it is known */
  vs_value rise, off_rate, on_rate, offered; /* V/s, V/s, A/s, s */
  double
      spread_s; /* of what was offered: the peak of the current before, by the rate at its zero */
  vs_value misfire, unintended; /* at_s alone */
  bool commutation_failure;     /* it is what the unintended firing is */
} vs_switch_news;
void vs_switch_follow(vs_switch *s, const vs_course_step *c, vs_switch_news *news);

#endif
