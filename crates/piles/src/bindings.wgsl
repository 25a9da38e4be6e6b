// What lies between the kernels: numbers of bodies to shapes, pairs and contacts and back, which shapes are near each
// other, which contact has which colour. Contacts stand in the order of their pairs of shapes, as on the processor.
//
// Several worlds are stepped together. In each array they lie one after the other; of bodies, behind a row for each world,
// for what does not move in it. What one of them does, no other one knows.
//
// A step, or a part of one, is taken whole or not at all: `status[FLAG]` says why it was not in all of them, what a world
// has under `STOPPED` why it was not there; then nothing of the state is written.

struct Plan {
    worlds: u32,
    // How many there are in all of them; of bodies, with what does not move.
    bodies: u32,
    shapes: u32,
    units: u32,
    joints: u32,
    // How many a world has; of bodies, that move.
    own_bodies: u32,
    own_shapes: u32,
    own_units: u32,
    own_joints: u32,
    large: u32,
    forms: u32,
    groups: u32,
    // Of them, those without a mesh, which come first.
    solid_groups: u32,
    surfaces: u32,
    // How many there is room for.
    pairs: u32,
    mesh_pairs: u32,
    // Triangles near a solid.
    most_near: u32,
    contacts: u32,
    // By each world.
    remembered: u32,
    // Runs of joints, and numbers of the laws of each joint.
    joint_runs: u32,
    law_numbers: u32,
    // Of a step.
    small_steps: u32,
    // Buckets of cells, a power of two.
    buckets: u32,
    pair_blocks: u32,
    contact_blocks: u32,
    // Numbers of a world's state, and offsets in it; the last of what joints carry.
    state_numbers: u32,
    body_state: u32,
    count: u32,
    memory: u32,
    forgotten: u32,
    tied: u32,
    // Behind all states, what acts on bodies; constants of joints, so many numbers a world; and what acts along their axes.
    forces: u32,
    given: u32,
    given_numbers: u32,
    acting: u32,
    // Offsets in `words`.
    cells: u32,
    bucket_of: u32,
    bucket_start: u32,
    bucket_items: u32,
    unit_start: u32,
    pair_shapes: u32,
    pair_group: u32,
    pair_order: u32,
    pair_place: u32,
    group_matrix: u32,
    contact_start: u32,
    body_start: u32,
    body_items: u32,
    colour: u32,
    colour_matrix: u32,
    contact_order: u32,
    pressing: u32,
    foreseen: u32,
    near: u32,
    ended: u32,
    merged: u32,
    same: u32,
    // Offsets in `whole`.
    carriers: u32,
    sides: u32,
    apart_start: u32,
    apart_items: u32,
    shape_form: u32,
    form_group: u32,
    group_places: u32,
    unit_shapes: u32,
    large_shapes: u32,
    shape_surface: u32,
    first_corner: u32,
    ties: u32,
    joint_seats: u32,
    joint_run: u32,
    paired_start: u32,
    paired_items: u32,
    mesh_of_shape: u32,
    mesh_group_rows: u32,
    mesh_cluster_rows: u32,
    // Offsets in `constants`; from those of one world to those of the next, which is 0 where all worlds share them; and
    // those of the first world.
    mesh_groups: u32,
    mesh_clusters: u32,
    mesh_triangles: u32,
    own_constants: u32,
    grown: u32,
    solids: u32,
    corners: u32,
    surface: u32,
    turn: u32,
    // Side of a cell at least [m], speed limit, and how far anything may be from the origin [m].
    cell: f32,
    fastest: f32,
    farthest: f32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
// Of each remembered contact, the colour that it had.
@group(0) @binding(1) var<storage, read_write> colours_before: array<u32>;
@group(0) @binding(2) var<storage, read_write> rows: array<f32>;
@group(0) @binding(3) var<storage, read_write> shape_scratch: array<f32>;
@group(0) @binding(4) var<storage, read_write> placed: array<f32>;
@group(0) @binding(5) var<storage, read_write> pair_parameters: array<f32>;
@group(0) @binding(6) var<storage, read_write> pair_scratch: array<f32>;
@group(0) @binding(7) var<storage, read_write> fresh: array<f32>;
@group(0) @binding(8) var<storage, read_write> contacts: array<f32>;
@group(0) @binding(9) var<storage, read_write> seats: array<u32>;
@group(0) @binding(10) var<storage, read_write> words: array<u32>;
// Words that several invocations write, or read while others write them; and those by which things are sorted.
@group(0) @binding(11) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(12) var<storage, read_write> status: array<atomic<u32>>;
@group(0) @binding(13) var<storage, read_write> runs: array<vec2<u32>>;
@group(0) @binding(14) var<storage, read_write> launches: array<u32>;
@group(0) @binding(15) var<storage, read_write> joints: array<f32>;
@group(0) @binding(16) var<storage, read_write> mesh_parameters: array<f32>;
@group(0) @binding(17) var<storage, read_write> mesh_scratch: array<f32>;
// The bodies of joints that hand a blow on; of the others NONE.
@group(0) @binding(18) var<storage, read_write> struck_seats: array<u32>;
@group(0) @binding(19) var<storage, read> constants: array<f32>;
@group(0) @binding(20) var<storage, read> whole: array<u32>;
@group(0) @binding(21) var<uniform> plan: Plan;

const NONE: u32 = 0xffffffffu;
// What a plane has on all sides.
const EVERYWHERE: f32 = 1e30;
// Beyond the last cells lies all that is farther.
const LAST_CELL: f32 = 1e9;

fn word(i: u32) -> u32 {
    return words[i];
}
fn put(i: u32, x: u32) {
    words[i] = x;
}
fn mark(i: u32) -> u32 {
    return atomicLoad(&marks[i]);
}
fn put_mark(i: u32, x: u32) {
    atomicStore(&marks[i], x);
}
fn told(i: u32) -> u32 {
    return atomicLoad(&status[i]);
}
fn runs_on() -> bool {
    return told(FLAG) == 0u;
}
fn stop(flag: u32) {
    atomicOr(&status[FLAG], flag);
}
// Of what is told of a world, where a number stands.
fn of_world(world: u32, i: u32) -> u32 {
    return STATUS + world * OF_WORLD + i;
}
fn runs_in(world: u32) -> bool {
    return runs_on() && told(of_world(world, STOPPED)) == 0u;
}
fn stop_in(world: u32, flag: u32) {
    atomicOr(&status[of_world(world, STOPPED)], flag);
}
// Where there is but one world, nothing is divided.
fn world_of_body(body: u32) -> u32 {
    if (SEVERAL) {
        return (body - plan.worlds) / plan.own_bodies;
    }
    return 0u;
}
fn world_of(shape: u32) -> u32 {
    if (SEVERAL) {
        return shape / plan.own_shapes;
    }
    return 0u;
}
// The same shape in the first world, and the same body, counted from 0.
fn own_shape(shape: u32) -> u32 {
    if (SEVERAL) {
        return shape % plan.own_shapes;
    }
    return shape;
}
fn own_body(body: u32) -> u32 {
    if (SEVERAL) {
        return (body - plan.worlds) % plan.own_bodies;
    }
    return body - plan.worlds;
}
// Of a contact that a world remembers, of all that worlds have room to remember.
fn world_of_old(i: u32) -> u32 {
    if (SEVERAL) {
        return i / plan.remembered;
    }
    return 0u;
}
// The row of a body of a world, as the solver counts them: 0 is what does not move.
fn row_of(world: u32, body: u32) -> u32 {
    return select(world, plan.worlds + world * plan.own_bodies + body - 1u, body != 0u);
}
fn is_fixed(body: u32) -> bool {
    return body < plan.worlds;
}
// The row of a shape's body.
fn carrier_of(shape: u32) -> u32 {
    let body = whole[plan.carriers + own_shape(shape)];
    return row_of(world_of(shape), body);
}
// Where the state of a body stands.
fn state_of(body: u32) -> u32 {
    let within = plan.body_state + (own_body(body) + 1u) * STATE;
    return world_of_body(body) * plan.state_numbers + within;
}
// Of a shape, a number of which each world may have another.
fn constant_of(shape: u32, at: u32, width: u32) -> f32 {
    return constants[world_of(shape) * plan.own_constants + at + own_shape(shape) * width];
}
fn pair_count() -> u32 {
    return min(told(PAIRS), plan.pairs);
}
fn contact_count() -> u32 {
    return min(told(CONTACTS), plan.contacts);
}
// Whether this is the first part of a step, or all of it.
fn is_first() -> bool {
    return told(PART) == 1u;
}
// Contacts that are told of: those found, and behind them those that ended in the parts before.
fn told_count() -> u32 {
    return min(contact_count() + told(ENDED), plan.contacts);
}
// In their order, the place at which those of a world begin.
fn first_place(world: u32) -> u32 {
    var ended = 0u;
    if (told(ENDED) != 0u) {
        ended = word(plan.ended + world * plan.remembered);
    }
    let pair = min(word(plan.unit_start + world * plan.own_units), plan.pairs);
    return min(word(plan.contact_start + pair) + ended, told_count());
}
// Contacts that are solved: all but those of sensors, which come last.
fn solved_count() -> u32 {
    return runs[CONTACTS_RUN].y;
}
// By its bits: compilers may take for granted that there are no others.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}
// Of the seven numbers of a place, the field of a row.
fn place_field(i: u32) -> u32 {
    return select(CENTER + i, ORIENTATION + i - 3u, i > 2u);
}
fn is_plane(shape: u32) -> bool {
    return (whole[plan.shape_form + own_shape(shape) * 2u + 1u] & 1u) != 0u;
}
fn is_sensor(shape: u32) -> bool {
    return (whole[plan.shape_form + own_shape(shape) * 2u + 1u] & 2u) != 0u;
}
fn is_mesh(shape: u32) -> bool {
    return (whole[plan.shape_form + own_shape(shape) * 2u + 1u] & 4u) != 0u;
}
// What two shapes make of a contact: the first of its numbers.
fn surface_of(shapes: vec2<u32>) -> u32 {
    let kind = whole[plan.shape_surface + own_shape(shapes.x)] * plan.surfaces;
    let both = kind + whole[plan.shape_surface + own_shape(shapes.y)];
    return world_of(shapes.x) * plan.own_constants + plan.surface + both * SURFACE;
}
fn is_large(shape: u32) -> bool {
    return whole[plan.first_corner + own_shape(shape) * 2u + 1u] == 1u;
}
fn row(field: u32, body: u32) -> f32 {
    return rows[field * plan.bodies + body];
}
fn row3(field: u32, body: u32) -> vec3<f32> {
    return vec3(row(field, body), row(field + 1u, body), row(field + 2u, body));
}
fn of_placed(field: u32, shape: u32) -> f32 {
    return placed[field * plan.shapes + shape];
}
fn placed3(field: u32, shape: u32) -> vec3<f32> {
    return vec3(of_placed(field, shape), of_placed(field + 1u, shape), of_placed(field + 2u, shape));
}
fn solid(field: u32, shape: u32) -> f32 {
    return constant_of(shape, plan.solids + field, SOLID);
}
