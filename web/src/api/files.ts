/** Robots in and out: tables as text, and robots to store. */
import type { Call } from './call';
import type { AngleUnit, Convention, LengthUnit, RobotView, TableDocument } from './types';

/** Formats in which the service writes a table. */
export type Format = 'yaml' | 'json' | 'csv' | 'markdown' | 'latex' | 'matlab' | 'par' | 'tsv';

/** A call that answers a table, changed to ask for its text in a format. */
export function asText(call: Call<TableDocument>, format: Format): Call<string> {
  const request = call as Call<never>;
  if (format === 'json') return request;
  return { ...request, query: { ...request.query, format }, accept: '*/*' };
}

/** The table in a file's text, as of its media type. */
export const readTableFile = (
  file: string,
  type: string,
  query: Readonly<Record<string, string>>,
): Call<TableDocument> => ({ method: 'POST', path: 'v1/convert-dh', query, body: file, type });

/** What a pasted text leaves open; '' for what the text says itself. */
export interface PasteOptions {
  readonly convention: Convention;
  readonly angle: AngleUnit | '';
  readonly length: LengthUnit;
  /** Numbers for names: `L1:0.4,L2:300mm`. */
  readonly values: string;
  /** Columns of a table without a heading: `theta,d,a,alpha`. */
  readonly columns: string;
}

/** A table pasted as Markdown, LaTeX, MATLAB, Python or columns, or a workbook with one. */
export const readPasted = (
  pasted: string | Blob,
  { convention, angle, length, values, columns }: PasteOptions,
): Call<TableDocument> => ({
  method: 'POST',
  path: 'v1/convert-dh',
  query: {
    to: convention,
    convention,
    name: 'table',
    ...(angle ? { angle } : {}),
    ...(length === 'mm' ? { length } : {}),
    ...(values ? { values } : {}),
    ...(columns ? { columns } : {}),
  },
  body: pasted,
  type: typeof pasted === 'string' ? 'text/plain' : pasted.type,
});

/** Store the robot of a zip with its meshes; refused where the name is taken. */
export const createFromArchive = (name: string, archive: Blob): Call<RobotView> => ({
  method: 'POST',
  path: 'v1/robots',
  query: { name },
  body: archive,
  type: 'application/zip',
});

/** Store a robot on the service; refused where the name is taken, unless it may overwrite. */
export const createRobot = (
  name: string,
  document: TableDocument | string,
  overwrite: boolean,
): Call<RobotView> => ({
  method: 'POST',
  path: 'v1/robots',
  query: {
    ...(typeof document === 'string' ? { name } : {}),
    ...(overwrite ? { overwrite: 'true' } : {}),
  },
  body: document,
  ...(typeof document === 'string' ? { type: 'application/xml' } : {}),
});
