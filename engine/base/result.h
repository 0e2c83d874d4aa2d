#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "engine/base/contract.h"

namespace graspdb {

/** What went wrong, by kind. server/http/problem.cc maps each to one HTTP
 status. */
enum class ErrorCode {
  kInvalidArgument,   ///< A parameter has a value it must not have.
  kUnusableInput,     ///< Bytes that are no mesh, or a mesh that is no solid.
  kTooLarge,          ///< A limit on bytes, triangles or points is exceeded.
  kNotFound,          ///< A named thing does not exist.
  kConflict,          ///< The request contradicts what is stored.
  kNotInCategory,     ///< The object does not match any example.
  kCancelled,         ///< The caller cancelled.
  kDeadlineExceeded,  ///< The time allowed ran out before any answer.
  kStorage,           ///< The database or disk failed.
  kOverloaded,        ///< Too much is asked for at once.
  kKeyReused,         ///< An idempotency key stands for another request.
  kNotImplemented,    ///< Announced by the contract, not built yet.
  kInternal,          ///< A bug.
};

/** An expected failure: code, a sentence for people, and what to do next. */
struct Error {
  ErrorCode code{ErrorCode::kInternal};
  std::string message;
  std::string hint{};   ///< What to do next; may be empty.
  std::string field{};  ///< The request field at fault; may be empty.

  bool operator==(const Error&) const = default;
};

/** A value or an Error, shaped like C++23's std::expected. */
template <typename T>
class [[nodiscard]] Result {
 public:
  using value_type = T;
  // Implicit on purpose: `return value;` and `return Error{…};`.
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  bool has_value() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return has_value(); }

  /** @pre has_value(). */
  const T& value() const& {
    GRASPDB_EXPECTS(has_value());
    return std::get<T>(state_);
  }
  T& value() & {
    GRASPDB_EXPECTS(has_value());
    return std::get<T>(state_);
  }
  T&& value() && {
    GRASPDB_EXPECTS(has_value());
    return std::get<T>(std::move(state_));
  }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

  /** @pre !has_value(). */
  const Error& error() const {
    GRASPDB_EXPECTS(!has_value());
    return std::get<Error>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

/** Success or an Error. */
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  const Error& error() const {
    GRASPDB_EXPECTS(!has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace graspdb

/** Evaluates a Result; returns its error from the calling function, or binds
 its value: `GRASPDB_TRY(mesh, ReadMesh(bytes));`. */
#define GRASPDB_TRY(name, expression)               \
  auto name##_result = (expression);                \
  if (!name##_result) return name##_result.error(); \
  auto& name = *name##_result

/** The same for Result<void>. */
#define GRASPDB_TRY_VOID(expression)                   \
  do {                                                 \
    if (auto void_result = (expression); !void_result) \
      return void_result.error();                      \
  } while (false)
