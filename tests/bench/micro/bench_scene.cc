#include "tests/bench/micro/bench_scene.h"

#include "tests/support/workshop.h"

namespace graspdb::bench {

const Scene& GetScene() {
  static const Scene scene = MakeSpeedScene(workshop::LoadBarrettHand(),
                                            workshop::LoadMug("latte").mesh_O);
  return scene;
}

}  // namespace graspdb::bench
