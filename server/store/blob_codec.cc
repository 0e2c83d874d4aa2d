#include "server/store/blob_codec.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace graspdb {
namespace {

static_assert(std::endian::native == std::endian::little,
              "blobs are little-endian");

constexpr uint8_t kVersion = 1;
enum class Kind : uint8_t {
  kMesh = 1,
  kIndices = 2,
  kPose = 3,
  kPart = 4,
  kConfigurations = 5,
  kGrasp = 6,
  kPoints = 7,
};
constexpr size_t kOverhead = 2 + 4;  // Version, kind; CRC-32.

// CRC-32 of IEEE 802.3, reflected.
uint32_t CalcCrc32(std::string_view bytes) {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> entries{};
    for (uint32_t i = 0; i < 256; ++i) {
      uint32_t crc = i;
      for (int bit = 0; bit < 8; ++bit) {
        crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
      }
      entries[i] = crc;
    }
    return entries;
  }();
  uint32_t crc = 0xFFFFFFFFu;
  for (const char c : bytes) {
    crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xFF] ^ (crc >> 8);
  }
  return ~crc;
}

class Writer {
 public:
  explicit Writer(Kind kind) {
    Put(kVersion);
    Put(kind);
  }
  void PutInt(int value) { Put(static_cast<int32_t>(value)); }
  void PutSize(size_t size) {
    GRASPDB_EXPECTS(size <= std::numeric_limits<int32_t>::max());
    Put(static_cast<int32_t>(size));
  }
  void PutDouble(double value) { Put(value); }
  void PutVector(const Eigen::VectorXd& vector) {
    PutSize(static_cast<size_t>(vector.size()));
    for (const double x : vector) PutDouble(x);
  }
  void PutPoint(const Eigen::Vector3d& point) {
    for (const double x : point) PutDouble(x);
  }
  void PutIndices(const std::vector<int>& indices) {
    PutSize(indices.size());
    for (const int index : indices) PutInt(index);
  }
  // Rows of R, then the translation.
  void PutPose(const RigidTransform& X) {
    for (int row = 0; row < 3; ++row) PutPoint(X.rotation.row(row).transpose());
    PutPoint(X.translation);
  }
  void PutMesh(const TriangleMesh& mesh) {
    PutSize(mesh.vertices().size());
    PutSize(mesh.triangles().size());
    for (const Eigen::Vector3d& vertex : mesh.vertices()) PutPoint(vertex);
    for (const Eigen::Vector3i& triangle : mesh.triangles()) {
      for (const int index : triangle) PutInt(index);
    }
  }
  void PutConfiguration(const HandConfiguration& configuration) {
    PutPose(configuration.X_OH);
    PutVector(configuration.q);
  }
  std::string Finish() && {
    Put(CalcCrc32(bytes_));
    return std::move(bytes_);
  }

 private:
  template <class T>
  void Put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  std::string bytes_;
};

// Reads past the end give zeros and are remembered; Finish() tells.
class Reader {
 public:
  Reader(std::string_view bytes, Kind kind) : sound_(IsSound(bytes, kind)) {
    if (sound_) rest_ = bytes.substr(2, bytes.size() - kOverhead);
  }
  int GetInt() { return Get<int32_t>(); }
  double GetDouble() { return Get<double>(); }
  // A count of items that take at least item_bytes each.
  size_t GetSize(size_t item_bytes) {
    const int32_t size = Get<int32_t>();
    if (size < 0 || static_cast<size_t>(size) > rest_.size() / item_bytes) {
      sound_ = false;
      return 0;
    }
    return static_cast<size_t>(size);
  }
  Eigen::Vector3d GetPoint() {
    const double x = GetDouble();
    const double y = GetDouble();
    const double z = GetDouble();
    return {x, y, z};
  }
  Eigen::VectorXd GetVector() {
    const size_t size = GetSize(sizeof(double));
    Eigen::VectorXd vector(static_cast<Eigen::Index>(size));
    for (double& x : vector) x = GetDouble();
    return vector;
  }
  std::vector<int> GetIndices() {
    std::vector<int> indices(GetSize(sizeof(int32_t)));
    for (int& index : indices) index = GetInt();
    return indices;
  }
  RigidTransform GetPose() {
    RigidTransform X;
    for (int row = 0; row < 3; ++row)
      X.rotation.row(row) = GetPoint().transpose();
    X.translation = GetPoint();
    return X;
  }
  TriangleMesh GetMesh() {
    const size_t num_vertices = GetSize(1);
    const size_t num_triangles = GetSize(1);
    if (num_vertices * 24 + num_triangles * 12 > rest_.size()) sound_ = false;
    if (!sound_) return {};
    std::vector<Eigen::Vector3d> vertices(num_vertices);
    for (Eigen::Vector3d& vertex : vertices) vertex = GetPoint();
    std::vector<Eigen::Vector3i> triangles(num_triangles);
    for (Eigen::Vector3i& triangle : triangles) {
      for (int& index : triangle) {
        index = GetInt();
        if (index < 0 || static_cast<size_t>(index) >= num_vertices) {
          sound_ = false;
          return {};
        }
      }
    }
    return {std::move(vertices), std::move(triangles)};
  }
  HandConfiguration GetConfiguration() {
    HandConfiguration configuration;
    configuration.X_OH = GetPose();
    configuration.q = GetVector();
    return configuration;
  }
  void Reject() { sound_ = false; }
  bool AtEnd() const { return rest_.empty(); }

  template <class T>
  Result<T> Finish(T value) const {
    if (!sound_ || !rest_.empty()) {
      return Error{ErrorCode::kStorage, "A stored value is damaged.",
                   "graspdb check tells which; restore a backup"};
    }
    return value;
  }

 private:
  static bool IsSound(std::string_view bytes, Kind kind) {
    if (bytes.size() < kOverhead) return false;
    uint32_t crc = 0;
    std::memcpy(&crc, bytes.data() + bytes.size() - 4, 4);
    return static_cast<uint8_t>(bytes[0]) == kVersion &&
           static_cast<uint8_t>(bytes[1]) == static_cast<uint8_t>(kind) &&
           crc == CalcCrc32(bytes.substr(0, bytes.size() - 4));
  }
  template <class T>
  T Get() {
    T value{};
    if (rest_.size() < sizeof(T)) {
      sound_ = false;
      rest_ = {};
    } else {
      std::memcpy(&value, rest_.data(), sizeof(T));
      rest_.remove_prefix(sizeof(T));
    }
    return value;
  }

  bool sound_;
  std::string_view rest_;
};

}  // namespace

std::string EncodeMesh(const TriangleMesh& mesh) {
  Writer writer(Kind::kMesh);
  writer.PutMesh(mesh);
  return std::move(writer).Finish();
}

Result<TriangleMesh> DecodeMesh(std::string_view bytes) {
  Reader reader(bytes, Kind::kMesh);
  TriangleMesh mesh = reader.GetMesh();
  return reader.Finish(std::move(mesh));
}

std::string EncodeIndices(const std::vector<int>& indices) {
  Writer writer(Kind::kIndices);
  writer.PutIndices(indices);
  return std::move(writer).Finish();
}

Result<std::vector<int>> DecodeIndices(std::string_view bytes) {
  Reader reader(bytes, Kind::kIndices);
  std::vector<int> indices = reader.GetIndices();
  return reader.Finish(std::move(indices));
}

std::string EncodePoints(const std::vector<Eigen::Vector3d>& points) {
  Writer writer(Kind::kPoints);
  writer.PutSize(points.size());
  for (const Eigen::Vector3d& point : points) writer.PutPoint(point);
  return std::move(writer).Finish();
}

Result<std::vector<Eigen::Vector3d>> DecodePoints(std::string_view bytes) {
  Reader reader(bytes, Kind::kPoints);
  std::vector<Eigen::Vector3d> points(reader.GetSize(3 * sizeof(double)));
  for (Eigen::Vector3d& point : points) point = reader.GetPoint();
  return reader.Finish(std::move(points));
}

std::string EncodePose(const RigidTransform& X_AB) {
  Writer writer(Kind::kPose);
  writer.PutPose(X_AB);
  return std::move(writer).Finish();
}

Result<RigidTransform> DecodePose(std::string_view bytes) {
  Reader reader(bytes, Kind::kPose);
  const RigidTransform X_AB = reader.GetPose();
  return reader.Finish(X_AB);
}

std::string EncodePart(const Part& part) {
  Writer writer(Kind::kPart);
  writer.PutInt(part.label);
  writer.PutInt(part.num_surface_faces);
  writer.PutIndices(part.object_faces);
  writer.PutMesh(part.solid_O);
  return std::move(writer).Finish();
}

Result<Part> DecodePart(std::string_view bytes) {
  Reader reader(bytes, Kind::kPart);
  Part part;
  part.label = reader.GetInt();
  part.num_surface_faces = reader.GetInt();
  part.object_faces = reader.GetIndices();
  part.solid_O = reader.GetMesh();
  if (part.label < 0 || part.num_surface_faces < 0 ||
      part.num_surface_faces > part.solid_O.num_triangles()) {
    reader.Reject();
  }
  return reader.Finish(std::move(part));
}

std::string EncodeConfigurations(
    const std::vector<HandConfiguration>& configurations) {
  Writer writer(Kind::kConfigurations);
  writer.PutSize(configurations.size());
  for (const HandConfiguration& configuration : configurations) {
    writer.PutConfiguration(configuration);
  }
  return std::move(writer).Finish();
}

Result<std::vector<HandConfiguration>> DecodeConfigurations(
    std::string_view bytes) {
  Reader reader(bytes, Kind::kConfigurations);
  std::vector<HandConfiguration> configurations(
      reader.GetSize(12 * sizeof(double) + sizeof(int32_t)));
  for (HandConfiguration& configuration : configurations) {
    configuration = reader.GetConfiguration();
  }
  return reader.Finish(std::move(configurations));
}

std::string EncodeGrasp(const GraspBlob& blob) {
  const Grasp& grasp = blob.grasp;
  Writer writer(Kind::kGrasp);
  writer.PutConfiguration(grasp.configuration);
  writer.PutVector(grasp.q_pregrasp);
  writer.PutPoint(grasp.approach_O);
  writer.PutDouble(grasp.retreat);
  writer.PutSize(grasp.contacts.size());
  for (const Contact& contact : grasp.contacts) {
    writer.PutInt(contact.link);
    writer.PutPoint(contact.p_O);
    writer.PutPoint(contact.nhat_O);
    writer.PutDouble(contact.gap);
  }
  writer.PutSize(blob.targets_O.size());
  for (const auto& target : blob.targets_O) {
    writer.PutInt(target.has_value() ? 1 : 0);
    if (target) writer.PutPoint(*target);
  }
  std::vector<int> unseen;
  for (size_t i = 0; i < grasp.contacts.size(); ++i) {
    if (!grasp.contacts[i].seen) unseen.push_back(static_cast<int>(i));
  }
  if (!unseen.empty()) writer.PutIndices(unseen);
  return std::move(writer).Finish();
}

Result<GraspBlob> DecodeGrasp(std::string_view bytes) {
  Reader reader(bytes, Kind::kGrasp);
  GraspBlob blob;
  Grasp& grasp = blob.grasp;
  grasp.configuration = reader.GetConfiguration();
  grasp.q_pregrasp = reader.GetVector();
  grasp.approach_O = reader.GetPoint();
  grasp.retreat = reader.GetDouble();
  grasp.contacts.resize(reader.GetSize(sizeof(int32_t) + 7 * sizeof(double)));
  for (Contact& contact : grasp.contacts) {
    contact.link = reader.GetInt();
    contact.p_O = reader.GetPoint();
    contact.nhat_O = reader.GetPoint();
    contact.gap = reader.GetDouble();
    if (contact.link < 0) reader.Reject();
  }
  blob.targets_O.resize(reader.GetSize(sizeof(int32_t)));
  for (auto& target : blob.targets_O) {
    if (reader.GetInt() != 0) target = reader.GetPoint();
  }
  if (!reader.AtEnd()) {
    for (const int i : reader.GetIndices()) {
      if (i < 0 || i >= std::ssize(grasp.contacts)) {
        reader.Reject();
      } else {
        grasp.contacts[static_cast<size_t>(i)].seen = false;
      }
    }
  }
  return reader.Finish(std::move(blob));
}

}  // namespace graspdb
