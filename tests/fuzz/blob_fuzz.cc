// Blobs of a database file and what the decoding helper says: neither is
// trusted. What can be decoded is encoded to the same bytes. The first byte
// chooses.

#include "server/decode/decode_protocol.h"
#include "server/store/blob_codec.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {
namespace {

template <class Decode, class Encode>
void RoundTrip(std::string_view bytes, const Decode& decode,
               const Encode& encode) {
  const auto value = decode(bytes);
  if (value) Require(encode(*value) == bytes);
}

TriangleMesh MakeTetrahedron() {
  return {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

}  // namespace

std::vector<std::string> MakeSeeds() {
  const TriangleMesh mesh = MakeTetrahedron();
  Part part;
  part.solid_O = mesh;
  part.num_surface_faces = 3;
  part.object_faces = {4, 5, 6};
  GraspBlob grasp;
  grasp.grasp.configuration.q = Eigen::VectorXd::LinSpaced(8, 0.0, 1.0);
  grasp.grasp.q_pregrasp = Eigen::VectorXd::Zero(8);
  grasp.grasp.contacts = {{1, {0, 0, 0}, {0, 0, 1}, 0.0}};
  grasp.targets_O = {Eigen::Vector3d(0, 0, 0)};
  DecodeAnswer answer;
  answer.mesh_O = mesh;
  answer.work_O = mesh;
  answer.repairs = {"closed a hole"};
  answer.format = "OBJ";
  answer.confinement = "seccomp";
  answer.cloud = DecodedCloud{{}, 0.5, mesh.vertices()};
  answer.cloud->report.spacing = 0.001;
  DecodeRequest request;
  request.file_name = "a.obj";
  request.metres_per_unit = 0.001;
  HandTree hand;
  hand.links.resize(2);
  hand.links[0].name = "palm";
  hand.links[1].name = "jaw";
  hand.links[1].parent = 0;
  hand.links[1].joint.name = "slide";
  hand.links[1].joint.upper = 1.0;
  hand.links[1].pieces = {{"jaw.obj", {}}};
  const auto text = [](const std::vector<uint8_t>& bytes) {
    return std::string(bytes.begin(), bytes.end());
  };
  return {"m" + EncodeMesh(mesh),
          "i" + EncodeIndices({1, 2, 3}),
          "p" + EncodePoints(mesh.vertices()),
          "x" + EncodePose(RigidTransform::Identity()),
          "s" + EncodePart(part),
          "c" + EncodeConfigurations({grasp.grasp.configuration}),
          "g" + EncodeGrasp(grasp),
          "a" + text(EncodeAnswer(answer)),
          "a" + text(EncodeAnswer(
                    Error{ErrorCode::kUnusableInput, "no", "hint", "mesh"})),
          "h" + text(EncodeHandAnswer(hand)),
          "r" + text(EncodeRequest(request)) + "v 0 0 0"};
}

}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace graspdb;
  using namespace graspdb::fuzz;
  if (size == 0) return 0;
  const auto bytes = AsText(data + 1, size - 1);
  switch (data[0]) {
    case 'm':
      RoundTrip(bytes, DecodeMesh, EncodeMesh);
      break;
    case 'i':
      RoundTrip(bytes, DecodeIndices, EncodeIndices);
      break;
    case 'p':
      RoundTrip(bytes, DecodePoints, EncodePoints);
      break;
    case 'x':
      RoundTrip(bytes, DecodePose, EncodePose);
      break;
    case 's':
      RoundTrip(bytes, DecodePart, EncodePart);
      break;
    case 'c':
      RoundTrip(bytes, DecodeConfigurations, EncodeConfigurations);
      break;
    case 'g':
      RoundTrip(bytes, DecodeGrasp, EncodeGrasp);
      break;
    case 'a':
      if (const auto answer = ParseAnswer({data + 1, size - 1});
          answer && answer->has_value()) {
        Require(IsClosed((*answer)->mesh_O) && IsClosed((*answer)->work_O));
      }
      break;
    case 'h':
      if (const auto hand = ParseHandAnswer({data + 1, size - 1});
          hand && hand->has_value()) {
        Require(CheckHandTree(**hand).has_value());
      }
      break;
    case 'r': {
      std::span<const uint8_t> mesh;
      if (const auto request = ParseRequest({data + 1, size - 1}, &mesh)) {
        Require(mesh.size() < size && request->work_triangles >= 4);
      }
      break;
    }
    default:
      break;
  }
  return 0;
}
