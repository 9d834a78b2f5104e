/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `completion`: what a shell needs to complete commands and their options. */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "options.h"

/* True if the option's value is one of a few words, which its argument lists: "csv|npy", "json".
 * Other arguments are in capitals. */
static bool has_words(const vs_option *o) {
  return o->value && !strpbrk(o->value, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
}

/* Prints them with blanks between them. */
static void print_words(const vs_option *o) {
  for (const char *s = o->value; *s; s++) putchar(*s == '|' ? ' ' : *s);
}

/* Behind an option whose value is one of a few words, these take the place of the options. */
static void print_bash_words(const vs_option *options) {
  bool any = false;
  for (const vs_option *o = options; o->name; o++) any = any || has_words(o);
  if (!any) return;
  printf("\n        case \"${COMP_WORDS[COMP_CWORD-1]}\" in");
  for (const vs_option *o = options; o->name; o++) {
    if (!has_words(o)) continue;
    printf(" --%s) words=\"", o->name);
    print_words(o);
    printf("\" ;;");
  }
  printf(" esac");
}

static void print_bash(const vs_command *const *commands) {
  puts("_vibrospice() {\n  local words");
  printf("  if [ \"$COMP_CWORD\" -eq 1 ]; then\n    words=\"");
  for (size_t k = 0; commands[k]; k++) printf("%s%s", k ? " " : "", commands[k]->name);
  puts("\"\n  else\n    case \"${COMP_WORDS[1]}\" in");
  for (size_t k = 0; commands[k]; k++) {
    printf("      %s) words=\"", commands[k]->name);
    for (const vs_option *o = commands[k]->options; o->name; o++)
      printf("%s--%s", o == commands[k]->options ? "" : " ", o->name);
    printf("\"");
    print_bash_words(commands[k]->options);
    puts(" ;;");
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

static void print_fish(const vs_command *const *commands) {
  for (size_t k = 0; commands[k]; k++) {
    printf("complete -c vibrospice -n __fish_use_subcommand -f -a %s -d ", commands[k]->name);
    print_quoted(commands[k]->text);
    putchar('\n');
    for (const vs_option *o = commands[k]->options; o->name; o++) {
      printf("complete -c vibrospice -n '__fish_seen_subcommand_from %s' -l %s%s",
             commands[k]->name, o->name, o->value ? " -r" : "");
      if (has_words(o)) {
        printf(" -f -a '");
        print_words(o);
        putchar('\'');
      }
      printf(" -d ");
      print_quoted(o->text);
      putchar('\n');
    }
  }
}

/* In single quotes as zsh reads them, without what its completion takes for syntax. */
static void print_plain(const char *before, const char *text, const char *after) {
  printf("%s", before);
  for (; *text; text++) printf("%s", strchr("[]:'\\", *text) ? " " : (char[]){*text, 0});
  printf("%s", after);
}

static void print_zsh(const vs_command *const *commands) {
  puts("#compdef vibrospice\n_vibrospice() {\n  local -a commands\n  commands=(");
  for (size_t k = 0; commands[k]; k++) {
    printf("    '%s:", commands[k]->name);
    print_plain("", commands[k]->text, "'\n");
  }
  puts("  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n"
       "  case $words[2] in");
  for (size_t k = 0; commands[k]; k++) {
    printf("    %s) _arguments", commands[k]->name);
    for (const vs_option *o = commands[k]->options; o->name; o++) {
      printf(" '--%s", o->name);
      print_plain("[", o->text, o->value ? "]:" : "]'");
      if (has_words(o)) {
        printf("%s:(", o->name);
        print_words(o);
        printf(")'");
      } else if (o->value)
        print_plain("", o->value, ":_files'");
    }
    puts(" '*:file:_files' ;;");
  }
  puts("  esac\n}\n_vibrospice \"$@\"");
}

static vs_status completion_command(const void *given, vs_error *err) {
  static const struct {
    const char *name;
    void (*print)(const vs_command *const *commands);
  } SHELLS[] = {{"bash", print_bash}, {"fish", print_fish}, {"zsh", print_zsh}};
  const vs_arguments *a = given;
  const char *shell = vs_command_name(a);
  for (size_t k = 0; k < sizeof SHELLS / sizeof *SHELLS; k++)
    if (!strcmp(SHELLS[k].name, shell)) return SHELLS[k].print(a->commands), VS_OK;
  return vs_fail(err, VS_INPUT, "completion: no shell '%s'; there are: bash, fish, zsh", shell);
}

static const vs_option COMPLETION_OPTIONS[] = {VS_OPTIONS_END};

const vs_command vs_completion_cli = {
    .name = "completion",
    .argument = "SHELL",
    .text = "prints what bash, fish or zsh needs to complete commands and options",
    .examples = "  vibrospice completion bash > vibrospice.bash\n",
    .options = COMPLETION_OPTIONS,
    .size = sizeof(vs_arguments),
    .run = completion_command};
