/** Conversions between tables and URDF; nothing is stored. */
import type { Call } from './call';
import type { AngleUnit, Convention, TableDocument } from './types';

/** The query's unit of angles; without one the service computes in rad. */
export function angleQuery(angle: AngleUnit): Readonly<Record<string, string>> {
  return angle === 'deg' ? { angle } : {};
}

/** A table in numbers, checked, and in the convention `to`. */
export const convertTable = (
  table: TableDocument,
  to: Convention,
  angle: AngleUnit,
): Call<TableDocument> => ({
  method: 'POST',
  path: 'v1/convert-dh',
  query: { to, ...angleQuery(angle) },
  body: table,
});

export const tableToURDF = (table: TableDocument): Call<string> => ({
  method: 'POST',
  path: 'v1/dh-to-urdf',
  query: {},
  body: table,
  accept: 'application/xml',
});

export const urdfToTable = (
  urdf: string,
  convention: Convention,
  angle: AngleUnit,
): Call<TableDocument> => ({
  method: 'POST',
  path: 'v1/urdf-to-dh',
  query: { convention, ...angleQuery(angle) },
  body: urdf,
  type: 'application/xml',
});
