import { describe, expect, it } from 'vitest';
import { fromHash, isIncomplete, toHash } from '../src/link';
import { type Linked, START } from '../src/state';

const FULL: Linked = {
  ...START,
  source: {
    kind: 'table',
    table: {
      convention: 'khalil',
      units: { angle: 'deg' },
      joints: [{ alpha: 'pi/2', d: '0,4', theta: 'q1', r: 0 }],
    },
  },
  angle: 'rad',
  q: [0.1, -2, 1e-7],
  euler: 'xyz',
  reference: 'local',
  task: 'xy_phi',
  digits: 9,
  open: ['pose', 'path'],
  view: {
    frames: 'ends',
    dimensions: true,
    ellipsoid: 'both',
    lost: false,
    cloud: true,
    other: 'ur5',
  },
  row: 2,
  step: 3,
  target: { position: [0.1, 0.2, 0.3], rpy: [0, 1, 2] },
  kept: [
    [1, 2],
    [3, 4],
  ],
  path: { ...START.path, obstacles: [{ type: 'sphere', center: [1, 2, 3], radius: 0.5 }] },
};

describe('a link', () => {
  it('holds the whole state', async () => {
    expect(await fromHash(`#${await toHash(FULL)}`)).toEqual(FULL);
  });

  it('is short and readable for a robot of the library', async () => {
    const hash = await toHash({ ...START, q: [0, 45, -90.5] });
    expect(hash).toBe('robot=puma560&q=0,45,-90.5');
  });

  it('holds a URDF', async () => {
    const urdf: Linked = {
      ...START,
      source: { kind: 'urdf', name: 'é', urdf: '<robot name="é"/>' },
    };
    expect((await fromHash(await toHash(urdf))).source).toEqual(urdf.source);
  });

  it('says so where a robot is too long for it', async () => {
    const noise = Array.from({ length: 40_000 }, (_, k) =>
      String.fromCharCode(33 + (((k * k * 7919) >> 5) % 90)),
    ).join('');
    const hash = await toHash({ ...START, source: { kind: 'urdf', name: 'long', urdf: noise } });
    expect(hash.length).toBeLessThan(1000);
    expect([isIncomplete(`#${hash}`), isIncomplete('#robot=puma560')]).toEqual([true, false]);
  });

  it.each([
    'q=1,x',
    'table=%%%',
    'table=AAAA',
    'angle=gon',
    'digits=99',
    'euler=<b>',
    'row=0',
    'view=,,:',
    'open=',
    '&&&=',
  ])('of nonsense gives the start: %s', async (hash) => {
    const state = await fromHash(`#${hash}`);
    expect({ ...state, open: START.open, view: START.view }).toEqual(START);
  });
});
