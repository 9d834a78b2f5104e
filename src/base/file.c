/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/compressed.h"
#include "base/shutdown.h"

vs_status vs_file_folder_make(const char *folder, int *made, vs_error *err) {
  char path[VS_PATH_SIZE];
  *made = 0;
  if (!*folder || strlen(folder) >= sizeof path)
    return vs_fail(err, VS_INPUT, "output directory '%s': empty or too long a name", folder);
  snprintf(path, sizeof path, "%s", folder);
  vs_status status = VS_OK;
  for (char *s = path + 1; !status; s++) {
    if (*s && *s != '/') continue;
    char kept = *s;
    *s = '\0';
    if (!mkdir(path, 0777))
      ++*made;
    else if (errno != EEXIST)
      status =
          vs_fail(err, VS_INPUT, "output directory %s: cannot be made: %s", path, strerror(errno));
    *s = kept;
    if (!kept) break;
  }
  struct stat st;
  if (!status && stat(folder, &st))
    status = vs_fail(err, VS_INPUT, "output directory %s: cannot be reached: %s", folder,
                     strerror(errno));
  else if (!status && !S_ISDIR(st.st_mode))
    status = vs_fail(err, VS_INPUT, "output directory %s: is there and is not a directory", folder);
  if (!status && access(folder, W_OK | X_OK))
    status = vs_fail(err, VS_INPUT, "output directory %s: cannot be written to: %s", folder,
                     strerror(errno));
  if (status) vs_file_folder_unmake(folder, *made);
  return status;
}

void vs_file_folder_unmake(const char *folder, int made) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s", folder);
  while (made > 0) {
    size_t n = strlen(path);
    while (n > 1 && path[n - 1] == '/') path[--n] = '\0';
    if (!rmdir(path))
      made--;
    else if (errno != ENOENT)
      return; /* folders below the one that failed were never made and are skipped */
    char *slash = strrchr(path, '/');
    if (!slash) return;
    *slash = '\0';
  }
}

static const char TEMPORARY[] = ".vibrospice-tmp.";
enum { RANDOM = 6 }; /* characters that mkostemp puts behind TEMPORARY */

static bool is_temporary(const char *name) {
  size_t n = sizeof TEMPORARY - 1;
  return !strncmp(name, TEMPORARY, n) && strlen(name) == n + RANDOM &&
         strspn(name + n, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") ==
             RANDOM;
}

/* Removes the file if it belongs to this user and nobody has it locked. Where the file system has
 * no locks it stays. */
static void remove_stale(int folder, const char *name) {
  struct stat s;
  int fd = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return;
  if (!fstat(fd, &s) && S_ISREG(s.st_mode) && s.st_uid == geteuid() && s.st_nlink == 1 &&
      !flock(fd, LOCK_EX | LOCK_NB))
    unlinkat(folder, name, 0);
  close(fd);
}

void vs_file_sweep(const char *folder) {
  DIR *d = opendir(*folder ? folder : ".");
  if (!d) return;
  for (const struct dirent *e; (e = readdir(d));)
    if (is_temporary(e->d_name)) remove_stale(dirfd(d), e->d_name);
  closedir(d);
}

/* Makes a new file and locks it; returns its descriptor, or -1 with errno. Between the two, another
 * process that removes stale files may have taken it for one; then a new one is made. */
static int make_temporary(vs_file *file, int folder_size) {
  int fd = -1;
  for (int tries = 0; tries < 10 && fd < 0; tries++) {
    struct stat s;
    snprintf(file->temporary, sizeof file->temporary, "%.*s%sXXXXXX", folder_size, file->path,
             TEMPORARY);
    fd = mkostemp(file->temporary, O_CLOEXEC);
    if (fd < 0) return -1;
    bool held = !flock(fd, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK;
    if (held && !fstat(fd, &s) && s.st_nlink) break;
    close(fd);
    fd = -1;
  }
  return fd;
}

/* True for a link such as /dev/stdout, by which the system names an open file of a process. */
static bool is_stream(const char *path) {
  static const char PROCESS[] = "/proc/";
  char target[sizeof PROCESS - 1];
  return readlink(path, target, sizeof target) == sizeof target &&
         !memcmp(target, PROCESS, sizeof target);
}

vs_status vs_file_open(vs_file *file, const char *folder, const char *name, vs_error *err) {
  *file = (vs_file){0};
  int n = snprintf(file->path, sizeof file->path, "%s%s%s", folder, *folder ? "/" : "", name);
  if (n >= (int)sizeof file->path)
    return vs_fail(err, VS_INPUT, "%s/%s: too long a name", folder, name);
  const char *slash = strrchr(file->path, '/');
  int size = slash ? (int)(slash - file->path) + 1 : 0;
  struct stat s;
  if (!lstat(file->path, &s) && S_ISDIR(s.st_mode)) /* so that no other file is replaced before */
    return vs_fail(err, VS_INPUT, "%s: cannot be written: %s", file->path, strerror(EISDIR));
  if ((!stat(file->path, &s) && !S_ISREG(s.st_mode)) || is_stream(file->path))
    return vs_fail(
        err, VS_INPUT,
        "%s: is a device, a pipe, a socket or a stream, which a file would replace; name a file",
        file->path);
  char place[VS_PATH_SIZE];
  snprintf(place, sizeof place, "%.*s", size, file->path);
  vs_file_sweep(place);
  sigset_t before;
  vs_shutdown_block_signals(&before);
  int fd = make_temporary(file, size), why = errno;
  if (fd >= 0) vs_shutdown_remove(file->temporary);
  vs_shutdown_unblock_signals(&before);
  if (fd < 0) return vs_fail(err, VS_INPUT, "%s: cannot be written: %s", file->path, strerror(why));
  mode_t mask = umask(0);
  umask(mask);
  fchmod(fd, 0666 & ~mask);
  file->stream = vs_checked(fdopen(fd, "w"));
  return VS_OK;
}

/* A file's name stands in its folder, so after a rename the folder has to be written to the disk,
 * too. Some file systems cannot do that; there the file is still whole or not there at all. */
static void sync_folder_of(const char *path) {
  char folder[VS_PATH_SIZE];
  const char *slash = strrchr(path, '/');
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
  int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

/* Finds out why an earlier write to the file failed. The stream remembers that it failed, but not
 * the reason; so more is written to the file, which is discarded anyway, until the error comes
 * again. The last block of a full disk may still take the first bytes. */
static const char *why_refused(int fd) {
  static const char MORE[1 << 16];
  for (int k = 0; k < 2; k++)
    if (write(fd, MORE, sizeof MORE) < 0) return strerror(errno);
  return "a part of it was refused";
}

vs_status vs_file_commit(vs_file *file, vs_error *err) {
  FILE *stream = file->stream;
  file->stream = NULL;
  const char *refused = ferror(stream) ? why_refused(fileno(stream)) : NULL;
  bool bad = refused || fflush(stream) || fsync(fileno(stream));
  int why = errno;
  int lock = dup(fileno(
      stream)); /* a copy of the descriptor keeps the lock until the file has its final name */
  if (fclose(stream) && !bad) {
    bad = true;
    why = errno;
  }
  if (!bad && rename(file->temporary, file->path)) {
    bad = true;
    why = errno;
  }
  if (bad) unlink(file->temporary);
  if (lock >= 0) close(lock);
  vs_shutdown_forget(file->temporary);
  if (!bad) {
    sync_folder_of(file->path);
    return VS_OK;
  }
  return vs_fail(err, VS_RUN, "%s: cannot be written: %s", file->path,
                 refused ? refused : strerror(why));
}

/* Copies so many bytes from the beginning of a file. */
static bool copy_bytes(int from, off_t size, FILE *to) {
  char part[1 << 16];
  ssize_t n = 1;
  for (off_t at = 0; at < size && n > 0; at += n) {
    size_t most = size - at < (off_t)sizeof part ? (size_t)(size - at) : sizeof part;
    n = pread(from, part, most, at);
    if (n > 0 && fwrite(part, 1, (size_t)n, to) != (size_t)n) n = -1;
  }
  return n > 0 && !fflush(to);
}

vs_status vs_file_part(vs_file *file, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (!file->stream) return VS_OK;
  FILE *shared = file->stream;
  const off_t size = ftello(shared);
  memcpy(path, file->path, sizeof path);
  vs_shutdown_forget(file->temporary);
  vs_status status = vs_file_open(file, "", path, err);
  if (!status && size && !copy_bytes(fileno(shared), size, file->stream)) {
    vs_file_discard(file);
    status = VS_RUN;
  }
  fclose(shared);
  return status ? vs_fail(err, VS_RUN, "%s: a copy of it cannot be written", path) : VS_OK;
}

void vs_file_discard(vs_file *file) {
  if (!file->stream) return;
  fclose(file->stream);
  file->stream = NULL;
  unlink(file->temporary);
  vs_shutdown_forget(file->temporary);
}

vs_status vs_file_write(const char *folder, const char *name, const char *text, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, name, err);
  if (status) return status;
  if (text) fputs(text, file.stream);
  return vs_file_commit(&file, err);
}

vs_status vs_file_commit_as(vs_file *file, const char *folder, const char *name, vs_error *err) {
  snprintf(file->path, sizeof file->path, "%s%s%s", folder, *folder ? "/" : "", name);
  return vs_file_commit(file, err);
}

vs_status vs_file_was_read(FILE *stream, const char *path, vs_error *err) {
  if (errno == EFBIG)
    return vs_fail(err, VS_INPUT,
                   "%s: a line in it is too long; no table or journal has such lines", path);
  if (!ferror(stream)) return VS_OK;
  return vs_fail(err, VS_INPUT, "%s: cannot be read: %s", path,
                 errno ? vs_compressed_strerror(errno) : "a part of it was refused");
}

void vs_file_remove(int folder, const char *name) {
  struct stat s;
  if (!fstatat(folder, name, &s, AT_SYMLINK_NOFOLLOW) && S_ISREG(s.st_mode))
    unlinkat(folder, name, 0);
}
