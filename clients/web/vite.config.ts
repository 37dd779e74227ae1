import { defineConfig } from "vitest/config";
import { licences } from "./licences";

// The server for `npm run dev`. The built editor uses the server that serves it.
const server = process.env.SUPPLE_SERVER ?? "http://127.0.0.1:8080";
const proxied = ["/v1", "/healthz", "/readyz", "/openapi.yaml"];

export default defineConfig({
  base: "./",
  plugins: [licences("licences.txt")],
  assetsInclude: ["**/*.obj"],
  server: {
    proxy: Object.fromEntries(proxied.map((path) => [path, server])),
    fs: { allow: ["../.."] },
  },
  build: {
    target: "es2022",
    // Pictures and meshes stay files, because the server's content security policy forbids data URLs.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
  },
  test: { include: ["test/**/*.test.ts"], environment: "node", setupFiles: ["test/setup.ts"] },
});
