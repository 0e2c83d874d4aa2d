#include "server/cli/command_line.h"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>

#include "server/codec/json.h"
#include "server/config.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
  int status{0};
  std::string out;
  std::string err;
};

Outcome Call(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "graspdb");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.status =
      RunCommandLine(static_cast<int>(arguments.size()), arguments.data());
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

// Status 2, nothing on standard output, one line that begins as given.
void ExpectUserError(const Outcome& outcome, const std::string& beginning) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, StartsWith("graspdb: " + beginning));
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
}

class CommandLineTest : public ::testing::Test {
 protected:
  CommandLineTest() {
    for (const char* name : {"GRASPDB_DB", "GRASPDB_CONFIG", "GRASPDB_PORT"}) {
      unsetenv(name);
    }
  }
  std::string File(const std::string& name, const std::string& content) {
    std::ofstream(folder_.File(name)) << content;
    return folder_.File(name);
  }

  TempFolder folder_;
  const std::string db_ = folder_.File("a.db");
  const std::string data_ = std::string(GRASPDB_SOURCE_DIR) + "/data";
};

TEST_F(CommandLineTest, EverySubcommandHasHelpWithAnExample) {
  for (const char* command : {"serve", "populate", "grasp", "query", "segment",
                              "learn", "render", "check"}) {
    const Outcome outcome = Call({command, "--help"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  graspdb ")) << command;
  }
  EXPECT_THAT(Call({"--version"}).out, HasSubstr("0."));
}

TEST_F(CommandLineTest, MistakesAreOneLineAndStatusTwo) {
  ExpectUserError(Call({}), "A subcommand is required");
  ExpectUserError(Call({"query", "--colour", "red"}), "");
  ExpectUserError(Call({"check", "--db", db_.c_str()}), db_);
  ExpectUserError(Call({"check", "--db", folder_.path().c_str()}),
                  folder_.path() + " is a folder");
  const std::string foreign = File("foreign.db", "hello");
  ExpectUserError(Call({"check", "--db", foreign.c_str()}),
                  foreign + " is not a database");
  ExpectUserError(Call({"populate", "/no/such/folder", "--db", db_.c_str()}),
                  "/no/such/folder is not a folder");
  ExpectUserError(Call({"grasp", "/no/mesh.stl", "--category", "mug"}),
                  "/no/mesh.stl cannot be read");
  ExpectUserError(Call({"grasp", folder_.path().c_str(), "--category", "mug"}),
                  folder_.path() + " is a folder");
  ExpectUserError(Call({"query", "--server", "localhost"}), "'localhost'");
  ExpectUserError(Call({"query", "--server", "http://127.0.0.1:1"}),
                  "http://127.0.0.1:1 does not answer");
  ExpectUserError(Call({"render", "--db", db_.c_str()}), "");
}

TEST_F(CommandLineTest, PopulateIsIdempotentAndWhatItMadeIsSound) {
  for (int i = 0; i < 2; ++i) {
    const Outcome populated =
        Call({"populate", data_.c_str(), "--no-learn", "--db", db_.c_str(),
              "--decoder", GRASPDB_DECODE_HELPER});
    EXPECT_EQ(populated.status, 0) << populated.err;
  }
  const Outcome check = Call({"check", "--db", db_.c_str(), "--json"});
  EXPECT_EQ(check.status, 0);
  const Json report = ParseJson(check.out).value();
  EXPECT_EQ(report["sound"], true);
  EXPECT_EQ(report["counts"]["objects"], 4);  // One example a category.
  EXPECT_EQ(report["counts"]["hands"], 1);

  const std::string mug = data_ + "/mug/latte.obj";
  const Outcome segment =
      Call({"segment", mug.c_str(), "--category", "mug", "--db", db_.c_str(),
            "--decoder", GRASPDB_DECODE_HELPER});
  EXPECT_EQ(segment.status, 0) << segment.err;
  EXPECT_THAT(segment.out, HasSubstr("handle"));
  const Outcome grasp = Call({"grasp", mug.c_str(), "--category", "mug", "--db",
                              db_.c_str(), "--decoder", GRASPDB_DECODE_HELPER});
  ExpectUserError(grasp, "Nothing has been learned yet for category 'mug'");
  EXPECT_THAT(grasp.err, HasSubstr("graspdb learn"));
  const Outcome query =
      Call({"query", "--category", "mug", "--db", db_.c_str()});
  EXPECT_EQ(query.status, 0);
  EXPECT_EQ(query.out, "no such grasps\n");
}

TEST_F(CommandLineTest, FlagsGoBeforeEnvironmentAndEnvironmentBeforeFile) {
  const std::string one = folder_.File("one.db");
  const std::string two = folder_.File("two.db");
  const std::string three = folder_.File("three.db");
  const std::string config = File("c.toml", "db = \"" + one + "\"\n");
  ExpectUserError(Call({"check", "--config", config.c_str()}), one);
  setenv("GRASPDB_DB", two.c_str(), 1);
  ExpectUserError(Call({"check", "--config", config.c_str()}), two);
  ExpectUserError(
      Call({"check", "--config", config.c_str(), "--db", three.c_str()}),
      three);
  unsetenv("GRASPDB_DB");
}

TEST_F(CommandLineTest, AConfigFileIsCheckedAndItsFaultNamed) {
  ExpectUserError(
      Call({"check", "--config", File("a.toml", "colour = 1\n").c_str()}),
      folder_.File("a.toml") + ": colour is not a setting");
  ExpectUserError(
      Call({"check", "--config", File("b.toml", "db = \n").c_str()}),
      folder_.File("b.toml") + ", line 1");
  ExpectUserError(Call({"check", "--config", "/no/such.toml"}),
                  "/no/such.toml");
}

}  // namespace
}  // namespace graspdb
