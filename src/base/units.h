/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers with units: "6 mm", "0.1 N.s/m", "95deg", "3.86e-3 kg.m2". */
#ifndef VS_BASE_UNITS_H
#define VS_BASE_UNITS_H

#include <stdbool.h>
#include <stddef.h>

/* Reads text as a quantity of the same kind as unit ("" for a pure number; "%" counts as one) and
 * gives it in SI. A unit is required unless the number is 0 or the quantity pure. Prefixes f p n u
 * µ m c k M G; products with '.' or '*', one '/', integer powers ("m2" or "m^2").
 * false: not readable; why[size] then says, without a final stop, what is wrong and what would be
 * right. */
bool vs_units_read(const char *text, const char *unit, double *si, char *why, size_t size);

/* SI value of one `unit`; 1 for "". The unit must be readable (it comes from a table of ours or
 * from a deck that was checked with vs_units_known). */
double vs_units_factor(const char *unit);
bool vs_units_known(const char *unit);
bool vs_units_same_kind(const char *unit, const char *other); /* false also for one that is none */

/* Writes the unit as it ends a CSV column's name: "m/s2" as "m_s2", "Wb" as "wb", "" as "". */
void vs_units_suffix(const char *unit, char *suffix, size_t size);

/* SI value of the unit of the same kind as `unit` that a CSV column's name ends in, written as
 * vs_units_suffix writes it or with its capitals: "mm_s2", "ma", "mA". NAN: it names no such unit.
 */
double vs_units_suffix_factor(const char *suffix, const char *unit);

#endif
