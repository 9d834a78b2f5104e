/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a study's manifest says, but for the counts of its cases: the same for every worker count,
 * shard and machine speed. */
#pragma once

#include "study/plan.h"
#include "workers/journal_head.h"

/* Fills the head of the plan's journal: what identifies the plan, and the text of its manifest
 * before and behind the counts. name is the study's as the user gave it. vs_journal_head_free it,
 * unless a journal takes it over. */
void vs_manifest_head(const vs_plan *plan, const char *name, vs_journal_head *head);
