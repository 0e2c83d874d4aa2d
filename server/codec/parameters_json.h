#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/parameters/parameters.h"

namespace graspdb {

/** All tunables, sections as objects: {"segmentation": {...}, ...}. Canonical:
 equal parameters give equal text. */
std::string ParametersToJson(const Parameters& parameters);

/** `base` with the fields that the text names replaced; "preset": "default" or
 "paper" replaces the base first.
 @retval kInvalidArgument naming the first field that is unknown, of the wrong
   type or out of range, and what it takes. */
Result<Parameters> ParametersFromJson(const std::string& text,
                                      const Parameters& base);

/** The segmentation section alone, in the same way. */
Result<SegmentationParameters> SegmentationFromJson(
    const std::string& text, const SegmentationParameters& base);

/** Canonical, as ParametersToJson(). */
std::string SegmentationToJson(const SegmentationParameters& parameters);

/** GET /v1/parameters: {"items": [{"name", "value", "unit", "minimum",
 "maximum", "source"}, ...], "presets": {...}, "next_cursor": null}. */
std::string DescribeParameters();

}  // namespace graspdb
