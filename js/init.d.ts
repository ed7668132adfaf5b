export * from './index.js';

/** Loads the module. Without `source`, from the file halfspace.wasm of the package, which
 * bundlers copy. It can be another URL, or the bytes of the file. A call before the promise is
 * fulfilled throws. Further calls return the same promise, unless it was rejected. */
export function init(source?: string | URL | Uint8Array | ArrayBuffer): Promise<void>;
