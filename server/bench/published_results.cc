#include "server/bench/published_results.h"

namespace graspdb {

// Table I.
const std::vector<PublishedLearning>& GetPublishedLearning() {
  static const std::vector<PublishedLearning> table{
      {"mug", "body", 1864, 1343.6, 1405.5, 133},
      {"mug", "handle", 1586, 1254.8, 1287.1, 60},
      {"spray_bottle", "body", 1844, 1404.5, 1536.4, 194},
      {"spray_bottle", "head", 894, 1286.7, 1328.0, 48},
      {"power_drill", "body", 4893, 1654.2, 1604.2, 61},
      {"power_drill", "head", 5052, 1795.1, 1635.9, 56},
  };
  return table;
}

// Table II, and Table III as objects 0.
const std::vector<PublishedTransfer>& GetPublishedTransfers() {
  static const std::vector<PublishedTransfer> table{
      {"mug", 1, "body", 752, 322.5, 305.3, 37, 35, 35, 29},
      {"mug", 1, "handle", 1284, 294.7, 302.5, 33, 21, 29, 19},
      {"mug", 2, "body", 2550, 335.3, 289.2, 36, 35, 36, 33},
      {"mug", 2, "handle", 1586, 283.1, 295.8, 33, 23, 26, 29},
      {"spray_bottle", 1, "body", 2294, 329.0, 293.4, 36, 29, 35, 29},
      {"spray_bottle", 1, "head", 1241, 298.9, 345.6, 32, 17, 22, 14},
      {"spray_bottle", 2, "body", 2074, 334.4, 315.1, 34, 22, 32, 19},
      {"spray_bottle", 2, "head", 737, 312.8, 364.2, 28, 15, 23, 18},
      {"power_drill", 1, "body", 6105, 414.7, 475.6, 35, 17, 32, 25},
      {"power_drill", 1, "head", 6850, 437.5, 498.1, 37, 24, 33, 26},
      {"power_drill", 2, "body", 6914, 421.5, 480.5, 39, 22, 36, 26},
      {"power_drill", 2, "head", 6781, 453.4, 509.4, 35, 20, 31, 13},
      {"mug", 0, "body", 1000, 0, 0, 38, 34, 37, 31},
      {"mug", 0, "handle", 500, 0, 0, 31, 19, 28, 23},
  };
  return table;
}

}  // namespace graspdb
