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
using store::MakePage;
using store::ReadRowCursor;
using store::Throw;
using store::Unwrap;

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
  for (const std::string& label : transfer.keep_free) {
    database.Prepare("INSERT INTO transfer_keep_free VALUES (?, ?)")
        .Bind(transfer.id, label)
        .Run();
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
  Statement labels = database.Prepare(
      "SELECT part_label FROM transfer_keep_free WHERE transfer_id = ?");
  labels.Bind(transfer.id);
  while (labels.Step()) transfer.keep_free.push_back(labels.Text(0));
}

void InsertTransferRow(Database& database, const StoredTransfer& transfer) {
  InsertParameterSet(database, transfer.parameters_hash, transfer.parameters);
  database
      .Prepare(
          "INSERT INTO transfers VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,"
          " ?, ?, ?)")
      .Bind(transfer.id, transfer.object_id, transfer.example_id,
            transfer.category, transfer.hand, ToString(transfer.stage),
            transfer.sources_per_part, transfer.parameters_hash, transfer.seed,
            transfer.engine_version, transfer.similarity, transfer.complete,
            FormatNow(), transfer.enough)
      .BindTextOrNull(transfer.inputs_id)
      .Run();
  WriteTransferNotes(database, transfer);
}

// The id of a transfer that makes one that was cut needless: the whole one of
// the same inputs, or one that was cut and has as many grasps; empty if none.
std::string FindBetter(Database& database, const StoredTransfer& transfer,
                       int64_t num_grasps) {
  Statement row = database.Prepare(
      "SELECT id FROM transfers t WHERE id = ?1 OR (inputs_id = ?1"
      " AND complete = 0 AND ?2 <= (SELECT count(*) FROM grasps g"
      " WHERE g.transfer_id = t.id)) ORDER BY complete DESC LIMIT 1");
  return row.Bind(transfer.inputs_id, num_grasps).Step() ? row.Text(0)
                                                         : std::string();
}

// Those of the same inputs that were cut.
void DeleteCutTransfers(Database& database, const StoredTransfer& transfer) {
  database.Prepare("DELETE FROM transfers WHERE inputs_id = ? AND complete = 0")
      .Bind(transfer.inputs_id)
      .Run();
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
        " t.engine_version, t.similarity, t.complete, t.created_at, t.enough,"
        " t.inputs_id"
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
    if (!row.IsNull(14)) transfer->enough = static_cast<int>(row.Int(14));
    transfer->inputs_id = row.Text(15);
  }
  ReadTransferNotes(database, *transfer);
  ReadContactMaps(database, *transfer);
  ReadAttempts(database, *transfer);
  return transfer;
}

}  // namespace

Result<StoredTransfer> Store::InsertTransfer(
    const StoredTransfer& transfer, const std::vector<StoredGrasp>& grasps) {
  return impl_->Write([&](Database& database) {
    if (auto known = ReadTransfer(database, transfer.id)) return *known;
    if (!transfer.complete) {
      const std::string better =
          FindBetter(database, transfer, std::ssize(grasps));
      if (!better.empty()) return *ReadTransfer(database, better);
    }
    DeleteCutTransfers(database, transfer);
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

Result<Page<StoredTransfer>> Store::ListTransfers(
    const TransferFilter& filter, const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    CheckPage(page);
    Filter where;
    if (const int64_t before = ReadRowCursor(page); before > 0) {
      where.AddValues("rowid < ?", before);
    }
    where.AddText("category", filter.category);
    where.AddText("object_id", filter.object_id);
    std::vector<std::pair<int64_t, std::string>> found;
    {
      Statement rows =
          database.Prepare("SELECT rowid, id FROM transfers " + where.sql() +
                           " ORDER BY rowid DESC LIMIT ?");
      where.Bind(rows);
      rows.Bind(page.limit + 1);
      while (rows.Step()) found.emplace_back(rows.Int(0), rows.Text(1));
    }
    const auto ids =
        MakePage(std::move(found), page.limit,
                 [](const auto& last) { return std::to_string(last.first); });
    Page<StoredTransfer> transfers;
    transfers.next_cursor = ids.next_cursor;
    for (const auto& [row, id] : ids.items) {
      transfers.items.push_back(*ReadTransfer(database, id));
    }
    return transfers;
  });
}

}  // namespace graspdb
