/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/jail.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"

static struct {
  bool on;
  vs_text allowed; /* real paths of folders, each with a newline at its end */
} jail;

void vs_jail_begin(void) {
  jail.on = true;
}

bool vs_jail_is_on(void) {
  return jail.on;
}

/* A folder whose name has a newline would be read as two. */
void vs_jail_allow(const char *folder) {
  char *real = realpath(folder, NULL);
  if (real && !strchr(real, '\n')) vs_text_add(&jail.allowed, "%s\n", real);
  free(real);
}

/* Cuts a path behind its last slash; what has none lies in the working directory. */
static void folder_of(char path[PATH_MAX]) {
  char *slash = strrchr(path, '/');
  if (slash == path)
    path[1] = '\0';
  else if (slash)
    *slash = '\0';
  else
    memcpy(path, ".", sizeof ".");
}

/* A link in a stranger's folder is not followed out of it, but /dev/stdin is the user's own. */
void vs_jail_allow_beside(const char *file) {
  char folder[PATH_MAX];
  if (!strncmp(file, "/dev/", strlen("/dev/"))) vs_jail_allow(file);
  if (access(file, F_OK) || strlen(file) >= sizeof folder) return;
  snprintf(folder, sizeof folder, "%s", file);
  folder_of(folder);
  vs_jail_allow(folder);
}

/* Returns the real path of a file, or of the nearest folder above it that is there; NULL: it has
 * none. Owned by the caller. */
static char *real_path(const char *path) {
  char above[PATH_MAX], *real = realpath(path, NULL);
  if (strlen(path) >= sizeof above) return NULL;
  snprintf(above, sizeof above, "%s", path);
  while (!real && (errno == ENOENT || errno == ENOTDIR) && strcmp(above, ".") != 0 &&
         strcmp(above, "/") != 0) {
    folder_of(above);
    real = realpath(above, NULL);
  }
  return real;
}

static bool is_below(const char *real, const char *folder, size_t length) {
  if (length == 1) return true; /* the root */
  return !strncmp(real, folder, length) && (!real[length] || real[length] == '/');
}

static bool is_allowed(const char *real) {
  for (const char *s = jail.allowed.text; s && *s;) {
    size_t length = strcspn(s, "\n");
    if (is_below(real, s, length)) return true;
    s += length + 1;
  }
  return false;
}

vs_status vs_jail_check(const char *path, vs_where where, vs_error *err) {
  if (!jail.on) return VS_OK;
  char *real = real_path(path);
  bool allowed = real && is_allowed(real);
  if (!allowed)
    vs_fail_at(err, where,
               "%s lies at %s, outside the folder of the file that the command names, and is not "
               "read; copy it there, or give --no-jail if you trust the file that names it",
               path, real ? real : "no place that can be found");
  free(real);
  return allowed ? VS_OK : VS_INPUT;
}
