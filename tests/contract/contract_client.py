"""A client that holds every answer against schema/openapi.yaml."""

import copy
import json
import pathlib
from urllib.parse import quote

import jsonschema
import requests
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPEC_PATH = ROOT / "schema" / "openapi.yaml"
METHODS = ("get", "post", "put", "patch", "delete")


def load_spec():
    with open(SPEC_PATH, encoding="utf-8") as file:
        return yaml.safe_load(file)


def operations(spec):
    """Yields (operationId, method, path, operation, path item)."""
    for path, item in spec["paths"].items():
        for method in METHODS:
            if method in item:
                operation = item[method]
                yield operation["operationId"], method, path, operation, item


def resolve(spec, node):
    """Follows $ref until there is none."""
    while isinstance(node, dict) and "$ref" in node:
        target = spec
        for key in node["$ref"].removeprefix("#/").split("/"):
            target = target[key.replace("~1", "/").replace("~0", "~")]
        node = target
    return node


def close_objects(node):
    """Refuses fields that no schema names, so that none stays undocumented."""
    if isinstance(node, dict):
        if "properties" in node and "additionalProperties" not in node:
            node["additionalProperties"] = False
        for value in node.values():
            close_objects(value)
    elif isinstance(node, list):
        for value in node:
            close_objects(value)


class Contract:
    """Calls operations by their id and checks what comes back."""

    def __init__(self, base_url):
        self.base_url = base_url
        self.spec = load_spec()
        self.by_id = {op[0]: op[1:] for op in operations(self.spec)}
        self.seen = {}  # operationId -> statuses
        self.session = requests.Session()
        closed = copy.deepcopy(self.spec)
        close_objects(closed["components"]["schemas"])
        self.resolver = jsonschema.RefResolver("", closed)

    def validate(self, instance, schema):
        jsonschema.Draft202012Validator(
            schema, resolver=self.resolver,
            format_checker=jsonschema.Draft202012Validator.FORMAT_CHECKER
        ).validate(instance)

    def call(self, operation_id, expect, path=None, query=None, headers=None,
             body=None, files=None, timeout=180):
        """Calls one operation and checks the answer.

        expect: the status, or several. body: bytes, text, or what becomes JSON.
        Returns the parsed JSON, else the bytes; .last has the whole answer.
        """
        method, template, operation, _ = self.by_id[operation_id]
        url = template
        for name, value in (path or {}).items():
            url = url.replace("{" + name + "}", quote(str(value), safe=""))
        headers = dict(headers or {})
        if body is not None and not isinstance(body, (bytes, str)):
            body = json.dumps(body)
            headers.setdefault("Content-Type", "application/json")
        if isinstance(body, str):
            body = body.encode()
        answer = self.session.request(
            method, self.base_url + url, params=query, headers=headers,
            data=body, files=files, timeout=timeout)
        self.last = answer
        statuses = {expect} if isinstance(expect, int) else set(expect)
        assert answer.status_code in statuses, (
            f"{operation_id}: {answer.status_code} {answer.text[:2000]}")
        self.seen.setdefault(operation_id, set()).add(answer.status_code)
        return self.check(operation_id, operation, answer)

    def check(self, operation_id, operation, answer):
        """The answer is one that the operation declares."""
        declared = operation["responses"]
        assert str(answer.status_code) in declared, (
            f"{operation_id} does not declare {answer.status_code}: "
            f"{answer.text[:500]}")
        assert answer.headers["X-Request-Id"]
        assert "total;dur=" in answer.headers["Server-Timing"]
        response = resolve(self.spec, declared[str(answer.status_code)])
        for name in response.get("headers", {}):
            if name in ("Location", "Content-Disposition"):
                assert name in answer.headers, f"{operation_id}: no {name}"
        content = response.get("content", {})
        if not content:
            assert answer.content == b"", operation_id
            return None
        media = answer.headers["Content-Type"].split(";")[0].strip()
        assert media in content, f"{operation_id}: undeclared {media}"
        if not media.endswith("json"):
            return answer.content
        instance = answer.json()
        self.validate(instance, content[media]["schema"])
        if media == "application/problem+json":
            assert instance["status"] == answer.status_code
        return instance
