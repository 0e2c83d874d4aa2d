#pragma once

#include <string>

namespace graspdb {

/** A grasp that a running transfer has found and not stored yet. */
struct LiveGrasp {
  std::string id;
  std::string json;  ///< As it will be answered once stored.
};

}  // namespace graspdb
