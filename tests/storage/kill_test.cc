#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>

#include "server/store/store.h"
#include "tests/support/rounds.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::IsEmpty;

// What a child process has acknowledged: the id of an object, or that of the
// grasp space that was learned from it.
struct Acknowledgement {
  char kind;  // 'o' or 's'.
  char id[36];
};

void Acknowledge(int pipe, char kind, const std::string& id) {
  Acknowledgement message{kind, {}};
  id.copy(message.id, sizeof(message.id));
  // Shorter than PIPE_BUF, hence whole or not at all.
  if (write(pipe, &message, sizeof(message)) != sizeof(message)) _exit(3);
}

// Imports and learns for ever, telling what is done.
[[noreturn]] void WorkUntilKilled(const std::string& path, int round,
                                  int pipe) {
  auto opened = Store::Open(path);
  if (!opened) _exit(4);
  Store& store = **opened;
  for (int i = 0;; ++i) {
    const std::string bytes = std::to_string(round) + "/" + std::to_string(i);
    const auto object =
        store.InsertObject(MakeNewObject(bytes, ObjectRole::kExample));
    if (!object) _exit(5);
    Acknowledge(pipe, 'o', object->id);
    const auto parts = store.ListParts(object->id);
    const auto space = store.InsertGraspSpace(MakeSpaceRecord((*parts)[0], 1),
                                              MakeGraspSpace(1, 5));
    if (!space) _exit(6);
    Acknowledge(pipe, 's', space->id);
  }
}

// What the store is asked after each kill.
void CheckAcknowledged(const std::string& path, int pipe, int* acknowledged,
                       std::chrono::duration<double>* slowest_open) {
  const auto begin = std::chrono::steady_clock::now();
  auto store = Store::Open(path);
  *slowest_open = std::max<std::chrono::duration<double>>(
      *slowest_open, std::chrono::steady_clock::now() - begin);
  ASSERT_TRUE(store) << store.error().message;
  Acknowledgement message{};
  while (read(pipe, &message, sizeof(message)) == sizeof(message)) {
    ++*acknowledged;
    const std::string id(message.id, strnlen(message.id, 36));
    if (message.kind == 'o') {
      EXPECT_TRUE((*store)->ReadObjectMeshes(id));
      EXPECT_EQ((*store)->ListParts(id).value().size(), 2u);
    } else {
      EXPECT_EQ((*store)->ReadGraspSpace(id).value().grasps.size(), 5u);
    }
  }
  EXPECT_THAT((*store)->Check().value().problems, IsEmpty());
}

TEST(KilledProcess, LosesNothingThatItAcknowledgedAndLeavesNothingHalf) {
  // Each database lives through so many kills.
  constexpr int kKills = 25;
  const TempFolder folder;
  Random random(1);
  int acknowledged = 0;
  std::chrono::duration<double> slowest_open{0.0};
  std::string path;
  for (int round = 0; round < CountRounds(kKills); ++round) {
    if (round % kKills == 0) {
      path = folder.File(std::to_string(round) + ".db");
      auto store = Store::Open(path);
      ASSERT_TRUE((*store)->InsertCategory(MakeMugCategory()));
      ASSERT_TRUE((*store)->InsertHand(MakeClaw()));
    }
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      WorkUntilKilled(path, round, ends[1]);
    }
    close(ends[1]);
    // At its beginning, or at its work, however slow the disk is.
    if (round % 2 == 1) {
      pollfd told{ends[0], POLLIN, 0};
      EXPECT_EQ(poll(&told, 1, 60'000), 1);
    }
    std::this_thread::sleep_for(
        std::chrono::milliseconds(20 + random.NextIndex(400)));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
    CheckAcknowledged(path, ends[0], &acknowledged, &slowest_open);
    close(ends[0]);
  }
  EXPECT_GE(acknowledged, CountRounds(kKills) / 2);
  RecordProperty("acknowledged", acknowledged);
  RecordProperty("slowest_open_milliseconds",
                 static_cast<int>(1e3 * slowest_open.count()));
}

// At any moment the file is either absent or whole.
TEST(KilledProcess, LeavesNoHalfMadeDatabase) {
  const TempFolder folder;
  Random random(2);
  for (int round = 0; round < CountRounds(25); ++round) {
    const std::string path = folder.File(std::to_string(round) + ".db");
    const pid_t child = fork();
    if (child == 0) {
      const bool opened = Store::Open(path).has_value();
      _exit(opened ? 0 : 1);
    }
    std::this_thread::sleep_for(
        std::chrono::microseconds(random.NextIndex(30'000)));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_TRUE(Store::Open(path)) << "round " << round;
  }
}

}  // namespace
}  // namespace graspdb
