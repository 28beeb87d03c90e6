"""The language server: questions of its protocol, answered by the documents. The only importer of pygls."""

from __future__ import annotations

import asyncio
import gc
import logging
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final

from lsprotocol import types as lsp
from pygls import uris
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.plain import one_line
from gcodesim.diagnostics.show import as_json
from gcodesim.editor import completion, fixes, hover, last_run, outline, parameters, targets
from gcodesim.editor.cell_document import CellDocument
from gcodesim.editor.place import TextRange, column_of, range_of, units_before
from gcodesim.editor.program_document import Choices, ProgramDocument
from gcodesim.formatting import CannotFormatError, formatted
from gcodesim.formatting.style_file import NAME as SETTINGS
from gcodesim.formatting.style_file import style_for
from gcodesim.version import __version__

_SLICE: Final = 40
"""Blocks that are read between two looks at what the editor says; a message takes several looks."""
_PAUSE: Final = 2.0
"""Nothing typed for so long [s]: time to look for memory that is free, which takes longer than an answer may."""
_NEVER: Final = 1_000_000

_LEVELS: Final = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_SORTS: Final = {
    "code": lsp.CompletionItemKind.Function,
    "letter": lsp.CompletionItemKind.Field,
    "parameter": lsp.CompletionItemKind.Variable,
    "keyword": lsp.CompletionItemKind.Keyword,
    "subroutine": lsp.CompletionItemKind.Method,
    "tool": lsp.CompletionItemKind.Value,
    "key": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.EnumMember,
    "unit": lsp.CompletionItemKind.Unit,
}
_PARTS: Final = {
    "subroutine": lsp.SymbolKind.Function,
    "tool": lsp.SymbolKind.Event,
    "comment": lsp.SymbolKind.String,
}
_CELLS: Final = (".yaml", ".yml")
Document = ProgramDocument | CellDocument


class RefusedError(JsonRpcInvalidParams):
    """What was asked cannot be done; the editor shows the text."""


def _is_a_fault(record: logging.LogRecord) -> bool:
    """Whether a record is about more than an answer that says no. Editors need not read what is logged, and a server
    whose log nobody reads would wait for that some day."""
    return record.exc_info is None or not isinstance(record.exc_info[1], RefusedError)


class Server(LanguageServer):
    """The documents that an editor has open."""

    def __init__(self, choices: Choices) -> None:
        super().__init__("gcodesim", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Incremental)
        self.choices = choices
        self.documents: dict[str, Document] = {}
        self._reading: dict[str, asyncio.Task[None]] = {}
        self._tidying: asyncio.TimerHandle | None = None

    # -- documents

    def take(self, uri: str) -> None:
        """A document was opened or changed: read what the change does, and the rest between questions."""
        text = self.workspace.get_text_document(uri).source
        document = self.documents.get(uri)
        if document is None:
            path = Path(uris.to_fs_path(uri) or "untitled.nc")
            if path.suffix.lower() in _CELLS:
                if not path.name.endswith(".test.yaml") and path.name != SETTINGS:
                    self.documents[uri] = CellDocument(path, text, self.choices.allow_paths)
            else:
                self.documents[uri] = ProgramDocument(path, text, self.choices)
        else:
            document.update(text)
        self.show(uri)
        self.read_on(uri)
        self._tidy_later()

    def _tidy_later(self) -> None:
        """Look for memory that is free in the next pause."""
        if self._tidying is not None:
            self._tidying.cancel()
        self._tidying = asyncio.get_event_loop().call_later(_PAUSE, gc.collect)

    def forget(self, uri: str) -> None:
        """A document was closed."""
        self.documents.pop(uri, None)
        if (task := self._reading.pop(uri, None)) is not None:
            task.cancel()
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri=uri, diagnostics=[]))

    def saved(self, uri: str) -> None:
        """A file was saved: programs in a cell look whether it has changed."""
        for other, document in self.documents.items():
            if isinstance(document, ProgramDocument) and other != uri:
                document.look_at_cell()
                self.show(other)
                self.read_on(other)

    def read_on(self, uri: str) -> None:
        """Read the rest of a program, a slice at a time, so that a question never waits for it."""
        if (task := self._reading.pop(uri, None)) is not None:
            task.cancel()
        document = self.documents.get(uri)
        if isinstance(document, ProgramDocument) and not document.is_done:
            self._reading[uri] = asyncio.get_event_loop().create_task(self._rest(uri, document))

    async def _rest(self, uri: str, document: ProgramDocument) -> None:
        while not document.go_on(_SLICE):
            await asyncio.sleep(0)
        if self.documents.get(uri) is document:
            self.show(uri)

    def show(self, uri: str) -> None:
        """Publish the findings of a document."""
        document = self.documents.get(uri)
        if document is None:
            return
        version = self.workspace.get_text_document(uri).version
        found = [_diagnostic(one, document.source) for one in document.findings]
        self.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(uri=uri, diagnostics=found, version=version)
        )

    # -- questions

    def program(self, uri: str) -> ProgramDocument | None:
        """The program of this name, if it is one and open."""
        document = self.documents.get(uri)
        return document if isinstance(document, ProgramDocument) else None

    def place(self, uri: str, position: lsp.Position) -> tuple[int, int]:
        """Line and column in code points, from 0."""
        document = self.documents[uri]
        return position.line, column_of(document.source.line(position.line + 1), position.character)


def _lsp_range(place: TextRange, source: SourceText) -> lsp.Range:
    def position(line: int, column: int) -> lsp.Position:
        return lsp.Position(line, units_before(source.line(line + 1), column))

    return lsp.Range(position(place.line, place.column), position(place.end_line, place.end_column))


def _diagnostic(finding: Diagnostic, source: SourceText) -> lsp.Diagnostic:
    """A finding as editors show it; one of another file stands at the call that leads there, or at the top."""
    span = finding.span
    message = one_line(finding.message) + (f"\nhint: {one_line(finding.hint)}" if finding.hint else "")
    if span.file == source.name:
        place = range_of(span, source)
    else:
        call = next((caller.line for caller in span.callers if caller.file == source.name), 1)
        place = TextRange(call - 1, 0, call - 1, len(source.line(call)))
        message = f"{one_line(span.file)}:{span.line}: {message}"
    return lsp.Diagnostic(
        range=_lsp_range(place, source),
        message=message,
        severity=_LEVELS[finding.level],
        code=finding.code,
        source="gcodesim",
        data=as_json(finding),
    )


def _edit(uri: str, changes: Iterable[tuple[TextRange, str]], source: SourceText) -> lsp.WorkspaceEdit:
    edits = [lsp.TextEdit(range=_lsp_range(place, source), new_text=text) for place, text in changes]
    return lsp.WorkspaceEdit(changes={uri: edits})


def serve(choices: Choices) -> Server:
    """A server, not yet connected to anybody; `start_io` connects it with standard input and output."""
    logging.getLogger("pygls").setLevel(logging.ERROR)  # a method that a client has and we do not is no news
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_a_fault)
    server = Server(choices)
    for register in (_documents, _reading, _writing):
        register(server)
    return server


def _documents(server: Server) -> None:
    @server.feature(lsp.INITIALIZE)
    def initialize(ls: Server, params: lsp.InitializeParams) -> None:
        gc.set_threshold(*gc.get_threshold()[:2], _NEVER)  # the server chooses the moment itself
        ls.choices = choices_of(params.initialization_options, ls.choices, params.root_uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def opened(ls: Server, params: lsp.DidOpenTextDocumentParams) -> None:
        ls.documents.pop(params.text_document.uri, None)
        ls.take(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def changed(ls: Server, params: lsp.DidChangeTextDocumentParams) -> None:
        ls.take(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def saved(ls: Server, params: lsp.DidSaveTextDocumentParams) -> None:
        ls.saved(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def closed(ls: Server, params: lsp.DidCloseTextDocumentParams) -> None:
        ls.forget(params.text_document.uri)


def _reading(server: Server) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hovered(ls: Server, params: lsp.HoverParams) -> lsp.Hover | None:
        uri = params.text_document.uri
        document = ls.documents.get(uri)
        if document is None:
            return None
        place = ls.place(uri, params.position)
        if isinstance(document, CellDocument):
            found = document.hover(*place)
        else:
            found = hover.hover(document, *place)
        if found is None:
            return None
        content = lsp.MarkupContent(kind=lsp.MarkupKind.Markdown, value=found.text)
        return lsp.Hover(contents=content, range=_lsp_range(found.range, document.source))

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def defined(ls: Server, params: lsp.DefinitionParams) -> lsp.Location | None:
        uri = params.text_document.uri
        document = ls.program(uri)
        found = None if document is None else targets.target_of(document, *ls.place(uri, params.position))
        if document is None or found is None:
            return None
        if found.path == document.path:
            return lsp.Location(uri=uri, range=_lsp_range(found.range, document.source))
        try:
            source = SourceText.read(found.path)
        except OSError:  # it has gone since it was found
            return None
        return lsp.Location(uri=uris.from_fs_path(str(found.path)) or "", range=_lsp_range(found.range, source))

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def used(ls: Server, params: lsp.ReferenceParams) -> list[lsp.Location]:
        uri = params.text_document.uri
        document = ls.program(uri)
        if document is None:
            return []
        line, column = ls.place(uri, params.position)
        name = parameters.parameter_at(document.tokens(line), column)
        found = [] if name is None else parameters.uses_of(document, name, line)
        return [lsp.Location(uri=uri, range=_lsp_range(use.range, document.source)) for use in found]

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def outlined(ls: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        document = ls.documents.get(params.text_document.uri)
        if isinstance(document, CellDocument):
            return [
                _symbol(name, lsp.SymbolKind.Property, at, whole, document.source)
                for name, at, whole in document.parts()
            ]
        if document is None:
            return []
        found = []
        for part in outline.parts_of(document):
            whole = outline.range_of_part(document, part)
            at = TextRange(part.line, 0, part.line, len(document.source.line(part.line + 1)))
            found.append(_symbol(part.name, _PARTS[part.kind], at, whole, document.source))
        return found

    @server.feature(lsp.TEXT_DOCUMENT_CODE_LENS)
    def lenses(ls: Server, params: lsp.CodeLensParams) -> list[lsp.CodeLens]:
        document = ls.program(params.text_document.uri)
        if document is None:
            return []
        return [
            lsp.CodeLens(
                range=_lsp_range(TextRange(use.line, 0, use.line, 0), document.source),
                command=lsp.Command(title=use.text, command=""),
            )
            for use in last_run.line_uses(document)
        ]


def _symbol(name: str, kind: lsp.SymbolKind, at: TextRange, whole: TextRange, source: SourceText) -> lsp.DocumentSymbol:
    return lsp.DocumentSymbol(
        name=name, kind=kind, range=_lsp_range(whole, source), selection_range=_lsp_range(at, source)
    )


def _writing(server: Server) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=["#", "<", "{", " "]))
    def completed(ls: Server, params: lsp.CompletionParams) -> lsp.CompletionList | None:
        uri = params.text_document.uri
        document = ls.documents.get(uri)
        if document is None:
            return None
        line, column = ls.place(uri, params.position)
        if isinstance(document, CellDocument):
            offers = document.offers(line, column)
        else:
            offers = completion.offers(document, line, column)
        items = []
        for count, offer in enumerate(offers):
            place = _lsp_range(TextRange(line, offer.begin, line, column), document.source)
            items.append(
                lsp.CompletionItem(
                    label=offer.text,
                    kind=_SORTS[offer.sort],
                    detail=offer.about or None,
                    sort_text=f"{count:05d}",
                    text_edit=lsp.TextEdit(range=place, new_text=offer.text),
                )
            )
        return lsp.CompletionList(is_incomplete=False, items=items)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def renamed(ls: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
        uri = params.text_document.uri
        document = ls.program(uri)
        if document is None:
            return None
        try:
            changes = parameters.renamed(document, *ls.place(uri, params.position), params.new_name)
        except parameters.CannotRenameError as error:
            raise RefusedError(str(error)) from None
        return _edit(uri, changes, document.source)

    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def may_rename(ls: Server, params: lsp.PrepareRenameParams) -> lsp.Range | None:
        uri = params.text_document.uri
        document = ls.program(uri)
        if document is None:
            return None
        line, column = ls.place(uri, params.position)
        name = parameters.parameter_at(document.tokens(line), column)
        uses = [] if name is None else parameters.uses_of(document, name, line)
        here = (use.range for use in uses if use.range.line == line and use.range.column - 1 <= column)
        found = max((one for one in here if column <= one.end_column), default=None)
        return None if found is None else _lsp_range(found, document.source)

    @server.feature(lsp.TEXT_DOCUMENT_CODE_ACTION)
    def actions(ls: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        uri = params.text_document.uri
        document = ls.documents.get(uri)
        if document is None:
            return []
        shown = [one for one in params.context.diagnostics if one.source == "gcodesim"]
        found = []
        for finding in document.findings:
            told = _diagnostic(finding, document.source)
            about = [one for one in shown if one.code == told.code and one.range == told.range]
            for fix in fixes.fixes_of(finding, document.source) if about else ():
                edit = _edit(uri, [(fix.range, fix.text)], document.source)
                found.append(
                    lsp.CodeAction(title=fix.title, kind=lsp.CodeActionKind.QuickFix, edit=edit, diagnostics=about)
                )
        return found

    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    async def written(ls: Server, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        document = ls.program(params.text_document.uri)
        if document is None or document.reading is None:
            return []
        source, settings = document.source, document.reading.settings
        try:  # beside the answers to other questions, since it reads the whole program twice
            style = style_for(document.path).style
            if style is None:
                return []  # nobody knows what the shop wants
            new = (await asyncio.to_thread(formatted, source, settings, style)).program
        except CannotFormatError:
            return []  # the errors are shown anyway
        if new.raw == source.raw or document.source is not source:  # somebody has typed on
            return []
        place = TextRange(0, 0, len(source.lines), 0)
        return [lsp.TextEdit(range=_lsp_range(place, source), new_text=new.text)]


def choices_of(options: Any, given: Choices, root_uri: str | None) -> Choices:
    """What a workspace says (`cell`, `dialect`, `subroutines`, `out`), over what the command line says.

    Paths are from the folder of the workspace. A cell from which code would run is never asked for here.
    """
    if not isinstance(options, dict):
        return given
    root = Path(uris.to_fs_path(root_uri) or ".") if root_uri else Path()
    path: Callable[[Any], Path | None] = lambda text: root / text if isinstance(text, str) and text else None  # noqa: E731
    folders = [root / one for one in options.get("subroutines") or () if isinstance(one, str)]
    dialect = options.get("dialect")
    return Choices(
        cell=path(options.get("cell")) or given.cell,
        dialect=dialect if isinstance(dialect, str) and _is_dialect(dialect) else given.dialect,
        subroutines=(*given.subroutines, *folders),
        allow_paths=given.allow_paths,
        out=path(options.get("out")) or given.out,
    )


def _is_dialect(name: str) -> bool:
    from gcodesim.rs274.dialects import DIALECTS

    return name in DIALECTS
