/* SPDX-License-Identifier: GPL-3.0-or-later
 * The program's commands, plugs of the table in main.c. A command is one file, cli/COMMAND.c: its
 * options, the struct that they fill in, and what it does. */
#pragma once

#include "command.h"

extern const vs_command vs_run_cli, vs_steady_cli, vs_sensitivity_cli, vs_check_cli, vs_part_cli,
    vs_list_cli, vs_new_cli, vs_schema_cli, vs_modes_cli, vs_export_cli, vs_plot_cli,
    vs_compare_cli, vs_validate_cli, vs_study_cli, vs_merge_cli, vs_judge_cli, vs_cure_cli,
    vs_design_cli, vs_fit_cli, vs_import_cli, vs_serve_cli, vs_help_cli, vs_completion_cli;
