/** Between the state and the URL's hash: short values readable, documents compressed. */
import type { AngleUnit, Convention, ReferenceFrame, TableDocument } from './api';
import { type Linked, type Section, START, type View } from './state';

/** Longest compressed document in a link, characters; a longer one must be stored first. */
const MAX_DOCUMENT = 12_000;

const LEFT_OUT = 'left-out';

/** Whether a hash says that its robot was too long for it. */
export function isIncomplete(hash: string): boolean {
  return new URLSearchParams(hash.replace(/^#/, '')).has(LEFT_OUT);
}

/** Write a state as a hash, without '#'; values of START are left out. */
export async function toHash(state: Linked): Promise<string> {
  const parts: [string, string][] = [];
  const put = (name: string, value: string, start: string): void => {
    if (value !== start) parts.push([name, value]);
  };
  const { source } = state;
  if (source.kind === 'stored') {
    parts.push(['robot', source.id]);
    put('convention', source.convention ?? '', '');
  } else {
    const packed = await pack(source.kind === 'table' ? source.table : source);
    if (packed.length <= MAX_DOCUMENT) parts.push([source.kind, packed]);
    else parts.push([LEFT_OUT, source.kind]);
  }
  put('q', state.q.join(','), '');
  put('angle', state.angle, START.angle);
  put('euler', state.euler, START.euler);
  put('reference', state.reference, START.reference);
  put('task', state.task, START.task);
  put('digits', String(state.digits), String(START.digits));
  put('open', state.open.join(','), START.open.join(','));
  if (state.row !== null) parts.push(['row', `${state.row + 1},${state.step}`]);
  put('view', viewText(state.view), viewText(START.view));
  if (state.kept.length) parts.push(['kept', state.kept.map((q) => q.join(',')).join(';')]);
  if (state.target) parts.push(['target', await pack(state.target)]);
  if (state.path !== START.path) parts.push(['path', await pack(state.path)]);
  return parts.map(([name, value]) => `${name}=${readable(value)}`).join('&');
}

/** Read the state of a hash; what is missing or cannot be read is that of START. */
export async function fromHash(hash: string): Promise<Linked> {
  const given = new URLSearchParams(hash.replace(/^#/, '').replaceAll('+', '%2B'));
  const text = (name: string): string => given.get(name) ?? '';
  let state: Linked = START;
  const put = (change: Partial<Linked>): void => {
    state = { ...state, ...change };
  };
  if (text('robot')) {
    const convention = text('convention') as Convention | '';
    put({ source: { kind: 'stored', id: text('robot'), convention: convention || null } });
  }
  const table = await unpack<TableDocument>(text('table'));
  if (isTable(table)) put({ source: { kind: 'table', table } });
  const urdf = await unpack<{ name: string; urdf: string }>(text('urdf'));
  if (typeof urdf?.urdf === 'string') {
    put({ source: { kind: 'urdf', name: String(urdf.name), urdf: urdf.urdf } });
  }
  const q = numbers(text('q'));
  if (q) put({ q });
  if (['rad', 'deg'].includes(text('angle'))) put({ angle: text('angle') as AngleUnit });
  if (/^[xyz]{3}$/i.test(text('euler'))) put({ euler: text('euler') });
  if (['world', 'local'].includes(text('reference'))) {
    put({ reference: text('reference') as ReferenceFrame });
  }
  if (/^\w+$/.test(text('task'))) put({ task: text('task') });
  const digits = Number(text('digits'));
  if (Number.isInteger(digits) && digits >= 1 && digits <= 12) put({ digits });
  if (given.has('open')) put({ open: text('open').split(',').filter(Boolean) as Section[] });
  const row = /^(\d+),([0-4])$/.exec(text('row'));
  if (row) put({ row: Number(row[1]) - 1, step: Number(row[2]) });
  if (text('view')) put({ view: readView(text('view')) });
  const kept = text('kept') ? text('kept').split(';').map(numbers) : [];
  put({ kept: kept.filter((one) => one !== null) });
  const target = await unpack<Linked['target']>(text('target'));
  if (target && Object.values(target).every(Array.isArray)) put({ target });
  const path = await unpack<Linked['path']>(text('path'));
  if (path && Array.isArray(path.obstacles)) put({ path: { ...START.path, ...path } });
  return state;
}

function isTable(given: TableDocument | null): given is TableDocument {
  return (
    given !== null &&
    ['standard', 'modified', 'khalil'].includes(given.convention) &&
    Array.isArray(given.joints) &&
    given.joints.every((row) => typeof row === 'object' && row !== null)
  );
}

function viewText(view: View): string {
  const parts: string[] = [`frames:${view.frames}`];
  if (view.dimensions) parts.push('dimensions');
  if (view.ellipsoid !== 'none') parts.push(`ellipsoid:${view.ellipsoid}`);
  if (!view.lost) parts.push('nolost');
  if (view.cloud) parts.push('cloud');
  if (view.other) parts.push(`other:${view.other}`);
  return parts.join(',');
}

function readView(text: string): View {
  const parts = new Map(text.split(',').map((one) => [one.split(':')[0], one.split(':')[1] ?? '']));
  const of = <T extends string>(name: string, choices: readonly T[], other: T): T =>
    choices.find((one) => one === parts.get(name)) ?? other;
  return {
    frames: of('frames', ['none', 'ends', 'all'], START.view.frames),
    dimensions: parts.has('dimensions'),
    ellipsoid: of('ellipsoid', ['none', 'velocity', 'force', 'both'], 'none'),
    lost: !parts.has('nolost'),
    cloud: parts.has('cloud'),
    other: parts.get('other') ?? '',
  };
}

function numbers(text: string): number[] | null {
  const found = text.split(',').map(Number);
  return text && found.every(Number.isFinite) ? found : null;
}

function readable(text: string): string {
  return encodeURIComponent(text).replaceAll(/%2C|%3A|%3B/gi, decodeURIComponent);
}

async function pack(value: unknown): Promise<string> {
  const stream = new Blob([JSON.stringify(value)]).stream();
  const packed = stream.pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

async function unpack<T>(text: string): Promise<T | null> {
  if (!text) return null;
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (one) =>
      one.charCodeAt(0),
    );
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
    return JSON.parse(await new Response(plain).text()) as T;
  } catch {
    return null;
  }
}
