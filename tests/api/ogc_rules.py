# SPDX-License-Identifier: GPL-3.0-or-later
"""What OGC API - Processes 1.0 demands of documents: its schemas in our words, with a validator for as much of JSON
Schema as they need; of OpenAPI 3.0 and of HTML what can be told without a library."""
import html.parser
import re

TEXT, WHOLE, OBJECT = {"type": "string"}, {"type": "integer"}, {"type": "object"}
MOMENT = {"type": "string", "format": "date-time"}


def ref(name):
    return {"$ref": name}


def many(schema):
    return {"type": "array", "items": schema}


def words(*list_of_words):
    return {"type": "string", "enum": list(list_of_words)}


def record(required=(), /, **properties):
    return {"type": "object", "required": list(required), "properties": properties}


DESCRIPTION = {"title": TEXT, "description": TEXT, "keywords": many(TEXT), "metadata": many(OBJECT)}
SUMMARY = {**DESCRIPTION, "id": TEXT, "version": TEXT, "links": many(ref("link")),
           "jobControlOptions": many(words("sync-execute", "async-execute", "dismiss")),
           "outputTransmission": many(words("value", "reference"))}
FORMAT = {"mediaType": TEXT, "encoding": TEXT, "schema": {"anyOf": [TEXT, OBJECT]}}
BOUND, NUMBER, FLAG, SUB = {"type": "integer", "minimum": 0}, {"type": "number"}, {"type": "boolean"}, ref("schema")

SCHEMAS = {
    "link": record(["href"], href=TEXT, rel=TEXT, type=TEXT, hreflang=TEXT, title=TEXT),
    "landingPage": record(["links"], title=TEXT, description=TEXT, links=many(ref("link"))),
    "confClasses": record(["conformsTo"], conformsTo=many(TEXT)),
    "exception": record(["type"], type=TEXT, title=TEXT, status=WHOLE, detail=TEXT, instance=TEXT),
    "processList": record(["processes", "links"], processes=many(ref("processSummary")), links=many(ref("link"))),
    "processSummary": record(["id", "version"], **SUMMARY),
    "process": record(["id", "version"], **SUMMARY,
                      inputs={"type": "object", "additionalProperties": ref("inputDescription")},
                      outputs={"type": "object", "additionalProperties": ref("outputDescription")}),
    "inputDescription": record(["schema"], **DESCRIPTION, schema=SUB, minOccurs=WHOLE,
                               maxOccurs={"anyOf": [WHOLE, words("unbounded")]}),
    "outputDescription": record(["schema"], **DESCRIPTION, schema=SUB),
    # The schema of schemas is closed: a word that is not here is an error.
    "schema": {**record(
        [], title=TEXT, multipleOf=NUMBER, maximum=NUMBER, exclusiveMaximum=FLAG, minimum=NUMBER, exclusiveMinimum=FLAG,
        maxLength=BOUND, minLength=BOUND, pattern=TEXT, maxItems=BOUND, minItems=BOUND, uniqueItems=FLAG,
        maxProperties=BOUND, minProperties=BOUND, required={**many(TEXT), "minItems": 1},
        enum={"type": "array", "minItems": 1}, type=words("array", "boolean", "integer", "number", "object", "string"),
        allOf=many(SUB), oneOf=many(SUB), anyOf=many(SUB), items=SUB,
        properties={"type": "object", "additionalProperties": SUB}, additionalProperties={"anyOf": [SUB, FLAG]},
        description=TEXT, format=TEXT, default={}, nullable=FLAG, readOnly=FLAG, writeOnly=FLAG, example={},
        deprecated=FLAG, contentMediaType=TEXT, contentEncoding=TEXT, contentSchema=TEXT),
        "additionalProperties": False},
    "bbox": record(["bbox"], bbox={"type": "array", "items": NUMBER, "minItems": 4, "maxItems": 6}, crs=TEXT),
    "qualifiedValue": record(["value"], value={}, **FORMAT),
    # The standard says oneOf, which no number and no base64 text can fulfil.
    "inlineOrRefData": {"anyOf": [TEXT, NUMBER, FLAG, {"type": "array"}, ref("bbox"), ref("qualifiedValue"),
                                  ref("link")]},
    "results": {"type": "object", "additionalProperties": ref("inlineOrRefData")},
    "execute": record(
        inputs={"type": "object", "additionalProperties": {"anyOf": [ref("inlineOrRefData"),
                                                                     many(ref("inlineOrRefData"))]}},
        outputs={"type": "object", "additionalProperties": record(
            format=record(**FORMAT), transmissionMode=words("value", "reference"))},
        response=words("raw", "document"),
        subscriber=record(["successUri"], successUri=TEXT, inProgressUri=TEXT, failedUri=TEXT)),
    "statusInfo": record(
        ["jobID", "status", "type"], processID=TEXT, type=words("process"), jobID=TEXT, message=TEXT, created=MOMENT,
        status=words("accepted", "running", "successful", "failed", "dismissed"), started=MOMENT, finished=MOMENT,
        updated=MOMENT, progress={"type": "integer", "minimum": 0, "maximum": 100}, links=many(ref("link"))),
    "jobList": record(["jobs", "links"], jobs=many(ref("statusInfo")), links=many(ref("link"))),
}
TYPES = {"string": str, "object": dict, "array": list, "boolean": bool, "integer": int, "number": (int, float)}


def faults(value, schema, place="", known=None):
    """What is wrong with a value, as a list of texts."""
    known = SCHEMAS if known is None else known
    if "$ref" in schema:
        return faults(value, known[schema["$ref"].rsplit("/", 1)[-1]], place, known)
    kind = schema.get("type")
    if kind and (not isinstance(value, TYPES[kind]) or (isinstance(value, bool) and kind in ("integer", "number"))):
        return [f"{place or 'it'} is no {kind}: {str(value)[:60]}"]
    found = []
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{place} is {value!r}, none of {schema['enum']}")
    if "minimum" in schema and value < schema["minimum"] or "maximum" in schema and value > schema["maximum"]:
        found.append(f"{place} is {value}, out of range")
    if schema.get("format") == "date-time" and not re.fullmatch(
            r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|[+-]\d\d:\d\d)", value):
        found.append(f"{place} is no date-time: {value}")
    for word in "anyOf", "oneOf":
        if word in schema and all(faults(value, one, place, known) for one in schema[word]):
            found.append(f"{place} fits none of {word}")
    for one in schema.get("allOf", []):
        found += faults(value, one, place, known)
    if isinstance(value, dict):
        found += object_faults(value, schema, place, known)
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            found.append(f"{place} has {len(value)} elements")
        for i, element in enumerate(value):
            found += faults(element, schema.get("items", {}), f"{place}[{i}]", known)
    return found


def object_faults(value, schema, place, known):
    found = [f"{place} has no {name}" for name in schema.get("required", []) if name not in value]
    properties, further = schema.get("properties", {}), schema.get("additionalProperties", True)
    for name, inner in value.items():
        if name in properties:
            found += faults(inner, properties[name], f"{place}.{name}", known)
        elif further is False:
            found.append(f"{place} has {name}, which is not allowed")
        elif isinstance(further, dict):
            found += faults(inner, further, f"{place}.{name}", known)
    return found


# --- OpenAPI 3.0 ------------------------------------------------------------------------------------------------------

METHODS = ("get", "put", "post", "delete", "options", "head", "patch", "trace")
SCHEMA_WORDS = set(SCHEMAS["schema"]["properties"]) - {"contentMediaType", "contentEncoding", "contentSchema"} | {
    "$ref", "not", "discriminator", "xml", "externalDocs"}


def schemas_in(value, name=""):
    """Every schema of an OpenAPI document."""
    if isinstance(value, list):
        for element in value:
            yield from schemas_in(element)
    elif isinstance(value, dict):
        for key, inner in value.items():
            if key == "schema":
                yield from subschemas(inner)
            elif key == "schemas" and name == "components":
                for one in inner.values():
                    yield from subschemas(one)
            elif key != "example":
                yield from schemas_in(inner, key)


def subschemas(schema):
    yield schema
    for word in "allOf", "anyOf", "oneOf":
        for one in schema.get(word, []):
            yield from subschemas(one)
    for one in schema.get("properties", {}).values():
        yield from subschemas(one)
    for word in "items", "additionalProperties":
        if isinstance(schema.get(word), dict):
            yield from subschemas(schema[word])


def resolve(document, value):
    while isinstance(value, dict) and "$ref" in value:
        target = document
        for step in value["$ref"].removeprefix("#/").split("/"):
            target = target[step]
        value = target
    return value


def operations(document):
    for path, item in document["paths"].items():
        for method in METHODS:
            if method in item:
                shared = item.get("parameters", [])
                yield path, method, {**item[method], "parameters": shared + item[method].get("parameters", [])}


def openapi_30_faults(document):
    found = [f"no {name}" for name in ("openapi", "info", "paths") if name not in document]
    if not re.fullmatch(r"3\.0\.\d", document.get("openapi", "")):
        found.append("not 3.0")
    found += [f"info has no {name}" for name in ("title", "version") if name not in document["info"]]
    ids = []
    for path, method, operation in operations(document):
        where = f"{method} {path}"
        ids.append(operation.get("operationId"))
        if not path.startswith("/") or not operation.get("responses"):
            found.append(f"{where}: no slash or no responses")
        for status, response in operation["responses"].items():
            if not re.fullmatch(r"[1-5](\d\d|XX)|default", status) or "description" not in resolve(document, response):
                found.append(f"{where}: response {status}")
        parameters = [resolve(document, p) for p in operation["parameters"]]
        keys = [(p["in"], p["name"]) for p in parameters]
        if len(keys) != len(set(keys)) or not all("schema" in p for p in parameters):
            found.append(f"{where}: parameters")
        if {name for place, name in keys if place == "path"} != set(re.findall(r"{(\w+)}", path)):
            found.append(f"{where}: path parameters")
        if method == "get" and "requestBody" in operation:
            found.append(f"{where}: a body")
    if len(ids) != len(set(ids)) or None in ids:
        found.append("operationIds are missing or not unique")
    for schema in schemas_in(document):
        strange = {word for word in schema if word not in SCHEMA_WORDS and not word.startswith("x-")}
        if strange or ("$ref" in schema and len(schema) > 1):
            found.append(f"words of no schema of 3.0: {strange or schema}")
        if "$ref" in schema:
            resolve(document, schema)
    return found


# --- HTML -------------------------------------------------------------------------------------------------------------

VOID = {"meta", "br", "hr", "img", "input", "link"}


class Page(html.parser.HTMLParser):
    """A document's text and links, and whether its tags close."""

    def __init__(self, text):
        super().__init__()
        self.open, self.seen, self.links, self.texts, self.faults, self.doctype = [], [], [], [], [], ""
        self.feed(text)
        self.close()
        if self.open:
            self.faults.append(f"left open: {self.open}")
        if self.doctype.lower() != "doctype html" or not {"html", "head", "title", "body"} <= set(self.seen):
            self.faults.append("no HTML5 document")
        if "script" in self.seen:
            self.faults.append("a script")

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())

    def handle_decl(self, decl):
        self.doctype = decl

    def handle_starttag(self, tag, attrs):
        self.seen.append(tag)
        if tag == "a" and "body" in self.open:
            self.links.append(dict(attrs)["href"])
        if any(name.startswith("on") for name, _ in attrs):
            self.faults.append("a script in an attribute")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        if "body" in self.open:
            self.texts.append(data)


def leaves(value):
    """The texts and numbers in a JSON value, those of links apart."""
    if isinstance(value, dict):
        for name, inner in value.items():
            if name != "links":
                yield from leaves(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from leaves(inner)
    elif isinstance(value, str):
        yield " ".join(value.split())
    elif isinstance(value, int) and not isinstance(value, bool):
        yield str(value)
