/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/digest.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "report/bars.h"
#include "chapters.h"
#include "flow.h"
#include "waves.h"
#include "report/html.h"

vs_status vs_digest_write(const char *folder, bool quiet, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_tree summary = {0};
  vs_html html = {0};
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(path, R_OK)) return VS_OK;
  vs_stretch *s = vs_alloc(1, sizeof *s);
  vs_status status = vs_waves_open(s, &folder, 1, err);
  if (!status) status = vs_tree_read(path, &summary, err);
  if (!status) {
    vs_chapter_head(&html, folder, summary.root, s->to_s);
    status = vs_bars_add(summary.root, &html, err);
  }
  if (!status) {
    vs_chapter_verdict(&html, summary.root);
    vs_flow_add(&html, vs_tree_child(summary.root, "energy"));
    status = vs_waves_add(s, &html, err);
    vs_chapter_measures(&html, summary.root);
    vs_chapter_parameters(&html, summary.root);
    vs_html_end(&html);
  }
  if (!status) status = vs_html_write(&html, folder, quiet, err);
  vs_tree_free(&summary);
  vs_html_free(&html);
  vs_waves_close(s);
  free(s);
  return status;
}
