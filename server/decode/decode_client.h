#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_tree.h"
#include "server/decode/decode_protocol.h"

namespace graspdb {

struct DecoderOptions {
  /** The helper program; empty: graspdb-decode beside the running program. */
  std::string helper;
  double deadline{20.0};                   ///< Of one mesh, wall clock, s.
  int64_t memory_bytes{int64_t{1} << 30};  ///< Of one helper.
  /** Decode even where the kernel cannot confine the helper. */
  bool allow_unsandboxed{false};
};

/** A mesh file, admitted: frame O is the frame of the file. */
struct DecodedMesh {
  TriangleMesh mesh_O;               ///< Closed, repaired, full resolution.
  TriangleMesh work_O;               ///< Decimated for the search, or the same.
  std::vector<std::string> repairs;  ///< One sentence per step; often empty.
  MassProperties mass;               ///< Of mesh_O.
  std::string format;                ///< "OBJ", "glTF", "PCD", ….
  std::optional<DecodedCloud> cloud{};  ///< Unset for a mesh.
  DecodeSeconds seconds{};
};

/** What became of the files since the program started. */
struct DecodeCounts {
  int64_t admitted{0};
  int64_t refused{0};    ///< By the helper, with a reason.
  int64_t crashed{0};    ///< The helper died, or talked nonsense.
  int64_t timed_out{0};  ///< It missed the deadline.
  int64_t unstarted{0};  ///< It could not be started or confined.
};

/** Admits mesh files and URDFs without ever touching their bytes: a confined
 helper program reads one and dies. Thread-safe. */
class Decoder {
 public:
  explicit Decoder(DecoderOptions options = {});

  /** @param bytes  A mesh file, hostile or not.
   @retval kUnusableInput when the bytes are no mesh, no solid can be made, the
     size cannot be that of a graspable object, or the helper crashed, ran out
     of memory or missed the deadline on them.
   @retval kTooLarge over one of request.limits.
   @retval kCancelled as soon as the context is.
   @retval kInternal when the helper cannot be started or confined.
   @pre metres_per_unit is positive and finite, work_triangles >= 4. */
  Result<DecodedMesh> Decode(std::span<const uint8_t> bytes,
                             const DecodeRequest& request,
                             const ExecutionContext& context = {}) const;

  /** What a URDF says of a hand, see ReadUrdf().
   @retval kUnusableInput when it says nothing that a hand can be, or the helper
     crashed, ran out of memory or missed the deadline on it.
   @retval kTooLarge over 1 MiB.
   @retval kCancelled as soon as the context is.
   @retval kInternal when the helper cannot be started or confined. */
  Result<HandTree> DecodeUrdf(const std::string& urdf,
                              const ExecutionContext& context = {}) const;

  /** Decodes a small solid: for a server to call before it starts to serve.
   @returns how the helper is confined: "landlock and seccomp", "seccomp" (the
     kernel has no landlock) or "none" (only if allowed).
   @retval kInternal as Decode(). */
  Result<std::string> Check() const;

  DecodeCounts counts() const;

 private:
  void Add(const DecodeCounts& counts) const;

  DecoderOptions options_;
  mutable std::mutex mutex_;
  mutable DecodeCounts counts_;
};

}  // namespace graspdb
