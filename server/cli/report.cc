#include "server/cli/report.h"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "server/codec/json.h"

namespace graspdb {
namespace {

using Row = std::vector<std::string>;

// Columns as wide as their widest cell; the first is left-aligned.
std::string FormatTable(const std::vector<Row>& rows) {
  std::vector<size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (size_t i = 0; i < row.size(); ++i) {
      line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i])
                     : fmt::format("  {:>{}}", row[i], widths[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string Number(const Json& value, int digits) {
  if (!value.is_number()) return "-";
  return fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::string Text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : "-";
}

std::string List(const Json& values, int digits) {
  std::vector<std::string> numbers;
  for (const Json& value : values) numbers.push_back(Number(value, digits));
  return fmt::format("{}", fmt::join(numbers, " "));
}

std::string FormatGrasps(const Json& grasps) {
  std::vector<Row> rows{{"part", "stage", "eps", "robust", "grip",
                         "position, m", "joints, rad", "grasp"}};
  for (const Json& grasp : grasps) {
    Json joints = Json::array();
    for (const auto& [name, angle] : grasp["joints"].items()) {
      joints.push_back(angle);
    }
    rows.push_back({Text(grasp["part"]), Text(grasp["stage"]),
                    Number(grasp["quality"]["epsilon"], 3),
                    Number(grasp["quality"]["robust"], 2),
                    Number(grasp["quality"]["grip"], 2),
                    List(grasp["X_OH"]["position"], 3), List(joints, 2),
                    Text(grasp["id"])});
  }
  return FormatTable(rows);
}

}  // namespace

std::string ReportTransfer(const std::string& answer) {
  const Json json = Json::parse(answer);
  std::string text;
  if (!json["grasps"].empty()) text += FormatGrasps(json["grasps"]) + "\n";
  const Json& summary = json["summary"];
  text += fmt::format(
      "{} source grasps: {} transferred, {} assembled, {} by open-close\n",
      summary["attempted"].dump(), summary["transferred"].dump(),
      summary["assembled"].is_null() ? "-" : summary["assembled"].dump(),
      summary["baseline_open_close"].dump());
  text += fmt::format(
      "transfer {}  object {}  like {} {} ({})\n", Text(json["transfer_id"]),
      Text(json["object"]["id"]), Text(json["example"]["category"]),
      Text(json["example"]["id"]), Number(json["example"]["similarity"], 2));
  for (const Json& warning : json["warnings"]) {
    text += "warning: " + Text(warning) + "\n";
  }
  return text;
}

std::string ReportGrasps(const std::string& list) {
  const Json json = Json::parse(list);
  if (json["items"].empty()) return "no such grasps\n";
  std::string text = FormatGrasps(json["items"]);
  if (json["next_cursor"].is_string()) {
    text += "more: --cursor " + Text(json["next_cursor"]) + "\n";
  }
  return text;
}

std::string ReportObject(const std::string& object) {
  const Json json = Json::parse(object);
  std::string text =
      fmt::format("object {}: {} triangles, {} x {} x {} m\n", Text(json["id"]),
                  json["triangles"].dump(),
                  Number(json["bounding_box"]["max"][0].get<double>() -
                             json["bounding_box"]["min"][0].get<double>(),
                         3),
                  Number(json["bounding_box"]["max"][1].get<double>() -
                             json["bounding_box"]["min"][1].get<double>(),
                         3),
                  Number(json["bounding_box"]["max"][2].get<double>() -
                             json["bounding_box"]["min"][2].get<double>(),
                         3));
  for (const Json& repair : json["repairs"]) {
    text += "repair: " + Text(repair) + "\n";
  }
  const Json& segmentation = json["segmentation"];
  if (segmentation.is_null()) return text + "not segmented\n";
  text +=
      fmt::format("{}, {} by {}, similarity {}\n", Text(json["category"]),
                  Text(segmentation["verdict"]), Text(segmentation["method"]),
                  Number(segmentation["similarity"], 2));
  std::vector<Row> rows{
      {"part", "faces", "area, m2", "volume, m3", "confidence", "id"}};
  for (const Json& part : json["parts"]) {
    rows.push_back({Text(part["label"]), part["num_faces"].dump(),
                    Number(part["area"], 5), Number(part["volume"], 7),
                    Number(part["confidence"], 2), Text(part["id"])});
  }
  text += FormatTable(rows);
  for (const Json& warning : segmentation["warnings"]) {
    text += "warning: " + Text(warning) + "\n";
  }
  return text;
}

std::string ReportGraspSpaces(const std::string& list) {
  const Json json = Json::parse(list);
  std::vector<Row> rows{
      {"part", "hand", "grasps", "coverage", "seconds", "grasp space"}};
  for (const Json& space : json["items"]) {
    rows.push_back({Text(space["part"]), Text(space["hand"]),
                    space["grasps"].dump(), Number(space["coverage"], 2),
                    Number(space["seconds"], 1), Text(space["id"])});
  }
  return FormatTable(rows);
}

std::string VerificationToJson(const std::vector<VerifiedGrasp>& verified) {
  const PushTest test;
  Json json;
  json["simulator"] = SimulatorVersion();
  json["friction"] = test.friction;
  json["force_n"] = test.force;
  json["mass_kg"] = test.mass;
  json["grasps"] = Json::array();
  for (const auto& [grasp, verdict] : verified) {
    json["grasps"].push_back({{"id", grasp.id},
                              {"object", grasp.object_id},
                              {"category", grasp.category},
                              {"part", grasp.part_label},
                              {"stage", ToString(grasp.stage)},
                              {"physical", verdict.CalcScore()},
                              {"settled", verdict.settled},
                              {"settle_shift_m", verdict.settle_shift},
                              {"settle_turn_rad", verdict.settle_turn},
                              {"shift_m", verdict.shift},
                              {"turn_rad", verdict.turn}});
  }
  return DumpJson(json);
}

std::string ReportVerification(const std::string& verification) {
  const Json json = Json::parse(verification);
  struct Count {
    int all{0};
    int settled{0};
    int held{0};
  };
  std::map<std::pair<std::string, std::string>, Count> counts;
  for (const Json& grasp : json["grasps"]) {
    Count& count = counts[{Text(grasp["category"]), Text(grasp["part"])}];
    ++count.all;
    count.settled += grasp["settled"].get<bool>() ? 1 : 0;
    count.held += grasp["physical"].get<double>() == 1.0 ? 1 : 0;
  }
  std::vector<Row> rows{{"category", "part", "grasps", "settled", "held"}};
  for (const auto& [key, count] : counts) {
    rows.push_back({key.first, key.second, std::to_string(count.all),
                    std::to_string(count.settled),
                    fmt::format("{} ({:.0f} %)", count.held,
                                100.0 * count.held / count.all)});
  }
  return FormatTable(rows) + Text(json["simulator"]) + ", six pushes of " +
         Number(json["force_n"], 1) + " N at friction " +
         Number(json["friction"], 2) + "\n";
}

std::string ReportCheck(const std::string& check) {
  const Json json = Json::parse(check);
  std::string text;
  for (const Json& problem : json["problems"]) text += Text(problem) + "\n";
  for (const auto& [name, count] : json["counts"].items()) {
    text += fmt::format("{:<16} {:>8}\n", name, count.dump());
  }
  return text + (json["sound"].get<bool>() ? "sound\n" : "damaged\n");
}

}  // namespace graspdb
