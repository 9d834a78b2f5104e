/* SPDX-License-Identifier: GPL-3.0-or-later
 * A functional mock-up unit that is named as a law of control, up to where its code would run: the
 * text as the archive, and as the description in an archive. */
#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "control/regulators.h"
#include "targets.h"

static void check(const char *path) {
  vs_control_values v = {.output = "angle_deg"};
  vs_error err = {0};
  snprintf(v.file, sizeof v.file, "%s", path);
  fuzz_judge(vs_fmu_regulator.check(&v, (vs_where){.line = 1, .column = 1}, &err), &err);
}

static void put_number(vs_text *t, unsigned long value, int bytes) {
  for (; bytes--; value >>= 8) vs_text_put(t, &(char){(char)(value & 255)}, 1);
}

static void take(const char *text, size_t size) {
  static const char NAME[] = "modelDescription.xml";
  char path[VS_PATH_SIZE];
  vs_text zip = {0};
  fuzz_write("x.fmu", text, size, path);
  check(path);
  for (int directory = 0; directory < 2; directory++) {
    const size_t at = zip.length;
    vs_text_put(&zip, directory ? "PK\1\2\24\0\24\0" : "PK\3\4\24\0", directory ? 8 : 6);
    put_number(&zip, 0, 8);
    put_number(&zip, vs_hash_crc32(text, size), 4);
    put_number(&zip, size, 4);
    put_number(&zip, size, 4);
    put_number(&zip, sizeof NAME - 1, 2);
    put_number(&zip, 0, directory ? 16 : 2);
    vs_text_put(&zip, NAME, sizeof NAME - 1);
    if (!directory) vs_text_put(&zip, text, size);
    if (!directory) continue;
    vs_text_put(&zip, "PK\5\6\0\0\0\0\1\0\1\0", 12);
    put_number(&zip, zip.length - 12 - at, 4);
    put_number(&zip, at, 4);
    put_number(&zip, 0, 2);
  }
  fuzz_write("x.fmu", zip.text, zip.length, path);
  vs_text_free(&zip);
  check(path);
}

const fuzz_target fuzz_fmu = {"fmu", take, NULL, NULL};
