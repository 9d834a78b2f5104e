/* SPDX-License-Identifier: GPL-3.0-or-later
 * The causes behind a verdict (`run --why`): of each violated line, or of the weakest where none is
 * violated. The scene is run once more, up to the last instant that is asked for. There the signals
 * of the whole circuit tell which branches a device's current comes from, or which elements its
 * voltage is made of. */
#pragma once

#include <stdio.h>

#include "base/json.h"
#include "run/session.h"

/* The most lines that are explained; further violated ones are left out. */
enum { VS_CAUSES_MOST = 12 };

typedef struct vs_causes vs_causes;

/* A run as vs_session_run does it, or vs_steady_run. */
typedef vs_status vs_causes_run(const vs_session *session, vs_scene *scene, vs_result *result,
                                vs_error *err);

/* Finds the causes of a result, which is borrowed. A line whose cause was not found has the reason
 * instead. Error: VS_SIGNAL. vs_causes_free is due also after an error. */
vs_status vs_causes_find(const vs_result *result, vs_causes_run *run,
                         const volatile sig_atomic_t *stop, vs_causes **causes, vs_error *err);
void vs_causes_free(vs_causes *causes);

/* Prints a line for each: "why thyristor.v_reverse: 1.05 kV at 15.2 ms, made of 621 V from the
 * mains, ...". */
void vs_causes_show(const vs_causes *causes, FILE *out);
/* Adds the member "cause" to that line of the verdict in a summary, if the line was looked at. */
void vs_causes_json(const vs_causes *causes, const vs_judgement *of, vs_json *json);
