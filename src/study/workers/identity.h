/* SPDX-License-Identifier: GPL-3.0-or-later
 * The id of a case, by which it can be found again in whatever study it stands. It is the first 16
 * hexadecimal digits of a SHA-256 over what the case's scene resolves to:
 *
 *   - the tier it runs on;
 *   - the value of every key of its sections, defaults filled in, to 12 digits, as many as an axis
 *     has; whether the tier uses the key does not matter;
 *   - the contents of the deck's file, of the files it includes and of its parts' files (each by
 * its own SHA-256), and which file each part's key names. The names of the files do not enter;
 *   - the contents of the files that make a law of control of the user's own, where it has one;
 *   - whether it begins on its orbit, as `start: steady` says;
 *   - whether it is a period of its orbit, as the study's key `steady` says, and of which period;
 *   - every event, in their order: its name, when it begins, and its other keys.
 *
 * Left out is what cannot change a measure:
 *
 *   - run.tier, because the tier itself is there, which says more;
 *   - run.sample, which only makes the rows of run.csv;
 *   - run.verify, which tells how sure a margin is;
 *   - record and measured, which are for run.csv and the table (what `record` makes of tier auto is
 *     in the tier);
 *   - an event's at, cycle and angle, which only say when it begins;
 *   - the program: its version and ngspice's, its circuit of the EVA. */
#pragma once

#include "study/plan.h"

enum { VS_ID_SIZE = 17 }; /* bytes of an id, the end included */

/* Makes ids, and keeps from scene to scene the sums of what stays the same. The plan is borrowed.
 * Files count as they were when the plan was read; those that are no input of the plan, as they
 * were when they were first met. */
typedef struct vs_identity vs_identity;
vs_identity *vs_identity_new(const vs_plan *plan);
void vs_identity_free(vs_identity *identity);

/* Writes the id of a settled scene. Error, and "": a file that it is made of can no longer be read,
 * or has changed (vs_hash_hold). */
vs_status vs_identity_of(vs_identity *identity, const vs_scene *scene, char id[VS_ID_SIZE],
                         vs_error *err);
