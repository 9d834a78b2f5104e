/* SPDX-License-Identifier: MIT
 * A law of control of your own, as a shared object. VibroSpice asks it once for each firing of the
 * thyristor. Write one function, compile it, and name the object in a scene:
 *
 *   cc -shared -fPIC -I.../include -o mylaw.so mylaw.c
 *
 *   control: {law: object, file: ./mylaw.so}
 *
 *   vibrospice run scene.yaml --allow-code
 *
 * The object is loaded into a process of its own, which begins anew with each run. So static
 * variables are the law's memory of one run, and a crash ends the run with one line.
 *
 * docs/control.md says more; the example that ships is spice/control/trim.c. */
#ifndef VIBROSPICE_LAW_H
#define VIBROSPICE_LAW_H

#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of what this file says. An object that was compiled with another version is refused. */
#define VIBROSPICE_LAW_VERSION 1

/* Bytes of the text with which a law may end the run, its end included. */
#define VIBROSPICE_LAW_TEXT 256

/* What one instrument shows, or what the scene's observer estimates. Every value is in the unit
 * that the name ends with. */
typedef struct vibrospice_channel {
  const char *name;      /* as the column in run.csv: "p_meas_m"; estimates are "NAME_est_UNIT" */
  double now;            /* the last sample */
  double least, largest; /* of the samples since the firing before was decided */
} vibrospice_channel;

/* A firing that is to be decided. Its cycle begins now, as the mains rise through zero. */
typedef struct vibrospice_firing {
  double t_s;                        /* now, s from the beginning of the run */
  long number;                       /* of the decision, from 1 */
  double last_angle_deg;             /* what was decided before; NAN: no firing, or number is 1 */
  int count;                         /* how many channels there are */
  const vibrospice_channel *channel; /* channel[count], the instruments in their order, then
                                        the estimates */
} vibrospice_firing;

/* Yours: decides one firing. Returns the angle, deg, above 0 and below 180, counted from now on at
 * 360 degrees in a period of the mains; or NAN, for no firing in this cycle. To end the run, write
 * why into error, which comes empty and has VIBROSPICE_LAW_TEXT bytes. */
double vibrospice_law(const vibrospice_firing *firing, char *error)
    __attribute__((visibility("default")));

/* The channel of that name; NULL: there is none. */
static inline const vibrospice_channel *vibrospice_channel_named(const vibrospice_firing *firing,
                                                                 const char *name) {
  for (int k = 0; k < firing->count; k++)
    if (!strcmp(firing->channel[k].name, name)) return &firing->channel[k];
  return NULL;
}

#ifndef VIBROSPICE_LAW_READER /* which VibroSpice itself is */
/* By this number VibroSpice knows which version the object was compiled with. */
extern const int vibrospice_law_version;
const int vibrospice_law_version __attribute__((weak, visibility("default"))) =
    VIBROSPICE_LAW_VERSION;
#endif

#ifdef __cplusplus
}
#endif

#endif
