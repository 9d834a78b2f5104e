/* SPDX-License-Identifier: GPL-3.0-or-later
 * Takes out of the steps of a run what stands in the place of each sample of a recording: the
 * channel itself, or what its instrument would show without noise and A/D. */
#pragma once

#include "fit/recording.h"
#include "measure/meter.h"

/* Begin with vs_sampler_begin, end with vs_sampler_end. */
typedef struct vs_sampler {
  const vs_recording *recording; /* borrowed */
  const vs_scene *scene;         /* that is run, whose instruments are looked through; borrowed */
  double *computed;              /* [recording->n_samples], SI; borrowed */
  size_t next;                   /* the first sample that is not taken yet */
  unsigned groups;               /* of the columns' channels */
  double *channels;              /* of one instant; owned */
  vs_meter *meters;              /* one for each column; owned */
} vs_sampler;

void vs_sampler_begin(vs_sampler *sampler, const vs_recording *recording, double *computed);
void vs_sampler_end(vs_sampler *sampler);

/* Begins a run of the scene anew: of what was taken before, nothing counts. */
void vs_sampler_restart(vs_sampler *sampler, const vs_scene *scene);

/* Takes a step of the run. Every step is to be shown, in order of time. */
void vs_sampler_accept(vs_sampler *sampler, const vs_step *step);
