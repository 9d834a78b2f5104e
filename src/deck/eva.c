/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deck/eva.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const vs_shelf EVA_SHELF = {"subcircuit", "", ".inc"};

/* What the files have for the current, where the flux linkage begins, and how they end. */
static const char CURRENT[] = "v(lam)*v(z)/(2*{eva_a})", BEGINS[] = " ic=0", ENDS[] = ".ends";

void vs_eva_take_law(vs_deck *deck, const vs_coil *coil) {
  vs_text force = {0};
  vs_text_free(&deck->eva_lines);
  vs_text_free(&deck->eva_current);
  if (coil->square || !coil->law->netlist) return;
  coil->law->netlist(coil, "v(lam)", "v(z)", &deck->eva_lines, &deck->eva_current, &force);
  vs_text_free(&force);
}

/* True where the line has the word, in capitals or not. */
static bool has_word(const char *line, const char *word) {
  size_t n = strlen(word);
  for (const char *s = line; *s; s++) {
    bool begins = s == line || !(isalnum((unsigned char)s[-1]) || s[-1] == '_');
    if (begins && !strncasecmp(s, word, n) && !isalnum((unsigned char)s[n]) && s[n] != '_')
      return true;
  }
  return false;
}

vs_status vs_eva_check_names(const vs_deck *deck, const vs_coil *coil, vs_error *err) {
  const char *name = vs_deck_standard_names[VS_STANDARD_EVA_A];
  vs_where where = {0};
  if (coil->a_hm != 0) return VS_OK;
  for (size_t k = 0; k < deck->n_names && !where.file; k++)
    if (!strcasecmp(deck->names[k].name, name)) where = deck->names[k].where;
  for (size_t k = 0; k < deck->n_lines && !where.file; k++)
    if (has_word(deck->lines[k].text, name)) where = deck->lines[k].where;
  if (!where.file) return VS_OK;
  return vs_fail_at(
      err, where,
      "%s: the actuator's law %s has no a (a = L z/2 of a plain reluctance); leave it "
      "out, or take actuator.law reluctance",
      name, coil->law->name);
}

/* Adds a line of the file, with the law's texts in the place of the file's own. Returns how often
 * it took the law's current. */
static int add_line(const vs_deck *deck, const char *line, vs_text *out) {
  const char *at = strstr(line, CURRENT), *begins = strstr(line, BEGINS);
  if (deck->eva_current.text && !strncasecmp(line, ENDS, sizeof ENDS - 1) && deck->eva_lines.text)
    vs_text_add(out, "%s", deck->eva_lines.text);
  if (deck->eva_current.text && at)
    vs_text_add(out, "%.*s(%s)%s\n", (int)(at - line), line, deck->eva_current.text,
                at + sizeof CURRENT - 1);
  else if (deck->eva_flux_wb != 0 && begins)
    vs_text_add(out, "%.*s ic=%.17g%s\n", (int)(begins - line), line, deck->eva_flux_wb,
                begins + sizeof BEGINS - 1);
  else
    vs_text_add(out, "%s\n", line);
  return deck->eva_current.text && at ? 1 : 0;
}

vs_status vs_eva_write(const vs_deck *deck, vs_text *out, vs_error *err) {
  char path[VS_PATH_SIZE], *line = NULL;
  size_t size = 0;
  int taken = 0;
  const char *own = deck->eva_led ? "eva_led" : "eva";
  vs_status status =
      vs_path_find(&EVA_SHELF, deck->eva_file ? deck->eva_file : own, (vs_where){0}, path, err);
  if (status) return status;
  FILE *file = fopen(path, "r");
  if (!file) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
  while (getline(&line, &size, file) >= 0) {
    line[strcspn(line, "\r\n")] = '\0';
    if (*line && *line != '*') taken += add_line(deck, line, out);
  }
  free(line);
  fclose(file);
  if (deck->eva_current.text && !taken)
    return vs_fail(err, VS_INPUT, "%s: has no current '%s' for the law to take the place of", path,
                   CURRENT);
  return VS_OK;
}
