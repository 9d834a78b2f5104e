/* SPDX-License-Identifier: GPL-3.0-or-later
 * libFuzzer's side of the targets: one program, which is linked once. Its name fuzz_NAME, by which
 * a link leads to it, says which target it is. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "targets.h"

static const fuzz_target *const TARGETS[] = {
#define ROW(name) &fuzz_##name,
    VS_FUZZ_TARGETS(ROW)
#undef ROW
};

static const fuzz_target *target;

/* libFuzzer's own. */
size_t LLVMFuzzerMutate(uint8_t *bytes, size_t size, size_t most);
int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed);

int LLVMFuzzerInitialize(int *argc, char ***argv) {
  (void)argc;
  const char *file = strrchr(**argv, '/'), *name = file ? file + 1 : **argv;
  for (size_t k = 0; k < sizeof TARGETS / sizeof *TARGETS; k++)
    if (!strncmp(name, "fuzz_", 5) && !strcmp(name + 5, TARGETS[k]->name)) target = TARGETS[k];
  if (!target) {
    fprintf(stderr, "%s: no target has this name\n", **argv);
    exit(1);
  }
  fuzz_begin();
  return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
  fuzz_take(target, bytes, size);
  return 0;
}

/* Half of the changes are libFuzzer's: bytes, and words of the dictionary. One in sixteen is left
 * as it is, so that wrong sums are tried as well. */
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed) {
  char *text = (char *)bytes;
  if (target->grammar && seed % 2)
    size = fuzz_grammar_change(target->grammar, text, size, most, seed / 2);
  else
    size = LLVMFuzzerMutate(bytes, size, most);
  if (target->mend && seed % 16) size = target->mend(text, size, most);
  return size;
}
