#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/result.h"
#include "server/cli/progress.h"
#include "server/jobs/service.h"

namespace graspdb {

/** What `graspdb render` is to draw: one of the ids. */
struct RenderOrder {
  std::string grasp_id;
  std::string transfer_id;  ///< Its best grasps, as a contact sheet.
  std::string object_id;    ///< Its parts, without hands.
  int count{12};            ///< Most grasps on a sheet.
  int width{800};           ///< Of the picture, or of one cell; pixels.
  int height{600};
};

/** What a client's subcommands need, either from a database file or from a
 server. Answers are the JSON of schema/openapi.yaml. */
class Backend {
 public:
  virtual ~Backend() = default;

  /** @param deadline  Seconds after which what was found is the answer. */
  virtual Result<std::string> Grasp(const TransferOrder& order,
                                    std::optional<double> deadline,
                                    Progress& progress) = 0;
  virtual Result<std::string> Query(const GraspSearch& search) = 0;
  /** Stores the mesh as an object; answers it with its parts. */
  virtual Result<std::string> Segment(const ImportOrder& order,
                                      Progress& progress) = 0;
  /** Answers the list of the object's grasp spaces. */
  virtual Result<std::string> Learn(const LearnOrder& order,
                                    Progress& progress) = 0;
  /** Answers a PNG file. */
  virtual Result<std::string> Render(const RenderOrder& order) = 0;
};

std::unique_ptr<Backend> MakeLocalBackend(Service& service);
/** @param url  "http://host:port".
 @retval kInvalidArgument when it is no such URL. */
Result<std::unique_ptr<Backend>> MakeRemoteBackend(const std::string& url);

}  // namespace graspdb
