/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/function.h"

#include <gsl/gsl_math.h>
#include <math.h>
#include <string.h>

double vs_function_power(double x, double y) {
  if (y == 2) return x * x; /* as gsl_pow_int has it; most losses are squares */
  return y == rint(y) && fabs(y) <= VS_FUNCTION_WHOLE ? gsl_pow_int(x, (int)y) : pow(x, y);
}
double vs_function_sign_power(double x, double y) {
  return copysign(vs_function_power(fabs(x), y), x);
}
static double add(double x, double y) {
  return x + y;
}
static double subtract(double x, double y) {
  return x - y;
}
static double multiply(double x, double y) {
  return x * y;
}
static double divide(double x, double y) {
  return x / y;
}
static double negate(double x) {
  return -x;
}
static double sign(double x) {
  return (x > 0) - (x < 0);
}

static void set(double d[5], double x, double y, double xx, double xy, double yy) {
  d[0] = x, d[1] = y, d[2] = xx, d[3] = xy, d[4] = yy;
}
static void set_one(double d[5], double x, double xx) {
  d[0] = x, d[1] = xx;
}

static void add_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set(d, 1, 1, 0, 0, 0);
}
static void subtract_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set(d, 1, -1, 0, 0, 0);
}
static void multiply_slopes(double x, double y, double d[5]) {
  set(d, y, x, 0, 1, 0);
}
static void divide_slopes(double x, double y, double d[5]) {
  set(d, 1 / y, -x / (y * y), 0, -1 / (y * y), 2 * x / (y * y * y));
}
static void negate_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set_one(d, -1, 0);
}

/* f = x^y: f_x = y x^(y-1), f_y = x^y ln x, f_xx = y (y-1) x^(y-2), f_xy = x^(y-1) (1 + y ln x),
 * f_yy = x^y ln^2 x. For x = 0 and y > 2 all are 0; a derivative with the factor 0 is 0, though
 * the power of 0 beside it may be infinite. */
static void power_slopes(double x, double y, double d[5]) {
  double ln = x == 0 && y > 2 ? 0 : log(x), low = vs_function_power(x, y - 2);
  double middle = x == 0 ? vs_function_power(x, y - 1) : low * x;
  double f = x == 0 ? vs_function_power(x, y) : middle * x, curve = y * (y - 1);
  set(d, y == 0 ? 0 : y * middle, f * ln, curve == 0 ? 0 : curve * low, middle * (1 + y * ln),
      f * ln * ln);
}

/* f = sign(x) |x|^y is odd in x, so f_x and f_xy are even. */
static void sign_power_slopes(double x, double y, double d[5]) {
  power_slopes(fabs(x), y, d);
  double s = copysign(1, x);
  d[1] *= s, d[2] *= s, d[4] *= s;
}
static void min_slopes(double x, double y, double d[5]) {
  set(d, x <= y, x > y, 0, 0, 0);
}
static void max_slopes(double x, double y, double d[5]) {
  set(d, x >= y, x < y, 0, 0, 0);
}
static void abs_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, copysign(1, x), 0);
}
static void sign_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set_one(d, 0, 0);
}
static void sqrt_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 0.5 / sqrt(x), -0.25 / (x * sqrt(x)));
}
static void exp_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, exp(x), exp(x));
}
static void ln_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 1 / x, -1 / (x * x));
}
static void log10_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 1 / (x * M_LN10), -1 / (x * x * M_LN10));
}
static void sin_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, cos(x), -sin(x));
}
static void cos_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, -sin(x), -cos(x));
}
static void tan_slopes(double x, double y, double d[5]) {
  (void)y;
  double t = tan(x);
  set_one(d, 1 + t * t, 2 * t * (1 + t * t));
}
static void asin_slopes(double x, double y, double d[5]) {
  (void)y;
  double r = 1 / sqrt(1 - x * x);
  set_one(d, r, x * r * r * r);
}
static void acos_slopes(double x, double y, double d[5]) {
  asin_slopes(x, y, d);
  set_one(d, -d[0], -d[1]);
}
static void atan_slopes(double x, double y, double d[5]) {
  (void)y;
  double r = 1 / (1 + x * x);
  set_one(d, r, -2 * x * r * r);
}
static void sinh_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, cosh(x), sinh(x));
}
static void cosh_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, sinh(x), cosh(x));
}
static void tanh_slopes(double x, double y, double d[5]) {
  (void)y;
  double t = tanh(x);
  set_one(d, 1 - t * t, -2 * t * (1 - t * t));
}

#define ONE(NAME, OF, SLOPES, SLOPE, ...)                                                          \
  { .name = NAME, .of = OF, .slopes = SLOPES, .slope = {SLOPE}, __VA_ARGS__ }
#define TWO(NAME, OF, SLOPES, SLOPE_X, SLOPE_Y, ...)                                               \
  { .name = NAME, .of_two = OF, .slopes = SLOPES, .slope = {SLOPE_X, SLOPE_Y}, __VA_ARGS__ }
const vs_function vs_function_table[VS_FUNCTIONS] = {
    TWO("+", add, add_slopes, "1", "1", .alike = true),
    TWO("-", subtract, subtract_slopes, "1", "-1", .alike = true),
    TWO("*", multiply, multiply_slopes, "y", "x", .power = {1, 1}),
    TWO("/", divide, divide_slopes, "1/y", "-x/y^2", .power = {1, -1}),
    TWO("^", vs_function_power, power_slopes, "y*x^(y-1)", "x^y*ln(x)", .raises = true),
    ONE("neg", negate, negate_slopes, "-1", .power = {1}),
    ONE("abs", fabs, abs_slopes, "sgn(x)", .power = {1}),
    ONE("sqrt", sqrt, sqrt_slopes, "0.5/sqrt(x)", .power = {0.5}),
    ONE("exp", exp, exp_slopes, "exp(x)", .pure = true),
    ONE("ln", log, ln_slopes, "1/x", .pure = true),
    ONE("log10", log10, log10_slopes, "1/(ln(10)*x)", .pure = true),
    TWO("pow", vs_function_power, power_slopes, "y*x^(y-1)", "x^y*ln(x)", .raises = true),
    TWO("pwr", vs_function_sign_power, sign_power_slopes, "y*abs(x)^(y-1)", "pwr(x,y)*ln(abs(x))",
        .raises = true),
    TWO("min", fmin, min_slopes, "(1-sgn(x-y))/2", "(1+sgn(x-y))/2", .alike = true),
    TWO("max", fmax, max_slopes, "(1+sgn(x-y))/2", "(1-sgn(x-y))/2", .alike = true),
    ONE("sin", sin, sin_slopes, "cos(x)", .pure = true),
    ONE("cos", cos, cos_slopes, "-sin(x)", .pure = true),
    ONE("tan", tan, tan_slopes, "1+tan(x)^2", .pure = true),
    ONE("asin", asin, asin_slopes, "1/sqrt(1-x^2)", .pure = true),
    ONE("acos", acos, acos_slopes, "-1/sqrt(1-x^2)", .pure = true),
    ONE("atan", atan, atan_slopes, "1/(1+x^2)", .pure = true),
    ONE("sinh", sinh, sinh_slopes, "cosh(x)", .pure = true),
    ONE("cosh", cosh, cosh_slopes, "sinh(x)", .pure = true),
    ONE("tanh", tanh, tanh_slopes, "1-tanh(x)^2", .pure = true),
    ONE("sgn", sign, sign_slopes, "0", .power = {0}),
};

int vs_function_find(const char *name) {
  for (int k = VS_OPERATORS; k < VS_FUNCTIONS; k++)
    if (!strcmp(name, vs_function_table[k].name)) return k;
  return -1;
}
