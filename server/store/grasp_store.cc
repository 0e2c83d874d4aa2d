#include <algorithm>
#include <bit>
#include <charconv>

#include <fmt/format.h>

#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::CheckPage;
using store::InsertParameterSet;
using store::MakePage;
using store::Throw;
using store::Unwrap;

// ---- Grasp spaces -----------------------------------------------------------

constexpr char kSpaceColumns[] =
    "SELECT s.id, s.object_id, s.part_id, s.part_label, s.category, s.hand,"
    " p.json, s.parameters_hash, s.seed, s.engine_version, s.num_grasps,"
    " s.num_support_vectors, s.configurations_tried, s.coverage, s.seconds,"
    " s.created_at, s.rowid FROM grasp_spaces s"
    " CROSS JOIN parameter_sets p ON p.hash = s.parameters_hash ";
constexpr int kSpaceRowid = 16;

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
          " ?, ?, ?, ?, ?)")
      .Bind(record.id, record.object_id, record.part_id, record.part_label,
            record.category, record.hand, record.parameters_hash, record.seed,
            record.engine_version, static_cast<int64_t>(space.grasps.size()),
            static_cast<int64_t>(space.support_vectors.size()),
            space.configurations_tried, space.coverage, record.seconds,
            FormatNow())
      .BindBlob(EncodeConfigurations(space.support_vectors))
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

// ---- Grasps -----------------------------------------------------------------

constexpr char kGraspColumns[] =
    "SELECT g.seq, g.id, g.stage, g.position, g.object_id, g.part_id,"
    " g.part_label, g.category, g.hand, g.grasp_space_id, g.transfer_id,"
    " g.source_grasp_id, g.epsilon, g.volume, g.hybrid, g.robust, g.physical,"
    " g.example_epsilon, g.open_close_epsilon, g.penetration, g.data,"
    " ifnull(t.engine_version, s.engine_version),"
    " ifnull(t.parameters_hash, s.parameters_hash), ifnull(t.seed, s.seed)"
    " FROM grasps g CROSS JOIN grasp_spaces s ON s.id = g.grasp_space_id"
    " LEFT JOIN transfers t ON t.id = g.transfer_id ";

StoredGrasp MakeGrasp(const Statement& row) {
  StoredGrasp grasp;
  GraspBlob blob = Unwrap(DecodeGrasp(row.Blob(20)));
  grasp.grasp = std::move(blob.grasp);
  grasp.targets_O = std::move(blob.targets_O);
  grasp.id = row.Text(1);
  grasp.stage = Unwrap(ParseGraspStage(row.Text(2)));
  grasp.index = static_cast<int>(row.Int(3));
  grasp.object_id = row.Text(4);
  grasp.part_id = row.Text(5);
  grasp.part_label = row.Text(6);
  grasp.category = row.Text(7);
  grasp.hand = row.Text(8);
  grasp.grasp_space_id = row.Text(9);
  grasp.transfer_id = row.Text(10);
  grasp.source_grasp_id = row.Text(11);
  grasp.grasp.quality = {row.Double(12), row.Double(13), row.Double(14)};
  grasp.robust = row.OptionalDouble(15);
  grasp.physical = row.OptionalDouble(16);
  grasp.example_epsilon = row.Double(17);
  grasp.open_close_epsilon = row.Double(18);
  grasp.penetration = row.Double(19);
  grasp.engine_version = row.Text(21);
  grasp.parameters_hash = row.Text(22);
  grasp.seed = static_cast<uint64_t>(row.Int(23));
  return grasp;
}

void InsertGrasp(Database& database, const StoredGrasp& grasp) {
  const GraspQuality& quality = grasp.grasp.quality;
  database
      .Prepare(
          "INSERT INTO grasps (id, stage, position, object_id, part_id,"
          " part_label, category, hand, grasp_space_id, transfer_id,"
          " source_grasp_id, epsilon, volume, hybrid, robust, physical,"
          " example_epsilon, open_close_epsilon, penetration, data) VALUES"
          " (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .Bind(grasp.id, ToString(grasp.stage), grasp.index, grasp.object_id,
            grasp.part_id, grasp.part_label, grasp.category, grasp.hand,
            grasp.grasp_space_id)
      .BindTextOrNull(grasp.transfer_id)
      .BindTextOrNull(grasp.source_grasp_id)
      .Bind(quality.epsilon, quality.volume, quality.hybrid, grasp.robust,
            grasp.physical, grasp.example_epsilon, grasp.open_close_epsilon,
            grasp.penetration)
      .BindBlob(EncodeGrasp({grasp.grasp, grasp.targets_O}))
      .Run();
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

// ---- Queries ----------------------------------------------------------------

// How a list is sorted: by `key` in `direction`, then by seq likewise.
struct SortRule {
  char letter;  ///< In the cursor, so that it fits this sort only.
  const char* key;
  bool descending;
};

SortRule FindSortRule(GraspQuery::Sort sort) {
  switch (sort) {
    case GraspQuery::Sort::kEpsilon:
      return {'e', "g.epsilon", true};
    case GraspQuery::Sort::kHybrid:
      return {'h', "g.hybrid", false};
    case GraspQuery::Sort::kRobust:
      return {'r', "ifnull(g.robust, -1.0)", true};
    case GraspQuery::Sort::kNewest:
      return {'n', "g.seq", true};
  }
  return {'e', "g.epsilon", true};
}

// The place of a grasp in a sorted list, as text: letter, the key's bits, seq.
struct Place {
  double key{0.0};
  int64_t seq{0};
};

std::string FormatPlace(const SortRule& rule, const Place& place) {
  return fmt::format("{}{:016x}{:x}", rule.letter,
                     std::bit_cast<uint64_t>(place.key), place.seq);
}

Place ParsePlace(const SortRule& rule, const std::string& cursor) {
  uint64_t bits = 0;
  Place place;
  const char* begin = cursor.data();
  const char* end = begin + cursor.size();
  const bool sound =
      cursor.size() > 17 && cursor[0] == rule.letter &&
      std::from_chars(begin + 1, begin + 17, bits, 16).ptr == begin + 17 &&
      std::from_chars(begin + 17, end, place.seq, 16).ptr == end;
  if (!sound) {
    Throw(ErrorCode::kInvalidArgument, "The cursor is not of this query.",
          "use next_cursor of the page before, with the same filters",
          "cursor");
  }
  place.key = std::bit_cast<double>(bits);
  return place;
}

// A WHERE clause and the values of its parameters, in order.
class Filter {
 public:
  void Add(const std::string& condition) {
    sql_ += (sql_.empty() ? "WHERE " : " AND ") + condition;
  }
  void AddText(const std::string& column, const std::string& value) {
    if (value.empty()) return;
    Add(column + " = ?");
    binders_.push_back([value](Statement& s) { s.Bind(value); });
  }
  // Several values do not use the index, so that the order still can.
  void AddAnyOf(const std::string& column,
                const std::vector<std::string>& values) {
    if (values.size() == 1) return AddText(column, values.front());
    if (values.empty()) return;
    std::string marks;
    for (const std::string& value : values) {
      marks += marks.empty() ? "?" : ", ?";
      binders_.push_back([value](Statement& s) { s.Bind(value); });
    }
    Add("+" + column + " IN (" + marks + ")");
  }
  void AddNumber(const std::string& condition, double value) {
    Add(condition);
    binders_.push_back([value](Statement& s) { s.Bind(value); });
  }
  void AddPlace(const std::string& condition, const Place& place) {
    Add(condition);
    binders_.push_back([place](Statement& s) { s.Bind(place.key, place.seq); });
  }
  const std::string& sql() const { return sql_; }
  void Bind(Statement& statement) const {
    for (const auto& bind : binders_) bind(statement);
  }

 private:
  std::string sql_;
  std::vector<std::function<void(Statement&)>> binders_;
};

Filter MakeGraspFilter(const GraspQuery& query) {
  Filter filter;
  filter.AddText("g.category", query.category);
  filter.AddAnyOf("g.part_label", query.part_labels);
  filter.AddText("g.hand", query.hand);
  filter.AddText("g.object_id", query.object_id);
  filter.AddText("g.grasp_space_id", query.grasp_space_id);
  filter.AddText("g.transfer_id", query.transfer_id);
  if (query.stage) filter.AddText("g.stage", ToString(*query.stage));
  if (query.min_epsilon) {
    filter.AddNumber("g.epsilon >= ?", *query.min_epsilon);
  }
  if (query.verified) {
    filter.Add(*query.verified ? "g.physical IS NOT NULL"
                               : "g.physical IS NULL");
  }
  return filter;
}

// ---- Transfers --------------------------------------------------------------

void WriteTransferNotes(Database& database, const StoredTransfer& transfer) {
  const auto write = [&](const char* kind, size_t position,
                         const std::string& note,
                         const std::optional<double>& value) {
    database.Prepare("INSERT INTO transfer_notes VALUES (?, ?, ?, ?, ?)")
        .Bind(transfer.id, kind, static_cast<int64_t>(position), note, value)
        .Run();
  };
  for (size_t i = 0; i < transfer.part_labels.size(); ++i) {
    write("part", i, transfer.part_labels[i], std::nullopt);
  }
  for (size_t i = 0; i < transfer.warnings.size(); ++i) {
    write("warning", i, transfer.warnings[i], std::nullopt);
  }
  for (size_t i = 0; i < transfer.seconds.size(); ++i) {
    write("seconds", i, transfer.seconds[i].first, transfer.seconds[i].second);
  }
}

void ReadTransferNotes(Database& database, StoredTransfer& transfer) {
  Statement rows = database.Prepare(
      "SELECT kind, note, value FROM transfer_notes WHERE transfer_id = ?"
      " ORDER BY kind, position");
  rows.Bind(transfer.id);
  while (rows.Step()) {
    const std::string kind = rows.Text(0);
    if (kind == "part") {
      transfer.part_labels.push_back(rows.Text(1));
    } else if (kind == "warning") {
      transfer.warnings.push_back(rows.Text(1));
    } else {
      transfer.seconds.emplace_back(rows.Text(1), rows.Double(2));
    }
  }
}

void InsertTransferRow(Database& database, const StoredTransfer& transfer) {
  InsertParameterSet(database, transfer.parameters_hash, transfer.parameters);
  database
      .Prepare(
          "INSERT INTO transfers VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
          " ?)")
      .Bind(transfer.id, transfer.object_id, transfer.example_id,
            transfer.category, transfer.hand, ToString(transfer.stage),
            transfer.sources_per_part, transfer.parameters_hash, transfer.seed,
            transfer.engine_version, transfer.similarity, transfer.complete,
            FormatNow())
      .Run();
  WriteTransferNotes(database, transfer);
}

void InsertContactMaps(Database& database, const StoredTransfer& transfer) {
  for (size_t i = 0; i < transfer.contact_maps.size(); ++i) {
    const StoredContactMap& map = transfer.contact_maps[i];
    database
        .Prepare(
            "INSERT INTO contact_maps VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .Bind(map.id, transfer.id, static_cast<int64_t>(i), map.example_part_id,
              map.novel_part_id, map.part_label)
        .BindBlob(EncodePose(map.alignment.X_NE))
        .Bind(map.alignment.scale, map.alignment.residual,
              map.alignment.mapped_share)
        .Run();
  }
}

void InsertAttempts(Database& database, const StoredTransfer& transfer) {
  for (size_t i = 0; i < transfer.attempts.size(); ++i) {
    const StoredAttempt& attempt = transfer.attempts[i];
    database
        .Prepare(
            "INSERT INTO transfer_attempts VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?,"
            " ?, ?, ?, ?)")
        .Bind(transfer.id, static_cast<int64_t>(i), attempt.source_grasp_id,
              attempt.part_id, attempt.part_label, ToString(attempt.transfer),
              ToString(attempt.assembly))
        .BindTextOrNull(attempt.transferred_grasp_id)
        .BindTextOrNull(attempt.assembled_grasp_id)
        .Bind(attempt.example_epsilon, attempt.example_epsilon_whole,
              attempt.open_close_epsilon_part, attempt.open_close_epsilon_whole)
        .Run();
  }
}

void ReadContactMaps(Database& database, StoredTransfer& transfer) {
  Statement rows = database.Prepare(
      "SELECT id, example_part_id, novel_part_id, part_label, pose, scale,"
      " residual, mapped_share FROM contact_maps WHERE transfer_id = ?"
      " ORDER BY position");
  rows.Bind(transfer.id);
  while (rows.Step()) {
    StoredContactMap map;
    map.id = rows.Text(0);
    map.transfer_id = transfer.id;
    map.example_part_id = rows.Text(1);
    map.novel_part_id = rows.Text(2);
    map.part_label = rows.Text(3);
    map.alignment.X_NE = Unwrap(DecodePose(rows.Blob(4)));
    map.alignment.scale = rows.Double(5);
    map.alignment.residual = rows.Double(6);
    map.alignment.mapped_share = rows.Double(7);
    transfer.contact_maps.push_back(std::move(map));
  }
}

void ReadAttempts(Database& database, StoredTransfer& transfer) {
  Statement rows = database.Prepare(
      "SELECT source_grasp_id, part_id, part_label, transfer_outcome,"
      " assembly_outcome, transferred_grasp_id, assembled_grasp_id,"
      " example_epsilon, example_epsilon_whole, open_close_epsilon_part,"
      " open_close_epsilon_whole FROM transfer_attempts"
      " WHERE transfer_id = ? ORDER BY position");
  rows.Bind(transfer.id);
  while (rows.Step()) {
    StoredAttempt attempt;
    attempt.source_grasp_id = rows.Text(0);
    attempt.part_id = rows.Text(1);
    attempt.part_label = rows.Text(2);
    attempt.transfer = Unwrap(ParseTransferOutcome(rows.Text(3)));
    attempt.assembly = Unwrap(ParseTransferOutcome(rows.Text(4)));
    attempt.transferred_grasp_id = rows.Text(5);
    attempt.assembled_grasp_id = rows.Text(6);
    attempt.example_epsilon = rows.Double(7);
    attempt.example_epsilon_whole = rows.Double(8);
    attempt.open_close_epsilon_part = rows.Double(9);
    attempt.open_close_epsilon_whole = rows.Double(10);
    transfer.attempts.push_back(std::move(attempt));
  }
}

std::optional<StoredTransfer> ReadTransfer(Database& database,
                                           const std::string& id) {
  std::optional<StoredTransfer> transfer;
  {
    Statement row = database.Prepare(
        "SELECT t.id, t.object_id, t.example_id, t.category, t.hand, t.stage,"
        " t.sources_per_part, p.json, t.parameters_hash, t.seed,"
        " t.engine_version, t.similarity, t.complete, t.created_at"
        " FROM transfers t JOIN parameter_sets p"
        " ON p.hash = t.parameters_hash WHERE t.id = ?");
    if (!row.Bind(id).Step()) return transfer;
    transfer.emplace();
    transfer->id = row.Text(0);
    transfer->object_id = row.Text(1);
    transfer->example_id = row.Text(2);
    transfer->category = row.Text(3);
    transfer->hand = row.Text(4);
    transfer->stage = Unwrap(ParseGraspStage(row.Text(5)));
    transfer->sources_per_part = static_cast<int>(row.Int(6));
    transfer->parameters = row.Text(7);
    transfer->parameters_hash = row.Text(8);
    transfer->seed = static_cast<uint64_t>(row.Int(9));
    transfer->engine_version = row.Text(10);
    transfer->similarity = row.Double(11);
    transfer->complete = row.Int(12) != 0;
    transfer->created_at = row.Text(13);
  }
  ReadTransferNotes(database, *transfer);
  ReadContactMaps(database, *transfer);
  ReadAttempts(database, *transfer);
  return transfer;
}

}  // namespace

// ---- The store's verbs ------------------------------------------------------

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
    for (size_t i = 0; i < space.grasps.size(); ++i) {
      InsertGrasp(database,
                  MakeLearnedGrasp(row, space.grasps[i], static_cast<int>(i)));
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
    int64_t after = 0;
    const char* end = page.cursor.data() + page.cursor.size();
    if (!page.cursor.empty() &&
        std::from_chars(page.cursor.data(), end, after).ptr != end) {
      Throw(ErrorCode::kInvalidArgument, "The cursor is not of this list.",
            "use next_cursor of the page before", "cursor");
    }
    Filter where;
    where.AddNumber("s.rowid > ?", static_cast<double>(after));
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

Result<StoredGrasp> Store::FindGrasp(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    Statement row =
        database.Prepare(std::string(kGraspColumns) + "WHERE g.id = ?");
    if (!row.Bind(id).Step()) {
      Throw(ErrorCode::kNotFound, "There is no grasp '" + id + "'.",
            "GET /v1/grasps lists them", "id");
    }
    return MakeGrasp(row);
  });
}

Result<Page<StoredGrasp>> Store::QueryGrasps(const GraspQuery& query) const {
  return impl_->Read([&](Database& database) {
    CheckPage(query.page);
    const SortRule rule = FindSortRule(query.sort);
    const std::string direction = rule.descending ? " DESC" : " ASC";
    Filter where = MakeGraspFilter(query);
    if (!query.page.cursor.empty()) {
      where.AddPlace(fmt::format("({}, g.seq) {} (?, ?)", rule.key,
                                 rule.descending ? '<' : '>'),
                     ParsePlace(rule, query.page.cursor));
    }
    const std::string order =
        fmt::format(" ORDER BY {0}{1}, g.seq{1}", rule.key, direction);
    // The inner query needs nothing but an index.
    Statement rows = database.Prepare(fmt::format(
        "{}WHERE g.seq IN (SELECT g.seq FROM grasps g {}{} LIMIT ?){}",
        kGraspColumns, where.sql(), order, order));
    where.Bind(rows);
    rows.Bind(query.page.limit + 1);
    Page<StoredGrasp> page;
    Place last;
    while (rows.Step()) {
      if (std::ssize(page.items) == query.page.limit) {
        page.next_cursor = FormatPlace(rule, last);
        break;
      }
      page.items.push_back(MakeGrasp(rows));
      const StoredGrasp& grasp = page.items.back();
      const int64_t seq = rows.Int(0);
      const double keys[] = {
          grasp.grasp.quality.epsilon, grasp.grasp.quality.hybrid,
          grasp.robust.value_or(-1.0), static_cast<double>(seq)};
      last = {keys[static_cast<int>(query.sort)], seq};
    }
    return page;
  });
}

Result<StoredTransfer> Store::InsertTransfer(
    const StoredTransfer& transfer, const std::vector<StoredGrasp>& grasps) {
  return impl_->Write([&](Database& database) {
    if (auto known = ReadTransfer(database, transfer.id)) return *known;
    InsertTransferRow(database, transfer);
    for (const StoredGrasp& grasp : grasps) InsertGrasp(database, grasp);
    InsertContactMaps(database, transfer);
    InsertAttempts(database, transfer);
    return *ReadTransfer(database, transfer.id);
  });
}

Result<StoredTransfer> Store::FindTransfer(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    auto transfer = ReadTransfer(database, id);
    if (!transfer) {
      Throw(ErrorCode::kNotFound, "There is no transfer '" + id + "'.",
            "POST /v1/grasps makes them", "id");
    }
    return *transfer;
  });
}

void store::CheckGrasps(Database& database, CheckReport& report) {
  const auto check = [&](const std::string& what, const auto& operation) {
    ++report.blobs_checked;
    const auto result = RunStorage(operation);
    if (!result) {
      report.problems.push_back(what + ": " + result.error().message);
    }
  };
  {
    Statement rows = database.Prepare("SELECT id, data FROM grasps");
    while (rows.Step()) {
      check("Grasp " + rows.Text(0),
            [&] { Unwrap(DecodeGrasp(rows.Blob(1))); });
    }
  }
  {
    Statement rows =
        database.Prepare("SELECT id, support_vectors FROM grasp_spaces");
    while (rows.Step()) {
      check("Grasp space " + rows.Text(0),
            [&] { Unwrap(DecodeConfigurations(rows.Blob(1))); });
    }
  }
  {
    Statement rows = database.Prepare(
        "SELECT id FROM grasp_spaces s WHERE num_grasps <> (SELECT count(*)"
        " FROM grasps WHERE grasp_space_id = s.id AND transfer_id IS NULL)");
    while (rows.Step()) {
      report.problems.push_back("Grasp space " + rows.Text(0) +
                                " has lost grasps.");
    }
  }
  {
    Statement rows = database.Prepare("SELECT id, pose FROM contact_maps");
    while (rows.Step()) {
      check("Contact map " + rows.Text(0),
            [&] { Unwrap(DecodePose(rows.Blob(1))); });
    }
  }
  Statement rows = database.Prepare("SELECT hand, file, mesh FROM hand_meshes");
  while (rows.Step()) {
    check("Hand " + rows.Text(0) + ", mesh " + rows.Text(1),
          [&] { Unwrap(DecodeMesh(rows.Blob(2))); });
  }
}

}  // namespace graspdb
