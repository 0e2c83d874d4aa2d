#include "server/cli/subcommands.h"

#include "server/cli/report.h"

namespace graspdb {

void AddQuery(Subcommands& commands) {
  CLI::App* command =
      commands.Add("query", "List stored grasps.",
                   "graspdb query --category mug --part handle --limit 5",
                   Source::kFileOrServer);
  struct Given {
    GraspSearch search;
    std::string stage;
    std::string sort{"epsilon"};
  };
  const auto given = Share<Given>();
  GraspQuery& query = given->search.query;
  query.page.limit = 20;
  command->add_option("--category", query.category, "category");
  command->add_option("--part", query.part_labels, "part labels");
  command->add_option("--task", given->search.task, "parts that serve it");
  command->add_option("--hand", query.hand, "hand");
  command->add_option("--object", query.object_id, "object's id");
  command->add_option("--min-epsilon", query.min_epsilon, "least eps");
  command->add_option("--stage", given->stage, "learned, transfer, assembly");
  command
      ->add_option("--sort", given->sort,
                   "epsilon, merit, hybrid, robust, newest")
      ->check(
          CLI::IsMember({"epsilon", "merit", "hybrid", "robust", "newest"}));
  command->add_option("--limit", query.page.limit, "1 to 1000")
      ->capture_default_str();
  command->add_option("--cursor", query.page.cursor, "of the page before");
  command->callback([&commands, given] {
    commands.action = [given](Program& program) -> Result<int> {
      using Sort = GraspQuery::Sort;
      GraspQuery& wanted = given->search.query;
      wanted.sort = given->sort == "hybrid"   ? Sort::kHybrid
                    : given->sort == "robust" ? Sort::kRobust
                    : given->sort == "merit"  ? Sort::kMerit
                    : given->sort == "newest" ? Sort::kNewest
                                              : Sort::kEpsilon;
      if (!given->stage.empty()) {
        GRASPDB_TRY(stage, ParseGraspStage(given->stage));
        wanted.stage = stage;
      }
      GRASPDB_TRY(backend, program.OpenBackend());
      GRASPDB_TRY(list, backend->Query(given->search));
      return program.Print(list, ReportGrasps);
    };
  });
}

}  // namespace graspdb
