/* SPDX-License-Identifier: GPL-3.0-or-later
 * What parts are, what their makers allow, and what a deck asks of both: the contract's lines part,
 * limit, rating, require and model, and what comes of them once the parts are chosen. */
#pragma once

#include "netlist/deck.h"
#include "netlist/kinds.h"

/* Each reads the rest of one line, behind its first word. Errors with their place. */
vs_status vs_parts_kind(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_limit(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_rating(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_require(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_model(vs_deck *deck, vs_cursor *c, vs_error *err);

/* Error: the part's file is of another kind than the deck wants, or says none. `where` is the place
 * where the part is named. */
vs_status vs_parts_check_kind(const vs_deck *deck, const vs_part *part, vs_where where,
                              vs_error *err);

/* What the file says of its part; NULL: nothing. */
const vs_part_file *vs_parts_file(const vs_deck *deck, const char *file);
/* The file's limit of that name; NULL: it has none. */
const vs_limit *vs_parts_find_limit(const vs_deck *deck, const char *file, const char *name);

/* True where the part's file states a limit. An ideal part has none, or "none" for each. */
bool vs_parts_is_real(const vs_deck *deck, const char *file);

/* How far a stretch of a rise of voltage rises over which dv/dt of the part is told, V: the file's
 * limit dv_dt_over; else a tenth of v_drm, and 10 V at the least, which is also what it is where
 * v_drm is not known or file is NULL. */
double vs_parts_dv_dt_over(const vs_deck *deck, const char *file);

/* The file's figure turn_on_time, s, over which di/dt of the part is told; 0: it has none. */
double vs_parts_turn_on_s(const vs_deck *deck, const char *file);

/* Gives ratings the limits of the parts chosen, and drops ratings that have no limit at either end.
 * Errors, each of which a check carries on from: no such part, no such limit in its file, a limit
 * in a unit of another kind, a rating from more to less; a limit dv_dt_over that is none, below 10
 * V or above v_drm; a line model of a figure that nothing hangs on. */
vs_status vs_parts_resolve(vs_deck *deck, vs_error *err);

/* Error, once formulas are bound: a condition between parameters that does not hold. `section` is
 * the scene's section circuit, in which the place of what breaks the condition is found; may be
 * NULL. */
vs_status vs_parts_require_hold(const vs_deck *deck, const vs_circuit_values *values,
                                const vs_node *section, vs_error *err);

/* The file's line model of that figure; NULL: it has none. */
const vs_model_line *vs_parts_find_model(const vs_deck *deck, const char *file, const char *figure);

/* What is known of the model that a margin hangs on: the line model of the device's part, or of the
 * part of another device that stands across it. */
typedef struct vs_model_beside {
  const vs_model_line *line;
  const vs_device *other; /* NULL: it is the device's own part */
} vs_model_beside;
enum { VS_MODELS_BESIDE = 4 }; /* more are left out */

/* Fills `out` with what a measure of the device hangs on, and returns how many there are. */
size_t vs_parts_models(const vs_deck *deck, const vs_device *device,
                       const vs_device_measure *measure, vs_model_beside out[VS_MODELS_BESIDE]);
/* The same of a rating of a probe, which hangs on the varistors across its nodes. */
size_t vs_parts_models_across(const vs_deck *deck, const vs_probe *probe,
                              vs_model_beside out[VS_MODELS_BESIDE]);

/* True where the mains alone, of this rms value, exceed what part number `part` allows. `text` then
 * says so. */
bool vs_parts_below_mains(const vs_deck *deck, size_t part, double rms_v, char *text, size_t size);

/* True where the limit is finite and nothing is held to it: no measure of its part's kind and no
 * rating of the deck. */
bool vs_parts_limit_is_left(const vs_deck *deck, const vs_limit *limit);

/* True where limit number `limit` is of a name that nothing is held against, neither a measure of
 * its part's kind nor a rating of the deck. `text` then says so, and which name may be meant. */
bool vs_parts_limit_is_idle(const vs_deck *deck, size_t limit, char *text, size_t size);
