"""A client that holds every answer against schema/openapi.yaml."""

import copy
import json
import os
import pathlib
import re
from urllib.parse import quote

import jsonschema
import requests
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPEC_PATH = ROOT / "schema" / "openapi.yaml"
METHODS = ("get", "post", "put", "patch", "delete")
# How many times slower than a release build the server is, e.g. under a sanitizer.
SLOWER = float(os.environ.get("GRASPDB_SLOWER", "1"))
LONGEST_WAIT = 600  # Seconds that a client may ask to wait for a job.


def patient(seconds):
    """A time limit of the tests, for the server that is tested."""
    return SLOWER * seconds


def wait_longer(prefer):
    """Prefer: wait=N, for the server that is tested."""
    return re.sub(r"(?<=wait=)\d+",
                  lambda n: str(min(LONGEST_WAIT, round(patient(int(n[0]))))), prefer)


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
        method, template, operation, item = self.by_id[operation_id]
        statuses = {expect} if isinstance(expect, int) else set(expect)
        if template.startswith("/v1/") and all(200 <= status < 300 for status in statuses):
            self.check_request(operation, item, query, body)
        url = template
        for name, value in (path or {}).items():
            url = url.replace("{" + name + "}", quote(str(value), safe=""))
        headers = dict(headers or {})
        if "Prefer" in headers:
            headers["Prefer"] = wait_longer(headers["Prefer"])
        if body is not None and not isinstance(body, (bytes, str)):
            body = json.dumps(body)
            headers.setdefault("Content-Type", "application/json")
        if isinstance(body, str):
            body = body.encode()
        answer = self.session.request(
            method, self.base_url + url, params=query, headers=headers,
            data=body, files=files, timeout=patient(timeout))
        self.last = answer
        assert answer.status_code in statuses, (
            f"{operation_id}: {answer.status_code} {answer.text[:2000]}")
        self.seen.setdefault(operation_id, set()).add(answer.status_code)
        return self.check(operation_id, operation, answer)

    def check_request(self, operation, item, query, body):
        """A request that is to succeed is one that the operation declares."""
        parameters = [resolve(self.spec, parameter) for parameter in
                      item.get("parameters", []) + operation.get("parameters", [])]
        declared = {one["name"] for one in parameters if one["in"] == "query"}
        assert set(query or {}) <= declared
        content = resolve(self.spec, operation.get("requestBody", {})).get("content", {})
        if body is None or "application/json" not in content:
            return
        is_text = isinstance(body, (bytes, str))
        self.validate(json.loads(body) if is_text else body,
                      content["application/json"]["schema"])

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
