import { type Example, gallery } from "../.vitepress/gallery";

declare const data: Example[];

export { data };

export default { load: () => gallery };
