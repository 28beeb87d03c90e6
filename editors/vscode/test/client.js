// The extension with the client of Visual Studio Code, under node, against the server: `npm test`.
// GCODESIM is the command, where it is not on the path.
'use strict';

const assert = require('assert');
const fs = require('fs');
const Module = require('module');
const os = require('os');
const path = require('path');
const { editorWith } = require('./editor.js');

const PROGRAM = 'G21 G90\nG1 X5\no<loch> sub\no<loch> endsub\nGO X1\nM2\n';
const LONGEST_MS = 60000;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'gcodesim-'));
fs.writeFileSync(path.join(folder, 'part.nc'), PROGRAM);
const editor = editorWith(folder, 'part.nc', { command: [process.env.GCODESIM || 'gcodesim', 'lsp'], cells: ['**/cell.yaml'] });

const load = Module._load;
Module._load = (name, ...rest) => (name === 'vscode' ? editor.vscode : load(name, ...rest));
const { LanguageClient } = require('vscode-languageclient/node');
const extension = require('../extension.js');

let client;
const start = LanguageClient.prototype.start;
LanguageClient.prototype.start = function () {
  client = this;
  return start.call(this);
};

async function test() {
  await extension.activate({ subscriptions: [] });
  const until = Date.now() + LONGEST_MS;
  while (!editor.shown.length && Date.now() < until) await new Promise((go) => setTimeout(go, 50));
  const found = editor.shown.at(-1).map((one) => [one.code, one.range.start.line]);
  assert.deepStrictEqual(found, [['GS107', 1], ['GS136', 2], ['GS004', 4]]);

  const place = { textDocument: { uri: editor.uri }, position: { line: 1, character: 1 } };
  const hover = await client.sendRequest('textDocument/hover', place);
  assert.match(hover.contents.value, /straight move at feed/);
  const offers = await client.sendRequest('textDocument/completion', place);
  assert.ok(offers.items.some((one) => one.label === 'G17'));
  const parts = await client.sendRequest('textDocument/documentSymbol', { textDocument: place.textDocument });
  assert.deepStrictEqual(parts.map((one) => one.name), ['o<loch>']);
  for (const what of ['Hover', 'CompletionItem', 'Definition', 'Rename', 'CodeLens', 'DocumentFormattingEdit'])
    assert.ok(editor.offered.has(`register${what}Provider`), what);
  await extension.deactivate();
}

test()
  .then(() => console.log('1 passed, 0 failed'))
  .catch((error) => {
    console.error(error);
    process.exitCode = 1;
  })
  .finally(() => {
    fs.rmSync(folder, { recursive: true });
    process.exit();
  });
