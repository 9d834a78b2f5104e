/* SPDX-License-Identifier: GPL-3.0-or-later
 * The library as it is installed: the program of docs/install.md, which stands outside, is built
 * over it by CMake's find_package and by pkg-config, and prints what the page says. */
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

/* The built program prints what the page says. */
static void expect_page(const char *program, int line) {
  int status;
  char *says = shell(program, &status), *page = read_file(PAGE);
  expect(status == 0 && *says && strstr(page, says), line, "%s: status %d: %s", program, status,
         says);
  free(page);
  free(says);
}
#define EXPECT_PAGE(program) expect_page(program, __LINE__)

/* ---- the tests, in this order ---- */

static void installing(void) {
  char folder[VS_PATH_SIZE];
  unsetenv("DESTDIR");
  unsetenv("VIBROSPICE_PATH");
  SHELL_GOOD("'" VS_CMAKE "' --install '" VS_BUILD_TREE "' --prefix \"$PWD/there\"");
  write_block("c", "swing.c");
  write_block("cmake", "CMakeLists.txt");
  char *here = realpath(".", NULL);
  snprintf(folder, sizeof folder, "%s/there/" VS_LIBDIR "/pkgconfig", here);
  setenv("PKG_CONFIG_PATH", folder, 1);
  snprintf(folder, sizeof folder, "%s/there", here);
  setenv("CMAKE_PREFIX_PATH", folder, 1);
  snprintf(folder, sizeof folder, "%s/there/" VS_LIBDIR, here);
  setenv("LD_LIBRARY_PATH", folder, 1);
  free(here);
  SHELL_GOOD("test -e $(pkg-config --variable=library vibrospice)/scenes/paper.yaml");
  SHELL_GOOD("test \"$(cd there/include && echo vibrospice/*)\" = "
             "'vibrospice/law.h vibrospice/vibrospice.h'");
}

/* The shim and the program that it packs are installed elsewhere than they lie in the build. */
static void a_unit(void) {
  SHELL_GOOD("there/bin/vibrospice export paper --with-program -o x.fmu && test -s x.fmu");
}

static void by_pkg_config(void) {
  SHELL_GOOD("'" VS_COMPILER "' " FLAGS " -std=c99 -Wall -Wextra -Wpedantic -Werror swing.c "
             "$(pkg-config --cflags --libs vibrospice) -o swing");
  EXPECT_PAGE("./swing");
}

static void statically(void) {
  SHELL_GOOD("'" VS_COMPILER "' " FLAGS " swing.c $(pkg-config --cflags vibrospice)"
             " there/" VS_LIBDIR "/libvibrospice.a -lpthread -ldl -o static");
  EXPECT_PAGE("PATH=\"$PWD/there/bin:$PATH\" ./static");
}

/* As C++ sees the header. */
static void from_cxx(void) {
  SHELL_GOOD("echo '#include <vibrospice/vibrospice.h>' >own.cc;"
             " ! command -v g++ >/dev/null || g++ -fsyntax-only -Wall -Wextra -Wpedantic -Werror"
             " $(pkg-config --cflags vibrospice) own.cc");
}

static void by_cmake(void) {
  SHELL_GOOD("'" VS_CMAKE "' -S . -B build -G '" VS_GENERATOR "' -DCMAKE_C_COMPILER='" VS_COMPILER
             "' -DCMAKE_C_FLAGS='" FLAGS "' && '" VS_CMAKE "' --build build");
  EXPECT_PAGE("build/swing");
}

/* The interface may be another in any other version. */
static void another_version_is_refused(void) {
  int status;
  SHELL_GOOD("sed 's/(vibrospice [0-9.]*/(vibrospice 0.0/' CMakeLists.txt >other &&"
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
                                  {"by the archive", statically},
                                  {"a unit", a_unit},
                                  {"from C++", from_cxx},
                                  {"by CMake", by_cmake},
                                  {"another version is refused", another_version_is_refused}};
  return program_suite("library", TESTS, COUNT(TESTS));
}
