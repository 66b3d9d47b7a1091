/** Robots that the service has stored, one function an endpoint. */
import { type Call, robotPath } from './call';
import { angleQuery } from './tables';
import type { AngleUnit, Convention, MeshLine, RobotLine, RobotView, TableDocument } from './types';

export const listRobots = (): Call<{ robots: readonly RobotLine[] }> => ({
  method: 'GET',
  path: 'v1/robots',
  query: { page_size: '1000' },
});

export const readRobot = (id: string): Call<RobotView> => ({
  method: 'GET',
  path: robotPath(id),
  query: {},
});

export const listMeshes = (id: string): Call<{ meshes: readonly MeshLine[] }> => ({
  method: 'GET',
  path: robotPath(id, 'meshes'),
  query: {},
});

export const readURDF = (id: string): Call<string> => ({
  method: 'GET',
  path: robotPath(id, 'urdf'),
  query: {},
  accept: 'application/xml',
});

export const readTable = (
  id: string,
  convention: Convention,
  angle: AngleUnit,
): Call<TableDocument> => ({
  method: 'GET',
  path: robotPath(id, 'dh'),
  query: { convention, ...angleQuery(angle) },
});
