/* SPDX-License-Identifier: GPL-3.0-or-later
 * Two checksums. CRC-32 (ISO 3309, with zlib's bit order) finds torn lines; SHA-256 (FIPS 180-4)
 * tells files apart. Input files are opened here, too, so that every reader of a file gets the same
 * bytes (vs_hash_hold). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/error.h"

uint32_t vs_hash_crc32(const void *bytes, size_t size);

/* A SHA-256 under way: begin it, add bytes in any pieces, end it. The members are its own. */
typedef struct vs_hash {
  uint32_t state[8];
  uint64_t size; /* bytes so far */
  unsigned char block[64];
} vs_hash;

enum { VS_HASH_TEXT = 65 }; /* bytes of a sum in hexadecimal digits, the end included */
void vs_hash_begin(vs_hash *hash);
void vs_hash_add(vs_hash *hash, const void *bytes, size_t size);
void vs_hash_end(vs_hash *hash, char text[VS_HASH_TEXT]);

/* true: from now on each file of input is held: vs_hash_open and vs_hash_file take it only as it
 * was when one of them read it first, here or, before a fork, in the parent. So all that a study is
 * made of is one state of its files, in all of its processes. false: what was held is forgotten. */
void vs_hash_hold(bool on);

/* Opens a file of input for reading. While files are held, what *stream gives is a copy in memory
 * of the very bytes that the sum was made of. *stream is NULL, and errno set, where the file cannot
 * be read. Not held are files that are no plain ones, and those beyond 64 MB. Error: the file has
 * changed since it was read first; the message names it. */
vs_status vs_hash_open(const char *path, FILE **stream, vs_error *err);

/* Writes the SHA-256 of a file's contents. Errors: the file cannot be read; those of vs_hash_open.
 */
vs_status vs_hash_file(const char *path, char text[VS_HASH_TEXT], vs_error *err);
