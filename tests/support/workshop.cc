#include "tests/support/workshop.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/contract.h"
#include "engine/hand/hand_maker.h"
#include "engine/hand/urdf_reader.h"

namespace graspdb::workshop {
namespace {

using nlohmann::json;

const std::string kData = std::string(GRASPDB_SOURCE_DIR) + "/data/";

std::string ReadText(const std::string& path) {
  std::ifstream file(path);
  GRASPDB_EXPECTS(file.good());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Eigen::Vector3d ToVector(const json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(),
          value.at(2).get<double>()};
}

// Joins vertices with equal coordinates as they come.
class MeshBuilder {
 public:
  int AddVertex(const Eigen::Vector3d& p) {
    const auto key =
        std::tuple(std::llround(p.x() * 1e9), std::llround(p.y() * 1e9),
                   std::llround(p.z() * 1e9));
    const auto [it, is_new] =
        index_.try_emplace(key, static_cast<int>(vertices_.size()));
    if (is_new) vertices_.push_back(p);
    return it->second;
  }
  void AddTriangle(int a, int b, int c) {
    if (a != b && b != c && c != a) triangles_.emplace_back(a, b, c);
  }
  void AddQuad(int a, int b, int c, int d) {
    AddTriangle(a, b, c);
    AddTriangle(a, c, d);
  }
  TriangleMesh Build() { return TriangleMesh(vertices_, triangles_); }

 private:
  std::map<std::tuple<long long, long long, long long>, int> index_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
};

// Turns a profile of (radius, z), from the bottom axis to the top axis, about
// z.
TriangleMesh Revolve(const std::vector<std::pair<double, double>>& profile,
                     int sides) {
  MeshBuilder builder;
  const auto vertex = [&](size_t i, int s) {
    const double phi = 2.0 * std::numbers::pi * (s % sides) / sides;
    const auto [r, z] = profile[i];
    return builder.AddVertex({r * std::cos(phi), r * std::sin(phi), z});
  };
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    for (int s = 0; s < sides; ++s) {
      builder.AddQuad(vertex(i, s), vertex(i, s + 1), vertex(i + 1, s + 1),
                      vertex(i + 1, s));
    }
  }
  return builder.Build();
}

}  // namespace

TriangleMesh MakeBox(const Eigen::Vector3d& size, int cells) {
  MeshBuilder builder;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const auto vertex = [&](int i, int j) {
        Eigen::Vector3d p;
        p[axis] = 0.5 * side * size[axis];
        p[(axis + 1) % 3] =
            (static_cast<double>(i) / cells - 0.5) * size[(axis + 1) % 3];
        p[(axis + 2) % 3] =
            (static_cast<double>(j) / cells - 0.5) * size[(axis + 2) % 3];
        return builder.AddVertex(p);
      };
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          if (side > 0) {
            builder.AddQuad(vertex(i, j), vertex(i + 1, j),
                            vertex(i + 1, j + 1), vertex(i, j + 1));
          } else {
            builder.AddQuad(vertex(i, j), vertex(i, j + 1),
                            vertex(i + 1, j + 1), vertex(i + 1, j));
          }
        }
      }
    }
  }
  return builder.Build();
}

TriangleMesh MakeCylinder(double radius, double height, int sides, int rings) {
  std::vector<std::pair<double, double>> profile{{0.0, -0.5 * height}};
  for (int i = 0; i <= rings; ++i) {
    profile.emplace_back(radius,
                         height * (static_cast<double>(i) / rings - 0.5));
  }
  profile.emplace_back(0.0, 0.5 * height);
  return Revolve(profile, sides);
}

TriangleMesh MakeSphere(double radius, int rings) {
  std::vector<std::pair<double, double>> profile;
  for (int i = 0; i <= rings; ++i) {
    const double theta = std::numbers::pi * i / rings;
    // Exactly on the axis at both poles.
    const double r = i == 0 || i == rings ? 0.0 : radius * std::sin(theta);
    profile.emplace_back(r, -radius * std::cos(theta));
  }
  return Revolve(profile, 2 * rings);
}

TriangleMesh ParseObj(const std::string& obj) {
  std::istringstream text(obj);
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::string line;
  while (std::getline(text, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Eigen::Vector3d p;
      words >> p.x() >> p.y() >> p.z();
      vertices.push_back(p);
    } else if (kind == "f") {
      Eigen::Vector3i t;
      for (int k = 0; k < 3; ++k) {
        std::string corner;
        words >> corner;
        t[k] = std::stoi(corner) - 1;
      }
      triangles.push_back(t);
    }
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

TriangleMesh LoadObj(const std::string& path) {
  return ParseObj(ReadText(path));
}

LabelledMesh LoadObject(const std::string& category, const std::string& name) {
  const std::string path = kData + category + "/" + name;
  LabelledMesh object{LoadObj(path + ".obj"), {}};
  const json labels = json::parse(ReadText(path + ".labels.json"));
  object.face_labels.assign(object.mesh_O.num_triangles(), -1);
  for (size_t label = 0; label < labels.at("labels").size(); ++label) {
    const std::string part = labels.at("labels")[label];
    for (const json& range : labels.at("faces").at(part)) {
      for (int f = range.at(0); f < range.at(1); ++f) {
        object.face_labels[f] = static_cast<int>(label);
      }
    }
  }
  return object;
}

LabelledMesh LoadMug(const std::string& name) {
  return LoadObject("mug", name);
}

Category LoadCategory(const std::string& name) {
  const json file = json::parse(ReadText(kData + name + "/category.json"));
  Category category;
  category.name = name;
  std::vector<std::string>& labels = category.vocabulary.labels;
  for (const json& part : file.at("parts")) {
    labels.push_back(part.at("label"));
  }
  const auto index = [&labels](const json& label) {
    return static_cast<int>(
        std::find(labels.begin(), labels.end(), label.get<std::string>()) -
        labels.begin());
  };
  for (const json& pair : file.at("topology")) {
    category.vocabulary.adjacency.emplace_back(index(pair[0]), index(pair[1]));
  }
  const json& settings = file.at("segmentation");
  category.segmentation.max_residual = settings.at("max_residual");
  category.segmentation.min_area_ratio = settings.at("min_area_ratio");
  category.segmentation.max_area_ratio = settings.at("max_area_ratio");
  for (const json& object : file.at("examples")) {
    category.examples.push_back(object.at("name"));
  }
  for (const json& object : file.at("novel")) {
    category.novel.push_back(object.at("name"));
  }
  return category;
}

PartVocabulary MakeMugVocabulary() { return {{"body", "handle"}, {{0, 1}}}; }

std::shared_ptr<const HandModel> LoadBarrettHand() {
  const std::string folder = kData + "hands/barrett-bh8-280/";
  const json notes = json::parse(ReadText(folder + "hand.json"));
  HandAnnotations annotations;
  annotations.name = notes.at("name");
  annotations.approach_H = ToVector(notes.at("approach_axis_H"));
  annotations.closing_force = notes.at("closing_force_n");
  for (const json& a : notes.at("actuators")) {
    annotations.actuators.push_back(
        {a.at("name"), a.at("joint"), a.at("closes")});
  }
  for (const json& b : notes.at("breakaway")) {
    annotations.breakaway.push_back(
        {b.at("joint"), b.at("released_joint"), b.at("ratio")});
  }
  for (const json& c : notes.at("contact_points")) {
    annotations.contact_points.push_back(
        {c.at("link"), ToVector(c.at("p_L")), ToVector(c.at("nhat_L"))});
  }
  for (const json& pair : notes.at("ignored_collisions")) {
    annotations.ignored_collisions.emplace_back(pair.at(0), pair.at(1));
  }
  const auto load = [&folder](const std::string& name) {
    return Result<TriangleMesh>(LoadObj(folder + name));
  };
  return std::make_shared<const HandModel>(
      MakeHand(ReadUrdf(ReadText(folder + "hand.urdf")).value(), annotations,
               load)
          .value());
}

std::shared_ptr<const HandModel> MakeTwoJawGripper() {
  HandModel::Data data;
  data.name = "two-jaw";
  const auto box = [](const Eigen::Vector3d& size, const Eigen::Vector3d& p) {
    return CalcTransformed(MakeBox(size, 4), {Eigen::Matrix3d::Identity(), p});
  };
  data.links.push_back(
      {"base", -1, -1, {box({0.12, 0.03, 0.02}, {0, 0, 0.01})}, 0.5, {}});
  // Each jaw's frame lies at its inner face, 40 mm from the middle when open.
  for (const int side : {-1, 1}) {
    HandJoint joint;
    joint.name = side < 0 ? "left" : "right";
    joint.type = JointType::kPrismatic;
    joint.child_link = side < 0 ? 1 : 2;
    joint.X_PJ.translation = {0.04 * side, 0, 0.02};
    joint.axis_J = {-1.0 * side, 0, 0};
    joint.upper = 0.04;
    joint.actuator = side < 0 ? 0 : 1;
    data.joints.push_back(joint);
    data.links.push_back({joint.name + "_jaw",
                          side < 0 ? 0 : 1,
                          0,
                          {box({0.01, 0.02, 0.06}, {0.005 * side, 0, 0.03})},
                          0.1,
                          {}});
    data.actuators.push_back({joint.name, {side < 0 ? 0 : 1}, true, 0.0, 0.04});
    for (const double z : {0.02, 0.05}) {
      data.contact_points.push_back(
          {side < 0 ? 1 : 2, {0, 0, z}, {-1.0 * side, 0, 0}});
    }
  }
  data.ignored_collisions = {{0, 1}, {0, 2}};
  return std::make_shared<const HandModel>(std::move(data));
}

std::shared_ptr<const HandModel> TurnRound(const HandModel& hand,
                                           const std::vector<int>& joints) {
  HandModel::Data data;
  data.name = hand.name();
  data.links = hand.links();
  data.joints = hand.joints();
  data.actuators = hand.actuators();
  data.contact_points = hand.contact_points();
  data.approach_H = hand.approach_H();
  data.closing_force = hand.closing_force();
  for (HandJoint& joint : data.joints) joint.breakaway_ratio = 0.0;
  for (const int j : joints) {
    HandJoint& joint = data.joints[static_cast<size_t>(j)];
    joint.axis_J = -joint.axis_J;
    std::swap(joint.lower, joint.upper);
    joint.lower = -joint.lower;
    joint.upper = -joint.upper;
    joint.ratio = -joint.ratio;
  }
  const auto& tested = hand.self_collision_pairs();
  for (int b = 0; b < hand.num_links(); ++b) {
    for (int a = 0; a < b; ++a) {
      if (std::find(tested.begin(), tested.end(), std::pair(a, b)) ==
          tested.end()) {
        data.ignored_collisions.emplace_back(a, b);
      }
    }
  }
  return std::make_shared<const HandModel>(std::move(data));
}

int FindJoint(const HandModel& hand, const std::string& name) {
  for (int j = 0; j < hand.num_joints(); ++j) {
    if (hand.joints()[j].name == name) return j;
  }
  return -1;
}

}  // namespace graspdb::workshop
