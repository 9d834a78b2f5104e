/* SPDX-License-Identifier: GPL-3.0-or-later
 * What else than its result a study leaves in its folder: the report and its pictures, as `plot`
 * draws them, and the runs that were kept. Beside another study's result they would lie. */
#ifndef VS_BATCH_STALE_H
#define VS_BATCH_STALE_H

/* Removes them, by the names they have: report.html; the pictures that follow from the columns of
 * the study.csv that is there (call it before that goes); runs/NUMBER/run.csv and folders that are
 * empty then. Whatever else is there stays, and so does what is a link. What cannot be removed
 * stays. */
void vs_stale_remove(const char *folder);

#endif
