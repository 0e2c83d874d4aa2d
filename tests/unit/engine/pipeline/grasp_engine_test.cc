#include "engine/grasp_engine.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "engine/hand/hand_shape.h"
#include "engine/planning/grasp_evaluator.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// The whole method with another hand: a two-jaw gripper learns on a box and
// transfers to a slightly larger one.
class GripperPipeline : public ::testing::Test {
 protected:
  static constexpr int kSources = 12;

  static Part MakePart(const TriangleMesh& mesh) {
    Part part;
    part.solid_O = mesh;
    part.num_surface_faces = mesh.num_triangles();
    return part;
  }

  static LabelledMesh Label(const TriangleMesh& mesh) {
    return {mesh, std::vector<int>(mesh.num_triangles(), 0)};
  }

  static Parameters MakeSmallParameters() {
    Parameters p;
    p.active_learning.seed_samples = 300;
    p.active_learning.rounds = 1;
    p.active_learning.queries_per_round = 100;
    p.active_learning.test_samples = 50;
    p.swarm.particles = 40;
    p.swarm.iterations = 35;
    p.mapping.samples = 400;
    p.replan.iterations = 30;
    p.replan.climb_samples = 20;
    return p;
  }

  GraspSpace LearnBox(int threads) const {
    ExecutionContext context;
    return Learn({gripper_, MakePart(box_E_), Label(box_E_),
                  MakeSmallParameters(), 1, threads},
                 context)
        .value();
  }

  // Learned once for all tests that only transfer.
  const GraspSpace& LearnedBox() const {
    static const GraspSpace space = LearnBox(2);
    return space;
  }

  TransferResult TransferBox(const GraspSpace& space, int threads) const {
    return TransferFrom(box_E_, space, threads);
  }

  // @param whole_E  What box_E_ is a part of.
  TransferResult TransferFrom(const TriangleMesh& whole_E,
                              const GraspSpace& space, int threads) const {
    return Run(MakeRequest(whole_E, space, threads));
  }

  static TransferResult Run(const TransferRequest& request) {
    ExecutionContext context;
    return Transfer(request, context).value();
  }

  TransferRequest MakeRequest(const TriangleMesh& whole_E,
                              const GraspSpace& space, int threads) const {
    TransferRequest request;
    request.hand = gripper_;
    request.whole_E = std::make_shared<const Solid>(whole_E);
    request.novel = Label(box_N_);
    request.example_parts = {MakePart(box_E_)};
    request.novel_parts = {MakePart(box_N_)};
    request.scale = 1.05;
    request.grasp_spaces = {std::make_shared<const GraspSpace>(space)};
    request.sources_per_part = kSources;
    request.parameters = MakeSmallParameters();
    request.threads = threads;
    return request;
  }

  const std::shared_ptr<const HandShape> gripper_ =
      std::make_shared<const HandShape>(workshop::MakeTwoJawGripper());
  const TriangleMesh box_E_ = workshop::MakeBox({0.04, 0.03, 0.08}, 8);
  const TriangleMesh box_N_ = workshop::MakeBox({0.042, 0.033, 0.084}, 8);
};

TEST_F(GripperPipeline, LearnsAndTransfersMostGrasps) {
  const GraspSpace& space = LearnedBox();
  ASSERT_GT(space.grasps.size(), 10u);
  ASSERT_EQ(space.curve.size(), 2u);
  const TransferResult result = TransferBox(space, 2);
  EXPECT_TRUE(result.complete);
  const HandShape& hand = *gripper_;
  const Solid novel(box_N_);
  int assembled = 0;
  for (const TransferRecord& record : result.records) {
    if (!record.assembled) {
      EXPECT_NE(record.assembly, TransferOutcome::kSucceeded);
      continue;
    }
    ++assembled;
    EXPECT_LT(record.penetration, 0.001);
    EXPECT_GE(record.assembled->quality.epsilon, 1e-3);
    EXPECT_EQ(
        FindCollidingLink(
            hand, record.assembled->configuration.X_OH,
            CalcLinkPoses(gripper_->model(), record.assembled->configuration.q),
            novel),
        -1);
    for (const Contact& contact : record.assembled->contacts) {
      EXPECT_LE(contact.gap, 0.0005);
    }
  }
  EXPECT_GE(assembled, static_cast<int>(result.records.size()) / 2);
}

TEST_F(GripperPipeline, ATransferEndsWithEnoughSureGraspsOnAnyThreads) {
  const GraspSpace& space = LearnedBox();
  std::vector<TransferResult> results;
  for (const int threads : {1, 2}) {
    TransferRequest request = MakeRequest(box_E_, space, threads);
    request.parameters.transfer.sure_grip = 0.0;
    request.enough = 2;
    std::vector<int> told;
    request.on_record = [&](int i, const TransferRecord&) {
      told.push_back(i);
    };
    results.push_back(Run(request));
    const auto& records = results.back().records;
    EXPECT_LT(records.size(), static_cast<size_t>(kSources));
    EXPECT_TRUE(records.back().assembled);
    EXPECT_EQ(std::count_if(records.begin(), records.end(),
                            [](const TransferRecord& record) {
                              return record.assembled.has_value();
                            }),
              2);
    std::vector<int> all(records.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(told, all);
  }
  ASSERT_EQ(results[0].records.size(), results[1].records.size());
  for (size_t i = 0; i < results[0].records.size(); ++i) {
    EXPECT_EQ(results[0].records[i].source_grasp,
              results[1].records[i].source_grasp);
    EXPECT_EQ(results[0].records[i].assembled, results[1].records[i].assembled);
  }
}

TEST_F(GripperPipeline, WhatIsNotSureIsTriedOnceMoreWithMoreSamples) {
  const GraspSpace& space = LearnedBox();
  std::vector<TransferResult> results;
  for (const int threads : {1, 2}) {
    TransferRequest request = MakeRequest(box_E_, space, threads);
    request.parameters.transfer.sure_grip = 1.1;  // Never.
    request.parameters.replan.quick_climb_samples = 0;
    request.parameters.replan.climb_samples = 5;
    request.enough = 1;
    std::map<int, int> told;
    request.on_record = [&](int i, const TransferRecord&) { ++told[i]; };
    results.push_back(Run(request));
    const auto& records = results.back().records;
    ASSERT_EQ(records.size(), static_cast<size_t>(kSources));
    for (int i = 0; i < kSources; ++i) {
      EXPECT_EQ(told[i], records[static_cast<size_t>(i)].assembled ? 2 : 1);
    }
  }
  for (size_t i = 0; i < results[0].records.size(); ++i) {
    EXPECT_EQ(results[0].records[i].assembled, results[1].records[i].assembled);
  }
}

TEST_F(GripperPipeline, TheHandKeepsOffThePartThatIsKeptFree) {
  constexpr double kClearance = 0.01;
  const GraspSpace& space = LearnedBox();
  TransferRequest request = MakeRequest(box_E_, space, 2);
  for (int f = 0; f < box_N_.num_triangles(); ++f) {
    if (box_N_.centroid(f).z() > 0.03) request.novel.face_labels[f] = 1;
  }
  const auto count = [&](const TransferResult& result, bool near) {
    int counted = 0;
    for (const TransferRecord& record : result.records) {
      counted += record.assembled.has_value() &&
                 (record.assembled_clearances[1] < kClearance) == near;
    }
    return counted;
  };
  const TransferResult free = Run(request);
  EXPECT_GT(count(free, true), 0);
  request.keep_free = {1};
  request.parameters.transfer.min_clearance = kClearance;
  const TransferResult kept = Run(request);
  EXPECT_EQ(count(kept, true), 0);
  EXPECT_EQ(count(kept, false), count(free, false));
  EXPECT_GT(count(kept, false), 0);
  EXPECT_TRUE(std::any_of(kept.records.begin(), kept.records.end(),
                          [](const TransferRecord& record) {
                            return record.assembly ==
                                   TransferOutcome::kNotKeptFree;
                          }));
}

TEST_F(GripperPipeline, OneAndTwoThreadsGiveTheSameBytes) {
  const GraspSpace one = LearnBox(1);
  GraspSpace two = LearnBox(2);
  two.configuration_space_seconds = one.configuration_space_seconds;
  EXPECT_EQ(one, two);
  const TransferResult a = TransferBox(one, 1);
  const TransferResult b = TransferBox(two, 2);
  ASSERT_EQ(a.records.size(), b.records.size());
  for (size_t i = 0; i < a.records.size(); ++i) {
    EXPECT_EQ(a.records[i].assembled, b.records[i].assembled);
    EXPECT_EQ(a.records[i].robust, b.records[i].robust);
  }
}

TEST_F(GripperPipeline, TheExamplesQualityOnItsWholeIsZeroWhereItObstructs) {
  const GraspSpace& space = LearnedBox();
  for (const TransferRecord& record : TransferBox(space, 2).records) {
    EXPECT_NEAR(record.example_epsilon_whole, record.example_epsilon, 1e-9);
  }
  // The gripper's way is inside this one, whose mass centre is the same.
  const TriangleMesh block = workshop::MakeBox({0.3, 0.3, 0.3}, 4);
  for (const TransferRecord& record : TransferFrom(block, space, 2).records) {
    EXPECT_GT(record.example_epsilon, 0.0);
    EXPECT_EQ(record.example_epsilon_whole, 0.0);
  }
}

TEST_F(GripperPipeline, TheDeadlineLeavesWhatWasFoundAndMarksTheRest) {
  TransferRequest request = MakeRequest(box_E_, LearnedBox(), 1);
  ExecutionContext context;
  request.on_record = [&](int i, const TransferRecord&) {
    if (i == 1) context.set_deadline(ExecutionContext::Clock::time_point{});
  };
  const auto cut = Transfer(request, context).value();
  EXPECT_FALSE(cut.complete);
  request.on_record = {};
  const TransferResult whole = Run(request);
  ASSERT_EQ(cut.records.size(), whole.records.size());
  for (size_t i = 0; i < cut.records.size(); ++i) {
    EXPECT_EQ(cut.records[i].cut, i > 1);
    EXPECT_FALSE(whole.records[i].cut);
    if (i > 1) {
      EXPECT_FALSE(cut.records[i].assembled);
    } else {
      EXPECT_EQ(cut.records[i].assembled, whole.records[i].assembled);
    }
  }
}

TEST_F(GripperPipeline, TheDeadlineLeavesWhatTheFirstRoundFound) {
  TransferRequest request = MakeRequest(box_E_, LearnedBox(), 1);
  request.parameters.transfer.sure_grip = 1.1;  // Never.
  request.parameters.replan.quick_climb_samples = 0;
  request.parameters.replan.climb_samples = 5;
  request.enough = 1;
  int told = 0;
  ExecutionContext context;
  request.on_record = [&](int, const TransferRecord&) {
    if (++told == kSources) {
      context.set_deadline(ExecutionContext::Clock::time_point{});
    }
  };
  const auto cut = Transfer(request, context).value();
  EXPECT_FALSE(cut.complete);
  EXPECT_EQ(told, kSources);
  int assembled = 0;
  for (const TransferRecord& record : cut.records) {
    EXPECT_FALSE(record.cut);
    assembled += record.assembled ? 1 : 0;
  }
  EXPECT_GT(assembled, 0);
}

TEST_F(GripperPipeline, ATransferThatHasEnoughIsCompleteThoughTimeIsUp) {
  TransferRequest request = MakeRequest(box_E_, LearnedBox(), 1);
  request.parameters.transfer.sure_grip = 0.0;
  request.enough = 1;
  ExecutionContext context;
  request.on_record = [&](int, const TransferRecord& record) {
    if (record.assembled) {
      context.set_deadline(ExecutionContext::Clock::time_point{});
    }
  };
  EXPECT_TRUE(Transfer(request, context).value().complete);
}

TEST_F(GripperPipeline, CancellingEndsATransferWithAnError) {
  TransferRequest request = MakeRequest(box_E_, LearnedBox(), 1);
  ExecutionContext context;
  context.Cancel();
  EXPECT_EQ(Transfer(request, context).error().code, ErrorCode::kCancelled);
}

TEST_F(GripperPipeline, WhatTheSwarmHadFoundWhenItWasCancelledIsNoGraspSpace) {
  for (const bool by_deadline : {false, true}) {
    ExecutionContext context([&](const std::string& stage, double) {
      if (stage != "swarm") return;
      if (by_deadline) {
        context.set_deadline(ExecutionContext::Clock::time_point{});
      } else {
        context.Cancel();
      }
    });
    const auto learned = Learn({gripper_, MakePart(box_E_), Label(box_E_),
                                MakeSmallParameters(), 1, 1},
                               context);
    ASSERT_FALSE(learned);
    EXPECT_EQ(learned.error().code, ErrorCode::kCancelled);
    EXPECT_EQ(context.TimedOut(), by_deadline);
  }
}

TEST_F(GripperPipeline, CancellingEndsLearning) {
  ExecutionContext context;
  context.Cancel();
  EXPECT_EQ(Learn({gripper_, MakePart(box_E_), Label(box_E_),
                   MakeSmallParameters(), 1, 1},
                  context)
                .error()
                .code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace graspdb
