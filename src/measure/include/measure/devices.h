/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that measures the stress of the deck's devices (netlist/devices.h). It evaluates each
 * device's voltage and current, tells what a device that conducts or blocks did, and hands both to
 * the reductions of the device's measures (measure/devices/reductions.h).
 *
 * Between two knots the deck's terms lie on straight lines, as the probes do. So extremes are at
 * knots, and Simpson's rule integrates a voltage times a current exactly. */
#pragma once

#include "engine/batch.h"
#include "measure/reducer.h"

/* What happened to a device: it went against its gate; or it fired or went out, where the deck has
 * devices that conduct both ways (vs_devices.tells); or a fuse melted, had cleared or arced again.
 */
typedef struct vs_incident {
  size_t step, which; /* the number of the piece since vs_devices_tell_anew; the device's */
  double at_s;
  const char *device, *what; /* borrowed: "thyristor", "misfires" */
} vs_incident;

typedef struct vs_device_watch vs_device_watch; /* devices.c: how one device is followed */

typedef struct vs_devices {
  const vs_frame *frame;
  vs_span_s means;       /* what means are over; the whole run where the frame says nothing */
  double began_s, now_s; /* of the steps accepted; began_s is NaN before the first */
  bool tells; /* each device's firings are among the incidents, so that the run's own need not be
                 told besides */
  vs_incident *incidents; /* since vs_devices_tell_anew, by their pieces of steps and then by their
                             devices; owned */
  size_t n_incidents, step; /* step: the one that is followed */
  size_t followed, here;    /* pieces since then; the first one of the last step */
  vs_device_watch *watch;   /* [count]; owned */
  size_t count;
  vs_watched item[]; /* in the order of the deck's devices */
} vs_devices;

/* Returns NULL where the frame has no deck, or its deck no devices; the functions below then do
 * nothing. The frame must outlive the watcher, which vs_devices_free frees. */
vs_devices *vs_devices_new(const vs_frame *frame);
void vs_devices_free(vs_devices *devices);
/* Tells where the first step begins. */
void vs_devices_begin(vs_devices *devices, const vs_step *first);
/* Forgets the incidents; behind that one or two batches are followed. */
void vs_devices_tell_anew(vs_devices *devices);
/* Takes some steps, one behind the other. A step of no length is ignored. */
void vs_devices_follow(vs_devices *devices, const vs_batch *batch);
/* Completes the measures that are known only once the run is over. */
void vs_devices_finish(vs_devices *devices);

/* True where a fuse has melted and does not clear, or arcs again, and the voltage of its arc is
 * below the crest of the mains that drive it, or their direct voltage: that is the cause, and the
 * text says so. False where the mains at the fuse are not known. */
bool vs_devices_fails_to_clear(const vs_devices *devices, size_t which, char *text, size_t size);

/* True: the line of the device in the deck has a wrong sign; text says which. The power v i of a
 * device is what it takes. So one that cannot store energy, and still gives more than it takes, has
 * the sign of its voltage or of its current wrong. A diode or a thyristor that conducts backwards
 * has both wrong, or stands the wrong way round, as a Zener diode does that conducts forwards alone.
 * whole_j: the energy of the run, against which a small one says nothing. */
bool vs_devices_sign_is_wrong(const vs_watched *w, double whole_j, char *text, size_t size);
