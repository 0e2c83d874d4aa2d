#include "engine/pipeline/source_grasps.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/random.h"

namespace graspdb {

std::vector<int> DrawSourceGrasps(const std::vector<Grasp>& grasps, int count,
                                  uint64_t seed) {
  const int total = static_cast<int>(grasps.size());
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

}  // namespace graspdb
