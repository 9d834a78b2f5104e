/* SPDX-License-Identifier: MIT
 * An engine, `vibrospice serve`, as a process: starting it, asking it, copying it, and its end. It
 * needs nothing but POSIX, as what hosts it may be anything: every request for memory is checked,
 * and no signal is taken. */
#ifndef VIBROSPICE_PROCESS_H
#define VIBROSPICE_PROCESS_H

#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

#include "vibrospice/vibrospice.h"

typedef struct vibrospice_process {
  int socket; /* -1: it has ended */
  pid_t pid;  /* 0: it is a copy, whose end nobody waits for */
  FILE *says; /* what it says on its standard error, for when it has died; NULL: nowhere */
} vibrospice_process;

/* Sets what vibrospice_error returns in this thread, and returns the status. */
vibrospice_status vibrospice_fail(vibrospice_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
vibrospice_status vibrospice_no_memory(void);

/* Starts an engine. program: its path; it finds its libraries in ../lib from there. NULL: the
 * program is looked for. To be ended also after an error. */
vibrospice_status vibrospice_process_start(vibrospice_process *p, const char *program);
/* Closes the socket, which ends the engine, and waits for that. */
void vibrospice_process_end(vibrospice_process *p);
/* The engine has ended by itself: returns the error that says how. */
vibrospice_status vibrospice_process_died(vibrospice_process *p);

/* Asks: so many bytes, then a text (NULL: none). beside: a descriptor to pass; -1: none. 0: the
 * engine has ended. */
int vibrospice_process_ask(int socket, uint32_t kind, const void *data, size_t size,
                           const char *more, int beside);
/* Takes an answer: *kind, and what follows as *text, to be freed, with an end behind it. An error
 * of the engine's becomes this one's, with *text NULL. */
vibrospice_status vibrospice_process_answer(vibrospice_process *p, uint32_t *kind, char **text,
                                            size_t *size);
/* Both, where no rows come between. text may be NULL: nobody wants what follows. */
vibrospice_status vibrospice_process_ask_for(vibrospice_process *p, uint32_t kind, const void *data,
                                             size_t size, const char *more, char **text);

/* Makes `to` a copy of the engine. */
vibrospice_status vibrospice_process_copy(vibrospice_process *of, vibrospice_process *to);

/* ---- handles.c, for the shim of mock-up units ---- */

/* As vibrospice_open, with the program at that path; NULL: as there. */
vibrospice_status vibrospice_open_by(const char *program, const char *scene, unsigned flags,
                                     vibrospice **run);
/* As vibrospice_run_to without rows. events: not 0, the run ends before t_s where the thyristor
 * fires or is extinct, or the armature meets or leaves a stop; vibrospice_time then says when. */
vibrospice_status vibrospice_run_to_event(vibrospice *run, double t_s, int events);

#endif
