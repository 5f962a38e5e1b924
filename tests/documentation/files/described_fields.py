# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/reference that describe the program's JSON, and their comparison with a file."""

import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent.parent
PAGES = ("json.md", "model-file.md")
ROW = re.compile(r"^\| `([^`]+)` \| ([^|]+) \|")
TYPES = {"number": (int, float), "integer": (int,), "text": (str,), "flag": (bool,), "null": (type(None),)}


class Field:
    """A row of a table: path, permitted types, whether it may be absent; what a file has shown of it."""

    def __init__(self, path, words):
        self.path = path
        self.optional = words.endswith(", optional")
        self.kinds = words.removesuffix(", optional").strip().strip("`").split(" or ")
        self.seen = False

    def permits(self, value):
        for kind in self.kinds:
            if kind == "object" or isinstance(value, TYPES[kind]) and (kind == "flag" or not isinstance(value, bool)):
                return True
        return False


def read_tables():
    """Returns {section: [(path, type)]} of the pages: the name of a schema, or of a part that several share."""
    tables = {}
    for page in PAGES:
        for line in (SOURCE / "docs" / "reference" / page).read_text().splitlines():
            heading = re.match(r"^##+ `?([^`]+)`?$", line)
            if heading:
                rows = tables.setdefault(heading[1], [])
            elif ROW.match(line):
                rows.append(ROW.match(line).groups())
    return {name: rows for name, rows in tables.items() if rows}


def described_columns(section):
    """Returns the columns of the table under a heading of files.md."""
    page = (SOURCE / "docs" / "reference" / "files.md").read_text()
    text = page.split(f"## {section}\n", 1)[1].split("\n## ", 1)[0]
    return [ROW.match(line)[1] for line in text.splitlines() if ROW.match(line)]


def fields_of(tables, section, prefix="", optional=False):
    """Returns the fields of a section, with those of the sections that it names as types."""
    fields = []
    for path, words in tables[section]:
        field = Field(prefix + path, words)
        field.optional = field.optional or optional
        if field.kinds[0] in tables:
            fields += fields_of(tables, field.kinds[0], field.path + ".", field.optional)
        else:
            fields.append(field)
    return fields


def pattern_of(path):
    """Returns the regular expression of a field's path: a name in braces stands for any name."""
    return re.compile(re.sub(r"\\\{\w+\\\}", r"[^.\\[]+", re.escape(path)))


def values_of(value, path=""):
    """Yields (path, value) of all values in a JSON document that are no objects or arrays. Empty ones yield nothing."""
    if isinstance(value, dict):
        for key, one in value.items():
            yield from values_of(one, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for one in value:
            yield from values_of(one, path + "[]")
    else:
        yield path, value


def parents_present(document, path):
    """Returns whether some object that must have the field is in the document: its parents exist."""
    places = [document]
    for part in path.split(".")[:-1]:
        name, depth = part.rstrip("[]"), part.count("[]")
        places = [one[name] for one in places if isinstance(one, dict) and name in one]
        for _ in range(depth):
            places = [one for place in places if isinstance(place, list) for one in place]
    return any(isinstance(one, dict) for one in places)


def complaints(document, fields):
    """Returns what a document and its table do not have in common; marks the fields that were seen."""
    wrong, here = [], set()
    patterns = [(pattern_of(field.path), field) for field in fields]
    for path, value in values_of(document):
        found = [field for pattern, field in patterns
                 if pattern.fullmatch(path) or "object" in field.kinds and path.startswith(field.path + ".")
                 or "object" in field.kinds and path.startswith(field.path + "[")]
        if not found:
            wrong.append(f"{path} is not described")
        elif not any(field.permits(value) for field in found):
            wrong.append(f"{path}: expected {' or '.join(found[0].kinds)}, found {value!r}")
        for field in found:
            field.seen = True
            here.add(field.path)
    for field in fields:
        is_empty_array = field.path.endswith("[]") and array_at(document, field.path) == []
        if not field.optional and field.path not in here and not is_empty_array and parents_present(document, field.path):
            wrong.append(f"{field.path} is absent, and not described as optional")
    return sorted(set(wrong))


def array_at(document, path):
    """Returns the array of a path such as `a.b[]`; None: there is none, or it is within another array."""
    place = document
    for part in path[:-2].split("."):
        if not isinstance(place, dict) or part not in place:
            return None
        place = place[part]
    return place
