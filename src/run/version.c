/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/version.h"

#include <gsl/gsl_version.h>

#include "ngspice/ngspice.h"

void vs_version_json(vs_json *json) {
  vs_json_object(json, "program", VS_JSON_ROW);
  vs_json_text(json, "version", VS_VERSION);
  vs_json_text(json, "ngspice", vs_ngspice_running());
  vs_json_text(json, "gsl", gsl_version);
  vs_json_end(json);
}

const char *vs_version_sources(void) {
  return VS_SOURCES;
}
