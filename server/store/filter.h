#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/store/database.h"

namespace graspdb::store {

/** A WHERE clause and the values of its parameters, in order. */
class Filter {
 public:
  void Add(const std::string& condition) {
    sql_ += (sql_.empty() ? "WHERE " : " AND ") + condition;
  }
  /** column = value, unless the value is empty. */
  void AddText(const std::string& column, const std::string& value) {
    if (value.empty()) return;
    Add(column + " = ?");
    binders_.push_back([value](Statement& s) { s.Bind(value); });
  }
  /** Several values do not use the index, so that the order still can. */
  void AddAnyOf(const std::string& column,
                const std::vector<std::string>& values) {
    if (values.size() == 1) return AddText(column, values.front());
    if (values.empty()) return;
    std::string marks;
    for (const std::string& value : values) {
      marks += marks.empty() ? "?" : ", ?";
      binders_.push_back([value](Statement& s) { s.Bind(value); });
    }
    Add("+" + column + " IN (" + marks + ")");
  }
  /** A condition with as many question marks as there are values. */
  template <class... Values>
  void AddValues(const std::string& condition, Values... values) {
    Add(condition);
    binders_.push_back([=](Statement& s) { s.Bind(values...); });
  }
  const std::string& sql() const { return sql_; }
  void Bind(Statement& statement) const {
    for (const auto& bind : binders_) bind(statement);
  }

 private:
  std::string sql_;
  std::vector<std::function<void(Statement&)>> binders_;
};

}  // namespace graspdb::store
