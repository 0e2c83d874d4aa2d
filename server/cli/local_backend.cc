#include <algorithm>

#include <fmt/format.h>

#include "engine/render/grasp_scene.h"
#include "engine/render/png_encoder.h"
#include "engine/render/scene_renderer.h"
#include "server/cli/backend.h"
#include "server/codec/record_json.h"

namespace graspdb {
namespace {

std::string Encode(const Image& image) {
  const std::vector<uint8_t> png = EncodePng(image);
  return {png.begin(), png.end()};
}

PosedHand PoseHand(const StoredGrasp& grasp, const HandModel& hand) {
  PosedHand posed{&hand, grasp.grasp.configuration, grasp.grasp.approach_O, {}};
  for (const Contact& contact : grasp.grasp.contacts) {
    posed.contacts_O.push_back(contact.p_O);
  }
  return posed;
}

class LocalBackend : public Backend {
 public:
  explicit LocalBackend(Service& service) : service_(service) {}

  Result<std::string> Grasp(const TransferOrder& order,
                            std::optional<double> deadline,
                            Progress& progress) override {
    ExecutionContext context(Follow(progress));
    if (deadline) {
      using Seconds = std::chrono::duration<double>;
      using Clock = ExecutionContext::Clock;
      context.set_deadline(
          Clock::now() +
          std::chrono::duration_cast<Clock::duration>(Seconds(*deadline)));
    }
    GRASPDB_TRY(answer, service_.TransferGrasps(order, context));
    return ToJson(answer);
  }

  Result<std::string> Query(const GraspSearch& search) override {
    GRASPDB_TRY(page, service_.QueryGrasps(search));
    std::vector<std::string> items;
    for (const StoredGrasp& grasp : page.items) {
      GRASPDB_TRY(hand, service_.FindHandModel(grasp.hand));
      items.push_back(ToJson(grasp, *hand));
    }
    return ListToJson(items, page.next_cursor);
  }

  Result<std::string> Segment(const ImportOrder& order,
                              Progress& progress) override {
    ExecutionContext context(Follow(progress));
    GRASPDB_TRY(imported, service_.ImportObject(order, context));
    return ToJson(imported.object, imported.parts);
  }

  Result<std::string> Learn(const LearnOrder& order,
                            Progress& progress) override {
    ExecutionContext context(Follow(progress));
    GRASPDB_TRY(spaces, service_.LearnObject(order, context));
    std::vector<std::string> items;
    for (const StoredGraspSpace& space : spaces) items.push_back(ToJson(space));
    return ListToJson(items, "");
  }

  Result<std::string> Render(const RenderOrder& order) override {
    if (!order.grasp_id.empty()) return RenderGrasp(order);
    if (!order.transfer_id.empty()) return RenderTransfer(order);
    return RenderObject(order);
  }

 private:
  static ExecutionContext::ProgressCallback Follow(Progress& progress) {
    return [&progress](const std::string& stage, double share) {
      progress.Report(stage, share);
    };
  }

  static View MakeView(const RenderOrder& order) {
    View view;
    view.width = order.width;
    view.height = order.height;
    return view;
  }

  Result<std::string> RenderObject(const RenderOrder& order) {
    GRASPDB_TRY(meshes, service_.store().ReadObjectMeshes(order.object_id));
    return Encode(RenderScene(
        MakeGraspScene(meshes.canonical, meshes.canonical_labels, {}),
        MakeView(order)));
  }

  Result<std::string> RenderGrasp(const RenderOrder& order) {
    GRASPDB_TRY(grasp, service_.store().FindGrasp(order.grasp_id));
    GRASPDB_TRY(hand, service_.FindHandModel(grasp.hand));
    GRASPDB_TRY(meshes, service_.store().ReadObjectMeshes(grasp.object_id));
    const PosedHand posed = PoseHand(grasp, *hand);
    const View view = TurnTowards(meshes.canonical, posed, MakeView(order));
    return Encode(RenderScene(
        MakeGraspScene(meshes.canonical, meshes.canonical_labels, {posed}),
        view));
  }

  Result<std::string> RenderTransfer(const RenderOrder& order) {
    GRASPDB_TRY(answer,
                service_.DescribeTransfer(order.transfer_id, order.count));
    if (answer.grasps.empty()) {
      return Error{ErrorCode::kNotFound, "The transfer has no grasps to draw.",
                   "graspdb render --object " + answer.object.id};
    }
    GRASPDB_TRY(meshes, service_.store().ReadObjectMeshes(answer.object.id));
    std::vector<SheetCell> cells;
    for (const StoredGrasp& grasp : answer.grasps) {
      cells.push_back({&meshes.canonical, meshes.canonical_labels,
                       PoseHand(grasp, *answer.hand),
                       fmt::format("{} eps {:.3f}", grasp.part_label,
                                   grasp.grasp.quality.epsilon)});
    }
    const int columns = std::min<int>(4, static_cast<int>(cells.size()));
    return Encode(RenderContactSheet(cells, columns, MakeView(order)));
  }

  Service& service_;
};

}  // namespace

std::unique_ptr<Backend> MakeLocalBackend(Service& service) {
  return std::make_unique<LocalBackend>(service);
}

}  // namespace graspdb
