/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const vs_scale_colours[VS_COLOURS] = {"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                                  "#000000", "#56b4e9", "#d55e00"};
const char vs_scale_colour_good[] = "#0072b2", vs_scale_colour_bad[] = "#d55e00";
const char vs_scale_palette[] =
    "set palette defined (0 '#440154', 1 '#482878', 2 '#3e4989', 3 '#31688e', 4 '#26828e', "
    "5 '#1f9e89', 6 '#35b779', 7 '#6ece58', 8 '#b5de2b', 9 '#fde725')\n";

void vs_scale_unit(const char *unit, char *pretty, size_t size) {
  static const struct {
    const char *plain, *pretty;
  } SIGNS[] = {{"ohm", "Ω"}, {"deg", "°"}, {"2", "²"}, {"3", "³"}, {".", "·"}, {"/u", "/µ"}};
  size_t n = 0;
  *pretty = '\0';
  if (*unit == 'u' && unit[1]) { /* micro */
    n = (size_t)snprintf(pretty, size, "µ");
    unit++;
  }
  while (*unit && n + 4 < size) {
    size_t k = 0;
    while (k < sizeof SIGNS / sizeof *SIGNS &&
           strncmp(unit, SIGNS[k].plain, strlen(SIGNS[k].plain)))
      k++;
    bool sign = k < sizeof SIGNS / sizeof *SIGNS;
    n +=
        (size_t)snprintf(pretty + n, size - n, "%.*s", sign ? 4 : 1, sign ? SIGNS[k].pretty : unit);
    unit += sign ? strlen(SIGNS[k].plain) : 1;
  }
}

static bool takes_prefix(const char *unit) {
  static const char *const UNITS[] = {"V", "A", "W", "J", "ohm", "F", "H", "s", "Hz", "m", "N"};
  for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++)
    if (!strcmp(unit, UNITS[k])) return true;
  return false;
}

/* What the manifest says of an axis that is a range; else true if the middle value is nearer to the
 * geometric than to the arithmetic mean of the ends. */
static bool is_log(const vs_folder_column *c, vs_extent s) {
  const vs_node *said = c->node ? vs_tree_child(c->node, "log") : NULL;
  if (said && said->kind == VS_NODE_TEXT) return !strcmp(said->text, "true") && s.least > 0;
  if (!s.value || s.count < 3 || !(s.least > 0) || s.largest < 8 * s.least) return false;
  double middle =
      s.count % 2 ? s.value[s.count / 2] : sqrt(s.value[s.count / 2] * s.value[s.count / 2 - 1]);
  double even = (s.least + s.largest) / 2, geometric = sqrt(s.least * s.largest);
  return fabs(log(middle / geometric)) < fabs(log(middle / even));
}

vs_scale vs_scale_of(const vs_folder_column *c, vs_extent span) {
  static const char *const PREFIXES[] = {"p", "n", "µ", "m", "", "k", "M", "G"};
  vs_scale s = {.factor = 1, .log = is_log(c, span)};
  double size =
      s.log ? sqrt(span.least * span.largest) : fmax(fabs(span.least), fabs(span.largest));
  int k = 4;
  if (takes_prefix(c->unit) && isfinite(size) && size > 0)
    k = 4 + (int)fmax(-4, fmin(3, floor(log10(size * (1 + 1e-9)) / 3)));
  char unit[40];
  vs_scale_unit(c->unit, unit, sizeof unit);
  s.factor = pow(10, -3 * (k - 4));
  snprintf(s.unit, sizeof s.unit, "%s%s", PREFIXES[k], unit);
  if (c->role == VS_ROLE_MARGIN) {
    s.factor = 100;
    snprintf(s.unit, sizeof s.unit, "%%");
  }
  snprintf(s.label, sizeof s.label, "%.240s%s%s", c->name, *s.unit ? " / " : "", s.unit);
  return s;
}
