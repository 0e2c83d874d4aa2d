#include <algorithm>

#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::ReadObject;
using store::ReadParts;
using store::Throw;
using store::Unwrap;

std::string MakePartId(const StoredObject& object, const StoredPart& part,
                       const Part& solid) {
  return MakeContentId("part " + object.sha256 + " " + object.units + " " +
                       ToString(object.role) + " " + object.category + " " +
                       part.label + " " + CalcSha256(EncodePart(solid)));
}

StoredPart MakePart(const Statement& row) {
  StoredPart part;
  part.id = row.Text(0);
  part.object_id = row.Text(1);
  part.label_index = static_cast<int>(row.Int(2));
  part.label = row.Text(3);
  part.area = row.Double(4);
  part.volume = row.Double(5);
  part.confidence = row.Double(6);
  part.faces = Unwrap(DecodeIndices(row.Blob(7)));
  return part;
}

void ReadAdjacency(Database& database, StoredPart& part) {
  Statement rows =
      database.Prepare("SELECT label FROM part_adjacency WHERE part_id = ?");
  rows.Bind(part.id);
  while (rows.Step()) part.adjacent.push_back(rows.Text(0));
}

// Labels are places among the category's parts, which may have been changed
// while the object was segmented.
void CheckLabels(Database& database, const std::string& category,
                 const ObjectMeshes& labelled,
                 const std::vector<StoredPart>& parts) {
  std::vector<std::string> labels;
  Statement rows = database.Prepare(
      "SELECT label FROM category_parts WHERE category = ?"
      " ORDER BY label_index");
  rows.Bind(category);
  while (rows.Step()) labels.push_back(rows.Text(0));
  const auto is_known = [&](int index) {
    return index >= 0 && index < std::ssize(labels);
  };
  const bool sound =
      std::all_of(labelled.canonical_labels.begin(),
                  labelled.canonical_labels.end(), is_known) &&
      std::all_of(labelled.work_labels.begin(), labelled.work_labels.end(),
                  is_known) &&
      std::all_of(parts.begin(), parts.end(), [&](const StoredPart& part) {
        return is_known(part.label_index) &&
               labels[static_cast<size_t>(part.label_index)] == part.label;
      });
  if (sound) return;
  Throw(ErrorCode::kConflict,
        "Category '" + category + "' has changed meanwhile.",
        "send the request again", "category");
}

constexpr char kPartColumns[] =
    "SELECT id, object_id, label_index, label, area, volume, confidence,"
    " faces FROM parts ";

}  // namespace

namespace store {

void InsertParts(Database& database, const StoredObject& object,
                 const ObjectMeshes& labelled,
                 const std::vector<StoredPart>& parts,
                 const std::vector<Part>& solids) {
  GRASPDB_EXPECTS(parts.size() == solids.size());
  CheckLabels(database, object.category, labelled, parts);
  for (size_t i = 0; i < parts.size(); ++i) {
    const StoredPart& part = parts[i];
    const std::string id = MakePartId(object, part, solids[i]);
    database.Prepare("INSERT INTO parts VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .Bind(id, object.id, part.label_index, part.label, part.area,
              part.volume, part.confidence)
        .BindBlob(EncodeIndices(part.faces))
        .BindBlob(EncodePart(solids[i]))
        .Run();
    for (const std::string& label : part.adjacent) {
      database.Prepare("INSERT INTO part_adjacency VALUES (?, ?)")
          .Bind(id, label)
          .Run();
    }
  }
}

std::vector<StoredPart> ReadParts(Database& database,
                                  const std::string& object_id) {
  std::vector<StoredPart> parts;
  {
    Statement rows = database.Prepare(
        std::string(kPartColumns) + "WHERE object_id = ? ORDER BY label_index");
    rows.Bind(object_id);
    while (rows.Step()) parts.push_back(MakePart(rows));
  }
  for (StoredPart& part : parts) ReadAdjacency(database, part);
  return parts;
}

}  // namespace store

Result<std::vector<StoredPart>> Store::ListParts(
    const std::string& object_id) const {
  return impl_->Read([&](Database& database) {
    ReadObject(database, object_id);
    return ReadParts(database, object_id);
  });
}

Result<StoredPart> Store::FindPart(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    StoredPart part;
    {
      Statement row =
          database.Prepare(std::string(kPartColumns) + "WHERE id = ?");
      if (!row.Bind(id).Step()) {
        Throw(ErrorCode::kNotFound, "There is no part '" + id + "'.",
              "GET /v1/objects/{id}/parts lists an object's", "id");
      }
      part = MakePart(row);
    }
    ReadAdjacency(database, part);
    return part;
  });
}

Result<std::vector<Part>> Store::ReadSolids(
    const std::vector<StoredPart>& parts) const {
  return impl_->Read([&](Database& database) {
    std::vector<Part> solids;
    for (const StoredPart& part : parts) {
      Statement row =
          database.Prepare("SELECT solid, confidence FROM parts WHERE id = ?");
      if (!row.Bind(part.id).Step()) {
        Throw(ErrorCode::kConflict,
              "Object " + part.object_id + " has been cut anew meanwhile.",
              "send the request again");
      }
      solids.push_back(Unwrap(DecodePart(row.Blob(0))));
      solids.back().confidence = row.Double(1);
    }
    return solids;
  });
}

}  // namespace graspdb
