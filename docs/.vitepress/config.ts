import { rm } from "node:fs/promises";
import { basename, join } from "node:path";
import { type DefaultTheme, defineConfig } from "vitepress";
import { type Example, gallery } from "./gallery";
import { BASE, relocatable, relocate } from "./relocatable";

const REPOSITORY = "https://github.com/kinetarium/kinetarium";
/** Made by rustdoc, which is beside these pages and not of them. */
const API = { link: "/api/kinetarium/index.html", target: "_self" };

const guide: DefaultTheme.SidebarItem[] = [
  { text: "First picture", link: "/guide/first-picture" },
  { text: "The page", link: "/guide/page" },
  { text: "Python", link: "/guide/python" },
  { text: "A robot file", link: "/guide/robot-file" },
  { text: "Thousands of worlds", link: "/guide/worlds" },
  { text: "On a graphics card", link: "/guide/graphics-card" },
  { text: "Controls and outputs", link: "/guide/controls" },
  { text: "Building a model", link: "/guide/building" },
  { text: "Contacts and materials", link: "/guide/contacts" },
  { text: "Events", link: "/guide/events" },
  { text: "Rays and nearby shapes", link: "/guide/queries" },
  { text: "Sensors", link: "/guide/sensors" },
  { text: "Snapshots", link: "/guide/snapshots" },
  { text: "Cameras", link: "/guide/cameras" },
  { text: "Gymnasium", link: "/guide/gymnasium" },
  { text: "Learning", link: "/guide/learning" },
];

const concepts: DefaultTheme.SidebarItem[] = [
  { text: "Units and conventions", link: "/concepts/conventions" },
  { text: "Model, worlds, simulation", link: "/concepts/simulation" },
  { text: "Solvers", link: "/concepts/solvers" },
  { text: "Contacts", link: "/concepts/contacts" },
  { text: "Determinism", link: "/concepts/determinism" },
  { text: "Kernels", link: "/concepts/kernels" },
];

const examples: DefaultTheme.SidebarItem[] = gallery.map(({ name, title }) => ({
  text: title,
  link: `/examples/${name}`,
}));

export default defineConfig({
  title: "Kinetarium",
  description:
    "A physics engine for actions: articulated bodies that move, in thousands of worlds side by side.",
  base: BASE,
  outDir: "../target/site",
  srcExclude: ["e2e/**"],
  // Beside the site when it is complete; `npm run e2e` looks whether they are there.
  ignoreDeadLinks: [/\/api\//, /\/live\//],
  head: [
    ["meta", { name: "color-scheme", content: "light dark" }],
    ["link", { rel: "icon", href: `${BASE}logo.svg` }],
  ],
  markdown: {
    codeTransformers: [{ preprocess: (code, { lang }) => (lang === "rust" ? withoutHidden(code) : code) }],
  },
  vite: { plugins: [relocatable] },
  // A page of an example has its title from the gallery.
  transformPageData: ({ params }) =>
    params ? { title: params.title, description: params.about } : undefined,
  transformHtml: (html, _path, { page }) => relocate(html, page),
  // A page for addresses that are not there cannot know how deep they are.
  buildEnd: ({ outDir }) => rm(join(outDir, "404.html")),
  themeConfig: {
    logo: "/logo.svg",
    nav: [
      { text: "Guide", link: "/guide/first-picture", activeMatch: "/guide/" },
      { text: "Concepts", link: "/concepts/conventions", activeMatch: "/concepts/" },
      { text: "Examples", link: "/examples/", activeMatch: "/examples/" },
      { text: "Benchmarks", link: "/benchmarks" },
      { text: "API", ...API },
    ],
    sidebar: [
      { text: "Guide", items: guide },
      { text: "Concepts", items: concepts },
      { text: "Examples", link: "/examples/", collapsed: true, items: examples },
      {
        text: "Reference",
        items: [
          { text: "API", ...API },
          { text: "Benchmarks", link: "/benchmarks" },
        ],
      },
    ],
    outline: { level: [2, 3] },
    socialLinks: [{ icon: "github", link: REPOSITORY }],
    search: { provider: "local", options: { miniSearch: { _splitIntoSections: sections } } },
  },
});

/** Lines that rustdoc compiles and does not show. */
function withoutHidden(code: string): string {
  const lines = code.split("\n");
  return lines.filter((line) => line !== "#" && !line.startsWith("# ")).join("\n");
}

/** What to find an example by: its page has no file. Of any other page nothing, so that it is read itself. */
function sections(path: string) {
  const example = gallery.find(({ name }) => basename(path) === `${name}.md` && path.includes("examples/"));
  return example && [section(example)];
}

function section({ title, about, guide }: Example) {
  return { anchor: "", titles: [title], text: `${about}. ${guide}` };
}
