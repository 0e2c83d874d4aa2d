#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "engine/math/rigid_transform.h"
#include "server/codec/json.h"

/** @file
 What the encoders of records share; only they include it. */

namespace graspdb {

/** Stored text that is JSON already, made by this program. */
inline Json Parsed(const std::string& text) { return Json::parse(text); }

/** Absent values are null, never empty text. */
inline Json OrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json Encode(const Eigen::Vector3d& vector);

/** The quaternion of the two that has w >= 0. */
Json Encode(const RigidTransform& X);

}  // namespace graspdb
