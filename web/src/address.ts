import type { Values } from "./protocol";
import type { Carrier, Viewpoint } from "./view/camera_rig";

/** What the page's address tells of it, after the `#`, so that it can be shared. */
export interface Address {
  example: string | null;
  /** Values other than the example's own. */
  build: Values;
  physics: Values;
  /** First replica shown, and how many. */
  replicas: { first: number; count: number } | null;
  viewpoint: Viewpoint | null;
  /** `follow` or `ride`: its body, and where told, its replica, and how one looks with its eyes. */
  carrier: Carrier | null;
}

export function emptyAddress(): Address {
  return { example: null, build: {}, physics: {}, replicas: null, viewpoint: null, carrier: null };
}

/** Reads an address; what in it is not understood is left out. */
export function parseAddress(hash: string): Address {
  const address = emptyAddress();
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ""))) {
    const [group, name] = key.split(/\.(.*)/s);
    const numbers = value.split(",").map(Number);
    const finite = value !== "" && numbers.every(Number.isFinite);
    if (key === "example") address.example = value;
    else if ((group === "build" || group === "physics") && name && finite) address[group][name] = numbers[0];
    else if (
      key === "replicas" &&
      finite &&
      numbers.length === 2 &&
      numbers.every(isCount) &&
      numbers[1] > 0
    ) {
      address.replicas = { first: numbers[0], count: numbers[1] };
    } else if (key === "view" && finite && numbers.length === 6 && numbers[5] > 0) {
      const [x, y, z, yaw, pitch, distance] = numbers;
      address.viewpoint = { target: [x, y, z], yaw, pitch, distance };
    } else if ((key === "follow" || key === "ride") && finite && numbers.slice(0, 2).every(isCount)) {
      const [body, world = null, ...gaze] = numbers;
      const [yaw, pitch, field] = gaze;
      address.carrier = { mount: key, body, world, gaze: gaze.length === 3 ? { yaw, pitch, field } : null };
    }
  }
  return address;
}

export function formatAddress(address: Address): string {
  const parts: [string, string][] = [];
  if (address.example !== null) parts.push(["example", address.example]);
  for (const group of ["build", "physics"] as const) {
    for (const [name, value] of Object.entries(address[group]))
      parts.push([`${group}.${name}`, String(value)]);
  }
  const { replicas, viewpoint, carrier } = address;
  if (replicas) parts.push(["replicas", `${replicas.first},${replicas.count}`]);
  if (viewpoint) {
    const { target, yaw, pitch, distance } = viewpoint;
    parts.push(["view", [...target, yaw, pitch, distance].map(brief).join(",")]);
  }
  if (carrier) {
    const { mount, body, world, gaze } = carrier;
    const where = world === null ? [] : [world];
    const how = gaze && world !== null ? [gaze.yaw, gaze.pitch, gaze.field].map(brief) : [];
    parts.push([mount, [body, ...where, ...how].join(",")]);
  }
  // Commas and dots may stay as they are after a hash.
  return parts.map(([key, value]) => `${key}=${encodeURIComponent(value).replaceAll("%2C", ",")}`).join("&");
}

function brief(value: number): number {
  return Number(value.toPrecision(5));
}

function isCount(value: number): boolean {
  return Number.isInteger(value) && value >= 0;
}
