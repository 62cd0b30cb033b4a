#!/usr/bin/env python3
"""Holds the JSON Schemas against the files, and against the readers: schema.py PROGRAM SOURCE_FOLDER

The schemas in the sources are what the program prints. Each shipped file names its schema and satisfies it. For every
place of a schema that a shipped file reaches, a copy of the file with a fault there is refused by the validator and by
the program. Exits with 77 where the validator is missing.
"""
import copy
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import yaml
    from jsonschema import Draft7Validator
except ImportError as missing:
    print(f"no {missing.name} here (Debian packages python3-jsonschema and python3-yaml)")
    sys.exit(77)
import json

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
SCHEMAS = {"rules": "schema/rules.json", "scene": "demo/schema/scene.json", "knowledge": "schema/knowledge.json"}
failures = []


def complain(text):
    failures.append(text)
    print(text)


class Yaml12(yaml.SafeLoader):
    """Scalars as YAML 1.2 has them: `yes` is a word and 1e-4 a number."""


Yaml12.yaml_implicit_resolvers = {}
for tag, pattern, first in [
    ("bool", r"true|false", "tf"),
    ("int", r"[-+]?[0-9]+|0x[0-9a-fA-F]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.inf", "-+.0123456789"),
    ("null", r"", [""]),
]:
    Yaml12.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{pattern})$"), list(first))
Yaml12.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value.replace(".inf", "inf")))


def faults(schema, value, path=()):
    """Pairs of a place in the schema and a change of the value that the schema forbids, for everything in the value."""
    if "anyOf" in schema:
        for i, choice in enumerate(schema["anyOf"]):
            if Draft7Validator(choice).is_valid(value):
                yield from faults(choice, value, path + (i,))
        return
    if "enum" in schema:
        yield path + ("word",), "no_such_word"
    kind = schema.get("type")
    if kind in ("number", "integer"):
        yield path + ("kind",), "text"
        if "maximum" in schema:
            yield path + ("high",), schema["maximum"] + 1
        if "minimum" in schema:
            yield path + ("low",), schema["minimum"] - 1
        if "exclusiveMinimum" in schema:
            yield path + ("low",), schema["exclusiveMinimum"]
        if kind == "integer":
            yield path + ("whole",), value + 0.5
    if kind == "boolean":
        yield path + ("flag",), "perhaps"
    if isinstance(value, list):
        if schema.get("minItems"):
            yield path + ("fewer",), value[: schema["minItems"] - 1]
        if "maxItems" in schema and schema.get("minItems") == schema["maxItems"]:
            yield path + ("more",), value + value[:1]
        yield path + ("list",), {"a": 1}
        for i, item in enumerate(value):
            for place, changed in faults(schema["items"], item, path + ("item",)):
                yield place, value[:i] + [changed] + value[i + 1 :]
    if isinstance(value, dict):
        yield path + ("map",), [1]
        if "properties" in schema:
            yield path + ("unknown",), {**value, "no_such_key": 1}
        for key in schema.get("required", []):
            yield path + ("without", key), {k: v for k, v in value.items() if k != key}
        for key, item in value.items():
            below = schema.get("properties", {}).get(key, schema["additionalProperties"])
            for place, changed in faults(below, item, path + (key if "properties" in schema else "name",)):
                yield place, {**value, key: changed}


def refuses(kind, document, folder, number):
    """Whether the program does, with a place in the file."""
    file = folder / f"{kind}{number}.yaml"
    file.write_text(yaml.safe_dump(document, sort_keys=False, width=1000, default_flow_style=True))
    # Without a device nothing is drawn: a scene that is accepted fails later, and without a place.
    command = [program, "lint", file] if kind == "rules" else [program, "run", file, "--frames", "1", "--size", "16x16"]
    if kind == "scene":
        command += ["--out", folder / "out"]
    ran = subprocess.run(command, capture_output=True, text=True, env={"VK_DRIVER_FILES": "none"})
    return ran.returncode != 0 and re.search(re.escape(str(file)) + r":\d+:\d+: ", ran.stderr) is not None


schemas = {}
for kind, name in SCHEMAS.items():
    printed = subprocess.run([program, "schema", kind], capture_output=True, text=True, check=True).stdout
    if (source / name).read_text() != printed:
        complain(f"bring it up to date: gnomon schema {kind} > {name}")
    schemas[kind] = json.loads(printed)
    Draft7Validator.check_schema(schemas[kind])

files = [("rules", source / "rules", file) for file in sorted((source / "rules").glob("*.yaml"))]
files += [("scene", source / "demo/scenes", file) for file in sorted((source / "demo/scenes").rglob("*.yaml"))]
files += [("scene", source / "demo/pictures", file) for file in sorted((source / "demo/pictures").glob("*.yaml"))]
seen = set()
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for kind, root, file in files:
        text = file.read_text()
        # The same path leads to it where the files are installed: beside their folder.
        up = "../" * len(file.relative_to(root).parts)
        if not text.startswith(f"# yaml-language-server: $schema={up}schema/{kind}.json\n"):
            complain(f"{file}: the first line does not name its schema")
        document = yaml.load(text, Yaml12)
        if "base" in document:
            document["base"] = str(file.parent / document["base"])
        validator = Draft7Validator(schemas[kind])
        for error in validator.iter_errors(document):
            complain(f"{file}: {error.json_path}: {error.message}")
        for place, broken in faults(schemas[kind], document):
            if (kind, place) in seen:
                continue
            seen.add((kind, place))
            if validator.is_valid(broken):
                complain(f"{file}: the schema allows a fault at {place}")
            if not refuses(kind, broken, folder, len(seen)):
                complain(f"{file}: the program allows a fault at {place}")

tables = sorted((source / "rules/knowledge").glob("*.csv"))
validator = Draft7Validator(schemas["knowledge"])


def rows(file):
    with open(file) as lines:
        table = csv.DictReader(line for line in lines if not line.startswith("#"))
        for row in table:
            cells = {name: cell for name, cell in row.items() if cell}
            numbers = {n for n, column in schemas["knowledge"]["items"]["properties"].items() if column["type"] == "number"}
            yield {name: float(cell) if name in numbers else cell for name, cell in cells.items()}


for file in tables:
    table = list(rows(file))
    for error in validator.iter_errors(table):
        complain(f"{file}: {error.json_path}: {error.message}")
    for row in ({**table[0], "fixed_ms": -1.0}, {**table[0], "samples": "many"}, {"device": "a"}):
        if validator.is_valid([row]):
            complain(f"{file}: the schema allows {row}")

print(f"{len(files)} files, {len(tables)} tables, {len(seen)} faults, {len(failures)} failures")
sys.exit(1 if failures or len(seen) < 200 else 0)
