import { execFileSync } from 'node:child_process';
import { describe, expect, it } from 'vitest';
import { computation, type TableDocument } from '../src/api';
import { asCurl, asHttpx, asPowerShell, python } from '../src/reproduction';

const TABLE: TableDocument = {
  name: "it's θ",
  convention: 'standard',
  joints: [{ type: 'R', alpha: '90°', a: 1, d: 0 }],
};

describe('a request to be run elsewhere', () => {
  it('is a GET that reads well for a robot of the library', () => {
    const call = computation('fk', { id: 'puma560' }, { q: [0, 45.5], euler: 'ZXZ' }, 'deg');
    expect(asCurl(call)).toBe(
      "curl -s 'http://service.test/lab/v1/robots/puma560/fk?q=0,45.5&euler=ZXZ&angle=deg'",
    );
  });

  it('survives the shell, quotes and all', () => {
    const call = computation('fk', { table: TABLE }, { q: [1] });
    const printed = execFileSync('sh', [
      '-c',
      asCurl(call).replace('curl -s', "printf '%s\\n'"),
    ]).toString();
    const [header, type, data, body, url] = printed.trim().split('\n');
    expect([header, type, data, url]).toEqual([
      '-H',
      'Content-Type: application/json',
      '-d',
      'http://service.test/lab/v1/fk',
    ]);
    expect(JSON.parse(body ?? '')).toEqual({ q: [1], robot: TABLE });
    expect([...printed].every((one) => one.charCodeAt(0) < 127)).toBe(true);
  });

  it('is Python that Python reads', () => {
    const value = { a: [1, 2.5, null, true], b: { c: 'it\'s "θ"' } };
    const program = `import json; print(json.dumps(${python(value)}))`;
    expect(JSON.parse(execFileSync('python3', ['-c', program]).toString())).toEqual(value);
    expect(asHttpx(computation('fk', { table: TABLE }, { q: [1] }))).toContain('httpx.post(');
  });

  it('doubles single quotes for PowerShell', () => {
    expect(asPowerShell(computation('fk', { table: TABLE }, { q: [1] }))).toContain("it''s");
  });
});

it('names the key by a variable, and never holds it', () => {
  const call = computation('fk', { id: 'puma560' }, { q: [0] }, 'deg', 'text/plain');
  expect(asCurl(call, true)).toContain('-H "X-API-Key: $DENAVIT_KEY"');
  expect(asHttpx(call, true)).toContain('"X-API-Key": os.environ["DENAVIT_KEY"]');
  expect(asHttpx(call, true)).toContain('import os');
  expect(asPowerShell(call, true)).toContain(
    "-Headers @{Accept='text/plain'; 'X-API-Key'=$env:DENAVIT_KEY}",
  );
  for (const form of [asCurl, asHttpx, asPowerShell]) expect(form(call)).not.toContain('KEY');
});
