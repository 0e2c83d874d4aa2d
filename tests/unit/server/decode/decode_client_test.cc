#include "server/decode/decode_client.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/geometry/surface_sampling.h"
#include "engine/hand/urdf_reader.h"
#include "tests/support/cloud_files.h"
#include "tests/support/mesh_files.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

DecoderOptions MakeOptions() {
  DecoderOptions options;
  options.helper = GRASPDB_DECODE_HELPER;
  return options;
}

Result<DecodedMesh> Decode(const FileBytes& bytes, const std::string& name,
                           const DecoderOptions& options = MakeOptions()) {
  DecodeRequest request;
  request.file_name = name;
  return Decoder(options).Decode(bytes, request);
}

// A folder of this test's own, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "decode-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~ScratchFolder() { fs::remove_all(path_); }
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

// A program that does something else than decoding.
DecoderOptions MakeImpostor(const ScratchFolder& folder,
                            const std::string& script) {
  const fs::path path = folder / "impostor";
  std::ofstream(path) << "#!/bin/sh\n" << script << "\n";
  fs::permissions(path, fs::perms::owner_all);
  DecoderOptions options;
  options.helper = path.string();
  options.deadline = 2.0;
  return options;
}

std::vector<std::string> RunAndReadLines(const std::string& command) {
  std::vector<std::string> lines;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> line{};
  while (fgets(line.data(), line.size(), pipe) != nullptr) {
    lines.emplace_back(line.data());
  }
  pclose(pipe);
  return lines;
}

TEST(Decoder, ReadsAUrdfAsItWouldBeReadHere) {
  std::ifstream file(std::string(GRASPDB_SOURCE_DIR) +
                     "/data/hands/barrett-bh8-280/hand.urdf");
  const std::string urdf(std::istreambuf_iterator<char>(file), {});
  const Decoder decoder(MakeOptions());
  const HandTree tree = decoder.DecodeUrdf(urdf).value();
  const HandTree here = ReadUrdf(urdf).value();
  EXPECT_TRUE(tree == here);
  EXPECT_GT(tree.links.size(), 8u);
  EXPECT_EQ(decoder.counts().admitted, 1);
}

TEST(Decoder, SaysOfAUrdfWhatIsWrongWithIt) {
  const auto refused = Decoder(MakeOptions()).DecodeUrdf("<robot");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnusableInput);
  EXPECT_EQ(refused.error().field, "urdf");
  // What is nested deeply costs the helper its stack and time, not us.
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 5'000; ++i) deep += "<a>";
  EXPECT_FALSE(Decoder(MakeOptions()).DecodeUrdf(deep));
  const ScratchFolder folder;
  const auto lost = Decoder(MakeImpostor(folder, "exit 3")).DecodeUrdf("");
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kUnusableInput);
  EXPECT_EQ(lost.error().field, "urdf");
}

TEST(Decoder, AdmitsEveryEncoding) {
  const TriangleMesh box = workshop::MakeBox({0.1, 0.08, 0.06}, 3);
  for (const auto& [name, bytes] : MakeEveryFile(box)) {
    SCOPED_TRACE(name);
    const auto decoded = Decode(bytes, name);
    ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
    EXPECT_THAT(decoded->repairs, IsEmpty());
    EXPECT_EQ(decoded->mesh_O.num_triangles(), box.num_triangles());
    EXPECT_TRUE(decoded->work_O == decoded->mesh_O);
    EXPECT_NEAR(decoded->mass.volume, 0.1 * 0.08 * 0.06, 1e-10);
    EXPECT_NEAR(decoded->mass.p_McCM.norm(), 0, 1e-8);
    EXPECT_EQ(decoded->format, GetName(*GuessMeshFormat(bytes, name)));
    EXPECT_FALSE(decoded->cloud.has_value());
  }
}

TEST(Decoder, MakesASolidOfEveryCloud) {
  const auto points =
      SamplePoissonDisk(workshop::MakeSphere(0.05, 40), 600, 1).points;
  for (const auto& [name, bytes] : MakeEveryCloud(points)) {
    SCOPED_TRACE(name);
    const auto decoded = Decode(bytes, name);
    ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
    EXPECT_NEAR(decoded->mass.max_radius, 0.05, 0.005);
    ASSERT_TRUE(decoded->cloud.has_value());
    EXPECT_EQ(decoded->cloud->report.num_points, 600);
    EXPECT_FALSE(decoded->cloud->report.one_sided);
    EXPECT_GT(decoded->cloud->seen_share, 0.99);
    EXPECT_EQ(decoded->cloud->points_O.size(), 600u);
    EXPECT_EQ(decoded->repairs.size(), 1u);
  }
}

TEST(Decoder, RepairsAndDecimates) {
  const TriangleMesh sphere = workshop::MakeSphere(50.0, 48);
  const TriangleMesh open(sphere.vertices(), {sphere.triangles().begin(),
                                              sphere.triangles().end() - 1});
  DecodeRequest request;
  request.format = MeshFormat::kPly;
  request.metres_per_unit = 0.001;
  request.work_triangles = 400;
  const auto decoded =
      Decoder(MakeOptions()).Decode(MakeBinaryPly(open, true), request);
  ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
  EXPECT_THAT(decoded->repairs,
              ::testing::ElementsAre("filled 1 hole with 1 face"));
  EXPECT_EQ(decoded->mesh_O.num_triangles(), sphere.num_triangles());
  EXPECT_LE(decoded->work_O.num_triangles(), 400);
  EXPECT_TRUE(IsClosed(decoded->work_O));
  EXPECT_NEAR(decoded->mass.max_radius, 0.05, 1e-4);
}

TEST(Decoder, RefusesWhatIsNoMeshOrNoSolidOrNoObjectToGrasp) {
  const TriangleMesh box = workshop::MakeBox({0.1, 0.1, 0.1});
  const TriangleMesh sheet({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}});
  FileBytes truncated = MakeBinaryStl(box);
  truncated.resize(truncated.size() / 2);
  struct {
    FileBytes bytes;
    std::string name;
    const char* words;
  } const cases[] = {
      {{}, "", "empty"},
      {{}, "a.obj", "OBJ: it is empty"},
      {truncated, "a.stl", "STL: its header announces 12 triangles"},
      {ToBytes("%PDF-1.4 nothing like a mesh"), "", "no known mesh format"},
      {MakeObj(sheet), "a.obj", "one plane"},
      {MakeObj(workshop::MakeBox({100, 100, 100})), "a.obj", "100 m"},
  };
  for (const auto& [bytes, name, words] : cases) {
    const auto decoded = Decode(bytes, name);
    ASSERT_FALSE(decoded.has_value()) << words;
    EXPECT_EQ(decoded.error().code, ErrorCode::kUnusableInput);
    EXPECT_THAT(decoded.error().message, HasSubstr(words));
    EXPECT_FALSE(decoded.error().hint.empty());
  }
}

TEST(Decoder, NamesTheLimitThatIsExceeded) {
  const FileBytes bytes = MakeObj(workshop::MakeBox({0.1, 0.1, 0.1}));
  DecodeRequest request;
  request.file_name = "a.obj";
  request.limits.max_triangles = 11;
  auto decoded = Decoder(MakeOptions()).Decode(bytes, request);
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(decoded.error().message, HasSubstr("the limit is 11"));
  request.limits.max_bytes = 10;
  decoded = Decoder(MakeOptions()).Decode(bytes, request);
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(decoded.error().message, HasSubstr("the limit is 10"));
}

TEST(Decoder, GivesUpAtTheDeadline) {
  ScratchFolder folder;
  // Never reads what it is sent, which is more than a socket holds.
  DecoderOptions options = MakeImpostor(folder, "exec sleep 1000");
  options.deadline = 0.3;
  for (const std::size_t size : {100u, 10'000'000u}) {
    const auto decoded = Decode(FileBytes(size, 'v'), "a.obj", options);
    ASSERT_FALSE(decoded.has_value());
    EXPECT_EQ(decoded.error().code, ErrorCode::kUnusableInput);
    EXPECT_THAT(decoded.error().message, HasSubstr("gave up after 0.3 s"));
  }
}

TEST(Decoder, EndsWithTheContextOfWhoAsks) {
  ScratchFolder folder;
  const Decoder decoder(MakeImpostor(folder, "exec sleep 1000"));
  ExecutionContext context;
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    context.Cancel();
  });
  const FileBytes bytes(100, 'v');
  const auto decoded = decoder.Decode(bytes, DecodeRequest{}, context);
  EXPECT_EQ(decoded.error().code, ErrorCode::kCancelled);
  later.join();
  EXPECT_EQ(decoder.DecodeUrdf("<robot/>", context).error().code,
            ErrorCode::kCancelled);
}

TEST(Decoder, OutlivesAHelperThatMisbehaves) {
  ScratchFolder folder;
  const FileBytes bytes = MakeObj(workshop::MakeBox({0.1, 0.1, 0.1}, 40));
  for (const auto& [script, words] : std::map<std::string, std::string>{
           {"kill -SEGV $$", "crashed on the mesh (signal 11)"},
           {"exit 0", "without an answer"},
           {"exit 3", "without an answer"},
           {"cat", "without an answer"},
           {"cat > /dev/null; echo GDA1", "without an answer"},
           {"exec 0<&- 1>&-; sleep 1000", "signal 9"}}) {
    SCOPED_TRACE(script);
    const auto decoded = Decode(bytes, "a.obj", MakeImpostor(folder, script));
    ASSERT_FALSE(decoded.has_value());
    EXPECT_EQ(decoded.error().code, ErrorCode::kUnusableInput);
    EXPECT_THAT(decoded.error().message, HasSubstr(words));
  }
}

// A finding among the mutants: the library reads past the array's end.
TEST(Decoder, OutlivesADaeThatLiesAboutItsNumbers) {
  const FileBytes bytes = MakeDae(workshop::MakeBox({0.1, 0.1, 0.1}));
  std::string text(bytes.begin(), bytes.end());
  const size_t count = text.find("count=\"") + 7;
  text.replace(count, text.find('"', count) - count, "0");
  const Decoder decoder(MakeOptions());
  DecodeRequest request;
  request.file_name = "a.dae";
  const auto lie = decoder.Decode(ToBytes(text), request);
  ASSERT_FALSE(lie.has_value());
  EXPECT_EQ(lie.error().code, ErrorCode::kUnusableInput);
  EXPECT_TRUE(decoder.Decode(bytes, request).has_value());
}

// Sanitizers cannot live within a limit on memory.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
TEST(Decoder, SaysSoWhenAMeshNeedsTooMuchMemory) {
  DecoderOptions options = MakeOptions();
  options.memory_bytes = 160 << 20;
  const auto decoded =
      Decode(MakeBinaryStl(workshop::MakeSphere(0.05, 300)), "a.stl", options);
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error().code, ErrorCode::kUnusableInput);
  EXPECT_THAT(decoded.error().message,
              ::testing::AnyOf(HasSubstr("memory"), HasSubstr("crashed")));
}
#endif

TEST(Decoder, ReportsAHelperThatIsNotThere) {
  DecoderOptions options;
  options.helper = "/nonexistent/graspdb-decode";
  const auto decoded = Decode(ToBytes("v"), "a.obj", options);
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error().code, ErrorCode::kInternal);
  EXPECT_THAT(decoded.error().message, HasSubstr("No such file"));
  EXPECT_EQ(Decoder(options).Check().error().code, ErrorCode::kInternal);
}

TEST(Decoder, ChecksThatItsHelperIsConfined) {
  const auto confinement = Decoder(MakeOptions()).Check();
  ASSERT_TRUE(confinement.has_value()) << confinement.error().message;
  EXPECT_THAT(*confinement, EndsWith("seccomp"));
}

TEST(DecodeHelper, IsRefusedTenForbiddenSystemCalls) {
  const auto lines =
      RunAndReadLines(std::string(GRASPDB_DECODE_HELPER) + " --probe");
  EXPECT_THAT(lines, SizeIs(10));
  EXPECT_THAT(lines, Each(EndsWith(": blocked\n")));
}

TEST(DecodeHelper, OpensNothingThatAMeshRefersTo) {
  ASSERT_EQ(std::system("strace -V > /dev/null"), 0) << ".ci/install has it";
  for (const std::string& line : RunAndReadLines("strace true 2>&1")) {
    // Any other trouble with strace fails below.
    if (line.starts_with("strace:") &&
        line.find("Operation not permitted") != line.npos) {
      GTEST_SKIP() << "this container forbids ptrace; that the helper can open "
                      "nothing is shown from inside by "
                      "IsRefusedTenForbiddenSystemCalls: "
                   << line;
    }
  }
  ScratchFolder folder;
  DecodeRequest request;
  request.file_name = "a.obj";
  FileBytes bytes = EncodeRequest(request);
  const FileBytes head = ToBytes("mtllib /etc/passwd\nusemtl root\n");
  const FileBytes mesh = MakeObj(workshop::MakeBox({0.1, 0.1, 0.1}));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), mesh.begin(), mesh.end());
  std::ofstream(folder / "request", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  ASSERT_EQ(std::system(fmt::format("strace -f -o {} {} < {} > {}",
                                    (folder / "trace").string(),
                                    GRASPDB_DECODE_HELPER,
                                    (folder / "request").string(),
                                    (folder / "answer").string())
                            .c_str()),
            0);
  EXPECT_GT(fs::file_size(folder / "answer"), 500u);  // A mesh, no error.
  std::ifstream trace(folder / "trace");
  bool confined = false;
  bool has_read = false;
  for (std::string line; std::getline(trace, line);) {
    EXPECT_THAT(line, ::testing::Not(HasSubstr("passwd")));
    if (line.find("seccomp(SECCOMP_SET_MODE_FILTER") != line.npos) {
      confined = true;
    }
    if (!confined) continue;
    for (const char* call : {" open", " socket(", " connect(", " execve("}) {
      EXPECT_THAT(line, ::testing::Not(HasSubstr(call)));
    }
    if (line.find(" read(0") != line.npos) has_read = true;
  }
  EXPECT_TRUE(confined && has_read);
}

}  // namespace
}  // namespace graspdb
