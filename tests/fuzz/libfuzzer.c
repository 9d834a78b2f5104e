/* SPDX-License-Identifier: GPL-3.0-or-later
 * libFuzzer's side of a target: a program for each, which is compiled with its name, VS_FUZZ. */
#include <string.h>

#include "targets.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define TARGET JOIN(fuzz_, VS_FUZZ)

/* libFuzzer's own. */
size_t LLVMFuzzerMutate(uint8_t *bytes, size_t size, size_t most);
int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed);

int LLVMFuzzerInitialize(int *argc, char ***argv) {
  (void)argc, (void)argv;
  fuzz_begin();
  return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
  fuzz_take(&TARGET, bytes, size);
  return 0;
}

/* Half of the changes are libFuzzer's: bytes, and words of the dictionary. One in sixteen is left
 * as it is, so that wrong sums are tried as well. */
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t most, unsigned seed) {
  char *text = (char *)bytes;
  if (TARGET.grammar && seed % 2)
    size = fuzz_grammar_change(TARGET.grammar, text, size, most, seed / 2);
  else
    size = LLVMFuzzerMutate(bytes, size, most);
  if (TARGET.mend && seed % 16) size = TARGET.mend(text, size, most);
  return size;
}
