import type { Theme } from "vitepress";
import DefaultTheme from "vitepress/theme-without-fonts";
import Live from "./Live.vue";
import "./style.css";

export default {
  extends: DefaultTheme,
  enhanceApp({ app }) {
    app.component("Live", Live);
    if (!import.meta.env.SSR) settle();
  },
} satisfies Theme;

/**
 * Makes relative addresses absolute. Menus and the icon stay when another page is shown without loading it,
 * and it may lie in another folder.
 */
function settle(): void {
  const links = 'a[href]:not([href^="#"]), link[rel="icon"]';
  for (const link of document.querySelectorAll<HTMLAnchorElement | HTMLLinkElement>(links)) {
    link.href = String(link.href);
  }
  for (const image of document.querySelectorAll("img")) image.src = String(image.src);
}
