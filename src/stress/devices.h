/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that measures the stress of the deck's devices (deck/devices.h). It evaluates each
 * device's voltage and current, tells what a device that conducts or blocks did, and hands both to
 * the reductions of the device's measures (stress/reductions.h).
 *
 * Between two knots the deck's terms lie on straight lines, as the probes do. So extremes are at
 * knots, and Simpson's rule integrates a voltage times a current exactly. */
#ifndef VS_STRESS_DEVICES_H
#define VS_STRESS_DEVICES_H

#include "stress/reductions.h"

/* A device that went against its gate in the step last accepted. */
typedef struct vs_incident {
  double at_s;
  const char *device, *what; /* borrowed: "thyristor", "misfires" */
} vs_incident;

typedef struct vs_device_watch vs_device_watch; /* devices.c: how one device is followed */

typedef struct vs_devices {
  const vs_frame *frame;
  vs_span_s means;       /* what means are over; the whole run where the frame says nothing */
  double began_s, now_s; /* of the steps accepted; began_s is NaN before the first */
  vs_incident incidents[2 * VS_DECK_DEVICES]; /* at most one misfire and one firing a device */
  size_t n_incidents;
  vs_device_watch *watch; /* [count]; owned */
  size_t count;
  vs_watched item[]; /* in the order of the deck's devices */
} vs_devices;

/* Returns NULL where the frame has no deck, or its deck no devices; the functions below then do
 * nothing. The frame must outlive the watcher, which vs_devices_free frees. */
vs_devices *vs_devices_new(const vs_frame *frame);
void vs_devices_free(vs_devices *devices);
/* Takes one accepted step. A step of no length is ignored. */
void vs_devices_accept(vs_devices *devices, const vs_step *step);
/* Completes the measures that are known only once the run is over. */
void vs_devices_finish(vs_devices *devices);

#endif
