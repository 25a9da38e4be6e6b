// What lies between the kernels: numbers of bodies to shapes, pairs and contacts and back, which shapes are near each
// other, which contact has which colour. Contacts stand in the order of their pairs of shapes, as on the processor.
//
// A step is taken whole or not at all: `status[FLAG]` says why it was not, and nothing of the state is written then.

struct Plan {
    // How many there are; of bodies, row 0, which does not move, is one.
    bodies: u32,
    shapes: u32,
    units: u32,
    large: u32,
    forms: u32,
    groups: u32,
    surfaces: u32,
    // How many there is room for.
    pairs: u32,
    contacts: u32,
    remembered: u32,
    // Buckets of cells, a power of two, and colours that the host has launched kernels for.
    buckets: u32,
    colours: u32,
    pair_blocks: u32,
    contact_blocks: u32,
    // Whether blows have to be looked for.
    bounces: u32,
    // Offsets in the state.
    alive: u32,
    body_state: u32,
    count: u32,
    memory: u32,
    forgotten: u32,
    // Offsets in `words`.
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
    colour_before: u32,
    colour_matrix: u32,
    contact_order: u32,
    pressing: u32,
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
    // Offsets in `constants`.
    margin: u32,
    grown: u32,
    solids: u32,
    corners: u32,
    surface: u32,
    spin_limit: u32,
    // Side of a cell [m], speed limit, and how far anything may be from the origin [m].
    cell: f32,
    fastest: f32,
    farthest: f32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> rows: array<f32>;
@group(0) @binding(2) var<storage, read_write> shape_scratch: array<f32>;
@group(0) @binding(3) var<storage, read_write> placed: array<f32>;
@group(0) @binding(4) var<storage, read_write> pair_parameters: array<f32>;
@group(0) @binding(5) var<storage, read_write> pair_scratch: array<f32>;
@group(0) @binding(6) var<storage, read_write> fresh: array<f32>;
@group(0) @binding(7) var<storage, read_write> contacts: array<f32>;
@group(0) @binding(8) var<storage, read_write> seats: array<u32>;
@group(0) @binding(9) var<storage, read_write> words: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read_write> status: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> runs: array<vec2<u32>>;
@group(0) @binding(12) var<storage, read_write> launches: array<u32>;
@group(0) @binding(13) var<storage, read> constants: array<f32>;
@group(0) @binding(14) var<storage, read> whole: array<u32>;
@group(0) @binding(15) var<uniform> plan: Plan;

const NONE: u32 = 0xffffffffu;
// What a plane has on all sides.
const EVERYWHERE: f32 = 1e30;
// Most cells that are looked through about one shape.
const MOST_CELLS: f32 = 4096.0;

fn word(i: u32) -> u32 {
    return atomicLoad(&words[i]);
}
fn put(i: u32, x: u32) {
    atomicStore(&words[i], x);
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
fn pair_count() -> u32 {
    return min(told(PAIRS), plan.pairs);
}
fn contact_count() -> u32 {
    return min(told(CONTACTS), plan.contacts);
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
    return constants[plan.solids + shape * SOLID + field];
}

// ---- A step begins.

@compute @workgroup_size(64)
fn clear(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i <= plan.buckets) {
        put(plan.bucket_start + i, 0u);
    }
    if (i <= plan.bodies) {
        put(plan.body_start + i, 0u);
    }
    // What was told of a step that was not taken stays.
    if (i == 0u && runs_on()) {
        atomicStore(&status[PAIRS], 0u);
        atomicStore(&status[CONTACTS], 0u);
        atomicStore(&status[WIDEST], 0u);
        atomicStore(&status[CHANGED], 0u);
        atomicStore(&status[SETTLED], 0u);
        atomicStore(&status[ROUND], 0u);
        runs[BODIES_RUN] = vec2(1u, plan.bodies - 1u);
        if (state[plan.alive] == 0.0) {
            stop(DEAD);
        }
    }
}

@compute @workgroup_size(64)
fn load_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (body >= plan.bodies) {
        return;
    }
    for (var field = 0u; field < ROW; field++) {
        rows[field * plan.bodies + body] = 0.0;
    }
    rows[(ORIENTATION + 3u) * plan.bodies + body] = 1.0;
    if (body == 0u) {
        return;
    }
    let source = plan.body_state + body * STATE;
    for (var i = 0u; i < 6u; i++) {
        rows[(VELOCITY + i) * plan.bodies + body] = state[source + STATE_VELOCITY + i];
    }
    for (var i = 0u; i < 7u; i++) {
        let to = select(CENTER + i, ORIENTATION + i - 3u, i > 2u);
        rows[to * plan.bodies + body] = state[source + i];
    }
    // What spins faster has its step cut into parts.
    let spin = row3(VELOCITY + 3u, body);
    let limit = constants[plan.spin_limit + body];
    if (dot(spin, spin) > limit * limit) {
        stop(PROCESSOR);
    }
}

@compute @workgroup_size(64)
fn load_shapes(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let body = whole[plan.carriers + shape];
    for (var i = 0u; i < 19u; i++) {
        var field = VELOCITY + i;
        if (i >= 12u) {
            field = select(CENTER + i - 12u, ORIENTATION + i - 15u, i > 14u);
        } else if (i >= 6u) {
            field = ACCELERATION + i - 6u;
        }
        shape_scratch[i * plan.shapes + shape] = row(field, body);
    }
}

// ---- Which shapes are near each other.

fn cell_of(at: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor(at / plan.cell));
}
// Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
fn bucket(cell: vec3<i32>) -> u32 {
    let c = bitcast<vec3<u32>>(cell);
    return ((c.x * 73856093u) ^ (c.y * 19349663u) ^ (c.z * 83492791u)) & (plan.buckets - 1u);
}
fn is_large(shape: u32) -> bool {
    return word(plan.bucket_of + shape) == NONE;
}

@compute @workgroup_size(64)
fn surround(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let center = placed3(PLACED_POSITION, shape);
    let half = placed3(PLACED_EXTENT, shape);
    // What rounding may take away, far from the origin.
    let most = abs(center) + half;
    let rounding = 1e-6 * max(most.x, max(most.y, most.z));
    var around = half + (constants[plan.grown + shape] + rounding);
    if (whole[plan.shape_form + shape * 2u + 1u] == 1u) {
        around = vec3(EVERYWHERE);
    }
    let least = center - around;
    let greatest = center + around;
    for (var i = 0u; i < 3u; i++) {
        placed[(PLACED + i) * plan.shapes + shape] = least[i];
        placed[(PLACED + 3u + i) * plan.shapes + shape] = greatest[i];
    }
    if (whole[plan.first_corner + shape * 2u + 1u] == 1u) {
        put(plan.bucket_of + shape, NONE);
        return;
    }
    // Far out, and what is nowhere, is the processor's.
    if (!(max(most.x, max(most.y, most.z)) < plan.farthest)) {
        stop(PROCESSOR);
        put(plan.bucket_of + shape, 0u);
        atomicAdd(&words[plan.bucket_start], 1u);
        return;
    }
    let own = bucket(cell_of(center));
    put(plan.bucket_of + shape, own);
    atomicAdd(&words[plan.bucket_start + own], 1u);
    atomicMax(&status[WIDEST], bitcast<u32>(max(around.x, max(around.y, around.z))));
}

// After it, a bucket begins where the one before it ends, and `bucket_start` says where it ends.
@compute @workgroup_size(64)
fn fill_buckets(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let own = word(plan.bucket_of + shape);
    if (own != NONE) {
        let at = atomicAdd(&words[plan.bucket_start + own], 1u);
        put(plan.bucket_items + at, shape);
    }
}

fn may_touch(a: u32, b: u32) -> bool {
    let one = plan.sides + a * 5u;
    let two = plan.sides + b * 5u;
    let owner = whole[one] >> 2u;
    let other = whole[two] >> 2u;
    // Bit 0: collides; bit 1: moves.
    let collide = (whole[one] & whole[two] & 1u) != 0u;
    let move_ = ((whole[one] | whole[two]) & 2u) != 0u;
    if (owner == other || !collide || !move_) {
        return false;
    }
    let masks = (whole[one + 1u] & whole[two + 2u]) | (whole[two + 1u] & whole[one + 2u]);
    let g = bitcast<i32>(whole[one + 3u]);
    let h = bitcast<i32>(whole[two + 3u]);
    let groups = (g > 0 && h != 0) || (h > 0 && g != 0);
    let v = bitcast<i32>(whole[one + 4u]);
    let w = bitcast<i32>(whole[two + 4u]);
    if (masks == 0u || !groups || !(v == w || v == -1 || w == -1)) {
        return false;
    }
    for (var i = whole[plan.apart_start + owner]; i < whole[plan.apart_start + owner + 1u]; i++) {
        if (whole[plan.apart_items + i] == other) {
            return false;
        }
    }
    return true;
}

fn overlap(a: u32, b: u32) -> bool {
    let below = placed3(PLACED, a) <= placed3(PLACED + 3u, b);
    let above = placed3(PLACED, b) <= placed3(PLACED + 3u, a);
    return all(below) && all(above);
}

// Of a pair of forms, the group of pairs that one kernel meets.
fn group_of(a: u32, b: u32) -> u32 {
    let f = whole[plan.shape_form + a * 2u];
    let g = whole[plan.shape_form + b * 2u];
    return whole[plan.form_group + min(f, g) * plan.forms + max(f, g)];
}

fn near(a: u32, b: u32) -> bool {
    return b > a && overlap(a, b) && group_of(a, b) != NONE && may_touch(a, b);
}

// A unit of work: a small shape with all later ones, or a large one with 64 others. Lists the pairs at `at`, if it is
// not NONE, and returns their number.
fn look(unit: u32, at: u32) -> u32 {
    let a = whole[plan.unit_shapes + 2u * unit];
    let first = whole[plan.unit_shapes + 2u * unit + 1u];
    var found = 0u;
    if (first != NONE) {
        for (var b = first; b < min(first + 64u, plan.shapes); b++) {
            if (near(a, b)) {
                list(at, found, a, b);
                found++;
            }
        }
        return found;
    }
    for (var i = 0u; i < plan.large; i++) {
        let b = whole[plan.large_shapes + i];
        if (near(a, b)) {
            list(at, found, a, b);
            found++;
        }
    }
    let widest = bitcast<f32>(told(WIDEST));
    let low = cell_of(placed3(PLACED, a) - widest);
    let high = cell_of(placed3(PLACED + 3u, a) + widest);
    let cells = vec3<f32>(high - low + 1);
    if (!(cells.x * cells.y * cells.z < MOST_CELLS)) {
        stop(PROCESSOR);
        return found;
    }
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let cell = vec3(x, y, z);
                let own = plan.bucket_start + bucket(cell);
                var i = 0u;
                if (own > plan.bucket_start) {
                    i = word(own - 1u);
                }
                for (; i < word(own); i++) {
                    let b = word(plan.bucket_items + i);
                    // Other cells may share the bucket.
                    if (near(a, b) && all(cell_of(placed3(PLACED_POSITION, b)) == cell)) {
                        list(at, found, a, b);
                        found++;
                    }
                }
            }
        }
    }
    return found;
}

fn list(at: u32, nth: u32, a: u32, b: u32) {
    if (at == NONE || at + nth >= plan.pairs) {
        return;
    }
    // Put where it belongs among those before it: they are few.
    var i = at + nth;
    for (; i > at; i--) {
        let before = word(plan.pair_shapes + 2u * i - 1u);
        if (before < b) {
            break;
        }
        put(plan.pair_shapes + 2u * i + 1u, before);
    }
    put(plan.pair_shapes + 2u * (at + nth), a);
    put(plan.pair_shapes + 2u * i + 1u, b);
}

@compute @workgroup_size(64)
fn count_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < plan.units) {
        put(plan.unit_start + id.x, look(id.x, NONE));
    } else if (id.x == plan.units) {
        put(plan.unit_start + id.x, 0u);
    }
}

@compute @workgroup_size(64)
fn list_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let unit = id.x;
    if (unit == plan.units && runs_on()) {
        let all_pairs = word(plan.unit_start + unit);
        atomicStore(&status[PAIRS], all_pairs);
        if (all_pairs > plan.pairs) {
            stop(MORE_PAIRS);
        }
    }
    if (unit >= plan.units) {
        return;
    }
    let at = word(plan.unit_start + unit);
    let found = look(unit, at);
    for (var i = at; i < min(at + found, plan.pairs); i++) {
        let a = word(plan.pair_shapes + 2u * i);
        let b = word(plan.pair_shapes + 2u * i + 1u);
        put(plan.pair_group + i, group_of(a, b));
    }
}

// A run, and how many workgroups it takes.
fn run(number: u32, first: u32, count: u32) {
    runs[number] = vec2(first, count);
    launches[3u * number] = (count + 63u) / 64u;
    launches[3u * number + 1u] = 1u;
    launches[3u * number + 2u] = 1u;
}

@compute @workgroup_size(64)
fn plan_groups(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= plan.groups) {
        return;
    }
    let first = word(plan.group_matrix + id.x * plan.pair_blocks);
    var next = pair_count();
    if (id.x + 1u < plan.groups) {
        next = word(plan.group_matrix + (id.x + 1u) * plan.pair_blocks);
    }
    run(id.x, first, select(0u, next - first, runs_on()));
}

// ---- Where they touch.

// A and B of a pair, as its kernel has them.
fn ordered(pair: u32) -> vec2<u32> {
    let a = word(plan.pair_shapes + 2u * pair);
    let b = word(plan.pair_shapes + 2u * pair + 1u);
    let f = whole[plan.shape_form + a * 2u];
    let g = whole[plan.shape_form + b * 2u];
    return select(vec2(b, a), vec2(a, b), f <= g);
}

// The remembered contact of two shapes, or NONE. They are in the order of the lower shape, then the other.
fn recall(a: u32, b: u32) -> u32 {
    let lower = min(a, b);
    let upper = max(a, b);
    let count = u32(state[plan.count]);
    var begin = 0u;
    var end = count;
    while (begin < end) {
        let middle = (begin + end) / 2u;
        let at = plan.memory + middle * REMEMBERED;
        let c = u32(state[at + REMEMBERED_SHAPES]);
        let d = u32(state[at + REMEMBERED_SHAPES + 1u]);
        if (min(c, d) < lower || (min(c, d) == lower && max(c, d) < upper)) {
            begin = middle + 1u;
        } else {
            end = middle;
        }
    }
    if (begin < count) {
        let at = plan.memory + begin * REMEMBERED;
        let c = u32(state[at + REMEMBERED_SHAPES]);
        let d = u32(state[at + REMEMBERED_SHAPES + 1u]);
        if (min(c, d) == lower && max(c, d) == upper) {
            return begin;
        }
    }
    return NONE;
}

@compute @workgroup_size(64)
fn seat_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let j = id.x;
    if (j >= pair_count()) {
        return;
    }
    let pair = word(plan.pair_order + j);
    put(plan.pair_place + pair, j);
    let shapes = ordered(pair);
    let places = plan.group_places + word(plan.pair_group + pair) * PLACES;
    for (var side = 0u; side < 2u; side++) {
        let shape = shapes[side];
        let size = whole[places + side];
        for (var i = 0u; i < 3u; i++) {
            pair_parameters[(size + i) * plan.pairs + j] = solid(SOLID_SIZE + i, shape);
        }
        let at = whole[places + 2u + side];
        for (var i = 0u; i < PAIR_PLACED; i++) {
            pair_scratch[(at + i) * plan.pairs + j] = of_placed(i, shape);
        }
        let corner = whole[places + 4u + side];
        let corners = whole[places + 5u + side] - corner;
        let first = whole[plan.first_corner + shape * 2u];
        for (var i = 0u; i < corners; i++) {
            pair_parameters[(corner + i) * plan.pairs + j] = constants[plan.corners + first + i];
        }
    }
    let margin = constants[plan.margin + shapes.x] + constants[plan.margin + shapes.y];
    pair_parameters[whole[places + 7u] * plan.pairs + j] = margin;
    let known = whole[places + 8u];
    let before = recall(shapes.x, shapes.y);
    for (var i = 0u; i < 3u; i++) {
        var direction = 0.0;
        if (before != NONE) {
            let at = plan.memory + before * REMEMBERED;
            if (u32(state[at + REMEMBERED_SHAPES]) == shapes.x) {
                direction = state[at + REMEMBERED_NORMAL + i];
            }
        }
        pair_parameters[(known + i) * plan.pairs + j] = direction;
    }
    pair_scratch[whole[places + 9u] * plan.pairs + j] = 0.0;
    for (var i = 0u; i < whole[places + 11u]; i++) {
        let at = whole[places + 10u] + i * POINT_PLACE + POINT_PLACE_DISTANCE;
        pair_scratch[at * plan.pairs + j] = FAR;
    }
}

// How far [m] two shapes can get towards each other within the step.
fn way(shapes: vec2<u32>) -> f32 {
    return of_placed(PLACED_WAY, shapes.x) + of_placed(PLACED_WAY, shapes.y) + NEARBY;
}

// Pairs that did not touch and are known to be farther apart than they get need not be met: one of the two is put where
// its kernel finds it out of reach.
@compute @workgroup_size(64)
fn part_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let j = id.x;
    if (j >= pair_count()) {
        return;
    }
    let pair = word(plan.pair_order + j);
    let places = plan.group_places + word(plan.pair_group + pair) * PLACES;
    if (whole[places + 12u] == 0u) {
        return;
    }
    var touched = false;
    for (var i = 0u; i < 3u; i++) {
        touched = touched || pair_parameters[(whole[places + 8u] + i) * plan.pairs + j] != 0.0;
    }
    let gap = (whole[places + 10u] + POINT_PLACE_DISTANCE) * plan.pairs + j;
    if (!touched && pair_scratch[gap] >= way(ordered(pair))) {
        pair_scratch[(whole[places + 3u] + PLACED_POSITION) * plan.pairs + j] = FAR;
    }
    pair_scratch[gap] = FAR;
}

// Of a pair's point, the first of its numbers.
fn point_of(pair: u32, i: u32) -> u32 {
    let places = plan.group_places + word(plan.pair_group + pair) * PLACES;
    return whole[places + 10u] + i * POINT_PLACE;
}
fn points_of(pair: u32) -> u32 {
    return whole[plan.group_places + word(plan.pair_group + pair) * PLACES + 11u];
}
fn of_pair(pair: u32, at: u32) -> f32 {
    return pair_scratch[at * plan.pairs + word(plan.pair_place + pair)];
}
fn is_point(pair: u32, i: u32) -> bool {
    return of_pair(pair, point_of(pair, i) + POINT_PLACE_DISTANCE) < 0.5 * FAR;
}

@compute @workgroup_size(64)
fn find_touching(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if (pair > plan.pairs) {
        return;
    }
    var touch = 0u;
    if (pair < pair_count() && runs_on()) {
        // Whether any of its points could close within the step.
        let reach = way(ordered(pair));
        for (var i = 0u; i < points_of(pair); i++) {
            let gap = of_pair(pair, point_of(pair, i) + POINT_PLACE_DISTANCE);
            touch |= select(0u, 1u, gap < reach);
        }
    }
    put(plan.contact_start + pair, touch);
}

@compute @workgroup_size(64)
fn make_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if (pair == plan.pairs && runs_on()) {
        let all_contacts = word(plan.contact_start + pair);
        atomicStore(&status[CONTACTS], all_contacts);
        if (all_contacts > plan.contacts) {
            stop(MORE_CONTACTS);
        }
    }
    if (pair >= plan.pairs) {
        return;
    }
    let contact = word(plan.contact_start + pair);
    if (word(plan.contact_start + pair + 1u) == contact || contact >= plan.contacts) {
        return;
    }
    let shapes = ordered(pair);
    let to = contact * REMEMBERED;
    for (var i = 0u; i < REMEMBERED; i++) {
        fresh[to + i] = 0.0;
    }
    fresh[to + REMEMBERED_SHAPES] = f32(shapes.x);
    fresh[to + REMEMBERED_SHAPES + 1u] = f32(shapes.y);
    var count = 0u;
    for (var i = 0u; i < points_of(pair); i++) {
        if (!is_point(pair, i)) {
            continue;
        }
        let source = point_of(pair, i);
        let point = to + REMEMBERED_POINT + count * REMEMBERED_POINT_WIDTH;
        for (var x = 0u; x < 3u; x++) {
            // All points of two convex solids have one normal.
            fresh[to + REMEMBERED_NORMAL + x] = of_pair(pair, source + POINT_PLACE_NORMAL + x);
            fresh[point + x] = of_pair(pair, source + POINT_PLACE_POSITION + x);
        }
        fresh[point + 3u] = of_pair(pair, source + POINT_PLACE_DISTANCE);
        fresh[point + 4u] = of_pair(pair, source + POINT_PLACE_FEATURE);
        count++;
    }
    fresh[to + REMEMBERED_POINTS] = f32(count);
    let old = recall(shapes.x, shapes.y);
    var colour = 0u;
    if (old != NONE) {
        warm(shapes, old, to, count);
        colour = word(plan.colour_before + old);
    }
    put(plan.colour + contact, min(colour, COLOURS));
    for (var side = 0u; side < 2u; side++) {
        let body = whole[plan.carriers + shapes[side]];
        if (body != 0u) {
            atomicAdd(&words[plan.body_start + body], 1u);
        }
    }
}

// Points begin with the impulses of those that had the same feature, or else were in the same place.
fn warm(shapes: vec2<u32>, old: u32, to: u32, count: u32) {
    let source = plan.memory + old * REMEMBERED;
    for (var i = 0u; i < 3u; i++) {
        fresh[to + REMEMBERED_DRAG + i] = state[source + REMEMBERED_DRAG + i];
        fresh[to + REMEMBERED_TWIST + i] = state[source + REMEMBERED_TWIST + i];
    }
    let near_by = SAME_PLACE * max(solid(SOLID_RADIUS, shapes.x), solid(SOLID_RADIUS, shapes.y));
    let olds = min(u32(state[source + REMEMBERED_POINTS]), POINTS);
    var taken: array<bool, POINTS>;
    var warmed: array<bool, POINTS>;
    for (var i = 0u; i < count; i++) {
        let point = to + REMEMBERED_POINT + i * REMEMBERED_POINT_WIDTH;
        for (var j = 0u; j < olds; j++) {
            let before = source + REMEMBERED_POINT + j * REMEMBERED_POINT_WIDTH;
            if (!warmed[i] && !taken[j] && state[before + 4u] == fresh[point + 4u]) {
                fresh[point + 5u] = state[before + 5u];
                taken[j] = true;
                warmed[i] = true;
            }
        }
    }
    for (var i = 0u; i < count; i++) {
        if (warmed[i]) {
            continue;
        }
        let point = to + REMEMBERED_POINT + i * REMEMBERED_POINT_WIDTH;
        let at = vec3(fresh[point], fresh[point + 1u], fresh[point + 2u]);
        var nearest = NONE;
        var least = near_by;
        for (var j = 0u; j < olds; j++) {
            let before = source + REMEMBERED_POINT + j * REMEMBERED_POINT_WIDTH;
            let then = vec3(state[before], state[before + 1u], state[before + 2u]);
            let apart = distance(at, then);
            if (!taken[j] && apart < least) {
                least = apart;
                nearest = j;
            }
        }
        if (nearest != NONE) {
            taken[nearest] = true;
            fresh[point + 5u] = state[source + REMEMBERED_POINT + nearest * REMEMBERED_POINT_WIDTH + 5u];
        }
    }
}

// ---- Colours: the first that none of the contacts before it has, at both of its bodies.

fn carrier(contact: u32, side: u32) -> u32 {
    let shape = u32(fresh[contact * REMEMBERED + REMEMBERED_SHAPES + side]);
    return whole[plan.carriers + shape];
}

// After it, a body's contacts begin where those of the one before end, and `body_start` says where its own do.
@compute @workgroup_size(64)
fn join(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact >= contact_count()) {
        return;
    }
    for (var side = 0u; side < 2u; side++) {
        let body = carrier(contact, side);
        if (body != 0u) {
            let at = atomicAdd(&words[plan.body_start + body], 1u);
            put(plan.body_items + at, contact);
        }
    }
}

// Each takes the colour that those before it leave, as far as theirs are known. Repeated until none changes, which
// leaves what they would get one after the other: the first cannot change, then the second, and so on.
@compute @workgroup_size(64)
fn paint(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (told(SETTLED) != 0u || contact >= contact_count()) {
        return;
    }
    var used = vec2(0u, 0u);
    for (var side = 0u; side < 2u; side++) {
        let body = carrier(contact, side);
        if (body == 0u) {
            continue;
        }
        for (var i = word(plan.body_start + body - 1u); i < word(plan.body_start + body); i++) {
            let other = word(plan.body_items + i);
            let colour = word(plan.colour + other);
            if (other < contact && colour < COLOURS) {
                let bit = 1u << (colour & 31u);
                used |= select(vec2(bit, 0u), vec2(0u, bit), colour > 31u);
            }
        }
    }
    var colour = countTrailingZeros(~used.x);
    if (colour == 32u) {
        colour += countTrailingZeros(~used.y);
    }
    if (word(plan.colour + contact) != colour) {
        put(plan.colour + contact, colour);
        atomicStore(&status[CHANGED], 1u);
    }
}

@compute @workgroup_size(1)
fn settle() {
    if (told(SETTLED) != 0u) {
        return;
    }
    atomicAdd(&status[ROUND], 1u);
    atomicMax(&status[ROUNDS], told(ROUND));
    if (told(CHANGED) == 0u) {
        atomicStore(&status[SETTLED], 1u);
    }
    atomicStore(&status[CHANGED], 0u);
}

@compute @workgroup_size(64)
fn plan_colours(@builtin(global_invocation_id) id: vec3<u32>) {
    let colour = id.x;
    let count = contact_count();
    if (colour > COLOURS) {
        return;
    }
    if (colour == 0u) {
        if (told(SETTLED) == 0u) {
            stop(MORE_ROUNDS);
        }
        run(CONTACTS_RUN, 0u, count);
    }
    let first = word(plan.colour_matrix + colour * plan.contact_blocks);
    var next = count;
    if (colour < COLOURS) {
        next = word(plan.colour_matrix + (colour + 1u) * plan.contact_blocks);
        run(COLOUR_RUN + colour, first, next - first);
    } else if (next > first) {
        // What finds no colour is solved one by one.
        stop(PROCESSOR);
        return;
    }
    if (next > first) {
        atomicMax(&status[COLOURED], colour + 1u);
        if (colour >= plan.colours) {
            stop(MORE_COLOURS);
        }
    }
}

// ---- Contacts in lanes, and back.

fn put_contact(field: u32, i: u32, x: f32) {
    contacts[field * plan.contacts + i] = x;
}
fn of_contact(field: u32, i: u32) -> f32 {
    return contacts[field * plan.contacts + i];
}

@compute @workgroup_size(64)
fn seat_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= contact_count()) {
        return;
    }
    let contact = word(plan.contact_order + i);
    let source = contact * REMEMBERED;
    let a = u32(fresh[source + REMEMBERED_SHAPES]);
    let b = u32(fresh[source + REMEMBERED_SHAPES + 1u]);
    seats[i] = whole[plan.carriers + a];
    seats[plan.contacts + i] = whole[plan.carriers + b];
    for (var x = 0u; x < 3u; x++) {
        put_contact(MANIFOLD_NORMAL + x, i, fresh[source + REMEMBERED_NORMAL + x]);
        put_contact(MANIFOLD_DRAG + x, i, fresh[source + REMEMBERED_DRAG + x]);
        put_contact(MANIFOLD_TWIST + x, i, fresh[source + REMEMBERED_TWIST + x]);
        put_contact(MANIFOLD_DRAG_SUM + x, i, 0.0);
        put_contact(MANIFOLD_TWIST_SUM + x, i, 0.0);
    }
    let s = whole[plan.shape_surface + a] * plan.surfaces + whole[plan.shape_surface + b];
    let surface = plan.surface + s * SURFACE;
    // Friction, restitution, torsion, rolling, spring and damper, settling; and what sticks.
    for (var x = 0u; x < 7u; x++) {
        put_contact(MANIFOLD_FRICTION + x, i, constants[surface + x]);
    }
    put_contact(MANIFOLD_STICKING, i, constants[surface + 7u]);
    put_contact(MANIFOLD_THICKNESS, i, solid(SOLID_THICKNESS, a) + solid(SOLID_THICKNESS, b));
    put_contact(MANIFOLD_STRUCK, i, 0.0);
    let count = u32(fresh[source + REMEMBERED_POINTS]);
    for (var p = 0u; p < POINTS; p++) {
        let at = MANIFOLD + p * POINT;
        let is_one = p < count;
        // Points that are not lie where the first does, but far apart: they give nothing.
        let point = source + REMEMBERED_POINT + select(0u, p, is_one) * REMEMBERED_POINT_WIDTH;
        for (var x = 0u; x < 3u; x++) {
            put_contact(at + POINT_ARM_A + x, i, fresh[point + x]);
        }
        put_contact(at + POINT_GAP, i, select(NOWHERE, fresh[point + 3u], is_one));
        put_contact(at + POINT_IMPULSE, i, select(0.0, fresh[point + 5u], is_one));
        put_contact(at + POINT_SUM, i, 0.0);
    }
}

@compute @workgroup_size(64)
fn read_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= contact_count()) {
        return;
    }
    let to = word(plan.contact_order + i) * REMEMBERED;
    for (var x = 0u; x < 3u; x++) {
        fresh[to + REMEMBERED_DRAG + x] = of_contact(MANIFOLD_DRAG + x, i);
        fresh[to + REMEMBERED_TWIST + x] = of_contact(MANIFOLD_TWIST + x, i);
        fresh[to + REMEMBERED_DRAG_SUM + x] = of_contact(MANIFOLD_DRAG_SUM + x, i);
        fresh[to + REMEMBERED_TWIST_SUM + x] = of_contact(MANIFOLD_TWIST_SUM + x, i);
        // What was stopped at its centre of mass is told of by the processor.
        if (of_contact(MANIFOLD_ASIDE + x, i) != 0.0) {
            stop(PROCESSOR);
        }
    }
    for (var p = 0u; p < u32(fresh[to + REMEMBERED_POINTS]); p++) {
        let point = to + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH;
        fresh[point + 5u] = of_contact(MANIFOLD + p * POINT + POINT_IMPULSE, i);
        fresh[point + 6u] = of_contact(MANIFOLD + p * POINT + POINT_SUM, i);
    }
}

// Those that press are remembered before all others, as far as there is room; all stay in order.
@compute @workgroup_size(64)
fn find_pressing(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact > plan.contacts) {
        return;
    }
    var presses = false;
    if (contact < contact_count()) {
        let at = contact * REMEMBERED;
        for (var i = 0u; i < 3u; i++) {
            presses = presses || fresh[at + REMEMBERED_DRAG_SUM + i] != 0.0;
        }
        for (var p = 0u; p < u32(fresh[at + REMEMBERED_POINTS]); p++) {
            let point = at + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH;
            presses = presses || fresh[point + 5u] > 0.0 || fresh[point + 6u] > 0.0;
        }
    }
    put(plan.pressing + contact, select(0u, 1u, presses));
}

// Where a contact is remembered, or NONE.
fn place_of(contact: u32) -> u32 {
    let before = word(plan.pressing + contact);
    let presses = word(plan.pressing + contact + 1u) > before;
    let room = plan.remembered - min(word(plan.pressing + plan.contacts), plan.remembered);
    let others = contact - before;
    if (!presses && others >= room) {
        return NONE;
    }
    let at = before + min(others, room);
    return select(NONE, at, at < plan.remembered);
}

// ---- What the processor has to take: blows, what got farther than it was looked for, what is lost.

@compute @workgroup_size(64)
fn find_blows(@builtin(global_invocation_id) id: vec3<u32>) {
    if (plan.bounces != 0u && id.x < contact_count() && of_contact(MANIFOLD_STRUCK, id.x) > 0.0) {
        stop(PROCESSOR);
    }
}

@compute @workgroup_size(64)
fn check_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (body == 0u || body >= plan.bodies) {
        return;
    }
    var sound = true;
    for (var i = 0u; i < 6u; i++) {
        sound = sound && abs(row(VELOCITY + i, body)) <= plan.fastest;
    }
    for (var i = 0u; i < 7u; i++) {
        sound = sound && abs(row(CENTER + i, body)) <= plan.farthest;
    }
    if (!sound) {
        stop(PROCESSOR);
    }
}

// No point of a shape gets farther than its body's shift and turn take it. The processor, which takes the step again,
// knows it more closely.
@compute @workgroup_size(64)
fn check_shapes(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let body = whole[plan.carriers + shape];
    if (body == 0u) {
        return;
    }
    let source = plan.body_state + body * STATE;
    let center = vec3(state[source], state[source + 1u], state[source + 2u]);
    let arm = distance(placed3(PLACED_POSITION, shape), center) + solid(SOLID_RADIUS, shape);
    let way = length(row3(SHIFT, body)) + length(row3(TURN, body)) * arm;
    let half = vec3(
        solid(SOLID_EXTENT, shape),
        solid(SOLID_EXTENT + 1u, shape),
        solid(SOLID_EXTENT + 2u, shape),
    );
    if (way - of_placed(PLACED_WAY, shape) > min(half.x, min(half.y, half.z))) {
        stop(PROCESSOR);
    }
}

// ---- The step is taken.

@compute @workgroup_size(64)
fn store_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (body == 0u || body >= plan.bodies || !runs_on()) {
        return;
    }
    let to = plan.body_state + body * STATE;
    for (var i = 0u; i < 6u; i++) {
        state[to + STATE_BEFORE + i] = state[to + STATE_VELOCITY + i];
        state[to + STATE_VELOCITY + i] = row(VELOCITY + i, body);
    }
    for (var i = 0u; i < 7u; i++) {
        state[to + i] = row(select(CENTER + i, ORIENTATION + i - 3u, i > 2u), body);
    }
    // Nothing sleeps here.
    state[to + STATE_REST] = 0.0;
}

@compute @workgroup_size(64)
fn store_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact >= contact_count() || !runs_on()) {
        return;
    }
    let at = place_of(contact);
    if (at == NONE) {
        return;
    }
    for (var i = 0u; i < REMEMBERED; i++) {
        state[plan.memory + at * REMEMBERED + i] = fresh[contact * REMEMBERED + i];
    }
    put(plan.colour_before + at, word(plan.colour + contact));
}

@compute @workgroup_size(1)
fn end() {
    if (runs_on()) {
        let count = contact_count();
        state[plan.count] = f32(min(count, plan.remembered));
        if (count > plan.remembered) {
            state[plan.forgotten] += f32(count - plan.remembered);
        }
        atomicAdd(&status[STEPS], 1u);
    }
}
