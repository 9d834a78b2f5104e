/* SPDX-License-Identifier: GPL-3.0-or-later
 * Why: what makes each violated line of a verdict, or the weakest where none is violated. The scene
 * is run once more, up to the last instant that is asked for, and the circuit is looked into: which
 * branches the device's current comes from, or what its voltage is made of. */
#ifndef VS_RUN_CAUSES_H
#define VS_RUN_CAUSES_H

#include <stdio.h>

#include "base/json.h"
#include "run/session.h"

/* Lines that are looked at; further violated ones are left out. */
enum { VS_CAUSES_MOST = 12 };

/* What is looked at of a line. */
typedef struct vs_causes vs_causes;

/* A run as vs_session_run does it, or vs_steady_run. */
typedef vs_status vs_causes_run(const vs_session *session, vs_scene *scene, vs_result *result,
                                vs_error *err);

/* Finds the causes of a result. Where the run for them fails, the lines have the reason. Error:
 * VS_SIGNAL. vs_causes_free is due also after an error. */
vs_status vs_causes_find(const vs_result *result, vs_causes_run *run,
                         const volatile sig_atomic_t *stop, vs_causes **causes, vs_error *err);
void vs_causes_free(vs_causes *causes);

/* Prints a line for each: "why thyristor.di_dt: 18.1 of 30.4 A from varistor_1's capacitance, ...".
 */
void vs_causes_show(const vs_causes *causes, FILE *out);
/* Adds the member "cause" of that line of the verdict to a summary, where it has one. */
void vs_causes_json(const vs_causes *causes, const vs_judgement *of, vs_json *json);

#endif
