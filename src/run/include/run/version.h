/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which program wrote a file: its version, and those of the libraries its numbers depend on. */
#pragma once

#include "base/json.h"

/* Adds the member "program": {"version", "ngspice", "gsl"}. */
void vs_version_json(vs_json *json);

/* Returns a digest over the program's sources (tools/sources.cmake). Programs of
 * one version differ in it where they were built between two releases. */
const char *vs_version_sources(void);
