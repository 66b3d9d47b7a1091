/** The meshes that the service has for a robot. */
import { LoadingManager, Mesh, MeshLambertMaterial, type Object3D } from 'three';
import { json, listMeshes, type MeshLine, send } from '../api';
import { meshOf } from './glb';

/** What the service keeps of every mesh that was uploaded. */
const GLB = 'model/gltf-binary';

/** A mesh that the URDF names. */
export interface WantedMesh {
  readonly url: string;
  /** Puts the mesh into its link. */
  readonly done: (mesh: Object3D) => void;
}

export interface LoadedMesh {
  readonly mesh: Object3D;
  readonly done: (mesh: Object3D) => void;
}

/**
 * Load those meshes that the service has.
 *
 * @param isNeeded Whether the robot is still shown once the service has answered.
 */
export async function loadMeshes(
  robotId: string,
  wanted: readonly WantedMesh[],
  isNeeded: () => boolean,
): Promise<LoadedMesh[]> {
  const { meshes } = await json(listMeshes(robotId));
  const found = new Map(meshes.map((one) => [pathOf(one.filename), one]));
  if (!isNeeded()) return [];
  const loading = wanted.flatMap(({ url, done }) => {
    const line = found.get(pathOf(url));
    return line === undefined ? [] : [meshAt(line).then((mesh) => ({ mesh, done }))];
  });
  return Promise.all(loading);
}

/** The path of a package's file, without the slashes and scheme in front, which loaders change. */
function pathOf(url: string): string {
  return url.replace(/^package:\/+/, '').replace(/^\/+/, '');
}

async function meshAt({ href, media_type }: MeshLine): Promise<Object3D> {
  const file = await send({ method: 'GET', path: href, query: {}, accept: '*/*' });
  if (media_type === GLB) return meshOf(await file.arrayBuffer());
  const suffix = href.toLowerCase().split('.').at(-1);
  if (suffix === 'stl') {
    const { STLLoader } = await import('three/examples/jsm/loaders/STLLoader.js');
    const geometry = new STLLoader().parse(await file.arrayBuffer());
    return new Mesh(geometry, new MeshLambertMaterial({ color: 0xb8c0c8 }));
  }
  // The service has no textures and no material files: a blank pixel stands for each.
  const manager = new LoadingManager();
  manager.setURLModifier(() => BLANK);
  if (suffix === 'obj') {
    const { OBJLoader } = await import('three/examples/jsm/loaders/OBJLoader.js');
    return new OBJLoader(manager).parse(await file.text());
  }
  const { ColladaLoader } = await import('three/examples/jsm/loaders/ColladaLoader.js');
  const text = await file.text();
  // A URDF takes the file's own axes, but the loader turns a file whose z is up: it is told y.
  const found = new ColladaLoader(manager).parse(text.replace('>Z_UP<', '>Y_UP<'), '');
  const { scene } = found as { scene: Object3D };
  for (const child of [...scene.children]) {
    if ('isLight' in child || 'isCamera' in child) scene.remove(child);
  }
  return scene;
}

const BLANK =
  'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mP8/x8AAwMCAO+ip1sAAAAASUVORK5CYII=';
