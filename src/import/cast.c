/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cast.h"

#include <math.h>
#include <strings.h>

#include "gates.h"
#include "winding.h"

static vs_status set_mains(vs_roles_search *f, const vs_element *e) {
  vs_course_sine s;
  vs_roles *r = f->roles;
  vs_where where = vs_elements_where(f->w, e, 0);
  vs_status status = vs_course_read_sine(f->w, f->v, e, &s, f->err);
  if (status) return status;
  if (e->letter != 'v')
    return vs_fail_at(f->err, where, "%s: the mains are a source of voltage, V...", e->name);
  if (s.offset_v != 0 || s.damping != 0)
    return vs_fail_at(f->err, where,
                      "%s: the mains have no %s; write that as a source of its own in series, or "
                      "say --mains none, which leaves %s as it is",
                      e->name, s.offset_v != 0 ? "offset" : "damping", e->name);
  if (!(s.hz > 0) || s.peak_v == 0)
    return vs_fail_at(f->err, where, "%s: SIN(0 amplitude frequency) is wanted of the mains",
                      e->name);
  if (isfinite(s.cycles))
    return vs_fail_at(f->err, where,
                      "%s: the mains do not end after %.9g cycles (the seventh number, LTspice's); "
                      "leave it out, and let the run end at %.9g s or give the scene an event "
                      "{kind: interruption, at: %.9g s, duration: ...}",
                      e->name, s.cycles, s.delay_s + s.cycles / s.hz, s.delay_s + s.cycles / s.hz);
  r->mains = e;
  r->rms_v = fabs(s.peak_v) / sqrt(2);
  r->hz = s.hz;
  r->delayed = s.delay_s > 0;
  r->phase_deg = remainder(s.phase_deg - 360 * s.hz * s.delay_s + (s.peak_v < 0 ? 180 : 0), 360);
  return VS_OK;
}

static bool is_sine(const vs_roles_search *f, const vs_element *e) {
  return e->letter == 'v' && (vs_course_has(f->w, e, "sin") || vs_course_has(f->w, e, "sine"));
}

static vs_status find_mains(vs_roles_search *f, const char *asked) {
  const vs_element *found = NULL;
  vs_text all = {0};
  size_t count = 0;
  if (asked && !strcasecmp(asked, "none")) return VS_OK;
  if (asked) {
    vs_status status = vs_roles_named(f, "mains", asked, &found);
    return status ? status : set_mains(f, found);
  }
  for (size_t k = 0; k < f->w->count; k++)
    if (is_sine(f, &f->w->elements[k])) {
      vs_text_add(&all, "%s%s", count++ ? ", " : "", f->w->elements[k].name);
      found = &f->w->elements[k];
    }
  vs_status status = VS_OK;
  if (count > 1)
    status = vs_fail_at(f->err, vs_elements_where(f->w, found, 0),
                        "%zu sources are sines, %s: --mains NAME says which is the mains, --mains "
                        "none that none is",
                        count, all.text);
  else if (found)
    status = set_mains(f, found);
  f->roles->found_mains = found;
  vs_text_free(&all);
  return status;
}

vs_status vs_cast_roles(const vs_elements *w, const vs_values *v, const vs_roles_asked *asked,
                        vs_roles *roles, vs_error *err) {
  vs_roles_search f = {w, v, roles, err};
  *roles = (vs_roles){0};
  size_t before = vs_error_count(err);
  vs_status status = vs_error_keep(err, find_mains(&f, asked->mains));
  bool lost = vs_error_count(err) > before; /* without the mains a gate cannot be recognised */
  if (!status && !lost) status = vs_error_keep(err, vs_gates_find(&f, asked->gate));
  if (!status) status = vs_error_keep(err, vs_winding_find(&f, asked->coil));
  if (!status) status = vs_gates_check_alike(&f);
  if (!status) vs_gates_set_firing(roles);
  return status;
}
