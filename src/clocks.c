/* SPDX-License-Identifier: GPL-3.0-or-later
 * Clocks that stand still, for libngspice.
 *
 * ngspice notes how long each part of each step takes: it asks a clock 14 times a step, by ftime()
 * or, where it was built with HAVE_GETRUSAGE, by getrusage(), and clock() once. Nobody asks it for
 * these figures. A tenth of a run's time went into ftime(), and more than half into getrusage(),
 * which always is a call of the kernel's. The dynamic linker takes a function of the program before
 * one of the C library's, so that ngspice calls these three, which do nothing. Only the program has
 * them: no library that others link has. This program itself asks clock_gettime() and times(). */
#include <sys/resource.h>
#include <sys/timeb.h>
#include <time.h>

int ftime(struct timeb *now);

int ftime(struct timeb *now) {
  *now = (struct timeb){0};
  return 0;
}

clock_t clock(void) {
  return 0;
}

int getrusage(int who, struct rusage *used) {
  (void)who;
  *used = (struct rusage){0};
  return 0;
}
