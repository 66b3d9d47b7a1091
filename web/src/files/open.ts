/** Opens a file with a robot; of all files only a zip, with its meshes, is stored on the service. */
import { json, Refusal } from '../api';
import { createFromArchive, readTableFile } from '../api/files';
import { NEW_ROBOT } from '../examples';
import { reasonsOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import { resolve } from '../resolve';
import { editable } from '../table/exchange';
import { shownTable } from '../table/shown';
import { faultsDialog } from './faults';

/** Media types of the files whose endings say what they are. */
const TYPES: Record<string, string> = {
  yaml: 'application/yaml',
  yml: 'application/yaml',
  json: 'application/json',
  csv: 'text/csv',
  par: 'text/x-symoro',
};
/** Workbooks, by their endings. */
const WORKBOOKS: Record<string, string> = {
  xlsx: 'application/vnd.openxmlformats-officedocument.spreadsheetml.sheet',
  ods: 'application/vnd.oasis.opendocument.spreadsheet',
};
const URDF = /^\s*(<\?xml[^>]*>\s*)?(<!--[\s\S]*?-->\s*)*<robot\b/;
/** Kind of a refusal because a robot of that name is stored already. */
const TAKEN = 'robot-exists';
const CONVENTION = /["']?convention["']?\s*:\s*["']?([\w-]+)/i;

/** Open a URDF, a workbook, or a table in any of its formats. */
export async function openFile(page: Page, file: File): Promise<void> {
  const [, name = 'robot', suffix = ''] = /^(.*?)\.?([^.]*)$/.exec(file.name) ?? [];
  const ending = suffix.toLowerCase();
  const type = TYPES[ending];
  const workbook = WORKBOOKS[ending];
  if (workbook) {
    const { pasteDialog } = await import('../table/paste');
    pasteDialog(page, new File([file], file.name, { type: workbook }), true);
    return;
  }
  try {
    if (ending === 'zip') return await openArchive(page, name, file);
    const text = textOf(await file.arrayBuffer());
    if (ending === 'urdf' || ending === 'xml' || URDF.test(text))
      await openURDF(page, file.name, name, text);
    else if (type) await openTable(page, name, text, type);
    else {
      const { pasteDialog } = await import('../table/paste');
      pasteDialog(page, text, true);
    }
  } catch (error) {
    page.tell(reasonsOf(error, '; '), true);
  }
}

async function openArchive({ history, tell }: Page, name: string, file: File): Promise<void> {
  try {
    const { id } = await json(createFromArchive(name, file));
    history.change({ ...NEW_ROBOT, source: { kind: 'stored', id, convention: null } }, 'open');
    tell(t.saved(id));
  } catch (error) {
    if (!(error instanceof Refusal) || error.kind !== TAKEN) throw error;
    tell(t.nameTaken(name), true);
  }
}

/**
 * The text of a file: UTF-8, UTF-16 with its mark, what an XML declaration says, or Windows-1252.
 *
 * The declaration of an encoding is left out, as the text is sent in UTF-8.
 */
function textOf(content: ArrayBuffer): string {
  const start = new Uint8Array(content.slice(0, 200));
  const declared = /^\s*<\?xml[^>]*?\sencoding=["']([\w-]+)/.exec(
    String.fromCharCode(...start),
  )?.[1];
  const marked = start[0] === 0xff && start[1] === 0xfe ? 'utf-16le' : null;
  const turned = start[0] === 0xfe && start[1] === 0xff ? 'utf-16be' : null;
  for (const encoding of [marked ?? turned ?? declared ?? 'utf-8', 'utf-8']) {
    try {
      const text = new TextDecoder(encoding, { fatal: true }).decode(content);
      return text.replace(/^(\s*<\?xml[^>]*?)\s+encoding=("[^"]*"|'[^']*')/, '$1');
    } catch {
      // Not in this encoding, or one that the browser does not know: the next is tried.
    }
  }
  return new TextDecoder('windows-1252').decode(content);
}

async function openURDF(page: Page, file: string, name: string, urdf: string): Promise<void> {
  const { store, history } = page;
  const source = { kind: 'urdf', name, urdf } as const;
  try {
    // A file that cannot be used leaves the page as it is.
    await resolve(source, store.state.angle, new AbortController().signal);
  } catch (error) {
    if (!(error instanceof Refusal) || !error.errors.some((one) => one.line)) throw error;
    faultsDialog(file, urdf, error);
    return;
  }
  history.change({ ...NEW_ROBOT, source }, 'open');
}

async function openTable(
  { store, history }: Page,
  name: string,
  text: string,
  type: string,
): Promise<void> {
  const { state } = store;
  const isSymoro = type === 'text/x-symoro';
  const stated = CONVENTION.exec(text)?.[1];
  const to = isSymoro ? 'khalil' : (stated ?? shownTable(state)?.convention ?? 'standard');
  const call = readTableFile(text, type, {
    to,
    angle: state.angle,
    ...(type === 'text/csv' && { convention: to }),
    ...(!isSymoro && { name: name.replace(/[^\w.-]+/g, '-') || 'table' }),
  });
  const table = editable(await json(call));
  history.change({ ...NEW_ROBOT, source: { kind: 'table', table } }, 'open');
}
