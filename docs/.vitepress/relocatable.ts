/**
 * Makes a site that works from any folder of any host. VitePress wants to know that folder when it builds; it
 * is told `BASE`, and every place where that appears says it relative to itself instead.
 */

import type { Plugin } from "vitepress";

/** Stands for the site's folder. */
export const BASE = "/__site__/";

/** The site's folder as a page's scripts see it, from the page's data. */
const AT_RUN_TIME = "__VP_SITE_DATA__.base";

/** A page's HTML, `path` its place in the site. */
export function relocate(html: string, path: string): string {
  const root = "../".repeat(path.split("/").length - 1) || "./";
  // What is not an attribute is within the string that the page's data are parsed from.
  return html
    .replaceAll(`="${BASE}`, `="${root}`)
    .replaceAll(BASE, `"+new URL("${root}",location.href).pathname+"`);
}

/** Has scripts and styles name each other relative to themselves, and look up the site's folder. */
export const relocatable: Plugin = {
  name: "relocatable",
  apply: "build",
  enforce: "post",
  config(_config, { isSsrBuild }) {
    // What Node renders is relocated as HTML.
    if (isSsrBuild) return;
    return {
      define: { "import.meta.env.BASE_URL": AT_RUN_TIME },
      experimental: { renderBuiltUrl: () => ({ relative: true }) },
    };
  },
  /** The search index is one string with the addresses of all pages. */
  transform(code, id) {
    if (!id.startsWith("/@localSearchIndex") || !code.includes(BASE)) return;
    return `${code.replace(/;?\s*$/, "")}.replaceAll("${BASE}", ${AT_RUN_TIME})`;
  },
};
