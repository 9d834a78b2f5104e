/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/stretch.h"

void vs_stretch_begin(vs_script *script) {
  vs_gnuplot_add(script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                         "set lmargin 12\nset rmargin 4\nset datafile separator ','\n");
}

void vs_stretch_legend(const vs_stretch *s, vs_script *script) {
  vs_gnuplot_add(script, s->runs > 1 ? "set key tmargin right horizontal reverse Left samplen 2\n"
                                     : "unset key\n");
}

const char *vs_stretch_colour(size_t run) {
  static const char *const COLOURS[VS_STRETCH_RUNS] = {"#1f4e79", "#d1495b", "#2a9d6f", "#e08e1b",
                                                       "#8e5ea2", "#17a2b8", "#7f5539", "#606060"};
  return COLOURS[run % VS_STRETCH_RUNS];
}
