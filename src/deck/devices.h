/* SPDX-License-Identifier: GPL-3.0-or-later
 * The devices of a deck, whose stress is measured: the contract's lines device and zth, and, once
 * the parts are chosen, what each device is and which limits it is held against. What is measured
 * of a device says its kind (deck/kinds.h). */
#ifndef VS_DECK_DEVICES_H
#define VS_DECK_DEVICES_H

#include "deck/deck.h"
#include "deck/kinds.h"

/* Each reads the rest of one line, behind its first word. Errors with their place. */
vs_status vs_devices_line(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_zth(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_devices_pulse(vs_deck *deck, vs_cursor *c, vs_error *err);

/* Gives devices their kinds, parts, gates and wards, once the parts are chosen. Errors with their
 * place, each of which a check carries on from: a device that is no part and of no kind, a gate
 * that no port has, a limit in a unit of another kind, a device to protect that is not there. */
vs_status vs_devices_resolve(vs_deck *deck, vs_error *err);

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

/* True where the device's part has a table of pulses. */
bool vs_devices_has_pulses(const vs_deck *deck, const vs_device *device);

/* The peak current, A, that the device bears in `number` pulses of that width, by its part's table:
 * a power law between two rows of it, of width and of number. A shorter pulse, and a smaller
 * number, than the table has is taken for the least that it has. Returns NaN where the table ends
 * before, or where there is none. *assumed: one of the rows used is. */
double vs_devices_bears(const vs_deck *deck, const vs_device *device, double width_s, double number,
                        bool *assumed);

/* True where device number `device` protects another one and, by the makers' figures, may let more
 * through (i2t_clear) than that one bears (i2t). `text` then says so. */
bool vs_devices_fails_ward(const vs_deck *deck, size_t device, char *text, size_t size);

#endif
