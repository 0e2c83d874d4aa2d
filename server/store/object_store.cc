#include <algorithm>

#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::CheckIdCursor;
using store::CheckPage;
using store::InsertParts;
using store::MakePage;
using store::ReadObject;
using store::ReadParts;
using store::Throw;
using store::Unwrap;

constexpr char kObjectColumns[] =
    "SELECT id, sha256, role, category, name, file_name, format, units,"
    " num_bytes, num_triangles, num_work_triangles, min_x, min_y, min_z,"
    " max_x, max_y, max_z, volume, area, centre_x, centre_y, centre_z,"
    " max_radius, created_at FROM objects ";

Eigen::Vector3d PointAt(const Statement& row, int column) {
  return {row.Double(column), row.Double(column + 1), row.Double(column + 2)};
}

StoredObject MakeObject(const Statement& row) {
  StoredObject object;
  object.id = row.Text(0);
  object.sha256 = row.Text(1);
  object.role = Unwrap(ParseObjectRole(row.Text(2)));
  object.category = row.Text(3);
  object.name = row.Text(4);
  object.file_name = row.Text(5);
  object.format = row.Text(6);
  object.units = row.Text(7);
  object.num_bytes = row.Int(8);
  object.num_triangles = static_cast<int>(row.Int(9));
  object.num_work_triangles = static_cast<int>(row.Int(10));
  object.box_min = PointAt(row, 11);
  object.box_max = PointAt(row, 14);
  object.mass.volume = row.Double(17);
  object.mass.area = row.Double(18);
  object.mass.p_McCM = PointAt(row, 19);
  object.mass.max_radius = row.Double(22);
  object.created_at = row.Text(23);
  return object;
}

std::vector<std::string> ReadNotes(Database& database, const std::string& id,
                                   const std::string& kind) {
  std::vector<std::string> notes;
  Statement rows = database.Prepare(
      "SELECT note FROM object_notes WHERE object_id = ? AND kind = ?"
      " ORDER BY position");
  rows.Bind(id, kind);
  while (rows.Step()) notes.push_back(rows.Text(0));
  return notes;
}

void WriteNotes(Database& database, const std::string& id,
                const std::string& kind,
                const std::vector<std::string>& notes) {
  for (size_t i = 0; i < notes.size(); ++i) {
    database.Prepare("INSERT INTO object_notes VALUES (?, ?, ?, ?)")
        .Bind(id, kind, static_cast<int64_t>(i), notes[i])
        .Run();
  }
}

std::optional<StoredCloud> ReadCloud(Database& database,
                                     const std::string& id) {
  Statement row = database.Prepare(
      "SELECT num_points, num_outliers, spacing, noise, one_sided, seen_share"
      " FROM clouds WHERE object_id = ?");
  if (!row.Bind(id).Step()) return std::nullopt;
  StoredCloud cloud;
  cloud.report = {static_cast<int>(row.Int(0)), static_cast<int>(row.Int(1)),
                  row.Double(2), row.Double(3), row.Int(4) != 0};
  cloud.seen_share = row.Double(5);
  return cloud;
}

void InsertCloud(Database& database, const std::string& id,
                 const StoredCloud& cloud,
                 const std::vector<Eigen::Vector3d>& points) {
  database.Prepare("INSERT INTO clouds VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(id, cloud.report.num_points, cloud.report.num_outliers,
            cloud.report.spacing, cloud.report.noise, cloud.report.one_sided,
            cloud.seen_share)
      .BindBlob(EncodePoints(points))
      .Run();
}

// What the object's own row does not hold.
void ReadLists(Database& database, StoredObject& object) {
  object.repairs = ReadNotes(database, object.id, "repair");
  object.cloud = ReadCloud(database, object.id);
  Statement row = database.Prepare(
      "SELECT method, verdict, example_id, pose, scale, residual, similarity"
      " FROM segmentations WHERE object_id = ?");
  if (!row.Bind(object.id).Step()) return;
  StoredSegmentation& segmentation = object.segmentation;
  segmentation.method = row.Text(0);
  segmentation.verdict = row.Text(1);
  segmentation.example_id = row.Text(2);
  segmentation.X_NE = Unwrap(DecodePose(row.Blob(3)));
  segmentation.scale = row.Double(4);
  segmentation.residual = row.Double(5);
  segmentation.similarity = row.Double(6);
  segmentation.warnings = ReadNotes(database, object.id, "warning");
}

std::optional<StoredObject> FindByContent(Database& database,
                                          const std::string& sha256,
                                          const std::string& units,
                                          ObjectRole role,
                                          const std::string& category) {
  std::optional<StoredObject> object;
  {
    Statement row =
        database.Prepare(std::string(kObjectColumns) +
                         "WHERE sha256 = ? AND units = ? AND role = ?"
                         " AND ifnull(category, '') = ?");
    if (!row.Bind(sha256, units, ToString(role), category).Step()) {
      return object;
    }
    object = MakeObject(row);
  }
  ReadLists(database, *object);
  return object;
}

// The columns of `objects`, in the order of the schema.
void InsertObjectRow(Database& database, const StoredObject& object) {
  database
      .Prepare(
          "INSERT INTO objects VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
          " ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(object.id, object.sha256, ToString(object.role))
      .BindTextOrNull(object.category)
      .Bind(object.name, object.file_name, object.format, object.units,
            object.num_bytes, object.num_triangles, object.num_work_triangles)
      .Bind(object.box_min.x(), object.box_min.y(), object.box_min.z(),
            object.box_max.x(), object.box_max.y(), object.box_max.z())
      .Bind(object.mass.volume, object.mass.area, object.mass.p_McCM.x(),
            object.mass.p_McCM.y(), object.mass.p_McCM.z(),
            object.mass.max_radius)
      .Bind(object.created_at)
      .Run();
}

// A label blob, or NULL when there are no labels.
void BindLabels(Statement& statement, const std::vector<int>& labels) {
  if (labels.empty()) {
    statement.BindTextOrNull("");
  } else {
    statement.BindBlob(EncodeIndices(labels));
  }
}

void InsertObjectData(Database& database, const std::string& id,
                      const std::string& bytes, const ObjectMeshes& meshes) {
  const bool same = meshes.work == meshes.canonical;
  Statement insert =
      database.Prepare("INSERT INTO object_data VALUES (?, ?, ?, ?, ?, ?)");
  insert.Bind(id).BindBlob(bytes).BindBlob(EncodeMesh(meshes.canonical));
  if (same) {
    insert.BindTextOrNull("");
  } else {
    insert.BindBlob(EncodeMesh(meshes.work));
  }
  BindLabels(insert, meshes.canonical_labels);
  BindLabels(insert, same ? std::vector<int>() : meshes.work_labels);
  insert.Run();
}

ObjectMeshes ReadMeshes(Database& database, const std::string& id) {
  Statement row = database.Prepare(
      "SELECT canonical_mesh, work_mesh, canonical_labels, work_labels"
      " FROM object_data WHERE object_id = ?");
  if (!row.Bind(id).Step()) {
    Throw(ErrorCode::kNotFound, "There is no object '" + id + "'.",
          "GET /v1/objects lists them", "id");
  }
  ObjectMeshes meshes;
  meshes.canonical = Unwrap(DecodeMesh(row.Blob(0)));
  const bool labelled = !row.IsNull(2);
  if (labelled) meshes.canonical_labels = Unwrap(DecodeIndices(row.Blob(2)));
  if (row.IsNull(1)) {
    meshes.work = meshes.canonical;
    meshes.work_labels = meshes.canonical_labels;
  } else {
    meshes.work = Unwrap(DecodeMesh(row.Blob(1)));
    if (labelled) meshes.work_labels = Unwrap(DecodeIndices(row.Blob(3)));
  }
  if (const auto cloud = ReadCloud(database, id)) {
    meshes.cloud_report = cloud->report;
    Statement points =
        database.Prepare("SELECT points FROM clouds WHERE object_id = ?");
    points.Bind(id).Step();
    meshes.cloud = Unwrap(DecodePoints(points.Blob(0)));
  }
  return meshes;
}

void WriteSegmentation(Database& database, const std::string& id,
                       const StoredSegmentation& segmentation) {
  if (segmentation.method.empty()) return;
  database.Prepare("INSERT INTO segmentations VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(id, segmentation.method, segmentation.verdict)
      .BindTextOrNull(segmentation.example_id)
      .BindBlob(EncodePose(segmentation.X_NE))
      .Bind(segmentation.scale, segmentation.residual, segmentation.similarity)
      .Run();
  WriteNotes(database, id, "warning", segmentation.warnings);
}

// "3 grasp spaces and 1 transfer (ids …)" that need an object as it is; empty
// when nothing does.
std::string DescribeDependents(Database& database, const std::string& id) {
  std::string ids;
  int64_t counts[2] = {0, 0};
  const char* queries[2] = {
      "SELECT id FROM grasp_spaces WHERE object_id = ?1 ORDER BY id",
      "SELECT id FROM transfers WHERE object_id = ?1 OR example_id = ?1"
      " ORDER BY id"};
  for (int i = 0; i < 2; ++i) {
    Statement rows = database.Prepare(queries[i]);
    rows.Bind(id);
    while (rows.Step()) {
      if (++counts[i] <= 5) ids += (ids.empty() ? "" : ", ") + rows.Text(0);
    }
  }
  if (counts[0] + counts[1] == 0) return {};
  return std::to_string(counts[0]) + " grasp spaces and " +
         std::to_string(counts[1]) + " transfers depend on it (" + ids + ")";
}

void RefuseOtherParts(Database& database, const std::string& object_id,
                      const std::vector<std::string>& expected) {
  std::vector<std::string> ids;
  for (const StoredPart& part : ReadParts(database, object_id)) {
    ids.push_back(part.id);
  }
  if (ids == expected) return;
  Throw(ErrorCode::kConflict,
        "Object " + object_id + " has been cut anew meanwhile.",
        "send the request again");
}

void RefuseDependents(Database& database, const std::string& id, bool cascade,
                      const std::string& what) {
  const std::string dependents = DescribeDependents(database, id);
  if (cascade || dependents.empty()) return;
  Throw(ErrorCode::kConflict,
        "Object " + id + " cannot be " + what + ": " + dependents + ".",
        "?cascade=true deletes them and their grasps too");
}

}  // namespace

namespace store {

StoredObject ReadObject(Database& database, const std::string& id) {
  StoredObject object;
  {
    Statement row =
        database.Prepare(std::string(kObjectColumns) + "WHERE id = ?");
    if (!row.Bind(id).Step()) {
      Throw(ErrorCode::kNotFound, "There is no object '" + id + "'.",
            "GET /v1/objects lists them", "id");
    }
    object = MakeObject(row);
  }
  ReadLists(database, object);
  return object;
}

void CheckObjects(Database& database, CheckReport& report) {
  std::vector<StoredObject> objects;
  {
    Statement rows =
        database.Prepare(std::string(kObjectColumns) + "ORDER BY id");
    while (rows.Step()) objects.push_back(MakeObject(rows));
  }
  const auto check = [&](const std::string& what, const auto& operation) {
    ++report.blobs_checked;
    const auto result = RunStorage(operation);
    if (!result)
      report.problems.push_back(what + ": " + result.error().message);
  };
  for (const StoredObject& object : objects) {
    const std::string what = "Object " + object.id;
    check(what, [&] {
      Statement row =
          database.Prepare("SELECT bytes FROM object_data WHERE object_id = ?");
      if (!row.Bind(object.id).Step() ||
          CalcSha256(row.Blob(0)) != object.sha256) {
        Throw(ErrorCode::kStorage, "The uploaded bytes are damaged.");
      }
    });
    check(what, [&] {
      const ObjectMeshes meshes = ReadMeshes(database, object.id);
      const size_t labels = meshes.canonical_labels.size();
      if (labels != 0 && labels != meshes.canonical.triangles().size()) {
        Throw(ErrorCode::kStorage, "There is not one label per face.");
      }
    });
    check(what, [&] { ReadObject(database, object.id); });
    check(what, [&] { ReadParts(database, object.id); });
    check(what, [&] {
      Statement rows =
          database.Prepare("SELECT solid FROM parts WHERE object_id = ?");
      rows.Bind(object.id);
      while (rows.Step()) Unwrap(DecodePart(rows.Blob(0)));
    });
  }
}

}  // namespace store

Result<StoredObject> Store::InsertObject(const NewObject& object,
                                         bool* created) {
  return impl_->Write([&](Database& database) {
    if (created != nullptr) *created = false;
    StoredObject record = object.record;
    if (auto known = FindByContent(database, record.sha256, record.units,
                                   record.role, record.category)) {
      return *known;
    }
    if (created != nullptr) *created = true;
    record.id = MakeUuid();
    record.created_at = FormatNow();
    InsertObjectRow(database, record);
    InsertObjectData(database, record.id, object.bytes, object.meshes);
    if (record.cloud) {
      InsertCloud(database, record.id, *record.cloud, object.meshes.cloud);
    }
    WriteNotes(database, record.id, "repair", record.repairs);
    WriteSegmentation(database, record.id, record.segmentation);
    InsertParts(database, record, object.meshes, object.parts, object.solids);
    return ReadObject(database, record.id);
  });
}

Result<StoredObject> Store::FindObject(const std::string& id) const {
  return impl_->Read(
      [&](Database& database) { return ReadObject(database, id); });
}

Result<std::optional<StoredObject>> Store::FindObjectByContent(
    const std::string& sha256, const std::string& units, ObjectRole role,
    const std::string& category) const {
  return impl_->Read([&](Database& database) {
    return FindByContent(database, sha256, units, role, category);
  });
}

Result<Page<StoredObject>> Store::ListObjects(const ObjectFilter& filter,
                                              const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    CheckPage(page);
    CheckIdCursor(page);
    std::string where = "WHERE id > ?";
    if (!filter.category.empty()) where += " AND category = ?";
    if (filter.role) where += " AND role = ?";
    std::vector<StoredObject> objects;
    {
      Statement rows =
          database.Prepare(kObjectColumns + where + " ORDER BY id LIMIT ?");
      rows.Bind(page.cursor);
      if (!filter.category.empty()) rows.Bind(filter.category);
      if (filter.role) rows.Bind(ToString(*filter.role));
      rows.Bind(page.limit + 1);
      while (rows.Step()) objects.push_back(MakeObject(rows));
    }
    for (StoredObject& object : objects) ReadLists(database, object);
    return MakePage(std::move(objects), page.limit,
                    [](const StoredObject& last) { return last.id; });
  });
}

Result<std::string> Store::ReadObjectBytes(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    Statement row =
        database.Prepare("SELECT bytes FROM object_data WHERE object_id = ?");
    if (!row.Bind(id).Step()) {
      Throw(ErrorCode::kNotFound, "There is no object '" + id + "'.",
            "GET /v1/objects lists them", "id");
    }
    return row.Blob(0);
  });
}

Result<ObjectMeshes> Store::ReadObjectMeshes(const std::string& id) const {
  return impl_->Read(
      [&](Database& database) { return ReadMeshes(database, id); });
}

Result<StoredObject> Store::ReplaceParts(
    const std::string& object_id, const std::string& category,
    const StoredSegmentation& segmentation, const ObjectMeshes& labelled,
    const std::vector<StoredPart>& parts, const std::vector<Part>& solids,
    bool cascade, const PartIds& instead_of) {
  return impl_->Write([&](Database& database) {
    StoredObject object = ReadObject(database, object_id);
    if (instead_of) RefuseOtherParts(database, object_id, *instead_of);
    RefuseDependents(database, object_id, cascade, "cut anew");
    if (category != object.category &&
        FindByContent(database, object.sha256, object.units, object.role,
                      category)) {
      Throw(ErrorCode::kConflict,
            "The same mesh is stored in category '" + category + "' already.",
            "use that object", "category");
    }
    for (const char* sql :
         {"DELETE FROM transfers WHERE object_id = ?1 OR example_id = ?1",
          "DELETE FROM parts WHERE object_id = ?1",
          "DELETE FROM segmentations WHERE object_id = ?1",
          "DELETE FROM object_notes WHERE object_id = ?1 AND kind = "
          "'warning'"}) {
      database.Prepare(sql).Bind(object_id).Run();
    }
    object.category = category;
    database.Prepare("UPDATE objects SET category = ?2 WHERE id = ?1")
        .Bind(object_id)
        .BindTextOrNull(category)
        .Run();
    Statement update = database.Prepare(
        "UPDATE object_data SET canonical_labels = ?2, work_labels = ?3"
        " WHERE object_id = ?1");
    update.Bind(object_id);
    BindLabels(update, labelled.canonical_labels);
    const bool same = labelled.work == labelled.canonical;
    BindLabels(update, same ? std::vector<int>() : labelled.work_labels);
    update.Run();
    WriteSegmentation(database, object_id, segmentation);
    InsertParts(database, object, labelled, parts, solids);
    return ReadObject(database, object_id);
  });
}

Result<void> Store::DeleteObject(const std::string& id, bool cascade) {
  return impl_->Write([&](Database& database) {
    const StoredObject object = ReadObject(database, id);
    if (object.role == ObjectRole::kExample) {
      RefuseDependents(database, id, cascade, "deleted");
    }
    database
        .Prepare(
            "DELETE FROM transfers WHERE object_id = ?1 OR example_id = ?1")
        .Bind(id)
        .Run();
    database.Prepare("DELETE FROM objects WHERE id = ?").Bind(id).Run();
  });
}

}  // namespace graspdb
