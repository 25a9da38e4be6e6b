// One invocation steps one world, then those that lie whole launches beyond it. A world's number at an offset lies at
// offset * worlds + world, or so in a piece of a few, so that neighbouring invocations read neighbours.
@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read> input: array<f32>;
@group(0) @binding(2) var<storage, read_write> output: array<f32>;
@group(0) @binding(3) var<storage, read_write> scratch: array<f32>;
@group(0) @binding(4) var<storage, read> parameters: array<f32>;
@group(0) @binding(5) var<storage, read> links: array<u32>;
@group(0) @binding(6) var<uniform> launch: Launch;

struct Launch {
    worlds: u32,
    // How often each invocation runs the kernel.
    rounds: u32,
}
