"""schema/openapi.yaml is a sound OpenAPI 3.1 document and keeps our rules."""

import json
import re

import jsonschema
import pytest
import yaml

from contract_client import ROOT, SPEC_PATH, load_spec, operations, resolve

SPEC = load_spec()
EXAMPLES = sorted((ROOT / "schema" / "examples").glob("*.json"))


def walk(node, path=""):
    """Yields every (path, node) below."""
    yield path, node
    if isinstance(node, dict):
        for key, value in node.items():
            yield from walk(value, f"{path}/{key}")
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from walk(value, f"{path}/{index}")


def schemas():
    """Yields every schema: the components and those in place."""
    for name, schema in SPEC["components"]["schemas"].items():
        yield name, schema
    for path, node in walk(SPEC["paths"]):
        if path.endswith("/schema"):
            yield path, node
    for path, node in walk(SPEC["components"]):
        if path.endswith("/schema"):
            yield path, node


def test_keys_are_not_repeated():
    class Strict(yaml.SafeLoader):
        pass

    def construct(loader, node, deep=False):
        keys = [loader.construct_object(key, deep) for key, _ in node.value]
        assert len(keys) == len(set(keys)), f"{node.start_mark}: {keys}"
        return yaml.SafeLoader.construct_mapping(loader, node, deep)

    Strict.add_constructor("tag:yaml.org,2002:map", construct)
    with open(SPEC_PATH, encoding="utf-8") as file:
        yaml.load(file, Strict)


def test_has_the_parts_that_openapi_asks_for():
    assert re.fullmatch(r"3\.1\.\d+", SPEC["openapi"])
    assert SPEC["info"]["title"] and SPEC["info"]["version"]
    assert set(SPEC) <= {"openapi", "info", "servers", "tags", "paths",
                         "components", "security", "webhooks", "externalDocs"}


def test_every_reference_resolves():
    for path, node in walk(SPEC):
        if isinstance(node, dict) and isinstance(node.get("$ref"), str):
            assert node["$ref"].startswith("#/components/"), path
            assert resolve(SPEC, node) is not None, path


def test_every_component_is_used():
    text = json.dumps(SPEC)
    for kind, entries in SPEC["components"].items():
        for name in entries:
            assert f'"#/components/{kind}/{name}"' in text, f"{kind}/{name}"


def test_operation_ids_are_unique():
    ids = [operation[0] for operation in operations(SPEC)]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("name,schema", list(schemas()))
def test_schema_is_valid_json_schema(name, schema):
    jsonschema.Draft202012Validator.check_schema(schema)
    known = {"x-unit"} | set(
        "$ref type enum const properties required items additionalProperties "
        "anyOf description pattern format minimum maximum exclusiveMinimum "
        "minItems maxItems minLength maxLength default contentMediaType "
        "contentSchema".split())
    for path, node in walk(schema):
        parent = path.rsplit("/", 1)[-1]
        if isinstance(node, dict) and parent not in ("properties", "default"):
            assert set(node) <= known, f"{name}{path}: {set(node) - known}"


def test_every_number_has_a_unit():
    for name, schema in schemas():
        for path, node in walk(schema):
            if isinstance(node, dict) and "type" in node:
                kinds = node["type"]
                kinds = kinds if isinstance(kinds, list) else [kinds]
                numeric = {"number", "integer"} & set(map(str, kinds))
                assert not numeric or "x-unit" in node, f"{name}{path}"


def test_required_fields_are_described():
    for name, schema in schemas():
        for path, node in walk(schema):
            if isinstance(node, dict) and isinstance(node.get("required"), list):
                assert set(node["required"]) <= set(node["properties"]), (
                    f"{name}{path}")


@pytest.mark.parametrize(
    "operation_id,method,path,operation,item",
    [pytest.param(*op, id=op[0]) for op in operations(SPEC)])
def test_operation_is_complete(operation_id, method, path, operation, item):
    assert operation["summary"].endswith(".")
    tags = {tag["name"] for tag in SPEC["tags"]}
    assert set(operation["tags"]) <= tags and operation["tags"]
    parameters = [resolve(SPEC, p) for p in item.get("parameters", []) +
                  operation.get("parameters", [])]
    for parameter in parameters:
        assert parameter["in"] in ("path", "query", "header")
        assert "schema" in parameter
    in_path = {p["name"] for p in parameters if p["in"] == "path"}
    assert in_path == set(re.findall(r"{(\w+)}", path))
    assert all(p["required"] for p in parameters if p["in"] == "path")
    statuses = set(operation["responses"])
    successes = {s for s in statuses if s.startswith("2")}
    assert successes
    assert "400" in statuses  # A query that is not UTF-8, a page of another site.
    # More than can be served; that it lives is told all the same.
    assert ("503" in statuses) == (operation_id != "getHealth")
    if in_path:
        assert "404" in statuses
    if "requestBody" in operation:
        assert {"408", "413", "415"} <= statuses
    for status, response in operation["responses"].items():
        response = resolve(SPEC, response)
        assert response["description"]
        if not status.startswith("2"):
            assert list(response["content"]) == ["application/problem+json"]
    if "202" in statuses:
        assert any(p["name"] == "Prefer" for p in parameters)
    # What creates or computes may be retried under a key.
    if method == "post":
        assert any(p["name"] == "Idempotency-Key" for p in parameters)


def test_every_documented_example_fits_its_schema():
    resolver = jsonschema.RefResolver("", SPEC)
    for path, node in walk(SPEC):
        if not (isinstance(node, dict) and "example" in node and
                "schema" in node):
            continue
        jsonschema.Draft202012Validator(node["schema"], resolver=resolver
                                        ).validate(node["example"])


def test_there_are_examples():
    assert EXAMPLES


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.name)
def test_example_file_fits_the_schema_of_its_name(path):
    """examples/Grasp.json and Problem.not_found.json are what they say."""
    schema = path.name.split(".")[0]
    assert schema in SPEC["components"]["schemas"]
    resolver = jsonschema.RefResolver("", SPEC)
    with open(path, encoding="utf-8") as file:
        instance = json.load(file)
    jsonschema.Draft202012Validator(
        {"$ref": f"#/components/schemas/{schema}"}, resolver=resolver
    ).validate(instance)


def test_errors_yaml_says_what_the_problems_of_the_examples_say():
    with open(ROOT / "schema" / "errors.yaml", encoding="utf-8") as file:
        kinds = {kind["code"]: kind for kind in yaml.safe_load(file)}
    for path in EXAMPLES:
        if path.name.startswith("Problem"):
            problem = json.loads(path.read_text(encoding="utf-8"))
            kind = kinds[problem["code"]]
            assert problem["status"] == kind["status"]
            assert problem["title"] == kind["title"]
