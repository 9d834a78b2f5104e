/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/table.h"

#include <errno.h>
#include <string.h>

#include "base/text.h"

void vs_table_begin(vs_table *table) {
  table->next = 0;
  fputs("t_s", table->stream);
  for (int k = 0; k < table->count; k++) {
    char suffix[32];
    vs_channel c = vs_channel_at(table->frame, table->channels[k]);
    vs_unit_suffix(c.unit, suffix, sizeof suffix);
    fprintf(table->stream, ",%s%s%s", c.name, *suffix ? "_" : "", suffix);
  }
  fputc('\n', table->stream);
}

vs_status vs_table_accept(vs_table *table, const vs_step *step, vs_error *err) {
  double y[VS_CH_MOST];
  if (step->to->t_s == step->from->t_s)
    return VS_OK; /* the other side of an instant already shown */
  /* the last row's instant and the end of the run may differ by rounding */
  double slack = 1e-9 * table->sample_s;
  for (;; table->next++) {
    double t = table->next * table->sample_s;
    if (t > step->to->t_s + (step->to->t_s >= table->until_s - slack ? slack : 0)) return VS_OK;
    vs_step_at(step, t < step->to->t_s ? t : step->to->t_s, y);
    fprintf(table->stream, "%.*g", table->digits, t);
    for (int k = 0; k < table->count; k++)
      fprintf(table->stream, ",%.*g", table->digits, y[table->channels[k]]);
    fputc('\n', table->stream);
    if (ferror(table->stream))
      return vs_fail(err, VS_RUN, "t = %.9g s: run.csv cannot be written: %s", t, strerror(errno));
  }
}
