#include "server/cli/subcommands.h"

#include <fmt/format.h>

#include "server/files.h"

namespace graspdb {

void AddRender(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "render", "Draw an object by parts, or grasps on it, as a PNG file.",
      "graspdb render --transfer 5f2c… --count 12 -o grasps.png",
      Source::kFileOrServer);
  const auto order = Share<RenderOrder>();
  const auto out = std::make_shared<std::string>("grasps.png");
  CLI::Option_group* what = command->add_option_group("what");
  what->add_option("--grasp", order->grasp_id, "one grasp");
  what->add_option("--transfer", order->transfer_id, "a sheet of its best");
  what->add_option("--object", order->object_id, "an object's parts");
  what->require_option(1);
  command->add_option("--count", order->count, "most grasps on a sheet")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--width", order->width, "pixels, of a cell on a sheet")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command->add_option("--height", order->height, "likewise")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command->add_option("-o,--output", *out, "PNG file; - writes to stdout")
      ->capture_default_str();
  command->callback([&commands, order, out] {
    commands.action = [order, out](Program& program) -> Result<int> {
      GRASPDB_TRY(backend, program.OpenBackend());
      GRASPDB_TRY(png, backend->Render(*order));
      GRASPDB_TRY_VOID(WriteFileBytes(*out, png));
      if (*out != "-") fmt::print("{}\n", *out);
      return kSuccess;
    };
  });
}

}  // namespace graspdb
