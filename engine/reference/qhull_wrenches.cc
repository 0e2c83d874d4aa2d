#include "engine/reference/qhull_wrenches.h"

#include <algorithm>
#include <cstdio>
#include <limits>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace graspdb {
namespace {

struct Hull {
  double nearest{-std::numeric_limits<double>::infinity()};
  double volume{0.0};
};

Hull RunQhull(const Wrenches& wrenches, const char* options) {
  Hull result;
  qhT state;
  qhT* qh = &state;
  std::FILE* trash = std::fopen("/dev/null", "w");
  qh_zero(qh, trash);
  Eigen::MatrixXd points = wrenches;
  char command[64];
  std::snprintf(command, sizeof(command), "%s", options);
  if (qh_new_qhull(qh, 6, static_cast<int>(points.cols()), points.data(), 0,
                   command, nullptr, trash) == 0) {
    result.nearest = std::numeric_limits<double>::infinity();
    facetT* facet;
    FORALLfacets { result.nearest = std::min(result.nearest, -facet->offset); }
    qh_getarea(qh, qh->facet_list);
    result.volume = qh->totvol;
  }
  qh_freeqhull(qh, !qh_ALL);
  int curlong, totlong;
  qh_memfreeshort(qh, &curlong, &totlong);
  std::fclose(trash);
  return result;
}

}  // namespace

double CalcEpsilonByQhull(const Wrenches& wrenches) {
  return RunQhull(wrenches, "qhull Qt").nearest;
}

double CalcVolumeByQhull(const Wrenches& wrenches) {
  return RunQhull(wrenches, "qhull Qt").volume;
}

}  // namespace graspdb
