#pragma once

namespace graspdb {

/** What Visit() tells of one tunable beside its name and value. */
struct ParameterInfo {
  const char* unit;    ///< SI; "1" when dimensionless.
  double minimum;      ///< Least value accepted.
  double maximum;      ///< Greatest value accepted.
  const char* source;  ///< "paper …" or "ours: …", why this value.
};

// Each struct of parameters lists its fields once, in Visit(): names, units,
// ranges and sources for GET /v1/parameters, validation, JSON and the parameter
// hash all come from there. A visitor is called as visitor(name, field, info)
// for a double, int or bool, and visitor(name, section) for a nested struct.

}  // namespace graspdb
