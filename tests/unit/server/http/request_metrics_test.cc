#include "server/http/request_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(RequestMetrics, CountsByMethodRouteAndStatus) {
  RequestMetrics metrics;
  for (const int status : {200, 200, 404}) {
    metrics.Begin();
    metrics.End({"GET", "/v1/objects/{id}", status, 0.004});
  }
  const std::string text = metrics.Write();
  EXPECT_THAT(text,
              HasSubstr("graspdb_http_requests_total{method=\"GET\","
                        "route=\"/v1/objects/{id}\",status=\"200\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("status=\"404\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("graspdb_http_requests_in_flight 0\n"));
}

// 2 ms and 3 s: buckets count all that is as short as they are.
TEST(RequestMetrics, ItsHistogramIsCumulative) {
  RequestMetrics metrics;
  metrics.Begin();
  metrics.End({"POST", "/v1/grasps", 200, 0.002});
  metrics.Begin();
  metrics.End({"POST", "/v1/grasps", 200, 3.0});
  metrics.Begin();
  const std::string text = metrics.Write();
  const std::string name = "graspdb_http_request_duration_seconds";
  const std::string labels = "method=\"POST\",route=\"/v1/grasps\"";
  const auto bucket = [&](const std::string& end, int count) {
    return name + "_bucket{" + labels + ",le=\"" + end + "\"} " +
           std::to_string(count) + "\n";
  };
  EXPECT_THAT(text, HasSubstr(bucket("0.001", 0)));
  EXPECT_THAT(text, HasSubstr(bucket("0.0025", 1)));
  EXPECT_THAT(text, HasSubstr(bucket("2.5", 1)));
  EXPECT_THAT(text, HasSubstr(bucket("5", 2)));
  EXPECT_THAT(text, HasSubstr(bucket("+Inf", 2)));
  EXPECT_THAT(text, HasSubstr(name + "_sum{" + labels + "} 3.002\n"));
  EXPECT_THAT(text, HasSubstr("graspdb_http_requests_in_flight 1\n"));
}

TEST(RequestMetrics, AClientCannotMakeItCountWithoutEnd) {
  RequestMetrics metrics;
  for (const char* method : {"BREW", "X\"} 1\n", ""}) {
    metrics.Begin();
    metrics.End({method, "", 404, 0.001});
  }
  const std::string text = metrics.Write();
  EXPECT_THAT(text, HasSubstr("{method=\"other\",route=\"other\","
                              "status=\"404\"} 3\n"));
  EXPECT_THAT(text, Not(HasSubstr("BREW")));
}

}  // namespace
}  // namespace graspdb
