#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** "1 face", "2 faces". */
std::string DescribeCount(std::size_t count, const char* one, const char* many);

/** Collects one sentence per step of a repair; a step that did nothing says
 nothing. */
class RepairLog {
 public:
  /** "welded 1 vertex", "welded 12 vertices". */
  void Add(const char* verb, std::size_t count, const char* one,
           const char* many);
  void Add(std::string sentence) { sentences_.push_back(std::move(sentence)); }
  const std::vector<std::string>& sentences() const { return sentences_; }

 private:
  std::vector<std::string> sentences_;
};

/** Triangles without any topology yet; metres. */
struct TriangleSoup {
  using Face = std::array<std::size_t, 3>;
  std::vector<Eigen::Vector3d> points;
  std::vector<Face> faces;
};

TriangleSoup MakeSoup(const TriangleMesh& mesh);

/** The mesh without the vertices that no face uses. */
TriangleMesh DropUnusedVertices(const TriangleMesh& mesh, RepairLog& log);

/** Why no solid can be made of a mesh, if that is plain to see: no faces, a
 coordinate that is not finite, no area, all points in one plane (thinner than
 1/10,000 of the diagonal). */
std::optional<std::string> FindHopelessness(const TriangleMesh& mesh);

/** Welds open edges' vertices within 1/100,000 of the diagonal, drops
 degenerate and duplicate faces, and splits faces so that no vertex lies inside
 another face's open edge. In a closed surface a face without height does its
 duty and stays. The result may have no faces.
 @pre FindHopelessness() finds none. */
TriangleSoup CleanSoup(const TriangleMesh& mesh, RepairLog& log);

}  // namespace graspdb
