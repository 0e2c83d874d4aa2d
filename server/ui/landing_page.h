#pragma once

#include <string>
#include <vector>

namespace graspdb {

/** One line of the landing page. */
struct Operation {
  std::string method;
  std::string path;
};

/** What a browser sees at "/": the operations and how to send a first mesh.
 Plain HTML without scripts. */
std::string MakeLandingPage(const std::vector<Operation>& operations);

}  // namespace graspdb
