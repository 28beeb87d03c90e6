"""The server in a process of its own, asked by a client of the protocol."""

import asyncio
import sys
from pathlib import Path

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

sys.path.insert(0, str(Path(__file__).parent))

from documents import CELL, PROGRAM, at

LONGEST = 600.0  # [s] for one answer, on a busy machine


class Editor:
    """A client that has one program or cell open."""

    def __init__(self, client: LanguageClient, shown: asyncio.Queue) -> None:
        self.client, self.shown, self.version = client, shown, 1

    def open(self, path: Path, text: str) -> None:
        path.write_text(text, encoding="utf-8")
        self.uri, self.text = path.as_uri(), text
        item = lsp.TextDocumentItem(uri=self.uri, language_id="gcode", version=1, text=text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))

    @property
    def document(self):
        return lsp.TextDocumentIdentifier(self.uri)

    def change(self, begin, end, text):
        self.version += 1
        part = lsp.TextDocumentContentChangePartial(
            range=lsp.Range(lsp.Position(*begin), lsp.Position(*end)), text=text
        )
        name = lsp.VersionedTextDocumentIdentifier(uri=self.uri, version=self.version)
        self.client.text_document_did_change(lsp.DidChangeTextDocumentParams(name, [part]))

    async def findings(self):
        """What is shown for the latest version."""
        while True:
            told = await asyncio.wait_for(self.shown.get(), LONGEST)
            if told.uri == self.uri and told.version == self.version:
                return told.diagnostics

    def at(self, needle, nth=0):
        return {"text_document": self.document, "position": lsp.Position(*at(self.text, needle, nth))}


def conversation(talk, folder, before="", **options):
    """Run `talk(editor)` with a server in `folder`, whose interpreter runs the lines `before` first."""
    begin = f"{before}\nimport sys\nfrom gcodesim.cli import main\nsys.exit(main(['lsp', '--stdio']))"

    async def whole():
        client = LanguageClient("test", "1")
        shown = asyncio.Queue()

        @client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def show(told: lsp.PublishDiagnosticsParams) -> None:
            shown.put_nowait(told)

        await client.start_io(sys.executable, "-c", begin, cwd=folder)
        parameters = lsp.InitializeParams(
            capabilities=lsp.ClientCapabilities(), root_uri=folder.as_uri(), initialization_options=options
        )
        answer = await asyncio.wait_for(client.initialize_async(parameters), LONGEST)
        assert answer.server_info.name == "gcodesim"
        client.initialized(lsp.InitializedParams())
        await talk(Editor(client, shown))
        await asyncio.wait_for(client.shutdown_async(None), LONGEST)
        client.exit(None)
        assert await asyncio.wait_for(client._server.wait(), LONGEST) == 0
        assert await asyncio.wait_for(client._server.stderr.read(), LONGEST) == b""  # nobody may read that
        await client.stop()

    asyncio.run(whole())


def test_an_editor_asks_everything(tmp_path):
    (tmp_path / "cell.yaml").write_text(CELL)

    async def talk(editor):
        ask = editor.client
        editor.open(tmp_path / "part.nc", PROGRAM)
        assert not [one for one in await editor.findings() if one.severity == lsp.DiagnosticSeverity.Error]

        hover = await ask.text_document_hover_async(lsp.HoverParams(**editor.at("T1 M6")))
        assert "Schlichter" in hover.contents.value
        offers = await ask.text_document_completion_async(lsp.CompletionParams(**editor.at("21 G90")))
        assert "G90.1" in [item.label for item in offers.items]
        place = await ask.text_document_definition_async(lsp.DefinitionParams(**editor.at("o<HOLE>")))
        assert place.range.start.line == at(PROGRAM, "o<hole> sub")[0]
        parts = await ask.text_document_document_symbol_async(lsp.DocumentSymbolParams(editor.document))
        assert "o<hole>" in [part.name for part in parts]
        uses = await ask.text_document_references_async(
            lsp.ReferenceParams(**editor.at("#100=5"), context=lsp.ReferenceContext(include_declaration=True))
        )
        assert len(uses) == 3
        edit = await ask.text_document_rename_async(lsp.RenameParams(**editor.at("#100=5"), new_name="105"))
        assert {one.new_text for one in edit.changes[editor.uri]} == {"105"}
        with pytest.raises(JsonRpcException, match="no parameter here"):
            await ask.text_document_rename_async(lsp.RenameParams(**editor.at("T1 M6"), new_name="105"))
        may = await ask.text_document_prepare_rename_async(lsp.PrepareRenameParams(**editor.at("#100=5")))
        assert (may.start.character, may.end.character) == (1, 4)
        styled = await ask.text_document_formatting_async(
            lsp.DocumentFormattingParams(editor.document, lsp.FormattingOptions(2, True))
        )
        assert "#<depth> = 2\n" in styled[0].new_text
        assert not await ask.text_document_code_lens_async(lsp.CodeLensParams(editor.document))

        editor.change((3, 0), (3, 0), "GO X1 (🔩) X\n")
        shown = await editor.findings()
        wrong = next(one for one in shown if one.range.start.line == 3)
        assert wrong.data["line"] == 4
        actions = await ask.text_document_code_action_async(
            lsp.CodeActionParams(editor.document, wrong.range, lsp.CodeActionContext(shown))
        )
        assert [one.title for one in actions] == ["Write `G0`"]
        editor.change((3, 0), (3, 2), "G0")
        shown = await editor.findings()
        # the letter stands behind a character of two UTF-16 units
        assert [one.range.start.character for one in shown if one.code == "GS004"] == [len("G0 X1 (xx) ")]

    conversation(talk, tmp_path)


def test_a_program_is_formatted_in_the_style_of_its_folder(tmp_path):
    (tmp_path / "gcodesim.yaml").write_text("format: {case: lower, decimals: 2}\n")

    async def talk(editor):
        editor.open(tmp_path / "part.nc", "G21 G90\nG1 X1 F100\nM2\n")
        await editor.findings()
        ask = lsp.DocumentFormattingParams(editor.document, lsp.FormattingOptions(2, True))
        (edit,) = await editor.client.text_document_formatting_async(ask)
        assert edit.new_text == "g21 g90\ng1 x1.00 f100\nm2\n"

    conversation(talk, tmp_path)


FORMATS_AT_LEISURE = """
import pathlib, time
from gcodesim.editor import server
formatted = server.formatted

def later(*given):
    for _ in range(3000):
        if pathlib.Path('go').exists():
            break
        time.sleep(0.01)
    return formatted(*given)

server.formatted = later
"""


def test_questions_are_answered_while_a_program_is_formatted(tmp_path):
    async def talk(editor):
        editor.open(tmp_path / "long.nc", "G21 G90\ng1 x1 f100\nM2\n")
        await editor.findings()
        style = lsp.DocumentFormattingParams(editor.document, lsp.FormattingOptions(2, True))
        writing = asyncio.ensure_future(asyncio.wrap_future(editor.client.text_document_formatting(style)))
        hover = await editor.client.text_document_hover_async(lsp.HoverParams(**editor.at("g1")))
        assert hover is not None and not writing.done()
        (tmp_path / "go").touch()
        (edit,) = await writing
        assert edit.new_text.startswith("G21 G90\nG1 X1 F100\n")

    conversation(talk, tmp_path, FORMATS_AT_LEISURE)


def test_a_cell(tmp_path):
    async def talk(editor):
        editor.open(tmp_path / "mill.yaml", CELL.replace("tools:", "tols:"))
        (finding,) = await editor.findings()
        assert finding.code == "GS704"
        hover = await editor.client.text_document_hover_async(lsp.HoverParams(**editor.at("box")))
        assert "edge lengths" in hover.contents.value

    conversation(talk, tmp_path)


def test_dialect_of_the_workspace(tmp_path):
    async def talk(editor):
        editor.open(tmp_path / "o1.nc", "O1\n#1=#2+3\nM30\n")
        assert not await editor.findings()

    conversation(talk, tmp_path, dialect="fanuc")


def test_a_long_program_answers_while_it_is_read(tmp_path):
    """Findings of a change come before the rest is read, and questions do not wait for it."""
    lines = ["G21 G90", "F100", *(f"G1 X{n % 90} Y{n % 7}" for n in range(20_000)), "M2"]

    async def talk(editor):
        editor.open(tmp_path / "long.nc", "\n".join(lines) + "\n")
        assert not await editor.findings()
        editor.change((500, 0), (500, 0), "G1 X\n")
        first = await editor.findings()
        assert [one.range.start.line for one in first] == [500]
        hover = await editor.client.text_document_hover_async(lsp.HoverParams(editor.document, lsp.Position(400, 0)))
        assert "straight move" in hover.contents.value

    conversation(talk, tmp_path)
