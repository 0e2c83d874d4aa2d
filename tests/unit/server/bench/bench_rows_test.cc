#include "server/bench/bench_rows.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

// Four source grasps to one part: two were assembled, one got as far as the
// part, one found no way.
class TransferRow : public ::testing::Test {
 protected:
  TransferRow() {
    part_.id = "p";
    part_.label = "handle";
    part_.faces = {0, 1, 2};
    AddAttempt(0.2, 0.1, 0.05, 0.2);  // Above open-close on both.
    AddAttempt(0.1, 0.1, 0.1, 0.1);   // A tie is not better.
    AddAttempt(0.3, std::nullopt, 0.0, 0.0);
    AddAttempt(std::nullopt, std::nullopt, 0.4, 0.0);
    transfer_.attempts[2].assembly = TransferOutcome::kFingerCollision;
    transfer_.attempts[3].transfer = TransferOutcome::kTooFar;
    transfer_.attempts[3].assembly = TransferOutcome::kTooFar;
    transfer_.seconds = {{MakeCoreStage("transfer", "handle"), 0.8},
                         {MakeCoreStage("assembly", "handle"), 0.4}};
  }

  void AddAttempt(std::optional<double> on_part, std::optional<double> on_whole,
                  double open_close_part, double open_close_whole) {
    StoredAttempt attempt;
    attempt.part_id = "p";
    attempt.transfer = attempt.assembly = TransferOutcome::kSucceeded;
    attempt.example_epsilon = attempt.example_epsilon_whole = 0.15;
    attempt.open_close_epsilon_part = open_close_part;
    attempt.open_close_epsilon_whole = open_close_whole;
    const std::string name = std::to_string(transfer_.attempts.size());
    if (on_part) {
      attempt.transferred_grasp_id = "t" + name;
      AddGrasp("t" + name, GraspStage::kTransfer, *on_part);
    }
    if (on_whole) {
      attempt.assembled_grasp_id = "a" + name;
      AddGrasp("a" + name, GraspStage::kAssembly, *on_whole);
      grasps_.back().robust = *on_whole * 5.0;
      grasps_.back().physical = name == "0" ? 1.0 : 5.0 / 6.0;
      grasps_.back().penetration = 1e-4;
    }
    transfer_.attempts.push_back(attempt);
  }
  void AddGrasp(const std::string& id, GraspStage stage, double epsilon) {
    StoredGrasp grasp;
    grasp.id = id;
    grasp.part_id = "p";
    grasp.stage = stage;
    grasp.grasp.quality.epsilon = epsilon;
    grasps_.push_back(grasp);
  }

  StoredTransfer transfer_;
  StoredPart part_;
  std::vector<StoredGrasp> grasps_;
};

TEST_F(TransferRow, CountsEverySourceOnceAndFiltersNothing) {
  const Json row = MakeTransferRow(transfer_, part_, grasps_, {});
  EXPECT_EQ(row["attempted"], 4);
  EXPECT_EQ(row["transferred"], 3);
  EXPECT_EQ(row["assembled"], 2);
  EXPECT_EQ(row["open_close"]["transferred"], 3);
  EXPECT_EQ(row["open_close"]["assembled"], 2);
  EXPECT_EQ(row["triangles"], 3);
  EXPECT_EQ(row["seconds"]["transfer"], 0.8);
  EXPECT_EQ(row["failures"], Json({{"finger_collision", 1}, {"too_far", 1}}));
  EXPECT_EQ(row["points"].size(), 4u);
  EXPECT_TRUE(row["points"][3]["assembled"].is_null());
}

TEST_F(TransferRow, ATieWithOpenCloseIsNotBetter) {
  const Json row = MakeTransferRow(transfer_, part_, grasps_, {});
  // Parts: 0.2 > 0.05, 0.1 = 0.1, 0.3 > 0. Wholes: 0.1 < 0.2, 0.1 = 0.1.
  EXPECT_EQ(row["over_open_close"]["transferred"]["hits"], 2);
  EXPECT_EQ(row["over_open_close"]["transferred"]["count"], 3);
  EXPECT_EQ(row["over_open_close"]["assembled"]["hits"], 0);
  EXPECT_EQ(row["over_open_close"]["assembled"]["count"], 2);
  EXPECT_EQ(row["over_example"]["transferred"]["hits"], 2);
}

TEST_F(TransferRow, OnlyWhatWithstoodEveryPushIsHeld) {
  const TestScores lift{{"lift", {{"a0", 1.0}, {"a1", 1.0}}}};
  const Json row = MakeTransferRow(transfer_, part_, grasps_, lift);
  EXPECT_EQ(row["physical"]["six_pushes"]["hits"], 1);
  EXPECT_EQ(row["physical"]["six_pushes"]["count"], 2);
  EXPECT_EQ(row["physical"]["lift"]["hits"], 2);
  EXPECT_NEAR(row["robust"]["median"].get<double>(), 0.5, 1e-12);
}

TEST_F(TransferRow, PooledRowsAddUpAndTheLeastIsTold) {
  const Json row = MakeTransferRow(transfer_, part_, grasps_, {});
  const Json refused =
      MakeFailedRow("handle", 4, {ErrorCode::kUnusableInput, "Holes.", ""});
  const Json pool = PoolRows({row, row, refused});
  EXPECT_EQ(pool["attempted"], 12);
  EXPECT_EQ(pool["transferred"]["hits"], 6);
  EXPECT_EQ(pool["assembled"]["hits"], 4);
  EXPECT_EQ(pool["least_row"]["assembled"], 0);
  EXPECT_EQ(pool["over_open_close"]["transferred"]["count"], 6);
  EXPECT_EQ(pool["failures"]["too_far"], 2);
  EXPECT_EQ(pool["failures"]["object"], 4);
  EXPECT_EQ(pool["physical"]["six_pushes"]["hits"], 2);
}

}  // namespace
}  // namespace graspdb
