/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static vs_status held(int fd, bool (*try)(int fd), const char *path, vs_error *err) {
  const struct timespec pause = {.tv_nsec = 20000000};
  for (int k = 0; k < 10 && !try(fd); k++) {
    if (errno != EACCES && errno != EAGAIN) return VS_OK; /* a file system without locks */
    if (k == 9) return vs_fail(err, VS_INPUT, "%s: another process is at this study", path);
    nanosleep(&pause, NULL);
  }
  return VS_OK;
}

static bool try_file(int fd) {
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return !fcntl(fd, F_OFD_SETLK, &whole);
}

static bool try_folder(int fd) {
  return !flock(fd, LOCK_EX | LOCK_NB);
}

vs_status vs_lock_file(int fd, const char *path, vs_error *err) {
  return held(fd, try_file, path, err);
}

vs_status vs_lock_folder(const char *folder, const char *path, int *fd, vs_error *err) {
  *fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  return *fd < 0 ? VS_OK : held(*fd, try_folder, path, err);
}

/* On some network file systems a file's number changes; its length does not. */
vs_status vs_lock_keeps(int fd, const char *path, vs_error *err) {
  struct stat held, named;
  if (fstat(fd, &held)) return VS_OK;
  if (stat(path, &named) ? errno != ENOENT && errno != ENOTDIR && errno != ESTALE
                         : (named.st_ino == held.st_ino && named.st_dev == held.st_dev) ||
                               named.st_size == held.st_size)
    return VS_OK;
  return vs_fail(
      err, VS_RUN,
      "%s: is gone, or is another file: its folder was moved, removed or unmounted while "
      "the study ran; put it back, and --resume goes on with it",
      path);
}
