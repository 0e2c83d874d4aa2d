#include "server/routes/grasp_texts.h"

#include <fmt/format.h>

#include "server/codec/record_json.h"

namespace graspdb {

std::shared_ptr<const std::string> GraspTexts::Get(const StoredGrasp& grasp,
                                                   const HandModel& hand) {
  // A transfer that was deleted and done again has the same ids.
  const std::string key = fmt::format("{} {} {}", grasp.id, grasp.object_id,
                                      grasp.physical.value_or(-1.0));
  if (auto known = cache_.Find(key)) return *known;
  auto text = std::make_shared<const std::string>(ToJson(grasp, hand));
  cache_.Insert(key, text, static_cast<int64_t>(text->size()));
  return text;
}

}  // namespace graspdb
