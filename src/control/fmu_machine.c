/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/fmu_machine.h"

/* FMI 2.0 has no name for others than Intel's; FMI 3.0 has those below. */
#if defined __x86_64__
#define MACHINE "linux64", "x86_64-linux"
#elif defined __i386__
#define MACHINE "linux32", "x86-linux"
#elif defined __aarch64__
#define MACHINE "aarch64-linux", "aarch64-linux"
#elif defined __arm__
#define MACHINE "aarch32-linux", "aarch32-linux"
#elif defined __riscv && __riscv_xlen == 64
#define MACHINE "riscv64-linux", "riscv64-linux"
#elif defined __powerpc64__
#define MACHINE "ppc64-linux", "ppc64-linux"
#else
#define MACHINE "unknown-linux", "unknown-linux"
#endif

const char *vs_fmu_machine(int version) {
  return (const char *const[]){MACHINE}[version - 2];
}
