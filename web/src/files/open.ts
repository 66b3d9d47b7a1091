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

/** Media types of the files whose endings say what they are. */
const TYPES: Record<string, string> = {
  yaml: 'application/yaml',
  yml: 'application/yaml',
  json: 'application/json',
  csv: 'text/csv',
  par: 'text/x-symoro',
};
const URDF = /^\s*(<\?xml[^>]*>\s*)?(<!--[\s\S]*?-->\s*)*<robot\b/;
/** Kind of a refusal because a robot of that name is stored already. */
const TAKEN = 'robot-exists';
const CONVENTION = /["']?convention["']?\s*:\s*["']?([\w-]+)/i;

/** Open a URDF, or a table in any of its formats. */
export async function openFile(page: Page, file: File): Promise<void> {
  const [, name = 'robot', suffix = ''] = /^(.*?)\.?([^.]*)$/.exec(file.name) ?? [];
  const ending = suffix.toLowerCase();
  const type = TYPES[ending];
  try {
    if (ending === 'zip') return await openArchive(page, name, file);
    const text = await file.text();
    if (ending === 'urdf' || ending === 'xml' || URDF.test(text)) await openURDF(page, name, text);
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

async function openURDF({ store, history }: Page, name: string, urdf: string): Promise<void> {
  const source = { kind: 'urdf', name, urdf } as const;
  // A file that cannot be used leaves the page as it is.
  await resolve(source, store.state.angle, new AbortController().signal);
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
