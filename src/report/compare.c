/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/compare.h"

#include <stdlib.h>
#include <string.h>

#include "run_pair.h"
#include "study_pair.h"

static vs_status compare_runs(const vs_compare_options *o, vs_text *out, vs_error *err) {
  vs_run_pair pair = {0};
  vs_status status = vs_run_pair_open(&pair, o->a, o->b, err);
  if (!status) (o->json ? vs_run_pair_json : vs_run_pair_table)(&pair, out);
  vs_run_pair_close(&pair);
  return status;
}

static vs_status compare_studies(const vs_compare_options *o, vs_text *out, vs_error *err) {
  vs_study_pair *pair = vs_alloc(1, sizeof *pair); /* large, because of its columns */
  vs_status status = vs_study_pair_open(pair, o->a, o->b, o->methods, err);
  if (!status) (o->json ? vs_study_pair_json : vs_study_pair_table)(pair, out);
  vs_study_pair_close(pair);
  free(pair);
  return status;
}

/* What the folder holds; NULL: neither a run nor a study. */
static const char *kind_of(const char *folder) {
  return vs_folder_here(folder) ? "study" : vs_traces_here(folder) ? "run" : NULL;
}

vs_status vs_compare_tell(const vs_compare_options *o, vs_text *out, vs_error *err) {
  const char *folders[] = {o->a, o->b}, *kinds[2];
  for (int k = 0; k < 2; k++)
    if (!(kinds[k] = kind_of(folders[k])))
      return vs_fail(err, VS_INPUT,
                     "%.500s: holds neither a run nor a study; 'vibrospice run "
                     "SCENE -o DIR' makes one",
                     folders[k]);
  if (strcmp(kinds[0], kinds[1]) != 0)
    return vs_fail(err, VS_INPUT,
                   "%.400s holds a %s and %.400s a %s; two of a kind can be compared", o->a,
                   kinds[0], o->b, kinds[1]);
  return (vs_folder_here(o->a) ? compare_studies : compare_runs)(o, out, err);
}
