#include "server/cli/subcommands.h"

#include "server/cli/progress.h"
#include "server/cli/report.h"

namespace graspdb {

void AddVerify(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "verify", "Push on stored grasps in a simulator and keep the verdicts.",
      "graspdb verify --category mug --stage assembly", Source::kFile);
  commands.AddEngineOptions(command);
  const auto order = Share<VerifyOrder>();
  const auto stage = Share<std::string>();
  GraspQuery& query = order->query;
  command->add_option("--category", query.category, "category");
  command->add_option("--part", query.part_labels, "part labels");
  command->add_option("--hand", query.hand, "hand");
  command->add_option("--object", query.object_id, "object's id");
  command->add_option("--transfer", query.transfer_id, "transfer's id");
  command->add_option("--stage", *stage, "learned, transfer, assembly");
  command
      ->add_option("--limit", order->limit, "most grasps, best first; 0: all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--again", order->again, "those with a verdict, too");
  command->callback([&commands, order, stage] {
    commands.action = [order, stage](Program& program) -> Result<int> {
      if (!stage->empty()) {
        GRASPDB_TRY(parsed, ParseGraspStage(*stage));
        order->query.stage = parsed;
      }
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kMustExist));
      Progress progress(program.options().json);
      ExecutionContext context(
          [&progress](const std::string& what, double share) {
            progress.Report(what, share);
          });
      GRASPDB_TRY(verified, service->VerifyGrasps(*order, context));
      return program.Print(VerificationToJson(verified), ReportVerification);
    };
  });
}

}  // namespace graspdb
