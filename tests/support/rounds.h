#pragma once

#include <cstdlib>

namespace graspdb {

/** How often a loop of faults goes round: GRASPDB_ROUNDS, or the few that a
 quick test can afford. */
inline int CountRounds(int few) {
  const char* given = std::getenv("GRASPDB_ROUNDS");
  return given == nullptr ? few : std::atoi(given);
}

}  // namespace graspdb
