/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which figures behind a line of the verdict no source says, or calls typical. */
#pragma once

#include "base/json.h"
#include "branches.h"
#include "measure/verdict.h"

/* Lists those that lack this, VS_ASSUMED or VS_TYPICAL, as "switch.i_cm, circuit.gate_r": the
 * line's limit, the parameters in its device's formulas and, of the first `most` shares, those of
 * the element. Of an assumed model that a share comes from they are its part's limits, too. */
void vs_lacks_list(const vs_branches *branches, const vs_deck *deck, const vs_judgement *of,
                   const vs_shares *shares, size_t most, unsigned lack, vs_text *list);
/* The list as an array; NULL: it is empty. */
void vs_lacks_json(const char *key, const char *list, vs_json *json);
