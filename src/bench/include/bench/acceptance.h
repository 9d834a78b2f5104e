/* SPDX-License-Identifier: GPL-3.0-or-later
 * The acceptance test of a part: tries it on the test stand, holds what it got to what the part's
 * file asks, and names what is implausible. */
#pragma once

#include "run/findings.h"

/* The hook of `check` for parts. With options->folder it writes bench.csv, bench.json and, where
 * gnuplot is installed, bench.png there. Of a part of a kind that is not tried it says so. Errors:
 * the part cannot be put on the stand; a file cannot be written. */
vs_status vs_acceptance_try(const vs_check_options *options, vs_check_bench *bench, vs_error *err);
