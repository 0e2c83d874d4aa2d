#pragma once

namespace graspdb {

/** How often this program's own objects, not its shared libraries, have asked
 for memory; Eigen's vectors count, too. */
int CountAllocations();

}  // namespace graspdb
