#include "server/bench/svg_plot.h"

#include <algorithm>
#include <cmath>

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

class Plot {
 public:
  Plot(const std::vector<PlotSeries>& series, const PlotOptions& options)
      : series_(series), options_(options) {
    x_max_ = options.x_max;
    y_max_ = options.y_max;
    for (const PlotSeries& one : series) {
      for (size_t i = 0; i < one.x.size(); ++i) {
        if (options.x_max == 0.0) x_max_ = std::max(x_max_, one.x[i]);
        if (options.y_max == 0.0) y_max_ = std::max(y_max_, one.y[i]);
      }
    }
    if (options.diagonal) x_max_ = y_max_ = std::max(x_max_, y_max_);
    if (x_max_ <= 0.0) x_max_ = 1.0;
    if (y_max_ <= options.y_min) y_max_ = options.y_min + 1.0;
  }

  std::string Draw() const {
    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "role=\"img\"><title>{2}</title>"
        "<text x=\"{3}\" y=\"13\" class=\"t\">{2}</text>",
        kWidth, kHeight, EscapeMarkup(options_.title), kLeft);
    svg += DrawAxes();
    if (options_.diagonal) {
      svg += fmt::format(
          "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" class=\"d\"/>", X(0.0),
          Y(0.0), X(x_max_), Y(y_max_));
    }
    for (const PlotSeries& one : series_) svg += DrawSeries(one);
    if (series_.size() > 1) svg += DrawLegend();
    return svg + "</svg>";
  }

 private:
  double X(double x) const {
    return kLeft + (kWidth - kLeft - kRight) * std::clamp(x / x_max_, 0.0, 1.0);
  }
  double Y(double y) const {
    const double share = (y - options_.y_min) / (y_max_ - options_.y_min);
    return kHeight - kBottom -
           (kHeight - kTop - kBottom) * std::clamp(share, 0.0, 1.0);
  }

  std::string DrawAxes() const {
    const double floor = kHeight - kBottom;
    std::string svg = fmt::format("<path d=\"M{} {}V{}H{}\" class=\"a\"/>",
                                  kLeft, kTop, floor, kWidth - kRight);
    const double x_step = CalcTickStep(x_max_);
    for (int i = 0; i * x_step <= x_max_ * (1.0 + 1e-9); ++i) {
      svg +=
          fmt::format("<text x=\"{:.1f}\" y=\"{}\" class=\"x\">{:.4g}</text>",
                      X(i * x_step), floor + 12.0, i * x_step);
    }
    const double y_step = CalcTickStep(y_max_ - options_.y_min);
    for (int i = 0; options_.y_min + i * y_step <= y_max_ * (1.0 + 1e-9); ++i) {
      const double y = options_.y_min + i * y_step;
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
  double x_max_{0.0};
  double y_max_{0.0};
};

}  // namespace

std::string MakeSvgPlot(const std::vector<PlotSeries>& series,
                        const PlotOptions& options) {
  return Plot(series, options).Draw();
}

}  // namespace graspdb
