/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "library.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/path.h"
#include "base/shutdown.h"

#ifndef VS_NGSPICE
#error "the build names the file of libngspice"
#endif

static struct {
  vs_library library;
  bool loaded;
  bool lean;     /* it begins, or has begun, without code models */
  char why[256]; /* it could not be loaded */
  vs_library_begin begin;
} spice;

/* ---- the library ---- */

/* Writes the address of a function to *function. C has no cast from data to a function. */
static bool find_function(void *handle, const char *name, void *function) {
  void *found = dlsym(handle, name);
  if (!found) snprintf(spice.why, sizeof spice.why, "%s", dlerror());
  memcpy(function, &found, sizeof found);
  return found;
}

static bool load_library(void) {
  if (spice.loaded) return true;
  vs_library *l = &spice.library;
  void *handle = dlopen(VS_NGSPICE, RTLD_LAZY | RTLD_LOCAL);
  if (!handle) snprintf(spice.why, sizeof spice.why, "%s", dlerror());
  spice.loaded = handle && find_function(handle, "ngSpice_Init", &l->init) &&
                 find_function(handle, "ngSpice_Init_Sync", &l->init_sync) &&
                 find_function(handle, "ngSpice_Circ", &l->circuit) &&
                 find_function(handle, "ngSpice_Command", &l->command) &&
                 find_function(handle, "ngSpice_SetBkpt", &l->set_breakpoint) &&
                 find_function(handle, "ngGet_Vec_Info", &l->vector);
  return spice.loaded;
}

/* Names the folder of spinit. */
static const char SCRIPTS[] = "SPICE_SCRIPTS";

/* Removes the variables by which a user tells ngspice where its files are, and so whose spinit it
 * runs, and more of the kind. Without them it takes those that it was installed with, code models
 * included. */
static void forget_environment(void) {
  const char *const NAMES[] = {"SPICE_LIB_DIR",     SCRIPTS,
                               "SPICE_EXEC_DIR",    "SPICE_PATH",
                               "SPICE_HELP_DIR",    "SPICE_NEWS",
                               "SPICE_MAPFILE",     "SPICE_ASCIIRAWFILE",
                               "SPICE_EDITOR",      "SPICE_HOST",
                               "SPICE_BUGADDR",     "SPICE_NO_DATASEG_CHECK",
                               "NGSPICE_INPUT_DIR", "NGSPICE_MEAS_PRECISION"};
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) unsetenv(NAMES[k]);
}

/* ---- where it begins ---- */

/* The files that ngspice reads in the place of the user's and of its own. */
static const char INIT[] = ".spiceinit", SPINIT[] = "spinit";

/* Finds the folder that comes with the program, whose two files say nothing. ngspice executes what
 * they say, shell commands too: it must be the program's own. */
static bool find_shipped(char path[VS_PATH_SIZE]) {
  static const vs_shelf SHELF = {"", "ngspice", ""};
  if (!vs_path_own(&SHELF, SPINIT, path) || !vs_path_own(&SHELF, INIT, path)) return false;
  path[strlen(path) - strlen(INIT)] = '\0';
  return true;
}

/* Goes there. */
static bool enter_shipped(void) {
  char path[VS_PATH_SIZE];
  return find_shipped(path) && !chdir(path);
}

/* Lets ngspice take the spinit of that folder, which loads no code models. */
static void begin_lean(void) {
  char path[VS_PATH_SIZE];
  spice.lean = find_shipped(path) && !setenv(SCRIPTS, path, 1);
}

/* Makes a folder below $TMPDIR, or /tmp. Returns false where it cannot; errno says why. */
static bool make_folder(char path[VS_PATH_SIZE]) {
  const char *temporary = getenv("TMPDIR");
  snprintf(path, VS_PATH_SIZE, "%.4000s/vibrospice.XXXXXX",
           temporary && *temporary ? temporary : "/tmp");
  return mkdtemp(path) != NULL;
}

/* Opens the working directory. From there, and not from the folder where ngspice begins, lead the
 * paths of what is removed if the process ends meanwhile. Returns -1 where it cannot. */
static int open_home(void) {
  int home = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (home >= 0) vs_shutdown_paths_from(home);
  return home;
}

static void close_home(int home) {
  vs_shutdown_paths_from(AT_FDCWD);
  close(home);
}

/* Begins in a private folder. Signals are held back as long as that is there; `home` is the working
 * directory. */
static vs_status begin_in_private(int home, vs_error *err) {
  char folder[VS_PATH_SIZE] = ".", settings[VS_PATH_SIZE + 16];
  vs_status status = VS_OK;
  sigset_t before;
  int empty = -1;
  vs_shutdown_block_signals(&before);
  bool made = make_folder(folder);
  snprintf(settings, sizeof settings, "%s/%s", folder, INIT);
  if (made) vs_shutdown_remove(folder), vs_shutdown_remove(settings);
  if (made && !chdir(folder)) empty = open(INIT, O_WRONLY | O_CREAT | O_EXCL, 0600);
  if (empty < 0)
    status = vs_fail(err, VS_RUN, "no private folder for ngspice: %s: %s", folder, strerror(errno));
  else {
    close(empty);
    spice.begin(&spice.library);
    unlink(INIT);
  }
  if (made && fchdir(home) && !status)
    status = vs_fail(err, VS_RUN, "the working directory is gone: %s", strerror(errno));
  if (made) rmdir(folder);
  vs_shutdown_forget(folder), vs_shutdown_forget(settings);
  vs_shutdown_unblock_signals(&before);
  return status;
}

/* Begins, and comes back to the working directory. */
static vs_status begin_here(vs_error *err) {
  int home = open_home();
  if (home < 0)
    return vs_fail(err, VS_RUN, "no working directory for ngspice: %s", strerror(errno));
  vs_status status = VS_OK;
  if (!enter_shipped())
    status = begin_in_private(home, err);
  else {
    spice.begin(&spice.library);
    if (fchdir(home))
      status = vs_fail(err, VS_RUN, "the working directory is gone: %s", strerror(errno));
  }
  close_home(home);
  return status;
}

/* ---- opened, and with code models ---- */

/* Their folder is beside the library's file, wherever ngspice was installed. */
static int find_models(glob_t *found) {
  char pattern[VS_PATH_SIZE];
  void *function;
  Dl_info info;
  memcpy(&function, &spice.library.init, sizeof function); /* C has no cast to data */
  const char *file = dladdr(function, &info) ? info.dli_fname : "";
  const char *slash = strrchr(file, '/');
  snprintf(pattern, sizeof pattern, "%.*s/ngspice/*.cm", slash ? (int)(slash - file) : 0, file);
  return glob(pattern, 0, NULL, found);
}

vs_status vs_library_open(vs_library_begin begin, vs_error *err) {
  glob_t models;
  spice.begin = begin;
  if (!load_library()) return vs_fail(err, VS_RUN, "ngspice cannot be loaded: %s", spice.why);
  forget_environment();
  if (!find_models(&models)) begin_lean(), globfree(&models);
  vs_status status = begin_here(err);
  unsetenv(SCRIPTS); /* a program that this one starts may run another ngspice */
  return status;
}

/* Where the folder is elsewhere, ngspice begins once more, with its own spinit, which knows it. */
vs_status vs_library_complete(vs_error *err) {
  char command[VS_PATH_SIZE + 16];
  glob_t found;
  if (!spice.lean) return VS_OK;
  spice.lean = false;
  if (find_models(&found)) return begin_here(err);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    snprintf(command, sizeof command, "codemodel %s", found.gl_pathv[k]);
    spice.library.command(command);
  }
  globfree(&found);
  return VS_OK;
}
