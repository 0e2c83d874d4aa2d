#include "server/http/http_server.h"

#include <atomic>
#include <latch>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/raw_client.h"

namespace graspdb {
namespace {

// What the body of /endless is made of.
constexpr char kOnAndOn[] = "on and on and ";
// More than sockets hold.
constexpr int kLarge = 20'000'000;

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

HttpResponse Text(const std::string& text) {
  HttpResponse response;
  response.content_type = "text/plain";
  response.body = text;
  return response;
}

/** A server with a few routes, on a free port. */
class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() {
    HttpServerOptions options;
    options.threads = 8;
    options.limits.max_json_bytes = 100;
    options.limits.max_upload_bytes = 1000;
    options.limits.idle_timeout = std::chrono::seconds(2);
    options.limits.head_timeout = std::chrono::seconds(1);
    options.limits.body_timeout = std::chrono::seconds(1);
    options.limits.write_timeout = std::chrono::seconds(2);
    options.limits.least_bytes_per_second = 1 << 20;
    options.metrics = metrics_;
    options.log = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      log_ += line + "\n";
    };
    server_ = std::make_unique<HttpServer>(MakeRouter(), std::move(options));
    const auto port = server_->Bind("127.0.0.1", 0);
    port_ = port ? *port : 0;
    thread_ = std::thread([this] { EXPECT_TRUE(server_->Serve()); });
  }
  ~HttpServerTest() override { Stop(); }

  void Stop() {
    server_->Stop();
    if (thread_.joinable()) thread_.join();
  }

  Router MakeRouter() {
    Router router;
    router.Add({"GET", "/hello/{name}", BodyKind::kNone,
                [](const HttpRequest& request) {
                  return Text("hello " + request.path_parameters.at("name"));
                }});
    router.Add({"POST", "/json", BodyKind::kJson,
                [](const HttpRequest& request) { return Text(request.body); }});
    router.Add(
        {"POST", "/upload", BodyKind::kUpload, [](const HttpRequest& request) {
           std::string text = request.body;
           for (const auto& file : request.files) {
             text += file.name + "=" + file.filename + ":" + file.content + ";";
           }
           for (const auto& [key, value] : request.query) {
             text += key + "=" + value + ";";
           }
           return Text(text);
         }});
    router.Add({"GET", "/throw", BodyKind::kNone,
                [](const HttpRequest&) -> Result<HttpResponse> {
                  throw std::runtime_error("secret");
                }});
    router.Add({"GET", "/pieces", BodyKind::kNone, [](const HttpRequest&) {
                  HttpResponse response = Text("");
                  response.next_piece =
                      [left = 3]() mutable -> std::optional<std::string> {
                    if (left == 0) return std::nullopt;
                    return "piece " + std::to_string(left--) + "\n";
                  };
                  return response;
                }});
    router.Add({"GET", "/endless", BodyKind::kNone,
                [gone = &gone_](const HttpRequest&) {
                  HttpResponse response = Text("");
                  response.next_piece =
                      [place = std::shared_ptr<void>(
                           nullptr, [gone](void*) { *gone = true; })] {
                        std::string piece;
                        while (piece.size() < 100'000) piece += kOnAndOn;
                        return std::optional(piece);
                      };
                  return response;
                }});
    router.Add({"GET", "/broken", BodyKind::kNone, [](const HttpRequest&) {
                  HttpResponse response = Text("");
                  response.next_piece = []() -> std::optional<std::string> {
                    throw 7;
                  };
                  return response;
                }});
    router.Add({"GET", "/large", BodyKind::kNone, [](const HttpRequest&) {
                  return Text(std::string(kLarge, 'a'));
                }});
    router.Add({"GET", "/alive", BodyKind::kNone,
                [](const HttpRequest&) { return Text("yes"); },
                /* vital = */ true});
    router.Add({"GET", "/fail", BodyKind::kNone,
                [](const HttpRequest&) -> Result<HttpResponse> {
                  return Error{ErrorCode::kConflict, "No.", "Do this."};
                }});
    router.Add(
        {"GET", "/full", BodyKind::kNone,
         [](const HttpRequest&) -> Result<HttpResponse> {
           return Error{ErrorCode::kStorage, "/srv/a.db: full", "Make room."};
         }});
    router.Add({"DELETE", "/thing", BodyKind::kNone, [](const HttpRequest&) {
                  HttpResponse response;
                  response.status = 204;
                  return response;
                }});
    router.Add(
        {"GET", "/wait", BodyKind::kNone, [this](const HttpRequest& request) {
           ++num_waiting_;
           while (!request.stop.stop_requested()) {
             std::this_thread::sleep_for(std::chrono::milliseconds(5));
           }
           return Text("stopped");
         }});
    return router;
  }

  /** Clients that wait until the server stops, a thread for each. */
  std::vector<std::unique_ptr<RawClient>> TakeThreads(int count) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < count; ++i) {
      clients.push_back(std::make_unique<RawClient>(port_));
      clients.back()->Send("GET /wait HTTP/1.1\r\nHost: localhost\r\n\r\n");
    }
    while (num_waiting_ < count) std::this_thread::yield();
    return clients;
  }

  /** One exchange on a connection of its own. */
  std::string Exchange(const std::string& bytes) {
    RawClient client(port_);
    client.Send(bytes);
    return client.ReadAll();
  }
  std::string Get(const std::string& target, const std::string& fields = "") {
    return Exchange("GET " + target +
                    " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                    fields + "\r\n");
  }
  std::string Post(const std::string& target, const std::string& fields,
                   const std::string& body) {
    return Exchange("POST " + target +
                    " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                    fields + "Content-Length: " + std::to_string(body.size()) +
                    "\r\n\r\n" + body);
  }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  int port_{0};
  const std::shared_ptr<RequestMetrics> metrics_ =
      std::make_shared<RequestMetrics>();
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
  std::atomic<bool> gone_{false};  // Whoever read /endless.
  std::atomic<int> num_waiting_{0};
  std::mutex mutex_;
  std::string log_;
};

TEST_F(HttpServerTest, AnswersWithBodyAndHeaders) {
  const std::string answer = Get("/hello/a%20b", "X-Request-Id: my-id\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("X-Request-Id: my-id\r\n"));
  EXPECT_THAT(answer, HasSubstr("Server-Timing: total;dur="));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 9\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\nhello a b"));
}

TEST_F(HttpServerTest, ARequestIdThatCouldForgeALogIsReplaced) {
  EXPECT_THAT(Get("/hello/x", "X-Request-Id: a b\r\n"),
              Not(HasSubstr("X-Request-Id: a b")));
}

TEST_F(HttpServerTest, HeadIsGetWithoutBody) {
  const std::string answer = Exchange(
      "HEAD /hello/x HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(answer, HasSubstr("Content-Length: 7\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(HttpServerTest, ABodyInPiecesIsSentChunkByChunk) {
  RawClient client(port_);
  for (int i = 0; i < 2; ++i) {  // The connection stays.
    client.Send("GET /pieces HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string answer = client.ReadUntil("\r\n0\r\n\r\n");
    EXPECT_THAT(answer, HasSubstr("Transfer-Encoding: chunked\r\n"));
    EXPECT_THAT(answer, EndsWith("\r\n\r\n8\r\npiece 3\n\r\n8\r\npiece 2\n"
                                 "\r\n8\r\npiece 1\n\r\n0\r\n\r\n"));
  }
  EXPECT_THAT(log(), HasSubstr("target=/pieces status=200 in=0 out=24"));
}

TEST_F(HttpServerTest, ABodyInPiecesThatFailsIsCutShort) {
  const std::string answer = Get("/broken");
  EXPECT_THAT(answer, HasSubstr("Transfer-Encoding: chunked\r\n"));
  EXPECT_THAT(answer, Not(EndsWith("0\r\n\r\n")));
  EXPECT_THAT(log(), HasSubstr("event=internal"));
  EXPECT_THAT(Get("/hello/x"), EndsWith("hello x"));
}

TEST_F(HttpServerTest, ABodyInPiecesEndsWithTheConnectionInHttp10) {
  const std::string answer =
      Exchange("GET /pieces HTTP/1.0\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(answer, Not(HasSubstr("chunked")));
  EXPECT_THAT(answer, EndsWith("\r\n\r\npiece 3\npiece 2\npiece 1\n"));
}

TEST_F(HttpServerTest, HeadOfABodyInPiecesHasNone) {
  const std::string answer = Exchange(
      "HEAD /pieces HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
  EXPECT_THAT(answer, Not(HasSubstr("piece")));
}

TEST_F(HttpServerTest, AnEndlessBodyEndsWhenItsReaderGoes) {
  {
    RawClient client(port_);
    client.Send("GET /endless HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_THAT(client.ReadUntil(kOnAndOn), EndsWith(kOnAndOn));
    EXPECT_FALSE(gone_);
  }
  while (!gone_) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_F(HttpServerTest, NoContentHasNoBody) {
  const std::string answer = Exchange(
      "DELETE /thing HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 204 No Content\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(HttpServerTest, KeepsAConnectionForManyRequests) {
  RawClient client(port_);
  for (int i = 0; i < 20; ++i) {
    client.Send("GET /hello/x HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_THAT(client.ReadUntil("hello x"), EndsWith("hello x"));
  }
}

TEST_F(HttpServerTest, AnswersPipelinedRequestsInOrder) {
  const std::string answer = Exchange(
      "GET /hello/1 HTTP/1.1\r\nHost: localhost\r\n\r\n"
      "POST /json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}"
      "GET /hello/2 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const size_t one = answer.find("hello 1");
  const size_t two = answer.find("\r\n\r\n{}");
  const size_t three = answer.find("hello 2");
  EXPECT_LT(one, two);
  EXPECT_LT(two, three);
  EXPECT_NE(three, std::string::npos);
}

TEST_F(HttpServerTest, UnknownPathsAndMethodsAreProblems) {
  EXPECT_THAT(Get("/nothing"), HasSubstr("urn:graspdb:problem:not_found"));
  const std::string answer = Get("/json");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(answer, HasSubstr("Allow: POST\r\n"));
  EXPECT_THAT(answer, HasSubstr("Content-Type: application/problem+json"));
  EXPECT_THAT(Exchange("BREW /json HTTP/1.1\r\nHost: localhost\r\nConnection: "
                       "close\r\n\r\n"),
              StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(Get("/%zz"), StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpServerTest, AnErrorOfAHandlerIsAProblem) {
  const std::string answer = Get("/fail");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 409 Conflict\r\n"));
  EXPECT_THAT(answer, HasSubstr("\"hint\":\"Do this.\""));
}

TEST_F(HttpServerTest, AnExceptionTellsItsTextToTheLogOnly) {
  const std::string answer = Get("/throw", "X-Request-Id: r-7\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 500"));
  EXPECT_THAT(answer, Not(HasSubstr("secret")));
  EXPECT_THAT(answer, HasSubstr("\"request_id\":\"r-7\""));
  Stop();
  EXPECT_THAT(log(), HasSubstr("id=r-7 cause=secret"));
}

TEST_F(HttpServerTest, EveryAnswerIsOneLineInTheLog) {
  Get("/hello/x", "X-Request-Id: r-8\r\n");
  Stop();
  EXPECT_THAT(log(), HasSubstr("event=request id=r-8 method=GET "
                               "target=/hello/x status=200 in=0 out=7 ms="));
}

TEST_F(HttpServerTest, AFailureOfTheDiskTellsItsTextToTheLogOnly) {
  const std::string answer = Get("/full", "X-Request-Id: r-9\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 507"));
  EXPECT_THAT(answer, Not(HasSubstr("/srv")));
  EXPECT_THAT(answer, HasSubstr("\"hint\":\"Make room.\""));
  Stop();
  EXPECT_THAT(log(),
              HasSubstr("event=storage id=r-9 cause=\"/srv/a.db: full\""));
}

TEST_F(HttpServerTest, AClientThatStallsIsCutOffWhenTheServerHasWaitedEnough) {
  // More patience than the test has.
  HttpServerOptions options;
  options.threads = 4;
  options.limits.body_timeout = std::chrono::hours(1);
  options.limits.write_timeout = std::chrono::hours(1);
  HttpServer server(MakeRouter(), std::move(options));
  const int port = server.Bind("127.0.0.1", 0).value();
  std::thread serving([&] { EXPECT_TRUE(server.Serve()); });
  RawClient uploads(port);
  uploads.Send(
      "POST /upload HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
      "9\r\n\r\nab");
  RawClient reads(port);
  reads.Send("GET /endless HTTP/1.1\r\nHost: localhost\r\n\r\n");
  reads.ReadUntil(kOnAndOn);
  server.Stop();
  server.CutConnections();
  serving.join();
  EXPECT_TRUE(gone_);
}

const char kHello[] = "GET /hello/x HTTP/1.1\r\nHost: localhost\r\n\r\n";

TEST_F(HttpServerTest, AKeptConnectionMakesRoomForWhoWaits) {
  const auto others = TakeThreads(7);
  RawClient kept(port_);
  kept.Send(kHello);
  EXPECT_THAT(kept.ReadUntil("hello x"), Not(HasSubstr("Connection: close")));
  RawClient waiting(port_);
  waiting.Send(kHello);
  std::string answer;
  do {
    kept.Send(kHello);
    answer = kept.ReadUntil("hello x");
  } while (!answer.empty() && answer.find("Connection: close") == answer.npos);
  EXPECT_THAT(answer, EndsWith("hello x"));
  EXPECT_THAT(waiting.ReadUntil("hello x"), StartsWith("HTTP/1.1 200 OK\r\n"));
}

TEST_F(HttpServerTest, AnIdleConnectionMakesRoomForWhoWaits) {
  const auto others = TakeThreads(7);
  RawClient idle(port_);
  idle.Send(kHello);
  idle.ReadUntil("hello x");
  RawClient waiting(port_);
  waiting.Send(kHello);
  EXPECT_THAT(waiting.ReadUntil("hello x"), StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_EQ(idle.ReadAll(), "");
}

TEST_F(HttpServerTest, BeyondTheLineOfThoseThatWaitTheNextIsToldToComeLater) {
  const auto others = TakeThreads(8);
  std::vector<std::unique_ptr<RawClient>> line;
  for (int i = 0; i < 4 * 8; ++i) {
    line.push_back(std::make_unique<RawClient>(port_));
    line.back()->Send(kHello);
  }
  const std::string answer = Get("/hello/x");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 503 Service Unavailable\r\n"));
  EXPECT_THAT(answer, HasSubstr("Retry-After: "));
  EXPECT_THAT(answer, HasSubstr("X-Request-Id: "));
  EXPECT_THAT(answer, HasSubstr("Connection: close\r\n"));
  EXPECT_THAT(answer, HasSubstr("More connections wait than can be served"));
  // Also to one that does not ask in time.
  EXPECT_THAT(RawClient(port_).ReadAll(),
              StartsWith("HTTP/1.1 503 Service Unavailable\r\n"));
  // Whether it lives is told all the same.
  EXPECT_THAT(Get("/alive"), StartsWith("HTTP/1.1 200 OK\r\n"));
  // And when there is no time for that either, nothing is, soon.
  std::vector<std::unique_ptr<RawClient>> crowd;
  while (metrics_->Write().find("connections_dropped_total 0\n") !=
         std::string::npos) {
    crowd.push_back(std::make_unique<RawClient>(port_));
    ASSERT_LT(crowd.size(), 1000u);
  }
  EXPECT_GT(crowd.size(), 4 * 8u);
  // Nobody is forgotten in the end.
  Stop();
  for (const auto& client : line) {
    EXPECT_THAT(client->ReadUntil("hello x"), StartsWith("HTTP/1.1 200 OK"));
  }
}

TEST_F(HttpServerTest, AClientThatHasMoreToSayGetsAllOfTheLastAnswer) {
  RawClient client(port_);
  client.Send(
      "GET /large HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n" +
      std::string(kHello));
  const std::string answer = client.ReadAll();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_GT(answer.size(), size_t{kLarge});
}

TEST_F(HttpServerTest, LargeBodiesBeyondWhatMemoryIsForAreA503) {
  // Two of the largest fit; who sends less than 64 KiB does not count.
  HttpServerOptions options;
  options.threads = 4;
  options.limits.max_held_bytes = 0;
  options.limits.max_upload_bytes = 1 << 20;
  options.limits.max_json_bytes = 100;
  std::latch both(2);
  std::latch seen(1);
  Router router;
  router.Add({"POST", "/hold", BodyKind::kUpload, [&](const HttpRequest&) {
                both.count_down();
                seen.wait();
                return Text("held");
              }});
  router.Add({"POST", "/upload", BodyKind::kUpload,
              [](const HttpRequest&) { return Text("fine"); }});
  HttpServer server(std::move(router), std::move(options));
  const int port = server.Bind("127.0.0.1", 0).value();
  std::thread serving([&] { EXPECT_TRUE(server.Serve()); });
  const auto post = [&](const std::string& target, size_t size) {
    RawClient client(port);
    client.Send("POST " + target +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: "
                "close\r\nContent-Length: " +
                std::to_string(size) + "\r\n\r\n" + std::string(size, 'x'));
    return client.ReadAll();
  };
  std::vector<std::thread> holders;
  for (int i = 0; i < 2; ++i) {
    holders.emplace_back([&] {
      EXPECT_THAT(post("/hold", 1 << 20), StartsWith("HTTP/1.1 200"));
    });
  }
  both.wait();
  const std::string refused = post("/upload", 1 << 20);
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(refused, HasSubstr("Retry-After"));
  EXPECT_THAT(post("/upload", 1000), StartsWith("HTTP/1.1 200"));
  seen.count_down();
  for (std::thread& holder : holders) holder.join();
  EXPECT_THAT(post("/upload", 1 << 20), StartsWith("HTTP/1.1 200"));
  server.Stop();
  serving.join();
}

TEST_F(HttpServerTest, ReadsAPlainAndAChunkedBody) {
  EXPECT_THAT(Post("/json", "Content-Type: application/json\r\n", "{\"a\":1}"),
              EndsWith("\r\n\r\n{\"a\":1}"));
  EXPECT_THAT(Exchange("POST /json HTTP/1.1\r\nHost: localhost\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n"
                       "2\r\n{\"\r\n5\r\na\":1}\r\n0\r\n\r\n"),
              EndsWith("\r\n\r\n{\"a\":1}"));
}

TEST_F(HttpServerTest, ReadsAFormWithFileAndFields) {
  const std::string body =
      "--B\r\nContent-Disposition: form-data; name=\"mesh\"; "
      "filename=\"m.stl\"\r\n\r\nbytes\r\n"
      "--B\r\nContent-Disposition: form-data; name=\"category\"\r\n\r\nmug\r\n"
      "--B--\r\n";
  EXPECT_THAT(Post("/upload?seed=3",
                   "Content-Type: multipart/form-data; boundary=B\r\n", body),
              EndsWith("mesh=m.stl:bytes;seed=3;category=mug;"));
  EXPECT_THAT(Post("/upload",
                   "Content-Type: multipart/form-data; boundary=C\r\n", body),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpServerTest, ABodyOverItsLimitIsRefusedUnread) {
  RawClient client(port_);
  client.Send(
      "POST /json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 101\r\n"
      "Expect: 100-continue\r\n\r\n");
  const std::string answer = client.ReadAll();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(answer, HasSubstr("A body has at most 100 bytes here."));
  EXPECT_THAT(answer, HasSubstr("Connection: close\r\n"));
}

TEST_F(HttpServerTest, ExpectContinueIsAnsweredWhenTheBodyIsWanted) {
  RawClient client(port_);
  client.Send(
      "POST /json HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n"
      "Expect: 100-continue\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(client.ReadUntil("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  client.Send("{}");
  EXPECT_THAT(client.ReadAll(), EndsWith("\r\n\r\n{}"));
}

TEST_F(HttpServerTest, AChunkedBodyOverItsLimitIsRefused) {
  std::string body;
  for (int i = 0; i < 30; ++i) body += "5\r\n[[[[[\r\n";
  EXPECT_THAT(Exchange("POST /json HTTP/1.1\r\nHost: localhost\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n" +
                       body + "0\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
}

TEST_F(HttpServerTest, ALineBetweenChunksThatDoesNotEndIsRefusedSoon) {
  const std::string head =
      "POST /upload HTTP/1.1\r\nHost: localhost\r\n"
      "Transfer-Encoding: chunked\r\n\r\n";
  EXPECT_THAT(Exchange(head + "1;" + std::string(5000, 'a')),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Exchange(head + "2\r\nab\r\n" + std::string(5000, '0')),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpServerTest, ManySmallChunksAreNoLongLine) {
  std::string body;
  for (int i = 0; i < 900; ++i) body += "1\r\nx\r\n";
  EXPECT_THAT(Exchange("POST /upload HTTP/1.1\r\nHost: localhost\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n" +
                       body + "0\r\n\r\n"),
              EndsWith(std::string(900, 'x')));
}

TEST_F(HttpServerTest, PagesOfOtherSitesAreRefused) {
  EXPECT_THAT(Exchange("GET /hello/x HTTP/1.1\r\nHost: evil.com\r\n\r\n"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Post("/json", "Origin: http://evil.com\r\n", "{}"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(Post("/json", "Origin: http://localhost\r\n", "{}"),
              StartsWith("HTTP/1.1 200"));
}

TEST_F(HttpServerTest, WhatItSendsIsNoPageUnlessARouteSaysSo) {
  EXPECT_THAT(Get("/hello/x"),
              HasSubstr("Content-Security-Policy: default-src 'none'; "));
}

TEST_F(HttpServerTest, WhoTakesAnAnswerWordByWordIsCutOff) {
  RawClient client(port_);
  client.Send("GET /endless HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (int i = 0; i < 100 && !gone_; ++i) {
    client.ReadUntil(" ");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(gone_);
}

TEST_F(HttpServerTest, ContentCodingsAndOtherTypesAreRefused) {
  EXPECT_THAT(Post("/json", "Content-Encoding: gzip\r\n", "{}"),
              StartsWith("HTTP/1.1 415"));
  EXPECT_THAT(Post("/json", "Content-Type: text/xml\r\n", "{}"),
              StartsWith("HTTP/1.1 415"));
}

TEST_F(HttpServerTest, AnUnreadBodyIsNeverTakenForARequest) {
  const std::string smuggled =
      "GET /hello/2 HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string answer =
      Exchange("POST /nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
               std::to_string(smuggled.size()) + "\r\n\r\n" + smuggled);
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(answer, Not(HasSubstr("hello")));
  const std::string get =
      Exchange("GET /hello/1 HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
               std::to_string(smuggled.size()) + "\r\n\r\n" + smuggled);
  EXPECT_THAT(get, StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get, Not(HasSubstr("hello")));
}

TEST_F(HttpServerTest, RangesAreIgnored) {
  std::string ranges = "Range: bytes=0-0";
  for (int i = 0; i < 700; ++i) ranges += ",0-";
  EXPECT_THAT(Get("/hello/x", ranges + "\r\n"), EndsWith("\r\n\r\nhello x"));
}

TEST_F(HttpServerTest, AnEndlessHeadIsRefused) {
  EXPECT_THAT(Exchange("GET / HTTP/1.1\r\nHost: localhost\r\n" +
                       std::string(40'000, 'a')),
              StartsWith("HTTP/1.1 431"));
  EXPECT_THAT(Exchange("GET /" + std::string(9'000, 'a') +
                       " HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              StartsWith("HTTP/1.1 414"));
}

TEST_F(HttpServerTest, ASlowClientIsToldSo) {
  EXPECT_THAT(Exchange("GET / HTT"), StartsWith("HTTP/1.1 408"));
  EXPECT_THAT(Exchange("POST /json HTTP/1.1\r\nHost: localhost\r\n"
                       "Content-Length: 5\r\n\r\n{"),
              StartsWith("HTTP/1.1 408"));
}

TEST_F(HttpServerTest, AnswersOrDropsEveryMutantOfARequest) {
  const std::string form =
      "--B\r\nContent-Disposition: form-data; name=\"mesh\"; "
      "filename=\"m.stl\"\r\n\r\nbytes\r\n--B--\r\n";
  const std::vector<std::string> seeds = {
      "GET /hello/a%20b?c=d&e HTTP/1.1\r\nHost: localhost\r\nRange: "
      "bytes=0-1\r\n\r\n",
      "POST /upload?seed=3 HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
      "multipart/form-data; boundary=B\r\nContent-Length: " +
          std::to_string(form.size()) + "\r\n\r\n" + form,
      "POST /json HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: "
      "chunked\r\n\r\n"
      "2\r\n{}\r\n0\r\n\r\n"};
  Random random(1);
  for (int i = 0; i < 1500; ++i) {
    std::string mutant = seeds[static_cast<size_t>(i) % seeds.size()];
    for (int edits = random.NextIndex(4); edits >= 0; --edits) {
      const auto at = static_cast<size_t>(
          random.NextIndex(static_cast<int>(mutant.size())));
      const int kind = random.NextIndex(3);
      if (kind == 0) mutant[at] = static_cast<char>(random.NextBits());
      if (kind == 1) mutant.erase(at, 1 + at % 5);
      if (kind == 2) mutant.insert(at, mutant.substr(at / 2, 8));
    }
    RawClient client(port_);
    client.Send(mutant);
    client.EndSending();
    const std::string answer = client.ReadAll();
    EXPECT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 ")) << mutant;
    EXPECT_THAT(answer, Not(HasSubstr("HTTP/1.1 500"))) << mutant;
  }
  EXPECT_THAT(Get("/hello/x"), EndsWith("hello x"));
}

TEST_F(HttpServerTest, StopLetsARequestInFlightEnd) {
  RawClient waiting(port_);
  waiting.Send("GET /wait HTTP/1.1\r\nHost: localhost\r\n\r\n");
  RawClient idle(port_);
  idle.Send("GET /hello/x HTTP/1.1\r\nHost: localhost\r\n\r\n");
  idle.ReadUntil("hello x");
  Stop();
  EXPECT_THAT(waiting.ReadAll(), EndsWith("\r\n\r\nstopped"));
  EXPECT_EQ(idle.ReadAll(), "");
  EXPECT_FALSE(RawClient(port_).connected());
}

TEST_F(HttpServerTest, ASecondServerCannotTakeThePort) {
  HttpServer second(MakeRouter(), HttpServerOptions{});
  const auto bound = second.Bind("127.0.0.1", port_);
  ASSERT_FALSE(bound);
  EXPECT_THAT(bound.error().message, HasSubstr("Address already in use"));
}

TEST(HttpServer, APortThatWasBoundButNeverServedIsFreeAgain) {
  int port = 0;
  for (int round = 0; round < 2; ++round) {
    HttpServer server(Router{}, HttpServerOptions{});
    const auto bound = server.Bind("127.0.0.1", port);
    ASSERT_TRUE(bound) << bound.error().message;
    port = *bound;
  }
}

TEST(HttpServer, StopBeforeServeIsNotLost) {
  HttpServer server(Router(), HttpServerOptions{});
  ASSERT_TRUE(server.Bind("127.0.0.1", 0));
  server.Stop();
  EXPECT_TRUE(server.Serve());
}

TEST(HttpServer, AnUnknownHostCannotBeListenedOn) {
  HttpServer server(Router(), HttpServerOptions{});
  EXPECT_FALSE(server.Bind("256.1.1.1", 0));
}

}  // namespace
}  // namespace graspdb
