/* SPDX-License-Identifier: GPL-3.0-or-later
 * The library as it is installed: the program of docs/install.md, which stands outside, is built
 * over it by CMake's find_package and by pkg-config. It prints what the page says, and what
 * `vibrospice run` finds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "program.h"

#define PAGE VS_TEST_FOLDER "/../docs/install.md"
#ifdef __SANITIZE_ADDRESS__ /* the library is then, too */
#define FLAGS "-fsanitize=address,undefined"
#else
#define FLAGS ""
#endif

/* Runs the shell's command; what it prints on both streams is to be freed. */
static char *shell(const char *command, int *status) {
  vs_text whole = {0};
  vs_text_add(&whole, "{ %s\n} >../says 2>&1", command);
  *status = system(whole.text);
  vs_text_free(&whole);
  return read_file("../says");
}

static void shell_good(const char *command, int line) {
  int status;
  char *says = shell(command, &status);
  expect(status == 0, line, "%s: %s", command, says);
  free(says);
}
#define SHELL_GOOD(command) shell_good(command, __LINE__)

/* Writes the page's first block of that language to a file. */
static void write_block(const char *language, const char *path) {
  char *page = read_file(PAGE), fence[16];
  snprintf(fence, sizeof fence, "\n```%s\n", language);
  char *block = strstr(page, fence), *end = block ? strstr(block + strlen(fence), "```\n") : NULL;
  EXPECT(end, "%s: no block of %s", PAGE, language);
  if (end) {
    *end = '\0';
    write_file(path, block + strlen(fence));
  }
  free(page);
}

static double number_after(const char *text, const char *word) {
  const char *at = strstr(text, word);
  return at ? strtod(at + strlen(word), NULL) : NAN;
}

/* The built program's peak: the page's within 1e-6 of it, as other libraries may be at work there,
 * and the command line's to the nine digits that are printed. */
static void expect_peak(const char *program, int line) {
  char command[256];
  int status;
  snprintf(command, sizeof command,
           "VIBROSPICE_PATH=$(pkg-config --variable=library vibrospice) %s", program);
  char *says = shell(command, &status), *page = read_file(PAGE);
  ran r = run("run paper --tier switched --json");
  double got = number_after(says, "p_first_peak = "),
         told = number_after(page, "\np_first_peak = "),
         wanted = number_after(r.out, "\"p_first_peak\": {\"value\": ");
  expect(status == 0 && fabs(got - wanted) <= 1e-8 * fabs(wanted), line,
         "%s: status %d, %.12g, not %.12g: %s", program, status, got, wanted, says);
  expect(fabs(got - told) <= 1e-6 * fabs(got), line, "%s: %.9g, on the page %.9g", program, got,
         told);
  free_ran(&r);
  free(page);
  free(says);
}
#define EXPECT_PEAK(program) expect_peak(program, __LINE__)

/* ---- the tests, in this order ---- */

static void installing(void) {
  char folder[VS_PATH_SIZE];
  unsetenv("DESTDIR");
  unsetenv("VIBROSPICE_PATH");
  SHELL_GOOD("'" VS_CMAKE "' --install '" VS_BUILD_TREE "' --prefix \"$PWD/there\"");
  write_block("c", "peak.c");
  write_block("cmake", "CMakeLists.txt");
  char *here = realpath(".", NULL);
  snprintf(folder, sizeof folder, "%s/there/" VS_LIBDIR "/pkgconfig", here);
  setenv("PKG_CONFIG_PATH", folder, 1);
  snprintf(folder, sizeof folder, "%s/there", here);
  setenv("CMAKE_PREFIX_PATH", folder, 1);
  free(here);
  SHELL_GOOD("test -e $(pkg-config --variable=library vibrospice)/scenes/paper.yaml");
}

static void by_pkg_config(void) {
  SHELL_GOOD("'" VS_COMPILER "' " FLAGS
             " -Wall -Wextra -Werror peak.c $(pkg-config --cflags --libs vibrospice) -o peak");
  EXPECT_PEAK("./peak");
}

static void by_cmake(void) {
  SHELL_GOOD("'" VS_CMAKE "' -S . -B build -G '" VS_GENERATOR "' -DCMAKE_C_COMPILER='" VS_COMPILER
             "' -DCMAKE_C_FLAGS='" FLAGS "' && '" VS_CMAKE "' --build build");
  EXPECT_PEAK("build/peak");
}

/* The interface may be another in any other version. */
static void another_version_is_refused(void) {
  int status;
  SHELL_GOOD("sed 's/(vibrospice [0-9.]*/(vibrospice 0.0.9/' CMakeLists.txt >other &&"
             " mv other CMakeLists.txt");
  char *says = shell("'" VS_CMAKE "' -S . -B other -G '" VS_GENERATOR
                     "' -DCMAKE_C_COMPILER='" VS_COMPILER "'",
                     &status);
  EXPECT(status != 0 && strstr(says, "version: " VS_VERSION), "status %d: %s", status, says);
  free(says);
}

int main(void) {
  static const vs_test TESTS[] = {{"installing", installing},
                                  {"by pkg-config", by_pkg_config},
                                  {"by CMake", by_cmake},
                                  {"another version is refused", another_version_is_refused}};
  return program_suite("library", TESTS, COUNT(TESTS));
}
