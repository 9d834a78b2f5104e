/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/code_models.h"

#include <ctype.h>
#include <dlfcn.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>

#include "base/path.h"

/* What turns a line E, F, G or H, or one that continues it, into a code model. */
static bool has_form(const char *line) {
  static const char *const FORMS[] = {"poly", "table", "laplace", "freq", "and(", "or("};
  bool found = false;
  for (size_t k = 0; k < sizeof FORMS / sizeof *FORMS && !found; k++)
    found = strcasestr(line, FORMS[k]);
  return found;
}

bool vs_code_models_needed(char *const *netlist, size_t lines, const char *dialect) {
  bool needed = *dialect;
  for (size_t k = 1; k < lines && !needed; k++) {
    const char *line = netlist[k] + strspn(netlist[k], " \t");
    int first = tolower((unsigned char)*line);
    needed = first == 'a' || first == 'u' || (strchr("efgh+", first) && has_form(line));
  }
  return needed;
}

vs_status vs_code_models_load(const vs_library *library, vs_error *err) {
  char pattern[VS_PATH_SIZE], command[VS_PATH_SIZE + 16];
  void *function;
  Dl_info info;
  glob_t found;
  memcpy(&function, &library->init, sizeof function); /* C has no cast from functions to data */
  const char *file = dladdr(function, &info) ? info.dli_fname : "";
  const char *slash = strrchr(file, '/');
  int folder = slash ? (int)(slash - file) : 0;
  snprintf(pattern, sizeof pattern, "%.*s/ngspice/*.cm", folder, file);
  if (glob(pattern, 0, NULL, &found))
    return vs_fail(err, VS_RUN,
                   "the circuit needs ngspice's code models, and there are none at %s: install "
                   "ngspice with XSPICE",
                   pattern);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    snprintf(command, sizeof command, "codemodel %s", found.gl_pathv[k]);
    library->command(command);
  }
  globfree(&found);
  return VS_OK;
}
