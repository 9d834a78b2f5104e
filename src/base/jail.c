/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/jail.h"

#include <errno.h>
#include <limits.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"

static struct {
  bool on;
  const char *way_out; /* for messages */
  /* Each has a newline at its end. */
  vs_text folders; /* real paths that messages name */
  vs_text broad;   /* likewise; of these only the files that lie directly in them */
  vs_text shipped; /* real paths that messages do not name */
  vs_text named;   /* files as the command line calls them */
  vs_text labels;  /* of the command line's values */
} jail;

void vs_jail_begin(const char *way_out) {
  jail.on = true;
  jail.way_out = way_out;
}

bool vs_jail_is_on(void) {
  return jail.on;
}

/* Returns the way from a folder to what lies below it, empty for the folder itself; NULL: the path
 * does not lie below it. Both are real paths. */
static const char *way_from(const char *folder, size_t length, const char *real) {
  if (length == 1) return real + 1; /* the root */
  if (strncmp(real, folder, length) != 0) return NULL;
  return real[length] == '/' ? real + length + 1 : real[length] ? NULL : real + length;
}

static bool is_below(const char *real, const char *folder) {
  return way_from(folder, strlen(folder), real) != NULL;
}

/* What begins with a dot is a program's own: keys, passwords, histories. */
static bool is_hidden(const char *way) {
  return *way == '.' || strstr(way, "/.");
}

/* How far a folder of a list lets a path be read. */
typedef enum reach { OUTSIDE, HIDDEN, WITHIN } reach;

/* The most that any folder of a list allows. flat: its folders allow only what lies directly in
 * them. */
static reach reach_of(const char *real, const vs_text *list, bool flat) {
  reach most = OUTSIDE;
  for (const char *s = list->text; s && *s; s += strcspn(s, "\n") + 1) {
    const char *way = way_from(s, strcspn(s, "\n"), real);
    if (!way || (flat && strchr(way, '/'))) continue;
    if (!is_hidden(way)) return WITHIN;
    most = HIDDEN;
  }
  return most;
}

/* A path that has a newline would be read as two. */
static void add_to_list(vs_text *list, const char *real) {
  if (real && !strchr(real, '\n') && reach_of(real, list, false) != WITHIN)
    vs_text_add(list, "%s\n", real);
}

void vs_jail_allow(const char *folder) {
  char *real = realpath(folder, NULL);
  add_to_list(&jail.shipped, real);
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

/* True for a folder that is, or lies above, the home folder that the system knows for a user. */
static bool holds_home_of(uid_t user, const char *real) {
  const struct passwd *entry = getpwuid(user);
  char *home = entry && entry->pw_dir && *entry->pw_dir ? realpath(entry->pw_dir, NULL) : NULL;
  bool holds = home && is_below(home, real);
  free(home);
  return holds;
}

/* True for the root, and for a home folder or one above it: they hold what belongs to no project.
 * $HOME alone does not tell, as sudo and services set another one. */
static bool is_broad(const char *real) {
  const char *variable = getenv("HOME");
  char *home = variable && *variable ? realpath(variable, NULL) : NULL;
  struct stat folder;
  bool broad = !strcmp(real, "/") || !strcmp(real, "/home") || !strcmp(real, "/root") ||
               (home && is_below(home, real)) || holds_home_of(getuid(), real) ||
               holds_home_of(geteuid(), real) ||
               (!stat(real, &folder) && holds_home_of(folder.st_uid, real));
  free(home);
  return broad;
}

/* Whoever works in a project's folder names files of the project. Without $HOME it is not known
 * whether it is one. */
static void allow_working_folder(const char *real_file) {
  const char *home = getenv("HOME");
  char *here = realpath(".", NULL);
  if (here && home && *home && is_below(real_file, here) && !is_broad(here))
    add_to_list(&jail.folders, here);
  free(here);
}

static void add_name(vs_text *list, const char *name) {
  if (!strchr(name, '\n')) vs_text_add(list, "%s\n", name);
}

static bool is_among(const char *name, const vs_text *list) {
  size_t length = strlen(name);
  for (const char *s = list->text; s && *s && length; s += strcspn(s, "\n") + 1)
    if (strcspn(s, "\n") == length && !strncmp(s, name, length)) return true;
  return false;
}

void vs_jail_allow_named(const char *name) {
  char folder[PATH_MAX], file[PATH_MAX], *around = NULL;
  snprintf(file, sizeof file, "%.*s", (int)vs_error_file_size(name), name);
  char *real = realpath(file, NULL);
  add_name(&jail.named, name);
  if (strcmp(file, name) != 0) add_name(&jail.named, file);
  struct stat s;
  if (real && !stat(real, &s) && S_ISDIR(s.st_mode))
    add_to_list(is_broad(real) ? &jail.broad : &jail.folders, real);
  else if (real && strlen(name) < sizeof folder && strncmp(file, "/dev/", strlen("/dev/")) != 0) {
    snprintf(folder, sizeof folder, "%s", file);
    folder_of(folder);
    around = realpath(folder, NULL);
    allow_working_folder(real);
    if (around) add_to_list(is_broad(around) ? &jail.broad : &jail.folders, around);
  }
  free(around);
  free(real);
}

void vs_jail_allow_place(const char *label) {
  add_name(&jail.labels, label);
}

/* A stranger's file may be called as a value of the command line is. */
static bool is_of_command_line(vs_where where) {
  return where.file && is_among(where.file, &jail.labels) && access(where.file, F_OK) != 0;
}

/* Returns the real path of a file; of one that is not there, that of the nearest folder above it
 * that is, and the rest as it is written. NULL: it has none. Owned by the caller. */
static char *real_path(const char *path) {
  char above[PATH_MAX], *real = realpath(path, NULL);
  const char *rest = "";
  snprintf(above, sizeof above, "%s", path);
  while (!real && (errno == ENOENT || errno == ENOTDIR) && strlen(path) < sizeof above &&
         strcmp(above, ".") != 0 && strcmp(above, "/") != 0) {
    folder_of(above);
    rest = strncmp(path, above, strlen(above)) != 0 ? path : path + strlen(above);
    real = realpath(above, NULL);
  }
  rest += strspn(rest, "/");
  if (!real || !*rest) return real;
  vs_text whole = {0};
  vs_text_add(&whole, "%s/%s", strcmp(real, "/") != 0 ? real : "", rest);
  free(real);
  return whole.text;
}

/* Writes the folders of a list, with a word before them and commas behind. */
static void add_folders(vs_text *text, const char *before, const vs_text *list) {
  for (const char *s = list->text; s && *s; s += strcspn(s, "\n") + 1)
    vs_text_add(text, "%s%.*s, ", s == list->text ? before : "", (int)strcspn(s, "\n"), s);
}

/* Why a path below an allowed folder is not read after all. A ".." is left in a real path where it
 * stands behind a folder that is not there. */
static const char *why_hidden(const char *real) {
  const size_t n = strlen(real);
  return strstr(real, "/../") || (n > 3 && !strcmp(real + n - 3, "/.."))
             ? " ('..' behind a folder that is not there leads out of those that are read)"
             : " (a name on the way to it begins with a dot)";
}

/* True for a file that has a second name, which may lie anywhere. */
static bool is_linked(const char *real) {
  struct stat s;
  return !stat(real, &s) && S_ISREG(s.st_mode) && s.st_nlink > 1;
}

static vs_status refuse_linked(const char *path, vs_where where, vs_error *err) {
  return vs_fail_at(err, where,
                    "%s is a hard link: the file has a second name, which may lie anywhere, and is "
                    "not read; copy it to a file of its own, or, if you trust the file that names "
                    "it, %s",
                    path, jail.way_out);
}

/* True for what may keep its reader waiting for ever. */
static bool is_no_file(const char *real) {
  struct stat s;
  return !stat(real, &s) && !S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode);
}

static vs_status refuse_path(const char *path, const char *real, bool hidden, vs_where where,
                             vs_error *err) {
  vs_text folders = {0};
  add_folders(&folders, "below ", &jail.folders);
  add_folders(&folders, "directly in (a home folder or one above it, so not below) ", &jail.broad);
  vs_fail_at(err, where,
             "%s lies at %s%s, and is not read; if you trust the file that names it, %s; else copy "
             "it to where files are read: %sand what comes with the program",
             path, real ? real : "no place that can be found", hidden ? why_hidden(real) : "",
             jail.way_out, folders.text ? folders.text : "");
  vs_text_free(&folders);
  return VS_INPUT;
}

vs_status vs_jail_check(const char *path, vs_where where, vs_error *err) {
  if (!jail.on || is_among(path, &jail.named)) return VS_OK;
  if (is_of_command_line(where)) {
    vs_jail_allow_named(path);
    return VS_OK;
  }
  char *real = real_path(path);
  const reach by[] = {real ? reach_of(real, &jail.folders, false) : OUTSIDE,
                      real ? reach_of(real, &jail.broad, true) : OUTSIDE,
                      real ? reach_of(real, &jail.shipped, false) : OUTSIDE};
  reach most = OUTSIDE;
  for (size_t k = 0; k < sizeof by / sizeof *by; k++)
    if (by[k] > most) most = by[k];
  vs_status status = most == WITHIN ? VS_OK : refuse_path(path, real, most == HIDDEN, where, err);
  if (!status && by[2] != WITHIN && is_linked(real)) status = refuse_linked(path, where, err);
  if (!status && is_no_file(real))
    status = vs_fail_at(err, where, "%s is a pipe, a device or a socket; a file is wanted", path);
  free(real);
  return status;
}
