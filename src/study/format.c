/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/format.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* To add a format: a row here and its word in VS_FORMAT_WORDS. test_format reads it back. */
const vs_format vs_format_all[] = {
    {"csv", "study.csv, as text", "study.csv", false, "study.csv, failures.csv, manifest.json"},
    {"csv.zst", "the same packed by zstd, in its place", "study.csv.zst", false,
     "study.csv.zst, failures.csv, manifest.json"},
    {"npy", "study.csv, and beside it DIR/columns, a file for numpy for each column", "study.csv",
     true, "study.csv, failures.csv, manifest.json, columns"},
    {0}};

vs_status vs_format_find(const char *name, const vs_format **format, vs_error *err) {
  *format = vs_format_all;
  while (name && (*format)->name && strcmp((*format)->name, name)) ++*format;
  if ((*format)->name) return VS_OK;
  return vs_fail(err, VS_INPUT, "--format %s: there are: csv, csv.zst, npy", name);
}

bool vs_format_find_rows(const char *folder, char path[VS_PATH_SIZE]) {
  for (const vs_format *f = vs_format_all; f->name; f++) {
    snprintf(path, VS_PATH_SIZE, "%.4000s/%s", folder, f->rows);
    if (!access(path, F_OK)) return true;
  }
  snprintf(path, VS_PATH_SIZE, "%.4000s/%s", folder, vs_format_all->rows);
  return false;
}
