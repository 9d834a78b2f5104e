/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tables.h"

#include <stdlib.h>
#include <string.h>

#include "report/compare.h"
#include "report/study_page.h"
#include "study/methods.h"
#include "study/study_results.h"
#include "targets.h"

static const struct {
  const char *name, *text;
} FILES[] = {
    {"manifest.json",
     "{\"method\": \"grid\", \"seed\": 0, \"cases\": 4, \"done\": 3, \"failed\": 1, \"violated\": "
     "1,\n"
     " \"axes\": [{\"key\": \"firing.angle\", \"column\": \"firing.angle_deg\", \"unit\": \"deg\", "
     "\"by\": \"grid\", \"text\": \"angle\", \"nominal\": 100, \"values\": [90, 95, 100, 105]}],\n"
     " \"report\": [{\"name\": \"i_peak\", \"column\": \"i_peak_a\", \"unit\": \"A\", \"rating\": "
     "2, \"side\": \"most\", \"text\": \"current\"}],\n"
     " \"shard\": [1, 1]}\n"},
    {"study.csv", "case,id,firing.angle_deg,i_peak_a,margin_least,margin_error,weakest,rung,"
                  "leaving_bound,happened,not_judged,warnings,status\n"
                  "0,fe0b0569e1966bc0,90,0.98,0.1,,i_peak,0,0,,0\n"
                  "1,ecc578a14d3cd5fb,95,0.84,-0.2,0.01,i_peak,1,1e-6,\"one, two\",3\n"
                  "3,82e8ce70e850eeb7,105,0.8,0.2,,i_peak,0,0,,0\n"},
    {"failures.csv", "case,id,firing.angle_deg,status,why\n"
                     "2,e4140ab861d42e3a,100,1,\"t = 0.0085 s: the armature, so to say\"\n"},
};

static const char *const OTHERS[] = {"failures.csv", "study.csv", NULL};

/* The page of the study, without pictures: nothing on it is obeyed. */
static void page(const vs_folder *folder, const vs_study_results *all) {
  const vs_study_pictures album = {0};
  vs_html html = {0};
  vs_study_page_write(folder, all, &album, NULL, &html);
  for (const char *s = html.text.text; *s; s++)
    FUZZ_HOLDS((unsigned char)*s >= ' ' || *s == '\n' || *s == '\t');
  FUZZ_HOLDS(!strstr(html.text.text, "<script"));
  vs_html_free(&html);
}

static void survey(const vs_folder *folder) {
  vs_study_results *all = vs_alloc(1, sizeof *all);
  vs_error err = {0};
  bool largest;
  vs_folder_aim(folder, &largest);
  vs_folder_search(folder);
  vs_folder_found(folder);
  vs_folder_is_sampled(folder);
  fuzz_judge(vs_study_results_take(folder, all, &err), &err);
  vs_study_results_ranked(folder, all);
  page(folder, all);
  vs_study_results_free(folder, all);
  free(all);
}

/* Of two folders in which the same stands nothing may be told that makes no JSON. */
static void compare(void) {
  const vs_compare_options options = {fuzz_folder(), fuzz_folder(), true, vs_methods_all};
  vs_text text = {0};
  vs_error err = {0};
  fuzz_judge(vs_compare_tell(&options, &text, &err), &err);
  vs_text_free(&text);
}

void fuzz_tables_take(const char *name, const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  vs_folder *folder = vs_alloc(1, sizeof *folder);
  vs_error err = {0};
  fuzz_write_all(text, size, name, OTHERS + !strcmp(name, "study.csv"), path);
  for (size_t k = 0; k < sizeof FILES / sizeof *FILES; k++) {
    char other[64];
    snprintf(other, sizeof other, "%%%%%% %s", FILES[k].name);
    if (strcmp(FILES[k].name, name) && !strstr(text, other))
      fuzz_write(FILES[k].name, FILES[k].text, strlen(FILES[k].text), path);
  }
  vs_status status = vs_folder_open(folder, fuzz_folder(), vs_methods_all, &err);
  fuzz_judge(status, &err);
  if (!status) {
    survey(folder);
    compare();
  }
  vs_folder_close(folder);
  free(folder);
}
