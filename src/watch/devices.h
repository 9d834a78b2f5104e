/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that measures the stress of the deck's devices (circuit/devices.h). Between two knots
 * their terms lie on straight lines, as the probes do, so that extremes are at knots; integrals are
 * Simpson's, exact for a voltage times a current on such lines. */
#ifndef VS_WATCH_DEVICES_H
#define VS_WATCH_DEVICES_H

#include "watch/pulse.h"
#include "watch/switching.h"

/* A measure of a device. */
typedef struct vs_reduced {
  const vs_device_measure *measure;
  const vs_limit *limit; /* NULL: none */
  vs_value value;        /* SI; of a mean once the run is over */
  double spread;         /* times a relative error of the run is an error of the value, SI */
  double pulse;          /* integral of the present one */
  double failed_s;       /* when it first passed its limit; NaN: it has not */
  const char *unjudged;  /* why it is not held against the limit its part has; NULL: it is, or the
                            part has none */
} vs_reduced;

/* The integral over the last 10 ms: parts of a quarter of a millisecond, each with its share of the
 * steps that reach into it, and of the oldest the share that is not yet out. Start from {0} with
 * starts_s set. */
enum { VS_WINDOW_PARTS = 40 };
typedef struct vs_window {
  double part[VS_WINDOW_PARTS + 1], whole; /* whole: of all but the present and the oldest */
  size_t now;
  double starts_s; /* when the present one began */
  double sum;      /* at the end of the last step */
} vs_window;

/* A formula, by the short way where it is one term times a constant. */
typedef struct vs_quick {
  const vs_formula *formula;
  bool is_term;
  int term;
  double factor;
} vs_quick;

typedef struct vs_watched {
  const vs_device *device;
  vs_quick voltage, current, flux; /* flux: where its device has one */
  double last[VS_COURSES];         /* at the last knot */
  double sum[VS_COURSES];          /* integrals over the run, but of V and V.s */
  double sum_meant[VS_COURSES];    /* the same over frame->means */
  vs_gate_watch train;             /* its gate, or the deck's first where it is not known */
  bool fresh;                      /* a gate pulse has begun since it last began to conduct */
  double shot_s;                   /* when its last shot began; -INFINITY: none did */
  int starts;                      /* how many shots began between these */
  bool rests;                      /* it did not conduct all the time between them */
  vs_reduced reduced[VS_KIND_MEASURES];
  size_t count;
  vs_reduced *each_step[VS_KIND_MEASURES]; /* those that every step may change; the others come of
                                              the sums, or with news */
  size_t n_each_step, n_peaks;             /* the peaks stand first */
  vs_switch *states;                       /* of a device that conducts or blocks; else NULL */
  vs_gate_watch gate;
  double gate_peak_a; /* in the present gate pulse */
  vs_window window;   /* of the one measure that has one */
  vs_slope slope;
  vs_pulse pulse;
  const vs_zth *zth[VS_PART_ZTH];
  double heat_k[VS_PART_ZTH]; /* rise of each term */
  size_t n_zth;
} vs_watched;

/* What a device did against its gate, in the step last accepted. */
typedef struct vs_incident {
  double at_s;
  const char *device, *what; /* "thyristor", "misfires" */
} vs_incident;

typedef struct vs_devices {
  const vs_frame *frame;
  vs_span_s means;       /* the frame's */
  double began_s, now_s; /* NaN: no step yet */
  vs_incident incidents[2 * VS_DECK_DEVICES];
  size_t n_incidents;
  size_t count;
  vs_watched item[];
} vs_devices;

/* NULL: the frame has no deck, or its deck no devices; the others then do nothing. */
vs_devices *vs_devices_new(const vs_frame *frame);
void vs_devices_free(vs_devices *devices);
void vs_devices_accept(vs_devices *devices, const vs_step *step);
/* The means: over frame->means, exactly. An rms current is held against a limit for ever only where
 * these last a second or longer and its device did not fire but once. */
void vs_devices_finish(vs_devices *devices);

#endif
