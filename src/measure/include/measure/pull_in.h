/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher of a machine that pulls in: an armature that a direct voltage pulls against a stop, and
 * that goes back once the voltage is off, as that of a relay or of a valve.
 *
 * The stop is the one that a closing gap meets first (vs_stops_closing). The drive is on while the
 * supply has a voltage and, where the deck has ports pwm, the first of them is on. */
#pragma once

#include "engine/step.h"
#include "measure/extremes.h"

/* Start from {0}. Instants in s; NaN: not yet, once `began` is set. */
typedef struct vs_pull_in {
  bool began, idle;        /* idle: the machine has no such measures */
  int stop;                /* the stop's index */
  bool on, touches;        /* now */
  double from_m;           /* the travel at the run's beginning */
  double on_s;             /* when the drive was first on */
  double off_s;            /* when it was last switched off */
  double met_s, speed_m_s; /* the first contact, and the size of the travel's rate there */
  double last_s;           /* the last contact */
  double left_s;           /* when the armature last left the stop */
  double flight_s;         /* how long it was away before the last contact; 0: it was not */
  double bounces;          /* contacts behind the first, up to bounced_s */
  double bounced_s;        /* the last contact before it had settled */
  bool settled;            /* it lay still on the stop as the drive was switched off, or let go */
  bool lay;                /* it has lain still since the last contact */
  bool away;               /* it has left the stop, and come back by half of its way */
  double gone_s;           /* when it left the stop with the drive off, and then came away */
  bool over;               /* the drive was on again then: the rest of the run does not count */
  double dropped_s;        /* when it left the stop and came away while the drive was on */
  double nearest_m;        /* the travel where it was nearest to the stop */
  double now_s;            /* the end of the last step */
  bool still;              /* it lies still on the stop at the end of the last step */
} vs_pull_in;

/* Takes one accepted step. */
void vs_pull_in_accept(vs_pull_in *pull, const vs_step *step);

/* Where the drive has not brought the armature to the stop, writes why and returns true: "pull_in
 * did not occur before 60 ms: the armature moved 0.02 of 2 mm". */
bool vs_pull_in_lacks(const vs_pull_in *pull, const vs_model *model, char *text, size_t size);
/* Time from the first switching on to the first contact. */
vs_value vs_pull_in_time(const vs_pull_in *pull);
/* Where the armature lets go of the stop while the drive is on, or goes on and off as in PWM,
 * writes when and returns true. */
bool vs_pull_in_drops(const vs_pull_in *pull, char *text, size_t size);
/* How long the drive has been on without a first contact at the run's end, and off with the
 * armature on the stop, s: the least that pull_in and release can be. NaN: it is not so. */
double vs_pull_in_waits_s(const vs_pull_in *pull);
double vs_pull_in_sticks_s(const vs_pull_in *pull);
/* Time from the last switching off before the armature left the stop for the last time to that
 * instant. It has left once it is back by half of its way. What comes after the next switching on
 * does not count. */
vs_value vs_pull_in_release(const vs_pull_in *pull);
/* How often the armature came back onto the stop behind the first contact, and the time from the
 * first contact to the last; without what comes once it has lain still and the drive was switched
 * off. Not known where the armature did not come to lie still on the stop: it
 * may have gone on to bounce. */
vs_value vs_pull_in_bounces(const vs_pull_in *pull);
vs_value vs_pull_in_bounce_time(const vs_pull_in *pull);
/* The size of the travel's rate at the first contact, m/s. */
vs_value vs_pull_in_speed(const vs_pull_in *pull);
