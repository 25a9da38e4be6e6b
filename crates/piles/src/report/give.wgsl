// The numbers that things are told of by: what the state has of each, then its constants. To lanes, `[number][thing]`.

struct Told {
    // The first of these things, counted through all worlds, and how many they are.
    first: u32,
    count: u32,
    // How many a world has, and numbers of its state.
    own: u32,
    state_numbers: u32,
    // Constants of each, and how many sets of them a world has: 0 where all worlds share one.
    constants: u32,
    sets: u32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> given: array<f32>;
// How long the ranges of a thing are; then, of each thing of a world, where these begin.
@group(0) @binding(2) var<storage, read> places: array<u32>;
@group(0) @binding(3) var<storage, read> constants: array<f32>;
@group(0) @binding(4) var<uniform> told: Told;

@compute @workgroup_size(64)
fn give(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= told.count) {
        return;
    }
    let world = (told.first + i) / told.own;
    let thing = (told.first + i) % told.own;
    var number = 0u;
    for (var range = 0u; range < RANGES; range++) {
        let start = world * told.state_numbers + places[RANGES + thing * RANGES + range];
        for (var n = 0u; n < places[range]; n++) {
            given[number * told.count + i] = state[start + n];
            number++;
        }
    }
    let start = (world * told.sets + thing) * told.constants;
    for (var n = 0u; n < told.constants; n++) {
        given[number * told.count + i] = constants[start + n];
        number++;
    }
}
