/** Edits of the table that is shown: it becomes the robot of the page. */
import * as api from '../api';
import { reasonOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import { carried, movingRows } from './document';
import { editable, sendable } from './exchange';
import { shownTable } from './shown';

export type Edit = (document: api.TableDocument) => api.TableDocument;

/**
 * Replace the table; joints keep their values, and the chosen row stays chosen.
 *
 * @param kind What is edited, for undo.
 */
export function replaceTable(page: Page, document: api.TableDocument, kind: string): void {
  const { store, history } = page;
  const { q, row, model } = store.state;
  const before = shownTable(store.state);
  const rows = before ? movingRows(before) : [];
  const joints = before && rows.length === q.length ? rows : (model?.joints ?? []);
  const name = row === null ? undefined : before?.joints[row]?.name;
  const found = document.joints.findIndex((one) => one.name === name);
  history.change(
    {
      source: { kind: 'table', table: document },
      ...(joints.length === q.length && { q: carried(joints, document, q) }),
      row: row === null || found < 0 ? null : found,
    },
    kind,
  );
}

/** Apply an edit to the table that is shown. */
export function editTable(page: Page, kind: string, edit: Edit): void {
  const document = shownTable(page.store.state);
  if (document) replaceTable(page, edit(document), kind);
}

/** Show a row by its elementary motions; a URDF gives way to its table, which has their frames. */
export function chooseRow(
  page: Page,
  change: { readonly row: number | null; readonly step: number },
): void {
  const { state } = page.store;
  const document = shownTable(state);
  if (document && state.model?.kind === 'urdf' && state.source.kind !== 'table') {
    replaceTable(page, document, 'row');
    page.tell(t.tableShown);
  }
  page.history.change(change, 'row');
}

/**
 * Describe the same arm in another convention; the service converts the table.
 *
 * @returns Whether it could.
 */
export async function convertTo(page: Page, convention: api.Convention): Promise<boolean> {
  const { source, angle } = page.store.state;
  if (source.kind === 'stored') {
    page.history.change({ source: { ...source, convention } }, 'convention');
    return true;
  }
  try {
    const table = await api.json(
      source.kind === 'table'
        ? api.convertTable(
            sendable({ name: 'table', ...source.table }),
            convention,
            source.table.units?.angle ?? 'rad',
          )
        : api.urdfToTable(source.urdf, convention, angle),
    );
    page.history.change({ source: { kind: 'table', table: editable(table) } }, 'convention');
    return true;
  } catch (error) {
    page.tell(reasonOf(error), true);
    return false;
  }
}
