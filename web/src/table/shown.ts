/** The table that is shown. */
import type { TableDocument } from '../api';
import type { State } from '../state';

/** The table being typed, or that of the robot; null where the robot has none. */
export function shownTable({ source, model }: State): TableDocument | null {
  return source.kind === 'table' ? source.table : (model?.table ?? null);
}
