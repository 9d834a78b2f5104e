/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/path.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/jail.h"
#include "base/text.h"

#ifndef VS_LIBRARY
#error "the build names the library folder that is looked into last"
#endif

/* Calls visit for the program's own library folders in their order, until it returns true; returns
 * whether it did. */
static bool each_own(bool (*visit)(void *ctx, const char *folder), void *ctx) {
  bool stop = false;
  char self[VS_PATH_SIZE], share[VS_PATH_SIZE + 32];
  ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n > 0) {
    self[n] = '\0';
    char *slash = strrchr(self, '/');
    if (slash) *slash = '\0';
    snprintf(share, sizeof share, "%s/../share/vibrospice", self);
    stop = visit(ctx, share);
  }
  return stop || visit(ctx, VS_LIBRARY);
}

/* The same for all library folders, of which the user's come first. */
static bool each_library(bool (*visit)(void *ctx, const char *folder), void *ctx) {
  const char *path = getenv("VIBROSPICE_PATH");
  char *folders = vs_copy(path ? path : ""), *rest = folders;
  bool stop = false;
  for (char *folder; !stop && (folder = strsep(&rest, ":"));)
    if (*folder) stop = visit(ctx, folder);
  free(folders);
  return stop || each_own(visit, ctx);
}

static bool is_file(const char *path) {
  struct stat s;
  return stat(path, &s) == 0 && !S_ISDIR(s.st_mode);
}

static bool allow_library(void *ctx, const char *folder) {
  (void)ctx;
  vs_jail_allow(folder);
  return false;
}

void vs_path_allow_shipped(void) {
  each_library(allow_library, NULL);
}

struct search {
  const vs_shelf *shelf;
  const char *name;
  char *path;
};

static bool try_library(void *ctx, const char *folder) {
  struct search *s = ctx;
  int n = snprintf(s->path, VS_PATH_SIZE, "%s/%s%s%s%s", folder, s->shelf->folder,
                   *s->shelf->folder ? "/" : "", s->name, s->shelf->ending);
  return n < VS_PATH_SIZE && is_file(s->path);
}

struct listing {
  const vs_shelf *shelf;
  void (*each)(void *, const char *);
  void *ctx;
};

static bool list_library(void *ctx, const char *folder) {
  struct listing *l = ctx;
  char path[2 * VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, l->shelf->folder);
  struct dirent **entries;
  int n = scandir(path, &entries, NULL, alphasort);
  for (int k = 0; k < n; k++) {
    size_t length = strlen(entries[k]->d_name), ending = strlen(l->shelf->ending);
    snprintf(path, sizeof path, "%s/%s%s%s", folder, l->shelf->folder, *l->shelf->folder ? "/" : "",
             entries[k]->d_name);
    if (length > ending && !strcmp(entries[k]->d_name + length - ending, l->shelf->ending) &&
        is_file(path))
      l->each(l->ctx, path);
    free(entries[k]);
  }
  if (n >= 0) free(entries);
  return false;
}

void vs_path_list(const vs_shelf *shelf, void (*each)(void *, const char *), void *ctx) {
  struct listing l = {shelf, each, ctx};
  each_library(list_library, &l);
}

struct names {
  const vs_shelf *shelf;
  const char *names[64];
  size_t count;
};

static void collect_name(void *ctx, const char *path) {
  struct names *n = ctx;
  const char *slash = strrchr(path, '/');
  const char *base = slash ? slash + 1 : path;
  if (n->count < sizeof n->names / sizeof *n->names)
    n->names[n->count++] = vs_alloc_part(base, strlen(base) - strlen(n->shelf->ending));
}

bool vs_path_shipped(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]) {
  struct search search = {shelf, name, path};
  return *name && each_library(try_library, &search);
}

bool vs_path_own(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]) {
  struct search search = {shelf, name, path};
  return each_own(try_library, &search) && access(path, R_OK) == 0;
}

/* True if the place is in a file that lies in another folder than the one where the program runs by
 * default, so that a relative name in it begins there. *folder is how many bytes of the file's name
 * are that folder. */
static bool has_folder(const char *name, vs_where where, int *folder) {
  char file[VS_PATH_SIZE];
  if (!where.file || *name == '/') return false;
  snprintf(file, sizeof file, "%.*s", (int)vs_error_file_size(where.file), where.file);
  const char *slash = strrchr(file, '/');
  *folder = slash ? (int)(slash + 1 - file) : 0;
  return slash && is_file(file); /* the label of a --set is none */
}

bool vs_path_beside(const char *name, vs_where where, char path[VS_PATH_SIZE]) {
  char file[VS_PATH_SIZE]; /* of a table's row, the table */
  int folder;
  if (!*name || !has_folder(name, where, &folder) ||
      snprintf(path, VS_PATH_SIZE, "%.*s%s", folder, where.file, name) >= VS_PATH_SIZE)
    return false;
  snprintf(file, sizeof file, "%.*s", (int)vs_error_file_size(path), path);
  return is_file(file);
}

bool vs_path_is_fallback(const char *name, vs_where where) {
  char path[VS_PATH_SIZE];
  int folder;
  return has_folder(name, where, &folder) && !vs_path_beside(name, where, path) && is_file(name);
}

/* A file of that name hides one that comes with the program. Who meant that one is told. */
static vs_status check_own_file(const vs_shelf *shelf, const char *name, vs_where where,
                                vs_error *err) {
  char shipped[VS_PATH_SIZE];
  if (!vs_jail_check(name, where, err)) return VS_OK;
  if (!vs_path_shipped(shelf, name, shipped)) return VS_INPUT;
  return vs_fail_at(err, where,
                    "the file %s hides the %s of that name that comes with the program, and the "
                    "jail does not let it be read; give the file another name",
                    name, shelf->what);
}

vs_status vs_path_check_plain(const char *path, vs_where where, vs_error *err) {
  struct stat s;
  if (stat(path, &s) || S_ISREG(s.st_mode)) return VS_OK;
  return vs_fail_at(err, where, "%s is a folder, a pipe, a device or a socket; a file is wanted",
                    path);
}

vs_status vs_path_check_result(const char *path, vs_error *err) {
  const vs_where where = {.file = path};
  struct stat s;
  if (stat(path, &s)) return VS_OK;
  return vs_jail_check(path, where, err);
}

/* Fails with the nearest name on the shelf; `looked` says where else there is no such file. */
static vs_status refuse_name(const vs_shelf *shelf, const char *name, vs_where where,
                             const char *looked, vs_error *err) {
  struct names known = {.shelf = shelf};
  vs_path_list(shelf, collect_name, &known);
  vs_fail_at(err, where, "no %s '%s': %s, and not a%s %s that comes with the program%s",
             shelf->what, name, looked, strchr("aeiou", *shelf->what) ? "n" : "", shelf->what,
             vs_text_hint(name, known.names, known.count, "").text);
  for (size_t k = 0; k < known.count; k++) free((void *)(size_t)known.names[k]);
  return VS_INPUT;
}

vs_status vs_path_find(const vs_shelf *shelf, const char *name, vs_where where,
                       char path[VS_PATH_SIZE], vs_error *err) {
  if (strlen(name) >= VS_PATH_SIZE / 2) return vs_fail_at(err, where, "%s: name too long", name);
  if (vs_path_beside(name, where, path)) {
    vs_status status = vs_jail_check(path, where, err);
    return status ? status : vs_path_check_plain(path, where, err);
  }
  snprintf(path, VS_PATH_SIZE, "%s", name);
  if (is_file(path)) {
    vs_status status = check_own_file(shelf, name, where, err);
    return status || !where.file ? status : vs_path_check_plain(path, where, err);
  }
  if (vs_path_shipped(shelf, name, path)) return vs_jail_check(path, where, err);
  if (strchr(name, '/') && vs_jail_check(name, where, err)) return VS_INPUT;
  return refuse_name(shelf, name, where, "not a file", err);
}

vs_status vs_path_find_shipped(const vs_shelf *shelf, const char *name, vs_where where,
                               const char *looked, char path[VS_PATH_SIZE], vs_error *err) {
  if (vs_path_shipped(shelf, name, path)) return vs_jail_check(path, where, err);
  return refuse_name(shelf, name, where, looked, err);
}
