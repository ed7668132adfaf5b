// Ready when it is imported: the text becomes a module without a promise. Browsers that forbid
// this on their main thread need init.js.
import { imports, start } from './bvh.js';
import base64 from './module.js';

function decoded() {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// The functions of node and of new browsers, as far as there are any, take a tenth of the time.
const bytes = globalThis.Buffer?.from(base64, 'base64') ?? Uint8Array.fromBase64?.(base64)
  ?? decoded();
start(new WebAssembly.Instance(new WebAssembly.Module(bytes), imports));

export { BVH, HalfspaceError, NO_ID, TriangleMesh, version } from './bvh.js';
