"""Whatever is asked, the answer is one that the contract declares, never a 500.

Each operation gets requests made at random: parameters as their schemas have
them and not at all like that, ids that exist and that do not, bodies of any JSON
and of any bytes. GRASPDB_EXAMPLES sets how many (default 40)."""

import os
import string

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from contract_client import Contract, load_spec, operations, resolve

SPEC = load_spec()
UNKNOWN = ["01890000-0000-7000-8000-000000000000", "0" * 32, "nobody", "", "..", "%00"]
# What would end the world that the other requests look at gets no real id.
DESTRUCTIVE = {"delete", "patch", "put"}
# Learning takes minutes, and is asked for in test_contract.
SLOW = {"postGraspSpaces", "postExample"}

text = st.text(max_size=40) | st.text(string.printable, max_size=12)
json_value = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | text,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(text, inner, max_size=4),
    max_leaves=12)


@pytest.fixture(scope="module")
def known(contract, world):
    """An id, or name, for each place in a path that can be filled."""
    grasp = contract.call("queryGrasps", 200, query={"limit": 1})["items"][0]
    parts = contract.call("listParts", 200, path={"id": world["example"]["id"]})["items"]
    jobs = contract.call("listJobs", 200)["items"]
    return [world["example"]["id"], world["space"]["id"], grasp["id"], parts[0]["id"],
            jobs[0]["id"] if jobs else UNKNOWN[0], "mug", "barrett-bh8-280", "palm.obj", "glb"]


def value_of(schema):
    """What a parameter's schema allows, as text."""
    schema = resolve(SPEC, schema)
    for key in ("anyOf", "oneOf"):
        if key in schema:
            return st.one_of([value_of(option) for option in schema[key]])
    if "enum" in schema:
        return st.sampled_from([str(word) for word in schema["enum"]])
    kind = schema.get("type")
    if kind == "integer":
        return st.integers(schema.get("minimum", 0), schema.get("maximum", 2**31)).map(str)
    if kind == "number":
        return st.floats(schema.get("minimum", -1e3), schema.get("maximum", 1e3)).map(str)
    if kind == "boolean":
        return st.sampled_from(["true", "false"])
    return text


def object_of(schema, depth=0):
    """JSON that is roughly what a schema describes."""
    schema = resolve(SPEC, schema)
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    kind = schema.get("type")
    if depth > 3 or kind is None:
        return json_value
    if kind == "object" and "properties" in schema:
        fields = {name: object_of(field, depth + 1) | json_value
                  for name, field in schema["properties"].items()}
        return st.fixed_dictionaries({}, optional=fields)
    if kind == "array":
        return st.lists(object_of(schema.get("items", {}), depth + 1), max_size=3)
    if kind == "integer":
        return st.integers(schema.get("minimum", -5), schema.get("maximum", 50))
    if kind == "string":
        return text
    return json_value


@st.composite
def requests_to(draw, operation, item, method, ids):
    path, query = {}, {}
    parameters = [resolve(SPEC, p) for p in
                  item.get("parameters", []) + operation.get("parameters", [])]
    for parameter in parameters:
        name = parameter["name"]
        if parameter["in"] == "path":
            real = [] if method in DESTRUCTIVE else ids
            path[name] = draw(st.sampled_from(real + UNKNOWN) | text)
        elif parameter["in"] == "query" and draw(st.booleans()):
            query[name] = draw(value_of(parameter["schema"]) | text)
    if draw(st.integers(0, 9)) == 0:
        query[draw(text)] = draw(text)
    headers = {"Prefer": "respond-async"}
    body = None
    content = resolve(SPEC, operation.get("requestBody", {})).get("content", {})
    if content:
        media = draw(st.sampled_from(sorted(content)))
        schema = content[media].get("schema", {})
        if "json" in media:
            body = draw(object_of(schema) | json_value | st.binary(max_size=60))
        else:
            body = draw(st.binary(max_size=200)
                        | st.sampled_from([b"v 0 0 0\n", b"solid x\n", b"ply\n", b"glTF"]))
        if draw(st.integers(0, 9)) > 0:
            headers["Content-Type"] = media
    return path, query, headers, body


@pytest.mark.parametrize("operation_id", [op[0] for op in operations(SPEC) if op[0] not in SLOW])
def test_any_request_gets_an_answer_of_the_contract(contract: Contract, known, operation_id):
    method, _, operation, item = contract.by_id[operation_id]
    declared = {int(status) for status in operation["responses"]} - {500}

    @settings(max_examples=int(os.environ.get("GRASPDB_EXAMPLES", "40")), deadline=None,
              derandomize=True, database=None, suppress_health_check=list(HealthCheck))
    @given(requests_to(operation, item, method, known))
    def check(request):
        path, query, headers, body = request
        # A path with an empty or dotted name is another path.
        if any(name in ("", ".", "..") for name in path.values()):
            return
        answer = contract.call(operation_id, declared, path=path, query=query,
                               headers=headers, body=body)
        if contract.last.status_code == 202:
            contract.call("cancelJob", 200, path={"id": answer["id"]})

    check()
