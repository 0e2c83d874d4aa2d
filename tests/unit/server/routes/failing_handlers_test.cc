#include <functional>
#include <mutex>
#include <new>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "server/decode/decode_client.h"
#include "server/http/http_server.h"
#include "server/routes/routes.h"
#include "tests/support/raw_client.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr char kSecret[] = "/srv/secret.db";

struct Failure {
  const char* name;
  std::function<Result<HttpResponse>()> fail;
  const char* status;
  const char* log;  ///< What the log tells of it.
};

class FailingHandlers : public testing::TestWithParam<Failure> {};

// Every operation of the real router reads its request and then fails.
TEST_P(FailingHandlers, TellTheClientNothingAndTheLogAll) {
  const TempFolder folder;
  auto store = Store::Open(folder.File("a.db"));
  ASSERT_TRUE(store) << store.error().message;
  Service service(std::move(*store), std::make_unique<Decoder>(), {});
  const Router real = MakeRouter(service, {});
  Router failing;
  for (const Route& route : real.routes()) {
    failing.Add(
        {route.method, route.pattern, route.body,
         [fail = GetParam().fail](const HttpRequest&) { return fail(); }});
  }
  std::mutex mutex;
  std::string log;
  HttpServerOptions options;
  options.threads = 2;
  options.log = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    log += line + "\n";
  };
  HttpServer server(std::move(failing), options);
  const auto port = server.Bind("127.0.0.1", 0);
  ASSERT_TRUE(port);
  std::thread serving([&] { EXPECT_TRUE(server.Serve()); });
  for (const Route& route : real.routes()) {
    std::string request =
        route.method + " " +
        std::regex_replace(route.pattern, std::regex("\\{[a-z]+\\}"), "a") +
        " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n";
    if (route.body == BodyKind::kJson) {
      request += "Content-Type: application/json\r\n";
    }
    request +=
        route.body == BodyKind::kNone ? "\r\n" : "Content-Length: 2\r\n\r\n{}";
    RawClient client(*port);
    client.Send(request);
    const std::string answer = client.ReadAll();
    EXPECT_THAT(answer, StartsWith(GetParam().status)) << request;
    EXPECT_THAT(answer, HasSubstr("application/problem+json")) << request;
    EXPECT_THAT(answer, Not(HasSubstr("secret"))) << request;
    EXPECT_THAT(answer, Not(HasSubstr("exception"))) << request;
    EXPECT_THAT(answer, Not(HasSubstr("std::"))) << request;
  }
  server.Stop();
  serving.join();
  size_t told = 0;
  const std::string cause = GetParam().log;
  for (size_t at = log.find(cause); at != std::string::npos;
       at = log.find(cause, at + 1)) {
    ++told;
  }
  EXPECT_EQ(told, real.routes().size());
}

INSTANTIATE_TEST_SUITE_P(
    By, FailingHandlers,
    testing::Values(Failure{"Exception",
                            []() -> Result<HttpResponse> {
                              throw std::runtime_error(kSecret);
                            },
                            "HTTP/1.1 500 ", "cause=/srv/secret.db"},
                    Failure{"WantOfMemory",
                            []() -> Result<HttpResponse> {
                              throw std::bad_alloc();
                            },
                            "HTTP/1.1 500 ", "cause=std::bad_alloc"},
                    Failure{"SomethingElseThrown",
                            []() -> Result<HttpResponse> { throw 7; },
                            "HTTP/1.1 500 ", "cause=\"unknown exception\""},
                    Failure{"ABug",
                            []() -> Result<HttpResponse> {
                              return Error{ErrorCode::kInternal, kSecret, ""};
                            },
                            "HTTP/1.1 500 ", "cause=/srv/secret.db"},
                    Failure{"TheDisk",
                            []() -> Result<HttpResponse> {
                              return Error{ErrorCode::kStorage, kSecret, ""};
                            },
                            "HTTP/1.1 507 ", "cause=/srv/secret.db"}),
    [](const auto& failure) { return failure.param.name; });

}  // namespace
}  // namespace graspdb
