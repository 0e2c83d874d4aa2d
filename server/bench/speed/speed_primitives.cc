#include "server/bench/speed/speed_primitives.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/random.h"
#include "engine/cspace/configuration_space.h"
#include "engine/cspace/svm.h"
#include "engine/dynamics/closing_simulation.h"
#include "engine/planning/grasp_evaluator.h"
#include "engine/quality/contact_extraction.h"
#include "engine/quality/epsilon_quality.h"
#include "engine/quality/wrench_space.h"
#include "engine/reference/cgal_surface.h"
#include "engine/reference/fcl_hand.h"
#include "engine/reference/qhull_wrenches.h"
#include "engine/segmentation/shape_diameter.h"
#include "server/bench/speed/speed_scene.h"

namespace graspdb {
namespace {

constexpr double kMicro = 1e-6;
constexpr int kFewContacts = 3;
constexpr int kManyContacts = 7;
constexpr int kPostures = 64;
constexpr int kPoints = 1024;
constexpr double kAround = 0.02;  // Of the box, m.
// CGAL's shape diameters take too long beyond.
constexpr int kMostSdfTriangles = 10'000;
constexpr int kTrainingSamples = 5000;
constexpr double kPenalty = 10.0;
constexpr double kGamma = 1.0;

// The next of a list at each call, around and around.
template <class T>
class Cycle {
 public:
  explicit Cycle(const std::vector<T>& all) : all_(all) {}
  const T& Next() { return all_[i_++ % all_.size()]; }

 private:
  const std::vector<T>& all_;
  size_t i_{0};
};

class PrimitiveBench {
 public:
  PrimitiveBench(std::shared_ptr<const HandModel> hand,
                 const StopwatchOptions& options)
      : hand_(std::move(hand)), options_(options) {}

  std::vector<SpeedRow> Run(const std::vector<TriangleMesh>& meshes) {
    for (const TriangleMesh& mesh : meshes) MeasureObject(mesh);
    const SpeedScene scene = MakeSpeedScene(hand_, meshes[meshes.size() / 2]);
    MeasureHand(scene);
    MeasureClosing(scene);
    MeasureQuality(scene);
    MeasureLearning(scene);
    return std::move(rows_);
  }

 private:
  template <class F>
  Timing Time(const F& f) const {
    return TimeCalls(f, options_);
  }

  void Add(SpeedRow row) { rows_.push_back(std::move(row)); }

  // What depends on how fine the object is.
  void MeasureObject(const TriangleMesh& mesh) {
    const SpeedScene scene = MakeSpeedScene(hand_, mesh, kPostures, 0);
    for (const bool free : {true, false}) {
      const auto& postures = free ? scene.free : scene.colliding;
      std::vector<std::vector<RigidTransform>> X_HL;
      for (const HandConfiguration& one : postures) {
        X_HL.push_back(CalcLinkPoses(scene.hand.model(), one.q));
      }
      const auto time = [&](const auto& find) {
        size_t i = 0;
        return Time([&] {
          const size_t k = i++ % postures.size();
          return find(scene.hand, postures[k].X_OH, X_HL[k], scene.solid);
        });
      };
      Add({fmt::format("hand-object test, {}", free ? "free" : "colliding"),
           mesh.num_triangles(), time(FindCollidingLink),
           LibraryTiming{"FCL collide", time(FindCollidingLinkByFcl)},
           10 * kMicro});
    }
    std::vector<Eigen::Vector3d> points(kPoints);
    Random random(2);
    for (Eigen::Vector3d& p : points) {
      for (int k = 0; k < 3; ++k) {
        p[k] = random.NextUniform(mesh.box_min()[k] - kAround,
                                  mesh.box_max()[k] + kAround);
      }
    }
    const CgalSurface cgal(mesh);
    Cycle<Eigen::Vector3d> ours(points);
    Cycle<Eigen::Vector3d> theirs(points);
    Add({"nearest point", mesh.num_triangles(), Time([&] {
           return scene.solid.index().FindClosest(ours.Next())->distance;
         }),
         LibraryTiming{"CGAL AABB_tree",
                       Time([&] { return cgal.CalcDistance(theirs.Next()); })},
         std::nullopt});
    Cycle<Eigen::Vector3d> looked_up(points);
    Add({"distance from the field", mesh.num_triangles(),
         Time([&] { return scene.solid.field().Calc(looked_up.Next()); }),
         std::nullopt, std::nullopt});
    Add({"solid with distance field", mesh.num_triangles(),
         Time([&] { return Solid(mesh).field().cell_size(); }),
         TimeFieldByCgal(scene.solid, cgal), std::nullopt});
    std::optional<LibraryTiming> sdf;
    if (mesh.num_triangles() <= kMostSdfTriangles) {
      sdf = {"CGAL sdf_values",
             Time([&] { return cgal.CalcShapeDiameters()[0]; })};
    }
    Add({"shape diameters", mesh.num_triangles(),
         Time([&] { return CalcShapeDiameters(mesh)[0]; }), sdf, std::nullopt});
  }

  // As many distances as the field has nodes, of which a few are measured.
  LibraryTiming TimeFieldByCgal(const Solid& solid,
                                const CgalSurface& cgal) const {
    constexpr int64_t kStride = 256;
    const int64_t nodes =
        solid.field().bytes() / static_cast<int64_t>(sizeof(float)) / kStride;
    Timing timing = Time([&] {
      Random random(3);
      double sum = 0.0;
      for (int64_t i = 0; i < nodes; ++i) {
        Eigen::Vector3d p;
        for (int k = 0; k < 3; ++k) {
          p[k] = random.NextUniform(solid.mesh_O().box_min()[k] - kAround,
                                    solid.mesh_O().box_max()[k] + kAround);
        }
        sum += cgal.CalcDistance(p);
      }
      return sum;
    });
    for (double& seconds : timing.samples) seconds *= kStride;
    return {"CGAL AABB_tree, a point for each node (1 in 256 taken)",
            std::move(timing)};
  }

  // @param X_HL  Of each of the scene's grasps.
  Timing TimeDistanceByFcl(
      const SpeedScene& scene,
      const std::vector<std::vector<RigidTransform>>& X_HL) const {
    size_t i = 0;
    return Time([&] {
      const size_t at = i++ % X_HL.size();
      return CalcDistanceByFcl(scene.hand, scene.grasps[at].configuration.X_OH,
                               X_HL[at], scene.solid);
    });
  }

  void MeasureHand(const SpeedScene& scene) {
    const HandModel& model = scene.hand.model();
    Cycle<HandConfiguration> open(scene.free);
    Add({"forward kinematics", std::nullopt, Time([&] {
           return CalcLinkPoses(model, open.Next().q).back().translation.x();
         }),
         std::nullopt, std::nullopt});
    std::vector<std::vector<RigidTransform>> X_HL;
    for (const Grasp& grasp : scene.grasps) {
      X_HL.push_back(CalcLinkPoses(model, grasp.configuration.q));
    }
    Cycle<std::vector<RigidTransform>> ours(X_HL);
    Cycle<std::vector<RigidTransform>> theirs(X_HL);
    Add({"self-collision", std::nullopt, Time([&] {
           return FindSelfCollision(scene.hand, ours.Next()).has_value();
         }),
         LibraryTiming{"FCL collide", Time([&] {
                         return CollidesWithItselfByFcl(scene.hand,
                                                        theirs.Next());
                       })},
         std::nullopt});
    size_t i = 0;
    Add({"gap to the object, estimated", std::nullopt, Time([&] {
           const size_t at = i++ % X_HL.size();
           const RigidTransform& X_OH = scene.grasps[at].configuration.X_OH;
           double least = 1e300;
           for (int link = 0; link < model.num_links(); ++link) {
             if (!scene.hand.link(link)) continue;
             least = std::min(
                 least, EstimateGap(*scene.hand.link(link),
                                    X_OH * X_HL[at][static_cast<size_t>(link)],
                                    scene.solid));
           }
           return least;
         }),
         LibraryTiming{"FCL distance", TimeDistanceByFcl(scene, X_HL)},
         std::nullopt});
  }

  void MeasureClosing(const SpeedScene& scene) {
    Cycle<Grasp> fcl(scene.grasps);
    const LibraryTiming by_fcl{"FCL collide, steps and bisections", Time([&] {
                                 const Grasp& one = fcl.Next();
                                 return CloseFingersByFcl(
                                            scene.hand, one.configuration.X_OH,
                                            one.q_pregrasp, scene.solid)
                                     .sum();
                               })};
    for (const bool exact : {false, true}) {
      const Precision precision =
          exact ? Precision::kExact : Precision::kEstimated;
      const char* how = exact ? "exact" : "estimated";
      Cycle<Grasp> closed(scene.grasps);
      Add({fmt::format("finger closing, {}", how), std::nullopt, Time([&] {
             const Grasp& one = closed.Next();
             return CloseFingers(scene.hand, one.configuration.X_OH,
                                 one.q_pregrasp, scene.solid, precision)
                 .sum();
           }),
           by_fcl, exact ? std::nullopt : std::optional<double>(30 * kMicro)});
      Cycle<Grasp> judged(scene.grasps);
      Add({fmt::format("closing, contacts and eps, {}", how), std::nullopt,
           Time([&] {
             const Grasp& one = judged.Next();
             return CloseAndJudge(scene.hand, one.configuration.X_OH,
                                  one.q_pregrasp, scene.solid, scene.parameters,
                                  precision)
                 .grasp.quality.epsilon;
           }),
           std::nullopt, std::nullopt});
    }
    const ClosingSimulation simulation(scene.hand, scene.solid,
                                       scene.parameters.hold,
                                       scene.parameters.motors);
    for (const Push push : {Push::kNone, Push::kPlusX}) {
      Cycle<Grasp> simulated(scene.grasps);
      Add({push == Push::kNone ? "simulated closing"
                               : "simulated closing and push",
           std::nullopt, Time([&] {
             const Grasp& one = simulated.Next();
             return simulation
                 .Run(one.configuration.X_OH, one.q_pregrasp,
                      scene.parameters.contact.friction, push)
                 .shift;
           }),
           std::nullopt, std::nullopt});
    }
  }

  void MeasureQuality(const SpeedScene& scene) {
    std::vector<std::vector<RigidTransform>> X_HL;
    for (const Grasp& grasp : scene.grasps) {
      X_HL.push_back(CalcLinkPoses(scene.hand.model(), grasp.configuration.q));
    }
    size_t i = 0;
    Add({"contact extraction", std::nullopt, Time([&] {
           const size_t at = i++ % X_HL.size();
           return ExtractContacts(scene.hand,
                                  scene.grasps[at].configuration.X_OH, X_HL[at],
                                  scene.solid, scene.parameters.contact)
               .size();
         }),
         LibraryTiming{"FCL distance, one point a link",
                       TimeDistanceByFcl(scene, X_HL)},
         std::nullopt});
    for (int count = kFewContacts; count <= kManyContacts; ++count) {
      MeasureEpsilon(
          fmt::format("eps of {} contacts", count),
          ChooseContacts(scene, static_cast<size_t>(count)),
          count <= 6 ? std::optional<double>(20 * kMicro) : std::nullopt);
    }
    MeasureEpsilon("eps of all contacts of a grasp", ChooseContacts(scene, 0),
                   std::nullopt);
    Cycle<Grasp> hybrid(scene.grasps);
    Add({"hybrid measure, Eq. (1)", std::nullopt, Time([&] {
           return CalcHybrid(scene.hand, hybrid.Next(), scene.solid,
                             scene.parameters);
         }),
         std::nullopt, std::nullopt});
    Cycle<Grasp> gripped(scene.grasps);
    Add({"what the motors balance", std::nullopt, Time([&] {
           return CalcGrip(scene.hand, gripped.Next(), scene.solid.mass(),
                           scene.parameters);
         }),
         std::nullopt, std::nullopt});
  }

  // Of each grasp that has as many; 0: all.
  static std::vector<Wrenches> ChooseContacts(const SpeedScene& scene,
                                              size_t count) {
    std::vector<Wrenches> all;
    for (const Grasp& grasp : scene.grasps) {
      const size_t has = grasp.contacts.size();
      const size_t wanted = count == 0 ? has : count;
      if (has < wanted) continue;
      std::vector<Contact> some;
      for (size_t k = 0; k < wanted; ++k) {
        some.push_back(grasp.contacts[k * has / wanted]);
      }
      all.push_back(CalcContactWrenches(some, scene.solid.mass(),
                                        scene.parameters.contact));
    }
    return all;
  }

  void MeasureEpsilon(const std::string& name, const std::vector<Wrenches>& all,
                      std::optional<double> goal) {
    if (all.empty()) return;
    Cycle<Wrenches> ours(all);
    Cycle<Wrenches> theirs(all);
    Add({name, std::nullopt,
         Time([&] { return CalcEpsilonQuality(ours.Next()); }),
         LibraryTiming{"qhull",
                       Time([&] { return CalcEpsilonByQhull(theirs.Next()); })},
         goal});
  }

  // The pieces of active learning.
  void MeasureLearning(const SpeedScene& scene) {
    const ConfigurationSpace space(scene.hand, scene.solid);
    Random random(3);
    Eigen::MatrixXd features;
    std::vector<bool> labels;
    std::vector<HandPosture> postures;
    for (int i = 0; i < kTrainingSamples; ++i) {
      postures.push_back(space.Sample(random));
      const Eigen::VectorXd column = space.CalcFeatures(postures.back());
      if (features.size() == 0) {
        features.resize(column.size(), kTrainingSamples);
      }
      features.col(i) = column;
      labels.push_back(space.Collides(postures.back()));
    }
    Cycle<HandPosture> labelled(postures);
    Cycle<HandPosture> by_fcl(postures);
    Add({"label of a configuration", std::nullopt,
         Time([&] { return space.Collides(labelled.Next()); }),
         LibraryTiming{"FCL collide", Time([&] {
                         const HandPosture& one = by_fcl.Next();
                         const HandModel& model = scene.hand.model();
                         const auto X_HL = CalcLinkPoses(
                             model, model.CalcCoupledJoints(one.actuators));
                         return FindCollidingLinkByFcl(scene.hand, one.X_OH,
                                                       X_HL,
                                                       scene.solid) >= 0 ||
                                CollidesWithItselfByFcl(scene.hand, X_HL);
                       })},
         std::nullopt});
    Add({fmt::format("classifier of {} labels", kTrainingSamples), std::nullopt,
         Time([&] {
           return Svm(features, labels, kPenalty, kGamma)
               .support_vectors()
               .size();
         }),
         std::nullopt, std::nullopt});
  }

  const std::shared_ptr<const HandModel> hand_;
  const StopwatchOptions options_;
  std::vector<SpeedRow> rows_;
};

}  // namespace

std::vector<SpeedRow> MeasurePrimitives(std::shared_ptr<const HandModel> hand,
                                        const std::vector<TriangleMesh>& meshes,
                                        const StopwatchOptions& options) {
  return PrimitiveBench(std::move(hand), options).Run(meshes);
}

}  // namespace graspdb
