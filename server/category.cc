#include "server/category.h"

namespace graspdb {
namespace {

// The labels of the parts whose notes name a task.
std::vector<std::string> FindParts(
    const StoredCategory& category,
    std::map<std::string, std::string> CategoryPart::*notes,
    const std::string& task) {
  std::vector<std::string> labels;
  for (const CategoryPart& part : category.parts) {
    if ((part.*notes).contains(task)) labels.push_back(part.label);
  }
  return labels;
}

}  // namespace

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
  return FindParts(category, &CategoryPart::tasks, task);
}

std::vector<std::string> FindPartsKeptFree(const StoredCategory& category,
                                           const std::string& task) {
  return FindParts(category, &CategoryPart::keep_free, task);
}

std::map<std::string, int> IndexParts(const std::vector<CategoryPart>& parts) {
  std::map<std::string, int> indices;
  for (const CategoryPart& part : parts) {
    indices.emplace(part.label, static_cast<int>(indices.size()));
  }
  return indices;
}

}  // namespace graspdb
