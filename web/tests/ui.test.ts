import { describe, expect, test } from "vitest";
import { keyName, keyOf } from "../src/shortcuts";
import { fixed, large, list, short } from "../src/ui/format";
import { fromShare, places, type Scale, toShare, written } from "../src/ui/scale";

describe("numbers for people", () => {
  test("short", () => {
    expect([0, 0.25, -1234.56, 1e-5, 123456, Number.NaN].map((x) => short(x))).toEqual([
      "0",
      "0.25",
      "−1235",
      "1e−5",
      "123500",
      "–",
    ]);
  });
  test("large", () => {
    expect([0, 999, 2_512_345, 7.1e9].map(large)).toEqual(["0", "999", "2.51 M", "7.1 G"]);
  });
  test("lists", () => {
    expect(list([0.1, -2, 3])).toBe("0.1, −2, 3");
    expect(fixed([-0.0001, -2, 3.25], 3)).toBe("0.000, −2.000, 3.250");
  });
});

describe("scales of sliders", () => {
  const linear: Scale = { min: -20, max: 20, logarithmic: false, integer: false };
  const powers: Scale = { min: 0.001, max: 1000, logarithmic: true, integer: false };
  const fromZero: Scale = { min: 0, max: 1000, logarithmic: true, integer: false };
  const whole: Scale = { min: 1, max: 30, logarithmic: false, integer: true };

  test("ends are ends", () => {
    for (const scale of [linear, powers, fromZero, whole]) {
      expect(fromShare(scale, 0)).toBe(scale.min);
      expect(fromShare(scale, 1)).toBe(scale.max);
      expect(toShare(scale, scale.min)).toBe(0);
      expect(toShare(scale, scale.max)).toBe(1);
      expect(toShare(scale, 1e9)).toBe(1);
    }
  });
  test("the middle of a logarithmic scale is the geometric mean", () => {
    expect(fromShare(powers, 0.5)).toBe(1);
    expect(toShare(powers, 1)).toBeCloseTo(0.5);
  });
  test("values are round, and whole where they are to be", () => {
    expect(places(linear)).toBe(400);
    expect(fromShare(linear, 133 / 400)).toBe(-6.7);
    expect(fromShare(whole, 0.5)).toBe(16);
  });
  test("a value's place gives the value again", () => {
    for (const value of [0.002, 0.05, 7, 410])
      expect(fromShare(powers, toShare(powers, value))).toBeCloseTo(value, 9);
    for (const value of [-19.5, 0, 3.2])
      expect(fromShare(linear, toShare(linear, value))).toBeCloseTo(value, 9);
  });
  test("a key moves a slider on from every place, and back", () => {
    const forms: Scale[] = [linear, powers, fromZero, whole];
    // Gravity, time step, substeps, limits in degrees, controls, and what does not divide.
    const ranges: [number, number][] = [
      [-30, 30],
      [1e-5, 0.1],
      [1, 100],
      [-45, 68.75],
      [-180, 180],
      [-0.4, 0.4],
      [0.05, 50.05],
      [0.3, 0.7],
      [-1 / 3, 1000 / 7],
      [0, 501],
      [0, 1499],
    ];
    for (const [min, max] of ranges) {
      forms.push({ min, max, integer: false, logarithmic: false });
      if (min >= 0) forms.push({ min, max, integer: false, logarithmic: true });
      if (Number.isInteger(min) && Number.isInteger(max))
        forms.push({ min, max, integer: true, logarithmic: false });
    }
    for (const scale of forms) {
      const all = places(scale);
      for (let place = 0; place <= all; place++) {
        const value = fromShare(scale, place / all);
        // What the engine says of it puts the thumb where it was.
        expect(Math.round(toShare(scale, value) * all), `${value} of ${JSON.stringify(scale)}`).toBe(place);
      }
    }
  });
  test("an empty range is no division by zero", () => {
    expect(toShare({ ...linear, min: 1, max: 1 }, 1)).toBe(0);
  });
  test("digits are as fine as the scale", () => {
    expect(written({ ...linear, min: -0.4, max: 0.4 }, -0.00843441)).toBe("-0.0084");
    expect(written(linear, -9.81)).toBe("-9.81");
    expect(written(powers, 0.00123456)).toBe("0.0012346");
  });
});

describe("keys", () => {
  const press = (key: string, code = "", shiftKey = false) => keyOf({ key, code, shiftKey });
  test("letters whatever the case, shifted ones told apart", () => {
    expect(press("n")).toBe("n");
    expect(press("N")).toBe("n");
    expect(press("N", "KeyN", true)).toBe("Shift+n");
  });
  test("a shifted digit is that digit on every keyboard", () => {
    expect(press("!", "Digit1", true)).toBe("Shift+1");
    expect(press("1", "Digit1")).toBe("1");
  });
  test("signs are what they say", () => {
    expect(press("?", "Slash", true)).toBe("?");
    expect(press("+", "Equal", true)).toBe("+");
    expect(press("=", "Equal")).toBe("+");
    expect(press("ArrowUp", "ArrowUp", true)).toBe("Shift+ArrowUp");
  });
  test("names", () => {
    expect(["+", "Shift+n", " ", "Shift+ArrowUp", "Escape"].map(keyName)).toEqual([
      "+",
      "Shift+N",
      "Space",
      "Shift+↑",
      "Esc",
    ]);
  });
});
