#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {

using store::CountOf;
using store::ListByName;
using store::ListNames;
using store::Throw;
using store::Unwrap;

namespace {

StoredHand ReadHand(Database& database, const std::string& name,
                    bool with_meshes) {
  StoredHand hand;
  {
    Statement row = database.Prepare(
        "SELECT name, title, sha256, urdf, annotations, created_at"
        " FROM hands WHERE name = ?");
    if (!row.Bind(name).Step()) {
      Throw(ErrorCode::kNotFound, "There is no hand '" + name + "'.",
            ListNames(database, "hands"), "hand");
    }
    hand.name = row.Text(0);
    hand.title = row.Text(1);
    hand.sha256 = row.Text(2);
    hand.urdf = row.Text(3);
    hand.annotations = row.Text(4);
    hand.created_at = row.Text(5);
  }
  if (!with_meshes) return hand;
  Statement meshes = database.Prepare(
      "SELECT file, mesh FROM hand_meshes WHERE hand = ? ORDER BY position");
  meshes.Bind(name);
  while (meshes.Step()) {
    hand.meshes.emplace_back(meshes.Text(0),
                             Unwrap(DecodeMesh(meshes.Blob(1))));
  }
  return hand;
}

}  // namespace

Result<StoredHand> Store::InsertHand(const StoredHand& hand) {
  return impl_->Write([&](Database& database) {
    if (CountOf(database, "hands WHERE name = ?", hand.name) > 0) {
      const StoredHand old = ReadHand(database, hand.name, true);
      if (old.sha256 == hand.sha256) return old;
      Throw(ErrorCode::kConflict,
            "There is another hand '" + hand.name + "' already.",
            "give this one another name", "name");
    }
    database.Prepare("INSERT INTO hands VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(hand.name, hand.title, hand.sha256, hand.urdf, hand.annotations,
              FormatNow())
        .Run();
    for (size_t i = 0; i < hand.meshes.size(); ++i) {
      database.Prepare("INSERT INTO hand_meshes VALUES (?, ?, ?, ?)")
          .Bind(hand.name, static_cast<int64_t>(i), hand.meshes[i].first)
          .BindBlob(EncodeMesh(hand.meshes[i].second))
          .Run();
    }
    return ReadHand(database, hand.name, true);
  });
}

Result<StoredHand> Store::FindHand(const std::string& name) const {
  return impl_->Read(
      [&](Database& database) { return ReadHand(database, name, true); });
}

Result<Page<StoredHand>> Store::ListHands(const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    return ListByName(database, "hands", page, [&](const std::string& name) {
      return ReadHand(database, name, false);
    });
  });
}

}  // namespace graspdb
