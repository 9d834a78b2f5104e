/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "guide/completion.h"

#include <stdio.h>
#include <string.h>

static void print_bash(const vs_command *commands, size_t count) {
  puts("_vibrospice() {\n  local words");
  printf("  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    words=\"");
  for (size_t k = 0; k < count; k++) printf("%s%s", k ? " " : "", commands[k].name);
  puts("\"\n  else\n    case \"${COMP_WORDS[1]}\" in");
  for (size_t k = 0; k < count; k++) {
    printf("      %s) words=\"", commands[k].name);
    for (const struct argp_option *o = commands[k].options; o->name; o++)
      printf("%s--%s", o == commands[k].options ? "" : " ", o->name);
    puts("\" ;;");
  }
  puts("    esac\n  fi\n"
       "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n"
       "complete -o default -F _vibrospice vibrospice");
}

/* In single quotes, in which fish reads \' and \\ alone. */
static void print_quoted(const char *text) {
  putchar('\'');
  for (; *text; text++) printf("%s%c", *text == '\'' || *text == '\\' ? "\\" : "", *text);
  putchar('\'');
}

static void print_fish(const vs_command *commands, size_t count) {
  for (size_t k = 0; k < count; k++) {
    printf("complete -c vibrospice -n __fish_use_subcommand -f -a %s -d ", commands[k].name);
    print_quoted(commands[k].text);
    putchar('\n');
    for (const struct argp_option *o = commands[k].options; o->name; o++) {
      printf("complete -c vibrospice -n '__fish_seen_subcommand_from %s' -l %s%s -d ",
             commands[k].name, o->name, o->arg ? " -r" : "");
      print_quoted(o->doc);
      putchar('\n');
    }
  }
}

vs_status vs_completion_print(const char *shell, const vs_command *commands, size_t count,
                              vs_error *err) {
  static const struct {
    const char *name;
    void (*print)(const vs_command *commands, size_t count);
  } SHELLS[] = {{"bash", print_bash}, {"fish", print_fish}};
  for (size_t k = 0; k < sizeof SHELLS / sizeof *SHELLS; k++)
    if (!strcmp(SHELLS[k].name, shell)) return SHELLS[k].print(commands, count), VS_OK;
  return vs_fail(err, VS_INPUT, "completion: no shell '%s'; there are: bash, fish", shell);
}
