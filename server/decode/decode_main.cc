// graspdb-decode: reads one request and the bytes of a mesh file or a URDF from
// standard input inside a sandbox, writes one answer to standard output. The
// server starts one per file; see decode_client.h.

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <sys/prctl.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include "engine/admission/graspable_size.h"
#include "engine/admission/mesh_decimation.h"
#include "engine/admission/mesh_reader.h"
#include "engine/admission/mesh_repair.h"
#include "engine/admission/point_cloud_reader.h"
#include "engine/admission/surface_reconstruction.h"
#include "engine/base/thread_clock.h"
#include "engine/geometry/seen_surface.h"
#include "engine/hand/urdf_reader.h"
#include "server/decode/decode_protocol.h"
#include "server/decode/sandbox.h"

namespace graspdb {
namespace {

std::vector<uint8_t> ReadStandardInput() {
  std::vector<uint8_t> bytes;
  std::size_t size = 0;
  while (true) {
    if (bytes.size() - size < (1 << 16)) bytes.resize(2 * size + (1 << 18));
    const ssize_t got =
        read(STDIN_FILENO, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

bool WriteStandardOutput(std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return true;
}

double CalcSeenShare(const TriangleMesh& mesh, const SeenSurface& seen) {
  double area = 0.0;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (seen.Shows(mesh.centroid(f))) area += mesh.area(f);
  }
  return std::min(1.0, area / mesh.total_area());
}

// What each of three steps took.
class StepClock {
 public:
  void EndRead() { seconds_.read = Lap(); }
  void EndRepair() { seconds_.repair = Lap(); }
  void EndDecimate() { seconds_.decimate = Lap(); }
  const DecodeSeconds& seconds() const { return seconds_; }

 private:
  double Lap() {
    const double now = ThreadSeconds();
    return now - std::exchange(last_, now);
  }

  double last_{ThreadSeconds()};
  DecodeSeconds seconds_;
};

Result<DecodeAnswer> AdmitCloud(const DecodeRequest& request,
                                std::span<const uint8_t> bytes,
                                MeshFormat format) {
  StepClock clock;
  const double metres_per_unit = request.metres_per_unit.value_or(1.0);
  GRASPDB_TRY(points_O,
              ReadPointCloud(bytes, format, metres_per_unit, request.limits));
  GRASPDB_TRY_VOID(
      CheckGraspableSize(TriangleMesh(points_O, {}), metres_per_unit));
  GRASPDB_TRY(surface, ReconstructSurface(points_O));
  clock.EndRead();
  GRASPDB_TRY(repaired, RepairMesh(surface.mesh_O));
  clock.EndRepair();
  GRASPDB_TRY(work_O, Decimate(repaired.mesh, request.work_triangles));
  clock.EndDecimate();
  DecodedCloud cloud{surface.report, 0.0, std::move(surface.points_O)};
  cloud.seen_share = CalcSeenShare(
      repaired.mesh, SeenSurface(cloud.points_O, CalcSeenReach(cloud.report)));
  std::vector<std::string> steps = std::move(surface.steps);
  steps.insert(steps.end(), repaired.repairs.begin(), repaired.repairs.end());
  return DecodeAnswer{std::move(repaired.mesh),
                      std::move(work_O),
                      std::move(steps),
                      GetName(format),
                      "",
                      std::move(cloud),
                      clock.seconds()};
}

Result<DecodeAnswer> Admit(const DecodeRequest& request,
                           std::span<const uint8_t> bytes) {
  StepClock clock;
  MeshFormat format{};
  if (request.format) {
    format = *request.format;
  } else {
    GRASPDB_TRY(guess, GuessMeshFormat(bytes, request.file_name));
    format = guess;
  }
  if (HoldsPointsOnly(bytes, format)) {
    return AdmitCloud(request, bytes, format);
  }
  GRASPDB_TRY(soup_O,
              ReadMesh(bytes, format, request.metres_per_unit, request.limits));
  GRASPDB_TRY_VOID(
      CheckGraspableSize(soup_O, request.metres_per_unit.value_or(1.0)));
  clock.EndRead();
  GRASPDB_TRY(repaired, RepairMesh(soup_O));
  clock.EndRepair();
  GRASPDB_TRY(work_O, Decimate(repaired.mesh, request.work_triangles));
  clock.EndDecimate();
  return DecodeAnswer{std::move(repaired.mesh),
                      std::move(work_O),
                      std::move(repaired.repairs),
                      GetName(format),
                      "",
                      std::nullopt,
                      clock.seconds()};
}

Result<DecodeAnswer> AnswerMesh(std::span<const uint8_t> bytes,
                                const std::string& confinement) {
  std::span<const uint8_t> mesh;
  const auto request = ParseRequest(bytes, &mesh);
  if (!request) {
    return Error{ErrorCode::kInternal,
                 "graspdb-decode got no request on its standard input",
                 "The server starts this program by itself."};
  }
  GRASPDB_TRY(answer, Admit(*request, mesh));
  answer.confinement = confinement;
  return std::move(answer);
}

Result<HandTree> AnswerUrdf(std::span<const uint8_t> urdf) try {
  return ReadUrdf(std::string(urdf.begin(), urdf.end()));
} catch (const std::exception&) {
  return Error{ErrorCode::kUnusableInput, "the decoder failed on the URDF",
               "Check it with check_urdf.", "urdf"};
}

std::vector<uint8_t> AnswerRequest(const std::string& confinement) try {
  const std::vector<uint8_t> bytes = ReadStandardInput();
  if (const auto urdf = ParseUrdfRequest(bytes)) {
    return EncodeHandAnswer(AnswerUrdf(*urdf));
  }
  return EncodeAnswer(AnswerMesh(bytes, confinement));
} catch (const std::bad_alloc&) {
  return EncodeAnswer(
      Error{ErrorCode::kUnusableInput,
            "the mesh needs more memory than its decoding may use",
            "Decimate or repair the mesh first.", "mesh"});
} catch (const std::exception&) {
  return EncodeAnswer(Error{ErrorCode::kUnusableInput,
                            "the decoder failed on the mesh",
                            "Check the mesh in a mesh editor.", "mesh"});
}

int Run(int argc, char** argv) {
  CLI::App app{
      "Decodes one mesh or URDF in a sandbox; graspdb starts it by itself."};
  SandboxLimits limits;
  bool allow_unsandboxed = false;
  bool probe = false;
  app.add_option("--memory", limits.memory_bytes, "Most bytes of memory");
  app.add_option("--cpu", limits.cpu_seconds, "Most seconds of computing");
  app.add_flag("--allow-unsandboxed", allow_unsandboxed,
               "Decode even where the kernel offers no sandbox");
  app.add_flag("--probe", probe,
               "Try ten forbidden system calls inside the sandbox");
  CLI11_PARSE(app, argc, argv);

  prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto confinement = EnterSandbox(limits);
  if (probe && confinement) return ProbeSandbox() == 0 ? 0 : 1;
  if (!confinement && !allow_unsandboxed) {
    WriteStandardOutput(EncodeAnswer(confinement.error()));
    return 1;
  }
  return WriteStandardOutput(AnswerRequest(confinement ? *confinement : "none"))
             ? 0
             : 1;
}

}  // namespace
}  // namespace graspdb

int main(int argc, char** argv) {
  // Without the destructors of libraries: nothing is left to do for them.
  _exit(graspdb::Run(argc, argv));
}
