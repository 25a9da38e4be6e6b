// Sums over the things of each world: of some of them in each invocation, one after the other, then of these sums.

struct Sum {
    // Where the first number of the first thing stands, and how far it is to the next number of that.
    at: u32,
    stride: u32,
    // Things of a world, worlds, and numbers of a thing.
    own: u32,
    worlds: u32,
    numbers: u32,
}

@group(0) @binding(0) var<storage, read_write> terms: array<f32>;
@group(0) @binding(1) var<storage, read_write> sums: array<f32>;
@group(0) @binding(2) var<uniform> sum: Sum;

@compute @workgroup_size(64)
fn add(@builtin(global_invocation_id) id: vec3<u32>) {
    let parts = (sum.own + SUMMED - 1u) / SUMMED;
    let count = sum.worlds * parts;
    if (id.x >= count * sum.numbers) {
        return;
    }
    let number = id.x / count;
    let world = id.x % count / parts;
    let first = id.x % parts * SUMMED;
    let start = sum.at + number * sum.stride + world * sum.own;
    var all = 0.0;
    for (var i = first; i < min(first + SUMMED, sum.own); i++) {
        all += terms[start + i];
    }
    sums[id.x] = all;
}
