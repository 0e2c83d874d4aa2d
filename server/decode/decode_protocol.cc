#include "server/decode/decode_protocol.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

namespace graspdb {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr uint32_t kRequestMark = 0x31524447;      // "GDR1"
constexpr uint32_t kAnswerMark = 0x34414447;       // "GDA4"
constexpr uint32_t kUrdfRequestMark = 0x31554447;  // "GDU1"
constexpr uint32_t kHandAnswerMark = 0x31484447;   // "GDH1"
constexpr uint32_t kErrorMark = 0x31454447;        // "GDE1"
constexpr uint8_t kNoFormat = 255;
// Without the names' letters.
constexpr std::size_t kLeastPieceBytes = 100;
constexpr std::size_t kLeastLinkBytes = 200;

bool MayDecoderSay(ErrorCode code) {
  return code == ErrorCode::kInvalidArgument ||
         code == ErrorCode::kUnusableInput || code == ErrorCode::kTooLarge ||
         code == ErrorCode::kInternal;
}

// Whether an array of them holds numbers and nothing else.
template <typename Vector>
constexpr bool IsPacked() {
  return sizeof(Vector) ==
         Vector::SizeAtCompileTime * sizeof(typename Vector::Scalar);
}

class Writer {
 public:
  template <typename T>
  void Write(T value) {
    static_assert(std::is_arithmetic_v<T>);
    const auto* begin = reinterpret_cast<const uint8_t*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof(T));
  }
  void WriteText(const std::string& text) {
    Write<uint64_t>(text.size());
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  // Of vectors of a fixed length.
  template <typename Vector>
  void WriteVectors(const std::vector<Vector>& vectors) {
    static_assert(IsPacked<Vector>());
    Write<uint64_t>(vectors.size());
    const auto* begin = reinterpret_cast<const uint8_t*>(vectors.data());
    bytes_.insert(bytes_.end(), begin, begin + vectors.size() * sizeof(Vector));
  }
  void WritePose(const RigidTransform& X) {
    for (const double x : X.rotation.reshaped()) Write(x);
    for (const double x : X.translation) Write(x);
  }
  void WriteMesh(const TriangleMesh& mesh) {
    WriteVectors(mesh.vertices());
    WriteVectors(mesh.triangles());
  }
  std::vector<uint8_t> TakeBytes() { return std::move(bytes_); }

 private:
  std::vector<uint8_t> bytes_;
};

// After the first failure everything reads as empty and ok() is false.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : rest_(bytes) {}

  bool ok() const { return ok_; }
  std::span<const uint8_t> rest() const { return rest_; }
  bool ReadEverything() const { return ok_ && rest_.empty(); }
  void Require(bool condition) { ok_ = ok_ && condition; }

  template <typename T>
  T Read() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    Require(rest_.size() >= sizeof(T));
    if (!ok_) return value;
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    return value;
  }

  // A count of things that take so many bytes each at least.
  std::size_t ReadCount(std::size_t size) {
    const auto count = Read<uint64_t>();
    Require(count <= rest_.size() / size);
    return ok_ ? count : 0;
  }

  // Anything but printable ASCII becomes a question mark.
  std::string ReadText() {
    std::string text(ReadCount(1), '\0');
    for (char& c : text) {
      const auto byte = Read<uint8_t>();
      c = byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
    }
    return text;
  }

  double ReadFinite() {
    const auto x = Read<double>();
    Require(std::isfinite(x));
    return x;
  }

  template <typename Vector>
  std::vector<Vector> ReadVectors() {
    static_assert(IsPacked<Vector>());
    std::vector<Vector> vectors(ReadCount(sizeof(Vector)));
    const std::size_t size = vectors.size() * sizeof(Vector);
    std::copy_n(rest_.begin(), size,
                reinterpret_cast<uint8_t*>(vectors.data()));
    rest_ = rest_.subspan(size);
    return vectors;
  }

  std::vector<Eigen::Vector3d> ReadPoints() {
    auto points = ReadVectors<Eigen::Vector3d>();
    Require(std::all_of(points.begin(), points.end(),
                        [](const auto& p) { return p.allFinite(); }));
    return points;
  }

  Eigen::Vector3d ReadVector() {
    Eigen::Vector3d v;
    for (double& x : v) x = ReadFinite();
    return v;
  }

  RigidTransform ReadPose() {
    RigidTransform X;
    for (double& x : X.rotation.reshaped()) x = ReadFinite();
    X.translation = ReadVector();
    return X;
  }

  HandTree::Joint ReadJoint() {
    HandTree::Joint joint;
    joint.name = ReadText();
    const auto type = Read<uint8_t>();
    Require(type <= static_cast<uint8_t>(JointType::kPrismatic));
    joint.type = static_cast<JointType>(type);
    joint.X_PJ = ReadPose();
    joint.axis_J = ReadVector();
    joint.lower = ReadFinite();
    joint.upper = ReadFinite();
    joint.mimicked = ReadText();
    joint.ratio = ReadFinite();
    return joint;
  }

  HandTree::Link ReadLink() {
    HandTree::Link link;
    link.name = ReadText();
    link.parent = Read<int>();
    link.joint = ReadJoint();
    link.mass = ReadFinite();
    link.p_LcCM = ReadVector();
    link.pieces.resize(ReadCount(kLeastPieceBytes));
    for (HandTree::Piece& piece : link.pieces) {
      piece.mesh = ReadText();
      piece.X_LM = ReadPose();
    }
    return link;
  }

  // The answer, if it is an error.
  std::optional<Error> ReadError() {
    Reader reader(rest_);
    reader.Require(reader.Read<uint32_t>() == kErrorMark);
    Error error;
    error.code = static_cast<ErrorCode>(reader.Read<uint8_t>());
    reader.Require(MayDecoderSay(error.code));
    error.message = reader.ReadText();
    error.hint = reader.ReadText();
    error.field = reader.ReadText();
    if (!reader.ReadEverything()) return std::nullopt;
    return error;
  }

  DecodedCloud ReadCloud() {
    DecodedCloud cloud;
    cloud.report.num_points = Read<int>();
    cloud.report.num_outliers = Read<int>();
    cloud.report.spacing = ReadFinite();
    cloud.report.noise = ReadFinite();
    cloud.report.one_sided = Read<uint8_t>() == 1;
    cloud.seen_share = ReadFinite();
    cloud.points_O = ReadPoints();
    Require(cloud.report.num_points >= 0 && cloud.report.num_outliers >= 0 &&
            cloud.report.spacing > 0.0 && cloud.report.noise >= 0.0 &&
            cloud.seen_share >= 0.0 && cloud.seen_share <= 1.0 &&
            !cloud.points_O.empty());
    return cloud;
  }

  TriangleMesh ReadMesh() {
    std::vector<Eigen::Vector3d> vertices = ReadPoints();
    auto triangles = ReadVectors<Eigen::Vector3i>();
    const auto count = static_cast<int64_t>(vertices.size());
    Require(
        std::all_of(triangles.begin(), triangles.end(), [count](const auto& t) {
          return t.minCoeff() >= 0 && t.maxCoeff() < count;
        }));
    if (!ok_) return {};
    TriangleMesh mesh(std::move(vertices), std::move(triangles));
    Require(IsClosed(mesh));
    return mesh;
  }

 private:
  std::span<const uint8_t> rest_;
  bool ok_{true};
};

std::vector<uint8_t> EncodeError(const Error& error) {
  Writer writer;
  writer.Write(kErrorMark);
  writer.Write(static_cast<uint8_t>(error.code));
  writer.WriteText(error.message);
  writer.WriteText(error.hint);
  writer.WriteText(error.field);
  return writer.TakeBytes();
}

}  // namespace

std::vector<uint8_t> EncodeRequest(const DecodeRequest& request) {
  Writer writer;
  writer.Write(kRequestMark);
  writer.Write(request.format ? static_cast<uint8_t>(*request.format)
                              : kNoFormat);
  writer.WriteText(request.file_name);
  writer.Write(request.metres_per_unit.value_or(0.0));
  writer.Write(request.limits.max_bytes);
  writer.Write(request.limits.max_triangles);
  writer.Write(request.work_triangles);
  return writer.TakeBytes();
}

std::optional<DecodeRequest> ParseRequest(std::span<const uint8_t> bytes,
                                          std::span<const uint8_t>* mesh) {
  Reader reader(bytes);
  DecodeRequest request;
  reader.Require(reader.Read<uint32_t>() == kRequestMark);
  const auto format = reader.Read<uint8_t>();
  if (format != kNoFormat) {
    reader.Require(format <= static_cast<uint8_t>(MeshFormat::kXyz));
    request.format = static_cast<MeshFormat>(format);
  }
  request.file_name = reader.ReadText();
  if (const auto scale = reader.Read<double>(); scale != 0.0) {
    reader.Require(std::isfinite(scale) && scale > 0.0);
    request.metres_per_unit = scale;
  }
  request.limits.max_bytes = reader.Read<int64_t>();
  request.limits.max_triangles = reader.Read<int64_t>();
  request.work_triangles = reader.Read<int>();
  reader.Require(request.work_triangles >= 4);
  if (!reader.ok()) return std::nullopt;
  *mesh = reader.rest();
  return request;
}

std::vector<uint8_t> EncodeUrdfRequest() {
  Writer writer;
  writer.Write(kUrdfRequestMark);
  return writer.TakeBytes();
}

std::optional<std::span<const uint8_t>> ParseUrdfRequest(
    std::span<const uint8_t> bytes) {
  Reader reader(bytes);
  reader.Require(reader.Read<uint32_t>() == kUrdfRequestMark);
  if (!reader.ok()) return std::nullopt;
  return reader.rest();
}

std::vector<uint8_t> EncodeHandAnswer(const Result<HandTree>& answer) {
  if (!answer) return EncodeError(answer.error());
  Writer writer;
  writer.Write(kHandAnswerMark);
  writer.Write<uint64_t>(answer->links.size());
  for (const HandTree::Link& link : answer->links) {
    writer.WriteText(link.name);
    writer.Write(link.parent);
    writer.WriteText(link.joint.name);
    writer.Write(static_cast<uint8_t>(link.joint.type));
    writer.WritePose(link.joint.X_PJ);
    for (const double x : link.joint.axis_J) writer.Write(x);
    writer.Write(link.joint.lower);
    writer.Write(link.joint.upper);
    writer.WriteText(link.joint.mimicked);
    writer.Write(link.joint.ratio);
    writer.Write(link.mass);
    for (const double x : link.p_LcCM) writer.Write(x);
    writer.Write<uint64_t>(link.pieces.size());
    for (const HandTree::Piece& piece : link.pieces) {
      writer.WriteText(piece.mesh);
      writer.WritePose(piece.X_LM);
    }
  }
  return writer.TakeBytes();
}

std::optional<Result<HandTree>> ParseHandAnswer(
    std::span<const uint8_t> bytes) {
  Reader reader(bytes);
  if (auto error = reader.ReadError()) return *std::move(error);
  reader.Require(reader.Read<uint32_t>() == kHandAnswerMark);
  HandTree tree;
  tree.links.resize(reader.ReadCount(kLeastLinkBytes));
  for (HandTree::Link& link : tree.links) link = reader.ReadLink();
  if (!reader.ReadEverything() || !CheckHandTree(tree)) return std::nullopt;
  return tree;
}

std::vector<uint8_t> EncodeAnswer(const Result<DecodeAnswer>& answer) {
  if (!answer) return EncodeError(answer.error());
  Writer writer;
  writer.Write(kAnswerMark);
  writer.WriteMesh(answer->mesh_O);
  writer.WriteMesh(answer->work_O);
  writer.Write<uint64_t>(answer->repairs.size());
  for (const std::string& repair : answer->repairs) writer.WriteText(repair);
  writer.WriteText(answer->format);
  writer.Write<uint8_t>(answer->cloud.has_value());
  if (answer->cloud) {
    const CloudReport& report = answer->cloud->report;
    writer.Write(report.num_points);
    writer.Write(report.num_outliers);
    writer.Write(report.spacing);
    writer.Write(report.noise);
    writer.Write<uint8_t>(report.one_sided);
    writer.Write(answer->cloud->seen_share);
    writer.WriteVectors(answer->cloud->points_O);
  }
  writer.WriteText(answer->confinement);
  writer.Write(answer->seconds.read);
  writer.Write(answer->seconds.repair);
  writer.Write(answer->seconds.decimate);
  return writer.TakeBytes();
}

std::optional<Result<DecodeAnswer>> ParseAnswer(
    std::span<const uint8_t> bytes) {
  Reader reader(bytes);
  if (auto error = reader.ReadError()) return *std::move(error);
  reader.Require(reader.Read<uint32_t>() == kAnswerMark);
  DecodeAnswer answer;
  answer.mesh_O = reader.ReadMesh();
  answer.work_O = reader.ReadMesh();
  answer.repairs.resize(reader.ReadCount(sizeof(uint64_t)));
  for (std::string& repair : answer.repairs) repair = reader.ReadText();
  answer.format = reader.ReadText();
  if (reader.Read<uint8_t>() == 1) answer.cloud = reader.ReadCloud();
  answer.confinement = reader.ReadText();
  answer.seconds.read = reader.ReadFinite();
  answer.seconds.repair = reader.ReadFinite();
  answer.seconds.decimate = reader.ReadFinite();
  if (!reader.ReadEverything()) return std::nullopt;
  return answer;
}

}  // namespace graspdb
