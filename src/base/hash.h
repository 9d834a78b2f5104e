/* SPDX-License-Identifier: GPL-3.0-or-later
 * Checksums: CRC-32 (ISO 3309, as of zlib) to find torn lines, SHA-256 (FIPS 180-4) to tell files
 * apart. */
#ifndef VS_BASE_HASH_H
#define VS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

uint32_t vs_crc32(const void *bytes, size_t size);

typedef struct vs_sha256 {
  uint32_t state[8];
  uint64_t size; /* bytes so far */
  unsigned char block[64];
} vs_sha256;

enum { VS_SHA256_TEXT = 65 };
void vs_sha256_begin(vs_sha256 *hash);
void vs_sha256_add(vs_sha256 *hash, const void *bytes, size_t size);
void vs_sha256_end(vs_sha256 *hash, char text[VS_SHA256_TEXT]); /* 64 hexadecimal digits */

/* Of a file's contents. Error: it cannot be read. */
vs_status vs_sha256_file(const char *path, char text[VS_SHA256_TEXT], vs_error *err);

#endif
