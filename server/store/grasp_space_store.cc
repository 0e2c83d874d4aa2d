#include <algorithm>
#include <limits>
#include <utility>

#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/filter.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::CheckPage;
using store::Filter;
using store::InsertGrasp;
using store::InsertParameterSet;
using store::ReadRowCursor;
using store::Throw;
using store::Unwrap;

constexpr char kSpaceColumns[] =
    "SELECT s.id, s.object_id, s.part_id, s.part_label, s.category, s.hand,"
    " p.json, s.parameters_hash, s.seed, s.engine_version, s.num_grasps,"
    " s.num_support_vectors, s.configurations_tried, s.coverage, s.seconds,"
    " s.created_at, s.configuration_space_seconds, s.rowid FROM grasp_spaces s"
    " CROSS JOIN parameter_sets p ON p.hash = s.parameters_hash ";
constexpr int kSpaceRowid = 17;

StoredGraspSpace MakeSpace(const Statement& row) {
  StoredGraspSpace space;
  space.id = row.Text(0);
  space.object_id = row.Text(1);
  space.part_id = row.Text(2);
  space.part_label = row.Text(3);
  space.category = row.Text(4);
  space.hand = row.Text(5);
  space.parameters = row.Text(6);
  space.parameters_hash = row.Text(7);
  space.seed = static_cast<uint64_t>(row.Int(8));
  space.engine_version = row.Text(9);
  space.num_grasps = static_cast<int>(row.Int(10));
  space.num_support_vectors = static_cast<int>(row.Int(11));
  space.configurations_tried = static_cast<int>(row.Int(12));
  space.coverage = row.Double(13);
  space.seconds = row.Double(14);
  space.created_at = row.Text(15);
  space.configuration_space_seconds = row.Double(16);
  return space;
}

void ReadCurve(Database& database, StoredGraspSpace& space) {
  Statement rows = database.Prepare(
      "SELECT samples, support_vectors, balanced_accuracy, boundary_accuracy"
      " FROM learning_rounds WHERE grasp_space_id = ? ORDER BY position");
  rows.Bind(space.id);
  while (rows.Step()) {
    space.curve.push_back({static_cast<int>(rows.Int(0)),
                           static_cast<int>(rows.Int(1)), rows.Double(2),
                           rows.Double(3)});
  }
}

StoredGraspSpace ReadSpace(Database& database, const std::string& id) {
  StoredGraspSpace space;
  {
    Statement row =
        database.Prepare(std::string(kSpaceColumns) + "WHERE s.id = ?");
    if (!row.Bind(id).Step()) {
      Throw(ErrorCode::kNotFound, "There is no grasp space '" + id + "'.",
            "GET /v1/grasp-spaces lists them", "id");
    }
    space = MakeSpace(row);
  }
  ReadCurve(database, space);
  return space;
}

std::optional<StoredGraspSpace> FindSpace(Database& database,
                                          const std::string& part_id,
                                          const std::string& hand,
                                          const std::string& parameters_hash,
                                          uint64_t seed) {
  std::optional<StoredGraspSpace> space;
  {
    Statement row = database.Prepare(
        std::string(kSpaceColumns) +
        "WHERE s.part_id = ? AND s.hand = ? AND s.parameters_hash = ?"
        " AND s.seed = ?");
    if (!row.Bind(part_id, hand, parameters_hash, seed).Step()) return space;
    space = MakeSpace(row);
  }
  ReadCurve(database, *space);
  return space;
}

std::string MakeSpaceId(Database& database, const StoredGraspSpace& space) {
  Statement row = database.Prepare("SELECT sha256 FROM hands WHERE name = ?");
  if (!row.Bind(space.hand).Step()) {
    Throw(ErrorCode::kNotFound, "There is no hand '" + space.hand + "'.", "",
          "hand");
  }
  return MakeContentId("grasp space " + space.part_id + " " + row.Text(0) +
                       " " + space.parameters_hash + " " +
                       std::to_string(space.seed));
}

void InsertSpaceRow(Database& database, const StoredGraspSpace& record,
                    const GraspSpace& space) {
  InsertParameterSet(database, record.parameters_hash, record.parameters);
  database
      .Prepare(
          "INSERT INTO grasp_spaces VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
          " ?, ?, ?, ?, ?, ?)")
      .Bind(record.id, record.object_id, record.part_id, record.part_label,
            record.category, record.hand, record.parameters_hash, record.seed,
            record.engine_version, static_cast<int64_t>(space.grasps.size()),
            static_cast<int64_t>(space.support_vectors.size()),
            space.configurations_tried, space.coverage, record.seconds,
            FormatNow())
      .BindBlob(EncodeConfigurations(space.support_vectors))
      .Bind(record.configuration_space_seconds)
      .Run();
  for (size_t i = 0; i < space.curve.size(); ++i) {
    const LearningRound& round = space.curve[i];
    database.Prepare("INSERT INTO learning_rounds VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(record.id, static_cast<int64_t>(i), round.samples,
              round.support_vectors, round.balanced_accuracy,
              round.boundary_accuracy)
        .Run();
  }
}

// The labels of a category's parts, by label index.
std::vector<std::string> ListLabels(Database& database,
                                    const std::string& category) {
  Statement rows = database.Prepare(
      "SELECT label FROM category_parts WHERE category = ?"
      " ORDER BY label_index");
  rows.Bind(category);
  std::vector<std::string> labels;
  while (rows.Step()) labels.push_back(rows.Text(0));
  return labels;
}

void ReadClearances(Database& database, const std::string& space_id,
                    const std::vector<std::string>& labels, GraspSpace& space) {
  space.clearances.assign(
      space.grasps.size(),
      std::vector<double>(labels.size(),
                          std::numeric_limits<double>::infinity()));
  Statement rows = database.Prepare(
      "SELECT g.position, c.part_label, c.distance FROM grasps g"
      " JOIN grasp_clearances c ON c.grasp_id = g.id"
      " WHERE g.grasp_space_id = ? AND g.transfer_id IS NULL");
  rows.Bind(space_id);
  while (rows.Step()) {
    const auto label = std::find(labels.begin(), labels.end(), rows.Text(1));
    if (label == labels.end()) continue;
    space.clearances[static_cast<size_t>(rows.Int(0))]
                    [static_cast<size_t>(label - labels.begin())] =
        rows.Double(2);
  }
}

StoredGrasp MakeLearnedGrasp(const StoredGraspSpace& space, const Grasp& grasp,
                             int index) {
  StoredGrasp stored;
  stored.id = MakeGraspId(space.id, GraspStage::kLearned, index);
  stored.stage = GraspStage::kLearned;
  stored.index = index;
  stored.object_id = space.object_id;
  stored.part_id = space.part_id;
  stored.part_label = space.part_label;
  stored.category = space.category;
  stored.hand = space.hand;
  stored.grasp = grasp;
  stored.example_epsilon = grasp.quality.epsilon;
  stored.grasp_space_id = space.id;
  return stored;
}

}  // namespace

Result<StoredGraspSpace> Store::InsertGraspSpace(const StoredGraspSpace& record,
                                                 const GraspSpace& space) {
  return impl_->Write([&](Database& database) {
    if (auto known = FindSpace(database, record.part_id, record.hand,
                               record.parameters_hash, record.seed)) {
      return *known;
    }
    StoredGraspSpace row = record;
    row.id = MakeSpaceId(database, record);
    InsertSpaceRow(database, row, space);
    const std::vector<std::string> labels = ListLabels(database, row.category);
    for (size_t i = 0; i < space.grasps.size(); ++i) {
      StoredGrasp grasp =
          MakeLearnedGrasp(row, space.grasps[i], static_cast<int>(i));
      if (i < space.clearances.size()) {
        grasp.clearances =
            NameClearances(space.clearances[i], labels, row.part_label);
      }
      InsertGrasp(database, grasp);
    }
    return ReadSpace(database, row.id);
  });
}

Result<StoredGraspSpace> Store::FindGraspSpace(const std::string& id) const {
  return impl_->Read(
      [&](Database& database) { return ReadSpace(database, id); });
}

Result<std::optional<StoredGraspSpace>> Store::FindLearned(
    const std::string& part_id, const std::string& hand,
    const std::string& parameters_hash, uint64_t seed) const {
  return impl_->Read([&](Database& database) {
    return FindSpace(database, part_id, hand, parameters_hash, seed);
  });
}

Result<Page<StoredGraspSpace>> Store::ListGraspSpaces(
    const GraspSpaceFilter& filter, const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    CheckPage(page);
    Filter where;
    where.AddValues("s.rowid > ?", ReadRowCursor(page));
    where.AddText("s.category", filter.category);
    where.AddText("s.part_label", filter.part_label);
    where.AddText("s.hand", filter.hand);
    where.AddText("s.object_id", filter.object_id);
    std::vector<std::pair<StoredGraspSpace, int64_t>> spaces;
    {
      Statement rows = database.Prepare(kSpaceColumns + where.sql() +
                                        " ORDER BY s.rowid LIMIT ?");
      where.Bind(rows);
      rows.Bind(page.limit + 1);
      while (rows.Step()) {
        spaces.emplace_back(MakeSpace(rows), rows.Int(kSpaceRowid));
      }
    }
    Page<StoredGraspSpace> result;
    if (std::ssize(spaces) > page.limit) {
      spaces.pop_back();
      result.next_cursor = std::to_string(spaces.back().second);
    }
    for (auto& [space, rowid] : spaces) {
      ReadCurve(database, space);
      result.items.push_back(std::move(space));
    }
    return result;
  });
}

Result<GraspSpace> Store::ReadGraspSpace(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    const StoredGraspSpace record = ReadSpace(database, id);
    GraspSpace space;
    space.curve = record.curve;
    space.configurations_tried = record.configurations_tried;
    space.coverage = record.coverage;
    {
      Statement row = database.Prepare(
          "SELECT support_vectors FROM grasp_spaces WHERE id = ?");
      row.Bind(id).Step();
      space.support_vectors = Unwrap(DecodeConfigurations(row.Blob(0)));
    }
    Statement rows = database.Prepare(
        "SELECT data, epsilon, volume, hybrid FROM grasps"
        " WHERE grasp_space_id = ? AND transfer_id IS NULL ORDER BY position");
    rows.Bind(id);
    while (rows.Step()) {
      Grasp grasp = Unwrap(DecodeGrasp(rows.Blob(0))).grasp;
      grasp.quality = {rows.Double(1), rows.Double(2), rows.Double(3)};
      space.grasps.push_back(std::move(grasp));
    }
    ReadClearances(database, id, ListLabels(database, record.category), space);
    return space;
  });
}

Result<void> Store::DeleteGraspSpace(const std::string& id, bool cascade) {
  return impl_->Write([&](Database& database) {
    ReadSpace(database, id);
    constexpr char kUsers[] =
        "SELECT DISTINCT transfer_id FROM transfer_attempts"
        " WHERE source_grasp_id IN"
        " (SELECT id FROM grasps WHERE grasp_space_id = ?)";
    std::string users;
    {
      Statement rows = database.Prepare(kUsers);
      rows.Bind(id);
      while (rows.Step()) users += (users.empty() ? "" : ", ") + rows.Text(0);
    }
    if (!users.empty() && !cascade) {
      Throw(ErrorCode::kConflict,
            "Transfers used the grasps of " + id + ": " + users + ".",
            "?cascade=true deletes them too");
    }
    database
        .Prepare(std::string("DELETE FROM transfers WHERE id IN (") + kUsers +
                 ")")
        .Bind(id)
        .Run();
    database.Prepare("DELETE FROM grasp_spaces WHERE id = ?").Bind(id).Run();
  });
}

}  // namespace graspdb
