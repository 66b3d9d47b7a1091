/** The workspace of a robot as a cloud of points. */
import * as api from '../api';
import type { Model } from '../model';

const POINTS = 20_000;

/** Positions of the tip over its workspace, m: x, y, z, x, y, z … */
export async function cloudOf(model: Model, signal: AbortSignal): Promise<Float32Array> {
  const response = await api.send(api.workspace(model.ref, POINTS), signal);
  return Float32Array.from(readNpy(await response.arrayBuffer()));
}

/** Numbers of an npy file: little-endian doubles behind a header that gives its own length. */
function readNpy(buffer: ArrayBuffer): Float64Array {
  const header = new DataView(buffer);
  const isLong = header.getUint8(6) > 1;
  const start = isLong ? 12 + header.getUint32(8, true) : 10 + header.getUint16(8, true);
  return new Float64Array(buffer.slice(start));
}
