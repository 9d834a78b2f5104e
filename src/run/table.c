/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/table.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "netlist/limits.h"

static int instruments_of(const vs_table *table) {
  return table->instruments ? table->instruments->count : 0;
}

vs_table vs_table_of(const vs_scene *s) {
  vs_table table = {.frame = &s->frame,
                    .count = s->n_record,
                    .instruments = &s->instruments,
                    .control = &s->control,
                    .digits = 9,
                    .sample_s = s->setup.run.sample_s,
                    .until_s = s->setup.run.until_s};
  memcpy(table.channels, s->record, sizeof s->record);
  return table;
}

bool vs_table_column_at(const vs_table *table, int k, vs_column *column) {
  const int n = k - 1, instrument = n - table->count, other = instrument - instruments_of(table);
  vs_control_column control;
  if (n < 0)
    *column = vs_channel_column("t", "s", VS_COLUMN_TIME, NULL);
  else if (instrument < 0) {
    const vs_channel c = vs_channel_at(table->frame, table->channels[n]);
    *column = vs_channel_column(c.name, c.unit, c.role, c.of);
  } else if (other < 0) {
    const vs_instrument *i = &table->instruments->item[instrument];
    *column = vs_channel_column(i->column, i->unit, VS_COLUMN_INSTRUMENT, i->v.channel);
  } else if (table->control && vs_control_column_at(table->control, other, &control))
    *column = vs_channel_column(control.name, control.unit, control.role, control.of);
  else
    return false;
  return true;
}

static int columns_of_table(const vs_table *table) {
  vs_column column;
  int n = 0;
  while (vs_table_column_at(table, n, &column)) n++;
  return n;
}

/* ---- what is seen between two rows ---- */

struct vs_table_between {
  int width;                       /* columns, with the time */
  double *row;                     /* the last row, [width]; before the first one its time is NaN */
  double *least, *largest;         /* of each column from that row on, [width] */
  double *run_least, *run_largest; /* of each column up to that row, [width] */
  double *seen;                    /* instants from that row on, in order of time, [room * width] */
  bool *marked;                    /* those that become rows, [room] */
  int count, room;
  char *line;   /* a row's text */
  double bytes; /* of the file with the further rows */
  bool has_further;
  int cannot_be_read; /* errno of reading what was written; 0: it was read */
};

static double *cells_of(const vs_table_between *b, int n) {
  return b->seen + (size_t)n * (size_t)b->width;
}

static void new_between(vs_table *table, int width) {
  vs_table_between *b = table->between = vs_alloc(1, sizeof *b);
  size_t n = (size_t)width;
  b->width = width;
  /* two extremes of each column are always kept, and at least as many instants besides */
  b->room = 4 * width + 128;
  b->row = vs_alloc(5 * n, sizeof *b->row);
  b->least = b->row + n;
  b->largest = b->least + n;
  b->run_least = b->largest + n;
  b->run_largest = b->run_least + n;
  b->seen = vs_alloc((size_t)b->room * n, sizeof *b->seen);
  b->marked = vs_alloc((size_t)b->room, sizeof *b->marked);
  b->line = vs_alloc(n, VS_NUMBER_SIZE + 1);
  b->row[0] = NAN;
  for (int k = 0; k < width; k++) b->run_least[k] = INFINITY, b->run_largest[k] = -INFINITY;
}

void vs_table_end(vs_table *table) {
  if (!table->between) return;
  free(table->between->row);
  free(table->between->seen);
  free(table->between->marked);
  free(table->between->line);
  free(table->between);
  table->between = NULL;
}

vs_table_peaks vs_table_found(const vs_table *table) {
  if (!table->peaks || !table->between->has_further) return VS_TABLE_NONE;
  return table->between->bytes > table->peaks_most ? VS_TABLE_BEYOND : VS_TABLE_SOME;
}

/* Marks the first of the instants at which the column has that value, and returns its number. One
 * of them has it, or the last row. */
static int mark(vs_table_between *b, int column, double value) {
  int n = 0;
  while (n < b->count && cells_of(b, n)[column] != value) n++;
  if (n < b->count) b->marked[n] = true;
  return n;
}

static void unmark(vs_table_between *b) {
  memset(b->marked, 0, (size_t)b->room * sizeof *b->marked);
}

/* Makes room: of what is no extreme of a channel every second instant goes. */
static void thin(const vs_table *table) {
  vs_table_between *b = table->between;
  int kept = 0, others = 0;
  for (int k = 1; k <= table->count; k++) {
    mark(b, k, b->least[k]);
    mark(b, k, b->largest[k]);
  }
  for (int n = 0; n < b->count; n++) {
    if (!b->marked[n] && others++ % 2) continue;
    if (kept != n) memcpy(cells_of(b, kept), cells_of(b, n), (size_t)b->width * sizeof *b->seen);
    kept++;
  }
  b->count = kept;
  unmark(b);
}

/* The cells of a row, which the caller has filled in where the next instant stands, are seen. */
static void look_at_channels(const vs_table *table) {
  vs_table_between *b = table->between;
  const double *cells = cells_of(b, b->count);
  if (isnan(b->row[0])) return;
  for (int k = 1; k <= table->count; k++) {
    if (cells[k] < b->least[k]) b->least[k] = cells[k];
    if (cells[k] > b->largest[k]) b->largest[k] = cells[k];
  }
  if (++b->count == b->room) thin(table);
}

/* Marks the peak of a column, of which sense * value is the largest, and its feet. `base`: the same
 * of the rows beside it. */
static void mark_peak(vs_table_between *b, int column, double sense, double value, double base) {
  const double foot = base + 0.1 * (sense * value - base);
  int peak = mark(b, column, value);
  if (peak == b->count) return;
  for (int side = -1; side <= 1; side += 2) {
    int n = peak + side;
    while (n >= 0 && n < b->count && sense * cells_of(b, n)[column] > foot) n += side;
    if (n >= 0 && n < b->count) b->marked[n] = true;
  }
}

/* What a peak has to pass the rows beside it by: this share of its column's range, or of itself
 * where it is the run's extreme so far and told. The first is as much as is seen in a picture; the
 * second is half of the 1 % to which the run's extremes are to be found in the file. What is less
 * than the third share of the range is rounding: coordinates at rest move by 1e-32 m. */
static const double SHARE_OF_RANGE = 0.02, SHARE_OF_EXTREME = 0.005, ROUNDING = 1e-6;

/* True if the run tells the extremes of the column's channel. */
static bool is_told(const vs_table *table, int column) {
  const vs_measures *m = table->measures;
  const int channel = table->channels[column - 1];
  bool told = channel >= vs_channel_deck(table->frame->model);
  for (int k = 0; m && k < m->of_probes; k++) told = told || m->extremes[k].channel == channel;
  for (size_t k = 0; m && k < m->n_followed; k++) told = told || m->followed[k].channel == channel;
  return told;
}

/* Marks what becomes a further row, and returns true if something does. `row`: the next one; NULL:
 * there is none. */
static bool mark_peaks(const vs_table *table, const double *row) {
  vs_table_between *b = table->between;
  bool found = false;
  if (!b->count) return false; /* nothing but the two rows was seen */
  for (int k = 1; k <= table->count; k++)
    for (int sense = -1; sense <= 1; sense += 2) {
      double value = sense > 0 ? b->largest[k] : b->least[k], base = sense * b->row[k];
      double range = fmax(b->run_largest[k], b->largest[k]) - fmin(b->run_least[k], b->least[k]);
      if (row) base = fmax(base, sense * row[k]);
      double over = sense * value - base;
      double before = sense > 0 ? b->run_largest[k] : -b->run_least[k];
      bool is_new = sense * value > before;
      if (!(over > ROUNDING * range)) continue;
      if (!(over > SHARE_OF_RANGE * range ||
            (is_new && over > SHARE_OF_EXTREME * fabs(value) && is_told(table, k))))
        continue;
      mark_peak(b, k, sense, value, base);
      found = true;
    }
  return found;
}

/* ---- text ---- */

void vs_table_begin(vs_table *table) {
  table->next = 0;
  vs_table_end(table);
  new_between(table, columns_of_table(table));
  vs_column column;
  for (int k = 0; table->stream && vs_table_column_at(table, k, &column); k++)
    fprintf(table->stream, "%s%s", k ? "," : "", column.name);
  if (table->stream) fputc('\n', table->stream);
}

/* ---- size ---- */

/* Bytes of a number besides its digits: sign, point, exponent, comma. In tables of nine digits 1.5
 * to 4.3 were seen. */
enum { BESIDES = 5 };

static double rows_of_table(const vs_table *table) {
  return floor(table->until_s / table->sample_s) + 1;
}

double vs_table_bytes(const vs_table *table) {
  return rows_of_table(table) * columns_of_table(table) * (table->digits + BESIDES);
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
                    size, rows_of_table(table), columns_of_table(table), most);
}

static void write_peaks(const vs_table *table, size_t length) {
  vs_table_between *b = table->between;
  if (!b->has_further) return;
  b->bytes += (double)length;
  if (b->bytes <= table->peaks_most) fwrite_unlocked(b->line, 1, length, table->peaks);
}

/* Begins the file with the further rows by what the other one has so far. An error stays in the
 * stream. */
static void copy_rows(const vs_table *table) {
  char part[1 << 16];
  ssize_t length;
  off_t at = 0;
  if (fflush(table->stream)) return;
  while ((length = pread(fileno(table->stream), part, sizeof part, at)) > 0) {
    fwrite_unlocked(part, 1, (size_t)length, table->peaks);
    at += length;
  }
  table->between->bytes = (double)at;
  if (length < 0) table->between->cannot_be_read = errno;
}

/* Makes the row's text and returns its length. */
static size_t make_line_of_table(const vs_table *table, const double *cells) {
  char *line = table->between->line, *s = line;
  for (int k = 0; k < table->between->width; k++) {
    if (k) *s++ = ',';
    s += vs_text_number(s, cells[k], table->digits);
  }
  *s++ = '\n';
  return (size_t)(s - line);
}

/* Writes the further rows that stand before `row`, which is NULL at the run's end. */
static void write_further(const vs_table *table, const double *row) {
  vs_table_between *b = table->between;
  if (!table->peaks || isnan(b->row[0]) || !mark_peaks(table, row)) return;
  if (!b->has_further) copy_rows(table);
  b->has_further = true;
  for (int n = 0; n < b->count; n++)
    if (b->marked[n]) write_peaks(table, make_line_of_table(table, cells_of(b, n)));
  unmark(b);
}

/* From now on `row` is the last one, which may be the same again. */
static void keep_last_row(const vs_table *table, const double *row) {
  vs_table_between *b = table->between;
  for (int k = 1; k <= table->count && !isnan(b->row[0]); k++) {
    if (b->least[k] < b->run_least[k]) b->run_least[k] = b->least[k];
    if (b->largest[k] > b->run_largest[k]) b->run_largest[k] = b->largest[k];
  }
  if (b->row != row) memcpy(b->row, row, (size_t)b->width * sizeof *row);
  memcpy(b->least, row, (size_t)b->width * sizeof *row);
  memcpy(b->largest, row, (size_t)b->width * sizeof *row);
  b->count = 0;
}

/* ---- steps ---- */

/* Fills in the time and the channels at an instant of the step, and returns where the others stand.
 */
static double *take_channels(const vs_table *table, const vs_step *step, double at_s, double time,
                             double *cells) {
  double y[VS_CH_MOST];
  vs_step_at(step, at_s, y);
  *cells++ = time;
  for (int k = 0; k < table->count; k++) *cells++ = y[table->channels[k]];
  return cells;
}

static void take_control(const vs_table *table, double *cells) {
  vs_control_column column;
  for (int k = 0; table->loop && vs_control_column_at(table->control, k, &column); k++)
    *cells++ = vs_loop_shows(table->loop, k);
}

/* Fills in what the columns show at an instant of the step; time is what the row says it is. */
static void take_table_row(vs_table *table, const vs_step *step, double at_s, double time,
                           double *cells) {
  const bool moves = step->to->t_s > step->from->t_s;
  cells = take_channels(table, step, at_s, time, cells);
  if (table->loop && moves) vs_loop_run_to(table->loop, step, at_s);
  for (int k = 0; k < instruments_of(table); k++) {
    if (moves) vs_meter_to(&table->meters[k], step, at_s);
    *cells++ = table->meters[k].value;
  }
  take_control(table, cells);
}

/* The meters stay where they are, so that no row depends on whether anyone has looked. */
void vs_table_peek(const vs_table *table, const vs_step *step, double at_s, double *cells) {
  cells = take_channels(table, step, at_s, at_s, cells);
  for (int k = 0; k < instruments_of(table); k++) {
    vs_meter meter = table->meters[k];
    if (step->to->t_s > step->from->t_s) vs_meter_to(&meter, step, at_s);
    *cells++ = meter.value;
  }
  take_control(table, cells);
}

enum { MOST_INSTANTS = VS_MOST_EXTREMES + 2 * VS_CH_MOST + VS_STEP_PARTS };

/* Adds an instant where it is within the step and not at one of its ends. */
static void add_instant(double t, const vs_step *step, double *at_s, int *count) {
  int n = *count;
  if (!(t > step->from->t_s && t < step->to->t_s) || n == MOST_INSTANTS) return;
  for (; n && at_s[n - 1] > t; n--) at_s[n] = at_s[n - 1];
  at_s[n] = t;
  ++*count;
}

static void add_instant_of_peak(const vs_extreme *e, const vs_step *step, double *at_s,
                                int *count) {
  if (e->best.known) add_instant(e->best.at_s, step, at_s, count);
}

/* True if a probe of the deck turns between the k-th piece of the step and the next. */
static bool turns_behind(const vs_step *step, int k) {
  const vs_piece before = vs_step_piece(step, k), behind = vs_step_piece(step, k + 1);
  const vs_deck *deck = step->frame->deck;
  bool turns = false;
  for (size_t n = 0; n < deck->n_probes && !turns; n++) {
    const int term = deck->probes[n].term;
    turns = (before.to->terms[term] - before.from->terms[term]) *
                (behind.to->terms[term] - behind.from->terms[term]) <
            0;
  }
  return turns;
}

/* The instants within the step at which the measures have found an extreme, or a probe turns, in
 * order of time. */
static int find_instants(const vs_table *table, const vs_step *step, double *at_s) {
  const vs_measures *m = table->peaks ? table->measures : NULL;
  int count = 0;
  for (int k = 0; m && k < m->of_probes; k++)
    add_instant_of_peak(&m->extremes[k], step, at_s, &count);
  for (size_t k = 0; m && k < m->n_followed; k++)
    for (int n = 0; n < 2; n++) add_instant_of_peak(&m->followed[k].end[n], step, at_s, &count);
  for (int k = 0; m && k < step->parts; k++)
    if (turns_behind(step, k)) add_instant(step->part[k].t_s, step, at_s, &count);
  for (int n = count - 1; step->parts && n > 0; n--) /* such a turn may be a followed extreme */
    if (at_s[n] == at_s[n - 1])
      memmove(at_s + n, at_s + n + 1, (size_t)(--count - n) * sizeof *at_s);
  return count;
}

static void look_at_peak(vs_table *table, const vs_step *step, double at_s) {
  if (!table->peaks) return;
  take_table_row(table, step, at_s, at_s, cells_of(table->between, table->between->count));
  look_at_channels(table);
}

static vs_status check_streams(const vs_table *table, double t_s, vs_error *err) {
  if (!table->stream) return VS_OK;
  const bool own = ferror(table->stream);
  if (table->between->cannot_be_read)
    return vs_fail(err, VS_RUN, "t = %.9g s: run.csv cannot be read back: %s", t_s,
                   strerror(table->between->cannot_be_read));
  if (!own && !(table->peaks && ferror(table->peaks))) return VS_OK;
  return vs_fail(err, VS_RUN, "t = %.9g s: %s.csv cannot be written: %s", t_s,
                 own ? "run" : "peaks", strerror(errno));
}

static vs_status write_row(vs_table *table, const vs_step *step, double at_s, double time,
                           vs_error *err) {
  const vs_table_reader *reader = table->reader;
  vs_table_between *b = table->between;
  double *cells = cells_of(b, b->count); /* there is always room for one more */
  vs_status status = VS_OK;
  take_table_row(table, step, at_s, time, cells);
  if (table->stream) {
    write_further(table, cells);
    size_t length = make_line_of_table(table, cells);
    fwrite_unlocked(b->line, 1, length, table->stream);
    write_peaks(table, length);
  }
  if (reader) status = reader->row(reader->ctx, cells, b->width, err);
  keep_last_row(table, cells);
  return status ? status : check_streams(table, time, err);
}

static vs_status tell_reader(const vs_table *table, const vs_step *step, double t_s,
                             vs_error *err) {
  const vs_table_reader *reader = table->reader;
  return reader ? reader->reach(reader->ctx, table, step, t_s, err) : VS_OK;
}

/* Writes what stands behind the last row, as the run ends with the step. */
static vs_status finish_table(const vs_table *table, vs_error *err) {
  write_further(table, NULL);
  keep_last_row(table, table->between->row);
  return check_streams(table, table->until_s, err);
}

vs_status vs_table_accept(vs_table *table, const vs_step *step, vs_error *err) {
  double instants[MOST_INSTANTS];
  const double to_s = step->to->t_s;
  /* the last row's instant and the end of the run may differ by rounding */
  const double slack = 1e-9 * table->sample_s;
  const bool ends = to_s >= table->until_s - slack;
  int seen = 0, count = find_instants(table, step, instants);
  vs_status status = VS_OK;
  /* a step of no length shows the other side of an instant whose row is written */
  for (bool moves = to_s > step->from->t_s; moves && !status; table->next++) {
    const double t = table->next * table->sample_s, within = t < to_s ? t : to_s;
    if (t > to_s + (ends ? slack : 0)) break;
    for (; seen < count && instants[seen] < within; seen++)
      look_at_peak(table, step, instants[seen]);
    status = tell_reader(table, step, within - slack, err);
    if (!status) status = write_row(table, step, within, t, err);
  }
  for (; seen < count && !status; seen++) look_at_peak(table, step, instants[seen]);
  if (!status) look_at_peak(table, step, to_s);
  if (!status) status = tell_reader(table, step, to_s, err);
  return status || !ends || isnan(table->between->row[0]) ? status : finish_table(table, err);
}
