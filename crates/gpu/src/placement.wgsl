// Writes the columns of some worlds.

struct Launch {
    // Worlds whose columns are written, numbers of each, worlds of the part.
    count: u32,
    numbers: u32,
    width: u32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<storage, read> worlds: array<u32>;
@group(0) @binding(3) var<uniform> launch: Launch;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    // A launch has not as many workgroups as there may be worlds.
    for (var i = id.x; i < launch.count; i += 64u * groups.x) {
        for (var number = 0u; number < launch.numbers; number++) {
            state[number * launch.width + worlds[i]] = columns[number * launch.count + i];
        }
    }
}
