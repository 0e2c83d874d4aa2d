#pragma once

#include <limits>
#include <string>

#include "engine/base/random.h"
#include "server/ids.h"
#include "server/store/store.h"

/** @file
 Records to store, small but with every field filled, from a seed. */

namespace graspdb {

inline TriangleMesh MakePlainBox(const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i) {
    vertices.emplace_back(i & 1 ? size.x() : 0.0, i & 2 ? size.y() : 0.0,
                          i & 4 ? size.z() : 0.0);
  }
  return {vertices,
          {{0, 2, 3},
           {0, 3, 1},
           {4, 5, 7},
           {4, 7, 6},
           {0, 1, 5},
           {0, 5, 4},
           {2, 6, 7},
           {2, 7, 3},
           {0, 4, 6},
           {0, 6, 2},
           {1, 3, 7},
           {1, 7, 5}}};
}

inline StoredCategory MakeMugCategory() {
  StoredCategory category;
  category.name = "mug";
  category.title = "Mugs";
  category.parts = {{"body", {{"handover", "hold it"}}, {}},
                    {"handle",
                     {{"use", "to drink"}, {"pour", ""}},
                     {{"handover", "the other takes it"}}}};
  category.adjacency = {{0, 1}};
  category.segmentation.max_residual = 0.2;
  return category;
}

inline StoredHand MakeClaw() {
  StoredHand hand;
  hand.name = "claw";
  hand.title = "A claw";
  hand.urdf = "<robot name=\"claw\"/>";
  hand.annotations = "{}";
  hand.meshes = {{"meshes/palm.obj", MakePlainBox({0.1, 0.1, 0.02})},
                 {"meshes/finger.obj", MakePlainBox({0.02, 0.02, 0.1})}};
  hand.sha256 = CalcSha256(hand.urdf + hand.annotations);
  return hand;
}

inline Eigen::Vector3d MakePoint(Random& random) {
  return 0.1 * random.NextInUnitBall();
}

inline RigidTransform MakePose(Random& random) {
  return {random.NextRotation(), MakePoint(random)};
}

inline Eigen::VectorXd MakeJoints(Random& random, int count) {
  Eigen::VectorXd q(count);
  for (double& angle : q) angle = random.NextUniform(-2.0, 2.0);
  return q;
}

inline Grasp MakeGrasp(Random& random, int num_joints = 8) {
  Grasp grasp;
  grasp.configuration = {MakePose(random), MakeJoints(random, num_joints)};
  grasp.q_pregrasp = MakeJoints(random, num_joints);
  grasp.approach_O = random.NextUnitVector();
  grasp.retreat = 0.1;
  for (int i = 0; i < 3; ++i) {
    grasp.contacts.push_back({i, MakePoint(random), random.NextUnitVector(),
                              random.NextUniform(0.0, 5e-4)});
  }
  grasp.quality = {random.NextUniform(), random.NextUniform(),
                   random.NextUniform(0.0, 60.0)};
  return grasp;
}

/** A box of two parts: its lower six faces and its upper six. */
inline NewObject MakeNewObject(const std::string& bytes, ObjectRole role) {
  NewObject object;
  object.bytes = bytes;
  StoredObject& record = object.record;
  record.sha256 = CalcSha256(bytes);
  record.role = role;
  record.category = "mug";
  record.name = "A mug";
  record.file_name = "mug.obj";
  record.format = "obj";
  record.units = "mm";
  record.num_bytes = static_cast<int64_t>(bytes.size());
  const TriangleMesh mesh = MakePlainBox({0.08, 0.09, 0.1});
  record.num_triangles = mesh.num_triangles();
  record.num_work_triangles = mesh.num_triangles();
  record.box_min = mesh.box_min();
  record.box_max = mesh.box_max();
  record.mass = CalcMassProperties(mesh);
  record.repairs = {"welded 2 vertices", "closed 1 hole"};
  record.segmentation.method = "transfer";
  record.segmentation.verdict = "matched";
  Random random(7);
  record.segmentation.X_NE = MakePose(random);
  record.segmentation.scale = 1.25;
  record.segmentation.residual = 0.03;
  record.segmentation.similarity = 0.9;
  record.segmentation.warnings = {"the handle is small"};
  object.meshes.canonical = object.meshes.work = mesh;
  object.meshes.canonical_labels = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  object.meshes.work_labels = object.meshes.canonical_labels;
  for (int label = 0; label < 2; ++label) {
    StoredPart part;
    part.label = label == 0 ? "body" : "handle";
    part.label_index = label;
    Part solid;
    solid.label = label;
    solid.solid_O = mesh;
    solid.num_surface_faces = 6;
    for (int face = 6 * label; face < 6 * label + 6; ++face) {
      part.faces.push_back(face);
      solid.object_faces.push_back(face);
    }
    part.area = 0.02;
    part.volume = 3e-4;
    part.confidence = solid.confidence = 0.75;
    part.adjacent = {label == 0 ? "handle" : "body"};
    object.parts.push_back(part);
    object.solids.push_back(solid);
  }
  return object;
}

inline GraspSpace MakeGraspSpace(uint64_t seed, int num_grasps) {
  Random random(seed);
  GraspSpace space;
  for (int i = 0; i < num_grasps; ++i) {
    space.grasps.push_back(MakeGrasp(random));
    space.clearances.push_back(
        {0.001 * i, std::numeric_limits<double>::infinity()});
  }
  space.curve = {{2000, 120, 0.81, 0.7}, {2500, 150, 0.9, 0.85}};
  space.support_vectors = {{MakePose(random), MakeJoints(random, 8)},
                           {MakePose(random), MakeJoints(random, 8)}};
  space.configurations_tried = 12'000;
  space.coverage = 0.4;
  return space;
}

inline StoredGraspSpace MakeSpaceRecord(const StoredPart& part, uint64_t seed) {
  StoredGraspSpace record;
  record.object_id = part.object_id;
  record.part_id = part.id;
  record.part_label = part.label;
  record.category = "mug";
  record.hand = "claw";
  record.parameters = "{}";
  record.parameters_hash = MakeContentId(record.parameters);
  record.seed = seed;
  record.engine_version = "0.1.0";
  record.seconds = 12.5;
  record.configuration_space_seconds = 2.5;
  return record;
}

/** A transfer of the space's first grasps to the novel object's part, every
 second one of which could be assembled. */
struct NewTransfer {
  StoredTransfer record;
  std::vector<StoredGrasp> grasps;
};

inline NewTransfer MakeNewTransfer(const StoredGraspSpace& space,
                                   const std::vector<StoredGrasp>& sources,
                                   const StoredPart& novel_part) {
  NewTransfer result;
  StoredTransfer& transfer = result.record;
  transfer.id = MakeContentId("transfer " + space.id + novel_part.id);
  transfer.object_id = novel_part.object_id;
  transfer.example_id = space.object_id;
  transfer.category = "mug";
  transfer.hand = space.hand;
  transfer.part_labels = {novel_part.label};
  transfer.keep_free = {"body"};
  transfer.parameters = "{\"a\":1}";
  transfer.parameters_hash = MakeContentId(transfer.parameters);
  transfer.seed = 0xFFFFFFFFFFFFFFFF;  // All 64 bits survive.
  transfer.engine_version = "0.1.0";
  transfer.similarity = 0.875;
  transfer.warnings = {"one part was not found"};
  transfer.seconds = {{"segment", 0.25}, {"replan", 1.5}};
  Random random(11);
  transfer.contact_maps = {{MakeContentId("map " + transfer.id),
                            transfer.id,
                            space.part_id,
                            novel_part.id,
                            novel_part.label,
                            {MakePose(random), 0.9, 0.01, 0.8}}};
  int index = 0;
  for (const StoredGrasp& source : sources) {
    StoredAttempt attempt;
    attempt.source_grasp_id = source.id;
    attempt.part_id = novel_part.id;
    attempt.part_label = novel_part.label;
    attempt.example_epsilon = 0.5;
    if (index % 2 == 0) {
      StoredGrasp grasp = source;
      grasp.id = MakeGraspId(transfer.id, GraspStage::kAssembly, index);
      grasp.stage = GraspStage::kAssembly;
      grasp.index = index;
      grasp.object_id = novel_part.object_id;
      grasp.part_id = novel_part.id;
      grasp.transfer_id = transfer.id;
      grasp.source_grasp_id = source.id;
      grasp.targets_O = {Eigen::Vector3d(1, 2, 3), std::nullopt,
                         Eigen::Vector3d(4, 5, 6)};
      grasp.robust = 0.96875;
      grasp.grip = 0.625;
      grasp.penetration = 1e-5;
      attempt.transfer = attempt.assembly = TransferOutcome::kSucceeded;
      attempt.assembled_grasp_id = grasp.id;
      result.grasps.push_back(grasp);
    } else {
      attempt.transfer = TransferOutcome::kSucceeded;
      attempt.assembly = TransferOutcome::kPalmCollision;
    }
    transfer.attempts.push_back(attempt);
    ++index;
  }
  return result;
}

}  // namespace graspdb
