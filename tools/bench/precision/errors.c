/* SPDX-License-Identifier: GPL-3.0-or-later
 * What part d of tools/bench/work_precision, and tools/bench/study, ask of the library:
 *
 *   errors reference TIER FILE [KEY=VALUE...]   p of the paper's scene every 0.1 ms of its 2 s (or
 *                                of run.until, at most as long), by tests/support/oracle.h
 *   errors csv REF FILE          largest error of p in a run.csv, in parts of its peak
 *   errors bin REF FILE          in a record of the peers: p, u, w, phi, i as doubles
 *   errors deck REF FILE         in a table "time, p in mm, p' in mm/s" of ngspice's own points
 *   errors seconds N COMMAND...  least and median wall time of N runs of a program, s
 *
 *   errors reference-all FILE [KEY=VALUE...]
 *                                p, u, w, phi and i of the circuit tier's scene, likewise
 *   errors csv-as-reference FILE RUN   the same from a run.csv of the paper's coil
 *   errors csv-all REF FILE      their largest error in a run.csv, each in parts of its peak, and
 *                                p's
 *   errors deck-all REF FILE     in a table of ngspice's own points: time, then p, p', u, u' ...
 *                                phi' in mm, mrad and their rates, then lambda and lambda'
 *
 * A file that does not reach the end has an infinite error. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/text.h"
#include "engine/budget.h"
#include "race.h"

enum { ROWS = 20001, ALL = 5 }; /* at most; p, u, w, phi, i */
static const double SAMPLE_S = 1e-4;
static double reference[ROWS], got[ROWS];
static double whole_reference[ROWS][ALL], whole_got[ROWS][ALL];

static FILE *opened(const char *path, const char *how) {
  FILE *f = fopen(path, how);
  if (!f) race_give_up(path);
  return f;
}

/* sets: NULL-ended. */
static void write_reference(const char *tier, const char *path, char **sets) {
  vs_scene *scene = race_scene(tier, (const char *const *)sets);
  oracle_scene o =
      oracle_of(&scene->setup, strcmp(tier, "circuit") ? ORACLE_SWITCHED : ORACLE_SNUBBED);
  if (o.rows > ROWS || o.sample_s != SAMPLE_S) race_give_up("not rows of 0.1 ms, 2 s at most");
  double *table = vs_alloc(o.rows * ORACLE_COLUMNS, sizeof *table);
  if (!oracle_run(&o, table, NULL)) race_give_up("no reference");
  for (size_t k = 0; k < o.rows; k++) got[k] = table[k * ORACLE_COLUMNS + ORACLE_P];
  FILE *f = opened(path, "wb");
  bool good = fwrite(got, sizeof *got, o.rows, f) == o.rows;
  if (fclose(f) || !good) race_give_up(path);
  free(table);
  vs_scene_free(scene);
  free(scene);
}

/* ---- all five ---- */

/* The reference's file begins with what a deck's table does not tell: the gap at rest, m, and 2a.
 */
static double gap_m, twice_a;

static void keep_whole_reference(const char *path, const double head[2], size_t rows) {
  FILE *f = opened(path, "wb");
  bool good = fwrite(head, 2 * sizeof *head, 1, f) == 1 &&
              fwrite(whole_got, sizeof *whole_got, rows, f) == rows;
  if (fclose(f) || !good) race_give_up(path);
}

static void take_head(const vs_scene *scene, double head[2]) {
  const vs_coil *coil = &scene->setup.model.coil;
  head[0] = coil->gap_rest_m;
  head[1] = 2 * coil->a_hm;
}

static void write_whole_reference(const char *path, char **sets) {
  vs_scene *scene = race_scene("circuit", (const char *const *)sets);
  oracle_scene o = oracle_of(&scene->setup, ORACLE_SNUBBED);
  double head[2];
  take_head(scene, head);
  if (o.rows > ROWS || o.sample_s != SAMPLE_S) race_give_up("not rows of 0.1 ms, 2 s at most");
  double *table = vs_alloc(o.rows * ORACLE_COLUMNS, sizeof *table);
  if (!oracle_run(&o, table, NULL)) race_give_up("no reference");
  for (size_t k = 0; k < o.rows; k++) {
    memcpy(whole_got[k], table + k * ORACLE_COLUMNS + ORACLE_P, 4 * sizeof(double));
    whole_got[k][ALL - 1] = table[k * ORACLE_COLUMNS + ORACLE_I];
  }
  keep_whole_reference(path, head, o.rows);
  free(table);
  vs_scene_free(scene);
  free(scene);
}

/* A run that recorded p, u, w, phi and i alone, in this order. */
static size_t read_whole_csv(FILE *f) {
  char line[4096];
  size_t n = 0;
  if (!fgets(line, sizeof line, f) || strcmp(line, "t_s,p_m,u_m,w_m,phi_rad,i_a\n"))
    race_give_up("not t_s,p_m,u_m,w_m,phi_rad,i_a");
  for (double *x = whole_got[0];
       n < ROWS && fscanf(f, "%*[^,],%lf,%lf,%lf,%lf,%lf", x, x + 1, x + 2, x + 3, x + 4) == ALL;
       x += ALL)
    n++;
  return n;
}

static void take_as_reference(const char *path, const char *run) {
  const char *const none[] = {NULL};
  vs_scene *scene = race_scene("circuit", none);
  double head[2];
  take_head(scene, head);
  vs_scene_free(scene);
  free(scene);
  FILE *f = opened(run, "rb");
  size_t rows = read_whole_csv(f);
  fclose(f);
  keep_whole_reference(path, head, rows);
}

/* A point of ngspice's: the time, then five values, each with its rate. */
enum { POINT = 1 + 2 * ALL };

/* Along the cubics through values and rates of two points. */
static void between(const double a[POINT], const double b[POINT], double t_s, double x[ALL]) {
  double h = b[0] - a[0], s = (t_s - a[0]) / h, r = 1 - s;
  for (int k = 0; k < ALL; k++) {
    const double *from = a + 1 + 2 * k, *to = b + 1 + 2 * k;
    x[k] = (1 + 2 * s) * r * r * from[0] + s * r * r * h * from[1] + s * s * (3 - 2 * s) * to[0] -
           s * s * r * h * to[1];
    if (k < ALL - 1) x[k] *= 1e-3;
  }
  x[ALL - 1] *= (gap_m + x[0]) / twice_a; /* i = lambda z/(2a) */
}

static size_t read_whole_deck(FILE *f) {
  double point[2][POINT] = {{0}};
  size_t n = 0;
  for (int now = 0;; now = 1 - now) {
    for (int k = 0; k < POINT; k++)
      if (fscanf(f, "%lf", &point[now][k]) != 1) return n;
    for (; n < ROWS && point[now][0] > point[1 - now][0] &&
           (double)n * SAMPLE_S <= point[now][0] + 1e-12;
         n++)
      between(point[1 - now], point[now], (double)n * SAMPLE_S, whole_got[n]);
  }
}

/* The worst of all, and that of p. */
static void print_whole_error(const char *ref, const char *path, size_t (*reader)(FILE *)) {
  FILE *f = opened(ref, "rb"), *g = opened(path, "rb");
  double head[2], worst = 0, of_p = 0;
  if (fread(head, sizeof head, 1, f) != 1) race_give_up(ref);
  gap_m = head[0], twice_a = head[1];
  size_t rows = fread(whole_reference, sizeof *whole_reference, ROWS, f), found = reader(g);
  for (int c = 0; c < ALL; c++) {
    double error = found >= rows ? 0 : INFINITY, peak = 0;
    for (size_t k = 0; k < rows; k++) {
      double off = fabs(whole_got[k][c] - whole_reference[k][c]);
      error = isnan(off) ? INFINITY : fmax(error, off);
      peak = fmax(peak, fabs(whole_reference[k][c]));
    }
    worst = fmax(worst, error / peak);
    if (c == 0) of_p = error / peak;
  }
  fclose(f);
  fclose(g);
  printf("%.3e %.3e\n", worst, of_p);
}

/* ---- p alone ---- */

/* Each gives how many rows it found. */
static size_t read_csv(FILE *f) {
  char line[4096];
  size_t n = 0;
  if (!fgets(line, sizeof line, f) || strncmp(line, "t_s,p_m", 7)) race_give_up("not t_s,p_m");
  while (n < ROWS && fscanf(f, "%*[^,],%lf%*[^\n]", &got[n]) == 1) n++;
  return n;
}

static size_t read_bin(FILE *f) {
  double row[5];
  size_t n = 0;
  while (n < ROWS && fread(row, sizeof row, 1, f) == 1) got[n++] = row[0];
  return n;
}

/* Along the cubic through value and slope at the points around each sample. */
static size_t read_deck(FILE *f) {
  double t0 = 0, p0 = 0, v0 = 0, t, p, v;
  size_t n = 0;
  while (fscanf(f, "%lf %lf %lf", &t, &p, &v) == 3) {
    double h = t - t0;
    for (; h > 0 && n < ROWS && (double)n * SAMPLE_S <= t + 1e-12; n++) {
      double s = ((double)n * SAMPLE_S - t0) / h, r = 1 - s;
      got[n] = 1e-3 * ((1 + 2 * s) * r * r * p0 + s * r * r * h * v0 + s * s * (3 - 2 * s) * p -
                       s * s * r * h * v);
    }
    t0 = t, p0 = p, v0 = v;
  }
  return n;
}

static void print_error(const char *ref, const char *path, size_t (*reader)(FILE *)) {
  FILE *f = opened(ref, "rb"), *g = opened(path, "rb");
  size_t rows = fread(reference, sizeof *reference, ROWS, f);
  if (!rows) race_give_up(ref);
  double worst = reader(g) >= rows ? 0 : INFINITY, peak = 0;
  for (size_t k = 0; k < rows; k++) {
    double error = fabs(got[k] - reference[k]);
    worst = isnan(error) ? INFINITY : fmax(worst, error);
    peak = fmax(peak, fabs(reference[k]));
  }
  fclose(f);
  fclose(g);
  printf("%.3e\n", worst / peak);
}

static double run_child(char *const *arguments) {
  double began = vs_budget_clock_s();
  pid_t pid = fork();
  if (pid < 0) race_give_up("no process for the child");
  if (pid == 0) {
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(127);
    execvp(arguments[0], arguments);
    _exit(127);
  }
  int status;
  if (waitpid(pid, &status, 0) != pid || !WIFEXITED(status)) race_give_up("a child failed");
  if (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != VS_RATING) race_give_up("a child failed");
  return vs_budget_clock_s() - began;
}

static void print_seconds(int times, char *const *arguments) {
  double *spent = vs_alloc((size_t)times, sizeof *spent);
  for (int k = 0; k < times; k++) spent[k] = run_child(arguments);
  gsl_sort(spent, 1, (size_t)times);
  printf("%.6f,%.6f\n", spent[0], gsl_stats_median_from_sorted_data(spent, 1, (size_t)times));
  free(spent);
}

int main(int argc, char **argv) {
  gsl_set_error_handler_off();
  if (argc >= 4 && !strcmp(argv[1], "reference"))
    write_reference(argv[2], argv[3], argv + 4);
  else if (argc == 4 && !strcmp(argv[1], "csv"))
    print_error(argv[2], argv[3], read_csv);
  else if (argc == 4 && !strcmp(argv[1], "bin"))
    print_error(argv[2], argv[3], read_bin);
  else if (argc == 4 && !strcmp(argv[1], "deck"))
    print_error(argv[2], argv[3], read_deck);
  else if (argc >= 3 && !strcmp(argv[1], "reference-all"))
    write_whole_reference(argv[2], argv + 3);
  else if (argc == 4 && !strcmp(argv[1], "csv-as-reference"))
    take_as_reference(argv[2], argv[3]);
  else if (argc == 4 && !strcmp(argv[1], "csv-all"))
    print_whole_error(argv[2], argv[3], read_whole_csv);
  else if (argc == 4 && !strcmp(argv[1], "deck-all"))
    print_whole_error(argv[2], argv[3], read_whole_deck);
  else if (argc > 3 && !strcmp(argv[1], "seconds") && atoi(argv[2]) > 0)
    print_seconds(atoi(argv[2]), argv + 3);
  else {
    fputs("usage: errors reference TIER FILE [KEY=VALUE...] | reference-all FILE [KEY=VALUE...] | "
          "csv-as-reference FILE RUN | csv|bin|deck|csv-all|deck-all REF FILE | seconds N "
          "COMMAND...\n",
          stderr);
    return 2;
  }
  return 0;
}
