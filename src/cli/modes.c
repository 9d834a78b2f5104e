/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `modes`: eigenfrequencies, damping, shapes and state space of a scene's machine. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "commands.h"
#include "options.h"
#include "run/scene.h"

/* the one of each conjugate pair with the positive imaginary part; overdamped ones stand alone */
static bool is_shown_mode(const vs_mode *mode) {
  return mode->im_rad_s >= 0;
}

static void print_modes(const vs_model *model, const vs_mode *modes) {
  printf("%16s %18s %14s   %s", "frequency Hz", "time constant s", "damping ratio", "shape");
  for (int i = 0; i < model->dof; i++) {
    const vs_coordinate *c = &model->machine->coordinates[i];
    printf("%s |%s| in %s", i ? "," : "", c->name, c->unit);
  }
  puts(", with angles in deg");
  for (int m = 0; m < 2 * model->dof; m++) {
    const vs_mode *mode = &modes[m];
    if (!is_shown_mode(mode)) continue;
    printf("%16.10g %18.10g %14.6g  ", mode->frequency_hz, mode->time_constant_s,
           mode->damping_ratio);
    for (int i = 0; i < model->dof; i++)
      printf(" %s %.4g@%.1f", model->machine->coordinates[i].name,
             hypot(mode->shape_re[i], mode->shape_im[i]),
             atan2(mode->shape_im[i], mode->shape_re[i]) * 180 / M_PI);
    putchar('\n');
  }
}

static void print_modes_json(const vs_model *model, const vs_mode *modes) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  vs_json_array(&json, "modes", VS_JSON_LINES);
  for (int m = 0; m < 2 * model->dof; m++) {
    const vs_mode *mode = &modes[m];
    if (!is_shown_mode(mode)) continue;
    vs_json_object(&json, NULL, VS_JSON_ROW);
    vs_json_number(&json, "frequency_hz", mode->frequency_hz, 12);
    vs_json_number(&json, "time_constant_s", mode->time_constant_s, 12);
    vs_json_number(&json, "damping_ratio", mode->damping_ratio, 12);
    vs_json_object(&json, "shape", VS_JSON_ROW);
    for (int i = 0; i < model->dof; i++) {
      vs_json_array(&json, model->machine->coordinates[i].name, VS_JSON_ROW);
      vs_json_number(&json, NULL, mode->shape_re[i], 12);
      vs_json_number(&json, NULL, mode->shape_im[i], 12);
      vs_json_end(&json);
    }
    vs_json_end(&json);
    vs_json_end(&json);
  }
  vs_json_end(&json);
  vs_json_end(&json);
  puts(text.text);
  vs_text_free(&text);
}

static vs_status write_matrix(const char *folder, const char *name, const double *m, int stride,
                              int rows, int columns, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, name, err);
  if (status) return status;
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < columns; j++)
      fprintf(file.stream, "%.17g%c", m[i * stride + j], j + 1 < columns ? ',' : '\n');
  return vs_file_commit(&file, err);
}

static vs_status write_modes(const char *folder, const vs_model *model, const vs_mode *modes,
                             vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, "modes.csv", err);
  if (status) return status;
  fputs("eigenvalue_re_1_s,eigenvalue_im_rad_s,frequency_hz,time_constant_s,damping_ratio",
        file.stream);
  for (int i = 0; i < model->dof; i++)
    fprintf(file.stream, ",%s_re,%s_im", model->machine->coordinates[i].name,
            model->machine->coordinates[i].name);
  for (int m = 0; m < 2 * model->dof; m++) {
    const vs_mode *mode = &modes[m];
    fprintf(file.stream, "\n%.17g,%.17g,%.17g,%.17g,%.17g", mode->re_1_s, mode->im_rad_s,
            mode->frequency_hz, mode->time_constant_s, mode->damping_ratio);
    for (int i = 0; i < model->dof; i++)
      fprintf(file.stream, ",%.17g,%.17g", mode->shape_re[i], mode->shape_im[i]);
  }
  fputc('\n', file.stream);
  return vs_file_commit(&file, err);
}

static vs_status write_state_space(const char *folder, const vs_model *model, const vs_mode *modes,
                                   vs_error *err) {
  vs_state_space s;
  vs_mechanics_state_space(model, &s);
  int made, dof = model->dof, states = 2 * dof;
  vs_status status = vs_file_folder_make(folder, &made, err);
  if (!status) status = write_modes(folder, model, modes, err);
  if (!status)
    status = write_matrix(folder, "A.csv", &s.a[0][0], VS_MOST_STATES, states, states, err);
  if (!status) status = write_matrix(folder, "B.csv", &s.b[0][0], VS_MOST_DOF, states, dof, err);
  if (!status) status = write_matrix(folder, "C.csv", &s.c[0][0], VS_MOST_STATES, dof, states, err);
  if (!status) status = write_matrix(folder, "D.csv", &s.d[0][0], VS_MOST_DOF, dof, dof, err);
  return status;
}

/* Prints the modes as a table or as JSON. With -o DIR it also writes modes.csv there, and the state
 * space of Eqs. 84-87 as A.csv, B.csv, C.csv, D.csv: plain matrices of 17 digits without a header.
 * With --quiet no table is printed, and JSON all the same. Errors: everything a scene can be wrong
 * in; VS_RUN, no eigenvalues are found; a file cannot be written. */
static vs_status modes_command(const void *given, vs_error *err) {
  const vs_arguments *a = given;
  const char *folder = a->output;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_mode modes[VS_MOST_STATES];
  vs_status status = vs_scene_read(vs_command_name(a), a->sets, a->n_sets, NULL, scene, err);
  const vs_model *model = &scene->setup.model;
  if (!status)
    status = vs_setup_require_fraction(
        &scene->setup, vs_tree_place(scene->tree.root, "load.fraction"), "modes", err);
  if (!status && !vs_mechanics_modes(model, modes))
    status = vs_fail(err, VS_RUN, "no eigenvalues found");
  if (!status && folder) status = write_state_space(folder, model, modes, err);
  if (!status && a->json)
    print_modes_json(model, modes);
  else if (!status && !a->quiet) {
    print_modes(model, modes);
    if (folder)
      printf("written: modes.csv and the state space (x = velocities, then coordinates; input: "
             "generalised "
             "forces, the actuator's is -F times gap.along) as A.csv, B.csv, C.csv, D.csv in %s\n",
             folder);
  }
  vs_scene_free(scene);
  free(scene);
  return status;
}

static const vs_option MODES_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_OUTPUT("DIR",
                      "writes modes.csv and the state space there: A.csv, B.csv, C.csv, D.csv"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "no table"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_modes_cli = {
    .name = "modes",
    .argument = "SCENE",
    .text = "prints eigenfrequencies, damping and shapes; exports the state space",
    .examples =
        "  vibrospice modes paper\n  vibrospice modes paper --set machine.m14=derived -o modes\n",
    .options = MODES_OPTIONS,
    .size = sizeof(vs_arguments),
    .run = modes_command};
