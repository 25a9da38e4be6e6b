import { viteSingleFile } from "vite-plugin-singlefile";
import { defineConfig } from "vitest/config";

export default defineConfig({
  // Relative, since the page is served from any folder: a server's root, a chapter of the documentation.
  base: "./",
  plugins: [viteSingleFile({ removeViteModuleLoader: true })],
  build: { target: "es2023", chunkSizeWarningLimit: 2000 },
  worker: { format: "es" },
  test: { include: ["tests/**/*.test.ts"] },
});
