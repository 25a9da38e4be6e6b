import { gallery } from "../.vitepress/gallery";

export default {
  paths: () => gallery.map((example) => ({ params: example })),
};
