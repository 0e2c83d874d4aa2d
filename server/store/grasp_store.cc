#include <bit>
#include <charconv>

#include <fmt/format.h>

#include "server/store/blob_codec.h"
#include "server/store/filter.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::CheckPage;
using store::Filter;
using store::Throw;
using store::Unwrap;

constexpr char kGraspById[] =
    "SELECT g.seq, g.id, g.stage, g.position, g.object_id, g.part_id,"
    " g.part_label, g.category, g.hand, g.grasp_space_id, g.transfer_id,"
    " g.source_grasp_id, g.epsilon, g.volume, g.hybrid, g.robust, g.physical,"
    " g.example_epsilon, g.open_close_epsilon, g.penetration, g.data,"
    " ifnull(t.engine_version, s.engine_version),"
    " ifnull(t.parameters_hash, s.parameters_hash), ifnull(t.seed, s.seed),"
    " g.grip"
    " FROM grasps g CROSS JOIN grasp_spaces s ON s.id = g.grasp_space_id"
    " LEFT JOIN transfers t ON t.id = g.transfer_id WHERE g.id = ?";

StoredGrasp MakeGrasp(Database& database, const Statement& row) {
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
  grasp.grip = row.OptionalDouble(24);
  grasp.physical = row.OptionalDouble(16);
  grasp.example_epsilon = row.Double(17);
  grasp.open_close_epsilon = row.Double(18);
  grasp.penetration = row.Double(19);
  grasp.engine_version = row.Text(21);
  grasp.parameters_hash = row.Text(22);
  grasp.seed = static_cast<uint64_t>(row.Int(23));
  Statement gaps = database.Prepare(
      "SELECT part_label, distance FROM grasp_clearances WHERE grasp_id = ?");
  gaps.Bind(grasp.id);
  while (gaps.Step()) grasp.clearances[gaps.Text(0)] = gaps.Double(1);
  return grasp;
}

StoredGrasp ReadGrasp(Database& database, const std::string& id) {
  Statement row = database.Prepare(kGraspById);
  if (!row.Bind(id).Step()) {
    Throw(ErrorCode::kNotFound, "There is no grasp '" + id + "'.",
          "GET /v1/grasps lists them", "id");
  }
  return MakeGrasp(database, row);
}

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
    case GraspQuery::Sort::kMerit:
      return {'m', "g.merit", true};
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
    filter.AddValues("g.epsilon >= ?", *query.min_epsilon);
  }
  for (const std::string& label : query.keep_free) {
    filter.AddValues(
        "NOT EXISTS (SELECT 1 FROM grasp_clearances c WHERE c.grasp_id = g.id"
        " AND c.part_label = ? AND c.distance < ?)",
        label, query.min_clearance);
  }
  if (query.held) filter.Add("g.physical >= 1.0");
  return filter;
}

Page<GraspKey> ReadKeys(Database& database, const GraspQuery& query) {
  CheckPage(query.page);
  const SortRule rule = FindSortRule(query.sort);
  Filter where = MakeGraspFilter(query);
  if (!query.page.cursor.empty()) {
    const Place place = ParsePlace(rule, query.page.cursor);
    where.AddValues(fmt::format("({}, g.seq) {} (?, ?)", rule.key,
                                rule.descending ? '<' : '>'),
                    place.key, place.seq);
  }
  // The inner query needs nothing but an index.
  const std::string order = fmt::format(" ORDER BY {0}{1}, g.seq{1}", rule.key,
                                        rule.descending ? " DESC" : " ASC");
  Statement rows = database.Prepare(fmt::format(
      "SELECT g.id, g.object_id, g.physical, {}, g.seq FROM grasps g WHERE"
      " g.seq IN (SELECT g.seq FROM grasps g {}{} LIMIT ?){}",
      rule.key, where.sql(), order, order));
  where.Bind(rows);
  rows.Bind(query.page.limit + 1);
  Page<GraspKey> page;
  Place last;
  while (rows.Step()) {
    if (std::ssize(page.items) == query.page.limit) {
      page.next_cursor = FormatPlace(rule, last);
      break;
    }
    page.items.push_back({rows.Text(0), rows.Text(1), rows.OptionalDouble(2)});
    last = {rows.Double(3), rows.Int(4)};
  }
  return page;
}

}  // namespace

void store::InsertGrasp(Database& database, const StoredGrasp& grasp) {
  const GraspQuality& quality = grasp.grasp.quality;
  database
      .Prepare(
          "INSERT INTO grasps (id, stage, position, object_id, part_id,"
          " part_label, category, hand, grasp_space_id, transfer_id,"
          " source_grasp_id, epsilon, volume, hybrid, robust, grip,"
          " physical, example_epsilon, open_close_epsilon, penetration, data)"
          " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
          " ?)")
      .Bind(grasp.id, ToString(grasp.stage), grasp.index, grasp.object_id,
            grasp.part_id, grasp.part_label, grasp.category, grasp.hand,
            grasp.grasp_space_id)
      .BindTextOrNull(grasp.transfer_id)
      .BindTextOrNull(grasp.source_grasp_id)
      .Bind(quality.epsilon, quality.volume, quality.hybrid, grasp.robust,
            grasp.grip, grasp.physical, grasp.example_epsilon,
            grasp.open_close_epsilon, grasp.penetration)
      .BindBlob(EncodeGrasp({grasp.grasp, grasp.targets_O}))
      .Run();
  for (const auto& [label, distance] : grasp.clearances) {
    database.Prepare("INSERT INTO grasp_clearances VALUES (?, ?, ?)")
        .Bind(grasp.id, label, distance)
        .Run();
  }
}

Result<StoredGrasp> Store::FindGrasp(const std::string& id) const {
  return impl_->Read(
      [&](Database& database) { return ReadGrasp(database, id); });
}

Result<void> Store::SetPhysical(
    const std::vector<std::pair<std::string, double>>& verdicts) {
  return impl_->Write([&](Database& database) {
    for (const auto& [id, physical] : verdicts) {
      database.Prepare("UPDATE grasps SET physical = ? WHERE id = ?")
          .Bind(physical, id)
          .Run();
    }
  });
}

Result<Page<GraspKey>> Store::QueryGraspKeys(const GraspQuery& query) const {
  return impl_->Read(
      [&](Database& database) { return ReadKeys(database, query); });
}

Result<Page<StoredGrasp>> Store::QueryGrasps(const GraspQuery& query) const {
  return impl_->Read([&](Database& database) {
    const Page<GraspKey> keys = ReadKeys(database, query);
    Page<StoredGrasp> page;
    page.next_cursor = keys.next_cursor;
    for (const GraspKey& key : keys.items) {
      page.items.push_back(ReadGrasp(database, key.id));
    }
    return page;
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
