#include "server/ui/web_viewer.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string ReadSource(std::string_view path) {
  std::ostringstream text;
  text << std::ifstream(
              GRASPDB_SOURCE_DIR "/clients/web/dist" + std::string(path),
              std::ios::binary)
              .rdbuf();
  return text.str();
}

TEST(WebViewer, IsByteForByteWhatWasBuilt) {
  EXPECT_GE(WebViewerFiles().size(), 3u);
  for (const ViewerFile& file : WebViewerFiles()) {
    // Not EXPECT_EQ, which would print a bundle.
    EXPECT_TRUE(file.bytes ==
                ReadSource(file.path == "/" ? "/index.html" : file.path))
        << file.path;
  }
}

TEST(WebViewer, LoadsOnlyWhatIsServed) {
  const std::string page = FindViewerFile("/").value().body;
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<style")));
  for (size_t at = 0; (at = page.find("assets/", at)) != std::string::npos;
       ++at) {
    const std::string path = page.substr(at, page.find('"', at) - at);
    EXPECT_TRUE(FindViewerFile("/" + path)) << path;
  }
}

TEST(WebViewer, ThePageIsAskedForAgainAndItsFilesAreKept) {
  for (const ViewerFile& file : WebViewerFiles()) {
    const HttpResponse response = FindViewerFile(file.path).value();
    EXPECT_EQ(
        response.headers[0].second,
        file.path == "/" ? "no-cache" : "public, max-age=31536000, immutable");
    EXPECT_EQ(response.headers[1].first, "Content-Security-Policy");
    EXPECT_THAT(response.headers[1].second, Not(HasSubstr("unsafe")));
  }
}

TEST(WebViewer, HasNothingElse) {
  EXPECT_FALSE(FindViewerFile("/assets/none.js"));
  EXPECT_FALSE(FindViewerFile("/index.html"));
  EXPECT_FALSE(FindViewerFile(""));
}

}  // namespace
}  // namespace graspdb
