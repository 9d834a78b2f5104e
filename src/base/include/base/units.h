/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers with units: "6 mm", "0.1 N.s/m", "95deg", "3.86e-3 kg.m2". */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

/* Reads text as a quantity of the same kind as `unit` and gives it in SI. "" is the unit of a pure
 * number, and "%" counts as one. The text must have a unit unless the number is 0 or pure. Units
 * may have the prefixes f p n u µ m c k M G, products with '.' or '*', one '/', and whole powers
 * ("m2" or "m^2"). Returns false when the text cannot be read; why[size] then says what is wrong
 * and what would be right, without a final stop. */
bool vs_units_read(const char *text, const char *unit, double *si, char *why, size_t size);

/* Returns the SI value of one `unit`; 1 for "". The unit must be one that vs_units_known knows. */
double vs_units_factor(const char *unit);
bool vs_units_known(const char *unit);
/* True if both are units and measure the same kind of quantity. */
bool vs_units_same_kind(const char *unit, const char *other);

/* Adds a regular expression, in the words that ECMA-262 and Python share, of a number with a unit
 * of the same kind: any name of that kind with any prefix, products and quotients of the powers, up
 * to 3, of two names, and `unit` as it is written with other names. */
void vs_units_pattern(const char *unit, vs_text *pattern);

/* The powers of a unit: of mass, length, time, current, angle, temperature, cycles, a temperature
 * that is counted from 0 degC, which is not a difference of two, and the root of a time, in which
 * makers give I2sqrt(t). Returns false where it is no unit. */
enum {
  VS_UNIT_KG,
  VS_UNIT_M,
  VS_UNIT_S,
  VS_UNIT_A,
  VS_UNIT_ANGLE,
  VS_UNIT_K,
  VS_UNIT_CYCLES,
  VS_UNIT_CELSIUS,
  VS_UNIT_ROOT_S
};
enum { VS_UNIT_POWERS = VS_UNIT_ROOT_S + 1 };
bool vs_units_powers(const char *unit, int power[VS_UNIT_POWERS]);

/* Writes the unit as it ends a CSV column's name: "m/s2" as "m_s2", "Wb" as "wb", "" as "". */
void vs_units_suffix(const char *unit, char *suffix, size_t size);

/* Returns the SI value of a unit that a CSV column's name ends in, written as vs_units_suffix
 * writes it or with its capitals: "mm_s2", "ma", "mA". NaN: there is no unit of that name of the
 * same kind as `unit`. */
double vs_units_suffix_factor(const char *suffix, const char *unit);
