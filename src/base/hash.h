/* SPDX-License-Identifier: GPL-3.0-or-later
 * Two checksums. CRC-32 (ISO 3309, with zlib's bit order) finds torn lines; SHA-256 (FIPS 180-4)
 * tells files apart. */
#ifndef VS_BASE_HASH_H
#define VS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

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

/* Writes the SHA-256 of a file's contents. Error: the file cannot be read. */
vs_status vs_hash_file(const char *path, char text[VS_HASH_TEXT], vs_error *err);

#endif
