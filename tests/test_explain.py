"""Every key of every file is explained, with an example that works, and editors know it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError
from ruamel.yaml import YAML

from dualarm_pin.cli import main
from dualarm_pin.explain import FILES, every_key, explain, schemas
from dualarm_pin.files.documented import documented, example_of, models_in
from dualarm_pin.files.resources import urdf_folder

jsonschema = pytest.importorskip("jsonschema")


def sections() -> list[type[BaseModel]]:
    found: list[type[BaseModel]] = []
    waiting: list[Any] = list(FILES.values())
    while waiting:
        model = waiting.pop()
        if model not in found:
            found.append(model)
            waiting += [m for f in model.model_fields.values() for m in models_in(f.annotation)]
    return found


@pytest.mark.parametrize("section", sections(), ids=lambda section: section.__name__)
def test_every_key_has_a_meaning_and_an_example_that_is_valid(section: type[BaseModel]) -> None:
    said = documented(section)
    assert set(said) == set(section.model_fields), "say what these mean in the docstring"
    for name, about in said.items():
        assert len(about.text) > 2, name
        assert about.example is not None, f"{name}: give an example, such as `...`"
        assert "such as" not in about.text, name
        needed = {n: said[n].example for n, f in section.model_fields.items() if f.is_required()}
        others = ({other: said[other].example} for other in said)
        bases = ({}, needed, example_of(section), {"call": "my_module:my_function"}, *others)
        tries = [base | {name: about.example} for base in bases]
        refused = []
        for content in tries:
            try:
                section.model_validate(content)
            except ValidationError as error:
                refused.append(error)
        assert len(refused) < len(tries), f"{name}: {refused}"


def shipped(kind: str) -> list[Path]:
    return sorted((urdf_folder() / f"{kind}s").glob("*.yaml"))


@pytest.fixture(scope="module")
def validators() -> dict[str, Any]:
    made = {name: json.loads(text) for name, text in schemas().items()}
    for schema in made.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    return {n.partition(".")[0]: jsonschema.Draft202012Validator(s) for n, s in made.items()}


@pytest.mark.parametrize("kind", FILES)
def test_what_ships_is_valid_by_its_schema_and_names_it(
    kind: str, validators: dict[str, Any]
) -> None:
    files = shipped(kind)
    assert files
    for file in files:
        text = file.read_text()
        assert text.startswith(f"# yaml-language-server: $schema=../schema/{kind}.schema.json\n")
        content = YAML(typ="safe", pure=True).load(text)
        mistakes = list(validators[kind].iter_errors(content))
        assert not mistakes, f"{file}: {mistakes[0].message}"


def test_the_schemas_that_ship_are_those_of_today() -> None:
    folder = urdf_folder() / "schema"
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == schemas(), (
        "run `dualarm-pin explain --schema urdf/schema`"
    )


@pytest.mark.parametrize(
    ("kind", "content", "valid"),
    [
        ("task", {"cell": "a", "path": {"csv": "a.csv"}, "index": "force"}, True),
        ("task", {"cell": "a", "path": {"call": "a:b", "any": 1}, "index": "force"}, True),
        ("task", {"cell": "a", "path": {"csv": "a.csv"}, "clearance": "off"}, True),
        ("task", {"cell": "a", "path": {"csv": "a.csv"}, "smoothnes": 3}, False),
        ("task", {"cell": "a", "path": {"cirle": {"radius": 1}}}, False),
        ("task", {"cell": "a", "path": {"circle": {"radius": "wide", "points": 9}}}, False),
        ("task", {"path": {"csv": "a.csv"}}, False),
        ("cell", {"arms": {"arm1": {"urdf": 3}, "arm2": {}}}, False),
        ("suite", {"tasks": ["a.yaml"], "methods": ["local"], "seeds": 0}, False),
    ],
)
def test_the_schemas_tell_right_from_wrong(
    kind: str, content: dict[str, Any], valid: bool, validators: dict[str, Any]
) -> None:
    assert validators[kind].is_valid(content) is valid


def test_schemas_carry_what_is_said_about_each_key() -> None:
    task = json.loads(schemas()["task.schema.json"])
    circle = task["$defs"]["circleArguments"]["properties"]
    assert circle["radius"]["description"] == "Above 0 [m]."
    assert circle["radius"]["examples"] == [0.1]
    assert "[deg]" in circle["start_deg"]["description"]


def test_a_key_is_found_by_its_place_and_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    text = explain("path.corner.fillet")
    assert text.startswith("task.path.corner.fillet\n")
    assert "unit     m" in text
    assert "default  0.01" in text
    assert explain("fillet").count("example") == 3  # of a corner, a polyline and a raster
    assert explain("arm1").startswith("cell.arms.arm1\n")
    overview = explain()
    assert all(f"{name}: " in overview for name in FILES)
    assert len(list(every_key())) > 250
    with pytest.raises(SystemExit) as end:
        main(["explain", "filet"])
    assert end.value.code == 2
    assert "no file or key 'filet': did you mean 'fillet'?" in capsys.readouterr().err
