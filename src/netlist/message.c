/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message.h"

#include <string.h>

static const char PARAMETER[] = "ndefined parameter [", MODEL[] = "can't find model '",
                  RANGE[] = "out of range for ";

const char *vs_message_between(const char *message, const char *open, char close, size_t *length) {
  const char *begin = strstr(message, open), *end;
  if (!begin) return NULL;
  begin += strlen(open);
  end = strchr(begin, close);
  *length = end ? (size_t)(end - begin) : 0;
  return end ? begin : NULL;
}

const char *vs_message_parameter(const char *message, size_t *length) {
  return vs_message_between(message, PARAMETER, ']', length);
}

const char *vs_message_model(const char *message, size_t *length) {
  return vs_message_between(message, MODEL, '\'', length);
}

const char *vs_message_function(const char *message) {
  const char *s = strstr(message, RANGE);
  return s ? s + strlen(RANGE) : NULL;
}

bool vs_message_is_of_power(const char *message) {
  const char *name = vs_message_function(message);
  return name && (*name == '^' || *name == 'p');
}

const char *vs_message_behind_path(const char *name) {
  const char *begin = name;
  for (; *name && !strchr(" :#)\"", *name); name++)
    if (*name == '.') begin = name + 1;
  return begin;
}

const char *vs_message_remedy(const char *message) {
  static const struct {
    const char *says, *instead;
  } ROWS[] = {
      {PARAMETER, "; '.param NAME=...' or '*$ param NAME = ...' defines one"},
      {MODEL, "; '.model NAME ...' defines one"},
      {"nknown subckt",
       "; '.subckt NAME ...' defines one, '.include FILE' takes in a file that does"},
      {"already exists", "; give one of the two another name"},
      {"singular matrix", "; wanted: from every node a path to node 0 on which direct current may "
                          "flow, and no loop of voltage sources"},
      {"parameters for subcircuit", "; wanted: as many nodes as the subcircuit has"},
      {"too few parameters", "; wanted: as many nodes and values as such an element has"},
      {"not enough parameters",
       "; wanted: as many nodes and values as such an element, or its subcircuit, has"},
      {"nknown controlling source", "; a source V... of that name is wanted"},
      {"nknown parameter", "; wanted: NAME=VALUE of a name that such an element or model has"},
      {"xpression err",
       "; look for a '=' with nothing behind it, a bracket or a sign that is missing"},
      {"Closing \"", "; close that bracket"},
      {"syntax error", "; look for a bracket, a comma or a sign that is missing"},
      {"YYparse", "; look for a bracket, a comma or a sign that is missing"},
      {"imestep too small", "; look at the values of that element"}};
  if (vs_message_is_of_power(message))
    return "; a power below 0 has no value where x is 0, one below 1 no slope: write "
           "max(abs(x), 1u) for x";
  for (size_t k = 0; k < sizeof ROWS / sizeof *ROWS; k++)
    if (strcasestr(message, ROWS[k].says)) return ROWS[k].instead;
  return "";
}
