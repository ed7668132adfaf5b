// Ready when init() has ended. The module is a file of its own.
import { imports, start } from './bvh.js';

let started;

export function init(source = new URL('./halfspace.wasm', import.meta.url)) {
  started ??= load(source).catch((error) => {
    started = undefined;
    throw error;
  });
  return started;
}

async function load(source) {
  let bytes = source;
  if (typeof source === 'string' || source instanceof URL) {
    const response = await fetch(source);
    if (!response.ok) throw new Error(`${response.url}: ${response.status}`);
    bytes = await response.arrayBuffer();
  }
  start((await WebAssembly.instantiate(bytes, imports)).instance);
}

export { BVH, HalfspaceError, NO_ID, TriangleMesh, version } from './bvh.js';
