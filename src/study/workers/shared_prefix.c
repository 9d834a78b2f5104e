/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/shared_prefix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/pace.h"
#include "netlist/netlist.h"
#include "ngspice/child.h"
#include "workers/divergence.h"

/* What becomes of a task: it waits for a prefix, has one, is to be run on its own, is answered. */
typedef enum task_state { WAITS, SHARES, OWN, DONE } task_state;

struct vs_shared_prefix {
  const vs_plan *plan;
  vs_case *prefix; /* the one that is run */
  vs_case *other;  /* begun, never run on tier circuit: the case that is compared with the prefix */
  vs_task_pipe *desk;
  vs_fork_point fork;
  double point[VS_PLAN_AXES]; /* of the prefix; the axes of events do not count */
  char **netlist;             /* of the prefix, as its solver has it */
  size_t lines;
  vs_pace pace;  /* of its run */
  double next_s; /* when this process has something to do next */
  void (*arrive)(vs_shared_prefix *past, double t_s); /* what it does there */
  vs_child_copy self;                                 /* of a runner or a branch */
  bool branch;                                        /* this process is one */
  bool over;                                          /* the prefix is not needed any more */
  task_state states[VS_TASK_PIPE_MOST];               /* of the desk's tasks */
  double parts_s[VS_TASK_PIPE_MOST];                  /* where such a task parts from the prefix */
  vs_text row;    /* of the run that begins with the prefix: in a branch it is a case's */
  vs_text answer; /* of a case without a circuit */
};

static const char EVENTS[] = "events.";

static bool is_of_events(const vs_axis *axis) {
  return !strncmp(axis->section, EVENTS, sizeof EVENTS - 1);
}

static bool is_threat(const vs_axis *axis) {
  return !strcmp(axis->key, "threat");
}

bool vs_shared_prefix_applies(const vs_plan *plan) {
  bool varied = false;
  for (size_t k = 0; k < plan->n_axes; k++) varied = varied || is_of_events(&plan->axes[k]);
  return varied && !plan->periods && !plan->derivatives && plan->first->tier->has_circuit;
}

/* ---- what is alike ---- */

/* Of threats the first axis has their names for words (study/method/threat_cases.c). */
static bool is_varied(const vs_plan *plan, const vs_scene_event *e) {
  for (size_t k = 0; k < plan->n_axes; k++) {
    const vs_axis *axis = &plan->axes[k];
    if (is_of_events(axis) && !strcmp(axis->section + sizeof EVENTS - 1, e->name)) return true;
    for (size_t w = 0; is_threat(axis) && w < axis->n_words; w++)
      if (!strcmp(axis->word[w], e->name)) return true;
  }
  return false;
}

static bool same_point(const vs_shared_prefix *p, const double *point) {
  for (size_t k = 0; k < p->plan->n_axes; k++)
    if (!is_of_events(&p->plan->axes[k]) && point[k] != p->point[k]) return false;
  return true;
}

static bool same_pace(const vs_pace *a, const vs_pace *b) {
  return a->max_step_s == b->max_step_s && a->relative == b->relative &&
         a->current_a == b->current_a && a->voltage_v == b->voltage_v &&
         a->charge_c == b->charge_c && a->truncation == b->truncation;
}

static bool make_netlist(const vs_setup *s, char ***lines, size_t *count) {
  vs_deck_value standard[VS_STANDARD];
  vs_error err = {0};
  vs_setup_standard(s, standard);
  return !vs_netlist_make(&s->deck, &s->circuit_values, standard, VS_STANDARD, lines, count, &err);
}

static bool same_netlist(const vs_shared_prefix *p, const vs_setup *s) {
  char **lines = NULL;
  size_t count = 0;
  bool same = make_netlist(s, &lines, &count) && count == p->lines;
  for (size_t k = 0; k < count && same; k++) same = !strcmp(lines[k], p->netlist[k]);
  vs_netlist_free(lines, count);
  return same;
}

/* One event of two cases: its accounts have its name, and what is kept of the heat of a run depends
 * on how often that comes. */
static bool same_account(const vs_scene_event *a, const vs_scene_event *b) {
  return !strcmp(a->name, b->name) && a->v.times == b->v.times && a->v.every_s == b->v.every_s;
}

/* What the events have put into the deck besides the netlist: its sources and its accounts. */
static bool same_wiring(const vs_setup *a, const vs_setup *b) {
  const vs_events *own = &a->timeline.events, *their = &b->timeline.events;
  bool same = own->count == their->count && a->deck.n_ports == b->deck.n_ports &&
              isinf(vs_setup_jams(a)) == isinf(vs_setup_jams(b)) &&
              a->model.reloaded == b->model.reloaded;
  for (size_t k = 0; k < own->count && same; k++)
    same = same_account(&own->item[k], &their->item[k]);
  for (size_t k = 0; k < a->deck.n_ports && same; k++) {
    const vs_signal *s = &a->deck.ports[k].signal, *t = &b->deck.ports[k].signal;
    same = s->drive == t->drive && s->event == t->event && s->shift_rad == t->shift_rad;
  }
  return same;
}

/* Does the case that `other` has begun make the prefix's run, but for its events? */
static bool is_alike(const vs_shared_prefix *p, const double *point) {
  const vs_scene *a = vs_case_scene(p->prefix), *b = vs_case_scene(p->other);
  return same_point(p, point) && a->tier == b->tier && same_wiring(&a->setup, &b->setup) &&
         same_netlist(p, &b->setup);
}

/* ---- a batch of tasks ---- */

/* Begins task k as `other`. Where it needs no circuit it is run and answered here. */
static bool begin_other(vs_shared_prefix *p, size_t k) {
  const vs_task *task = &p->desk->tasks[k];
  vs_error err = {0};
  vs_status begun = vs_case_begin(p->other, task->index, task->point, &err);
  if (!begun && vs_case_scene(p->other)->tier->has_circuit) return true;
  bool circuit;
  p->answer.length = 0;
  int status = vs_case_end(p->other, begun, &p->answer, &circuit, &err);
  const vs_task_pipe_head head = {task->index, p->answer.length, status, circuit, 0, 0};
  vs_task_pipe_answer(p->desk, &head, p->answer.text);
  p->states[k] = DONE;
  return false;
}

/* Finds out whether the run of task k begins as the prefix does, and up to when. Only a run with a
 * settling (`start: steady`) has something to share where the two part at t = 0 already. */
static void compare_task(vs_shared_prefix *p, size_t k) {
  if (!begin_other(p, k) || !is_alike(p, p->desk->tasks[k].point)) return;
  const vs_setup *own = &vs_case_scene(p->prefix)->setup;
  vs_setup *their = &vs_case_scene(p->other)->setup;
  const vs_events events = their->timeline.events;
  their->timeline = own->timeline; /* an orbit may have set when it is fired first */
  their->timeline.events = events;
  p->parts_s[k] = vs_divergence_of(own, their);
  bool past = p->parts_s[k] > 0 || own->steady;
  p->states[k] = past && isfinite(p->parts_s[k]) ? SHARES : OWN;
}

static void compare_tasks(vs_shared_prefix *p) {
  for (size_t k = 0; k < p->desk->count; k++)
    if (p->states[k] == WAITS) compare_task(p, k);
}

static size_t count_tasks(const vs_shared_prefix *p, task_state which) {
  size_t n = 0;
  for (size_t k = 0; k < p->desk->count; k++) n += p->states[k] == which;
  return n;
}

static double first_parting(const vs_shared_prefix *p) {
  double first_s = INFINITY;
  for (size_t k = 0; k < p->desk->count; k++)
    if (p->states[k] == SHARES) first_s = fmin(first_s, p->parts_s[k]);
  return first_s;
}

static void wait_for_all(vs_shared_prefix *p) {
  for (size_t k = 0; k < p->desk->count; k++) p->states[k] = WAITS;
}

/* ---- a branch ---- */

static void stay_in_branch(vs_shared_prefix *p, double t_s) {
  (void)p, (void)t_s;
}

/* This process is a copy now, whose run is that of task k. */
static void become_branch(vs_shared_prefix *p, size_t k) {
  const vs_task *task = &p->desk->tasks[k];
  vs_error err = {0};
  p->branch = true;
  p->next_s = INFINITY;
  p->arrive = stay_in_branch;
  if (vs_case_begin(p->other, task->index, task->point, &err)) _exit(VS_CHILD_BAD_RUN);
  if (vs_case_become(p->prefix, p->other)) _exit(VS_CHILD_BAD_RUN);
  const vs_pace pace = vs_pace_of(&vs_case_scene(p->prefix)->setup);
  if (!same_pace(&pace, &p->pace)) _exit(VS_CHILD_BAD_RUN); /* it would have taken other steps */
}

static _Noreturn void end_branch(const vs_shared_prefix *p, int status) {
  const vs_task_pipe_head head = {0, p->row.length, status, 0, 1, 0};
  if (!vs_child_say(&p->self, &head, sizeof head)) _exit(VS_CHILD_BAD_RUN);
  vs_child_tell(&p->self, p->row.text, p->row.length);
}

/* ---- the runner ---- */

/* Passes on what a branch tells, if it comes to its end. */
static void pass_on(vs_shared_prefix *p, const vs_child_copy *branch, uint64_t index) {
  vs_task_pipe_head head = {0};
  vs_error err = {0};
  bool begun = vs_child_listen(branch, &head, sizeof head);
  char *row = vs_alloc(head.length + 1, 1);
  bool whole = !vs_child_hear(branch, row, begun ? head.length : 0, &err) && begun;
  head.index = index;
  if (whole &&
      !(vs_child_say(&p->self, &head, sizeof head) && vs_child_say(&p->self, row, head.length)))
    _exit(VS_CHILD_BAD_RUN);
  free(row);
}

/* At the knot t_s: sends a branch for each task that parts from the prefix here, one after the
 * other. In the branch it returns at once. */
static void fork_branches(vs_shared_prefix *p, double t_s) {
  for (size_t k = 0; k < p->desk->count; k++) {
    if (p->states[k] != SHARES || p->parts_s[k] > t_s + vs_divergence_near_s) continue;
    vs_error err = {0};
    vs_child_copy branch;
    p->states[k] = OWN;
    if (p->parts_s[k] < t_s - vs_divergence_near_s) continue; /* its knot was passed over */
    if (vs_child_fork(&branch, &err)) continue;
    if (branch.pid == 0) {
      close(p->self.pipe_end);
      p->self = branch;
      become_branch(p, k);
      return;
    }
    pass_on(p, &branch, p->desk->tasks[k].index);
  }
  p->next_s = first_parting(p);
  if (isinf(p->next_s)) _exit(VS_CHILD_GOOD);
}

/* ---- the worker ---- */

/* Answers the cases whose rows the runner passes on. Tasks of which it says nothing are to be run
 * on their own. */
static void hear_runner(vs_shared_prefix *p, const vs_child_copy *runner) {
  vs_task_pipe_head head;
  while (vs_child_listen(runner, &head, sizeof head)) {
    char *row = vs_alloc(head.length + 1, 1);
    bool whole = vs_child_listen(runner, row, head.length);
    for (size_t k = 0; k < p->desk->count && whole; k++)
      if (p->desk->tasks[k].index == head.index) p->states[k] = DONE;
    if (whole) vs_task_pipe_answer(p->desk, &head, row);
    if (count_tasks(p, SHARES))
      vs_task_pipe_deliver(p->desk); /* the last one once the runner has ended */
    free(row);
  }
  vs_child_end_of(runner);
  vs_task_pipe_deliver(p->desk);
}

/* Forks a runner for the tasks that share the prefix. In the runner it returns true. */
static bool fork_runner(vs_shared_prefix *p, double t_s) {
  vs_error err = {0};
  vs_child_copy runner;
  if (!count_tasks(p, SHARES) || vs_child_fork(&runner, &err)) return false;
  if (runner.pid == 0) {
    p->self = runner;
    p->arrive = fork_branches;
    fork_branches(p, t_s);
    return true;
  }
  hear_runner(p, &runner);
  return false;
}

/* At the knot where the worker stays: serves batch after batch, until one has a task that this
 * prefix is of no use for. */
static void serve_at_knot(vs_shared_prefix *p, double t_s) {
  p->pace = vs_pace_of(&vs_case_scene(p->prefix)->setup);
  for (;;) {
    if (fork_runner(p, t_s)) return;
    for (size_t k = 0; k < p->desk->count; k++)
      if (p->states[k] == SHARES) p->states[k] = OWN;
    p->over = count_tasks(p, DONE) < p->desk->count;
    if (p->over) return;
    vs_task_pipe_deliver(p->desk);
    vs_task_pipe_wait(p->desk);
    wait_for_all(p);
    compare_tasks(p);
    for (size_t k = 0; k < p->desk->count; k++)
      if (p->states[k] == SHARES && p->parts_s[k] < t_s - vs_divergence_near_s)
        p->states[k] = WAITS;
  }
}

static vs_status reach_knot(void *ctx, double t_s, vs_error *err) {
  vs_shared_prefix *p = ctx;
  if (t_s < p->next_s - vs_divergence_near_s) return VS_OK;
  p->arrive(p, t_s);
  return p->over ? vs_fail(err, VS_RUN, "t = %.9g s: the trunk is left", t_s) : VS_OK;
}

/* Turns the scene of the prefix into one in which the varied events never begin. It is not
 * run again where ngspice gives up: then each case is, with what its scene says. False: that cannot
 * be. */
static bool put_varied_events_off(vs_shared_prefix *p) {
  vs_setup *s = &vs_case_scene(p->prefix)->setup;
  vs_events *events = &s->timeline.events;
  vs_error err = {0};
  if (vs_case_scene(p->prefix)->control.regulator)
    return false; /* it would decide for one of them */
  for (size_t k = 0; k < events->count; k++)
    if (is_varied(p->plan, &events->item[k])) vs_scene_event_put_off(&events->item[k], k);
  s->run.ladder = VS_LADDER_STAY;
  s->run.verify = VS_VERIFY_NEVER;
  return !vs_setup_make_loads(events, s->machine, &s->model, &s->loads, &err);
}

/* Begins a prefix with the keys of task k. False: no task shares it. */
static bool begin_prefix(vs_shared_prefix *p, size_t k) {
  const vs_task *task = &p->desk->tasks[k];
  vs_error err = {0};
  if (!begin_other(p, k) || vs_case_begin(p->prefix, task->index, task->point, &err)) return false;
  if (!put_varied_events_off(p)) return false;
  const vs_setup *setup = &vs_case_scene(p->prefix)->setup;
  memcpy(p->point, task->point, sizeof p->point);
  vs_netlist_free(p->netlist, p->lines);
  p->netlist = NULL;
  p->lines = 0;
  if (!make_netlist(setup, &p->netlist, &p->lines)) return false;
  compare_tasks(p);
  return count_tasks(p, SHARES) > 0;
}

/* Runs the prefix, and from it all tasks that share it. */
static void run_prefix(vs_shared_prefix *p) {
  vs_error err = {0};
  vs_scene *s = vs_case_scene(p->prefix);
  bool circuit;
  vs_task_pipe_deliver(p->desk);
  p->over = false;
  p->next_s = first_parting(p);
  p->arrive = serve_at_knot;
  p->row.length = 0;
  s->order.fork = &p->fork;
  int status = vs_case_end(p->prefix, VS_OK, &p->row, &circuit, &err);
  s->order.fork = NULL;
  if (p->branch) end_branch(p, status);
  if (p->arrive == fork_branches)
    _exit(VS_CHILD_BAD_RUN); /* a runner whose prefix ended too early */
}

void vs_shared_prefix_run(vs_shared_prefix *p) {
  wait_for_all(p);
  for (size_t k; (k = 0, count_tasks(p, WAITS));) {
    while (p->states[k] != WAITS) k++;
    bool shares = begin_prefix(p, k);
    if (p->states[k] == WAITS) p->states[k] = OWN;
    if (shares) run_prefix(p);
    for (k = 0; k < p->desk->count; k++) {
      if (p->states[k] != SHARES && p->states[k] != OWN) continue;
      p->states[k] = DONE;
      vs_task_pipe_run(p->desk, p->prefix, k);
    }
  }
}

vs_shared_prefix *vs_shared_prefix_new(const vs_plan *plan, vs_case *c, vs_task_pipe *desk) {
  vs_shared_prefix *p = vs_alloc(1, sizeof *p);
  *p =
      (vs_shared_prefix){.plan = plan, .prefix = c, .desk = desk, .other = vs_case_new(plan, NULL)};
  p->fork = (vs_fork_point){p, reach_knot};
  return p;
}
