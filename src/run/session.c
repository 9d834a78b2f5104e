/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of one scene. The first functions tell it from top to bottom, and everything else in the
 * file is a part of one of them:
 *
 *   vs_session_run       the scene as it is, then with the settings of rung after rung of the
 *                        ladder, until one attempt runs to its end
 *   vs_session_attempt   one attempt: scene, watchers, tier, result
 *   vs_session_finish    a second run, for the errors of the margins
 *
 * What is before it: vs_scene_read (run/scene.c) reads the scene's text, has its setup built
 * (engine/setup.c) and its tier chosen (run/tier_choice.c). The commands `run` and `study` call
 * vs_steady_run (orbit/steady.c) in the place of vs_session_run: it does the same, but finds the
 * scene's orbit and the share of its load that rides before each attempt, where the scene asks for
 * these. After it the verdict becomes an exit code (vs_session_judge, below), a table (run/show.c)
 * and summary.json (run/summary.c). */
#include "run/session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/units.h"
#include "run/listed_measure.h"

/* One attempt at the run, which the parts below are shown. */
typedef struct attempt {
  const vs_session *session;
  vs_scene *scene;
  vs_result *result;
} attempt;

static vs_status refuse_orbit(const vs_scene *scene, vs_error *err);
static bool wants_second(const vs_session *session, const vs_result *r);
static void run_second(const vs_session *session, vs_result *r);
static bool is_alone(const vs_session *session, const vs_scene *s);
static void begin_watching(const vs_session *session, vs_scene *s, vs_result *r, bool alone);
static vs_status run_tier(attempt *a, bool alone, vs_error *err);
static vs_status close_books(vs_result *r, double tolerance, vs_error *err);

/* ---- the story ---- */

vs_status vs_session_run(const vs_session *session, vs_scene *scene, vs_result *r, vs_error *err) {
  vs_status status = vs_session_begin(session, scene, r, err);
  vs_scene *now = status ? NULL : scene;
  /* Where the solver gives up, the scene of the next rung takes this one's place. */
  for (; now; now = vs_session_climb(session, scene, status, r, err)) {
    status = refuse_orbit(now, err);
    if (!status) status = vs_session_attempt(session, now, r, err);
  }
  return vs_session_finish(session, status, scene, r);
}

vs_status vs_session_begin(const vs_session *session, const vs_scene *scene, vs_result *r,
                           vs_error *err) {
  *r = (vs_result){.scene = scene};
  /* Code of the user's own, as a law of control, runs only where the command line allows it. */
  return vs_control_allow(&scene->control, scene->allow_code || session->bare, err);
}

vs_status vs_session_attempt(const vs_session *session, vs_scene *s, vs_result *r, vs_error *err) {
  attempt a = {session, s, r};
  const vs_session_listener *guest = session->guest;

  /* The scene. Its guest, as the command `run` with its files, may still change what is ordered. */
  r->scene = s;
  r->steps = 0;
  vs_status status = guest && guest->begin ? guest->begin(guest->ctx, s, err) : VS_OK;
  if (status) return status;

  /* The watchers, who will be shown each accepted step. */
  const bool alone = is_alone(session, s);
  begin_watching(session, s, r, alone);

  /* The tier, which owns time from the scene's start to run.until. */
  status = run_tier(&a, alone, err);
  if (status || session->bare) return status;

  /* The result: measures and verdict of what the watchers have seen, and the books of energy. */
  vs_result_finish(r);
  return close_books(r, s->setup.run.tolerance, err);
}

vs_status vs_session_finish(const vs_session *session, vs_status status, vs_scene *scene,
                            vs_result *r) {
  if (status) return status;
  if (scene->tier->has_circuit) scene->order.tried = true; /* until another deck is read */

  /* The same scene at another tolerance: how far the two differ is the error of each margin. */
  if (wants_second(session, r)) run_second(session, r);
  return VS_OK;
}

/* ---- one attempt: its parts ---- */

/* Takes one accepted step of the tier: each who looks at the run is shown it, in this order. The
 * control may decide the next firing by it. */
static vs_status accept_step_of_run(void *ctx, const vs_step *step, vs_error *err) {
  const attempt *a = ctx;
  const vs_session_listener *guest = a->session->guest;
  vs_result *r = a->result;
  r->steps++;
  if (!a->session->bare) vs_watchers_accept(&r->watchers, step);
  vs_status status = guest && guest->accept ? guest->accept(guest->ctx, step, r, err) : VS_OK;
  if (!status && r->loop) status = vs_loop_accept(r->loop, step, err);
  for (int k = 0; r->meters && k < r->scene->instruments.count && !status; k++)
    vs_meter_accept(&r->meters[k], step);
  for (int k = 0; k < r->n_quality; k++) vs_quality_accept(&r->quality[k], step);
  if (!status && a->session->stop && *a->session->stop)
    return vs_fail(err, VS_SIGNAL, "t = %.9g s: stopped by a signal", step->to->t_s);
  return status;
}

/* Asked where the machine swings freely from now on: true ends the run there. */
static bool may_leave_rest(void *ctx, const vs_swing_rest *rest) {
  const attempt *a = ctx;
  return vs_watchers_may_end_early(&a->result->watchers, rest, a->session->wants);
}

/* True if nobody but the watchers looks at the run, and these need not see all of it. */
static bool is_alone(const vs_session *session, const vs_scene *s) {
  return session->wants && !session->bare && !session->guest && !s->instruments.count &&
         !s->quality.count && !s->ratings.count && !s->control.regulator && !s->order.pilot;
}

static double clock_s(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The balances of the machine and of the coil are the program's own: where one leaves more than
 * this multiple of what is warned of, the numbers of the run mean nothing. The balance of the
 * circuit rests on the deck's lines too, of which some may be missing. Whatever is missing, it
 * cannot leave more than all the energy there was. */
static const double MOST_OPEN = 100;

static bool is_an_event(const vs_events *events, const char *name) {
  for (size_t k = 0; k < events->count; k++)
    if (!strcmp(events->item[k].name, name)) return true;
  return false;
}

/* The energy there was, J: that of the books, and what events have brought. */
static double energy_there(const vs_energy *e) {
  double brought = 0;
  for (size_t k = 0; e->frame->deck && k < e->frame->deck->losses.count; k++)
    if (is_an_event(&e->frame->timeline->events, e->frame->deck->losses.item[k].name))
      brought += fabs(e->loss_j[k]);
  return vs_energy_whole(e) + brought;
}

/* True: the deck's loss and store lines speak of the circuit that is run. A deck without the port
 * mains has a source that the books do not know, and the loss of an element that an event opens or
 * shorts is no longer what its line says. */
static bool has_whole_books(const vs_frame *frame) {
  const vs_deck *deck = frame->deck;
  const vs_events *events = &frame->timeline->events;
  bool mains = !deck;
  for (size_t k = 0; deck && k < deck->n_ports; k++)
    mains = mains || deck->ports[k].signal.drive == VS_PORT_MAINS;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->element) return false;
  return mains;
}

/* Notes what the energy audit finds. Error: VS_RUN, the books are open beyond all meaning. */
static vs_status close_books(vs_result *r, double tolerance, vs_error *err) {
  const vs_energy *e = &r->watchers.energy;
  vs_energy_open(e, tolerance, r->books, sizeof r->books);
  double whole = energy_there(e), own = fmin(MOST_OPEN * VS_ENERGY_ALLOWED * tolerance, 1);
  for (int b = 0; b < VS_BALANCES; b++) {
    double most = (b == VS_B_CIRCUIT ? 1 : own) * whole;
    if (b == VS_B_CIRCUIT && !has_whole_books(e->frame)) continue;
    if (whole > 0 && e->balanced[b] && fabs(e->furthest_j[b]) > most)
      return vs_fail(err, VS_RUN,
                     "t = %.9g s: the energy books (%s) leave %.3g J, with %.3g J in all; so far "
                     "off the numbers mean nothing",
                     e->furthest_s[b], vs_energy_balance_names[b], e->furthest_j[b], whole);
  }
  return VS_OK;
}

/* Begins the scene's instruments anew. */
static void begin_instruments(const vs_session *session, const vs_scene *s, vs_result *r) {
  const vs_instruments *all = &s->instruments;
  free(r->meters);
  r->meters = NULL;
  if (session->bare || !all->count) return;
  r->meters = vs_alloc((size_t)all->count, sizeof *r->meters);
  for (int k = 0; k < all->count; k++) vs_meter_begin(&r->meters[k], &all->item[k], all->v.seed);
}

/* Begins the scene's control anew, which then decides when the setup's thyristors fire. The circuit
 * is not left in such a run, as nobody knows when the next firing comes. */
static vs_status begin_control(const vs_session *session, vs_scene *s, vs_result *r,
                               vs_error *err) {
  vs_result_end_loop(r);
  s->setup.timeline.program = NULL;
  if (!s->control.regulator || session->bare) return VS_OK;
  r->loop = vs_alloc(1, sizeof *r->loop);
  s->order.stand_in = NULL;
  s->setup.timeline.program = &r->loop->program;
  return vs_loop_begin(r->loop, &s->control, &s->setup, &s->instruments, r->meters, err);
}

/* Begins all that looks at the steps: watchers, instruments, ratings of probes, the quality of
 * currents. alone: nobody but the watchers will look, so that these need only see what is wanted.
 */
static void begin_watching(const vs_session *session, vs_scene *s, vs_result *r, bool alone) {
  const vs_session_listener *guest = session->guest;
  if (!session->bare) vs_watchers_begin(&r->watchers, &s->frame, alone ? session->wants : NULL);
  s->order.warming = session->bare ? NULL : vs_watchers_warm(&r->watchers, &s->setup);
  r->watchers.prompt =
      (guest && guest->accept && !guest->late) || s->control.regulator || s->order.fork;
  begin_instruments(session, s, r);
  if (!session->bare) vs_ratings_follow(&s->ratings, r->watchers.measures);
  if (!session->bare) vs_result_begin_quality(r, s);
}

/* Lets the tier run from the scene's start to run.until. Where a pilot brings the machine to its
 * orbit first, the instruments' low-passes go along, and the start that it has found becomes the
 * scene's. */
static vs_status run_tier(attempt *a, bool alone, vs_error *err) {
  const vs_session *session = a->session;
  vs_result *r = a->result;
  vs_scene *s = a->scene;
  const vs_observer observer = {a, accept_step_of_run};
  const vs_early_end early_end = {a, may_leave_rest};
  vs_orbit_search *pilot = s->order.pilot;
  vs_meter_pilot metered;
  s->order.stop = session->stop;
  s->order.early_end = alone ? &early_end : NULL;
  if (pilot && r->meters) {
    vs_meter_pilot_begin(&metered, pilot, &s->instruments, r->meters);
    s->order.pilot = &metered.pilot;
  }
  double began_s = clock_s(CLOCK_MONOTONIC);
  vs_status status = begin_control(session, s, r, err);
  if (!status)
    status = session->unguarded ? s->tier->run(&s->setup, &s->order, &observer, err)
                                : vs_sim_run(s->tier, &s->setup, &s->order, &observer, err);
  if (status == VS_INPUT && !err->place_size) { /* of the run as a whole */
    const vs_error plain = *err;
    vs_fail_at(err, vs_tree_place(s->tree.root, "run"), "%s", plain.text);
  }
  s->order.pilot = pilot;
  s->order.early_end = NULL;
  s->order.warming = NULL;
  r->wall_s = clock_s(CLOCK_MONOTONIC) - began_s;
  if (!status && s->order.pilot) /* which has found the start */
    memcpy(s->setup.start.x, s->order.pilot->x, sizeof s->setup.start.x);
  return status;
}

/* ---- the ladder ---- */

/* Goes to the next rung and reads its scene. NULL: there is no rung left, or its scene cannot be
 * read, as where an ideal thyristor would take the place of one whose own keys the scene sets. */
static vs_scene *next_rung(const vs_scene *scene, vs_ladder *ladder) {
  vs_error err = {0};
  if (!vs_ladder_climb(ladder, scene)) return NULL;
  vs_scene *other = vs_alloc(1, sizeof *other);
  if (!vs_ladder_scene(ladder, scene, other, &err)) return other;
  vs_scene_free(other);
  free(other);
  return NULL;
}

static void take_climbed_scene(vs_result *r, vs_scene *climbed) {
  vs_watchers_free(&r->watchers); /* they look at the scene that was run before, */
  vs_result_end_loop(r);          /* and the control is that scene's */
  if (r->climbed) vs_scene_free(r->climbed);
  free(r->climbed);
  r->climbed = climbed;
}

/* No rung helped: the error tells how the last attempt ended, and how the scene as it is did. */
static void fail_after_ladder(const vs_scene *scene, const vs_ladder *ladder, vs_error *err) {
  const vs_error last = *err;
  const char *ideal =
      vs_ladder_stopped_short(scene)
          ? "; run.ladder: ideal would put an ideal thyristor in the place of the scene's"
          : "";
  if (ladder->rung)
    vs_fail(err, VS_RUN, "%s (%s; before, the scene as it is: %s)%s", last.text,
            vs_ladder_text(ladder->rung), ladder->failed, ideal);
  else
    vs_fail(err, VS_RUN, "%s%s", last.text, ideal);
  err->gave_up = true;
}

vs_scene *vs_session_climb(const vs_session *session, const vs_scene *scene, vs_status status,
                           vs_result *r, vs_error *err) {
  vs_ladder next = r->ladder;
  if (!status || !err->gave_up || session->bare) return NULL;
  vs_scene *other = next_rung(scene, &next);
  if (!other) {
    if (status == VS_RUN) fail_after_ladder(scene, &r->ladder, err);
    return NULL;
  }
  if (!next.failed[0]) memcpy(next.failed, err->text, sizeof next.failed);
  if (session->guest && session->guest->again)
    session->guest->again(session->guest->ctx, status == VS_RUN ? err->text : "", next.rung);
  take_climbed_scene(r, other);
  r->ladder = next;
  *err = (vs_error){.findings = err->findings};
  return other;
}

/* Error: the scene begins on an orbit, or its load follows from one, and nobody has looked for it.
 */
static vs_status refuse_orbit(const vs_scene *scene, vs_error *err) {
  if (scene->setup.steady)
    return vs_fail_at(err, vs_tree_place(scene->tree.root, "start"),
                      "start: steady: what is run here begins at rest or at a state; leave it out");
  return vs_setup_require_fraction(&scene->setup, vs_tree_place(scene->tree.root, "load.fraction"),
                                   "what is run here", err);
}

/* ---- the second run ---- */

/* The second run's tolerance is COARSER times the first's. Steps go with the root of the tolerance,
 * so such a run costs about 0.4 of the first. Where the first run's tolerance is above COARSE its
 * steps are at their longest, and a coarser run would be the same; the second one is finer then. */
static const double COARSER = 10, COARSE = 2e-4;
/* ngspice's default. The second run takes a run.trtol above this back to it, so that what a loose
 * trtol costs shows as a difference. */
static const double USUAL_TRTOL = 7;
/* A coarser run lets the truncation be this much looser than its tolerance asks for. Where a
 * thyristor of two transistors conducts, its gate is pulsed, and at each edge the solver rejects
 * steps and takes them up again. With the tolerance alone such a run cost 0.54 of the first, with
 * twice that 0.45, with three times no less. With twice that or more the error of the rise of a
 * thyristor's current came out as half of its limit, or as twice the limit, in one of three scenes;
 * with 1 to 1.75 times it was at most a fifth in all three. With sub-pulses spared (anode.c) the
 * cost is 0.27. */
static const double LOOSER = 1.5;

/* What any number of a run may be wrong by, as a multiple of run.tolerance. The tolerance bounds
 * the motion; a device's spikes are known less well. */
static const double RESOLUTION = 3;

/* A rate over 0.1 us is decided by few steps, whose length follows from the solver's own tolerance.
 * That one stands still above FINE (engine/coupled/pace.c), and below it the error goes with
 * run.tolerance. At 1e-4 the largest error of 439 rates of current was 1.5 % of the limit, and 1 %
 * in one of twenty scenes that are fired in every cycle; so FINE_RATE times the resolution. With 17
 * times 3 of them were outside: the two runs may be wrong alike, by chance. Above FINE the rates
 * have COARSE_RATE times the resolution at least, which is what the motion's own steps may add. */
static const double FINE = 1e-4, FINE_RATE = 50, COARSE_RATE = 17;

double vs_session_other_tolerance(double tolerance) {
  return fmin(tolerance > COARSE ? tolerance / COARSER : tolerance * COARSER, 0.1);
}

/* What a rate may be wrong by, as a multiple of the resolution. */
static double resolution_of_rates(double tolerance) {
  return fmax(COARSE_RATE, FINE_RATE * fmin(1, FINE / tolerance));
}

double vs_session_resolution(double tolerance, bool of_rate) {
  return RESOLUTION * tolerance * (of_rate ? resolution_of_rates(tolerance) : 1);
}

/* True if a small error could give the run another sequence of firings. */
static bool is_run_on_edge(const vs_result *r) {
  const vs_devices *d = r->watchers.devices;
  for (size_t k = 0; d && k < d->count; k++)
    if (d->item[k].sequence.edge) return true;
  return vs_verdict_on_edge(&r->verdict);
}

static bool wants_second(const vs_session *session, const vs_result *r) {
  int word = r->scene->setup.run.verify;
  bool told = r->verdict.count || r->scene->tier->has_circuit; /* what a second run tells */
  if (session->bare) return false; /* nobody has watched, and there is nothing to compare */
  if (word == VS_VERIFY_ALWAYS && told) return true;
  if (word != VS_VERIFY_AUTO || !r->verdict.count) return false;
  return session->verify || (session->verify_edges && is_run_on_edge(r));
}

/* With run.verify: always, an extreme of a probe is told which a finer run has otherwise by more
 * than this part of the probe's peak, or a coarser one by three times as much. A tolerance bounds
 * the motion; a spike of nanoseconds, as behind an ideal switch, may be as high as the steps make
 * it. What is below a millionth of a volt or an ampere is nothing. */
static const double UNSURE = 0.03, NOTHING = 1e-6;

/* Names the extreme of a probe that the second run has most differently. */
static void tell_unsure(vs_result *r, const vs_result *second) {
  const vs_frame *frame = &r->scene->frame;
  vs_listed_measure one, other, worst = {.name = ""};
  bool coarser = second->scene->setup.run.tolerance > r->scene->setup.run.tolerance;
  const double allowed = coarser ? 3 * UNSURE : UNSURE;
  double most = allowed, by = NAN;
  int count = 0;
  for (int k = 0; vs_listed_measure_at(frame, r, k, &one); k++) {
    if (one.channel < 0 || !vs_listed_measure_at(frame, second, k, &other)) continue;
    const vs_extreme *ends =
        vs_measures_of_probe(r->watchers.measures, one.channel - vs_channel_deck(frame->model));
    double peak = fmax(fabs(ends[0].best.value), fabs(ends[1].best.value));
    double change =
        fabs(one.value.value - other.value.value) * vs_units_factor(one.unit) / fmax(peak, NOTHING);
    count += change > allowed;
    if (!(change > most)) continue;
    most = change;
    worst = one;
    by = other.value.value;
  }
  if (count)
    snprintf(r->second.unsure, sizeof r->second.unsure,
             "%s is %.4g %s, and %.4g %s at run.tolerance = %.3g%s", worst.name, worst.value.value,
             worst.unit, by, worst.unit, r->second.tolerance,
             count > 1 ? "; other extremes differ, too" : "");
}

/* Makes *s, a copy of a scene, one that differs in how finely it is solved and in nothing else. */
static void change_settings(vs_scene *s, double factor) {
  vs_run_values run = s->setup.run;
  run.tolerance = fmin(fmax(run.tolerance * factor, s->tier->finest), 0.1);
  run.max_step_s *= sqrt(factor);
  double looser = factor > 1 ? factor * LOOSER : factor;
  run.trtol = run.trtol > USUAL_TRTOL ? USUAL_TRTOL : fmax(run.trtol * looser, 1);
  s->setup = vs_setup_varied(&s->setup, &run, NULL);
  s->order.raw = NULL;
  if (!vs_ratings_want_quality(&s->ratings)) s->quality.count = 0;
  if (!s->control.regulator) s->instruments.count = 0; /* it is for the margins alone */
  s->order.tried = true;
  s->frame = vs_sim_frame(s->tier, &s->setup);
}

/* The run.tolerance at which every undecided line is likely to be decided, as errors go with the
 * tolerance. 0: no line is undecided, or the tier cannot hold such a tolerance. */
static double deciding_tolerance(const vs_result *r) {
  double most = INFINITY, own = r->scene->setup.run.tolerance;
  for (size_t k = 0; k < r->verdict.count; k++) {
    const vs_judgement *j = &r->verdict.item[k];
    if (vs_verdict_word(j) == VS_UNDECIDED &&
        fabs(j->margin) > j->scatter) /* no run decides that */
      most = fmin(most, own * fabs(j->margin) / j->margin_error / 2);
  }
  if (isinf(most) || most < r->scene->tier->finest) return 0;
  return pow(10, floor(log10(most)));
}

/* Two instants are those of one firing where they are within this part of a cycle of the mains,
 * 3.6 degrees. It is far above what a tolerance makes of an instant, but for the end of a current
 * that creeps to zero, and not above the distance of the pulses of a burst. */
static const double WINDOW = 0.01;

/* Compares the sequences of what the devices with a gate and the fuses did, and of the run's own
 * firings. mark: marks what hangs on one that the second run has otherwise, and tells it. Returns
 * true where they are the same. */
static bool compare_sequences(vs_result *r, const vs_result *second, bool mark) {
  const vs_devices *a = r->watchers.devices, *b = second->watchers.devices;
  double window_s = WINDOW * r->scene->setup.timeline.period_s;
  vs_sequence_difference how, first;
  const char *name = NULL;
  for (size_t k = 0; a && b && k < a->count; k++) {
    const vs_kind *kind = a->item[k].device->kind;
    if (!kind->gated && !kind->melts) continue; /* a diode that rings fires nothing */
    if (vs_reducer_sequences_agree(&a->item[k].sequence, &b->item[k].sequence, window_s, &how))
      continue;
    if (mark) vs_verdict_undecide_sequence(&r->verdict, a->item[k].device, how.parts_s);
    if (!name) first = how;
    if (!name) name = a->item[k].device->name;
  }
  if (!name && !vs_reducer_sequences_agree(&r->watchers.sequence, &second->watchers.sequence,
                                           window_s, &first))
    name = "it";
  if (name && mark)
    snprintf(r->second.sequence, sizeof r->second.sequence,
             "%s %s at run.tolerance = %.3g, %s at %.3g", name, first.one,
             r->scene->setup.run.tolerance, first.other, r->second.tolerance);
  return !name;
}

/* Runs the scene, as `other`, with its tolerance times the factor. A coarser run may spare the
 * sub-pulses of gates. */
static vs_status run_with_factor(const vs_session *session, const vs_result *r, double factor,
                                 vs_scene *other, vs_result *second, vs_error *err) {
  const vs_session plain = {.stop = session->stop, .unguarded = session->unguarded};
  bool spares = false;
  *other = *r->scene;
  change_settings(other, factor);
  if (factor > 1) other->setup.timeline.spares = other->order.spares = &spares;
  vs_status status = vs_session_attempt(&plain, other, second, err);
  other->setup.timeline.spares = other->order.spares = NULL;
  return status;
}

/* A second run. Its scene shares what the first one's owns and is not freed as a scene. */
typedef struct another {
  vs_scene scene;
  vs_result result;
  vs_error why; /* it failed */
  vs_status status;
} another;

static another *run_another(const vs_session *session, const vs_result *r, double factor) {
  another *a = vs_alloc(1, sizeof *a);
  a->status = run_with_factor(session, r, factor, &a->scene, &a->result, &a->why);
  return a;
}

static void free_another(another *a) {
  vs_result_free(&a->result);
  free(a);
}

/* Returns the run that is to give the margins their errors. A coarser run may fail by its
 * coarseness alone: its steps made a thyristor fire by itself, and the armature met the pole cover.
 * So may its sequence of firings differ: a triac took up its recovery current for good, which lets
 * go at all finer tolerances. A finer run then takes its place, unless it alone fails. */
static another *find_second(const vs_session *session, vs_result *r) {
  const bool coarser = r->scene->setup.run.tolerance <= COARSE;
  another *a = run_another(session, r, coarser ? COARSER : 1 / COARSER);
  if (!coarser) return a;
  if (a->status ? a->status != VS_RUN : compare_sequences(r, &a->result, false)) return a;
  another *finer = run_another(session, r, 1 / COARSER);
  const bool keeps = !a->status && finer->status && finer->status != VS_SIGNAL;
  free_another(keeps ? finer : a);
  return keeps ? a : finer;
}

/* Runs the scene a second time and gives the margins their errors. */
static void run_second(const vs_session *session, vs_result *r) {
  another *second = find_second(session, r);
  r->second.tolerance = second->scene.setup.run.tolerance;
  r->second.wall_s = second->result.wall_s;
  r->second.done = !second->status;
  if (second->status)
    snprintf(r->second.failed, sizeof r->second.failed, "%.255s", second->why.text);
  if (second->status == VS_SIGNAL) { /* the first run is whole: its lines stay unverified */
    r->second.stopped = true;
  } else if (second->status) {
    for (size_t k = 0; k < r->verdict.count; k++) r->verdict.item[k].margin_error = INFINITY;
  } else {
    const double own = r->scene->setup.run.tolerance;
    double bound = fmax(r->watchers.absence.bound, second->result.watchers.absence.bound);
    double resolution = RESOLUTION * own + bound;
    vs_verdict_compare(&r->verdict, &second->result.verdict, r->scene->frame.deck, resolution,
                       resolution_of_rates(own) * resolution);
    compare_sequences(r, &second->result, true);
    r->second.decides = deciding_tolerance(r);
    if (r->scene->setup.run.verify == VS_VERIFY_ALWAYS) tell_unsure(r, &second->result);
  }
  free_another(second);
}

/* ---- what it takes ---- */

/* More cycles than any search has time for, and few enough to be counted in 32 bits. */
static const double COUNTED = 1e9;

long vs_session_cycles(const vs_scene *scene) {
  const vs_setup *setup = &scene->setup;
  return lround(fmin(fmax(ceil(setup->run.until_s / setup->timeline.period_s - 1e-9), 1), COUNTED));
}

vs_status vs_session_charge_budget(const vs_scene *scene, vs_error *err) {
  return vs_budget_take(scene->order.budget, scene->tier->has_circuit, vs_session_cycles(scene),
                        err);
}

/* ---- what follows ---- */

static void write_allowed(const vs_judgement *j, double unit, char *text, size_t size) {
  const bool below = j->name && isinf(j->rating->min), above = j->name && isinf(j->rating->max);
  if (below || above)
    snprintf(text, size, "%s %g", below ? "at most" : "at least",
             (below ? j->rating->max : j->rating->min) / unit);
  else if (j->rating)
    snprintf(text, size, "%g..%g", j->rating->min / unit, j->rating->max / unit);
  else
    snprintf(text, size, "%s %g", j->measure->held == VS_AT_LEAST ? "at least" : "at most",
             j->limit->value / unit);
}

/* What happened against the scene's expectation, or did not. */
static vs_status fail_of_happening(const vs_judgement *j, vs_error *err) {
  const char *device = j->device->name, *verb = vs_kinds_happening(j->measure)->verb;
  const char *undecided =
      vs_verdict_word(j) == VS_UNDECIDED ? "; the two runs differ in it, so it is undecided" : "";
  if (!(j->stress.value > 0))
    return vs_fail(err, VS_RATING, "%s %s: the scene expects it, and it did not happen%s", device,
                   verb, undecided);
  return vs_fail(err, VS_RATING, "%s %s at %.6g s: %s%s%s", device, verb, j->stress.at_s, j->cause,
                 j->expected ? "" : "; the scene does not expect it", undecided);
}

vs_status vs_session_judge(const vs_result *r, vs_error *err) {
  const vs_judgement *worst = vs_verdict_breach(&r->verdict);
  if (r->second.stopped)
    return vs_fail(err, VS_SIGNAL,
                   "stopped by a signal in the second run, for the errors of the margins (%s): the "
                   "first run's result is whole, its verdict unverified",
                   r->second.failed);
  if (!worst) return VS_OK;
  if (vs_verdict_is_happening(worst)) return fail_of_happening(worst, err);
  const char *unit_name = vs_verdict_unit(worst);
  char name[VS_JUDGED_NAME], allowed[2 * VS_DECK_NAME + 16], decides[96] = "", at[48] = "";
  double unit = vs_units_factor(unit_name);
  if (!worst->lacks) write_allowed(worst, unit, allowed, sizeof allowed);
  vs_verdict_name(worst, name);
  if (!isnan(worst->stress.at_s)) snprintf(at, sizeof at, " at %.6g s", worst->stress.at_s);
  if (worst->lacks)
    return vs_fail(err, VS_RATING, "a rating is undecided: %s: %s; waive: [%s] leaves it out", name,
                   vs_verdict_unknown(worst, allowed, sizeof allowed), name);
  if (worst->unknown && isinf(worst->rating->min) && isinf(worst->rating->max))
    return vs_fail(err, VS_RATING,
                   "a rating is undecided: the limits of %s are held to nothing, as %s", name,
                   worst->unknown);
  if (worst->unknown)
    return vs_fail(err, VS_RATING, "a rating is undecided: %s has no value, as %s; allowed %s %s",
                   name, worst->unknown, allowed, unit_name);
  if (vs_verdict_word(worst) != VS_UNDECIDED)
    return vs_fail(err, VS_RATING, "a rating is violated: %s = %.6g %s%s, allowed %s %s", name,
                   worst->stress.value / unit, unit_name, at, allowed, unit_name);
  if (r->second.decides > 0)
    snprintf(decides, sizeof decides, "; run.tolerance = %.1g may decide", r->second.decides);
  else
    snprintf(decides, sizeof decides, "; no run.tolerance is known to decide");
  return vs_fail(
      err, VS_RATING,
      "a rating is undecided: %s = %.6g %s%s, allowed %s %s: margin %.3g %% +- %.2g %%%s", name,
      worst->stress.value / unit, unit_name, at, allowed, unit_name, 100 * worst->margin,
      100 * worst->margin_error, decides);
}

static vs_status stop_at_once(void *ctx, const vs_step *step, vs_error *err) {
  (void)step;
  *(bool *)ctx = true;
  return vs_fail(err, VS_SIGNAL, "the first step is taken");
}

vs_status vs_session_try(const vs_tier *tier, const vs_setup *setup, vs_error *err) {
  bool begun = false;
  const vs_observer observer = {&begun, stop_at_once};
  vs_run_values run = setup->run; /* a run has the longer first step on the ladder */
  run.first_step = fmax(run.first_step, VS_SETUP_LONGER_FIRST_STEP);
  const vs_setup tried = vs_setup_varied(setup, &run, NULL);
  vs_status status = tier->run(&tried, &vs_tiers_order, &observer, err);
  return begun ? VS_OK : status;
}
