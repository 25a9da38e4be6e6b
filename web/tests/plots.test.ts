import { describe, expect, test } from "vitest";
import { History } from "../src/plots/history";
import { padded, ticks } from "../src/plots/ticks";

describe("ticks", () => {
  test("are round and within the range", () => {
    expect(ticks(0, 1, 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
    expect(ticks(-7, 12, 4)).toEqual([-5, 0, 5, 10]);
    expect(ticks(3, 3, 4)).toEqual([3]);
  });
  test("a range is never empty", () => {
    expect(padded(2, 2)).toEqual([1.9, 2.1]);
    expect(padded(0, 0)).toEqual([-1, 1]);
    expect(padded(-7e-44, 3e-44)).toEqual([-1, 1]);
    expect(padded(20, 20.000001)[1]).toBeCloseTo(21);
    expect(padded(Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY)).toEqual([0, 1]);
  });
});

describe("history", () => {
  function filled(count: number): History {
    const history = new History();
    history.choose([7, 9]);
    for (let i = 0; i < count; i++) history.push(i, [i, 10 - i]);
    return history;
  }

  test("keeps samples by quantity", () => {
    const history = filled(3);
    expect(history.times).toEqual([0, 1, 2]);
    expect(history.values(9)).toEqual([10, 9, 8]);
    expect(history.values(8)).toEqual([]);
  });
  test("what is chosen anew has no past, what stays keeps its own", () => {
    const history = filled(2);
    history.choose([9, 8]);
    expect(history.values(9)).toEqual([10, 9]);
    expect(history.values(8)).toEqual([Number.NaN, Number.NaN]);
    history.push(2, [5, 6]);
    expect(history.values(8)[2]).toBe(6);
  });
  test("a sample of an earlier time is a new branch", () => {
    const history = filled(5);
    history.push(2, [20, 21]);
    expect(history.times).toEqual([0, 1, 2]);
    expect(history.values(7)).toEqual([0, 1, 20]);
  });
  test("cuts what is later", () => {
    const history = filled(5);
    history.cut(2);
    expect(history.times).toEqual([0, 1, 2]);
    expect(history.values(7).length).toBe(3);
  });
  test("finds the last sample that is not later", () => {
    const history = filled(4);
    expect([-1, 0, 1.5, 3, 99].map((time) => history.at(time))).toEqual([-1, 0, 1, 3, 3]);
  });
  test("is bounded, and spans all the time", () => {
    const history = filled(50_000);
    expect(history.times.length).toBeLessThanOrEqual(8192);
    expect(history.times[0]).toBe(0);
    expect(history.times.at(-1)).toBeGreaterThan(49_900);
    expect(history.values(7)).toEqual(history.times);
  });
});
