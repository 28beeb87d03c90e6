// Starts `gcodesim lsp` and connects the editor with it; all answers come from there.
'use strict';

const vscode = require('vscode');
const { LanguageClient, TransportKind } = require('vscode-languageclient/node');

const SECTION = 'gcodesim';
const TOLD = ['cell', 'dialect', 'subroutines', 'out'];

let client;

/** What the workspace says, as the server reads it. */
function choices() {
  const settings = vscode.workspace.getConfiguration(SECTION);
  return Object.fromEntries(TOLD.map((name) => [name, settings.get(name)]));
}

function newClient() {
  const settings = vscode.workspace.getConfiguration(SECTION);
  const [command, ...args] = settings.get('command');
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  const server = { command, args, transport: TransportKind.stdio, options: { cwd: folder } };
  const cells = settings.get('cells').map((pattern) => ({ scheme: 'file', language: 'yaml', pattern }));
  return new LanguageClient(SECTION, 'gcodesim', server, {
    documentSelector: [{ scheme: 'file', language: 'gcode' }, ...cells],
    initializationOptions: choices(),
  });
}

async function start() {
  client = newClient();
  try {
    await client.start();
  } catch (error) {
    const command = vscode.workspace.getConfiguration(SECTION).get('command').join(' ');
    vscode.window.showErrorMessage(
      `\`${command}\` did not start: ${error.message}. Install it with: pip install 'gcodesim[lsp]', ` +
        'or say in gcodesim.command where it is.',
    );
  }
}

async function restart() {
  await client?.stop();
  await start();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand('gcodesim.restart', restart),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration(SECTION) && restart()),
  );
  await start();
}

function deactivate() {
  return client?.stop();
}

module.exports = { activate, deactivate };
