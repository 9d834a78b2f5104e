/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "schedule.h"

vs_timeline schedule(const char *scene) {
  vs_tree tree = {0};
  vs_error err = {0};
  vs_timeline t;
  write_file("t.yaml", scene);
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("t.yaml", &tree, &err), VS_OK);
  CU_ASSERT_EQUAL_FATAL(vs_timeline_build(tree.root, NULL, &t, NULL, &err), VS_OK);
  vs_status s = vs_events_read(vs_tree_child(tree.root, "events"), &t, 2, &t.events, &err);
  EXPECT(s == VS_OK, "%s", err.text);
  vs_tree_free(&tree);
  return t;
}
