// Pairs to lanes, and the points that their kernels find to contacts.

// A and B of a pair, as its kernel has them.
fn ordered(pair: u32) -> vec2<u32> {
    let a = word(plan.pair_shapes + 2u * pair);
    let b = word(plan.pair_shapes + 2u * pair + 1u);
    let f = whole[plan.shape_form + own_shape(a) * 2u];
    let g = whole[plan.shape_form + own_shape(b) * 2u];
    return select(vec2(b, a), vec2(a, b), f <= g);
}

// What is remembered of a world's nth contact.
fn memory_of(world: u32, nth: u32) -> u32 {
    return world * plan.state_numbers + plan.memory + nth * REMEMBERED;
}
// The same of a contact of all that worlds have room to remember.
fn memory_at(i: u32) -> u32 {
    let world = world_of_old(i);
    return memory_of(world, i - world * plan.remembered);
}
// How many contacts a world remembers.
fn count_in(world: u32) -> u32 {
    return min(u32(state[world * plan.state_numbers + plan.count]), plan.remembered);
}
fn is_remembered(i: u32) -> bool {
    let world = world_of_old(i);
    return i - world * plan.remembered < count_in(world);
}
// The shapes of a remembered contact, the lower first.
fn old_key(i: u32) -> vec2<u32> {
    let at = memory_at(i) + REMEMBERED_SHAPES;
    let first = world_of_old(i) * plan.own_shapes;
    let a = first + u32(state[at]);
    let b = first + u32(state[at + 1u]);
    return vec2(min(a, b), max(a, b));
}
fn comes_before(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}
// The first of those that the key's world remembers that does not come before it.
fn olds_before(key: vec2<u32>) -> u32 {
    let world = world_of(key.x);
    var begin = world * plan.remembered;
    var end = begin + count_in(world);
    while (begin < end) {
        let middle = (begin + end) / 2u;
        if (comes_before(old_key(middle), key)) {
            begin = middle + 1u;
        } else {
            end = middle;
        }
    }
    return begin;
}

// The first remembered contact of two shapes, or NONE.
fn recall(a: u32, b: u32) -> u32 {
    let key = vec2(min(a, b), max(a, b));
    let first = olds_before(key);
    return select(NONE, first, is_of(first, key));
}

fn is_of(old: u32, key: vec2<u32>) -> bool {
    let world = world_of(key.x);
    return old < world * plan.remembered + count_in(world) && all(old_key(old) == key);
}

// Where a pair's lane has its numbers: `PairPlaces`, in order.
fn places_of(pair: u32) -> u32 {
    return plan.group_places + mark(plan.pair_group + pair) * PLACES;
}

// Pairs with meshes come after those of solids, and have a memory of their own.
var<private> first_with_mesh: u32;

fn put_parameter(j: u32, at: u32, x: f32) {
    if (j < first_with_mesh) {
        pair_parameters[at * plan.pairs + j] = x;
    } else {
        mesh_parameters[at * plan.mesh_pairs + j - first_with_mesh] = x;
    }
}
fn put_scratch(j: u32, at: u32, x: f32) {
    if (j < first_with_mesh) {
        pair_scratch[at * plan.pairs + j] = x;
    } else {
        mesh_scratch[at * plan.mesh_pairs + j - first_with_mesh] = x;
    }
}

// What a pair's kernel is told of its shapes, and of the step before.
@compute @workgroup_size(64)
fn seat_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let j = id.x;
    if (j >= pair_count()) {
        return;
    }
    first_with_mesh = mesh_first();
    let pair = word(plan.pair_order + j);
    put(plan.pair_place + pair, j);
    if (!runs_on()) {
        return;
    }
    let shapes = ordered(pair);
    let places = places_of(pair);
    for (var side = 0u; side < 2u; side++) {
        let shape = shapes[side];
        let size = whole[places + side];
        for (var i = 0u; i < 3u; i++) {
            put_parameter(j, size + i, solid(SOLID_SIZE + i, shape));
        }
        let corner = whole[places + 4u + side];
        let corners = whole[places + 5u + side] - corner;
        let own_corners = plan.corners + whole[plan.first_corner + own_shape(shape) * 2u];
        let first = world_of(shape) * plan.own_constants + own_corners;
        for (var i = 0u; i < corners; i++) {
            put_parameter(j, corner + i, constants[first + i]);
        }
    }
    // The last number of a surface is its margin.
    let margin = constants[surface_of(shapes) + SURFACE - 1u];
    put_parameter(j, whole[places + 7u], margin);
    let known = whole[places + 8u];
    let before = recall(shapes.x, shapes.y);
    let as_mesh = j >= first_with_mesh;
    for (var i = 0u; i < 3u; i++) {
        var direction = 0.0;
        if (before != NONE && !as_mesh) {
            let at = memory_at(before);
            if (u32(state[at + REMEMBERED_SHAPES]) == own_shape(shapes.x)) {
                direction = state[at + REMEMBERED_NORMAL + i];
            }
        }
        put_parameter(j, known + i, direction);
    }
}

// Where a pair's kernel finds its shapes; it has found no point yet.
@compute @workgroup_size(64)
fn place_pairs(@builtin(global_invocation_id) id: vec3<u32>) {
    let j = id.x;
    if (j >= pair_count() || !runs_on()) {
        return;
    }
    first_with_mesh = mesh_first();
    let pair = word(plan.pair_order + j);
    let shapes = ordered(pair);
    let places = places_of(pair);
    for (var side = 0u; side < 2u; side++) {
        let at = whole[places + 2u + side];
        for (var i = 0u; i < PAIR_PLACED; i++) {
            put_scratch(j, at + i, of_placed(i, shapes[side]));
        }
    }
    put_scratch(j, whole[places + 9u], 0.0);
    for (var i = 0u; i < whole[places + 11u]; i++) {
        put_scratch(j, whole[places + 10u] + i * POINT_PLACE + POINT_PLACE_DISTANCE, FAR);
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
    let places = places_of(pair);
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
    return whole[places_of(pair) + 10u] + i * POINT_PLACE;
}
fn points_of(pair: u32) -> u32 {
    return whole[places_of(pair) + 11u];
}
fn of_pair(pair: u32, at: u32) -> f32 {
    let j = word(plan.pair_place + pair);
    if (j < first_with_mesh) {
        return pair_scratch[at * plan.pairs + j];
    }
    return mesh_scratch[at * plan.mesh_pairs + j - first_with_mesh];
}

// How the points of a pair fall into contacts: those of one normal are one, up to a number, as far as any of them could
// close within the step.
struct Parts {
    count: u32,
    // Of each point its contact, or NONE.
    part: array<u32, SLOTS>,
}

fn parts_of(pair: u32, reach: f32) -> Parts {
    var parts: Parts;
    var normals: array<vec3<f32>, SLOTS>;
    var sizes: array<u32, SLOTS>;
    var near_by: array<bool, SLOTS>;
    var found = 0u;
    for (var i = 0u; i < points_of(pair); i++) {
        let point = point_of(pair, i);
        let gap = of_pair(pair, point + POINT_PLACE_DISTANCE);
        parts.part[i] = NONE;
        if (gap >= 0.5 * FAR) {
            continue;
        }
        var normal = vec3(0.0);
        for (var x = 0u; x < 3u; x++) {
            normal[x] = of_pair(pair, point + POINT_PLACE_NORMAL + x);
        }
        var part = 0u;
        for (; part < found; part++) {
            let apart = normals[part] - normal;
            if (sizes[part] < POINTS && dot(apart, apart) < ONE * ONE) {
                break;
            }
        }
        if (part == found) {
            normals[part] = normal;
            sizes[part] = 0u;
            near_by[part] = false;
            found++;
        }
        parts.part[i] = part;
        sizes[part]++;
        near_by[part] = near_by[part] || gap < reach;
    }
    var kept: array<u32, SLOTS>;
    for (var part = 0u; part < found; part++) {
        kept[part] = select(NONE, parts.count, near_by[part]);
        parts.count += select(0u, 1u, near_by[part]);
    }
    for (var i = 0u; i < points_of(pair); i++) {
        if (parts.part[i] != NONE) {
            parts.part[i] = kept[parts.part[i]];
        }
    }
    return parts;
}

@compute @workgroup_size(64)
fn find_touching(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if (pair > plan.pairs) {
        return;
    }
    first_with_mesh = mesh_first();
    var count = 0u;
    if (pair < pair_count() && runs_in(world_of(word(plan.pair_shapes + 2u * pair)))) {
        count = parts_of(pair, way(ordered(pair))).count;
    }
    put(plan.contact_start + pair, count);
}

// The first contact of a pair, and the one behind its last: none where there is no room for these.
fn contacts_of(pair: u32) -> vec2<u32> {
    let first = word(plan.contact_start + pair);
    let next = word(plan.contact_start + pair + 1u);
    return vec2(first, select(next, first, next > plan.contacts));
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
    first_with_mesh = mesh_first();
    let its = contacts_of(pair);
    if (its.x == its.y) {
        return;
    }
    let shapes = ordered(pair);
    let parts = parts_of(pair, way(shapes));
    for (var part = 0u; part < its.y - its.x; part++) {
        write_contact(pair, shapes, parts, part, its.x + part);
    }
}

// They begin with what was remembered, and those of sensors with nothing.
@compute @workgroup_size(64)
fn warm_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let pair = id.x;
    if (pair >= plan.pairs) {
        return;
    }
    let its = contacts_of(pair);
    if (its.x == its.y) {
        return;
    }
    let shapes = ordered(pair);
    if (is_sensor(shapes.x) || is_sensor(shapes.y)) {
        for (var contact = its.x; contact < its.y; contact++) {
            put_mark(plan.colour + contact, SENSED);
        }
        return;
    }
    warm(shapes, its.x, its.y);
    for (var side = 0u; side < 2u; side++) {
        let body = carrier_of(shapes[side]);
        if (!is_fixed(body)) {
            atomicAdd(&marks[plan.body_start + body], its.y - its.x);
        }
    }
}

// A contact that has given nothing yet.
fn write_contact(pair: u32, shapes: vec2<u32>, parts: Parts, part: u32, contact: u32) {
    let to = contact * REMEMBERED;
    for (var i = 0u; i < REMEMBERED; i++) {
        fresh[to + i] = 0.0;
    }
    fresh[to + REMEMBERED_SHAPES] = f32(shapes.x);
    fresh[to + REMEMBERED_SHAPES + 1u] = f32(shapes.y);
    var count = 0u;
    for (var i = 0u; i < points_of(pair); i++) {
        if (parts.part[i] != part) {
            continue;
        }
        let source = point_of(pair, i);
        let point = to + REMEMBERED_POINT + count * REMEMBERED_POINT_WIDTH;
        for (var x = 0u; x < 3u; x++) {
            if (count == 0u) {
                fresh[to + REMEMBERED_NORMAL + x] = of_pair(pair, source + POINT_PLACE_NORMAL + x);
            }
            fresh[point + x] = of_pair(pair, source + POINT_PLACE_POSITION + x);
        }
        fresh[point + 3u] = of_pair(pair, source + POINT_PLACE_DISTANCE);
        fresh[point + 4u] = of_pair(pair, source + POINT_PLACE_FEATURE);
        count++;
    }
    fresh[to + REMEMBERED_POINTS] = f32(count);
}

fn remembered_normal(i: u32) -> vec3<f32> {
    let at = memory_at(i) + REMEMBERED_NORMAL;
    return vec3(state[at], state[at + 1u], state[at + 2u]);
}
fn fresh_normal(contact: u32) -> vec3<f32> {
    let at = contact * REMEMBERED + REMEMBERED_NORMAL;
    return vec3(fresh[at], fresh[at + 1u], fresh[at + 2u]);
}

// Contacts of two shapes, from `first` to before `next`, begin with what those remembered gave: each with what the one of
// the nearest normal did. They begin with their colours, too.
fn warm(shapes: vec2<u32>, first: u32, next: u32) {
    for (var contact = first; contact < next; contact++) {
        start_colour(contact, 0u);
    }
    let key = vec2(min(shapes.x, shapes.y), max(shapes.x, shapes.y));
    let old = recall(shapes.x, shapes.y);
    if (old == NONE) {
        return;
    }
    var olds = 1u;
    while (is_of(old + olds, key)) {
        olds++;
    }
    // As many as there are bits to tell which are taken.
    if (olds > 32u) {
        stop_in(world_of(key.x), PROCESSOR);
        return;
    }
    if (olds == 1u && next - first == 1u) {
        warm_one(shapes, old, first);
        return;
    }
    var taken = 0u;
    var warmed = 0u;
    for (var i = first; i < next; i++) {
        var best = vec2(0u, 0u);
        var most = SAME_NORMAL;
        for (var contact = first; contact < next; contact++) {
            for (var j = 0u; j < olds; j++) {
                let is_free = ((taken >> j) & 1u) == 0u && ((warmed >> (contact - first)) & 1u) == 0u;
                let cosine = dot(fresh_normal(contact), remembered_normal(old + j));
                if (is_free && cosine > most) {
                    most = cosine;
                    best = vec2(contact, j);
                }
            }
        }
        if (most == SAME_NORMAL) {
            return;
        }
        warm_one(shapes, old + best.y, best.x);
        taken |= 1u << best.y;
        warmed |= 1u << (best.x - first);
    }
}

fn start_colour(contact: u32, colour: u32) {
    if (told(KEEP) == 0u) {
        put_mark(plan.colour + contact, min(colour, COLOURS));
    }
}

// Points begin with the impulses of those that had the same feature, or else were in the same place.
fn warm_one(shapes: vec2<u32>, old: u32, contact: u32) {
    start_colour(contact, colours_before[old]);
    let to = contact * REMEMBERED;
    let count = u32(fresh[to + REMEMBERED_POINTS]);
    let source = memory_at(old);
    for (var i = 0u; i < 3u; i++) {
        fresh[to + REMEMBERED_DRAG + i] = state[source + REMEMBERED_DRAG + i];
        fresh[to + REMEMBERED_TWIST + i] = state[source + REMEMBERED_TWIST + i];
    }
    // Of a mesh the radius says nothing.
    let radii = vec2(solid(SOLID_RADIUS, shapes.x), solid(SOLID_RADIUS, shapes.y));
    let solids = select(radii, vec2(0.0), vec2(is_mesh(shapes.x), is_mesh(shapes.y)));
    let near_by = SAME_PLACE * max(solids.x, solids.y);
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
