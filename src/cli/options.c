/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "options.h"

#include "base/shutdown.h"

vs_run_options vs_options_of_run(const vs_run_options *asked, const vs_arguments *line) {
  vs_run_options o = *asked;
  o.scene = vs_command_name(line);
  o.folder = line->output;
  o.sets = line->sets;
  o.n_sets = line->n_sets;
  o.json = line->json;
  o.quiet = line->quiet;
  o.allow_code = line->allow_code;
  o.stop = &vs_shutdown_requested;
  return o;
}

void vs_options_explain_formats(vs_text *help) {
  vs_text_add(help, "\nFormats of the rows (--format):\n");
  for (const vs_format *f = vs_format_all; f->name; f++)
    vs_text_add(help, "  %-8s %s\n", f->name, f->text);
}
