"""Writes an OpenAPI YAML file as a C++ source that defines kOpenApiDocument.

usage: embed_openapi.py OPENAPI.yaml VERSION OUTPUT.cc
"""

import json
import sys

import yaml


def main() -> None:
    source, version, output = sys.argv[1:]
    with open(source, encoding="utf-8") as file:
        document = yaml.safe_load(file)
    document["info"]["version"] = version
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    # One raw string literal per piece: compilers limit their length.
    pieces = [text[i:i + 8000] for i in range(0, len(text), 8000)]
    literals = "\n".join(f'    R"openapi({piece})openapi"' for piece in pieces)
    with open(output, "w", encoding="utf-8") as file:
        file.write(
            '#include "server/routes/openapi_document.h"\n\n'
            "namespace graspdb {\n\n"
            f"const std::string_view kOpenApiDocument =\n{literals};\n\n"
            "}  // namespace graspdb\n")


main()
