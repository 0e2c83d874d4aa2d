#pragma once

#include <stdexcept>
#include <string>

namespace graspdb {

/** Thrown when a caller breaks a function's precondition: always a bug in the
 calling code, never an answer to bad input. */
class ContractViolation : public std::logic_error {
  using std::logic_error::logic_error;
};

namespace internal {
[[noreturn]] inline void FailContract(const char* condition, const char* file,
                                      int line) {
  throw ContractViolation(std::string(file) + ":" + std::to_string(line) +
                          ": expected " + condition);
}
}  // namespace internal

}  // namespace graspdb

/** Checks a precondition in every build type. */
#define GRASPDB_EXPECTS(condition)                                       \
  do {                                                                   \
    if (!(condition)) {                                                  \
      ::graspdb::internal::FailContract(#condition, __FILE__, __LINE__); \
    }                                                                    \
  } while (false)
