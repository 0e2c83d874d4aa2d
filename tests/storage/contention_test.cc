#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>

#include "server/store/database.h"
#include "server/store/migrator.h"
#include "server/store/store.h"
#include "tests/support/faulty_vfs.h"
#include "tests/support/rounds.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::IsEmpty;
using Clock = std::chrono::steady_clock;

constexpr int kWriters = 16;

// What a writing process tells at its end.
struct Report {
  int written{0};
  int failed{0};
  double slowest_of_99{0.0};  ///< Of each hundred, s.
};

// Writes from several threads at once until the time is over.
Report WriteUntil(const std::string& path, int process, size_t num_threads,
                  Clock::time_point end) {
  Report report;
  auto store = Store::Open(path);
  if (!store) return {0, 1, 0.0};
  std::vector<std::vector<double>> seconds(num_threads);
  std::vector<int> failed(num_threads);
  std::vector<std::thread> threads;
  for (size_t t = 0; t < num_threads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; Clock::now() < end; ++i) {
        const auto begin = Clock::now();
        const auto object = (*store)->InsertObject(
            MakeNewObject(std::to_string(process) + "/" + std::to_string(t) +
                              "/" + std::to_string(i),
                          ObjectRole::kExample));
        seconds[t].push_back(
            std::chrono::duration<double>(Clock::now() - begin).count());
        if (!object) ++failed[t];
      }
    });
  }
  std::vector<double> all;
  for (size_t t = 0; t < num_threads; ++t) {
    threads[t].join();
    all.insert(all.end(), seconds[t].begin(), seconds[t].end());
    report.failed += failed[t];
  }
  std::sort(all.begin(), all.end());
  report.written = static_cast<int>(all.size());
  if (!all.empty()) report.slowest_of_99 = all[all.size() * 99 / 100];
  return report;
}

struct Writers {
  const char* name;
  int processes;          ///< One, as a server's, or several.
  int disk_milliseconds;  ///< What each change on the disk takes at least.
};

class Contention : public ::testing::TestWithParam<Writers> {};

TEST_P(Contention, SixteenWritersAreNeverToldThatItIsLocked) {
  const auto [name, processes, disk_milliseconds] = GetParam();
  const TempFolder folder;
  if (disk_milliseconds > 0) {
    FaultyVfs::Get().Watch(folder.path());
    FaultyVfs::Get().set_before_change([pause = disk_milliseconds] {
      std::this_thread::sleep_for(std::chrono::milliseconds(pause));
    });
  }
  const std::string path = folder.File("a.db");
  {
    auto store = Store::Open(path);
    ASSERT_TRUE((*store)->InsertCategory(MakeMugCategory()));
  }
  const auto end = Clock::now() + std::chrono::seconds(CountRounds(3));
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  for (int process = 0; process < processes; ++process) {
    if (fork() != 0) continue;
    const Report report = WriteUntil(
        path, process, static_cast<size_t>(kWriters / processes), end);
    const bool told = write(ends[1], &report, sizeof(report)) == sizeof(report);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  int written = 0;
  double slowest = 0.0;
  Report report;
  int reports = 0;
  while (read(ends[0], &report, sizeof(report)) == sizeof(report)) {
    ++reports;
    EXPECT_EQ(report.failed, 0);
    EXPECT_GT(report.written, 0);
    written += report.written;
    slowest = std::max(slowest, report.slowest_of_99);
  }
  close(ends[0]);
  while (wait(nullptr) > 0) {
  }
  EXPECT_EQ(reports, processes);
  if (disk_milliseconds > 0) FaultyVfs::Get().Watch("");
  auto store = Store::Open(path);
  EXPECT_EQ((*store)->Count().value().objects, written);
  EXPECT_THAT((*store)->Check().value().problems, IsEmpty());
  RecordProperty("written", written);
  RecordProperty("p99_milliseconds", static_cast<int>(1e3 * slowest));
}

// Opening looks the file over: that another program begins to write meanwhile,
// or ends, is no damage.
TEST(ContentionWhileOpening, IsNotTakenForDamage) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  CreateDatabaseFile(path);
  Database(path, Database::Mode::kReadWrite)
      .Execute(
          "CREATE TABLE other(x UNIQUE);"
          "WITH RECURSIVE rows(i) AS (SELECT 1 UNION ALL"
          " SELECT i + 1 FROM rows WHERE i < 20000)"
          " INSERT INTO other SELECT randomblob(100) FROM rows");
  const pid_t child = fork();
  if (child == 0) {
    for (;;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      // Its end, the only connection's, writes the log into the file.
      Database database(path, Database::Mode::kReadWrite);
      database.Execute(
          "PRAGMA synchronous = OFF;"
          "UPDATE other SET x = randomblob(100) WHERE rowid % 1000 = 1");
    }
  }
  for (int i = 0; i < CountRounds(100); ++i) {
    const auto file = InspectDatabaseFile(path);
    EXPECT_TRUE(file) << file.error().message;
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
}

INSTANTIATE_TEST_SUITE_P(Of, Contention,
                         ::testing::Values(Writers{"OneProcess", 1, 0},
                                           Writers{"FourProcesses", 4, 0},
                                           Writers{"FourOnASlowDisk", 4, 1}),
                         [](const auto& writers) {
                           return writers.param.name;
                         });

}  // namespace
}  // namespace graspdb
