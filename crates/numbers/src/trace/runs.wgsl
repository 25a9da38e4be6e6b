// One invocation works on one member of a run: worlds of a kind of their own, such as contacts. A member's number at an
// offset lies at offset * worlds + world, where `worlds` is how many there is room for.
@group(0) @binding(0) var<storage, read_write> state: array<f32>;
// Of each member, the rows of two bodies; 0xffffffff where it is left out.
@group(0) @binding(1) var<storage, read> seats: array<u32>;
// Of each run, its first member and how many it has.
@group(0) @binding(2) var<storage, read_write> runs: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> scratch: array<f32>;
@group(0) @binding(4) var<storage, read> parameters: array<f32>;
@group(0) @binding(5) var<storage, read> links: array<u32>;
@group(0) @binding(6) var<uniform> launch: Launch;

struct Launch {
    worlds: u32,
    // Which run.
    run: u32,
    // How many bodies there are.
    bodies: u32,
}
