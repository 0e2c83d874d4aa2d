#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/hand/hand_tree.h"

namespace graspdb {

/** Reads a hand's URDF, whose joints are revolute with limits or prismatic and
 whose collision shapes are meshes. Not for bytes of strangers: call it in the
 sandbox. From then on urdfdom prints nothing in this process.
 @returns a tree that passes CheckHandTree(), in depth-first order.
 @retval kUnusableInput naming the link or joint at fault. */
Result<HandTree> ReadUrdf(const std::string& urdf);

}  // namespace graspdb
