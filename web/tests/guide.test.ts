import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { keys } from "../src/keys";
import type { Page } from "../src/page";

test("the guide has all keys", () => {
  const guide = readFileSync(new URL("../../docs/guide/page.md", import.meta.url), "utf8");
  const told = [...guide.matchAll(/^\| (?:`|arrows)[^|]*\| ([^|]*) \|$/gm)].map(([, help]) => help);
  // Until the table after this one, of the address.
  const helps = keys({} as Page).map(({ help }) => help);
  expect(told.slice(0, helps.length)).toEqual(helps);
});
