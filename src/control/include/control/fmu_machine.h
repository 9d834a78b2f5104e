/* SPDX-License-Identifier: GPL-3.0-or-later
 * What functional mock-up units call this machine. */
#pragma once

/* The folder below binaries/ for a unit of FMI `version`, 2 or 3: "x86_64-linux". */
const char *vs_fmu_machine(int version);
