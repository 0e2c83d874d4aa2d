#include "server/routes/grasp_texts.h"

#include <fmt/format.h>

#include "server/codec/record_json.h"

namespace graspdb {
namespace {

std::string FormatKey(const GraspKey& key) {
  return fmt::format("{} {} {}", key.id, key.object_id,
                     key.physical.value_or(-1.0));
}

}  // namespace

Result<std::shared_ptr<const std::string>> GraspTexts::Get(
    const GraspKey& key, const Service& service) {
  if (auto known = cache_.Find(FormatKey(key))) return *std::move(known);
  GRASPDB_TRY(grasp, service.store().FindGrasp(key.id));
  GRASPDB_TRY(hand, service.FindHandModel(grasp.hand));
  auto text = std::make_shared<const std::string>(ToJson(grasp, *hand));
  // It may have been judged since the key was read.
  cache_.Insert(FormatKey({grasp.id, grasp.object_id, grasp.physical}), text,
                static_cast<int64_t>(text->size()));
  return std::shared_ptr<const std::string>(std::move(text));
}

}  // namespace graspdb
