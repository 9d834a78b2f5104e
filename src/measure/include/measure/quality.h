/* SPDX-License-Identifier: GPL-3.0-or-later
 * Power quality: what currents of a run are to the mains, over whole cycles of these. The scene
 * names them:
 *
 *   quality: [mains, i_source]     mains: the current drawn from the mains; else a channel in A
 *
 * They are taken over the stretch of time that means are over (the scene's `measure`), which must
 * be whole cycles. A current is taken apart into harmonics as in measure/spectrum.h, on the dense
 * output of each step. */
#pragma once

#include "engine/setup.h"
#include "measure/extremes.h"
#include "measure/harmonic_classes.h"

enum { VS_QUALITY_MOST = 8 };

/* The words for the mains current, and for no current. */
extern const char vs_quality_mains[], vs_quality_none[];

/* A current that is named. */
typedef struct vs_quality_current {
  char name[VS_DECK_NAME];
  int channel;
} vs_quality_current;

typedef struct vs_quality_list {
  vs_quality_current item[VS_QUALITY_MOST];
  int count;
} vs_quality_list;

/* Reads the scene's key; node NULL: it has none. of_period: what is told will be of a period of the
 * scene's orbit, which is whole cycles, and not of the setup's stretch. Errors, from each of which
 * a check carries on: a name of no channel, one that this tier has not, that is no current or
 * stands here twice; the mains are a direct voltage; the stretch is no whole number of cycles. */
vs_status vs_quality_read(const vs_node *node, const vs_setup *setup, const vs_frame *frame,
                          bool of_period, vs_quality_list *list, vs_error *err);

/* One of them in one run. Begin with vs_quality_begin, end with vs_quality_end. */
typedef struct vs_quality {
  char name[VS_DECK_NAME];
  int channel;
  vs_span_s over;      /* what is taken in, s */
  int cycles;          /* of the mains in it */
  int half;            /* how many of these, whole firing periods, its two ends are compared over;
                          0: they are not */
  vs_spectrum current; /* A; its span is what was taken in so far */
  double voltage[2];   /* int v cos(w t) dt, int v sin(w t) dt of the mains' voltage, V s */
  double voltage_squared; /* int v^2 dt, V^2 s */
  double energy_j;        /* int v i dt */
  double ends_squared[2]; /* int i^2 dt over the first and the last `half` cycles, A^2 s */
} vs_quality;

/* setup: of the run, whose means and firings it follows. */
void vs_quality_begin(vs_quality *quality, const vs_quality_current *current,
                      const vs_setup *setup);
void vs_quality_end(vs_quality *quality);
/* Takes one accepted step. */
void vs_quality_accept(vs_quality *quality, const vs_step *step);

/* What limits depend on, as vs_harmonic_classes_all want it. */
vs_drawn_current vs_quality_drawn(const vs_quality *quality);

/* The phase of harmonic n, rad: of the sine sin(n w t + phase), where w t counts from the mains'
 * rise through zero at t = 0. NaN: there is no such harmonic. */
double vs_quality_phase(const vs_quality *quality, int n);

typedef struct vs_quality_measure {
  char name[VS_DECK_NAME + 24]; /* "mains.thd" */
  const char *unit, *text;      /* of the program's */
  vs_value value;
} vs_quality_measure;

/* Fills `measure` with the k-th measure, from 0, and returns true; false: there are no more. Behind
 * those of all of the current come, where `harmonics` asks for them, NAME.harmonic_0 to _40. No
 * value is known before anything was taken in. */
bool vs_quality_at(const vs_quality *quality, int k, bool harmonics, vs_quality_measure *measure);

/* Writes what is to be warned of: the stretch is no whole number of firing periods, or the current
 * is not the same at its two ends. False: nothing is. */
bool vs_quality_warning(const vs_quality *quality, const vs_setup *setup, char *text, size_t size);

/* Displacement factor: the cosine of the angle between the fundamental of a current and that of a
 * voltage, each given as integrals over whole cycles of itself times cos(w t) and sin(w t). NaN:
 * one of them has none. */
double vs_quality_displacement(const double current[2], const double voltage[2]);
/* Total harmonic current: the root of the sum of the squares of harmonics 2 to 40, A rms. */
double vs_quality_thc(const vs_spectrum *current);
