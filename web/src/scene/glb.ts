/** Meshes as the service writes those that were uploaded: binary glTF, one mesh, few colours. */
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
} from 'three';
import { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const GREY = 0xb8c0c8;
/** Edges sharper than this stay edges, rad. */
const CREASE = 0.6;
const HEAD = 20;
const UINT32 = 5125;

interface View {
  readonly byteOffset: number;
}

interface Accessor {
  readonly bufferView: number;
  readonly componentType: number;
  readonly count: number;
}

interface Primitive {
  readonly attributes: { readonly POSITION: number };
  readonly indices: number;
  readonly material?: number;
}

interface Document {
  readonly accessors: readonly Accessor[];
  readonly bufferViews: readonly View[];
  readonly meshes: readonly [{ readonly primitives: readonly Primitive[] }];
  readonly materials?: readonly {
    readonly pbrMetallicRoughness: {
      readonly baseColorFactor: readonly [number, number, number, number];
    };
  }[];
}

/** The mesh of a file; one without colours takes that of the URDF. */
export function meshOf(file: ArrayBuffer): Object3D {
  const length = new DataView(file).getUint32(12, true);
  const text = new TextDecoder().decode(new Uint8Array(file, HEAD, length));
  const document = JSON.parse(text) as Document;
  const start = HEAD + length + 8;
  const parts = document.meshes[0].primitives.map((one) => partOf(document, file, start, one));
  const [first] = parts;
  if (first && parts.length === 1 && !document.materials) return first;
  return new Group().add(...parts);
}

function partOf(document: Document, file: ArrayBuffer, start: number, part: Primitive): Mesh {
  const at = (number: number): { accessor: Accessor; offset: number } => {
    const accessor = document.accessors[number];
    const view = accessor && document.bufferViews[accessor.bufferView];
    if (!accessor || !view) throw new Error('a mesh without its numbers');
    return { accessor, offset: start + view.byteOffset };
  };
  const { accessor, offset } = at(part.attributes.POSITION);
  const positions = new Float32Array(file, offset, 3 * accessor.count);
  const of = at(part.indices);
  const Numbers = of.accessor.componentType === UINT32 ? Uint32Array : Uint16Array;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(new Numbers(file, of.offset, of.accessor.count), 1));
  return new Mesh(toCreasedNormals(geometry, CREASE), materialOf(document, part.material));
}

function materialOf(document: Document, number: number | undefined): MeshLambertMaterial {
  const given = number === undefined ? undefined : document.materials?.[number];
  if (!given) return new MeshLambertMaterial({ color: GREY, side: DoubleSide });
  const [r, g, b, opacity] = given.pbrMetallicRoughness.baseColorFactor;
  const color = new Color(r, g, b);
  return new MeshLambertMaterial({ color, opacity, transparent: opacity < 1, side: DoubleSide });
}
