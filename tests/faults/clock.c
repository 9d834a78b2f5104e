/* SPDX-License-Identifier: GPL-3.0-or-later
 * A shared object for LD_PRELOAD, with which the clock of the day jumps at each look: ten years
 * ahead, thirty back, and a day ahead. Clocks that count from the machine's start stay as they are,
 * as they do when somebody sets the clock. */
#include <stddef.h>
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
