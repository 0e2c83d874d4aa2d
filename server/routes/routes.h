#pragma once

#include <chrono>
#include <memory>

#include "server/http/request_metrics.h"
#include "server/http/router.h"
#include "server/jobs/service.h"
#include "server/routes/grasp_texts.h"
#include "server/routes/job_metrics.h"
#include "server/routes/work_slots.h"

/** @file
 The operations of schema/openapi.yaml, one .cc per noun: decode the request,
 call the service, encode the answer. The service must outlive the router. */

namespace graspdb {

struct RouteOptions {
  /** How long a request waits for its job unless the client says, where most
   jobs are short. */
  std::chrono::seconds default_wait{60};
  /** For event streams and requests that wait for their jobs: each holds one of
   the server's threads, and some must be left. */
  std::shared_ptr<WorkSlots> held_threads{std::make_shared<WorkSlots>(32, 0)};
  /** What GET /metrics tells of requests; may be null. */
  std::shared_ptr<RequestMetrics> metrics;
  /** … and of jobs; may be null. */
  std::shared_ptr<JobMetrics> jobs;
  std::shared_ptr<GraspTexts> grasp_texts{std::make_shared<GraspTexts>()};
  /** Drawing takes all cores: one picture after the other. */
  std::shared_ptr<WorkSlots> picture_slots{std::make_shared<WorkSlots>(1, 16)};
  /** For meshes that are decoded and segmented while someone waits. */
  std::shared_ptr<WorkSlots> work_slots{std::make_shared<WorkSlots>(2, 32)};
};

void AddBackupRoutes(Router& router, Service& service);
void AddCategoryRoutes(Router& router, Service& service,
                       const RouteOptions& options);
void AddGraspRoutes(Router& router, Service& service,
                    const RouteOptions& options);
void AddGraspSpaceRoutes(Router& router, Service& service);
void AddHandRoutes(Router& router, Service& service,
                   const RouteOptions& options);
void AddJobRoutes(Router& router, Service& service,
                  const RouteOptions& options);
void AddMetricsRoutes(Router& router, Service& service,
                      const RouteOptions& options);
void AddObjectRoutes(Router& router, Service& service,
                     const RouteOptions& options);
void AddPartRoutes(Router& router, Service& service);
void AddSystemRoutes(Router& router, Service& service);
void AddTransferRoutes(Router& router, Service& service);
void AddVerificationRoutes(Router& router, Service& service,
                           const RouteOptions& options);
void AddViewerRoutes(Router& router);

/** All of them. */
Router MakeRouter(Service& service, const RouteOptions& options);

}  // namespace graspdb
