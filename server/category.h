#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/segmentation/part_segmentation.h"

/** @file
 What the database keeps of a category; one of the records of records.h. */

namespace graspdb {

inline constexpr size_t kMostParts = 64;  ///< Of a category.
inline constexpr size_t kMostTasks = 64;  ///< Of a part.

/** A part that objects of a category have, and what it is good for. */
struct CategoryPart {
  std::string label;
  std::map<std::string, std::string> tasks;  ///< Task name → note for people.
  /** Tasks in which the hand keeps off this part → why. */
  std::map<std::string, std::string> keep_free;

  bool operator==(const CategoryPart&) const = default;
};

struct StoredCategory {
  std::string name;  ///< [a-z0-9][a-z0-9_-]{0,63}
  std::string title;
  std::vector<CategoryPart> parts;  ///< In the order of the label indices.
  std::vector<std::pair<int, int>> adjacency;  ///< Of label indices.
  SegmentationParameters segmentation;
  std::string created_at;

  bool operator==(const StoredCategory&) const = default;
};

PartVocabulary MakeVocabulary(const StoredCategory& category);

/** The labels of the category's parts that serve a task. */
std::vector<std::string> FindPartsForTask(const StoredCategory& category,
                                          const std::string& task);

/** Those that the hand keeps off in a task; none for an empty one. */
std::vector<std::string> FindPartsKeptFree(const StoredCategory& category,
                                           const std::string& task);

/** The label index of each label. */
std::map<std::string, int> IndexParts(const std::vector<CategoryPart>& parts);

}  // namespace graspdb
