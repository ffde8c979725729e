"""shared/http/openapi.yaml, and whether a response is as it says."""
import json
import os
import re
import sys

import jsonschema
import yaml

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PATH = os.path.join(ROOT, "shared", "http", "openapi.yaml")
METHODS = ("get", "head", "query", "options", "post", "put", "patch", "delete", "trace")
# What HTTP itself brings to each response.
FRAMING = {"date", "connection", "content-length"}


def load():
    """The document without references."""
    with open(PATH, encoding="utf-8") as file:
        document = yaml.safe_load(file)

    def resolve(node):
        if isinstance(node, dict):
            if "$ref" in node:
                if set(node) != {"$ref"} or not node["$ref"].startswith("#/"):
                    raise ValueError(f"reference {node}")
                target = document
                for part in node["$ref"][2:].split("/"):
                    target = target[part]
                return resolve(target)
            return {str(key): resolve(value) for key, value in node.items()}
        return [resolve(value) for value in node] if isinstance(node, list) else node

    return resolve(document)


def operations(document):
    """(path, METHOD, operation) of each."""
    for path, item in document["paths"].items():
        for method in METHODS:
            if method in item:
                yield path, method.upper(), item[method]


def contradictions(document):
    """What is wrong in the document itself."""
    found = []
    if not re.fullmatch(r"3\.2\.\d+", document["openapi"]):
        found.append(f"openapi: {document['openapi']}")
    seen = set()
    for path, method, operation in operations(document):
        where = f"{method} {path}"
        if operation["operationId"] in seen:
            found.append(f"{where}: operationId {operation['operationId']} is there twice")
        seen.add(operation["operationId"])
        item = document["paths"][path]
        declared = {p["name"] for p in item.get("parameters", []) if p["in"] == "path"}
        if declared != set(re.findall(r"\{(\w+)\}", path)):
            found.append(f"{where}: path parameters {declared}")
        for parameter in item.get("parameters", []) + operation.get("parameters", []):
            jsonschema.Draft202012Validator.check_schema(parameter["schema"])
        for status, response in operation["responses"].items():
            if not response.get("description"):
                found.append(f"{where} {status}: no description")
            for header in response["headers"].values():
                jsonschema.Draft202012Validator.check_schema(header["schema"])
            for content in response.get("content", {}).values():
                jsonschema.Draft202012Validator.check_schema(content.get("schema", {}))
    return found


def violations(response, documented, has_content):
    """Where a response differs from what is documented for its status. `has_content`: not by HEAD."""
    found = []
    headers = {name.lower(): header for name, header in documented["headers"].items()}
    for name, header in headers.items():
        if name not in response.headers:
            if header.get("required"):
                found.append(f"no {name}")
            continue
        found += complaints(response.headers[name], header["schema"], name)
    known = set(headers) | FRAMING | ({"content-type"} if "content" in documented else set())
    found += [f"{name} is not documented" for name in response.headers if name not in known]
    if response.status != 204 and "content-length" not in response.headers:
        found.append("no content-length")
    if "content" not in documented:
        return found + (["there is content"] if response.body else [])
    media_type = response.headers.get("content-type")
    if media_type not in documented["content"]:
        return found + [f"content-type {media_type}"]
    if not has_content:
        return found + (["there is content"] if response.body else [])
    return found + content_violations(response, media_type, documented["content"][media_type])


def content_violations(response, media_type, documented):
    if not response.body:
        return ["no content"]
    if not response.body.startswith(documented.get("x-begins-with", "").encode()):
        return [f"content begins with {response.body[:4]}"]
    if media_type.startswith("text/"):
        return complaints(response.body.decode(), documented["schema"], "content")
    if not media_type.endswith("json"):
        return []
    content = json.loads(response.body)
    found = complaints(content, documented["schema"], "content")
    if media_type == "application/problem+json" and content.get("status") != response.status:
        found.append(f"problem of status {content.get('status')}")
    return found


def complaints(value, schema, where):
    return [f"{where}: {error.message}"
            for error in jsonschema.Draft202012Validator(schema).iter_errors(value)]


if __name__ == "__main__":
    print("\n".join(contradictions(load())) or "no contradictions")
    sys.exit(1 if contradictions(load()) else 0)
