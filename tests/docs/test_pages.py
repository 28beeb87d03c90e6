"""The documentation: a command that a page shows prints what the page says; the site is whole and needs no network."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import jsonschema
import pytest
import yaml

from gcodesim.cell.loader import load_cell
from gcodesim.cell.schema import cell_schema
from gcodesim.cli.outline import outline
from gcodesim.cli.parser import build_parser
from gcodesim.cli.reference import reference
from gcodesim.key_page import with_keys
from gcodesim.kinematics.models import MODELS
from tests.console import Block, Console, blocks_of, differs, without_blocks

TOP = Path(__file__).parents[2]
DOCS = TOP / "docs"
PAGES = [TOP / "README.md", *sorted(DOCS.rglob("*.md"))]


def name_of(page: Path) -> str:
    return page.relative_to(TOP).as_posix()


SNIPPETS = [
    (page, code)
    for page in PAGES[1:]
    for code in re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
]
YAML = [
    (page, text)
    for page in PAGES
    for text in re.findall(r"^```yaml\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
]
WITH_COMMANDS = [page for page in PAGES if any(block.language == "console" for block in blocks_of(page.read_text()))]


@pytest.mark.parametrize("page", WITH_COMMANDS, ids=name_of)
def test_commands_print_what_the_page_says(page: Path, tmp_path: Path) -> None:
    for name in ("programs", "cells"):
        (tmp_path / name).symlink_to(TOP / name)
    console, faults = Console(tmp_path), []
    for block in blocks_of(page.read_text(encoding="utf-8")):
        if block.title:
            console.put(block.title, block.text)
        elif not block.reason:
            faults += _faults(console, block)
    assert not faults, "\n".join(faults)


def test_the_python_of_the_readme_runs(tmp_path: Path) -> None:
    for name in ("programs", "cells"):
        (tmp_path / name).symlink_to(TOP / name)
    [code] = re.findall(
        r"^```python\n(.*?)^```$", (TOP / "README.md").read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert re.fullmatch(r"\d+\.\d+ \d\.\d+e-\d+\n", done.stdout)


@pytest.mark.parametrize(("page", "code"), SNIPPETS, ids=[name_of(page) for page, _ in SNIPPETS])
def test_python_of_a_page_can_be_copied(page: Path, code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each block runs by itself, with what it imports."""
    module = ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)
    exec(compile(code, name_of(page), "exec"), vars(module))


def test_cells_of_the_pages_are_cells(tmp_path: Path) -> None:
    file, faults = tmp_path / "cell.yaml", list[str]()
    whole = [(page, text) for page, text in YAML if text.startswith("gcodesim: 1\n")]
    for page, text in whole:
        file.write_text(text, encoding="utf-8")
        faults += [f"{name_of(page)}: {found.message}" for found in load_cell(file).findings if found.code != "GS926"]
    assert len(whole) > 5 and not faults, "\n".join(faults)


def test_parts_of_cells_of_the_pages_have_their_keys() -> None:
    schema = cell_schema()
    keys = schema["$defs"]["Cell"]["properties"]
    parts = [json.loads(json.dumps(yaml.safe_load(text))) for _, text in YAML]
    parts = [part for part in parts if "gcodesim" not in part and part.keys() <= keys.keys()]
    assert len(parts) > 4
    of_parts = {"$defs": schema["$defs"], "properties": keys}
    jsonschema.Draft202012Validator.check_schema(of_parts)
    validator = jsonschema.Draft202012Validator(of_parts)
    for part in parts:
        validator.validate(part)


def test_prose_names_commands_and_options_that_exist() -> None:
    command_line = outline(build_parser())
    leaves = {command.path: command for command in command_line.leaves()}
    spoken = [
        (page, words)
        for page in PAGES
        for text in re.findall(r"`gcodesim ([^`]+)`", without_blocks(page.read_text(encoding="utf-8")))
        for words in [text.replace("|", " | ").split()]
    ]
    assert len(spoken) > 100
    unknown = []
    for page, words in spoken:
        command = leaves.get((words[0],)) or leaves.get(tuple(words[:2]))
        options = [word for word in words if word.startswith("--") and word != "--help"]
        if command is None:
            group = any(path[0] == words[0] for path in leaves) or words[0] == "COMMAND"
            unknown += [] if group and not options else [f"{name_of(page)}: gcodesim {' '.join(words)}"]
        else:
            unknown += [f"{name_of(page)}: {option}" for option in options if not command.takes(option)]
    assert not unknown, "\n".join(unknown)


def test_the_tables_of_the_readme_are_whole() -> None:
    text = (TOP / "README.md").read_text(encoding="utf-8")
    commands = {command.path[0] for command in outline(build_parser()).leaves()}
    assert set(re.findall(r"^\| `gcodesim ([a-z-]+)", text, re.MULTILINE)) == commands
    rows = re.findall(r"^\| `([\w]+\.(?:nc|ngc|gcode|py))` \| ([^|]+) \|", text, re.MULTILINE)
    kinds = (".nc", ".ngc", ".gcode", ".py")
    programs = [path for path in (TOP / "programs").iterdir() if path.suffix in kinds and "." not in path.stem]
    # a dot in the stem: of a second channel
    assert {name for name, _ in rows} == {path.name for path in programs} - {"make_programs.py"}
    named = {cell for _, cells in rows for cell in re.findall(r"`(\w+)`", cells)}
    assert named == {path.stem for path in (TOP / "cells").glob("*.yaml")}
    assert len(MODELS) == 12 and "Twelve machines ship with gcodesim" in text


def _faults(console: Console, block: Block) -> list[str]:
    faults = []
    for command, shown in block.commands():
        status = console.run(command)
        if shown and (why := differs(console.said, shown)):
            faults.append(f"line {block.line}: $ {command}: {why}")
        elif not shown and status:
            faults.append(f"line {block.line}: $ {command} ends with {status}: {console.said}")
    return faults


def test_pages_have_commands_and_few_that_are_not_run() -> None:
    blocks = [block for page in WITH_COMMANDS for block in blocks_of(page.read_text()) if block.language == "console"]

    assert sum(len(list(block.commands())) for block in blocks if not block.reason) > 40
    assert sum(bool(block.reason) for block in blocks) < 16


@pytest.mark.parametrize(
    ("said", "shown", "same"),
    [
        ("a 1\nb\nc\n", ["a …", "…", "c"], True),
        ("a   1\n", ["a 1"], True),
        ("a 1\n", ["a 2"], False),
        ("a\nb\n", ["a"], False),
        ("a\n", ["a", "…"], True),
        ("x a\n", ["a"], False),
    ],
)
def test_what_counts_as_the_same(said: str, shown: list[str], same: bool) -> None:
    assert (differs(said, shown) == "") is same


def test_the_page_of_commands_is_fresh() -> None:
    page = (DOCS / "commands.md").read_text(encoding="utf-8")

    assert page == with_keys(page, reference()), "python -m gcodesim.cli.reference docs/commands.md"
    assert page.count("\n### `") > 18


def _pages_of(entry: object) -> list[str]:
    if isinstance(entry, str):
        return [entry]
    entries = entry.values() if isinstance(entry, dict) else entry
    return [page for one in entries for page in _pages_of(one)]  # type: ignore[attr-defined]


def test_navigation_has_every_page_once() -> None:
    settings = yaml.safe_load((TOP / "mkdocs.yml").read_text(encoding="utf-8"))

    assert sorted(_pages_of(settings["nav"])) == sorted(
        page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")
    )
    assert settings["strict"] is True and settings["theme"]["font"] is False


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = _build(TOP / "mkdocs.yml", folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def _build(settings: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mkdocs", "build", "--config-file", settings, "--site-dir", folder]
    environment = {"PATH": "/usr/bin:/bin", "NO_MKDOCS_2_WARNING": "1"}
    return subprocess.run(command, cwd=TOP, capture_output=True, text=True, check=False, env=environment)


def test_the_site_asks_nothing_of_a_network(site: Path) -> None:
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 30
    for page in pages:
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(
            r"<(?:script|img|iframe|link(?! rel=\"canonical\"))[^>]*(?:src|href)=[\"']?([^\"' >]+)", text
        )
        assert loaded
        assert not [address for address in loaded if re.match(r"(?:https?:)?//", address)], page.name
    for sheet in site.rglob("*.css"):
        assert not re.search(r"(?:@import|url\()\s*[\"']?(?:https?:)?//", sheet.read_text(encoding="utf-8")), sheet.name


def test_a_broken_link_fails(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("# Page\n\n[gone](gone.md), [no part](index.md#no-part)\n")
    settings = yaml.safe_load((TOP / "mkdocs.yml").read_text(encoding="utf-8"))
    own = {name: settings[name] for name in ("site_name", "strict", "validation", "theme", "plugins")}
    (tmp_path / "mkdocs.yml").write_text(yaml.safe_dump(own))
    done = _build(tmp_path / "mkdocs.yml", tmp_path / "site")

    assert done.returncode != 0
    assert "gone.md" in done.stdout + done.stderr and "no-part" in done.stdout + done.stderr
