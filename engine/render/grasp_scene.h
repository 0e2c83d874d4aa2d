#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_model.h"
#include "engine/render/scene_renderer.h"

namespace graspdb {

/** The colour of the part with the given label: Okabe and Ito's palette, which
 people of every colour vision can tell apart, repeated when it runs out.
 @pre label >= 0. */
Rgb PartColour(int label);

/** A hand on an object, in the object's frame O. */
struct PosedHand {
  const HandModel* hand{nullptr};
  HandConfiguration configuration;
  Eigen::Vector3d approach_O{Eigen::Vector3d::UnitZ()};  ///< Unit.
  std::vector<Eigen::Vector3d> contacts_O;               ///< m.
};

/** The object coloured by part, each hand in light grey with its base darker,
 and each contact as a small dark sphere.
 @pre face_labels is empty (one colour) or holds one label per face; no hand is
   null. */
std::vector<RenderItem> MakeGraspScene(const TriangleMesh& mesh_O,
                                       const std::vector<int>& face_labels,
                                       const std::vector<PosedHand>& hands);

/** The view turned about its up axis, by a multiple of 45 degrees, so that the
 hand is seen from the side rather than along its approach, and the place that
 it holds (a handle, say) beside the object's middle rather than before or
 behind it. */
View TurnTowards(const TriangleMesh& mesh_O, const PosedHand& hand,
                 const View& view);

/** One cell of a contact sheet: an object with one hand. */
struct SheetCell {
  const TriangleMesh* mesh_O{nullptr};
  std::vector<int> face_labels;
  PosedHand hand;
  std::string caption;  ///< Digits, letters and " .,:;-+/%=#()_" are drawn.
};

/** Many grasps at a glance: cells in rows from left to right, each `cell` large
 and turned by TurnTowards(), with its caption. Captions that are wider than
 their cell are cut.
 @pre columns >= 1; the preconditions of MakeGraspScene() and RenderScene(). */
Image RenderContactSheet(const std::vector<SheetCell>& cells, int columns,
                         const View& cell);

}  // namespace graspdb
