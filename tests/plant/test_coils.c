/* SPDX-License-Identifier: GPL-3.0-or-later
 * Laws of the actuator besides the plain reluctance, and stops: each against its equations, its own
 * derivatives, and the published solenoid. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plant/actuator.h"
#include "plant/coenergy.h"
#include "suite.h"

/* ---- an actuator from the text of a scene ---- */

typedef struct built {
  vs_actuator_values values;
  vs_coil coil;
  vs_stops stops;
  vs_error err;
  vs_status status;
} built;

static built build(const char *scene) {
  built b = {0};
  vs_tree tree;
  write_file("s.yaml", scene);
  b.status = vs_tree_read("s.yaml", &tree, &b.err);
  const vs_node *map = vs_tree_child(tree.root, "actuator");
  if (!b.status) b.status = vs_field_section_read(&vs_actuator_section, map, &b.values, &b.err);
  if (!b.status) b.status = vs_actuator_build(&b.values, map, NULL, &b.coil, &b.stops, &b.err);
  vs_tree_free(&tree);
  return b;
}

static built good(const char *scene) {
  built b = build(scene);
  EXPECT(!b.status, "%s: %s", scene, b.err.text);
  return b;
}

static void refused(const char *scene, const char *says) {
  built b = build(scene);
  EXPECT(b.status == VS_INPUT && !strcmp(b.err.text, says), "%s\n  says %s\n  not  %s", scene,
         b.err.text, says);
  vs_actuator_end(&b.coil);
}

/* ---- what holds for every law ---- */

/* A path through the law's range: lambda and z with their first two derivatives at t. */
static void path_at(double t, double flux_wb, double z_m, double flux[3], double z[3]) {
  const double w = 300, v = 410;
  flux[0] = flux_wb * (1 + 0.2 * sin(w * t));
  flux[1] = flux_wb * 0.2 * w * cos(w * t);
  flux[2] = -flux_wb * 0.2 * w * w * sin(w * t);
  z[0] = z_m * (1 + 0.1 * cos(v * t));
  z[1] = -z_m * 0.1 * v * sin(v * t);
  z[2] = -z_m * 0.1 * v * v * cos(v * t);
}

/* i = dW/dlambda, F = dW/dz and the rates along a path, by central differences of five points,
 * which leave some 1e-8 of each quantity's size here. */
static double slope(const double at[4], double h) {
  return (8 * (at[2] - at[1]) - (at[3] - at[0])) / (12 * h);
}
static const double STEP[4] = {-2, -1, 1, 2};

static void check_energy(const vs_coil *c, double flux, double z, double force_n, int line) {
  double by_flux[4], by_z[4], dl = 3e-4 * flux, dz = 3e-4 * z;
  for (int k = 0; k < 4; k++) {
    by_flux[k] = c->law->energy(c, flux + STEP[k] * dl, z);
    by_z[k] = c->law->energy(c, flux, z + STEP[k] * dz);
  }
  double i = c->law->current(c, flux, z);
  vs_close(slope(by_flux, dl), i, i, 1e-7, "dW/dlambda", line);
  vs_close(slope(by_z, dz), force_n, force_n, 1e-7, "dW/dz", line);
}

static void check_rates(const vs_coil *c, double flux_wb, double z_m, double t, int line) {
  double flux[3], z[3], i[3], f[3], i_at[2][4], f_at[2][4], h = 1e-6;
  path_at(t, flux_wb, z_m, flux, z);
  c->law->along(c, flux, z, i, f);
  vs_close(i[0], c->law->current(c, flux[0], z[0]), i[0], 1e-14, "i", line);
  vs_close(f[0], c->law->force(c, flux[0], z[0]), f[0], 1e-14, "F", line);
  for (int k = 0; k < 4; k++) {
    double x[3], y[3], i_there[3], f_there[3];
    path_at(t + STEP[k] * h, flux_wb, z_m, x, y);
    c->law->along(c, x, y, i_there, f_there);
    for (int n = 0; n < 2; n++) {
      i_at[n][k] = i_there[n];
      f_at[n][k] = f_there[n];
    }
  }
  vs_close(slope(i_at[0], h), i[1], fabs(i[0]) * 300, 1e-7, "i'", line);
  vs_close(slope(f_at[0], h), f[1], fabs(f[0]) * 300, 1e-7, "F'", line);
  vs_close(slope(i_at[1], h), i[2], fabs(i[0]) * 9e4, 1e-7, "i\"", line);
  vs_close(slope(f_at[1], h), f[2], fabs(f[0]) * 9e4, 1e-7, "F\"", line);
}

/* ---- moving coil ---- */

static void moving_coil(void) {
  built b = good("actuator: {law: moving_coil, inductance: 764 uH, resistance: 1.6 ohm, gap: 5 mm, "
                 "pole_cover: 0, emf_constant: 3.744 V.s/m}");
  const vs_coil *c = &b.coil;
  const double k = 3.744, g = 1.2e-3, i = 2.5, flux = 764e-6 * i + k * g, z = 5e-3 + g;
  CLOSE(vs_coil_current(c, flux, z), i, 1e-14);
  CLOSE(vs_coil_force(c, flux, z), -k * i, 1e-14);
  CLOSE(vs_coil_energy(c, flux, z), 764e-6 * i * i / 2, 1e-14);
  CU_ASSERT_EQUAL(vs_coil_current(c, 0, 5e-3), 0);
  CU_ASSERT_EQUAL(c->rest_h, 764e-6);
  CU_ASSERT_FALSE(c->law->poles);
  CU_ASSERT_EQUAL(c->law->transducer_w(c, flux, z, 2), 0);
  check_energy(c, flux, z, -k * i, __LINE__);
  check_rates(c, flux, z, 0.001, __LINE__);
  vs_actuator_end(&b.coil);
}

/* The shaker's two constants differ: what the circuit gives to the motion is not what the armature
 * gets. */
static void transducer(void) {
  built b = good("actuator: {law: moving_coil, inductance: 764 uH, gap: 5 mm, pole_cover: 0,\n"
                 "  emf_constant: 3.744 V.s/m, force_constant: 3.7437 N/A}");
  const double flux = 764e-6 * 2 + 3.744 * 1e-3;
  CLOSE(vs_coil_force(&b.coil, flux, 6e-3), -3.7437 * 2, 1e-14);
  CLOSE(b.coil.law->transducer_w(&b.coil, flux, 6e-3, 0.5), (3.744 - 3.7437) * 2 * 0.5, 1e-9);
  vs_actuator_end(&b.coil);
}

/* ---- the published solenoid ---- */

/* Modelica Standard Library, Magnetic.FluxTubes.Examples.SolenoidActuator, SimpleSolenoid: N i =
 * Phi (1/G(z) + 1/G_p) + sum over the iron. */
static const double TURNS = 957, MU0 = 4e-7 * M_PI * 1.00000000055, LEAK_H = 3.0319757963e-7;
static const double R_M = 5e-3, W_M = 2 * M_PI * 6.5e-3, RHO_M = 3e-3;

static double permeance(double z) {
  return MU0 * (M_PI * R_M * R_M / z + W_M / M_PI * log(1 + M_PI * RHO_M / z));
}
static double permeance_slope(double z) {
  double x = M_PI * RHO_M / z;
  return -MU0 * (M_PI * R_M * R_M / (z * z) + W_M / M_PI * x / z / (1 + x));
}
static double solenoid_current(double flux, double z) {
  const double pole = M_PI * R_M * R_M;
  const double iron[][2] = {{1.343030859410e-4, 4.263590029872e-3},
                            {pole, 3.510159389486e-3},
                            {pole, 1.208304866765e-2},
                            {2.105652476069e-4, 2.524717179043e-2},
                            {2.034181243199e-4, 2.214055808678e-2}};
  double phi = flux / TURNS, sum = phi * (1 / permeance(z) + 1 / LEAK_H);
  for (size_t k = 0; k < COUNT(iron); k++) {
    double b = fabs(phi) / iron[k][0] / 1.488;
    double mu = 1 + (400 - 1 + 1200 * b) / (1 + 3 * b + pow(b, 12.5));
    sum += phi / (MU0 * mu * iron[k][1]);
  }
  return sum / TURNS;
}
static double solenoid_force(double flux, double z) {
  double b = flux / TURNS / permeance(z);
  return -b * b * permeance_slope(z) / 2;
}
static double solenoid_flux(double current, double z) {
  double low = 0, high = 1;
  for (int k = 0; k < 60; k++) {
    double middle = (low + high) / 2;
    if (solenoid_current(middle, z) < current)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

/* The table as machines of this kind come: z 0.25..5 mm by 0.25, i 0..1.5 A by 0.05, 12 digits. */
static void write_table(const char *file, const char *head) {
  vs_text t = {0};
  vs_text_add(&t, "%s\n", head);
  for (int k = 1; k <= 20; k++)
    for (int n = 0; n <= 30; n++) {
      double z = k * 0.25e-3, i = n * 0.05, flux = n ? solenoid_flux(i, z) : 0;
      vs_text_add(&t, "%.12g,%.12g,%.12g,%.12g\n", z, i, flux, solenoid_force(flux, z));
    }
  write_file(file, t.text);
  vs_text_free(&t);
}

static built tabled(void) {
  write_table("solenoid.csv", "z_m,i_a,lambda_wb,force_n");
  return good("actuator: {law: solenoid.csv, gap: 4.75 mm, pole_cover: 0.25 mm, resistance: 10 "
              "ohm}");
}

/* The formulas of this test are those of the reference: its static values. */
static void solenoid_of_the_test(void) {
  static const double ROWS[][3] = {{0.25e-3, 0.133083219405, 76.894487208},
                                   {1e-3, 0.091737072159, 27.7787508419},
                                   {5e-3, 0.034717862614, 2.91620922713}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double flux = solenoid_flux(1.2, ROWS[k][0]);
    CLOSE(flux, ROWS[k][1], 1e-10);
    CLOSE(solenoid_force(flux, ROWS[k][0]), ROWS[k][2], 1e-10);
  }
}

/* On the grid lambda is the table's. Off it the error is that of splines with a step of 0.25 mm,
 * which is the whole of the smallest gap: reached are 4.1e-4 and 1.5e-4 (lambda, F) at 0.33 mm,
 * 5.9e-5 and 2.0e-4 at 0.61 mm. */
static void table_off_its_grid(void) {
  built b = tabled();
  const vs_coil *c = &b.coil;
  static const struct {
    double z, i, flux, force;
  } ROWS[] = {{0.00033, 0.72, 0.08797816227, 32.1006993168},
              {0.00061, 0.415, 0.0400858219696, 5.91416664057}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double low = 0, high = 1;
    for (int n = 0; n < 60; n++) { /* the flux linkage at this current */
      double middle = (low + high) / 2;
      if (vs_coil_current(c, middle, ROWS[k].z) < ROWS[k].i)
        low = middle;
      else
        high = middle;
    }
    CLOSE(low, ROWS[k].flux, 5e-4);
    CLOSE(vs_coil_force(c, low, ROWS[k].z), ROWS[k].force, 2.5e-4);
  }
  double flux = solenoid_flux(0.85, 2e-3);
  CLOSE(vs_coil_current(c, flux, 2e-3), 0.85, 1e-10); /* a point of the table, of 12 digits */
  CLOSE(vs_coil_current(c, -flux, 2e-3), -0.85, 1e-10);
  CLOSE(vs_coil_force(c, -flux, 2e-3), vs_coil_force(c, flux, 2e-3), 1e-15);
  CU_ASSERT_EQUAL(vs_coil_current(c, 0, 2e-3), 0);
  CLOSE(c->rest_h, solenoid_flux(1e-4, 5e-3) / 1e-4, 1e-4);
  vs_actuator_end(&b.coil);
}

/* Current and force are slopes of the one energy, in the first interval, between and beyond the
 * last current, and so are their rates. */
static void table_agrees_with_itself(void) {
  built b = tabled();
  static const double Z[] = {0.29e-3, 0.4e-3, 1.13e-3, 3.6e-3, 4.4e-3},
                      I[] = {0.013, 0.33, 0.812, 1.31, 1.7};
  for (size_t k = 0; k < COUNT(Z); k++)
    for (size_t n = 0; n < COUNT(I); n++) {
      double flux = solenoid_flux(I[n], Z[k]);
      check_energy(&b.coil, flux, Z[k], vs_coil_force(&b.coil, flux, Z[k]), __LINE__);
    }
  /* the third derivatives jump at the knots, so these paths do not meet one within a difference */
  for (size_t k = 0; k < COUNT(Z); k++) {
    check_rates(&b.coil, solenoid_flux(0.812, Z[k]), Z[k], 0.0007, __LINE__);
    check_rates(&b.coil, -solenoid_flux(0.33, Z[k]), Z[k], 0.0023, __LINE__);
  }
  vs_actuator_end(&b.coil);
}

/* Pull-in on 12 V, from the table: contact at 0.25 mm, where the table ends. 0.5 % is asked for;
 * reached are 1e-6 of the contact's time and i_max, 7e-5 of its speed and 4e-5 of the current then.
 */
static int pull_in(double t, const double y[3], double rate[3], void *ctx) {
  const vs_coil *c = ctx;
  (void)t;
  rate[0] = y[1];
  rate[1] = -vs_coil_force(c, y[2], y[0]) / 0.0260361026206;
  rate[2] = 12 - 10 * vs_coil_current(c, y[2], y[0]);
  return GSL_SUCCESS;
}

static void table_pulls_in(void) {
  built b = tabled();
  gsl_odeiv2_system system = {pull_in, NULL, 3, &b.coil};
  gsl_odeiv2_driver *d =
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-6, 1e-10, 1e-10);
  double t = 0, y[3] = {5e-3, 0, 0}, most_a = 0, before[3], h = 1e-6;
  while (y[0] > 0.25e-3 && t < 0.05) {
    memcpy(before, y, sizeof y);
    CU_ASSERT_EQUAL_FATAL(gsl_odeiv2_driver_apply(d, &t, t + h, y), GSL_SUCCESS);
    most_a = fmax(most_a, vs_coil_current(&b.coil, y[2], y[0]));
  }
  gsl_odeiv2_driver_free(d);
  double contact_s = t - h * (0.25e-3 - y[0]) / (before[0] - y[0]);
  CLOSE(most_a, 1.0073962738, 2e-6);
  CLOSE(contact_s, 0.012281796804, 2e-6);
  CLOSE(y[1], -1.322846269, 1e-4);
  CLOSE(vs_coil_current(&b.coil, y[2], 0.25e-3), 0.3852808708, 1e-4);
  vs_actuator_end(&b.coil);
}

static void table_tells_its_range(void) {
  built b = tabled();
  char text[256];
  const vs_coil *c = &b.coil;
  CU_ASSERT_PTR_NULL(c->law->beyond(c, solenoid_flux(1.49, 5e-3), 5e-3, text, sizeof text));
  CU_ASSERT_PTR_NULL(c->law->beyond(c, 0, 0.25e-3, text, sizeof text));
  CU_ASSERT_STRING_EQUAL(
      c->law->beyond(c, 0, 0.2e-3, text, sizeof text),
      "the gap, 0.2 mm, is outside the table solenoid.csv, which has 0.25..5 mm");
  CU_ASSERT_PTR_NOT_NULL_FATAL(
      c->law->beyond(c, -solenoid_flux(1.6, 1e-3), 1e-3, text, sizeof text));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "outside the table solenoid.csv, which has up to 1.5 A"));
  CU_ASSERT_PTR_NOT_NULL_FATAL(c->law->note(c, text, sizeof text));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "at most 1.67 N (1.9 % of its largest), at z = 0.25 mm, i "));
  CU_ASSERT_PTR_NULL(c->law->netlist);
  vs_actuator_end(&b.coil);
}

/* A law that saturates at once, so that a plain spline would swing: lambda still rises. */
static void table_with_a_corner(void) {
  vs_text t = {0};
  vs_text_add(&t, "lambda_wb,i_ma,z_mm\n");
  for (int k = 1; k <= 5; k++)
    for (int n = 1; n <= 9; n++)
      vs_text_add(&t, "%.9g,%d,%d\n", (n < 4 ? n : 4 + 1e-3 * n) / (1.0 + k), 100 * n, k);
  write_file("corner.csv", t.text);
  vs_text_free(&t);
  built b = good("actuator: {law: corner.csv, gap: 3 mm}");
  double before = 0;
  char text[256];
  for (int n = 1; n < 600; n++) {
    double i = vs_coil_current(&b.coil, 1e-3 * n, 3.3e-3);
    EXPECT(i > before, "%g Wb: %.17g A after %.17g A", 1e-3 * n, i, before);
    before = i;
  }
  CU_ASSERT_STRING_EQUAL(b.coil.law->note(&b.coil, text, sizeof text),
                         "corner.csv: rows of i = 0 are missing, and lambda = 0 is taken");
  vs_actuator_end(&b.coil);
}

static void tables_that_are_none(void) {
  static const struct {
    const char *text, *says;
  } ROWS[] = {
      {"", "t.csv:1:1: the table is empty; its first line names its columns: "
           "z_m,i_a,lambda_wb,force_n"},
      {"z_m,i_a,lambda_wb,forze_n\n",
       "t.csv:1:19: column 'forze_n' is not known in a table of an actuator; there are: z_m, i_a, "
       "lambda_wb and force_n"},
      {"z_m,i_a,lambda_v\n",
       "t.csv:1:9: column 'lambda_v' is not known in a table of an actuator; there are: z_m, i_a, "
       "lambda_wb and force_n"},
      {"z_m,z_mm,i_a\n", "t.csv:1:5: column z_mm stands here a second time; leave one out"},
      {"z_m,i_a\n", "t.csv:1:1: there is no column lambda_wb; a table of an actuator has z_m, i_a, "
                    "lambda_wb and, if wanted, force_n"},
      {"z_m,i_a,lambda_wb\n1,2,x\n", "t.csv:2:5: 'x' is not a number; write one as 1.5e-3"},
      {"z_m,i_a,lambda_wb\n1,2\n",
       "t.csv:2:1: the row has 2 cells, and its column lambda_wb is the 3."},
      {"z_mm,i_a,lambda_wb\n-1,2,3\n", "t.csv:2:1: -1: a gap must be above 0"},
      {"z_mm,i_a,lambda_wb\n1,-2,3\n",
       "t.csv:2:3: -2: a current must not be below 0; the table is taken as symmetric, lambda as "
       "odd in i"},
      {"z_m,i_a,lambda_wb\n1,0,0\n1,1,1\n1,2,2\n1,3,3\n",
       "t.csv:1:1: the number of gaps is 1; a table has 4 to 1000"},
      {"z_m,i_a,lambda_wb\n1,0,0\n1,1,1\n2,0,0\n2,1,1\n3,0,0\n3,1,1\n4,0,0\n4,1,1\n",
       "t.csv:1:1: the number of currents, 0 included, is 2; a table has 4 to 1000"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("t.csv", ROWS[k].text);
    refused("actuator: {law: t.csv}", ROWS[k].says);
  }
  refused("actuator: {law: nix.csv}",
          "s.yaml:1:17: actuator.law: the table nix.csv cannot be read: No such file or directory");
  write_table("solenoid.csv", "z_m,i_a,lambda_wb,force_n");
  refused("actuator: {law: solenoid.csv}",
          "s.yaml:1:17: actuator.law: the gap at rest, gap + pole_cover = 6.5 mm, is not within "
          "those of the table, 0.25..5 mm");
}

/* One row of a grid of 4 gaps and 4 currents in another's place. */
static void grids_that_are_none(void) {
  static const struct {
    int row; /* from 0 */
    const char *text, *says;
  } ROWS[] = {
      {5, "",
       "t.csv:7:1: the table is no grid: at z = 0.002 m the currents are not those at z = "
       "0.001 m; give every gap the same ones"},
      {5, "0.002,1,0.5\n0.002,1,0.6\n",
       "t.csv:8:1: z = 0.002 m, i = 1 A stands in line 7 already; leave one out"},
      {15, "",
       "t.csv:16:1: the table is no grid: at z = 0.004 m currents are missing; give every "
       "gap the same ones"},
      {6, "0.002,2,0.4\n",
       "t.csv:8:1: lambda does not rise with i at z = 0.002 m: 0.5 Wb at 1 A and 0.4 Wb at 2 A"},
      {4, "0.002,0,0.1\n",
       "t.csv:6:1: lambda is 0.1 Wb without current; it must be 0 there, as "
       "the table is taken as symmetric"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text t = {0};
    vs_text_add(&t, "z_m,i_a,lambda_wb\n");
    for (int n = 0; n < 16; n++)
      if (n == ROWS[k].row)
        vs_text_add(&t, "%s", ROWS[k].text);
      else
        vs_text_add(&t, "%g,%d,%g\n", 1e-3 * (n / 4 + 1), n % 4, (double)(n % 4) / (n / 4 + 1));
    write_file("t.csv", t.text);
    vs_text_free(&t);
    refused("actuator: {law: t.csv}", ROWS[k].says);
  }
}

/* ---- stops ---- */

static void keys_of_stops(void) {
  built b = good("actuator: {gap: 6 mm, stop: {}}");
  const vs_stop *s = b.stops.item;
  CU_ASSERT_EQUAL(b.stops.count, 1);
  CU_ASSERT_EQUAL(s->at_m, -b.values.gap_m); /* to the bit */
  CU_ASSERT_EQUAL(s->side, 1);
  CU_ASSERT_STRING_EQUAL(s->kind->name, "linear");
  b = good("actuator:\n  gap: 6 mm\n  stop:\n"
           "  - {at: 6.5 mm, stiffness: 1e5 N/m}\n"
           "  - {kind: quadratic_clipped, at: 0.25 mm, stiffness: 2e11 N/m2, damping: 400 N.s/m}\n"
           "  - {at: 8 mm}\n");
  s = b.stops.item;
  CU_ASSERT_EQUAL(b.stops.count, 3);
  CU_ASSERT_STRING_EQUAL(s[0].kind->name, "quadratic_clipped"); /* those that end the closing */
  CLOSE(s[0].at_m, 0.25e-3 - 6.5e-3, 1e-14);
  CU_ASSERT_EQUAL(s[1].side, -1);
  CU_ASSERT_EQUAL(s[1].at_m, 0);
  CU_ASSERT_EQUAL(s[1].stiffness, 1e5);
  CLOSE(s[2].at_m, 1.5e-3, 1e-12);
  CU_ASSERT_EQUAL(s[2].stiffness, 1e7);
  const vs_stops back = {{s[1]}, 1};
  CU_ASSERT_EQUAL(vs_stops_nearness(&back, 0), 1);
  CLOSE(vs_stops_nearness(&back, -3.25e-3), 0.5, 1e-12);
  CU_ASSERT(vs_stops_nearness(&back, 1e-6) > 1);
  CU_ASSERT_EQUAL(vs_stops_touched(&back, 1e-6), 1);
  refused("actuator: {stop: {stiffness: 1e11 N/m, kind: quadratic_clipped}}",
          "s.yaml:1:30: actuator.stop.stiffness: '1e11 N/m' has the wrong unit; write N/m2");
  refused("actuator: {stop: [{}, 3]}",
          "s.yaml:1:23: actuator.stop: each of the list is a map of keys: {stiffness: 1e7 N/m, "
          "...}");
  refused("actuator: {stop: [{}, {}, {}, {}, {at: 8 mm}]}",
          "s.yaml:1:36: actuator.stop: a list of at most 4 is allowed");
  refused("actuator: {stop: {kind: soft}}",
          "s.yaml:1:25: actuator.stop.kind: 'soft' is not one of: linear|quadratic_clipped");
}

/* A study sets one key of one stop, by its number in the list where there are several. */
static void a_key_of_one_stop(void) {
  vs_tree tree;
  vs_error err = {0};
  write_file("s.yaml", "actuator: {stop: [{at: 1 mm}, {at: 8 mm, damping: 1 N.s/m}]}");
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("s.yaml", &tree, &err), VS_OK);
  CU_ASSERT_EQUAL(vs_tree_set(&tree, "actuator.stop.2.damping=5 N.s/m", &err), VS_OK);
  const vs_node *map = vs_tree_child(tree.root, "actuator");
  vs_actuator_values v = {0};
  CU_ASSERT_EQUAL(vs_field_section_read(&vs_actuator_section, map, &v, &err), VS_OK);
  CU_ASSERT_EQUAL(v.stop[0].damping_ns_m, 300);
  CU_ASSERT_EQUAL(v.stop[1].damping_ns_m, 5);
  CU_ASSERT_EQUAL(v.stop[1].at_m, 8e-3);
  vs_text json = {0};
  vs_field_json(&vs_actuator_section.fields[4], &v, &json);
  CU_ASSERT_STRING_EQUAL(
      json.text,
      "[{\"stiffness\": {\"value\": 10000000, \"unit\": \"N/m\"}, \"damping\": "
      "{\"value\": 300, \"unit\": \"N.s/m\"}, \"kind\": \"linear\", \"at\": {\"value\": 1, "
      "\"unit\": \"mm\"}}, {\"stiffness\": {\"value\": 10000000, \"unit\": \"N/m\"}, "
      "\"damping\": {\"value\": 5, \"unit\": \"N.s/m\"}, \"kind\": \"linear\", \"at\": "
      "{\"value\": 8, \"unit\": \"mm\"}}]");
  vs_text_free(&json);
  vs_tree_free(&tree);
}

/* On a path in and out of a stop: the rate by differences, and what it takes in is what it stores
 * and loses. The clipped stop neither pulls nor more than doubles. */
static void check_stop(const char *scene, double speed, int line) {
  built b = good(scene);
  enum { STEPS = 200000 };
  const double w = 2000, depth = speed / w, h = M_PI / w / STEPS;
  const vs_stop *s = b.stops.item;
  double work = 0, lost = 0, most = 0, g0 = s->at_m;
  for (int k = 0; k < STEPS; k++) {
    double t = (k + 0.5) * h, g = g0 - s->side * depth * sin(w * t),
           g1 = -s->side * depth * w * cos(w * t), g2 = s->side * depth * w * w * sin(w * t);
    unsigned touched = vs_stops_touched(&b.stops, g);
    double force = vs_stops_force(&b.stops, touched, g, g1), e = 1e-4 * h;
    work += force * g1 * h; /* F closes the gap: its power on the armature is -F g' */
    lost += vs_stops_loss(&b.stops, touched, g, g1) * h;
    most = fmax(most, vs_stops_energy(&b.stops, touched, g));
    double push = -s->side * force, elastic = s->stiffness * pow(vs_stop_depth(s, g), 2);
    if (!s->kind->linear)
      EXPECT(push >= 0 && push <= 2 * elastic * (1 + 1e-12), "%g of %g", push, elastic);
    if (k % 1000 || fabs(fabs(s->damping_ns_m * g1) / elastic - 1) < 1e-6) continue;
    double after = vs_stops_force(&b.stops, touched, g + e * g1 + e * e * g2 / 2, g1 + e * g2),
           before = vs_stops_force(&b.stops, touched, g - e * g1 + e * e * g2 / 2, g1 - e * g2);
    vs_close((after - before) / (2 * e), vs_stops_force_rate(&b.stops, touched, g, g1, g2),
             w * s->kind->force(s, depth, 0), 1e-5, "rate", line);
  }
  /* whole passages: nothing stays stored; the rule of midpoints leaves some 1e-9 */
  vs_close(-work, -lost, most, 1e-7, "work", line);
  EXPECT(lost > 0, "%s: %g J lost", scene, lost);
}

static void stops_keep_books(void) {
  check_stop("actuator: {stop: {}}", 1, __LINE__);
  check_stop("actuator: {stop: {at: 9 mm}}", 1, __LINE__);
  check_stop("actuator: {stop: {kind: quadratic_clipped, damping: 400 N.s/m, at: 0.25 mm}}", 1.3,
             __LINE__);
  check_stop("actuator: {stop: {kind: quadratic_clipped, damping: 4 N.s/m, at: 7 mm}}", 0.7,
             __LINE__);
}

/* ---- laws by name ---- */

static void keys_of_laws(void) {
  refused("actuator: {law: reluctanse}",
          "s.yaml:1:17: actuator.law: no law 'reluctanse'; there are: reluctance, moving_coil, "
          "formula, FILE.csv; did you mean 'reluctance'?");
  refused("actuator: {emf_constant: 1 V.s/m}",
          "s.yaml:1:12: actuator.emf_constant: law reluctance has no use for it; leave it out, or "
          "choose a law that has");
  refused("actuator: {law: moving_coil, saturation: {}}",
          "s.yaml:1:30: actuator.saturation: law moving_coil has no use for it; leave it out, or "
          "choose a law that has");
  refused("actuator: {law: a.csv, inductance: 1 H}",
          "s.yaml:1:24: actuator.inductance: law FILE.csv has no use for it; leave it out, or "
          "choose a law that has");
  refused("actuator: {saturation: {law: multiplicative, current: 1 A}}",
          "s.yaml:1:46: actuator.saturation has no key 'current'; it has: law, flux, exponent");
  built b = good("actuator: {saturation: {law: series, flux: 1.2 Wb}}");
  CU_ASSERT_EQUAL(b.values.saturation.current_a, 0.2);
  CU_ASSERT_EQUAL(b.values.saturation.flux_wb, 1.2);
  CU_ASSERT(isnan(b.values.force_constant_n_a));
  vs_actuator_end(&b.coil);
}

/* Where a spline across the gaps bends, lambda may fall with i between two of them. */
static void a_line_is_the_surface(void) {
  enum { N_Z = 7, N_I = 5 };
  double z_m[N_Z], i_a[N_I], flux_wb[N_Z * N_I], at_z = 0, at_i = 0;
  for (size_t n = 0; n < N_I; n++) i_a[n] = 0.5 * (double)n;
  for (size_t k = 0; k < N_Z; k++) {
    z_m[k] = 1e-3 * (double)(k + 1);
    for (size_t n = 0; n < N_I; n++)
      flux_wb[k * N_I + n] = i_a[n] / (1 + 0.2 * i_a[n]) / (double)(k + 1);
  }
  vs_coenergy s = vs_coenergy_new(z_m, N_Z, i_a, N_I, flux_wb);
  for (double i = 0; i < 3; i += 0.25) {
    vs_coenergy_line line = vs_coenergy_line_new(&s, i);
    for (double z = 0.5e-3; z < 9e-3; z += 0.4e-3) {
      vs_coenergy_point whole = vs_coenergy_at(&s, i, z), own = vs_coenergy_line_at(&line, z);
      for (int a = 0; a < 4; a++)
        for (int b = 0; a + b < 4; b++)
          EXPECT(fabs(own.c[a][b] - whole.c[a][b]) <= 1e-9 * (fabs(whole.c[a][b]) + 1e-6),
                 "%g A, %g m: c[%d][%d] is %g and not %g", i, z, a, b, own.c[a][b], whole.c[a][b]);
    }
    vs_coenergy_line_free(&line);
  }
  CU_ASSERT(vs_coenergy_rises(&s, &at_z, &at_i));
  vs_coenergy_free(&s);
  /* at one gap the flux linkage rises late and steeply, and the spline swings beside it */
  static const double STEEP[N_I] = {0, 0.1, 0.2, 5, 10};
  for (size_t k = 0; k < N_Z * N_I; k++) flux_wb[k] = k / N_I == 3 ? STEEP[k % N_I] : i_a[k % N_I];
  s = vs_coenergy_new(z_m, N_Z, i_a, N_I, flux_wb);
  CU_ASSERT_FALSE_FATAL(vs_coenergy_rises(&s, &at_z, &at_i));
  bool earlier = false, there = false; /* at smaller gaps, or at smaller currents */
  for (size_t k = 0; k < 4 * (N_Z - 1); k++)
    for (size_t n = 0; n < 4 * (N_I - 1); n++) {
      double z = z_m[k / 4] + (double)(k % 4) / 4 * (z_m[k / 4 + 1] - z_m[k / 4]);
      double i = i_a[n / 4] + (double)(n % 4) / 4 * (i_a[n / 4 + 1] - i_a[n / 4]);
      if (vs_coenergy_at(&s, i, z).c[2][0] > 0) continue;
      if (z == at_z && i == at_i) there = true;
      earlier = earlier || z < at_z || (z == at_z && i < at_i);
    }
  CU_ASSERT(there && !earlier);
  vs_coenergy_free(&s);
}

static const vs_test TESTS[] = {
    {"a moving coil", moving_coil},
    {"constants that differ", transducer},
    {"the solenoid of the test", solenoid_of_the_test},
    {"a table off its grid", table_off_its_grid},
    {"a line of a surface is the surface", a_line_is_the_surface},
    {"a table agrees with itself", table_agrees_with_itself},
    {"a table pulls in", table_pulls_in},
    {"a table tells its range", table_tells_its_range},
    {"a table with a corner", table_with_a_corner},
    {"tables that are none", tables_that_are_none},
    {"grids that are none", grids_that_are_none},
    {"keys of stops", keys_of_stops},
    {"a key of one stop", a_key_of_one_stop},
    {"stops keep books", stops_keep_books},
    {"keys of laws", keys_of_laws},
};

VS_SUITE_MAIN("coils", TESTS)
