// Which shapes are near each other: boxes, cells of a hashed grid, and pairs in order.

// How far the largest box of a world reaches from its middle [m].
fn widest_in(world: u32) -> f32 {
    return bitcast<f32>(told(of_world(world, WIDEST)));
}
// A cell is no smaller than half of the largest box is wide, so that few are looked through.
fn cell_of(world: u32, at: vec3<f32>) -> vec3<i32> {
    let side = max(plan.cell, 0.5 * widest_in(world));
    return vec3<i32>(clamp(floor(at / side), vec3(-LAST_CELL), vec3(LAST_CELL)));
}
// Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
fn bucket(world: u32, cell: vec3<i32>) -> u32 {
    let c = bitcast<vec3<u32>>(cell);
    let hash = (c.x * 73856093u) ^ (c.y * 19349663u) ^ (c.z * 83492791u) ^ (world * 2654435761u);
    return hash & (plan.buckets - 1u);
}

@compute @workgroup_size(64)
fn surround(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let world = world_of(shape);
    let center = placed3(PLACED_POSITION, shape);
    let half = placed3(PLACED_EXTENT, shape);
    // What rounding may take away, far from the origin.
    let most = abs(center) + half;
    let rounding = 1e-6 * max(most.x, max(most.y, most.z));
    var around = half + (constant_of(shape, plan.grown, 1u) + rounding);
    if (is_plane(shape)) {
        around = vec3(EVERYWHERE);
    }
    let least = center - around;
    let greatest = center + around;
    for (var i = 0u; i < 3u; i++) {
        placed[(PLACED + i) * plan.shapes + shape] = least[i];
        placed[(PLACED + 3u + i) * plan.shapes + shape] = greatest[i];
    }
    if (is_large(shape) || !runs_in(world)) {
        return;
    }
    // Far out, and what is nowhere, is the processor's.
    for (var i = 0u; i < 3u; i++) {
        if (!is_finite(most[i]) || most[i] > plan.farthest) {
            stop_in(world, PROCESSOR);
            return;
        }
    }
    let most_around = max(around.x, max(around.y, around.z));
    atomicMax(&status[of_world(world, WIDEST)], bitcast<u32>(most_around));
}

@compute @workgroup_size(64)
fn count_buckets(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let world = world_of(shape);
    if (is_large(shape) || !runs_in(world)) {
        put(plan.bucket_of + shape, NONE);
        return;
    }
    let cell = cell_of(world, placed3(PLACED_POSITION, shape));
    for (var i = 0u; i < 3u; i++) {
        put(plan.cells + 3u * shape + i, bitcast<u32>(cell[i]));
    }
    let here = bucket(world, cell);
    put(plan.bucket_of + shape, here);
    atomicAdd(&marks[plan.bucket_start + here], 1u);
}

// Whether a shape was put there.
fn is_in(shape: u32, world: u32, cell: vec3<i32>) -> bool {
    let at = plan.cells + 3u * shape;
    return world_of(shape) == world && all(vec3(word(at), word(at + 1u), word(at + 2u)) == bitcast<vec3<u32>>(cell));
}

// After it, a bucket begins where the one before it ends, and `bucket_start` says where it ends.
@compute @workgroup_size(64)
fn fill_buckets(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let here = word(plan.bucket_of + shape);
    if (here != NONE) {
        let at = atomicAdd(&marks[plan.bucket_start + here], 1u);
        put(plan.bucket_items + at, shape);
    }
}

// Two shapes of the first world.
fn may_touch(a: u32, b: u32) -> bool {
    let one = plan.sides + a * SIDE;
    let two = plan.sides + b * SIDE;
    let owner = whole[one] >> 2u;
    let other = whole[two] >> 2u;
    // Bit 0: collides; bit 1: moves.
    let collide = (whole[one] & whole[two] & 1u) != 0u;
    let move_ = ((whole[one] | whole[two]) & 2u) != 0u;
    let v = bitcast<i32>(whole[one + 4u]);
    let w = bitcast<i32>(whole[two + 4u]);
    if (owner == other || !move_ || !(v == w || v == -1 || w == -1)) {
        return false;
    }
    for (var i = whole[plan.paired_start + a]; i < whole[plan.paired_start + a + 1u]; i++) {
        if (whole[plan.paired_items + i] == b) {
            return true;
        }
    }
    let masks = (whole[one + 1u] & whole[two + 2u]) | (whole[two + 1u] & whole[one + 2u]);
    let g = bitcast<i32>(whole[one + 3u]);
    let h = bitcast<i32>(whole[two + 3u]);
    let groups = (g > 0 && h != 0) || (h > 0 && g != 0);
    if (!collide || masks == 0u || !groups) {
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
    let f = whole[plan.shape_form + own_shape(a) * 2u];
    let g = whole[plan.shape_form + own_shape(b) * 2u];
    return whole[plan.form_group + min(f, g) * plan.forms + max(f, g)];
}

fn may_meet(a: u32, b: u32) -> bool {
    return group_of(a, b) != NONE && may_touch(own_shape(a), own_shape(b));
}

fn near(a: u32, b: u32) -> bool {
    return b > a && overlap(a, b) && may_meet(a, b);
}

fn world_of_unit(unit: u32) -> u32 {
    if (SEVERAL) {
        return unit / plan.own_units;
    }
    return 0u;
}

// A unit of work: a small shape with all later ones, or a large one with some of them. Lists the pairs from `at` on, which
// is before `end`, and returns their number.
fn look(unit: u32, at: u32, end: u32) -> u32 {
    let world = world_of_unit(unit);
    let own_unit = plan.unit_shapes + 2u * (unit - world * plan.own_units);
    let base = world * plan.own_shapes;
    let a = base + whole[own_unit];
    let first = whole[own_unit + 1u];
    var found = 0u;
    if (!runs_in(world)) {
        return found;
    }
    if (first != NONE) {
        for (var i = first; i < min(first + UNIT, plan.own_shapes); i++) {
            let b = base + i;
            if (near(a, b)) {
                list(at, end, found, a, b);
                found++;
            }
        }
        return found;
    }
    for (var i = 0u; i < plan.large; i++) {
        let b = base + whole[plan.large_shapes + i];
        if (near(a, b)) {
            list(at, end, found, a, b);
            found++;
        }
    }
    let widest = widest_in(world);
    let low = cell_of(world, placed3(PLACED, a) - widest);
    let high = cell_of(world, placed3(PLACED + 3u, a) + widest);
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let cell = vec3(x, y, z);
                let there = plan.bucket_start + bucket(world, cell);
                var i = 0u;
                if (there > plan.bucket_start) {
                    i = mark(there - 1u);
                }
                let next = mark(there);
                for (; i < next; i++) {
                    let b = word(plan.bucket_items + i);
                    if (b <= a) {
                        continue;
                    }
                    // Other cells may share the bucket. All that this needs is read at once.
                    let here = is_in(b, world, cell);
                    let close = overlap(a, b);
                    if (here && close && may_meet(a, b)) {
                        list(at, end, found, a, b);
                        found++;
                    }
                }
            }
        }
    }
    return found;
}

fn list(at: u32, end: u32, nth: u32, a: u32, b: u32) {
    if (at + nth >= end) {
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
        put(plan.unit_start + id.x, look(id.x, 0u, 0u));
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
    let next = word(plan.unit_start + unit + 1u);
    let end = min(next, plan.pairs);
    if (look(unit, at, end) != next - at) {
        let world = world_of_unit(unit);
        stop_in(world, PROCESSOR);
        // None of these is looked at again, and they are no other world's.
        for (var i = 2u * at; i < 2u * end; i++) {
            put(plan.pair_shapes + i, world * plan.own_shapes);
        }
    }
    for (var i = at; i < end; i++) {
        let a = word(plan.pair_shapes + 2u * i);
        let b = word(plan.pair_shapes + 2u * i + 1u);
        put_mark(plan.pair_group + i, min(group_of(a, b), plan.groups - 1u));
    }
}

// A run, and how many workgroups it takes.
fn run(number: u32, first: u32, count: u32) {
    runs[number] = vec2(first, count);
    launch(number, (count + 63u) / 64u);
}

// The first pair with a mesh, in the order of groups.
fn mesh_first() -> u32 {
    if (plan.solid_groups == plan.groups) {
        return pair_count();
    }
    return word(plan.group_matrix + plan.solid_groups * plan.pair_blocks);
}

@compute @workgroup_size(64)
fn plan_groups(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= plan.groups) {
        return;
    }
    let mesh_pairs = pair_count() - mesh_first();
    let fits = mesh_pairs <= plan.mesh_pairs;
    // Of a step that was stopped before, pairs are not known.
    if (id.x == 0u && !fits && runs_on()) {
        atomicStore(&status[MESH_PAIRS], mesh_pairs);
        stop(MORE_MESH_PAIRS);
    }
    let first = word(plan.group_matrix + id.x * plan.pair_blocks);
    var next = pair_count();
    if (id.x + 1u < plan.groups) {
        next = word(plan.group_matrix + (id.x + 1u) * plan.pair_blocks);
    }
    let of_mesh = id.x >= plan.solid_groups;
    let base = select(0u, mesh_first(), of_mesh);
    run(id.x, first - base, select(0u, next - first, fits && runs_on()));
}
