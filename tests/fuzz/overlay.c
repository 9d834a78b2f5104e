/* SPDX-License-Identifier: GPL-3.0-or-later
 * Measured curves that `plot --overlay` draws over a run's. */
#include "report/plot/overlay.h"

#include <string.h>

#include "targets.h"

static const char *const FILES[] = {"summary.json", "run.csv", NULL};
static const char SUMMARY[] =
    "{\"probes\": {\"v_ak\": {\"unit\": \"V\"}, \"i_thyristor\": {\"unit\": \"A\"}}}\n";

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE], other[VS_PATH_SIZE];
  vs_overlay overlay = {0};
  vs_error err = {0};
  fuzz_write_all(text, size, "measured.csv", FILES, path);
  if (!strstr(text, "%%% summary.json"))
    fuzz_write("summary.json", SUMMARY, strlen(SUMMARY), other);
  const vs_overlay_run run = {.folder = fuzz_folder(),
                              .path = "run.csv",
                              .header = "t_s,p_m,u_m,i_a,v_eva_v,v_ak_v,i_thyristor_a",
                              .until_s = 2};
  fuzz_judge(vs_overlay_read(path, &run, &overlay, &err), &err);
  vs_overlay_find(&overlay, "p_m");
  vs_overlay_free(&overlay);
}

const fuzz_target fuzz_overlay = {"overlay", take, NULL, NULL};
