/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of control that does what a law should not, for test_ownlaw: which of it, the environment
 * variable LAW says. LAW_FILE is a file that gets a line, with this process' number, when the
 * object is loaded. With another version, or with no function, where the compiler is told so. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#ifdef OTHER_VERSION
#define VIBROSPICE_LAW_READER
#endif
#include <vibrospice/law.h>

#ifdef OTHER_VERSION
__attribute__((visibility("default"))) extern const int vibrospice_law_version;
const int vibrospice_law_version = VIBROSPICE_LAW_VERSION + 1;
#endif

static const char *what(void) {
  const char *law = getenv("LAW");
  return law ? law : "";
}

__attribute__((constructor)) static void load(void) {
  const char *name = getenv("LAW_FILE");
  FILE *f = name ? fopen(name, "a") : NULL;
  if (f) fprintf(f, "%d\n", (int)getpid());
  if (f) fclose(f);
  if (!strcmp(what(), "crash at load")) raise(SIGSEGV);
  if (!strcmp(what(), "hang at load")) sleep(77);
  for (int k = 3; k < 6 && !strcmp(what(), "floods its pipe at load"); k++)
    for (int n = 0; n < 512; n++)
      if (write(k, "x", 1) < 0) break;
}

#ifndef NO_FUNCTION
double vibrospice_law(const vibrospice_firing *firing, char *error) {
  const char *law = what();
  if (!strcmp(law, "none")) return firing->number % 2 ? 100 : NAN;
  if (firing->number < 3) return 100;
  if (!strcmp(law, "crash")) raise(SIGSEGV);
  if (!strcmp(law, "exit")) exit(3);
  if (!strcmp(law, "hang")) sleep(77);
  if (!strcmp(law, "error")) strcpy(error, "the feeder\nis empty");
  if (!strcmp(law, "error of bytes")) strcpy(error, "the belt\xff\xfe is torn");
  if (!strcmp(law, "beyond")) return 180;
  if (!strcmp(law, "print")) printf("not an answer\n");
  return 100;
}
#endif
