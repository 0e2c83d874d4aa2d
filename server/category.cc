#include "server/category.h"

namespace graspdb {

PartVocabulary MakeVocabulary(const StoredCategory& category) {
  PartVocabulary vocabulary;
  for (const CategoryPart& part : category.parts) {
    vocabulary.labels.push_back(part.label);
  }
  vocabulary.adjacency = category.adjacency;
  return vocabulary;
}

std::vector<std::string> FindPartsForTask(const StoredCategory& category,
                                          const std::string& task) {
  std::vector<std::string> labels;
  for (const CategoryPart& part : category.parts) {
    if (part.tasks.contains(task)) labels.push_back(part.label);
  }
  return labels;
}

std::vector<std::string> FindPartsKeptFree(const StoredCategory& category,
                                           const std::string& task) {
  std::vector<std::string> labels;
  for (const CategoryPart& part : category.parts) {
    if (part.keep_free.contains(task)) labels.push_back(part.label);
  }
  return labels;
}

std::map<std::string, int> IndexParts(const std::vector<CategoryPart>& parts) {
  std::map<std::string, int> indices;
  for (const CategoryPart& part : parts) {
    indices.emplace(part.label, static_cast<int>(indices.size()));
  }
  return indices;
}

}  // namespace graspdb
