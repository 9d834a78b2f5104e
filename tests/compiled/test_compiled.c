/* SPDX-License-Identifier: GPL-3.0-or-later
 * The parts of tier compiled, each by what is known of it without the others: the sparse matrix,
 * the slopes of the equations, the method's order, the courses of sources. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compiled/compiled.h"
#include "compiled/elements.h"
#include "compiled/reduction.h"
#include "compiled/rodas.h"
#include "suite.h"

/* ---- numbers that are the same on every machine ---- */

static uint64_t state;
static double drawn(void) { /* -1..1; Knuth's MMIX */
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) / (double)(1ull << 52) - 1;
}

/* ---- the matrix ---- */

enum { ROWS = 40 };

/* About four entries a row, of sizes from 1e-6 to 1e6, as of farads and siemens in one circuit; the
 * diagonal is often 0, as that of a voltage source is. */
static void fill(vs_matrix *m, double *a, double *value) {
  vs_matrix_begin(m, ROWS);
  memset(a, 0, ROWS * ROWS * sizeof *a);
  for (int i = 0; i < ROWS; i++) {
    a[i * ROWS + (i + 1) % ROWS] = 1 + fabs(drawn());
    for (int k = 0; k < 3; k++)
      a[i * ROWS + (int)((drawn() + 1) / 2 * (ROWS - 1))] = drawn() * pow(10, 6 * drawn());
  }
  for (int k = 0; k < ROWS * ROWS; k++)
    if (a[k] != 0) vs_matrix_place(m, k / ROWS, k % ROWS);
  for (int k = 0; k < ROWS * ROWS; k++)
    if (m->place[k] >= 0) value[m->place[k]] = a[k];
}

/* The residual of each row is rounding beside the row's own largest term: 1e-10, as a pivot may be
 * a thousandth of its column. */
static void a_sparse_system_is_solved(void) {
  static double a[ROWS * ROWS], value[ROWS * ROWS];
  double b[ROWS], used[ROWS], x[ROWS];
  int culprit;
  for (state = 1; state < 20; state += 3) {
    vs_matrix m;
    fill(&m, a, value);
    for (int k = 0; k < ROWS; k++) b[k] = used[k] = drawn();
    CU_ASSERT_TRUE_FATAL(vs_matrix_order(&m, value, &culprit));
    CU_ASSERT_TRUE(vs_matrix_factor(&m, value));
    vs_matrix_solve(&m, value, used, x);
    for (int i = 0; i < ROWS; i++) {
      double left = b[i], most = fabs(b[i]);
      for (int j = 0; j < ROWS; j++) {
        left -= a[i * ROWS + j] * x[j];
        most = fmax(most, fabs(a[i * ROWS + j] * x[j]));
      }
      EXPECT(fabs(left) <= 1e-10 * most, "row %d leaves %g of %g", i, left, most);
    }
    vs_matrix_free(&m);
  }
}

static void a_singular_one_names_a_column(void) {
  static double a[ROWS * ROWS], value[ROWS * ROWS];
  vs_matrix m;
  int culprit = -1;
  state = 5;
  fill(&m, a, value);
  for (int i = 0; i < ROWS; i++)
    if (m.place[i * ROWS + 7] >= 0) value[m.place[i * ROWS + 7]] = 0;
  CU_ASSERT_FALSE(vs_matrix_order(&m, value, &culprit));
  CU_ASSERT_EQUAL(culprit, 7);
  vs_matrix_free(&m);
}

/* ---- netlists without a host ---- */

static void nothing(void *ctx, double t_s, double *value) {
  (void)ctx, (void)t_s, (void)value;
}

enum { LINES = 64 };

static vs_status make(const char *netlist, const char *dialect, vs_equations *e, vs_error *err) {
  char *text = vs_copy(netlist), *rest = text, *lines[LINES + 1];
  vs_circuit_job job = {.netlist = lines, .dialect = dialect, .relative_tolerance = 1e-4};
  static const vs_circuit_host HOST = {0};
  while ((lines[job.lines] = strsep(&rest, "\n")) && job.lines < LINES) job.lines++;
  vs_status status = vs_elements_make(&job, &HOST, e, err);
  free(text);
  return status;
}

/* ---- slopes ---- */

/* df/dy of everything that is nonlinear against differences of second order. Their error is h^2 by
 * the third derivative, and rounding over h: together below 1e-6 of the largest slope of the row
 * for these, whose numbers are about 1. Kinks are kept away from by what stands in them. */
static const char SLOPES[] =
    "* slopes\n"
    "V1 a 0 1\nV2 b 0 2\nV3 c 0 0.5\nVs d e 0\nRs e 0 2\nR1 d a 1\n"
    ".param gain=3\n.func f(x,y) {x*y+gain}\n"
    "B1 a 0 i=v(a)*v(b)/(2+v(c))+i(Vs)^2\n"
    "B2 b 0 i=exp(0.3*v(a))*sin(v(b))+cos(v(a,c))+tan(0.2*v(c))\n"
    "B3 c 0 i=sqrt(4+v(a))+ln(5+v(b))+log10(5+v(c))+atan(v(a))\n"
    "B4 d 0 i=tanh(v(a))+sinh(0.3*v(b))+cosh(0.2*v(c))+asinh(v(a))+atanh(0.1*v(b))\n"
    "B5 a 0 i=abs(v(a)-9)+pow(v(a)+4,2.5)+pwr(v(b)-7,3)+min(v(a),v(b)+9)+max(v(c),-9)\n"
    "B6 b 0 i=f(v(a),v(c))+(v(a)>-9 ? v(b)*v(b) : 7)+u(v(a)-9)*v(b)+sgn(v(b)-9)*v(c)\n"
    "B7 q 0 v=pwl(v(a),-9,0,-5,3,9,6)+uramp(v(b)+9)\nR7 q 0 1\n"
    "B8 c 0 i=acos(0.1*v(a))+asin(0.1*v(b))+acosh(9+v(c))+if(v(a)<-9,1,v(c))+sqr(v(b)) m=2\n"
    "D1 a b dd\n.model dd d(is=1e-3 n=20 rs=0.1 tt=1m bv=30 ibv=1m)\n"
    "Q1 a b c qq\n.model qq npn(is=1e-9 bf=50 br=2 vaf=40)\n"
    "Q2 c a b qp\n.model qp pnp(is=1e-9 bf=50)\n"
    "M1 a b c mm\n.model mm vdmos(vto=0.2 kp=2 lambda=0.05 cgs=1n cgdmin=1n cgdmax=3n cjo=1n "
    "is=1e-6 "
    "n=20)\n"
    "S1 a c b 0 ss\n.model ss sw(vt=-9 vh=0.1 ron=2 roff=1meg)\n";

static void slopes_are_those_of_differences(void) {
  vs_equations e;
  vs_error err = {0};
  const double h = 1e-5;
  vs_status status = make(SLOPES, "", &e, &err);
  EXPECT(!status, "%s", err.text);
  if (status) return;
  const size_t n = (size_t)e.n;
  double *y = vs_alloc(n, sizeof *y), *low = vs_alloc(n, sizeof *low),
         *high = vs_alloc(n, sizeof *high);
  double *source = vs_alloc((size_t)e.sources + 1, sizeof *source),
         *jacobian = vs_alloc(n * n, sizeof *jacobian);
  for (state = 3; state < 9; state += 2) {
    for (size_t k = 0; k < n; k++) y[k] = 0.3 * drawn();
    vs_equations_choose(&e, y, false);
    vs_equations_value(&e, y, source, false, low, jacobian);
    for (int j = 0; j < e.n; j++) {
      const double at = y[j];
      y[j] = at - h;
      vs_equations_value(&e, y, source, false, low, NULL);
      y[j] = at + h;
      vs_equations_value(&e, y, source, false, high, NULL);
      y[j] = at;
      for (int i = 0; i < e.n; i++) {
        const int place = e.matrix.place[i * e.n + j];
        const double slope = place < 0 ? 0 : jacobian[place], by = (high[i] - low[i]) / (2 * h);
        EXPECT(fabs(slope - by) <= 1e-6 * fmax(100, fabs(by)),
               "d f(%s)/d %s: %.9g, by differences "
               "%.9g",
               e.name[i], e.name[j], slope, by);
      }
    }
  }
  free(y), free(low), free(high), free(source), free(jacobian);
  vs_equations_free(&e);
}

/* What B source q gives with v(a) = 2, v(b) = -3. */
static double value_in(const char *dialect, const char *expression) {
  vs_text netlist = {0};
  vs_equations e;
  vs_error err = {0};
  double f[16] = {0}, y[16] = {0}, source[16] = {0};
  vs_text_add(&netlist, "* one\nV1 a 0 2\nV2 b 0 -3\nB1 q 0 v=%s\nR1 q 0 1\n", expression);
  vs_status status = make(netlist.text, dialect, &e, &err);
  double value = NAN;
  if (!status) {
    y[vs_equations_signal(&e, "v(a)")] = 2;
    y[vs_equations_signal(&e, "v(b)")] = -3;
    vs_equations_choose(&e, y, false);
    vs_equations_value(&e, y, source, false, f, NULL);
    value = -f[vs_equations_signal(&e, "i(b1)")]; /* 0 = v(q) - value, and v(q) is 0 */
  }
  vs_equations_free(&e);
  vs_text_free(&netlist);
  return value;
}

/* ngspice's own pwr has the sign of its first number; read as PSpice's it has not, and pwrs has. */
static void functions_are_those_of_the_dialect(void) {
  CLOSE(value_in("", "pwr(v(b),3)"), -27, 1e-15);
  CLOSE(value_in("ps", "pwr(v(b),3)"), 27, 1e-15);
  CLOSE(value_in("ps", "pwrs(v(b),3)"), -27, 1e-15);
  CU_ASSERT_TRUE(isnan(value_in("", "pwrs(v(b),3)")));
  CLOSE(value_in("ps", "limit(v(a),5,3)"), 3, 1e-15);
  CLOSE(value_in("ps", "limit(v(b),-1,1)"), -1, 1e-15);
  CLOSE(value_in("ps", "stp(v(a))+2*stp(v(b))"), 1, 1e-15);
  CLOSE(value_in("ps", "if(v(a)>1 & v(b)<0, 4, 5)"), 4, 1e-15);
}

/* ---- the method ---- */

/* The error of v(a) after 1 s of a lossless ring of 1 H and 1 F, v = cos t, in steps of h. */
static double ring_error(double h) {
  vs_equations e;
  vs_rodas r;
  vs_error err = {0};
  const vs_rodas_drive none = {NULL, nothing};
  vs_status status = make("* ring\nL1 a 0 1\nC1 a 0 1 ic=1\n", "", &e, &err);
  CU_ASSERT_EQUAL_FATAL(status, VS_OK);
  vs_rodas_begin(&r, &e, &none);
  const int a = vs_equations_signal(&e, "v(a)"), steps = (int)lround(1 / h);
  r.y[a] = 1;
  for (int k = 0; k < steps; k++) {
    CU_ASSERT_TRUE(vs_rodas_try(&r, h));
    vs_rodas_take(&r, h);
  }
  const double error = fabs(r.y[a] - cos(1));
  vs_rodas_free(&r);
  vs_equations_free(&e);
  return error;
}

/* With half the step the error of a method of fourth order is a sixteenth; 14 to 18 leaves room for
 * the next order. */
static void its_order_is_four(void) {
  const double one = ring_error(0.1), half = ring_error(0.05);
  EXPECT(one < 1e-4 && one / half > 14 && one / half < 18, "%g, %g: %g times", one, half,
         one / half);
}

/* The error at a quarter of a step of h of v(z) = v(a) v(b) with v(a) = cos t and v(b) = exp(-t).
 */
static double product_error(double h) {
  vs_equations e;
  vs_rodas r;
  vs_error err = {0};
  const vs_rodas_drive none = {NULL, nothing};
  vs_status status = make("* product\nL1 a 0 1\nC1 a 0 1\nC2 b 0 1\nR2 b 0 1\n"
                          "B1 z 0 v=v(a)*v(b)\nR3 z 0 1\n",
                          "", &e, &err);
  CU_ASSERT_EQUAL_FATAL(status, VS_OK);
  vs_rodas_begin(&r, &e, &none);
  const int z = vs_equations_signal(&e, "v(z)");
  r.y[vs_equations_signal(&e, "v(a)")] = r.y[vs_equations_signal(&e, "v(b)")] = r.y[z] = 1;
  r.y[vs_equations_signal(&e, "i(b1)")] = -1;
  CU_ASSERT_TRUE(vs_rodas_try(&r, h));
  const double error = fabs(vs_rodas_dense_of(&r, z, 0.25) - cos(h / 4) * exp(-h / 4));
  vs_rodas_free(&r);
  vs_equations_free(&e);
  return error;
}

/* With half the step the error of an interpolation of third order is a sixteenth, of one of second
 * order an eighth. */
static void products_are_interpolated_as_states(void) {
  const double one = product_error(0.1), half = product_error(0.05);
  EXPECT(one < 1e-5 && one / half > 14, "%g, %g: %g times", one, half, one / half);
}

/* ---- fewer equations ---- */

static void drive_courses(void *ctx, double t_s, double *value) {
  const vs_equations *e = ctx;
  for (int k = 0; k < e->sources; k++)
    value[k] = vs_course_at(&e->course[e->source[k].course], t_s);
}

enum { ASKED = 6 };
static const char *const ASKED_FOR[ASKED] = {"v(a)", "v(b)", "v(c)", "v(d)", "i(vs)", "v(e)"};

/* The signals within the last of 20 steps of 10 us, behind it, and 1e5 times its error; returns the
 * number of equations. */
static int run_signals(bool reduce, double end[3][ASKED]) {
  vs_equations e;
  vs_rodas r;
  vs_error err = {0};
  int signal[ASKED];
  const vs_rodas_drive courses = {&e, drive_courses};
  const vs_status status =
      make("* a source, a coil, what hangs on them alone, and a load that squares\n"
           "V1 in 0 sin(1 10 2k)\nR1 in a 10\nVs a b 0\nR2 b 0 5\nL1 b c 1m\nR3 c 0 3\n"
           "C1 c 0 10u\nG1 0 d c 0 2\nR4 d x 1\nR5 x 0 3\nI1 0 d 0.5\nE1 e 0 d 0 0.5\n"
           "B1 c 0 i=0.001*v(d)*v(d)+0.1*v(e)\n",
           "", &e, &err);
  CU_ASSERT_EQUAL_FATAL(status, VS_OK);
  for (int k = 0; k < ASKED; k++) signal[k] = vs_equations_signal(&e, ASKED_FOR[k]);
  if (reduce) vs_reduction_make(&e, signal, ASKED);
  for (int k = 0; k < ASKED; k++) signal[k] = vs_equations_signal(&e, ASKED_FOR[k]);
  vs_rodas_begin(&r, &e, &courses);
  CU_ASSERT_TRUE_FATAL(vs_rodas_restart(&r, e.charge, 1e-9, false));
  vs_rodas_take(&r, 1e-9);
  for (int n = 0; n < 20; n++) {
    CU_ASSERT_TRUE(vs_rodas_try(&r, 1e-5));
    for (int k = 0; k < ASKED; k++) end[0][k] = vs_rodas_dense_of(&r, signal[k], 0.3);
    vs_rodas_take(&r, 1e-5);
  }
  for (int k = 0; k < ASKED; k++) {
    end[1][k] = r.y[signal[k]];
    end[2][k] = 1e5 * r.error[signal[k]];
  }
  const int rows = e.rows;
  vs_rodas_free(&r);
  vs_equations_free(&e);
  return rows;
}

/* Unknowns that follow from others are the same but for rounding. Of eleven equations four are
 * left: those of coil and capacitor, and two on which the source acts, as v(a) and i(vs) are asked
 * for. */
static void fewer_equations_say_the_same(void) {
  double whole[3][ASKED], reduced[3][ASKED];
  const int before = run_signals(false, whole), behind = run_signals(true, reduced);
  EXPECT(before == 11 && behind == 4, "%d of %d equations", behind, before);
  for (int k = 0; k < 3 * ASKED; k++) {
    const double was = whole[k / ASKED][k % ASKED], is = reduced[k / ASKED][k % ASKED];
    EXPECT(fabs(is - was) <= 1e-9 * (1 + fabs(was)) && fabs(was) > 1e-3, "%s: %.15g for %.15g",
           ASKED_FOR[k % ASKED], is, was);
  }
}

/* Of a decay of 1 us a step of 1 s leaves about a step's inverse: the method is L-stable. */
static void what_is_stiff_is_gone(void) {
  vs_equations e;
  vs_rodas r;
  vs_error err = {0};
  const vs_rodas_drive none = {NULL, nothing};
  CU_ASSERT_EQUAL_FATAL(make("* decay\nR1 a 0 1\nC1 a 0 1u\n", "", &e, &err), VS_OK);
  vs_rodas_begin(&r, &e, &none);
  r.y[0] = 1;
  CU_ASSERT_TRUE(vs_rodas_try(&r, 1));
  EXPECT(fabs(r.next[0]) < 1e-4, "%g is left", r.next[0]);
  vs_rodas_free(&r);
  vs_equations_free(&e);
}

/* ---- courses ---- */

static void courses_are_ngspices(void) {
  static const struct {
    const char *source;
    double t_s, value, edge_s;
  } ROWS_OF[] = {
      {"pulse(1 5 1m 1u 3u 10u 100u)", 0.5e-3, 1, 1e-3},
      {"pulse(1 5 1m 1u 3u 10u 100u)", 1.0005e-3, 3, 1.001e-3},
      {"pulse(1 5 1m 1u 3u 10u 100u)", 1.105e-3, 5, 1.111e-3},
      {"pulse(1 5 1m 1u 3u 10u 100u)", 1.1125e-3, 3, 1.114e-3},
      {"pulse(1 5 1m 1u 3u 10u)", 2e-3, 1, INFINITY},
      {"dc 7 sin(1 2 50 5m)", 4e-3, 1, 5e-3},
      {"sin(1 2 50 5m 0 90)", 5e-3, 3, INFINITY},
      {"sin(1 2 50 0 100)", 5e-3, 1 + 2 * 0.60653065971263342, INFINITY},
      {"pwl(1m 2 3m 6 4m 0)", 0.5e-3, 2, 1e-3},
      {"pwl(1m 2 3m 6 4m 0)", 2e-3, 4, 3e-3},
      {"pwl(1m 2 3m 6 4m 0)", 9e-3, 0, INFINITY},
  };
  for (size_t k = 0; k < COUNT(ROWS_OF); k++) {
    vs_text netlist = {0};
    vs_equations e;
    vs_error err = {0};
    vs_text_add(&netlist, "* course\nV1 a 0 %s\nR1 a 0 1\n", ROWS_OF[k].source);
    vs_status status = make(netlist.text, "", &e, &err);
    EXPECT(!status && e.courses == 1, "%s: %s", ROWS_OF[k].source, err.text);
    if (!status && e.courses == 1) {
      CLOSE_OF(vs_course_at(&e.course[0], ROWS_OF[k].t_s), ROWS_OF[k].value, 1, 1e-9);
      const double edge_s = vs_course_edge(&e.course[0], ROWS_OF[k].t_s);
      EXPECT(edge_s == ROWS_OF[k].edge_s || fabs(edge_s - ROWS_OF[k].edge_s) < 1e-12, "%s: %.12g",
             ROWS_OF[k].source, edge_s);
    }
    vs_equations_free(&e);
    vs_text_free(&netlist);
  }
}

/* ---- the whole state, and its slopes over a stretch ---- */

/* A switch with hysteresis and a comparator, whose instants the state moves; a diode with a stored
 * charge; a loop of capacitors, of which two charges are independent. */
static const char MAPPED[] =
    "* map\nV1 in 0 pulse(0 10 0.1m 10u 10u 0.4m 1m)\nR1 in a 10\nL1 a b 5m\nC1 b 0 1u\n"
    "D1 b c dd\n.model dd d(is=1e-9 n=1.2 rs=0.5 tt=2u)\nC2 c 0 2u\nR2 c 0 40\n"
    "S1 b d c 0 ss\n.model ss sw(vt=3 vh=1 ron=100 roff=1meg)\nR3 d 0 500\nC3 d 0 100n\n"
    "C4 d b 100n\nB1 e 0 v = v(d) > 2 ? 5 : 0\nR4 e f 1k\nC5 f 0 200n\n";

enum { MAP_STATES = 6, STRETCHES = 2 + 2 * MAP_STATES };
static const double STRETCH_S = 1e-3, PUSHED = 1e-4;

typedef struct mapped {
  vs_circuit_map map;
  int stretch; /* the first one settles, the second has slopes, the others are pushed */
  double begins[MAP_STATES], size[MAP_STATES], slope[MAP_STATES * MAP_STATES];
  double end[STRETCHES][MAP_STATES];
} mapped;

static double edge_of_map(void *ctx, double t_s) {
  (void)ctx;
  return (floor(t_s / STRETCH_S + 1e-6) + 1) * STRETCH_S;
}

static double any_length(void *ctx, double t_s) {
  (void)ctx, (void)t_s;
  return INFINITY;
}

static vs_status accept_map(void *ctx, double t_s, const double *signals, vs_error *err) {
  mapped *m = ctx;
  (void)signals;
  if (t_s < (m->stretch + 1) * STRETCH_S * (1 - 1e-9)) return VS_OK;
  if (m->map.states != MAP_STATES) return vs_fail(err, VS_RUN, "%d states", m->map.states);
  m->map.tell(m->map.solver);
  memcpy(m->end[m->stretch], m->map.end, sizeof m->end[0]);
  if (m->stretch == 0) memcpy(m->begins, m->map.end, sizeof m->begins);
  if (m->stretch == 1) {
    CU_ASSERT_TRUE(m->map.knows_slope);
    memcpy(m->size, m->map.size, sizeof m->size);
    memcpy(m->slope, m->map.slope, sizeof m->slope);
  }
  memcpy(m->map.next, m->begins, sizeof m->begins);
  const int pushed = (++m->stretch - 2) / 2;
  if (m->stretch >= 2 && pushed < MAP_STATES)
    m->map.next[pushed] += (m->stretch % 2 ? -PUSHED : PUSHED) * m->size[pushed];
  m->map.begins = true;
  m->map.wants_slope = m->stretch == 1;
  return VS_OK;
}

/* Against differences of second order at a tolerance of 1e-9: their error is the square of PUSHED
 * times what bends, and 1e-9 over PUSHED by the steps. */
static void a_map_has_the_slopes_of_differences(void) {
  mapped m = {0};
  char *text = vs_copy(MAPPED), *rest = text, *lines[LINES + 1];
  vs_circuit_job job = {.netlist = lines,
                        .dialect = "",
                        .relative_tolerance = 1e-4,
                        .current_tolerance_a = 1e-6,
                        .tolerance = 1e-9,
                        .until_s = STRETCHES * STRETCH_S,
                        .max_step_s = INFINITY};
  const vs_circuit_host host = {
      .ctx = &m, .edge = edge_of_map, .longest = any_length, .accept = accept_map, .map = &m.map};
  while ((lines[job.lines] = strsep(&rest, "\n")) && job.lines < LINES) job.lines++;
  vs_error err = {0};
  void *circuit = NULL;
  vs_status status = vs_compiled_kind.load(&job, &host, &circuit, &err);
  if (!status) status = vs_compiled_kind.run(circuit, &err);
  EXPECT(!status, "%s", err.text);
  EXPECT(m.stretch == STRETCHES, "%d stretches", m.stretch);
  for (int j = 0; j < MAP_STATES; j++)
    for (int i = 0; i < MAP_STATES; i++) {
      const double up = m.end[2 + 2 * j][i], down = m.end[3 + 2 * j][i];
      const double of_size = (up - down) / (2 * PUSHED) / m.size[i];
      const double slope = m.slope[i * MAP_STATES + j] * m.size[j] / m.size[i];
      EXPECT(fabs(slope - of_size) <= 1e-5, "%d by %d: %.9g, by differences %.9g", i, j, slope,
             of_size);
    }
  vs_compiled_kind.free(circuit);
  free(text);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"a sparse system is solved", a_sparse_system_is_solved},
      {"a singular one names a column", a_singular_one_names_a_column},
      {"slopes are those of differences", slopes_are_those_of_differences},
      {"functions are those of the dialect", functions_are_those_of_the_dialect},
      {"its order is four", its_order_is_four},
      {"products are interpolated as states", products_are_interpolated_as_states},
      {"fewer equations say the same", fewer_equations_say_the_same},
      {"what is stiff is gone", what_is_stiff_is_gone},
      {"courses are ngspice's", courses_are_ngspices},
      {"a map has the slopes of differences", a_map_has_the_slopes_of_differences},
  };
  return vs_suite("compiled", TESTS, COUNT(TESTS));
}
