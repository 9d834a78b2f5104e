/* SPDX-License-Identifier: GPL-3.0-or-later
 * The curves of a run, read back. */
#include "report/traces.h"

#include "targets.h"

static void take(const char *text, size_t size) {
  char path[VS_PATH_SIZE];
  vs_traces traces = {0};
  vs_error err = {0};
  fuzz_write("run.csv", text, size, path);
  vs_status status = vs_traces_read(fuzz_folder(), &traces, &err);
  fuzz_judge(status, &err);
  if (!status) {
    FUZZ_HOLDS(traces.rows > 0 && traces.columns > 0);
    FUZZ_HOLDS(!vs_traces_find(&traces, traces.name[0]));
    vs_trace_value(&traces, traces.rows - 1, (int)traces.columns - 1);
    for (size_t k = 1; k < traces.rows; k++)
      FUZZ_HOLDS(vs_trace_time(&traces, k) >= vs_trace_time(&traces, k - 1));
  }
  vs_traces_free(&traces);
}

const fuzz_target fuzz_run_csv = {"run_csv", take, NULL, NULL};
