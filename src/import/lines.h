/* SPDX-License-Identifier: GPL-3.0-or-later
 * The lines that tell a deck what to measure of each element: ports, probes, ratings, devices,
 * losses, stores. If a deck has no room for all of them, thyristors come first and nets last. */
#pragma once

#include "fate.h"

/* Adds the lines to plan->sheet, and notes what is not measured. Error, with its place: the pins of
 * a shipped part are connected as no thyristor's can be. */
vs_status vs_lines_add(vs_fate *plan, vs_error *err);
