#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_model.h"
#include "engine/parameters/transfer_parameters.h"
#include "engine/segmentation/part.h"

namespace graspdb::workshop {

/** A box centred at the origin, edges of `size` metres cut into `cells` squares
 of two triangles each. */
TriangleMesh MakeBox(const Eigen::Vector3d& size, int cells = 1);

/** A cylinder about z, centred at the origin. */
TriangleMesh MakeCylinder(double radius, double height, int sides = 64,
                          int rings = 16);

/** A sphere about the origin. */
TriangleMesh MakeSphere(double radius, int rings = 32);

/** Reads an OBJ's `v` and triangular `f` lines, nothing else. */
TriangleMesh ParseObj(const std::string& text);
/** The same of a file. @pre It exists. */
TriangleMesh LoadObj(const std::string& path);

/** A mesh of data/<category> and its labels. */
LabelledMesh LoadObject(const std::string& category, const std::string& name);

/** data/<name>/category.json. */
struct Category {
  std::string name;
  PartVocabulary vocabulary;
  SegmentationParameters segmentation;
  std::vector<std::string> examples;
  std::vector<std::string> novel;
};
Category LoadCategory(const std::string& name);

/** A mesh of data/mug and its labels. */
LabelledMesh LoadMug(const std::string& name);

/** body and handle, which touch. */
PartVocabulary MakeMugVocabulary();

/** The Barrett hand of data/hands. */
std::shared_ptr<const HandModel> LoadBarrettHand();

/** A parallel gripper: two jaws that slide towards each other along x, 80 mm
 apart when open, approaching along z. */
std::shared_ptr<const HandModel> MakeTwoJawGripper();

/** The hand with the axes of some joints turned round, so that they mimic
 backwards: they are at -q where they were at q. No finger breaks away. */
std::shared_ptr<const HandModel> TurnRound(const HandModel& hand,
                                           const std::vector<int>& joints);

/** The place of a joint among the hand's, -1 when it has none of that name. */
int FindJoint(const HandModel& hand, const std::string& name);

}  // namespace graspdb::workshop
