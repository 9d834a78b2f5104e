/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a case is told by, in whatever study it stands: the first 16 hexadecimal digits of a SHA-256
 * over what its scene resolves to. That is
 *
 *   - the tier it runs on;
 *   - the value of every key of its sections, whether the tier uses it or not, defaults filled in,
 *     to 12 digits, as many as an axis has;
 *   - the contents of the deck's file, of what that includes and of its parts' files (each by its
 *     own SHA-256), and which part each key names. The names of these files do not matter;
 *   - every event, in their order: its name, when it begins, and its other keys.
 *
 * A key is in unless it cannot change a measure. Left out are
 *
 *   - run.tier: the tier is there, which says more;
 *   - run.sample: it makes the rows of run.csv and nothing else;
 *   - run.verify: it tells how sure a margin is, and changes no measure;
 *   - record and measured, which are for run.csv and the table (what `record` makes of tier auto is
 *     in the tier);
 *   - an event's at, cycle and angle: all they do is to say when it begins;
 *   - what is the program's: its version and ngspice's, its circuit of the EVA. */
#ifndef VS_STUDY_IDENTITY_H
#define VS_STUDY_IDENTITY_H

#include "study/plan.h"

enum { VS_ID_SIZE = 17 };

/* Keeps from scene to scene what stays the same. The plan is borrowed; files are as they were when
 * it was read, those that are no input of its when they are first met. */
typedef struct vs_identity vs_identity;
vs_identity *vs_identity_new(const vs_plan *plan);
void vs_identity_free(vs_identity *identity);

/* The id of a scene that was settled; "" if a file of its deck cannot be read any more. */
void vs_identity_of(vs_identity *identity, const vs_scene *scene, char id[VS_ID_SIZE]);

#endif
