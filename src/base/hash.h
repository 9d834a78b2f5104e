/* SPDX-License-Identifier: GPL-3.0-or-later
 * Checksums: CRC-32 (ISO 3309, as of zlib) to find torn lines, SHA-256 (FIPS 180-4) to tell files
 * apart. */
#ifndef VS_BASE_HASH_H
#define VS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

uint32_t vs_hash_crc32(const void *bytes, size_t size);

typedef struct vs_hash {
  uint32_t state[8];
  uint64_t size; /* bytes so far */
  unsigned char block[64];
} vs_hash;

enum { VS_HASH_TEXT = 65 };
void vs_hash_begin(vs_hash *hash);
void vs_hash_add(vs_hash *hash, const void *bytes, size_t size);
void vs_hash_end(vs_hash *hash, char text[VS_HASH_TEXT]); /* 64 hexadecimal digits */

/* Of a file's contents. Error: it cannot be read. */
vs_status vs_hash_file(const char *path, char text[VS_HASH_TEXT], vs_error *err);

#endif
