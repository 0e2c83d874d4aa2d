"""Third-party libraries appear only in the files that wrap them."""

import fnmatch
import pathlib
import re
import tempfile
import unittest

from source_tree import ROOT, find_files, find_includes

# Header pattern: (files that may include it, how many of them at most).
CONTAINMENT = {
    "CGAL/*": (["engine/*.cc"], 7),
    "CLI/*": (["server/cli/*", "server/decode/decode_main.cc"], None),
    "assimp/*": (["engine/admission/mesh_reader.cc"], 1),
    "embree3/*": (["engine/*.cc"], 4),
    "fcl/*": (["engine/geometry/collision*.cc"], None),
    "fmt/*": (["engine/*.cc", "server/*.cc"], None),
    "httplib.h": (["server/http/*", "server/*/*client.cc"], None),
    "libqhull_r/*": (["engine/reference/*.cc"], 1),
    "libsvm/*": (["engine/cspace/svm.cc"], 1),
    "svm.h": (["engine/cspace/svm.cc"], 1),
    "mujoco/*": (["engine/simulation/grasp_simulator.cc"], 1),
    "nanoflann.hpp": (["engine/math/kd_tree.cc"], 1),
    "nlohmann/*": (["server/codec/*", "server/http/*"], None),
    "openssl/*": (["server/ids.cc", "server/store/*.cc", "server/codec/*.cc"],
                  None),
    "png.h": (["engine/render/png_encoder.cc"], 1),
    "seccomp.h": (["server/decode/*.cc"], None),
    "spdlog/*": (["server/*.cc"], None),
    "sqlite3.h": (["server/store/*"], None),
    "tbb/*": (["engine/*.cc", "server/*.cc"], None),
    "toml++/*": (["server/cli/*.cc", "server/config.cc"], None),
    "console_bridge/*": (["engine/hand/urdf_reader.cc"], 1),
    "urdf_*": (["engine/hand/urdf_reader.cc"], 1),
    # Not libraries, but not everywhere either: the engine is pure.
    "linux/*": (["server/*.cc"], None),
    "sys/*": (["server/*"], None),
}
POSIX = {"arpa/inet.h", "fcntl.h", "malloc.h", "netdb.h", "netinet/in.h", "netinet/tcp.h",
         "poll.h", "pthread.h", "sched.h", "signal.h", "spawn.h", "termios.h",
         "time.h", "unistd.h"}


def is_standard(name):
    return re.fullmatch(r"[a-z_0-9]+", name) is not None


def matches(path, patterns):
    return any(fnmatch.fnmatch(str(path), pattern) for pattern in patterns)


def find_violations(root):
    violations = []
    users = {pattern: set() for pattern in CONTAINMENT}
    for path in find_files(root, ("engine", "server"), {".h", ".cc"}):
        for bracket, name in find_includes(root / path):
            if bracket == '"' or is_standard(name) or name.startswith("Eigen/"):
                continue
            if name in POSIX:
                if path.parts[0] == "engine":
                    violations.append(f"{path}: no {name} in the engine")
                continue
            pattern = next((p for p in CONTAINMENT
                            if fnmatch.fnmatch(name, p)), None)
            if pattern is None:
                violations.append(f"{path}: {name} is not in the table")
            elif not matches(path, CONTAINMENT[pattern][0]):
                violations.append(f"{path} must not include {name}")
            else:
                users[pattern].add(path)
    for pattern, (_, limit) in CONTAINMENT.items():
        if limit is not None and len(users[pattern]) > limit:
            violations.append(f"more than {limit} files include {pattern}: "
                              f"{sorted(map(str, users[pattern]))}")
    return violations


class ThirdPartyContainmentTest(unittest.TestCase):
    def test_libraries_stay_in_their_wrappers(self):
        self.assertEqual(find_violations(ROOT), [])


class CheckerTest(unittest.TestCase):
    """The checker itself, on a planted tree."""

    def find_violations(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, included in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(f"#include <{included}>\n")
            return find_violations(root)

    def test_accepts_standard_headers_and_wrappers(self):
        self.assertEqual(self.find_violations({
            "engine/a.h": "vector",
            "engine/b.h": "Eigen/Core",
            "engine/admission/mesh_reader.cc": "assimp/Importer.hpp",
            "server/store/database.cc": "sqlite3.h",
            "server/http/http_server.cc": "poll.h",
        }), [])

    def test_finds_each_planted_violation(self):
        for name, included in {
            "engine/hand/a.cc": "sqlite3.h",
            "engine/geometry/collision_shape.h": "fcl/fcl.h",
            "engine/geometry/solid.h": "CGAL/Surface_mesh.h",
            "engine/base/a.cc": "unistd.h",
            "server/store/a.cc": "httplib.h",
            "server/jobs/a.cc": "somebody/library.h",
        }.items():
            self.assertEqual(len(self.find_violations({name: included})), 1,
                             name)

    def test_counts_the_files_that_use_cgal(self):
        files = {f"engine/geometry/{i}.cc": "CGAL/a.h" for i in range(8)}
        self.assertEqual(len(self.find_violations(files)), 1)


if __name__ == "__main__":
    unittest.main()
