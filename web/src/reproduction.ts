/** A call as a command for a terminal and as a program: it sends what the page has sent. */
import { type Call, urlOf } from './api';

/** JSON in ASCII, which every terminal's encoding can print. */
function ascii(value: unknown): string {
  return JSON.stringify(value).replace(
    /[\u007f-\uffff]/g,
    (one) => `\\u${one.charCodeAt(0).toString(16).padStart(4, '0')}`,
  );
}

/** Variable of the environment that stands for the key, which no command and no program holds. */
const KEY = 'DENAVIT_KEY';

/** @param keyed Whether the service asks for a key. */
export function asCurl(call: Call, keyed = false): string {
  const parts = ['curl -s'];
  if (keyed) parts.push(`-H "X-API-Key: $${KEY}"`);
  if (call.method !== 'GET' && call.method !== 'POST') parts.push(`-X ${call.method}`);
  if (call.accept) parts.push(`-H ${shell(`Accept: ${call.accept}`)}`);
  if (call.body !== undefined) {
    // curl before 7.82, as in Ubuntu 22.04, has no --json.
    parts.push(`-H 'Content-Type: application/json' -d ${shell(ascii(call.body))}`);
  }
  parts.push(shell(urlOf(call)));
  return parts.join(' ');
}

/** Quote a text for sh, bash and zsh. */
function shell(text: string): string {
  return `'${text.replaceAll("'", String.raw`'\''`)}'`;
}

export function asHttpx(call: Call, keyed = false): string {
  const named = [`    "${urlOf({ ...call, query: {} })}",`];
  if (Object.keys(call.query).length) named.push(`    params=${python(call.query)},`);
  if (call.body !== undefined) named.push(`    json=${python(call.body)},`);
  const headers = [
    ...(call.accept ? [`"Accept": ${python(call.accept)}`] : []),
    ...(keyed ? [`"X-API-Key": os.environ["${KEY}"]`] : []),
  ];
  if (headers.length) named.push(`    headers={${headers.join(', ')}},`);
  return [
    ...(keyed ? ['import os', ''] : []),
    'import httpx',
    '',
    `answer = httpx.${call.method.toLowerCase()}(`,
    ...named,
    ')',
    'answer.raise_for_status()',
    'print(answer.json())',
  ].join('\n');
}

/** A value as a Python literal. */
export function python(value: unknown): string {
  if (value === null || value === undefined) return 'None';
  if (value === true) return 'True';
  if (value === false) return 'False';
  if (typeof value === 'number') return String(value);
  if (typeof value === 'string') return ascii(value);
  if (Array.isArray(value)) return `[${value.map(python).join(', ')}]`;
  const entries = Object.entries(value).filter(([, one]) => one !== undefined);
  return `{${entries.map(([key, one]) => `${ascii(key)}: ${python(one)}`).join(', ')}}`;
}

export function asPowerShell(call: Call, keyed = false): string {
  const quoted = (text: string): string => `'${text.replaceAll("'", "''")}'`;
  const parts = [`Invoke-RestMethod -Method ${call.method} -Uri ${quoted(urlOf(call))}`];
  if (call.body !== undefined) {
    parts.push(`-ContentType 'application/json' -Body ${quoted(ascii(call.body))}`);
  }
  const headers = [
    ...(call.accept ? [`Accept=${quoted(call.accept)}`] : []),
    ...(keyed ? [`'X-API-Key'=$env:${KEY}`] : []),
  ];
  if (headers.length) parts.push(`-Headers @{${headers.join('; ')}}`);
  return `${parts.join(' `\n  ')} |\n  ConvertTo-Json -Depth 20`;
}
