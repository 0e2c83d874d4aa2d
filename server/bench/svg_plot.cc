#include "server/bench/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "server/codec/markup.h"

namespace graspdb {
namespace {

constexpr double kWidth = 320.0;
constexpr double kHeight = 240.0;
constexpr double kLeft = 44.0;
constexpr double kRight = 16.0;
constexpr double kTop = 20.0;
constexpr double kBottom = 34.0;
constexpr int kTicks = 5;  // About so many on an axis.

// 1, 2 or 5 times a power of ten.
double CalcTickStep(double range) {
  const double rough = range / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

// Where values lie along one side of the plot.
class Axis {
 public:
  Axis() = default;

  static Axis MakeLinear(double least, double most) {
    Axis axis;
    axis.least_ = least;
    axis.most_ = most > least ? most : least + 1.0;
    const double step = CalcTickStep(axis.most_ - least);
    for (int i = 0; least + i * step <= axis.most_ * (1.0 + 1e-9); ++i) {
      axis.ticks_.push_back(least + i * step);
    }
    return axis;
  }

  // By whole powers of ten around positive values.
  static Axis MakeLogarithmic(double least, double most) {
    Axis axis;
    axis.logarithmic_ = true;
    const double low = std::floor(std::log10(least) + 1e-9);
    const double high = std::max(low + 1.0, std::ceil(std::log10(most) - 1e-9));
    for (double power = low; power <= high; power += 1.0) {
      axis.ticks_.push_back(std::pow(10.0, power));
    }
    axis.least_ = axis.ticks_.front();
    axis.most_ = axis.ticks_.back();
    return axis;
  }

  // 0 at its beginning, 1 at its end.
  double CalcShare(double value) const {
    const double share = logarithmic_
                             ? std::log(std::max(value, least_) / least_) /
                                   std::log(most_ / least_)
                             : (value - least_) / (most_ - least_);
    return std::clamp(share, 0.0, 1.0);
  }

  double most() const { return most_; }
  const std::vector<double>& ticks() const { return ticks_; }

 private:
  bool logarithmic_{false};
  double least_{0.0};
  double most_{1.0};
  std::vector<double> ticks_;
};

class Plot {
 public:
  Plot(const std::vector<PlotSeries>& series, const PlotOptions& options)
      : series_(series), options_(options) {
    const auto [x_least, x_most] = FindRange(&PlotSeries::x);
    const auto [y_least, y_most] = FindRange(&PlotSeries::y);
    if (options.logarithmic && x_least > 0.0 && y_least > 0.0) {
      x_ = Axis::MakeLogarithmic(x_least, x_most);
      y_ = Axis::MakeLogarithmic(y_least, y_most);
      return;
    }
    double x_max = options.x_max == 0.0 ? x_most : options.x_max;
    double y_max = options.y_max == 0.0 ? y_most : options.y_max;
    if (options.diagonal) x_max = y_max = std::max(x_max, y_max);
    x_ = Axis::MakeLinear(0.0, x_max);
    y_ = Axis::MakeLinear(options.y_min, y_max);
  }

  std::string Draw() const {
    std::string svg = fmt::format(
        "<svg {4}viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "role=\"img\">{5}<title>{2}</title>"
        "<text x=\"{3}\" y=\"13\" class=\"t\">{2}</text>",
        kWidth, kHeight, EscapeMarkup(options_.title), kLeft,
        options_.alone ? "xmlns=\"http://www.w3.org/2000/svg\" " : "",
        options_.alone ? fmt::format("<style>{}</style>", kPlotStyle) : "");
    svg += DrawAxes();
    if (options_.diagonal) {
      svg += fmt::format(
          "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" class=\"d\"/>", X(0.0),
          Y(0.0), X(x_.most()), Y(y_.most()));
    }
    for (const PlotSeries& one : series_) svg += DrawSeries(one);
    if (series_.size() > 1) svg += DrawLegend();
    return svg + "</svg>";
  }

 private:
  // Of all points; from 0 to 0 when there are none.
  std::pair<double, double> FindRange(
      std::vector<double> PlotSeries::*values) const {
    double least = 1e300;
    double most = 0.0;
    for (const PlotSeries& one : series_) {
      for (const double value : one.*values) {
        least = std::min(least, value);
        most = std::max(most, value);
      }
    }
    return {std::min(least, most), most};
  }

  double X(double x) const {
    return kLeft + (kWidth - kLeft - kRight) * x_.CalcShare(x);
  }
  double Y(double y) const {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * y_.CalcShare(y);
  }

  std::string DrawAxes() const {
    const double floor = kHeight - kBottom;
    std::string svg = fmt::format("<path d=\"M{} {}V{}H{}\" class=\"a\"/>",
                                  kLeft, kTop, floor, kWidth - kRight);
    for (const double x : x_.ticks()) {
      svg +=
          fmt::format("<text x=\"{:.1f}\" y=\"{}\" class=\"x\">{:.4g}</text>",
                      X(x), floor + 12.0, x);
    }
    for (const double y : y_.ticks()) {
      svg += fmt::format(
          "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"g\"/>"
          "<text x=\"{}\" y=\"{:.1f}\" class=\"y\">{:.4g}</text>",
          kLeft, kWidth - kRight, Y(y), Y(y), kLeft - 4.0, Y(y) + 3.0, y);
    }
    svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"x\">{}</text>",
                       0.5 * (kLeft + kWidth - kRight), kHeight - 6.0,
                       EscapeMarkup(options_.x_label));
    svg += fmt::format(
        "<text transform=\"translate(10 {}) rotate(-90)\" class=\"x\">{}"
        "</text>",
        0.5 * (kTop + floor), EscapeMarkup(options_.y_label));
    return svg;
  }

  std::string DrawSeries(const PlotSeries& one) const {
    std::string svg;
    if (one.line) {
      svg = fmt::format("<polyline fill=\"none\" stroke=\"{}\" points=\"",
                        one.color);
      for (size_t i = 0; i < one.x.size(); ++i) {
        svg += fmt::format("{:.1f},{:.1f} ", X(one.x[i]), Y(one.y[i]));
      }
      return svg + "\"/>";
    }
    for (size_t i = 0; i < one.x.size(); ++i) {
      svg += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.2\" fill=\"{}\"/>",
          X(one.x[i]), Y(one.y[i]), one.color);
    }
    return svg;
  }

  std::string DrawLegend() const {
    std::string svg;
    double y = kTop + 8.0;
    for (const PlotSeries& one : series_) {
      svg += fmt::format(
          "<circle cx=\"{}\" cy=\"{}\" r=\"3\" fill=\"{}\"/>"
          "<text x=\"{}\" y=\"{}\" class=\"l\">{}</text>",
          kWidth - 118.0, y - 3.0, one.color, kWidth - 111.0, y,
          EscapeMarkup(one.name));
      y += 11.0;
    }
    return svg;
  }

  const std::vector<PlotSeries>& series_;
  const PlotOptions& options_;
  Axis x_;
  Axis y_;
};

}  // namespace

const char kPlotStyle[] = R"(svg { background: #fff; }
svg text { font: 10px sans-serif; fill: #444; }
svg .t { font-weight: bold; }
svg .x { text-anchor: middle; }
svg .y { text-anchor: end; }
svg .a { fill: none; stroke: #444; }
svg .g { stroke: #eee; }
svg .d { stroke: #d62728; }
)";

std::string MakeSvgPlot(const std::vector<PlotSeries>& series,
                        const PlotOptions& options) {
  return Plot(series, options).Draw();
}

}  // namespace graspdb
