#pragma once

#include <string>
#include <vector>

namespace graspdb {

/** Points or a line of a plot. */
struct PlotSeries {
  std::string name;
  std::string color;  ///< CSS.
  std::vector<double> x;
  std::vector<double> y;
  bool line{false};  ///< Joined, instead of dots.
};

struct PlotOptions {
  std::string title;
  std::string x_label;
  std::string y_label;
  double x_max{0.0};  ///< 0: as far as the points reach.
  double y_min{0.0};
  double y_max{0.0};     ///< Likewise.
  bool diagonal{false};  ///< From corner to corner; both axes are the same.
  /** Both axes by powers of ten, around positive points. */
  bool logarithmic{false};
  bool alone{false};  ///< A file of its own, which brings its style along.
};

/** The style sheet that the plots of a page share. */
extern const char kPlotStyle[];

/** An <svg> element, 320 by 240 pixels, that needs kPlotStyle and nothing else:
 axes from zero with round ticks, or by powers of ten; a legend when there are
 several series. */
std::string MakeSvgPlot(const std::vector<PlotSeries>& series,
                        const PlotOptions& options);

}  // namespace graspdb
