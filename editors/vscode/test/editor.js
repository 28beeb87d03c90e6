// A stand-in for the module `vscode`, as far as vscode-languageclient asks for it: one open document, and a list of
// what is shown. What nothing here depends on is a class without content or an event that never comes.
'use strict';

const fs = require('fs');
const path = require('path');

const nothing = () => ({ dispose() {} });
const otherwise = (known, value) => new Proxy(known, { get: (of, name) => (name in of ? of[name] : value(name)) });

class Position {
  constructor(line, character) {
    Object.assign(this, { line, character });
  }
}

class Range {
  constructor(...places) {
    const [a, b, c, d] = places;
    Object.assign(this, places.length === 4 ? { start: new Position(a, b), end: new Position(c, d) } : { start: a, end: b });
  }
}

class Uri {
  constructor(text) {
    const [, scheme, place] = /^(\w+):\/\/(.*)$/.exec(text);
    Object.assign(this, { text, scheme, path: decodeURIComponent(place), fsPath: decodeURIComponent(place) });
  }
  static parse = (text) => new Uri(text);
  static file = (name) => new Uri(`file://${name}`);
  toString() {
    return this.text;
  }
}

class EventEmitter {
  event = nothing;
  fire() {}
  dispose() {}
}

class Diagnostic {
  constructor(range, message, severity) {
    Object.assign(this, { range, message, severity });
  }
}

class CancellationTokenSource {
  token = { isCancellationRequested: false, onCancellationRequested: nothing };
  cancel() {}
  dispose() {}
}

/** The editor with one program open; `shown` gets what is published, `offered` the names of what the client offers. */
exports.editorWith = (folder, name, settings) => {
  const shown = [];
  const offered = new Set();
  const file = path.join(folder, name);
  const text = fs.readFileSync(file, 'utf8');
  const document = { uri: Uri.file(file), languageId: 'gcode', version: 1, fileName: file, getText: () => text };
  const output = otherwise({ append: (said) => process.stderr.write(said) }, () => (said) => console.error(said));
  const known = {
    Position, Range, Uri, EventEmitter, Diagnostic, CancellationTokenSource, CancellationError: Error,
    Disposable: { from: nothing }, version: '1.82.0', env: { language: 'en', appName: 'trial' }, extensions: { getExtension() {} },
    commands: { registerCommand: nothing },
    window: otherwise(
      { createOutputChannel: () => output, visibleTextEditors: [], tabGroups: { all: [], onDidChangeTabs: nothing },
        showErrorMessage: async (said) => { throw new Error(said); } },
      () => nothing,
    ),
    workspace: otherwise(
      { textDocuments: [document], notebookDocuments: [], isTrusted: true, getWorkspaceFolder() {},
        workspaceFolders: [{ uri: Uri.file(folder), name: 'folder', index: 0 }],
        getConfiguration: () => ({ get: (key) => settings[key] }) },
      () => nothing,
    ),
    languages: otherwise(
      { match: (selector, asked) => Number([selector].flat().some((one) => one.language === asked.languageId)),
        createDiagnosticCollection: () => ({ set: (uri, found) => shown.push(found), delete() {}, dispose() {} }) },
      (what) => (offered.add(what), nothing),
    ),
  };
  const words = (kind) => otherwise(class {}, (word) => (word === 'Empty' ? { append: () => words(kind) } : word));
  const vscode = new Proxy(known, {
    get: (of, what) => (what in of ? of[what] : (of[what] = /(Kind|Tag|Reason|Severity)$/.test(what) ? words(what) : class {})),
  });
  return { vscode, shown, offered, uri: document.uri.toString() };
};
