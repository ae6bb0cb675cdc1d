"""The JSON schema of model files knows the keys that the reader knows, and takes every model there is."""

import json
import operator
import re
import tomllib

import tool

DATE = "1970-01-01"  # no key of a model file takes a date: known ones complain of the value, others of the key


def deref(schema, root):
    return root["$defs"][schema["$ref"].split("/")[-1]] if "$ref" in schema else schema


def closed_tables(schema, root, wrap="@", path=""):
    """Every table that has fixed keys: its path, how a model file writes it, its keys."""
    schema = deref(schema, root)
    for option in schema.get("anyOf", []):
        yield from closed_tables(option, root, wrap, path)
    if "items" in schema:
        yield from closed_tables(schema["items"], root, wrap.replace("@", "[ @ ]"), path + "[]")
    inner = schema.get("additionalProperties", True)
    if isinstance(inner, dict):
        yield from closed_tables(inner, root, wrap.replace("@", "{ zz = @ }"), path + ".*")
    if inner is False:
        yield path, wrap, list(schema["properties"])
    for key, member in schema.get("properties", {}).items():
        yield from closed_tables(member, root, wrap.replace("@", f"{{ {key} = @ }}"), f"{path}.{key}")


class Schema(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.schema = json.loads(self.run_tool("schema", code=0)[0])

    def mistakes(self, wrap, keys):
        """What `saltus check` says of a model with this table."""
        # What is drawn is read once there is something that moves.
        wrap = wrap.replace("{ draw = ", '{ positions = ["x"], velocities = ["v"], draw = ')
        content = wrap.replace("@", "{ " + ", ".join(f"{key} = {DATE}" for key in keys) + " }")
        name = "" if content.startswith("{ model") else 'model = { name = "m" }\n'
        within = content[1:-1].strip()  # the outermost braces are those of the file
        self.write("m.toml", name + (within if wrap != "@" else within.replace(", ", "\n")) + "\n")
        out, _ = self.run_tool("check", "m.toml", "--json", code=2)
        return [error["message"] for error in json.loads(out)["errors"]]

    def known(self, wrap, keys):
        """Those of the keys that the reader does not call unknown."""
        said = self.mistakes(wrap, keys)
        unknown = {word.split(".")[-1] for message in said for word in re.findall(r"unknown (?:key|table|option) \W?([\w.]+)", message)}
        return set(keys) - unknown, said

    def candidates(self):
        """Every word of the sources that a reader may compare a key with."""
        words = set()
        for folder in ("io", "pipeline/options"):
            for source in (tool.SOURCE / "src/saltus" / folder).rglob("*.cpp"):
                words |= set(re.findall(r'"(?:\w+\.)*([a-z]\w*)"', source.read_text(encoding="utf-8")))
        return sorted(words | {"no_such_key"})

    def test_every_key_the_reader_takes_is_in_the_schema_and_no_other(self):
        candidates, reserved = self.candidates(), {"sensitivity"}
        count = 0
        for path, wrap, keys in closed_tables(self.schema, self.schema):
            one_each = path == ".simulate.inputs.*"  # of these a table has one
            tried = [[key] for key in sorted({*keys, "x", "every"})] if one_each else [sorted({*candidates, *keys} - reserved)]
            for some in tried:
                known, said = self.known(wrap, some)
                self.assertEqual(known, set(keys) & set(some), f"{path}: {said[:3]}")
            count += 1
        self.assertGreater(count, 25)

    def test_what_is_kept_for_later_is_not_offered(self):
        tables = self.schema["properties"]
        self.assertNotIn("sensitivity", tables)

    def test_it_takes_every_model(self):
        files = sorted([*(tool.SOURCE / "models").rglob("*.toml"), *(tool.SOURCE / "examples").rglob("*.toml")])
        self.assertGreaterEqual(len(files), 90)
        for path in files:
            self.assertEqual(self.problems(tomllib.loads(path.read_text(encoding="utf-8")), self.schema, path.stem), [])

    def problems(self, value, schema, place):
        """What of JSON schema the file uses: properties, additionalProperties, items, anyOf, $ref, required, enum, bounds."""
        schema = deref(schema, self.schema)
        if "anyOf" in schema:
            tried = [self.problems(value, option, place) for option in schema["anyOf"]]
            return [] if any(not found for found in tried) else tried[0]
        types = {"object": dict, "array": list, "string": str, "boolean": bool, "number": (int, float)}
        wanted = schema.get("type", [])
        wanted = [wanted] if isinstance(wanted, str) else wanted
        if wanted and not any(isinstance(value, types[name]) and (name == "boolean") >= isinstance(value, bool) for name in wanted):
            return [f"{place}: {value!r} is no {wanted}"]
        if "enum" in schema and value not in schema["enum"]:
            return [f"{place}: {value!r}"]
        bounds = {"minimum": operator.ge, "exclusiveMinimum": operator.gt, "maximum": operator.le,
                  "exclusiveMaximum": operator.lt, "multipleOf": lambda number, step: number % step == 0}
        for key, holds in bounds.items():
            if key in schema and not holds(value, schema[key]):
                return [f"{place}: {value!r} against {key} {schema[key]}"]
        found = []
        if isinstance(value, dict) and ("properties" in schema or "additionalProperties" in schema):
            found += [f"{place}: no {key}" for key in schema.get("required", []) if key not in value]
            for key, member in value.items():
                known = schema.get("properties", {}).get(key, schema.get("additionalProperties", True))
                if known is False:
                    found.append(f"{place}: unknown {key}")
                elif known is not True:
                    found += self.problems(member, known, f"{place}.{key}")
        if isinstance(value, list) and "items" in schema:
            for i, item in enumerate(value):
                found += self.problems(item, schema["items"], f"{place}[{i}]")
        return found

    def test_it_refuses_what_the_reader_refuses(self):
        for wrong in ({"modle": {}}, {"model": {}}, {"model": {"name": "m"}, "simulate": {"rtoll": 1}},
                      {"model": {"name": "m"}, "jumps": [{"when": "x"}]},
                      {"model": {"name": "m"}, "contacts": [{"name": "ground"}]},
                      {"model": {"name": "m"}, "optimize": {"horizon": {"initail": 1}}},
                      {"model": {"name": "m"}, "outputs": {"x": {"unit": "m"}}}):
            self.assertNotEqual(self.problems(wrong, self.schema, ""), [], wrong)
        for wrong in ({"method": "x"}, {"rtol": -1}, {"rtol": "small"}, {"until": [1]}, {"output": {"points": 1}},
                      {"output": {"points": 2.5}}, {"output": "all"}, {"event": {"integrator": "rk45"}},
                      {"fesd": {"stages": 0}}, {"max_steps": True}, {"fesd": {"step_equilibration": "exact"}},
                      {"fesd": {"lifting": 65}}, {"output": {"times": ["soon"]}}, {"output": {"states": [1]}}):
            self.assertNotEqual(self.problems({"model": {"name": "m"}, "simulate": wrong}, self.schema, ""), [], wrong)
        for wrong in ({"mpcc": {"method": "newton"}}, {"elements": [0.5]}, {"mpcc": {"sigma_factor": 1}}):
            self.assertNotEqual(self.problems({"model": {"name": "m"}, "optimize": wrong}, self.schema, ""), [], wrong)


if __name__ == "__main__":
    tool.main()
