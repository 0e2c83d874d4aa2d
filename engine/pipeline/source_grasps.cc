#include "engine/pipeline/source_grasps.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/random.h"
#include "engine/pipeline/part_clearance.h"

namespace graspdb {

std::vector<int> DrawByQuartile(int total, int count, uint64_t seed) {
  std::vector<int> drawn;
  if (count >= total) {
    drawn.resize(total);
    std::iota(drawn.begin(), drawn.end(), 0);
    return drawn;
  }
  Random random(seed);
  for (int quartile = 0; quartile < 4; ++quartile) {
    const int first = quartile * total / 4;
    const int last = (quartile + 1) * total / 4;
    const int wanted = (quartile + 1) * count / 4 - quartile * count / 4;
    std::vector<int> pool(last - first);
    std::iota(pool.begin(), pool.end(), first);
    // Fisher and Yates, as far as needed.
    for (int i = 0; i < wanted; ++i) {
      std::swap(pool[i],
                pool[i + random.NextIndex(static_cast<int>(pool.size()) - i)]);
    }
    drawn.insert(drawn.end(), pool.begin(), pool.begin() + wanted);
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

std::vector<int> DrawSourceGrasps(const GraspSpace& space,
                                  const std::vector<int>& keep_free,
                                  double min_clearance, int count,
                                  uint64_t seed) {
  std::vector<int> allowed;
  for (size_t i = 0; i < space.grasps.size(); ++i) {
    if (i < space.clearances.size() &&
        !KeepsFree(space.clearances[i], keep_free, min_clearance)) {
      continue;
    }
    allowed.push_back(static_cast<int>(i));
  }
  std::vector<int> drawn =
      DrawByQuartile(static_cast<int>(allowed.size()), count, seed);
  for (int& index : drawn) index = allowed[static_cast<size_t>(index)];
  return drawn;
}

}  // namespace graspdb
