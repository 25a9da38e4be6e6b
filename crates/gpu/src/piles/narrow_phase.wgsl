// Pairs to lanes, and the points that their kernels find to contacts.

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
    return select(NONE, begin, is_of(begin, lower, upper));
}

fn is_of(remembered: u32, lower: u32, upper: u32) -> bool {
    if (remembered >= u32(state[plan.count])) {
        return false;
    }
    let at = plan.memory + remembered * REMEMBERED;
    let c = u32(state[at + REMEMBERED_SHAPES]);
    let d = u32(state[at + REMEMBERED_SHAPES + 1u]);
    return min(c, d) == lower && max(c, d) == upper;
}

// Where a pair's lane has its numbers: `PairPlaces`, in order.
fn places_of(pair: u32) -> u32 {
    return plan.group_places + word(plan.pair_group + pair) * PLACES;
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
    let places = places_of(pair);
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
    // The last number of a surface is its margin.
    let margin = constants[surface_of(shapes) + SURFACE - 1u];
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
    if (is_sensor(shapes.x) || is_sensor(shapes.y)) {
        put(plan.colour + contact, SENSED);
        return;
    }
    let old = recall(shapes.x, shapes.y);
    var colour = 0u;
    if (old != NONE) {
        warm(shapes, old, to, count);
        // The parts of a step have left two: which of them it is, the processor knows.
        if (is_of(old + 1u, min(shapes.x, shapes.y), max(shapes.x, shapes.y))) {
            stop(PROCESSOR);
        }
        colour = colours_before[old];
    }
    if (told(KEEP) == 0u) {
        put(plan.colour + contact, min(colour, COLOURS));
    }
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
