// Compiles a source file for a test: node 20 reads no TypeScript.
import { build } from "esbuild";

export async function load(path) {
  const made = await build({ entryPoints: [new URL(`../src/${path}`, import.meta.url).pathname], bundle: true, format: "esm", write: false });
  return import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].contents).toString("base64")}`);
}
