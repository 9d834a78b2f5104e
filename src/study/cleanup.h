/* SPDX-License-Identifier: GPL-3.0-or-later
 * What else than its files a study leaves in its folder: the columns, the report and its pictures,
 * as `plot` draws them, and the runs that were kept. Beside another study's result they would lie.
 */
#pragma once

#include "workers/journal.h"

/* Removes them, by the names they have: report.html; the pictures and the folder of columns that
 * follow from the header rows of the study's two files (call it before those go);
 * runs/NUMBER/run.csv of the cases of the old study, and folders that are empty then. old: its
 * journal; NULL: there is none, and its cases are those in the two files. Whatever else is there
 * stays, and so does what is a link. What cannot be removed stays. */
void vs_cleanup_folder(const char *folder, const vs_journal *old);
