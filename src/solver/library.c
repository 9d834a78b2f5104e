/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/library.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/leave.h"
#include "base/path.h"

#ifndef VS_NGSPICE
#error "the build names the file of libngspice"
#endif

static struct {
  vs_library library;
  bool loaded, begun;
  char why[256]; /* it could not be loaded */
  vs_library_begin begin;
  bool expected; /* the thread runs, or has ended and was not waited for */
  pthread_t thread;
  pid_t owner; /* the process that has the thread */
} spice;

/* ---- the library ---- */

/* Writes the address of a function to *function. C has no cast from data to a function. */
static bool find(void *handle, const char *name, void *function) {
  void *found = dlsym(handle, name);
  if (!found) snprintf(spice.why, sizeof spice.why, "%s", dlerror());
  memcpy(function, &found, sizeof found);
  return found;
}

static bool load(void) {
  if (spice.loaded) return true;
  vs_library *l = &spice.library;
  void *handle = dlopen(VS_NGSPICE, RTLD_LAZY | RTLD_LOCAL);
  if (!handle) snprintf(spice.why, sizeof spice.why, "%s", dlerror());
  spice.loaded = handle && find(handle, "ngSpice_Init", &l->init) &&
                 find(handle, "ngSpice_Init_Sync", &l->init_sync) &&
                 find(handle, "ngSpice_Circ", &l->circuit) &&
                 find(handle, "ngSpice_Command", &l->command) &&
                 find(handle, "ngSpice_SetBkpt", &l->set_breakpoint);
  return spice.loaded;
}

/* The folder in which ngspice looks for spinit: here it is the one that it begins in. */
static const char SCRIPTS[] = "SPICE_SCRIPTS";

/* Removes the variables by which a user tells ngspice where its files are, and so whose spinit it
 * runs, and more of the kind. */
static void set_environment(void) {
  static const char *const NAMES[] = {"SPICE_LIB_DIR",
                                      "SPICE_EXEC_DIR",
                                      "SPICE_PATH",
                                      "SPICE_HELP_DIR",
                                      "SPICE_NEWS",
                                      "SPICE_MAPFILE",
                                      "SPICE_ASCIIRAWFILE",
                                      "SPICE_EDITOR",
                                      "SPICE_HOST",
                                      "SPICE_BUGADDR",
                                      "SPICE_NO_DATASEG_CHECK",
                                      "NGSPICE_INPUT_DIR",
                                      "NGSPICE_MEAS_PRECISION"};
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) unsetenv(NAMES[k]);
  setenv(SCRIPTS, ".", 1);
}

static void call_begin(void) {
  spice.begin(&spice.library);
  spice.begun = true;
}

/* ---- where it begins ---- */

/* The files that ngspice reads in the place of the user's and of its own. */
static const char INIT[] = ".spiceinit", SPINIT[] = "spinit";

/* Goes to the folder that comes with the program, whose files of these names say nothing. */
static bool enter_shipped(void) {
  char path[VS_PATH_SIZE];
  static const vs_shelf SHELF = {"", "ngspice", ""};
  if (!vs_path_shipped(&SHELF, INIT, path)) return false;
  path[strlen(path) - strlen(INIT)] = '\0';
  return !chdir(path);
}

/* Makes a folder below $TMPDIR, or /tmp. Returns false where it cannot; errno says why. */
static bool make_folder(char path[VS_PATH_SIZE]) {
  const char *temporary = getenv("TMPDIR");
  snprintf(path, VS_PATH_SIZE, "%.4000s/vibrospice.XXXXXX",
           temporary && *temporary ? temporary : "/tmp");
  return mkdtemp(path) != NULL;
}

static bool make_empty(const char *name) {
  int file = open(name, O_WRONLY | O_CREAT | O_EXCL, 0600);
  if (file >= 0) close(file);
  return file >= 0;
}

/* Begins in a private folder. Signals are held back as long as that is there; `home` is the working
 * directory, from which the paths of what is noted for removal lead. */
static vs_status begin_in_private(int home, vs_error *err) {
  char folder[VS_PATH_SIZE] = ".", init[VS_PATH_SIZE + 16], spinit[VS_PATH_SIZE + 16];
  vs_status status = VS_OK;
  sigset_t before;
  vs_leave_hold(&before);
  bool made = make_folder(folder);
  snprintf(init, sizeof init, "%s/%s", folder, INIT);
  snprintf(spinit, sizeof spinit, "%s/%s", folder, SPINIT);
  if (made)
    vs_leave_from(home), vs_leave_remove(folder), vs_leave_remove(init), vs_leave_remove(spinit);
  bool entered = made && !chdir(folder);
  if (entered && make_empty(INIT) && make_empty(SPINIT))
    call_begin();
  else
    status = vs_fail(err, VS_RUN, "no private folder for ngspice: %s: %s", folder, strerror(errno));
  if (entered) unlink(INIT), unlink(SPINIT);
  if (made && fchdir(home) && !status)
    status = vs_fail(err, VS_RUN, "the working directory is gone: %s", strerror(errno));
  if (made) rmdir(folder);
  vs_leave_from(AT_FDCWD);
  vs_leave_forget(folder), vs_leave_forget(init), vs_leave_forget(spinit);
  vs_leave_release(&before);
  return status;
}

/* Begins, and comes back to the working directory. */
static vs_status begin_here(vs_error *err) {
  int home = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (home < 0)
    return vs_fail(err, VS_RUN, "no working directory for ngspice: %s", strerror(errno));
  vs_status status = VS_OK;
  if (!enter_shipped())
    status = begin_in_private(home, err);
  else {
    call_begin();
    if (fchdir(home))
      status = vs_fail(err, VS_RUN, "the working directory is gone: %s", strerror(errno));
  }
  close(home);
  return status;
}

/* ---- the thread ---- */

/* The working directory is the process's, unless the thread has one of its own (unshare). Some
 * containers do not allow that; the library is loaded even so. */
static void *work(void *unused) {
  (void)unused;
  if (load() && !unshare(CLONE_FS) && enter_shipped()) call_begin();
  return NULL;
}

/* Waits for the thread. At the end of the process, too, as nothing may be loaded while all that is
 * there is taken down. */
static void await_thread(void) {
  if (!spice.expected || getpid() != spice.owner) return;
  spice.expected = false;
  pthread_join(spice.thread, NULL);
}

void vs_library_expect(vs_library_begin begin) {
  sigset_t before;
  if (spice.expected || spice.loaded) return;
  set_environment();
  spice.begin = begin;
  spice.owner = getpid();
  vs_leave_hold(&before); /* the thread keeps them held back */
  spice.expected = !atexit(await_thread) && !pthread_create(&spice.thread, NULL, work, NULL);
  vs_leave_release(&before);
}

vs_status vs_library_open(vs_library_begin begin, vs_error *err) {
  vs_status status = VS_OK;
  await_thread();
  if (!spice.begun) {
    set_environment();
    spice.begin = begin;
    status =
        load() ? begin_here(err) : vs_fail(err, VS_RUN, "ngspice cannot be loaded: %s", spice.why);
  }
  unsetenv(SCRIPTS); /* programs that this one starts may be another ngspice */
  return status;
}
