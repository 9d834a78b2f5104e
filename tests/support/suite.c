/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "suite.h"

#include <dirent.h>
#include <ftw.h>
#include <gsl/gsl_errno.h>
#include <libfyaml.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ngspice/ngspice.h"

int vs_suite(const char *name, const vs_test *tests, size_t count) {
  gsl_set_error_handler_off();
  if (CU_initialize_registry()) return 1;
  CU_pSuite suite = CU_add_suite(name, NULL, NULL);
  for (size_t k = 0; k < count; k++) CU_add_test(suite, tests[k].name, tests[k].run);
  CU_basic_set_mode(CU_BRM_VERBOSE);
  CU_basic_run_tests();
  unsigned failed = CU_get_number_of_failures();
  CU_cleanup_registry();
  return failed != 0;
}

bool is_for_memory_alone(void) {
#ifdef __SANITIZE_ADDRESS__
  return !getenv("VS_LONG");
#else
  return false;
#endif
}

void vs_close(double got, double expected, double scale, double tolerance, const char *what,
              int line) {
  double error = fabs(got - expected) / fabs(scale);
  char text[256];
  snprintf(text, sizeof text, "%s = %.12g, expected %.12g: off by %.3g, allowed %.3g", what, got,
           expected, error, tolerance);
  CU_assertImplementation(error <= tolerance, (unsigned)line, text, "", "", CU_FALSE);
}

void expect(bool good, int line, const char *format, ...) {
  char text[2048];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  CU_assertImplementation(good, (unsigned)line, text, "", "", CU_FALSE);
}

const vs_judgement *judged_line(const vs_verdict *v, const char *name) {
  char own[VS_JUDGED_NAME];
  for (size_t k = 0; k < v->count; k++)
    if (!strcmp(vs_verdict_name(&v->item[k], own), name)) return &v->item[k];
  return NULL;
}

void write_file(const char *path, const char *text) {
  FILE *f = fopen(path, "wb");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  CU_ASSERT(fputs(text, f) >= 0);
  CU_ASSERT_EQUAL(fclose(f), 0);
}

char *listing(const char *folder) {
  vs_text names = {0};
  struct dirent **entries;
  int n = scandir(folder, &entries, NULL, alphasort);
  vs_text_add(&names, "%s", n < 0 ? "(no folder) " : "");
  for (int k = 0; k < n; k++) {
    const char *name = entries[k]->d_name;
    if (strcmp(name, ".") && strcmp(name, "..")) vs_text_add(&names, "%s ", name);
    free(entries[k]);
  }
  if (n >= 0) free(entries);
  return names.text;
}

void expect_files(const char *folder, const char *names, int line) {
  char *seen = listing(folder);
  expect(!strcmp(seen, names), line, "%s holds: %sand should: %s", folder, seen, names);
  free(seen);
}

bool on_path(const char *program) {
  const char *path = getenv("PATH");
  char *folders = vs_copy(path ? path : ""), *rest = folders, file[VS_PATH_SIZE];
  bool found = false;
  for (char *folder; !found && (folder = strsep(&rest, ":"));) {
    snprintf(file, sizeof file, "%s/%s", folder, program);
    found = !access(file, X_OK);
  }
  free(folders);
  return found;
}

bool is_newer_ngspice(void) {
  return strtod(vs_ngspice_version(), NULL) >= 44;
}

bool is_newer_yaml(void) {
  return strtod(fy_library_version(), NULL) >= 0.8;
}

static int remove_entry(const char *path, const struct stat *s, int kind, struct FTW *at) {
  (void)s, (void)kind, (void)at;
  return remove(path);
}

void remove_tree(const char *path) {
  nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

double run_extreme(const vs_trial *t, const char *channel, int sense) {
  for (int k = 0; k < t->result.watchers.measures->n_extremes; k++) {
    const vs_extreme *e = &t->result.watchers.measures->extremes[k];
    if (e->sense == sense && !strcmp(vs_channel_at(&t->scene.frame, e->channel).name, channel))
      return e->best.value;
  }
  return NAN;
}
