"""The OpenAPI document says what is true: names and ranges of the catalogue, examples that work, and for any request a
response that it describes.
"""

import os
from collections import Counter
from contextlib import suppress

import pytest
import schemathesis
from http_server import PATIENCE_S, Server
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import Unsatisfiable
from schemathesis import checks
from schemathesis.specs.openapi import checks as openapi_checks

from service.catalogue import load_catalogue
from service.presets import preset_names

CASES = int(os.environ.get("SAMPLERSCOPE_TEST_CASES", "8"))
"""Generated requests for each operation; `make bench` asks for many more."""

CHECKS = (
    checks.not_a_server_error,
    openapi_checks.status_code_conformance,
    openapi_checks.content_type_conformance,
    openapi_checks.response_headers_conformance,
    openapi_checks.response_schema_conformance,
)


@pytest.fixture(scope="module")
def small_server(tmp_path_factory, _own_cache):
    """A server whose limits keep what is generated small."""
    running = Server(
        tmp_path_factory.mktemp("server"), max_samples=10**7, max_cells=64, direct_limit_s=0.5, jobs_limit=10**6
    )
    yield running
    running.stop()


@pytest.fixture(scope="module")
def document(small_server):
    return small_server.client.get("/openapi.json").json()


def test_models_techniques_and_formats_are_enums_and_parameters_have_ranges_and_meanings(document):
    catalogue = load_catalogue()
    found = {one["name"]: one for one in document["paths"]["/v1/statistics"]["get"]["parameters"]}
    assert set(found["model"]["schema"]["enum"]) == {*catalogue.models, "all"}
    assert set(found["preset"]["schema"]["enum"]) == set(preset_names())
    assert set(found["techniques"]["schema"]["items"]["enum"]) == set(catalogue.techniques)
    assert found["format"]["schema"]["enum"][0] == "json"
    for entry in (*catalogue.models.values(), *catalogue.techniques.values()):
        for name, parameter in entry.head.parameters.items():
            assert found[name]["schema"]["items"]["minimum"] <= parameter.min
            assert found[name]["schema"]["items"]["maximum"] >= parameter.max
            assert found[name]["description"]
    roughness = catalogue.models["eon"].head.parameters["roughness"]
    assert roughness.help in found["roughness"]["description"]
    scene = document["components"]["schemas"]["Scene"]
    assert set(scene["properties"]["model"]["enum"]) == {*catalogue.models, "all"}
    assert "roughness" in scene["properties"]["parameters"]["properties"]


def test_every_example_of_the_document_works(start_server, document):
    """All examples of an operation together are one request. On a server of its limits an answer may become a job."""
    server = start_server(own_glsl=True)
    asked = Counter()
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            given = {(one["in"], one["name"]): one for one in operation.get("parameters", [])}
            examples = {place: found for place, one in given.items() if (found := example_of(one)) is not None}
            content = operation.get("requestBody", {}).get("content", {}).get("application/json")
            if any(where == "path" and (where, name) not in examples for where, name in given):
                continue
            address = path.format(**{name: value for (where, name), value in examples.items() if where == "path"})
            query = {name: value for (where, name), value in examples.items() if where == "query"}
            more = {} if content is None else {"json": content["example"]}
            reply = server.client.request(method, address, params=query, **more)
            assert reply.status_code in (200, 202), (method, address, reply.text)
            asked[method] += 1
            if reply.status_code == 202:
                server.client.delete(reply.headers["location"])
    assert asked["get"] >= 13
    assert asked["post"] >= 9


def example_of(parameter):
    example = parameter.get("example", next(iter(parameter["schema"].get("examples", [])), None))
    return ",".join(map(str, example)) if isinstance(example, list) else example


def test_every_response_to_generated_requests_is_one_the_document_describes(small_server):
    schema = schemathesis.openapi.from_url(f"{small_server.url}/openapi.json")
    operations = [result.ok() for result in schema.get_all_operations()]
    sent = Counter()
    for operation in operations:
        for mode in schemathesis.GenerationMode:

            @given(operation.as_strategy(generation_mode=mode))
            @settings(
                max_examples=CASES,
                deadline=None,
                derandomize=True,
                database=None,
                phases=[Phase.generate],
                suppress_health_check=list(HealthCheck),
            )
            def conforms(case):
                sent[case.operation.label] += 1
                case.call_and_validate(base_url=small_server.url, checks=CHECKS, timeout=PATIENCE_S)

            # An operation without parameters has no wrong request.
            with suppress(Unsatisfiable):
                conforms()
    assert len(sent) == len(operations) >= 14
    assert sent["POST /v1/statistics"] >= 2 * CASES
    print(f"{sent.total()} requests conform")
