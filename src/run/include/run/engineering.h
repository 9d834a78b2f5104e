/* SPDX-License-Identifier: GPL-3.0-or-later
 * A value with its unit, as people read it: four significant digits, and the prefix that leaves one
 * to three digits before the point. */
#pragma once

enum { VS_ENGINEERING_SIZE = 48 };

/* Writes the value, which is in `unit`, and returns the text: "833.4 mA", "0.6669 V/us", "0.0656".
 * A unit takes a prefix where it is a single one of SI without a prefix of its own, as "A" and
 * "Hz"; angles, temperatures and masses take none. */
const char *vs_engineering_text(double value, const char *unit, char text[VS_ENGINEERING_SIZE]);

/* Writes both ends of a range with one unit, that of the larger one, and returns the text:
 * "-244.2 um .. 264.9 um". */
const char *vs_engineering_range(double least, double largest, const char *unit,
                                 char text[2 * VS_ENGINEERING_SIZE]);
