/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/phase_plane.h"

#include "base/gnuplot.h"

static vs_status add_curve(const vs_stretch *s, const vs_probe_shown *p, size_t run,
                           vs_script *script, vs_error *err) {
  const vs_traces *t = &s->run[run].traces;
  vs_probe_shown rate;
  if (!vs_probes_rate(p, t, &rate))
    return vs_fail(err, VS_INPUT,
                   "--orbit: %s has no column of the rate of '%s', which coordinates have", t->path,
                   p->column);
  if (!run) {
    vs_gnuplot_add(script, "set xlabel ");
    vs_gnuplot_quoted(script, p->label);
    vs_gnuplot_add(script, "\nset ylabel ");
    vs_gnuplot_quoted(script, rate.label);
    vs_gnuplot_add(script, "\nplot ");
  }
  vs_gnuplot_add(script, run ? ", " : "");
  vs_gnuplot_path(script, t->path);
  vs_gnuplot_add(script,
                 " using ($1 >= %.12g && $1 <= %.12g ? $%d*%g : NaN):($%d*%g) skip 1 with lines lc "
                 "rgb %s lw 1.2 title ",
                 s->from_s, s->to_s, vs_traces_find(t, p->column) + 1, p->scale,
                 vs_traces_find(t, rate.column) + 1, rate.scale, vs_stretch_colour(run));
  vs_gnuplot_quoted(script, s->run[run].folder);
  return VS_OK;
}

vs_status vs_phase_plane_add(const vs_stretch *s, vs_script *script, vs_error *err) {
  vs_status status = VS_OK;
  vs_stretch_begin(script);
  vs_gnuplot_add(script, "set multiplot layout %d,1\n", s->probes.count);
  vs_stretch_legend(s, script);
  for (int k = 0; k < s->probes.count; k++) {
    for (size_t r = 0; r < s->runs && !status; r++)
      status = add_curve(s, &s->probes.item[k], r, script, err);
    vs_gnuplot_add(script, "\n");
  }
  vs_gnuplot_add(script, "unset multiplot\n");
  return status;
}
