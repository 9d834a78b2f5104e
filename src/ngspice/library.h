/* SPDX-License-Identifier: GPL-3.0-or-later
 * libngspice, the library. It is loaded when the first circuit is to be solved, and not when the
 * program starts: most of what the program does needs none.
 *
 * Loading it in a second thread while the scene is read was tried. It saved 0.3 ms of 4 ms, and
 * made every run 3 % longer: ngspice takes a lock around each of its requests for memory, and locks
 * are dear in a process that has ever had two threads. */
#pragma once

#include <stdbool.h>

#include <ngspice/sharedspice.h>

#include "base/error.h"

/* Its functions that are used, under the names that sharedspice.h has for them without "ngSpice_".
 */
typedef struct vs_library {
  __typeof__(ngSpice_Init) *init;
  __typeof__(ngSpice_Init_Sync) *init_sync;
  __typeof__(ngSpice_Circ) *circuit;
  __typeof__(ngSpice_Command) *command;
  __typeof__(ngSpice_SetBkpt) *set_breakpoint;
  __typeof__(ngGet_Vec_Info) *vector; /* NULL: it has none of that name */
} vs_library;

/* Calls init and init_sync. */
typedef void (*vs_library_begin)(const vs_library *library);

/* Loads the library and calls begin; it is called once in a process. ngspice reads .spiceinit from
 * the working directory, else from the user's home; begin is called in a folder with one that says
 * nothing, so that a scene gives the same result for everyone. It begins without its code models,
 * the elements whose names begin with "a": ngspice goes through all types of devices that it has
 * several times in every step, and with these, which few netlists have, that is a fifteenth of a
 * run. Errors, VS_RUN: there is no such library, or no folder for it. */
vs_status vs_library_open(vs_library_begin begin, vs_error *err);

/* Loads ngspice's code models where it has begun without them; where their folder is not found
 * beside the library, by calling begin once more, which ngspice takes only while it has had no
 * circuit. Errors: those of vs_library_open. */
vs_status vs_library_complete(vs_error *err);
