/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/compressed.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "base/alloc.h"

/* The level of compression, from 1 to 19. Rows of numbers gain nothing from a higher one: 131,072
 * of them, of 21 columns, took 39 % of their bytes at level 1, 43 % at level 3, 41 % at level 9 in
 * nine times the time of level 3, and 36 % at level 19 in 250 times (tools/bench/format; zstd
 * 1.5.4). */
enum { LEVEL = 1 };

static bool is_packed(const char *name) {
  const size_t n = strlen(name);
  return n > 4 && !strcmp(name + n - 4, ".zst");
}

/* ---- reading ---- */

typedef struct unpacker {
  FILE *file;
  ZSTD_DCtx *context;
  ZSTD_inBuffer in; /* what was read of the file, and how much of it is unpacked */
  char *room;       /* [size], what `in` points to */
  size_t size;
  bool inside;          /* a frame has begun and has not ended */
  uint64_t taken, made; /* bytes, of the file and of what it holds */
} unpacker;

/* Rows of numbers become a half to a tenth of their size; where all but the case's number and id
 * stays the same, a thirtieth. zstd can pack a gigabyte into thirty kilobytes. A file that unpacks
 * to more than SLACK bytes and to more than MOST times its size is refused: the program writes no
 * such table. */
enum { MOST = 256, SLACK = 1 << 24 };

const char *vs_compressed_strerror(int why) {
  return why == EBADMSG     ? "it is torn or damaged"
         : why == EOVERFLOW ? "it holds more than 256 times its size, which no table does; if you "
                              "trust it, unpack "
                              "it by zstd -d and remove the packed file"
                            : strerror(why);
}

/* Reads more of the file. Returns 1; 0 at the file's end; -1 where it cannot be read, or ends
 * inside a frame. */
static int refill(unpacker *u) {
  const size_t n = fread(u->room, 1, u->size, u->file);
  u->in = (ZSTD_inBuffer){u->room, n, 0};
  u->taken += n;
  if (n) return 1;
  if (ferror(u->file)) return -1;
  if (u->inside) errno = EBADMSG;
  return u->inside ? -1 : 0;
}

static ssize_t unpack(void *cookie, char *to, size_t size) {
  unpacker *u = cookie;
  ZSTD_outBuffer out = {to, size, 0};
  while (!out.pos) {
    if (u->in.pos == u->in.size && !u->inside) {
      const int more = refill(u);
      if (more <= 0) return more;
    }
    const size_t before = u->in.pos;
    const size_t left = ZSTD_decompressStream(u->context, &out, &u->in);
    if (ZSTD_isError(left)) {
      errno = EBADMSG;
      return -1;
    }
    u->inside = left > 0;
    if (out.pos || u->in.pos > before || !left) continue;
    const int more = refill(u); /* nothing moved: it waits for more of the frame */
    if (more <= 0) return more;
  }
  u->made += out.pos;
  if (u->made > SLACK && u->made / MOST > u->taken) {
    errno = EOVERFLOW;
    return -1;
  }
  return (ssize_t)out.pos;
}

static int end_unpacker(void *cookie) {
  unpacker *u = cookie;
  const int closed = fclose(u->file);
  ZSTD_freeDCtx(u->context);
  free(u->room);
  free(u);
  return closed;
}

FILE *vs_compressed_read(FILE *file, const char *name) {
  if (!file || !is_packed(name)) return file;
  unpacker *u = vs_alloc(1, sizeof *u);
  u->file = file;
  u->context = vs_checked(ZSTD_createDCtx());
  u->size = ZSTD_DStreamInSize();
  u->room = vs_alloc(u->size, 1);
  return vs_checked(
      fopencookie(u, "r", (cookie_io_functions_t){.read = unpack, .close = end_unpacker}));
}

/* ---- writing ---- */

typedef struct packer {
  FILE *file;
  ZSTD_CCtx *context;
  char *room; /* [size], for what is packed */
  size_t size;
} packer;

/* Packs the bytes, and with ZSTD_e_end all that is left, into the file. */
static bool pack(packer *p, const char *from, size_t size, ZSTD_EndDirective how) {
  ZSTD_inBuffer in = {from, size, 0};
  for (size_t left = 1; left;) {
    ZSTD_outBuffer out = {p->room, p->size, 0};
    left = ZSTD_compressStream2(p->context, &out, &in, how);
    if (ZSTD_isError(left)) {
      errno = EIO;
      return false;
    }
    if (fwrite(p->room, 1, out.pos, p->file) != out.pos) return false;
    if (how == ZSTD_e_continue) left = in.size - in.pos;
  }
  return true;
}

static ssize_t pack_bytes(void *cookie, const char *from, size_t size) {
  return pack(cookie, from, size, ZSTD_e_continue) ? (ssize_t)size : 0;
}

static int end_packer(void *cookie) {
  packer *p = cookie;
  const bool good = pack(p, "", 0, ZSTD_e_end);
  const int why = errno;
  ZSTD_freeCCtx(p->context);
  free(p->room);
  free(p);
  errno = why;
  return good ? 0 : EOF;
}

FILE *vs_compressed_write(FILE *file, const char *name) {
  if (!is_packed(name)) return file;
  packer *p = vs_alloc(1, sizeof *p);
  p->file = file;
  p->context = vs_checked(ZSTD_createCCtx());
  p->size = ZSTD_CStreamOutSize();
  p->room = vs_alloc(p->size, 1);
  ZSTD_CCtx_setParameter(p->context, ZSTD_c_compressionLevel, LEVEL);
  ZSTD_CCtx_setParameter(p->context, ZSTD_c_checksumFlag, 1);
  return vs_checked(
      fopencookie(p, "w", (cookie_io_functions_t){.write = pack_bytes, .close = end_packer}));
}

vs_status vs_compressed_end(FILE *stream, FILE *file, const char *name, vs_error *err) {
  if (stream == file) return VS_OK;
  const bool bad = ferror(stream);
  if (!fclose(stream) && !bad) return VS_OK;
  return vs_fail(err, VS_RUN, "%s: cannot be written: %s", name,
                 bad ? "a part of it was refused" : strerror(errno));
}
