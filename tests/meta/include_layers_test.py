"""Holds every #include against engine/LAYERS and server/LAYERS."""

import pathlib
import tempfile
import unittest

from source_tree import ROOT, find_files, find_includes


def read_layers(path):
    """{module: set of modules that it may include}, in the file's order."""
    layers = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            name, allowed = line.split(":")
            layers[name.strip()] = set(allowed.split())
    return layers


def find_engine_module(path):
    """engine/math/x.h -> math, engine/parameters.h -> parameters."""
    return path.parts[1] if len(path.parts) > 2 else path.stem


def find_server_module(path):
    """server/http/x.h -> http, server/main.cc -> main; other files directly in
    server/ are the values that its modules share."""
    if len(path.parts) > 2:
        return path.parts[1]
    return "main" if path.stem == "main" else "values"


def is_allowed(layers, includer, included):
    """Whether the file may include the other; both are paths below the root."""
    top, other_top = includer.parts[0], included.parts[0]
    if top == "engine":
        if other_top != "engine":
            return False
        module = find_engine_module(includer)
        other = find_engine_module(included)
        return module == other or other in layers["engine"].get(module, ())
    if top == "server":
        module = find_server_module(includer)
        allowed = layers["server"].get(module, set())
        if other_top == "engine":
            return ("engine" in allowed or
                    "engine/" + find_engine_module(included) in allowed)
        other = find_server_module(included)
        return other_top == "server" and (module == other or other in allowed)
    return top != "clients"  # tests may include everything, clients nothing


def find_violations(root):
    layers = {top: read_layers(root / top / "LAYERS")
              for top in ("engine", "server")}
    violations = []
    for path in find_files(root, ("engine", "server", "clients"),
                           {".h", ".cc"}):
        for bracket, name in find_includes(root / path):
            included = pathlib.PurePosixPath(name)
            if bracket == '"' and included.parts[0] in ("engine", "server"):
                if not is_allowed(layers, path, included):
                    violations.append(f"{path} must not include {name}")
    return violations


def find_cycle(layers):
    """A module that reaches itself, or None."""
    def reaches(start, module, seen):
        for other in layers.get(module, ()):
            if other == start:
                return True
            if other not in seen:
                seen.add(other)
                if reaches(start, other, seen):
                    return True
        return False
    return next((m for m in layers if reaches(m, m, set())), None)


class IncludeLayersTest(unittest.TestCase):
    def test_every_include_goes_downwards(self):
        self.assertEqual(find_violations(ROOT), [])

    def test_layers_have_no_cycle(self):
        for top in ("engine", "server"):
            self.assertIsNone(find_cycle(read_layers(ROOT / top / "LAYERS")))

    def test_every_module_is_named_in_layers(self):
        for top, find in (("engine", find_engine_module),
                          ("server", find_server_module)):
            layers = read_layers(ROOT / top / "LAYERS")
            for path in find_files(ROOT, (top,), {".h", ".cc"}):
                self.assertIn(find(path), layers, path)


class CheckerTest(unittest.TestCase):
    """The checker itself, on a planted tree."""

    def find_violations(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for top in ("engine", "server", "clients"):
                (root / top).mkdir()
            (root / "engine/LAYERS").write_text(
                "base:\nmath: base\nparameters: base\n")
            (root / "server/LAYERS").write_text(
                "values: engine\nhttp: engine/base\nstore: values\nmain: http\n")
            for name, included in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(f'#include <vector>\n#include "{included}"\n')
            return find_violations(root)

    def test_accepts_what_layers_allow(self):
        self.assertEqual(self.find_violations({
            "engine/math/a.h": "engine/base/b.h",
            "engine/math/b.h": "engine/math/a.h",
            "engine/parameters/parameters.h": "engine/base/b.h",
            "server/ids.h": "engine/math/a.h",
            "server/http/a.cc": "engine/base/b.h",
            "server/store/a.cc": "server/ids.h",
            "server/main.cc": "server/http/a.h",
        }), [])

    def test_finds_each_planted_violation(self):
        for name, included in {
            "engine/base/a.h": "engine/math/b.h",
            "engine/math/a.h": "server/ids.h",
            "engine/unknown/a.h": "engine/base/b.h",
            "server/http/a.h": "server/store/b.h",
            "server/http/b.h": "engine/math/b.h",
            "server/store/a.cc": "server/main.h",
            "clients/cpp/a.h": "engine/base/b.h",
        }.items():
            self.assertEqual(len(self.find_violations({name: included})), 1,
                             name)

    def test_finds_a_cycle(self):
        self.assertIsNone(find_cycle({"a": set(), "b": {"a"}}))
        self.assertIsNotNone(find_cycle({"a": {"b"}, "b": {"a"}}))


if __name__ == "__main__":
    unittest.main()
