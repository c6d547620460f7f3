"""YAML from users: lines in messages, all mistakes at once, nothing executed; safe writing."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import Field

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.source import Spec, check, read_yaml
from dualarm_pin.files.write import replacing, write_text


class Inner(Spec):
    weight: float = Field(1.0, ge=0)
    name: str = ""


class Outer(Spec):
    inner: Inner = Inner()
    items: list[Inner] = Field(default_factory=list)
    count: int = 0


def load(tmp_path: Path, text: str | bytes) -> Outer:
    file = tmp_path / "f.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return check(read_yaml(file), Outer)


def test_numbers_in_scientific_notation_are_numbers(tmp_path: Path) -> None:
    assert load(tmp_path, "inner: {weight: 1e-6}").inner.weight == 1e-6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("inner:\n  wieght: 1", r"f\.yaml:2: inner\.wieght: unknown key: did you mean 'weight'"),
        ("\n\ncout: 1", r"f\.yaml:3: cout: unknown key: did you mean 'count'"),
        ("inner: {weight: heavy}", r"f\.yaml:1: inner\.weight: .*number.*given 'heavy'"),
        ("inner: {weight: -1}", r"inner\.weight: .*greater than or equal to 0; given -1"),
        ("inner: {weight: .nan}", r"inner\.weight: .*finite"),
        ("items:\n- {weight: 1}\n- {weight: x}", r"f\.yaml:3: items\.1\.weight"),
        ("count: 1\ncount: 2", r"f\.yaml:2: .*duplicate key"),
        ("inner: [", r"f\.yaml:\d+: not valid YAML"),
        ("", r"f\.yaml:1: an empty file"),
        ("- 1\n", r"f\.yaml:1: a \w+ where keys and values are expected"),
        (b"\xff\xfe\x00", r"f\.yaml: byte 0 is not UTF-8"),
        ("inner: !!python/object/apply:os.system ['true']", r"f\.yaml:1: inner"),
    ],
)
def test_every_mistake_names_file_line_and_field(
    tmp_path: Path, text: str | bytes, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        load(tmp_path, text)


def test_all_mistakes_are_reported_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load(tmp_path, "inner:\n  weight: heavy\nitems:\n- {wait: 1}\ncount: many\n")
    text = str(caught.value)
    assert all(place in text for place in ("f.yaml:2", "f.yaml:4", "f.yaml:5"))


def test_aliases_that_explode_are_not_followed_for_ever(tmp_path: Path) -> None:
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
        f"{b}: &{b} [*{a},*{a},*{a},*{a},*{a},*{a},*{a},*{a},*{a}]\n"
        for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    with pytest.raises(InputError):
        load(tmp_path, bomb)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match=r"gone\.yaml: no such file"):
        read_yaml(tmp_path / "gone.yaml")
    with pytest.raises(MissingFileError):
        read_yaml(tmp_path)


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path) -> None:
    file = tmp_path / "new" / "a.txt"
    write_text(file, "first")
    with pytest.raises(RuntimeError), replacing(file) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert file.read_text() == "first"
    assert [p.name for p in file.parent.iterdir()] == ["a.txt"]


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot write here"):
        write_text(tmp_path / "file" / "a.txt", "x")
