/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/onset.h"

#include <string.h>

static void begin_meters(vs_onset *o) {
  for (int k = 0; k < o->instruments->count; k++)
    vs_meter_begin(&o->meters[k], &o->instruments->item[k], o->instruments->v.seed);
}

static void take_start(vs_onset *o) {
  memcpy(o->pilot.x, o->steers->x, sizeof o->pilot.x);
}

static void begin(void *self, const vs_setup *setup) {
  vs_onset *o = self;
  o->steers->begin(o->steers->self, setup);
  take_start(o);
}

static void accept(void *self, const vs_step *step) {
  vs_onset *o = self;
  o->steers->accept(o->steers->self, step);
  for (int k = 0; k < o->instruments->count; k++) vs_meter_accept(&o->meters[k], step);
}

/* At the end of a part the clock goes back to 0, and the meters begin anew where their low-passes
 * are. */
static vs_status turn(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  vs_onset *o = self;
  vs_status status = o->steers->turn(o->steers->self, end, begins, err);
  bool whole = ++o->parts % o->pilot.of_orbit == 0;
  take_start(o);
  for (int k = 0; k < o->instruments->count; k++) {
    vs_lowpass *l = &o->meters[k].lowpass;
    vs_instrument *i = &o->instruments->item[k];
    if (*begins) vs_lowpass_close(l, o->from[k], o->pilot.of_orbit * o->pilot.period_s);
    memcpy(i->x, l->x, sizeof i->x);
    if (whole) memcpy(o->from[k], l->x, sizeof o->from[k]);
  }
  begin_meters(o);
  return status;
}

static double push(void *self, double t_s) {
  const vs_onset *o = self;
  return o->steers->push(o->steers->self, t_s);
}

static void end(void *self) {
  const vs_onset *o = self;
  o->steers->end(o->steers->self);
}

void vs_onset_begin(vs_onset *o, vs_pilot *steers, vs_instruments *instruments, vs_meter *meters) {
  *o = (vs_onset){.pilot = *steers, .steers = steers, .instruments = instruments, .meters = meters};
  o->pilot.self = o;
  o->pilot.begin = begin;
  o->pilot.accept = accept;
  o->pilot.turn = turn;
  o->pilot.push = push;
  o->pilot.end = end;
  o->pilot.free = NULL;
  for (int k = 0; k < instruments->count; k++) {
    vs_instrument *i = &instruments->item[k];
    i->on_orbit = true;
    memset(i->x, 0, sizeof i->x);
  }
  begin_meters(o);
}
