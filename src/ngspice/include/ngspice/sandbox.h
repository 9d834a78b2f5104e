/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a process gives up before it lets ngspice read a netlist that others have written. A fault
 * in ngspice may let a netlist do what its author likes; what the process can no longer do, the
 * netlist cannot do either. A filter of system calls in the kernel (seccomp) refuses them with
 * EPERM, so that the process goes on. It holds for the rest of the process and for all it starts,
 * and cannot be taken off. docs/strangers.md lists what is refused. */
#pragma once

#include <stdbool.h>

/* Each gives up what the one before it does, and more. */
typedef enum vs_sandbox {
  VS_SANDBOX_NETWORK, /* no sockets, no tracing of other processes, no keys typed into the terminal,
                         nothing of an administrator's */
  VS_SANDBOX_WORKER,  /* no other program is started, no memory shared with one */
  VS_SANDBOX_TRIAL    /* no process is started or ended, and no file opened for writing; at most
                         VS_SANDBOX_TRIAL_BYTES of memory */
} vs_sandbox;

/* So much more memory than ngspice needs for a circuit that could be run in useful time. */
#define VS_SANDBOX_TRIAL_BYTES (2ull << 30)

/* Confines this process from now on. False where the kernel has no such filter; the limit on memory
 * holds even so. */
bool vs_sandbox_process(vs_sandbox level);

/* True where the kernel has such a filter. */
bool vs_sandbox_works(void);
