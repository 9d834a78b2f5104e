/* SPDX-License-Identifier: GPL-3.0-or-later
 * A shared object for LD_PRELOAD, with which the clock of the day jumps at each look: ten years
 * ahead, thirty back, and a day ahead. Clocks that count from the machine's start stay as they are,
 * as they do when somebody sets the clock.
 *
 * Where VS_ASK_CLOCKS is set it says on standard error which of the clocks that libngspice may ask
 * stand still. The dynamic linker finds them for it as it does for libngspice. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static time_t jump(void) {
  static const time_t YEAR = 31556952, DAY = 86400;
  static _Atomic unsigned looks;
  switch (++looks % 3) {
  case 0:
    return 10 * YEAR;
  case 1:
    return -30 * YEAR;
  default:
    return DAY;
  }
}

int clock_gettime(clockid_t clock, struct timespec *now) {
  int failed = (int)syscall(SYS_clock_gettime, clock, now);
  if (!failed && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += jump();
  return failed;
}

time_t time(time_t *to) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (to) *to = now.tv_sec;
  return now.tv_sec;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone) {
  struct timespec t;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &t);
  *now = (struct timeval){t.tv_sec, t.tv_nsec / 1000};
  return 0;
}

int ftime(void *now); /* a struct timeb, whose header calls this one deprecated */

__attribute__((constructor)) static void ask_clocks(void) {
  struct rusage used;
  time_t now[8] = {0}; /* the first is the seconds of a struct timeb */
  if (!getenv("VS_ASK_CLOCKS")) return;
  ftime(now);
  getrusage(RUSAGE_SELF, &used);
  fprintf(stderr, "stand still: clock %d, ftime %d, getrusage %d\n", clock() == 0, now[0] == 0,
          used.ru_maxrss == 0);
}
