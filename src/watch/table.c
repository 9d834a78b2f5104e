/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/table.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "bounds/limits.h"
#include "syntax/units.h"

static int instruments_of(const vs_table *table) {
  return table->instruments ? table->instruments->count : 0;
}

static void write_name(const vs_table *table, const char *name, const char *unit) {
  char suffix[32];
  vs_units_suffix(unit, suffix, sizeof suffix);
  fprintf(table->stream, ",%s%s%s", name, *suffix ? "_" : "", suffix);
}

void vs_table_begin(vs_table *table) {
  table->next = 0;
  fputs("t_s", table->stream);
  for (int k = 0; k < table->count; k++) {
    vs_channel c = vs_channel_at(table->frame, table->channels[k]);
    write_name(table, c.name, c.unit);
  }
  for (int k = 0; k < instruments_of(table); k++)
    write_name(table, table->instruments->item[k].column, table->instruments->item[k].unit);
  vs_control_column column;
  for (int k = 0; table->control && vs_control_column_at(table->control, k, &column); k++)
    write_name(table, column.name, column.unit);
  fputc('\n', table->stream);
}

static int columns_of(const vs_table *table) {
  vs_control_column column;
  int n = 1 + table->count + instruments_of(table), k = 0;
  while (table->control && vs_control_column_at(table->control, k, &column)) k++;
  return n + k;
}

/* Bytes of a number besides its digits: sign, point, exponent, comma. In tables of nine digits 1.5
 * to 4.3 were seen. */
enum { BESIDES = 5 };

static double rows_of(const vs_table *table) {
  return floor(table->until_s / table->sample_s) + 1;
}

double vs_table_bytes(const vs_table *table) {
  return rows_of(table) * columns_of(table) * (table->digits + BESIDES);
}

vs_where vs_table_where(const vs_node *scene) {
  const vs_node *run = vs_tree_child(scene, "run"), *node = vs_tree_child(run, "sample");
  return node ? node->where : vs_tree_place(scene, "run.until");
}

vs_status vs_table_check(const vs_table *table, const vs_node *scene, double most, vs_error *err) {
  const double bytes = vs_table_bytes(table);
  char size[VS_LIMITS_SIZE];
  if (bytes <= most) return VS_OK;
  vs_limits_write(bytes, size);
  return vs_fail_at(err, vs_table_where(scene),
                    "run.csv would have about %s, in %.4g rows of %d columns; limits.csv = "
                    "%.9g bytes allows no more: take a longer run.sample, record fewer probes, or "
                    "raise it",
                    size, rows_of(table), columns_of(table), most);
}

static void write_number(vs_table *table, double value, char before) {
  char text[VS_NUMBER_SIZE];
  size_t length = vs_text_number(text, value, table->digits);
  if (before) putc_unlocked(before, table->stream);
  fwrite_unlocked(text, 1, length, table->stream);
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
    double within = t < step->to->t_s ? t : step->to->t_s;
    vs_step_at(step, within, y);
    write_number(table, t, '\0');
    for (int k = 0; k < table->count; k++) write_number(table, y[table->channels[k]], ',');
    if (table->loop) vs_loop_to(table->loop, step, within);
    for (int k = 0; k < instruments_of(table); k++) {
      vs_meter_to(&table->meters[k], step, within);
      write_number(table, table->meters[k].value, ',');
    }
    vs_control_column column;
    for (int k = 0; table->loop && vs_control_column_at(table->control, k, &column); k++)
      write_number(table, vs_loop_shows(table->loop, k), ',');
    putc_unlocked('\n', table->stream);
    if (ferror(table->stream))
      return vs_fail(err, VS_RUN, "t = %.9g s: run.csv cannot be written: %s", t, strerror(errno));
  }
}
