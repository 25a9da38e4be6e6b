import { expect, test } from "vitest";
import { type Address, emptyAddress, formatAddress, parseAddress } from "../src/address";

const full: Address = {
  example: "pendula",
  build: { links: 5 },
  physics: { gravity: -1.62, substeps: 4 },
  replicas: { first: 3, count: 4 },
  viewpoint: { target: [0, 1.5, -0.25], yaw: 0.6, pitch: 0.35, distance: 7.5 },
  carrier: { mount: "follow", body: 2, world: null, gaze: null },
};

test("an address is read as it was written", () => {
  const hash = formatAddress(full);
  expect(hash).toBe(
    "example=pendula&build.links=5&physics.gravity=-1.62&physics.substeps=4&replicas=3,4" +
      "&view=0,1.5,-0.25,0.6,0.35,7.5&follow=2",
  );
  expect(parseAddress(`#${hash}`)).toEqual(full);
});

test("a body's eyes are told with its replica, and how they look", () => {
  const gaze = { yaw: -1.5708, pitch: 0.25, field: 35 };
  const carrier = { mount: "ride", body: 2, world: 7, gaze } as const;
  const hash = formatAddress({ ...emptyAddress(), carrier });
  expect(hash).toBe("ride=2,7,-1.5708,0.25,35");
  expect(parseAddress(hash).carrier).toEqual(carrier);
  expect(parseAddress("follow=2,7").carrier).toEqual({ mount: "follow", body: 2, world: 7, gaze: null });
});

test("names may hold what addresses do not", () => {
  const address = { ...emptyAddress(), example: "a&b=c d,e", build: { "x.y": 1 } };
  expect(parseAddress(formatAddress(address))).toEqual(address);
});

test("what is not understood is left out", () => {
  const hash =
    "#build.links=many&physics.=1&replicas=-1,2&replicas=1&replicas=0,0&view=1,2,3,4,5,0&ride=x&follow=1.5&new=1";
  expect(parseAddress(hash)).toEqual(emptyAddress());
  expect(parseAddress("")).toEqual(emptyAddress());
});
