#include "server/bench/bench_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/planning/grasp_coverage.h"
#include "server/bench/statistics.h"

namespace graspdb {
namespace {

constexpr double kBetterBy = 1e-6;
constexpr int kTop = 10;

// Pairs of an eps of ours and one to compare it with.
struct Comparison {
  int better{0};
  int count{0};

  void Add(double ours, double other) {
    ++count;
    if (ours > other + kBetterBy) ++better;
  }
  Json Encode() const { return EncodeProportion(better, count); }
};

// How many of the grasps passed, of those that were tried.
Json CountPassed(const std::vector<const StoredGrasp*>& grasps,
                 const std::map<std::string, double>* scores, size_t most) {
  int passed = 0;
  int count = 0;
  for (size_t i = 0; i < std::min(most, grasps.size()); ++i) {
    std::optional<double> score = grasps[i]->physical;
    if (scores != nullptr) {
      const auto found = scores->find(grasps[i]->id);
      score = found == scores->end() ? std::nullopt
                                     : std::optional<double>(found->second);
    }
    if (!score) continue;
    ++count;
    if (*score == 1.0) ++passed;
  }
  return EncodeProportion(passed, count);
}

Json EncodePoint(const StoredAttempt& attempt, const StoredGrasp* transferred,
                 const StoredGrasp* assembled) {
  Json point;
  point["example"] = attempt.example_epsilon;
  point["example_whole"] = attempt.example_epsilon_whole;
  point["open_close_part"] = attempt.open_close_epsilon_part;
  point["open_close_whole"] = attempt.open_close_epsilon_whole;
  point["transferred"] = transferred != nullptr
                             ? Json(transferred->grasp.quality.epsilon)
                             : Json();
  point["assembled"] =
      assembled != nullptr ? Json(assembled->grasp.quality.epsilon) : Json();
  if (assembled == nullptr) return point;
  point["robust"] = assembled->robust ? Json(*assembled->robust) : Json();
  point["physical"] = assembled->physical ? Json(*assembled->physical) : Json();
  return point;
}

void CountOutcome(TransferOutcome outcome, Json& counts) {
  if (outcome == TransferOutcome::kSucceeded) return;
  Json& count = counts[ToString(outcome)];
  count = count.is_null() ? 1 : count.get<int>() + 1;
}

double FindSeconds(const StoredTransfer& transfer, const std::string& stage,
                   const std::string& part) {
  for (const auto& [name, seconds] : transfer.seconds) {
    if (name == MakeCoreStage(stage, part)) return seconds;
  }
  return 0.0;
}

// Adds one proportion to another, which may not be there yet.
void AddProportion(const Json& row, Json& sum) {
  if (sum.is_null()) sum = EncodeProportion(0, 0);
  sum = EncodeProportion(sum["hits"].get<int>() + row["hits"].get<int>(),
                         sum["count"].get<int>() + row["count"].get<int>());
}

}  // namespace

Json EncodeProportion(int hits, int count) {
  const Proportion proportion = CalcProportion(hits, count);
  Json json;
  json["hits"] = hits;
  json["count"] = count;
  json["share"] = proportion.share();
  json["lower"] = proportion.lower;
  json["upper"] = proportion.upper;
  return json;
}

Json MakeLearningRow(const StoredGraspSpace& space, int triangles,
                     const std::vector<Grasp>& grasps,
                     const TriangleMesh& part_O) {
  std::vector<double> epsilons;
  for (const Grasp& grasp : grasps) epsilons.push_back(grasp.quality.epsilon);
  const GraspCoverage coverage = CalcGraspCoverage(grasps, part_O);
  Json row;
  row["category"] = space.category;
  row["part"] = space.part_label;
  row["triangles"] = triangles;
  row["configuration_space_seconds"] = space.configuration_space_seconds;
  row["search_seconds"] = space.seconds - space.configuration_space_seconds;
  row["grasps"] = space.num_grasps;
  row["coverage"] = coverage.approaches;
  row["pair_coverage"] = coverage.pairs;
  row["configurations_tried"] = space.configurations_tried;
  row["median_epsilon"] = CalcQuantile(epsilons, 0.5);
  row["curve"] = Json::array();
  for (const LearningRound& round : space.curve) {
    row["curve"].push_back({{"samples", round.samples},
                            {"support_vectors", round.support_vectors},
                            {"balanced_accuracy", round.balanced_accuracy},
                            {"boundary_accuracy", round.boundary_accuracy}});
  }
  return row;
}

Json MakeTransferRow(const StoredTransfer& transfer, const StoredPart& part,
                     const std::vector<StoredGrasp>& grasps,
                     const TestScores& further) {
  std::map<std::string, const StoredGrasp*> by_id;
  std::vector<const StoredGrasp*> assembled;  // Best first.
  for (const StoredGrasp& grasp : grasps) {
    if (grasp.part_id != part.id) continue;
    by_id[grasp.id] = &grasp;
    if (grasp.stage == GraspStage::kAssembly) assembled.push_back(&grasp);
  }
  int attempted = 0;
  int num_transferred = 0;
  int open_close_part = 0;
  int open_close_whole = 0;
  Comparison over_open_close_part, over_open_close_whole;
  Comparison over_example_part, over_example_whole;
  Json failures = Json::object();
  Json points = Json::array();
  for (const StoredAttempt& attempt : transfer.attempts) {
    if (attempt.part_id != part.id) continue;
    ++attempted;
    open_close_part += attempt.open_close_epsilon_part > 0.0 ? 1 : 0;
    open_close_whole += attempt.open_close_epsilon_whole > 0.0 ? 1 : 0;
    const auto on_part = by_id.find(attempt.transferred_grasp_id);
    const auto on_whole = by_id.find(attempt.assembled_grasp_id);
    const StoredGrasp* first =
        on_part == by_id.end() ? nullptr : on_part->second;
    const StoredGrasp* last =
        on_whole == by_id.end() ? nullptr : on_whole->second;
    if (first != nullptr) {
      ++num_transferred;
      const double epsilon = first->grasp.quality.epsilon;
      over_open_close_part.Add(epsilon, attempt.open_close_epsilon_part);
      over_example_part.Add(epsilon, attempt.example_epsilon);
    }
    if (last != nullptr) {
      const double epsilon = last->grasp.quality.epsilon;
      over_open_close_whole.Add(epsilon, attempt.open_close_epsilon_whole);
      over_example_whole.Add(epsilon, attempt.example_epsilon_whole);
    }
    CountOutcome(first == nullptr ? attempt.transfer : attempt.assembly,
                 failures);
    points.push_back(EncodePoint(attempt, first, last));
  }
  std::vector<double> robust, epsilon;
  double penetration = 0.0;
  for (const StoredGrasp* grasp : assembled) {
    robust.push_back(grasp->robust.value_or(0.0));
    epsilon.push_back(grasp->grasp.quality.epsilon);
    penetration = std::max(penetration, grasp->penetration);
  }
  Json row;
  row["part"] = part.label;
  row["triangles"] = part.faces.size();
  row["attempted"] = attempted;
  row["transferred"] = num_transferred;
  row["assembled"] = assembled.size();
  row["open_close"] = {{"transferred", open_close_part},
                       {"assembled", open_close_whole}};
  row["seconds"] = {
      {"transfer", FindSeconds(transfer, "transfer", part.label)},
      {"assembly", FindSeconds(transfer, "assembly", part.label)}};
  row["over_open_close"] = {{"transferred", over_open_close_part.Encode()},
                            {"assembled", over_open_close_whole.Encode()}};
  row["over_example"] = {{"transferred", over_example_part.Encode()},
                         {"assembled", over_example_whole.Encode()}};
  row["median_epsilon"] = CalcQuantile(epsilon, 0.5);
  row["robust"] = {{"median", CalcQuantile(robust, 0.5)},
                   {"tenth_percentile", CalcQuantile(robust, 0.1)}};
  row["penetration_m"] = penetration;
  constexpr size_t kAll = std::numeric_limits<size_t>::max();
  Json physical;
  physical["six_pushes"] = CountPassed(assembled, nullptr, kAll);
  physical["six_pushes_top_ten"] = CountPassed(assembled, nullptr, kTop);
  for (const auto& [key, scores] : further) {
    physical[key] = CountPassed(assembled, &scores, kAll);
  }
  row["physical"] = std::move(physical);
  row["failures"] = std::move(failures);
  row["points"] = std::move(points);
  return row;
}

Json MakeFailedRow(const std::string& part, int attempts, const Error& error) {
  StoredTransfer nothing;
  nothing.attempts.resize(static_cast<size_t>(attempts));
  Json row = MakeTransferRow(nothing, StoredPart(), {}, {});
  row["part"] = part;
  row["failures"] = {{"object", attempts}};
  row["error"] = error.message;
  return row;
}

Json PoolRows(const std::vector<Json>& rows) {
  Json pool;
  int attempted = 0, transferred = 0, assembled = 0;
  int open_close_part = 0, open_close_whole = 0;
  int least_transferred = std::numeric_limits<int>::max();
  int least_assembled = std::numeric_limits<int>::max();
  double penetration = 0.0;
  std::vector<double> robust;
  Json over_open_close = Json::object(), over_example = Json::object();
  Json physical = Json::object(), failures = Json::object();
  for (const Json& row : rows) {
    attempted += row["attempted"].get<int>();
    transferred += row["transferred"].get<int>();
    assembled += row["assembled"].get<int>();
    open_close_part += row["open_close"]["transferred"].get<int>();
    open_close_whole += row["open_close"]["assembled"].get<int>();
    least_transferred =
        std::min(least_transferred, row["transferred"].get<int>());
    least_assembled = std::min(least_assembled, row["assembled"].get<int>());
    penetration = std::max(penetration, row["penetration_m"].get<double>());
    for (const char* stage : {"transferred", "assembled"}) {
      AddProportion(row["over_open_close"][stage], over_open_close[stage]);
      AddProportion(row["over_example"][stage], over_example[stage]);
    }
    for (const auto& [key, value] : row["physical"].items()) {
      AddProportion(value, physical[key]);
    }
    for (const auto& [reason, count] : row["failures"].items()) {
      Json& sum = failures[reason];
      sum = (sum.is_null() ? 0 : sum.get<int>()) + count.get<int>();
    }
    for (const Json& point : row["points"]) {
      if (point.contains("robust") && point["robust"].is_number()) {
        robust.push_back(point["robust"].get<double>());
      }
    }
  }
  pool["rows"] = rows.size();
  pool["attempted"] = attempted;
  pool["transferred"] = EncodeProportion(transferred, attempted);
  pool["assembled"] = EncodeProportion(assembled, attempted);
  pool["least_row"] = {{"transferred", rows.empty() ? 0 : least_transferred},
                       {"assembled", rows.empty() ? 0 : least_assembled}};
  pool["open_close"] = {
      {"transferred", EncodeProportion(open_close_part, attempted)},
      {"assembled", EncodeProportion(open_close_whole, attempted)}};
  pool["over_open_close"] = over_open_close;
  pool["over_example"] = over_example;
  pool["robust"] = {{"median", CalcQuantile(robust, 0.5)},
                    {"tenth_percentile", CalcQuantile(robust, 0.1)}};
  pool["penetration_m"] = penetration;
  pool["physical"] = physical;
  pool["failures"] = failures;
  return pool;
}

}  // namespace graspdb
