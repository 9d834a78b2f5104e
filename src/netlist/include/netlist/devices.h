/* SPDX-License-Identifier: GPL-3.0-or-later
 * The devices of a deck, whose stress is measured: the contract's lines device and zth, and, once
 * the parts are chosen, what each device is and which limits it is held against. What is measured
 * of a device says its kind (netlist/kinds.h). */
#pragma once

#include "netlist/deck.h"
#include "netlist/kinds.h"

/* Behind a device's name: the key of the part that says of which series it is. */
#define VS_DEVICE_PART "_part"

/* Each reads the rest of one line, behind its first word. Errors with their place. */
vs_status vs_devices_line(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_time_current(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_derate(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_zth(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_pulse(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_surge(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_at(vs_deck *deck, vs_cursor *c, vs_error *err);

/* Gives devices their kinds, parts, gates and wards, once the parts are chosen. Errors with their
 * place, each of which a check carries on from: a device that is no part and of no kind, a gate
 * that no port has, a limit in a unit of another kind, a device to protect that is not there. */
vs_status vs_devices_resolve(vs_deck *deck, vs_error *err);

/* Finds what the devices' measures are held to, where the deck's limits have become others. */
void vs_devices_hold(vs_deck *deck);

/* The limit that a measure of the device is held against, from the file of its part or of the part
 * it protects. NULL where there is none, or where the file says "none". */
const vs_limit *vs_devices_limit(const vs_deck *deck, const vs_device *device,
                                 const vs_device_measure *measure);

/* True where the device's part is a real one, as its file states a finite limit, and where the file
 * says nothing, not even "none", of the limit of that measure, which decides (vs_kinds_decides). */
bool vs_devices_lacks(const vs_deck *deck, const vs_device *device,
                      const vs_device_measure *measure);

/* The same as vs_parts_dv_dt_over, of the device's part. */
double vs_devices_dv_dt_over(const vs_deck *deck, const vs_device *device);

/* What its part's file says of this limit; NULL: nothing. */
const vs_limit *vs_devices_own_limit(const vs_deck *deck, const vs_device *device,
                                     const char *name);

/* What the part's lines `derate` leave of a limit of it at that ambient temperature, degC, on a
 * straight line between two of them. Returns the limit itself where no such line names it, or all
 * of it is left; NULL where the lines end before that temperature with something left; else `own`,
 * which it fills. Where nothing is left, the limit is a billionth of what it was: margins are parts
 * of it. */
const vs_limit *vs_devices_derated(const vs_deck *deck, const vs_limit *limit, double ambient_degc,
                                   vs_limit *own);

/* The shortest and the longest time of the device's time-current curve, s; false: it has none. */
bool vs_devices_curve(const vs_deck *deck, const vs_device *device, double span_s[2]);
/* The current, A, at which the device melts in that time by its curve: a power law between two of
 * its points. NaN outside of it. *unsure: what those used lack. */
double vs_devices_melts_at(const vs_deck *deck, const vs_device *device, double time_s,
                           unsigned *unsure);

/* The least current, A, of the part's table of pulses; 0: it has no table. */
double vs_devices_least_pulse(const vs_deck *deck, const vs_device *device);

/* The peak current, A, that the device bears in `number` pulses of that width, by its part's table:
 * a power law between two rows of it, of width and of number. A shorter pulse, and a smaller
 * number, than the table has is taken for the least that it has. Returns NaN where the table ends
 * before, or where there is none. *unsure: what those used lack. */
double vs_devices_bears(const vs_deck *deck, const vs_device *device, double width_s, double number,
                        unsigned *unsure);

/* The peak current, A, that the device bears in `number` consecutive cycles, by its part's lines
 * surge: a power law between two of them. Below the least number it is what the part bears in that
 * one. Returns NaN beyond the largest, or where there is none. *unsure: what those used lack. */
double vs_devices_bears_surge(const vs_deck *deck, const vs_device *device, double number,
                              unsigned *unsure);
/* The largest number of cycles in these lines; 0: there is none. */
double vs_devices_most_surges(const vs_deck *deck, const vs_device *device);

/* What the part says of this limit at another temperature, and t_j_max, degC, at which the limit is
 * given. NULL: nothing. */
const vs_limit_at *vs_devices_limit_at(const vs_deck *deck, const vs_device *device,
                                       const char *limit, double *t_j_max_degc);

/* A thermal resistance, K/W, that the device's part states: "r_th_jc", "r_th_cs", "r_th_ja". Where
 * it has lines zth, their sum is r_th_jc. NaN: it states none. *unsure gets what it lacks, besides.
 */
double vs_devices_r_th(const vs_deck *deck, const vs_device *device, const char *name,
                       unsigned *unsure);

/* True where device number `device` protects another one and, by the makers' figures, may let more
 * through (i2t_clear) than that one bears (i2t). `text` then says so. */
bool vs_devices_fails_ward(const vs_deck *deck, size_t device, char *text, size_t size);
