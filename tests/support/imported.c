/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "imported.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* Allowed, of each peak. */
static const double NEAR = 1e-3;

/* The coil's inductance is constant, as the netlist's: a coil in a field of no force. */
#define HELD "--set actuator.law=moving_coil --set 'actuator.emf_constant=0 V.s/m'"

/* ---- decks.txt ---- */

typedef struct deck {
  const char *netlist, *options, *settings, *ngspice, *until, *signals, *missed;
} deck;

enum { MOST_DECKS = 40 };

typedef struct decks {
  const char *origin;
  char *text, *references; /* owned */
  deck item[MOST_DECKS];
  int count;
} decks;

/* Cuts the field that begins at *rest, without the blanks around it. */
static char *field(char **rest) {
  char *word = strsep(rest, "|");
  if (!word) return "";
  word += strspn(word, " \t");
  for (size_t n = strlen(word); n > 0 && strchr(" \t\n", word[n - 1]);) word[--n] = '\0';
  return word;
}

/* Makes the origin's folder the link `decks` in the work folder, and reads its tables. */
static decks begin(const char *origin) {
  decks d = {.origin = origin};
  char folder[512];
  snprintf(folder, sizeof folder, VS_TEST_FOLDER "/cases/import/%s", origin);
  unlink("decks"); /* of an earlier test */
  CU_ASSERT_EQUAL_FATAL(symlink(folder, "decks"), 0);
  d.text = read_file("decks/decks.txt");
  d.references = read_file("decks/references.csv");
  char *rest = d.text;
  for (char *line; d.count < MOST_DECKS && (line = strsep(&rest, "\n"));) {
    if (!strchr(line, '|') || *line == '#') continue;
    deck *k = &d.item[d.count++];
    k->netlist = field(&line);
    k->options = field(&line);
    k->settings = field(&line);
    k->ngspice = field(&line);
    k->until = field(&line);
    k->signals = field(&line);
    k->missed = field(&line);
  }
  EXPECT(d.count >= 12, "%s: %d netlists", origin, d.count);
  return d;
}

static void end(decks *d) {
  free(d->text);
  free(d->references);
}

/* ---- with the gap held ---- */

/* Imports the netlist to w.cir with its scene w.yaml. */
static bool import(const deck *k) {
  ran r = run("import decks/%s %s -o w.cir --scene w.yaml --quiet", k->netlist, k->options);
  bool good = r.status == 0 && !*r.err;
  EXPECT(good, "%s: %s", k->netlist, r.err);
  free_ran(&r);
  if (!good) return false;
  r = run("check w.cir --no-jail"); /* its models lie beside the netlist */
  good = r.status == 0;
  EXPECT(good, "%s: %s", k->netlist, r.err);
  free_ran(&r);
  return good;
}

/* How far a probe's extremes are from its row of references.csv, of its peak; INFINITY: no row. Of
 * "^NAME" the maximum alone is compared. */
static double error_of(const decks *d, const deck *k, const char *probe, const char *json) {
  bool maximum = *probe == '^';
  probe += maximum;
  char wanted[128];
  double min = NAN, max = NAN, uncertain = NAN;
  snprintf(wanted, sizeof wanted, "\n%s,%s,", k->netlist, probe);
  const char *at = strstr(d->references, wanted);
  bool read = at && sscanf(at + strlen(wanted), "%lf,%lf,%lf", &min, &max, &uncertain) == 3;
  EXPECT(read, "%s: no reference of %s; tools/import_references makes it", k->netlist, probe);
  EXPECT(uncertain <= 3e-4, "%s: the reference of %s is off by %.1e itself", k->netlist, probe,
         uncertain);
  double peak = fmax(fabs(min), fabs(max));
  if (!read) return INFINITY;
  if (!strcmp(probe, "i_peak")) return fabs(json_measure(json, probe, "") / peak - 1);
  double low = maximum ? 0 : fabs(json_measure(json, probe, "_min") - min);
  return fmax(low, fabs(json_measure(json, probe, "_max") - max)) / peak;
}

/* Runs what was imported, and gives the worst of its signals. */
static double held(const decks *d, const deck *k, bool telling) {
  double worst = 0;
  char *signals = vs_copy(k->signals), *rest = signals;
  ran r = run("run w.yaml --json --quiet %s " HELD, k->settings);
  EXPECT(r.status == 0 || r.status == 3, "%s: %d: %s", k->netlist, r.status, r.err);
  for (char *signal; (signal = strsep(&rest, " "));) {
    char *equals = strchr(signal, '=');
    if (!equals) continue;
    *equals = '\0';
    double error = error_of(d, k, signal, r.out);
    EXPECT(error <= NEAR, "%s: %s is off by %.2e of its peak", k->netlist, signal, error);
    worst = fmax(worst, error);
  }
  if (telling) printf(" %s %.1e", k->netlist, worst);
  free(signals);
  free_ran(&r);
  return worst;
}

void imported_held(const char *origin, int first) {
  decks d = begin(origin);
  const bool all = getenv("VS_LONG");
  for (int k = 0; k < d.count; k++)
    if (import(&d.item[k]) && strcmp(d.item[k].until, "-") && (all || k % 2 == first))
      held(&d, &d.item[k], true);
  end(&d);
}

/* ---- exported ---- */

enum { MOST_COLUMNS = 64 };

/* What ngspice measured of a column of the exported netlist. */
typedef struct extreme {
  char name[64];
  double min, max;
} extreme;

/* Writes the exported x.cir as y.cir, with meas of each column in the place of its table, reltol as
 * given and the largest step divided; gives the columns. */
static int with_measures(const char *reltol, int divisor, extreme of[MOST_COLUMNS]) {
  static const char RELTOL[] = "reltol=0.001", STEP[] = ".param vs_step=", TABLE[] = "linearize ";
  char *text = read_file("x.cir"), *rest = text;
  int count = 0;
  FILE *out = fopen("y.cir", "w");
  for (char *line; (line = strsep(&rest, "\n"));) {
    char *at = strstr(line, RELTOL);
    if (!strncmp(line, TABLE, strlen(TABLE))) {
      char *words = line + strlen(TABLE);
      for (char *name; (name = strsep(&words, " ")) && count < MOST_COLUMNS;) {
        if (!*name) continue;
        fprintf(out, "meas tran low_%s min %s\nmeas tran high_%s max %s\n", name, name, name, name);
        of[count] = (extreme){.min = NAN, .max = NAN};
        snprintf(of[count++].name, sizeof of->name, "%s", name);
      }
      fputs("quit 0\n", out);
    } else if (at)
      fprintf(out, "%.*sreltol=%s abstol=1e-9 vntol=1e-5%s\n", (int)(at - line), line, reltol,
              at + strlen(RELTOL));
    else if (!strncmp(line, STEP, strlen(STEP)))
      fprintf(out, "%s{%.*s/%d}\n", STEP, (int)strcspn(line + strlen(STEP), " ;"),
              line + strlen(STEP), divisor);
    else
      fprintf(out, "%s\n", line);
  }
  fclose(out);
  free(text);
  return count;
}

/* Runs ngspice on the exported netlist. Returns how many columns it has; 0: ngspice gives up. */
static int measured(const deck *k, const char *reltol, int divisor, extreme of[MOST_COLUMNS]) {
  vs_text command = {0};
  char wanted[96];
  int count = with_measures(reltol, divisor, of);
  vs_text_add(&command, "ngspice %s -b y.cir >y.log 2>&1", k->ngspice);
  bool good = system(command.text) == 0;
  vs_text_free(&command);
  if (!good) return 0;
  char *log = read_file("y.log");
  for (int n = 0; n < count; n++)
    for (int high = 0; high < 2; high++) {
      snprintf(wanted, sizeof wanted, "\n%s_%.64s ", high ? "high" : "low", of[n].name);
      const char *at = strcasestr(log, wanted), *equals = at ? strchr(at, '=') : NULL;
      if (equals) *(high ? &of[n].max : &of[n].min) = strtod(equals + 1, NULL);
      EXPECT(equals, "%s: ngspice did not measure %s", k->netlist, of[n].name);
    }
  free(log);
  return count;
}

/* How far a column is from the run's measures, of its peak; NAN: no measure is of it. */
static double off(const extreme *e, const char *json) {
  char name[64], low[96];
  double peak = fmax(fabs(e->min), fabs(e->max));
  snprintf(name, sizeof name, "%.*s", (int)(strrchr(e->name, '_') - e->name), e->name);
  snprintf(low, sizeof low, "\"%s_min\": {\"value\"", name);
  if (!strcmp(name, "i")) return fabs(json_measure(json, "i_peak", "") / peak - 1);
  if (!strstr(json, low)) return NAN;
  return fmax(fabs(json_measure(json, name, "_min") - e->min),
              fabs(json_measure(json, name, "_max") - e->max)) /
         peak;
}

/* How far the worst of the columns is off. */
static double worst_off(const extreme *of, int count, const char *json) {
  double worst = 0;
  for (int n = 0; n < count; n++) worst = fmax(worst, off(&of[n], json));
  return worst;
}

/* True for a column that decks.txt says is missed. */
static bool is_missed(const deck *k, const char *column) {
  size_t n = strlen(column);
  for (const char *at = k->missed; (at = strstr(at, column)); at += n)
    if ((at == k->missed || at[-1] == ' ') && strchr(" ", at[n])) return true;
  return false;
}

/* The worst difference between run and export, of a column's peak. A column of which ngspice itself
 * is not certain, as its extremes change by more than 3e-4 with half the step, is not judged; nor
 * is one that is nothing. Where a column is off, the run is made once
 * more at a tolerance of 1e-6, and the better one is taken. `remark` tells all that, and by how
 * much columns are off that decks.txt says are missed; these do not count. */
static double exported(const deck *k, vs_text *remark) {
  static const struct {
    const char *reltol;
    int divisor;
  } SETTINGS[] = {{"1e-5", 2}, {"1e-5", 1}, {"1e-4", 2}, {"1e-4", 1}, {"1e-3", 2}, {"1e-3", 1}};
  extreme coarse[MOST_COLUMNS], fine[MOST_COLUMNS];
  double worst = 0;
  int judged = 0, count = 0, ran_ones = 0;
  ran r = run("export w.yaml %s -o x.cir", k->settings);
  EXPECT(r.status == 0, "%s: %s", k->netlist, r.err);
  free_ran(&r);
  /* the finest settings with which ngspice does not give up, and the next ones */
  for (size_t n = 0; n < COUNT(SETTINGS) && ran_ones < 2; n++) {
    int columns = measured(k, SETTINGS[n].reltol, SETTINGS[n].divisor, ran_ones ? coarse : fine);
    if (columns) ran_ones++, count = columns;
  }
  EXPECT(ran_ones == 2, "%s: ngspice gives up", k->netlist);
  if (ran_ones < 2) {
    vs_text_add(remark, "ngspice gives up");
    return NAN;
  }
  r = run("run w.yaml --json --quiet %s", k->settings);
  EXPECT(r.status == 0 || r.status == 3, "%s: %s", k->netlist, r.err);
  if ((r.status == 0 || r.status == 3) && worst_off(fine, count, r.out) > NEAR) {
    ran finer = run("run w.yaml --json --quiet %s --set run.tolerance=1e-6", k->settings);
    bool better = (finer.status == 0 || finer.status == 3) &&
                  worst_off(fine, count, finer.out) < worst_off(fine, count, r.out);
    if (better) vs_text_add(remark, "at run.tolerance 1e-6");
    ran other = better ? r : finer;
    if (better) r = finer;
    free_ran(&other);
  }
  for (int n = 0; n < count && (r.status == 0 || r.status == 3); n++) {
    double peak = fmax(fabs(fine[n].min), fabs(fine[n].max)), error = off(&fine[n], r.out);
    double changed = fmax(fabs(fine[n].min - coarse[n].min), fabs(fine[n].max - coarse[n].max));
    if (isnan(error) || peak < 1e-9) continue;
    if (changed > 3e-4 * peak) {
      vs_text_add(remark, "%s%s",
                  strstr(remark->length ? remark->text : "", "not judged") ? " " : "; not judged: ",
                  fine[n].name);
      continue;
    }
    judged++;
    if (error > NEAR && is_missed(k, fine[n].name)) {
      vs_text_add(remark, "; missed: %s by %.1e", fine[n].name, error);
      continue;
    }
    worst = fmax(worst, error);
    EXPECT(error <= NEAR, "%s: %s is off by %.2e of its peak", k->netlist, fine[n].name, error);
  }
  EXPECT(judged >= 5, "%s: %d columns", k->netlist, judged);
  free_ran(&r);
  return worst;
}

void imported_exported(const char *origin) {
  if (!getenv("VS_LONG") || !on_path("ngspice")) return;
  decks d = begin(origin);
  char path[96], edits[160];
  const char *folder = getenv("VS_ROWS");
  snprintf(path, sizeof path, "%s/imports_%s.csv", folder ? folder : "..", origin);
  FILE *csv = fopen(path, "w");
  CU_ASSERT_PTR_NOT_NULL_FATAL(csv);
  fputs("origin,netlist,options,signals,worst_held,worst_exported,remark\n", csv);
  for (int k = 0; k < d.count; k++) {
    const deck *item = &d.item[k];
    if (!import(item)) continue;
    bool read = strcmp(item->until, "-");
    snprintf(edits, sizeof edits, "decks/%s.sed", item->netlist);
    fprintf(csv, "%s,%s,\"%s\",\"%s\",", origin, item->netlist, item->options, item->signals);
    if (read) fprintf(csv, "%.1e", held(&d, item, false));
    vs_text remark = {0};
    double worst = exported(item, &remark);
    bool edited = access(edits, F_OK) == 0;
    const char *text = remark.length ? remark.text : "";
    if (!edited) text += strspn(text, "; ");
    fprintf(csv, ",%.1e,%s%s%s\n", worst, edited ? "edited for plain ngspice" : "",
            edited && *text && *text != ';' ? "; " : "", text);
    vs_text_free(&remark);
    fflush(csv);
  }
  fclose(csv);
  end(&d);
}
