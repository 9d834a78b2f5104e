/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/powers.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

/* The call of pow, or in PSpice's dialect of what is made of it; its bytes up to the base, 0: none.
 */
static size_t call_at(const char *at, bool pspice) {
  static const char *const NAMES[] = {"pow(", "pwr(", "pwrs("};
  for (size_t k = 0; k < (pspice ? 3 : 1); k++)
    if (!strncasecmp(at, NAMES[k], strlen(NAMES[k]))) return strlen(NAMES[k]);
  return 0;
}

/* The base is what a function of no negative value gives. */
static bool is_safe_base(const char *at) {
  at += strspn(at, " \t");
  return !strncasecmp(at, "abs(", 4) || !strncasecmp(at, "max(", 4);
}

/* The exponent is 2 or 4. */
static bool is_even(const char *at) {
  at += strspn(at, " \t*^");
  return (*at == '2' || *at == '4') && !isalnum((unsigned char)at[1]) && at[1] != '.';
}

bool vs_powers_differ(const char *line, bool pspice) {
  int depth = 0;
  if (!*line || !strchr("bBeEgG", *line)) return false;
  for (const char *at = line + 1; *at; at++) {
    if (*at == '{') depth++;
    if (*at == '}') depth--;
    if (depth > 0) continue;
    size_t call = isalnum((unsigned char)at[-1]) ? 0 : call_at(at, pspice);
    if (call && !is_safe_base(at + call)) return true;
    bool power = *at == '^' || (*at == '*' && at[1] == '*');
    if (power && !is_even(at)) return true;
    if (power) at += strspn(at, "*^") - 1;
  }
  return false;
}
