import { describe, expect, it } from 'vitest';
import type { TableDocument } from '../src/api';
import {
  addRow,
  carried,
  constantOf,
  moveRow,
  readAs,
  removeRow,
  setType,
  variableCell,
} from '../src/table/document';
import { editable, sendable } from '../src/table/exchange';

const TABLE: TableDocument = {
  convention: 'standard',
  units: { angle: 'deg', length: 'm' },
  joints: [
    { name: 'j1', type: 'revolute', alpha: 90, a: 0, d: 0.4, theta: 0, offset: 0, sign: 1 },
    { name: 'j2', type: 'revolute', alpha: 0, a: 0.3, d: 0, theta: 0, offset: -90, sign: -1 },
    { name: 'j3', type: 'prismatic', alpha: 0, a: 0, d: 0, theta: 0, offset: 0.1, sign: 1 },
    { name: 'end', type: 'fixed', alpha: 0, a: 0, d: 0.2, theta: 0, offset: 0, sign: 1 },
  ],
};

describe('a table as it is edited', () => {
  it('has the variable in its own column, with what were offset and sign', () => {
    const { joints } = editable(TABLE);
    expect(joints.map((row) => [row.theta, row.d])).toEqual([
      ['q1', 0.4],
      ['-q2 - 90', 0],
      [0, 'q3 + 0.1'],
      [0, 0.2],
    ]);
    expect(joints.every((row) => !('offset' in row) && !('sign' in row))).toBe(true);
  });

  it('numbers the variables by rows when rows move', () => {
    const moved = moveRow(editable(TABLE), 2, 0);
    expect(moved.joints.map((row) => [row.name, row.theta, row.d])).toEqual([
      ['j3', 0, 'q1 + 0.1'],
      ['j1', 'q2', 0.4],
      ['j2', '-q3 - 90', 0],
      ['end', 0, 0.2],
    ]);
    expect(moveRow(moved, 0, 2)).toEqual(editable(TABLE));
    expect(moveRow(moved, 0, -1)).toBe(moved);
  });

  it('adds rows with a name that is free, and removes them again', () => {
    const more = addRow(editable(TABLE), 0);
    expect(more.joints.map((row) => row.name)).toEqual(['j1', 'j5', 'j2', 'j3', 'end']);
    expect(more.joints[2]?.theta).toBe('-q3 - 90');
    expect(removeRow(more, 1)).toEqual(editable(TABLE));
  });

  it('moves the variable with the type and leaves its constant', () => {
    const slides = setType(editable(TABLE), 1, 'prismatic');
    expect([slides.joints[1]?.theta, slides.joints[1]?.d]).toEqual(['-90', 'q2']);
    const fixed = setType(editable(TABLE), 2, 'fixed');
    expect(fixed.joints[2]?.d).toBe('0.1');
  });

  it('is sent without what is empty', () => {
    const sent = sendable({
      ...TABLE,
      name: '',
      joints: [{ type: 'revolute', a: '', alpha: '0', limits: { lower: '', upper: '2' } }],
    });
    expect(sent.joints).toEqual([{ type: 'revolute', alpha: '0', limits: { upper: '2' } }]);
    expect('name' in sent).toBe(false);
  });

  it('shows a placement that does not turn as a point', () => {
    const shift = [
      [1, 0, 0, 0.1],
      [0, 1, 0, 0.2],
      [0, 0, 1, 0.3],
      [0, 0, 0, 1],
    ];
    const turn = [
      [-1, 0, 0, 0],
      [0, -1, 0, 0],
      [0, 0, 1, 0],
      [0, 0, 0, 1],
    ];
    const shown = editable({ ...TABLE, tool: { matrix: shift }, base: { matrix: turn } });
    expect(shown.tool).toEqual({ xyz: [0.1, 0.2, 0.3], rpy: [0, 0, 0] });
    expect(shown.base).toEqual({ matrix: turn });
  });
});

describe('the same numbers read in another convention', () => {
  it("become Khalil's d and r, and come back", () => {
    const khalil = readAs(editable(TABLE), 'khalil');
    expect(khalil.joints.map((row) => [row.theta, row.r, row.d, row.a])).toEqual([
      ['q1', 0.4, 0, undefined],
      ['-q2 - 90', 0, 0.3, undefined],
      [0, 'q3 + 0.1', 0, undefined],
      [0, 0.2, 0, undefined],
    ]);
    expect(readAs(khalil, 'standard')).toEqual(editable(TABLE));
  });
});

describe('a cell with a variable', () => {
  it.each([
    [0, 1, 0, 'q1'],
    [2, -1, 0, '-q3'],
    [1, 1, 'pi/2', 'q2 + pi/2'],
    [1, -1, -0.5, '-q2 - 0.5'],
  ] as const)('is written from %s, %s, %s', (index, sign, constant, text) => {
    expect(variableCell(index, sign, constant)).toBe(text);
  });

  it.each([
    ['q2 - pi/2', '-pi/2'],
    ['-q2 + 90', '90'],
    ['θ1', '0'],
    ['q3 + 0.1', '0.1'],
    ['', '0'],
  ] as const)('%s leaves %s', (cell, constant) => {
    expect(constantOf(cell)).toBe(constant);
  });
});

describe('values of the joints', () => {
  const moving = TABLE.joints.slice(0, 3);

  it('go with their rows', () => {
    expect(carried(moving, moveRow(editable(TABLE), 2, 0), [1, 2, 3])).toEqual([3, 1, 2]);
    expect(carried(moving, addRow(editable(TABLE), 0), [1, 2, 3])).toEqual([1, 0, 2, 3]);
    expect(carried(moving, removeRow(editable(TABLE), 1), [1, 2, 3])).toEqual([1, 3]);
  });

  it('are not taken from an angle to a length', () => {
    expect(carried(moving, setType(editable(TABLE), 0, 'prismatic'), [1, 2, 3])).toEqual([0, 2, 3]);
    expect(carried(moving, setType(editable(TABLE), 0, 'continuous'), [1, 2, 3])).toEqual([
      1, 2, 3,
    ]);
    expect(carried(moving, setType(editable(TABLE), 1, 'fixed'), [1, 2, 3])).toEqual([1, 3]);
  });
});

it('variables with Greek names are numbered by rows, too', () => {
  const joints = ['θ1', '-θ_2 + 90', 'pi/2 - theta3'].map((theta, k) => ({
    name: `j${k}`,
    type: 'R',
    a: 0,
    alpha: 0,
    d: 0,
    theta,
  }));
  const moved = moveRow({ ...TABLE, joints }, 2, 0);
  expect(moved.joints.map((row) => row.theta)).toEqual(['pi/2 - theta1', 'θ2', '-θ_3 + 90']);
});
