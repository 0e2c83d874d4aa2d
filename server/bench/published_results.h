#pragma once

#include <vector>

/** @file
 What the paper reports, as printed, to stand beside what is measured. */

namespace graspdb {

/** Table I: learning one part of an example. */
struct PublishedLearning {
  const char* category;
  const char* part;
  int triangles;
  double configuration_space_seconds;
  double search_seconds;
  int grasps;
};

/** Tables II and III: forty grasps to one part of a novel object, ours (the
 paper's) and by open-close. */
struct PublishedTransfer {
  const char* category;
  int object;  ///< 1 or 2; 0: the one reconstructed from points (Table III).
  const char* part;
  int size;                 ///< Triangles; points in Table III.
  double transfer_seconds;  ///< 0 where not reported.
  double assembly_seconds;
  int transferred, transferred_open_close;
  int assembled, assembled_open_close;
};

const std::vector<PublishedLearning>& GetPublishedLearning();
const std::vector<PublishedTransfer>& GetPublishedTransfers();

}  // namespace graspdb
