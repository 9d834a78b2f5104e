/* SPDX-License-Identifier: GPL-3.0-or-later
 * The files of a run as plot and compare read them: summary.json, run.csv, events.csv; and what
 * their texts become on a page and in a script for gnuplot. */
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"
#include "report/compare.h"
#include "report/margin_bars.h"
#include "report/plot/sheets.h"
#include "report/plot/time_window.h"
#include "report/run_page.h"
#include "study/methods.h"
#include "targets.h"

static const char *const FILES[] = {"run.csv", "events.csv", "manifest.json", NULL};
static const char RUN[] = "t_s,p_m,v_ak_v\n0,0,1\n0.1,1,2\n";

/* What a page and a script never hold: what would be obeyed in place of being shown. */
static void is_harmless(const char *text) {
  for (const char *s = text; *s; s++)
    FUZZ_HOLDS((unsigned char)*s >= ' ' || *s == '\n' || *s == '\t');
}

static void page(const vs_node *root) {
  vs_html html = {0};
  vs_script bars = {0};
  int size[2];
  if (vs_margin_bars_script(root, false, &bars, size)) is_harmless(bars.text.text);
  vs_gnuplot_free(&bars);
  vs_run_page_head(&html, "run", root, 1);
  vs_run_page_verdict(&html, root);
  vs_run_page_values(&html, root);
  is_harmless(html.text.text);
  FUZZ_HOLDS(!strstr(html.text.text, "<script"));
  vs_html_free(&html);
}

/* A string of gnuplot's ends where it should, and holds nothing that a shell is given. */
static void quoted(const char *text) {
  vs_script script = {0};
  vs_gnuplot_quoted(&script, text);
  const char *s = script.text.text;
  FUZZ_HOLDS(*s == '"' && strchr(s + 1, '"') == s + script.text.length - 1);
  FUZZ_HOLDS(!strpbrk(s, "`$'\n"));
  is_harmless(s);
  vs_gnuplot_free(&script);
}

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE], other[VS_PATH_SIZE];
  vs_tree summary = {0};
  vs_moments moments = {0};
  vs_text told = {0};
  vs_error err = {0};
  quoted(text);
  fuzz_write_all(text, size, "summary.json", FILES, path);
  if (!strstr(text, "%%% run.csv")) fuzz_write("run.csv", RUN, strlen(RUN), other);
  vs_status status = vs_tree_read(path, &summary, &err);
  fuzz_judge(status, &err);
  if (!status) page(summary.root);
  vs_tree_free(&summary);
  fuzz_judge(vs_time_window_read_moments(fuzz_folder(), &moments, &err), &err);
  vs_time_window_free_moments(&moments);
  free(vs_sheets_new(fuzz_folder(), "t_s,p_m,v_ak_v", 1));
  for (int json = 0; json < 2; json++) {
    const vs_compare_options o = {fuzz_folder(), fuzz_folder(), json, vs_methods_all};
    fuzz_judge(vs_compare_tell(&o, &told, &err), &err);
  }
  vs_text_free(&told);
}

const fuzz_target fuzz_summary = {"summary", take, NULL, NULL};
