/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists of other programs, as `import` reads them, up to the deck's lines. */
#include <string.h>

#include "import/copying.h"
#include "import/lines.h"
#include "import/roles.h"
#include "import/settings.h"
#include "targets.h"

static const char *const FILES[] = {"a.lib", "b.inc", NULL};

typedef struct work {
  vs_listing listing;
  vs_values values;
  vs_elements wiring;
  vs_roles roles;
  vs_fate plan;
  vs_copying body;
  vs_settings settings;
} work;

static void make(work *w) {
  vs_text text = {0};
  vs_copying_write(&w->plan, fuzz_folder(), NULL, &w->body);
  vs_settings_make(&w->settings, &w->roles, &w->values, w->body.until_s, w->body.gear);
  vs_declared_write(&w->plan.sheet, &text);
  vs_settings_write(&w->settings, "deck.cir", "* ", &text);
  vs_text_free(&text);
}

static vs_status understand(work *w, const char *path, vs_findings *all) {
  const vs_roles_asked asked = {NULL, NULL, NULL};
  vs_error err = {.findings = all};
  vs_status status = vs_listing_read(&w->listing, path, NULL, &err);
  if (!status) {
    vs_values_read(&w->values, &w->listing);
    status = vs_elements_read(&w->wiring, &w->listing, &err);
  }
  if (!status && !vs_error_count(&err))
    status = vs_roles_find(&w->wiring, &w->values, &asked, &w->roles, &err);
  bool known = !status && !vs_error_count(&err);
  w->plan = (vs_fate){.wiring = &w->wiring, .values = &w->values, .roles = &w->roles};
  if (known) status = vs_fate_make(&w->plan, NULL, &err);
  known = known && !status && !vs_error_count(&err);
  if (known) status = vs_lines_add(&w->plan, &err);
  fuzz_judge(status, &err);
  if (known) make(w);
  return status;
}

static vs_status go(const char *path, vs_findings *all) {
  static work w_; /* too large to be made anew for each text */
  work *w = &w_;
  memset(w, 0, sizeof *w);
  vs_status status = understand(w, path, all);
  vs_copying_free(&w->body);
  vs_fate_free(&w->plan);
  vs_elements_free(&w->wiring);
  vs_values_free(&w->values);
  vs_listing_free(&w->listing);
  return status;
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  fuzz_write_all(text, size, "netlist.net", FILES, path);
  fuzz_read(go, path, size);
}

const fuzz_target fuzz_netlist = {"netlist", take, &fuzz_grammar_netlist, NULL};
