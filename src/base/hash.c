/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/hash.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/alloc.h"

/* What a byte leaves when it is shifted out is what its lower and its upper half leave together. */
static const uint32_t LOWER[16] = {0x00000000, 0x77073096, 0xee0e612c, 0x990951ba,
                                   0x076dc419, 0x706af48f, 0xe963a535, 0x9e6495a3,
                                   0x0edb8832, 0x79dcb8a4, 0xe0d5e91e, 0x97d2d988,
                                   0x09b64c2b, 0x7eb17cbd, 0xe7b82d07, 0x90bf1d91},
                      UPPER[16] = {0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac,
                                   0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
                                   0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                   0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};

uint32_t vs_hash_crc32(const void *bytes, size_t size) {
  const unsigned char *b = bytes;
  uint32_t crc = 0xffffffff;
  for (size_t k = 0; k < size; k++) {
    crc ^= b[k];
    crc = crc >> 8 ^ LOWER[crc & 15] ^ UPPER[crc >> 4 & 15];
  }
  return ~crc;
}

/* ---- SHA-256 ---- */

/* First 32 bits of the fractional parts of the cube roots of the first 64 primes. */
static const uint32_t ROUND[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t rotate_right(uint32_t x, int by) {
  return x >> by | x << (32 - by);
}

static void compress(uint32_t state[8], const unsigned char block[64]) {
  uint32_t w[64], s[8];
  for (int k = 0; k < 16; k++)
    w[k] = (uint32_t)block[4 * k] << 24 | (uint32_t)block[4 * k + 1] << 16 |
           (uint32_t)block[4 * k + 2] << 8 | block[4 * k + 3];
  for (int k = 16; k < 64; k++)
    w[k] = w[k - 16] + (rotate_right(w[k - 15], 7) ^ rotate_right(w[k - 15], 18) ^ w[k - 15] >> 3) +
           w[k - 7] + (rotate_right(w[k - 2], 17) ^ rotate_right(w[k - 2], 19) ^ w[k - 2] >> 10);
  memcpy(s, state, sizeof s);
  for (int k = 0; k < 64; k += 8) /* after eight rounds each number is back in its place */
    for (int n = 0; n < 8; n++) {
#define S_(place) s[((place)-n) & 7]
      uint32_t one = S_(7) +
                     (rotate_right(S_(4), 6) ^ rotate_right(S_(4), 11) ^ rotate_right(S_(4), 25)) +
                     ((S_(4) & S_(5)) ^ (~S_(4) & S_(6))) + ROUND[k + n] + w[k + n];
      uint32_t two = (rotate_right(S_(0), 2) ^ rotate_right(S_(0), 13) ^ rotate_right(S_(0), 22)) +
                     ((S_(0) & S_(1)) ^ (S_(0) & S_(2)) ^ (S_(1) & S_(2)));
      S_(3) += one;
      S_(7) = one + two;
#undef S_
    }
  for (int k = 0; k < 8; k++) state[k] += s[k];
}

void vs_hash_begin(vs_hash *h) {
  *h = (vs_hash){.state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c,
                           0x1f83d9ab, 0x5be0cd19}};
}

void vs_hash_add(vs_hash *h, const void *bytes, size_t size) {
  const unsigned char *b = bytes;
  while (size) {
    const size_t at = (size_t)(h->size % 64), n = size < 64 - at ? size : 64 - at;
    memcpy(h->block + at, b, n);
    h->size += n, b += n, size -= n;
    if (h->size % 64 == 0) compress(h->state, h->block);
  }
}

void vs_hash_end(vs_hash *h, char text[VS_HASH_TEXT]) {
  static const unsigned char END[64] = {0x80};
  uint64_t bits = 8 * h->size;
  unsigned char length[8];
  for (int k = 0; k < 8; k++) length[k] = (unsigned char)(bits >> (56 - 8 * k));
  vs_hash_add(h, END,
              1 + (size_t)(119 - h->size % 64) % 64); /* 56 bytes of the last block are full then */
  vs_hash_add(h, length, sizeof length);
  for (int k = 0; k < 64; k++)
    text[k] = "0123456789abcdef"[h->state[k / 8] >> (28 - 4 * (k % 8)) & 15];
  text[64] = '\0';
}

/* ---- files of input ---- */

/* What is held: each file as it was when it was read first. */
typedef struct held {
  char *path;
  char sum[VS_HASH_TEXT];
} held;
static struct {
  bool on;
  held *file;
  size_t count;
} holding;

void vs_hash_hold(bool on) {
  for (size_t k = 0; k < holding.count; k++) free(holding.file[k].path);
  free(holding.file);
  holding.file = NULL;
  holding.count = 0;
  holding.on = on;
}

/* Error: the file was read before, and then had another sum. */
static vs_status hold_file(const char *path, const char *sum, vs_error *err) {
  size_t k = 0;
  while (k < holding.count && strcmp(holding.file[k].path, path)) k++;
  if (k == holding.count) {
    holding.file = vs_alloc_grow(holding.file, holding.count, sizeof *holding.file);
    held *new = &holding.file[holding.count++];
    new->path = vs_copy(path);
    memcpy(new->sum, sum, sizeof new->sum);
  }
  if (!strcmp(holding.file[k].sum, sum)) return VS_OK;
  return vs_fail(
      err, VS_INPUT,
      "%s has changed since this study began: its SHA-256 was %.8s..., and is %.8s...; "
      "put the file back and go on with --resume --again failed, or begin the study anew",
      path, holding.file[k].sum, sum);
}

/* Reads on to the end, from where the stream stands. to: where the bytes go, too; NULL: nowhere. */
static bool add_stream(vs_hash *hash, FILE *from, FILE *to) {
  char part[4096];
  size_t n;
  while ((n = fread(part, 1, sizeof part, from)) > 0) {
    vs_hash_add(hash, part, n);
    if (to && fwrite(part, 1, n, to) != n) return false;
  }
  return !ferror(from) && (!to || !fflush(to));
}

/* The largest file that is held, in bytes: more than any that is read again (a deck may have 16 MB,
 * a scene 8 MB). */
enum { LARGEST_HELD = 1 << 26 };

/* Makes a copy of the file's bytes in memory, and holds them. The file is closed. */
static vs_status copy_held(const char *path, size_t size, FILE *file, FILE **copy, vs_error *err) {
  vs_hash hash;
  char sum[VS_HASH_TEXT];
  *copy = vs_checked(fmemopen(NULL, size + 1, "w+"));
  vs_hash_begin(&hash);
  const bool whole = add_stream(&hash, file, *copy);
  const int why = ferror(file) ? errno : EBUSY; /* it has grown while it was read */
  vs_hash_end(&hash, sum);
  fclose(file);
  vs_status status = whole ? hold_file(path, sum, err) : VS_OK;
  if (whole && !status) {
    rewind(*copy);
    return VS_OK;
  }
  fclose(*copy);
  *copy = NULL;
  errno = why;
  return status;
}

vs_status vs_hash_open(const char *path, FILE **stream, vs_error *err) {
  struct stat s;
  *stream = fopen(path, "rb");
  if (!*stream || !holding.on || fstat(fileno(*stream), &s) || !S_ISREG(s.st_mode) ||
      s.st_size > LARGEST_HELD)
    return VS_OK;
  return copy_held(path, (size_t)s.st_size, *stream, stream, err);
}

vs_status vs_hash_file(const char *path, char text[VS_HASH_TEXT], vs_error *err) {
  const vs_where where = {.file = path};
  FILE *f;
  vs_hash hash;
  vs_status status = vs_hash_open(path, &f, err);
  if (status) return status;
  if (!f) return vs_fail_at(err, where, "cannot be opened: %s", strerror(errno));
  vs_hash_begin(&hash);
  const bool whole = add_stream(&hash, f, NULL);
  const int why = errno;
  fclose(f);
  if (!whole) return vs_fail_at(err, where, "cannot be read: %s", strerror(why));
  vs_hash_end(&hash, text);
  return VS_OK;
}
