/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rawfile.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "netlist/limits.h"

enum { COUNT_WIDTH = 12 }; /* room for the number of points */

vs_rawfile vs_rawfile_begin(FILE *stream, const char *title, const char *const *names,
                            size_t count) {
  static const char BRANCH[] = "#branch";
  vs_rawfile raw = {.stream = stream, .vectors = count};
  fprintf(stream,
          "Title: %.*s\n"
          "Plotname: Transient Analysis\n"
          "Flags: real\n"
          "No. Variables: %zu\n"
          "No. Points: ",
          (int)strcspn(title, "\r\n"), title, count);
  raw.count_at = ftell(stream);
  fprintf(stream, "%-*d\nVariables:\n", COUNT_WIDTH, 0);
  for (size_t k = 0; k < count; k++) {
    const char *branch = strstr(names[k], BRANCH);
    if (branch)
      fprintf(stream, "\t%zu\ti(%.*s)\tcurrent\n", k, (int)(branch - names[k]), names[k]);
    else if (k == 0)
      fprintf(stream, "\t%zu\t%s\ttime\n", k, names[k]);
    else
      fprintf(stream, "\t%zu\tv(%s)\tvoltage\n", k, names[k]);
  }
  fputs("Binary:\n", stream);
  return raw;
}

static double bytes_of(const vs_rawfile *raw, double points) {
  return points * (double)raw->vectors * sizeof(double);
}

vs_status vs_rawfile_expect(const vs_rawfile *raw, double points, vs_where where, vs_error *err) {
  const double bytes = bytes_of(raw, points);
  char size[VS_LIMITS_SIZE];
  if (raw->most_bytes <= 0 || bytes <= raw->most_bytes) return VS_OK;
  vs_limits_write(bytes, size);
  return vs_fail_at(err, where,
                    "run.raw would have at least %s, in %.4g steps of %zu vectors; limits.raw = "
                    "%.9g bytes allows no more: take a shorter run.until, or raise it",
                    size, points, raw->vectors, raw->most_bytes);
}

vs_status vs_rawfile_room(const vs_rawfile *raw, double t_s, vs_error *err) {
  if (raw->most_bytes <= 0 || bytes_of(raw, 1 + (double)raw->points) <= raw->most_bytes)
    return VS_OK;
  return vs_fail(err, VS_RUN,
                 "t = %.9g s: run.raw has the limits.raw = %.9g bytes that it may have; take a "
                 "shorter run.until, or raise it",
                 t_s, raw->most_bytes);
}

vs_status vs_rawfile_point(vs_rawfile *raw, const double *values, vs_error *err) {
  if (fwrite(values, sizeof *values, raw->vectors, raw->stream) != raw->vectors)
    return vs_fail(err, VS_RUN, "t = %.9g s: the rawfile cannot be written: %s", values[0],
                   strerror(errno));
  raw->points++;
  return VS_OK;
}

vs_status vs_rawfile_end(vs_rawfile *raw, vs_error *err) {
  bool good = raw->count_at >= 0 && !fseek(raw->stream, raw->count_at, SEEK_SET) &&
              fprintf(raw->stream, "%-*ld", COUNT_WIDTH, raw->points) > 0 &&
              !fseek(raw->stream, 0, SEEK_END) && !ferror(raw->stream);
  return good ? VS_OK : vs_fail(err, VS_RUN, "the rawfile cannot be written: %s", strerror(errno));
}
