/* SPDX-License-Identifier: GPL-3.0-or-later
 * Files packed by zstd (RFC 8878), read and written as streams of what is in them. A file is packed
 * if its name ends with ".zst". One frame is written, with the checksum of its content, so that a
 * damaged file is noticed when it is read. */
#pragma once

#include <stdio.h>

#include "base/error.h"

/* Returns a stream of what the file holds, which is open for reading. It takes the file over:
 * fclose closes both. A file that is not packed is returned as it is. Where a packed one is torn or
 * damaged, reading fails with errno EBADMSG; where it holds far more than a table of its size
 * would, with errno EOVERFLOW. NULL gives NULL. */
FILE *vs_compressed_read(FILE *file, const char *name);
/* What such an errno, or any other, says to people. */
const char *vs_compressed_strerror(int why);

/* Returns a stream that packs what is written to it into the file; a file that is not to be packed
 * is returned as it is. The file stays the caller's. vs_compressed_end ends it. */
FILE *vs_compressed_write(FILE *file, const char *name);
/* Writes what is left into the file and ends the stream. Does nothing where stream is the file
 * itself. Error: VS_RUN, something could not be packed or written. */
vs_status vs_compressed_end(FILE *stream, FILE *file, const char *name, vs_error *err);
