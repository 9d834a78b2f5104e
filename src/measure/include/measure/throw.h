/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher of the trough's throw: how hard it is accelerated along the ways that the machine's file
 * names (plant/machine_file.h), and what follows for the material on it.
 *
 * The material leaves the trough where that is accelerated downwards by more than g. The conveying
 * speed is the theoretical one of VDI 2333: a trough that swings along a straight line throws a
 * point of material once in each swing; in the air nothing brakes it, and on the trough it does not
 * slide. With x = 2 pi n, n the part of a swing that it flies, it starts at the phase whose sine is
 * 1/G and lands where the trough is again:
 *   G^2 = 1 + ((cos x - 1 + x^2/2)/(x - sin x))^2,   v = g n^2 cot(beta)/(2 f).
 * n = 1 belongs to G = sqrt(1 + pi^2) = 3.297, beyond which the flight is longer than a swing. */
#pragma once

#include "engine/step.h"
#include "measure/extremes.h"

/* What is followed: the accelerations along the machine's ways, and the speed upwards. */
enum { VS_THROW_SPEED = VS_MACHINE_WAYS, VS_THROW_COURSES };

/* Start from {0}. */
typedef struct vs_throw {
  const vs_model *model;                                    /* of the last step */
  vs_value least[VS_THROW_COURSES], most[VS_THROW_COURSES]; /* m/s2 and m/s */
} vs_throw;

/* Takes one accepted step. */
void vs_throw_accept(vs_throw *thrown, const vs_step *step);

/* The paper's throw coefficient K: the largest acceleration along load.along, over g. Not known
 * where the machine's file has no such key. */
vs_value vs_throw_coefficient(const vs_throw *thrown);
/* The throw number: the largest acceleration of the trough up or down, over g; and the largest one
 * downwards alone. */
vs_value vs_throw_number(const vs_throw *thrown);
vs_value vs_throw_down(const vs_throw *thrown);
/* The conveying speed, m/s, without a sign; not known where nothing is thrown. Where the material
 * would fly for longer than a swing, it is the one of a flight as long as a swing. */
vs_value vs_throw_speed(const vs_throw *thrown);

/* Up to which throw number the conveying speed's formula holds. */
extern const double vs_throw_most;
