/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/roles.h"

#include <stdlib.h>

vs_where vs_roles_file(const vs_roles_search *f) {
  return (vs_where){f->w->listing->files[0], 1, 1};
}

vs_status vs_roles_named(const vs_roles_search *f, const char *option, const char *name,
                         const vs_element **e) {
  *e = vs_elements_find(f->w, name);
  if (*e) return VS_OK;
  const char **names = vs_alloc(f->w->count + 1, sizeof *names);
  for (size_t k = 0; k < f->w->count; k++) names[k] = f->w->elements[k].name;
  const char *nearest = vs_text_nearest(name, names, f->w->count);
  vs_status status =
      vs_fail_at(f->err, vs_roles_file(f), "--%s %s: there is no such element%s%s%s", option, name,
                 nearest ? "; did you mean " : " outside of subcircuits", nearest ? nearest : "",
                 nearest ? "?" : "");
  free(names);
  return status;
}

int vs_roles_gate_of(const vs_roles *r, const vs_element *source) {
  for (size_t k = 0; k < r->n_gates; k++)
    if (r->gates[k].source == source) return (int)k;
  return -1;
}
