/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as JSON for programs: the file summary.json. */
#ifndef VS_COMMAND_SUMMARY_H
#define VS_COMMAND_SUMMARY_H

#include "base/text.h"
#include "scene/result.h"

/* Appends the result to `json`. with_cost: wall times and steps, too, which no two runs share. */
void vs_summary_json(const vs_result *result, bool with_cost, vs_text *json);

#endif
